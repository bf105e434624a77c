//! A share of the hypotheses drawn afresh around the person's own detection.
//!
//! The transition alone cannot follow a size that was wrong at birth or a place that was lost behind somebody. A small
//! share of the particles starts anew where a detector saw the person: the mixed-state model of Isard and Blake
//! (ICondensation, 1998), in which such a start has a prior probability of its own, so that weights need no
//! correction. Not in the paper; a share of 0 is its system.

use super::Proposal;
use hearsight_core::{Rectangle, Span};
use hearsight_filter::{FilterError, Generator, Particles, standard_normal};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How many hypotheses start anew, and how near to the detection.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct DetectedSettings {
    /// Share of the particles that start anew at a detection, 0 to 1. Default 0.1. Raising it trusts detections more
    /// than the past; 0 is the paper's bootstrap filter.
    pub share: f32,
    /// Standard deviation of their place around the detection, head widths. Default 0.15.
    pub position: f64,
    /// Standard deviation of the logarithm of their size. Default 0.08.
    pub size: f64,
}

impl Default for DetectedSettings {
    fn default() -> Self {
        Self {
            share: 0.1,
            position: 0.15,
            size: 0.08,
        }
    }
}

/// Draws a share of head boxes (x, y, w, h) around the detection that belongs to the person.
#[derive(Clone, Debug)]
pub struct DetectedProposal {
    settings: DetectedSettings,
}

impl DetectedProposal {
    /// A proposal with these settings; the share is held within 0 and 1.
    pub fn new(settings: DetectedSettings) -> Self {
        Self {
            settings: DetectedSettings {
                share: settings.share.clamp(0.0, 1.0),
                ..settings
            },
        }
    }
}

impl Proposal for DetectedProposal {
    fn name(&self) -> &'static str {
        "detected"
    }

    fn propose(
        &self,
        particles: &mut Particles,
        _elapsed: Span,
        detections: &[(Rectangle, f32)],
        generator: &mut Generator,
    ) -> Result<(), FilterError> {
        let Some((head, _)) = detections.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else {
            return Ok(());
        };
        let count = (self.settings.share * particles.count() as f32).round() as usize;
        let (x, y) = head.centre();
        let spread = self.settings.position * f64::from(head.width);
        // Survivors of systematic resampling stand in the order of their ancestors: every n-th one is replaced, so that
        // no part of the cloud is lost.
        for index in 0..count {
            let mut normal = || standard_normal(generator);
            let state = [
                (f64::from(x) + spread * normal()) as f32,
                (f64::from(y) + spread * normal()) as f32,
                (f64::from(head.width) * (self.settings.size * normal()).exp()) as f32,
                (f64::from(head.height) * (self.settings.size * normal()).exp()) as f32,
            ];
            particles.set_state(index * particles.count() / count, &state)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight_filter::generator;

    #[test]
    fn the_share_starts_at_the_detection_and_the_rest_stays() {
        let proposal = DetectedProposal::new(DetectedSettings {
            share: 0.25,
            ..DetectedSettings::default()
        });
        let mut random = generator(1, "test", 0);
        let mut particles = Particles::new(4, 200).unwrap();
        let head = Rectangle::new(100.0, 50.0, 20.0, 26.0);
        proposal
            .propose(&mut particles, Span::ZERO, &[], &mut random)
            .unwrap();
        assert!(particles.column(0).iter().all(|x| *x == 0.0));
        proposal
            .propose(&mut particles, Span::ZERO, &[(head, 1.0)], &mut random)
            .unwrap();
        assert_eq!(
            particles
                .column(0)
                .iter()
                .filter(|x| (**x - 110.0).abs() < 20.0)
                .count(),
            50
        );
        assert_eq!(particles.column(0).iter().filter(|x| **x == 0.0).count(), 150);
    }
}
