//! Brownian motion of single dimensions.

use super::{BLOCK, Motion, elapsed_secs};
use crate::elementary::exp;
use crate::error::FilterError;
use crate::particles::Particles;
use crate::random::{Generator, fill_standard_normal};
use hearsight_core::Span;
use serde::{Deserialize, Serialize};

/// Independent Brownian motion of each dimension named; the others stay.
///
/// The deviation grows with the square root of time: a paper's "sigma per frame" at `r` frames a second is
/// `sigma * sqrt(r)` here.
///
/// ```
/// use hearsight_core::Span;
/// use hearsight_filter::{Particles, generator, motion::{Motion, Noise, RandomWalk}};
///
/// // Position in pixels, then size.
/// let walk = RandomWalk::new()
///     .with(0, Noise::Additive { sigma_per_sqrt_sec: 25.0 })?
///     .with(1, Noise::Additive { sigma_per_sqrt_sec: 25.0 })?
///     .with(2, Noise::Relative { sigma_per_sqrt_sec: 0.1 })?;
/// let mut particles = Particles::new(3, 100)?;
/// walk.step(&mut particles, Span::from_seconds(0.04), &mut generator(1, "track", 1))?;
/// # Ok::<(), hearsight_filter::FilterError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RandomWalk {
    dimensions: Vec<RandomWalkDimension>,
}

/// The noise of one dimension.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RandomWalkDimension {
    /// The dimension of the state that moves.
    pub dimension: usize,
    /// How it moves.
    pub noise: Noise,
}

/// What one dimension does in time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Noise {
    /// Adds a Gaussian number: for positions and angles.
    Additive {
        /// Standard deviation after one second, in the unit of the dimension per square root of a second, from 0.
        sigma_per_sqrt_sec: f64,
    },
    /// Multiplies by the exponential of a Gaussian number: for sizes, which stay positive. The median stays; growth
    /// and shrinkage by one factor are equally likely.
    Relative {
        /// Standard deviation of the logarithm after one second, per square root of a second, from 0 (0.1: about
        /// 10 % in a second).
        sigma_per_sqrt_sec: f64,
    },
}

impl Noise {
    fn sigma_per_sqrt_sec(self) -> f64 {
        match self {
            Self::Additive { sigma_per_sqrt_sec } | Self::Relative { sigma_per_sqrt_sec } => {
                sigma_per_sqrt_sec
            }
        }
    }
}

impl RandomWalk {
    /// A walk that moves nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Lets one more dimension move.
    ///
    /// # Errors
    /// [`FilterError::BadIndex`] if it moves already, [`FilterError::OutOfRange`] for a negative or non-finite sigma.
    pub fn with(mut self, dimension: usize, noise: Noise) -> Result<Self, FilterError> {
        if self.dimensions.iter().any(|moving| moving.dimension == dimension) {
            let available = self.dimensions.len();
            return Err(FilterError::BadIndex {
                what: "dimension",
                index: dimension,
                available,
            });
        }
        FilterError::check_not_negative("sigma_per_sqrt_sec", noise.sigma_per_sqrt_sec())?;
        self.dimensions.push(RandomWalkDimension { dimension, noise });
        Ok(self)
    }

    /// The moving dimensions in the order of their draws.
    pub fn dimensions(&self) -> &[RandomWalkDimension] {
        &self.dimensions
    }
}

impl Motion for RandomWalk {
    fn step(
        &self,
        particles: &mut Particles,
        elapsed: Span,
        generator: &mut Generator,
    ) -> Result<(), FilterError> {
        let root = elapsed_secs(elapsed)?.sqrt();
        for (position, moving) in self.dimensions.iter().enumerate() {
            let index = moving.dimension;
            let available = particles.dimensions();
            if index >= available
                || self.dimensions[..position]
                    .iter()
                    .any(|earlier| earlier.dimension == index)
            {
                return Err(FilterError::BadIndex {
                    what: "dimension",
                    index,
                    available,
                });
            }
            FilterError::check_not_negative("sigma_per_sqrt_sec", moving.noise.sigma_per_sqrt_sec())?;
        }
        if root == 0.0 {
            return Ok(());
        }
        let mut normal = [0.0_f32; BLOCK];
        for moving in &self.dimensions {
            let sigma = moving.noise.sigma_per_sqrt_sec() * root;
            for block in particles.column_mut(moving.dimension).chunks_mut(BLOCK) {
                let normal = &mut normal[..block.len()];
                fill_standard_normal(generator, normal);
                match moving.noise {
                    Noise::Additive { .. } => {
                        for (state, normal) in block.iter_mut().zip(normal) {
                            *state += sigma as f32 * *normal;
                        }
                    }
                    Noise::Relative { .. } => {
                        for (state, normal) in block.iter_mut().zip(normal) {
                            *state *= exp(sigma * f64::from(*normal)) as f32;
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::consistency::{assert_halves_equal_whole, clouds};
    use crate::random::generator;

    #[test]
    fn two_halves_are_distributed_as_one_whole() {
        let walk = RandomWalk::new()
            .with(
                1,
                Noise::Additive {
                    sigma_per_sqrt_sec: 3.0,
                },
            )
            .and_then(|walk| {
                walk.with(
                    0,
                    Noise::Relative {
                        sigma_per_sqrt_sec: 0.2,
                    },
                )
            })
            .unwrap();
        assert_halves_equal_whole(&walk, 2, 0.37);
    }

    #[test]
    fn deviation_grows_with_the_root_of_time() {
        let walk = RandomWalk::new()
            .with(
                0,
                Noise::Additive {
                    sigma_per_sqrt_sec: 2.0,
                },
            )
            .and_then(|walk| {
                walk.with(
                    1,
                    Noise::Relative {
                        sigma_per_sqrt_sec: 0.3,
                    },
                )
            })
            .unwrap();
        for seconds in [0.01, 0.25, 4.0] {
            let mut particles = clouds(2, 100_000);
            particles
                .draw_gaussian(&[0.0, 50.0], &[0.0, 0.0], &mut generator(1, "test", 0))
                .unwrap();
            walk.step(
                &mut particles,
                Span::from_seconds(seconds),
                &mut generator(1, "test", 1),
            )
            .unwrap();
            // The relative error of a variance from n samples is sqrt(2/n); five of them.
            let tolerance = 5.0 * (2.0 / 100_000.0_f64).sqrt();
            assert!((particles.covariance_of(0, 0) / (4.0 * seconds) - 1.0).abs() < tolerance);
            for value in particles.column_mut(1) {
                *value = (*value / 50.0).ln();
            }
            assert!((particles.covariance_of(1, 1) / (0.09 * seconds) - 1.0).abs() < tolerance);
            assert!(particles.mean_of(1).abs() < 5.0 * 0.3 * (seconds / 100_000.0).sqrt());
        }
    }

    #[test]
    fn mistakes_are_errors_and_move_nothing() {
        let noise = Noise::Additive {
            sigma_per_sqrt_sec: 1.0,
        };
        assert!(
            RandomWalk::new()
                .with(
                    0,
                    Noise::Relative {
                        sigma_per_sqrt_sec: -1.0
                    }
                )
                .is_err()
        );
        assert!(
            RandomWalk::new()
                .with(0, noise)
                .and_then(|walk| walk.with(0, noise))
                .is_err()
        );
        let walk = RandomWalk::new()
            .with(0, noise)
            .and_then(|walk| walk.with(7, noise))
            .unwrap();
        let mut particles = Particles::new(2, 3).unwrap();
        let before = particles.clone();
        let mut random = generator(1, "test", 0);
        assert!(
            walk.step(&mut particles, Span::from_seconds(1.0), &mut random)
                .is_err()
        );
        let walk = RandomWalk::new().with(0, noise).unwrap();
        assert!(
            walk.step(&mut particles, Span::from_seconds(-1.0), &mut random)
                .is_err()
        );
        walk.step(&mut particles, Span::ZERO, &mut random).unwrap();
        assert_eq!(particles, before);
    }
}
