//! The transition as the proposal: a zero-order motion model (stac, eq. 6; the authors' own choice, method sheet).

use super::Proposal;
use hearsight_core::{Rectangle, Span};
use hearsight_filter::motion::{Motion, Noise, RandomWalk};
use hearsight_filter::{FilterError, Generator, Particles, fill_standard_normal};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How much a head moves by chance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RandomWalkSettings {
    /// Standard deviation of position after one second, head widths per square root of a second. Default 1.5 (8 px
    /// in 40 ms for a head 27 px wide). Raising it follows faster people and blurs the rest.
    pub position: f32,
    /// Standard deviation of the logarithm of width and height after one second. Default 0.15 (3 % in 40 ms).
    pub size: f64,
}

impl Default for RandomWalkSettings {
    fn default() -> Self {
        Self {
            position: 1.5,
            size: 0.15,
        }
    }
}

/// Moves head boxes (x, y, w, h) by chance, positions in proportion to the head's own width.
#[derive(Clone, Debug)]
pub struct RandomWalkProposal {
    position: f32,
    sizes: RandomWalk,
}

impl RandomWalkProposal {
    /// A walk with these deviations.
    ///
    /// # Errors
    /// [`FilterError::OutOfRange`] for a negative or non-finite deviation.
    pub fn new(settings: &RandomWalkSettings) -> Result<Self, FilterError> {
        let noise = Noise::Relative {
            sigma_per_sqrt_sec: settings.size,
        };
        let checked = Noise::Additive {
            sigma_per_sqrt_sec: settings.position.into(),
        };
        RandomWalk::new().with(0, checked)?;
        Ok(Self {
            position: settings.position,
            sizes: RandomWalk::new().with(2, noise)?.with(3, noise)?,
        })
    }
}

impl Proposal for RandomWalkProposal {
    fn name(&self) -> &'static str {
        "random_walk"
    }

    fn propose(
        &self,
        particles: &mut Particles,
        elapsed: Span,
        _detections: &[(Rectangle, f32)],
        generator: &mut Generator,
    ) -> Result<(), FilterError> {
        const BLOCK: usize = 256;
        let deviation = self.position * elapsed.seconds().max(0.0).sqrt() as f32;
        let mut normal = [0.0_f32; BLOCK];
        let [x, y, width] = particles.columns_mut([0, 1, 2])?;
        for column in [x, y] {
            for (block, widths) in column.chunks_mut(BLOCK).zip(width.chunks(BLOCK)) {
                let normal = &mut normal[..block.len()];
                fill_standard_normal(generator, normal);
                for ((state, width), normal) in block.iter_mut().zip(widths).zip(normal) {
                    *state += deviation * width * *normal;
                }
            }
        }
        self.sizes.step(particles, elapsed, generator)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight_filter::generator;

    #[test]
    fn deviation_is_in_head_widths_and_grows_with_the_root_of_time() {
        let walk = RandomWalkProposal::new(&RandomWalkSettings {
            position: 2.0,
            size: 0.0,
        })
        .unwrap();
        let mut particles = Particles::new(4, 20_000).unwrap();
        let mut random = generator(1, "test", 0);
        particles
            .draw_gaussian(&[100.0, 50.0, 10.0, 13.0], &[0.0; 4], &mut random)
            .unwrap();
        walk.propose(&mut particles, Span::from_seconds(0.25), &[], &mut random)
            .unwrap();
        let deviation = particles.covariance_of(0, 0).sqrt();
        assert!((deviation / 10.0 - 1.0).abs() < 0.03, "{deviation}");
        assert!((particles.mean_of(0) - 100.0).abs() < 0.3);
        assert!(particles.column(2).iter().all(|width| *width == 10.0));
    }
}
