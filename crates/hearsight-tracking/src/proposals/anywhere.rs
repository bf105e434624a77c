//! A share of the hypotheses drawn afresh over the whole width of the picture.
//!
//! For following by sound alone: nothing tells the filter of the next talker but the likelihood of the places where it
//! has particles. A start of its own prior probability, as in the mixed-state model of Isard and Blake
//! (ICondensation, 1998), so that weights need no correction.

use super::Proposal;
use hearsight_core::{Rectangle, Span};
use hearsight_filter::{FilterError, Generator, Particles, uniform};

/// Draws a share of head boxes (x, y, w, h) at any column.
#[derive(Clone, Debug)]
pub struct AnywhereProposal {
    share: f32,
    width_px: f64,
}

impl AnywhereProposal {
    /// A proposal over a picture of this width; the share is held within 0 and 1.
    pub fn new(share: f32, width_px: f64) -> Self {
        Self {
            share: share.clamp(0.0, 1.0),
            width_px,
        }
    }
}

impl Proposal for AnywhereProposal {
    fn name(&self) -> &'static str {
        "anywhere"
    }

    fn propose(
        &self,
        particles: &mut Particles,
        _elapsed: Span,
        _detections: &[(Rectangle, f32)],
        generator: &mut Generator,
    ) -> Result<(), FilterError> {
        let count = (self.share * particles.count() as f32).round() as usize;
        let total = particles.count();
        let [column] = particles.columns_mut([0])?;
        // Every n-th one, as survivors of systematic resampling stand in the order of their ancestors.
        for index in 0..count {
            column[index * total / count] = (self.width_px * uniform(generator)) as f32;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight_filter::generator;

    #[test]
    fn the_share_is_spread_over_the_width() {
        let mut particles = Particles::new(4, 1000).unwrap();
        let mut random = generator(1, "test", 0);
        AnywhereProposal::new(0.5, 200.0)
            .propose(&mut particles, Span::ZERO, &[], &mut random)
            .unwrap();
        let column = particles.column(0);
        assert_eq!(column.iter().filter(|x| **x == 0.0).count(), 500);
        assert!(column.iter().all(|x| (0.0..200.0).contains(x)));
        assert!((particles.mean_of(0) - 50.0).abs() < 5.0);
    }
}
