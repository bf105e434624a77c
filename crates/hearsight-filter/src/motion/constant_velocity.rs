//! Constant velocity, disturbed by white acceleration.

use super::gaussian_step::{GaussianStep, check_axes};
use super::{Motion, elapsed_secs};
use crate::error::FilterError;
use crate::particles::Particles;
use crate::random::Generator;
use hearsight_core::Span;
use serde::{Deserialize, Serialize};

/// Axes of nearly constant velocity (Bar-Shalom, Li and Kirubarajan 2001, section 6.2.2): the exact discrete form of
/// continuous white acceleration, right for steps of any length.
///
/// ```
/// use hearsight_core::Span;
/// use hearsight_filter::{Particles, generator, motion::{ConstantVelocity, ConstantVelocityAxis, Motion}};
///
/// // State: x, y, velocity of x, velocity of y, in metres.
/// let model = ConstantVelocity {
///     axes: [0, 1].map(|axis| ConstantVelocityAxis { position: axis, velocity: axis + 2, diffusion: 0.5 }).to_vec(),
/// };
/// let mut particles = Particles::new(4, 100)?;
/// model.step(&mut particles, Span::from_seconds(0.04), &mut generator(1, "track", 1))?;
/// # Ok::<(), hearsight_filter::FilterError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstantVelocity {
    /// The axes that move; other dimensions stay.
    pub axes: Vec<ConstantVelocityAxis>,
}

/// One axis: a position and its velocity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstantVelocityAxis {
    /// The dimension of the position.
    pub position: usize,
    /// The dimension of the velocity, in units of the position per second.
    pub velocity: usize,
    /// Deviation of the velocity after one second, in units of the position per second to the power 3/2, from 0: the
    /// square root of the spectral density of the acceleration. Greater follows turns faster and is less smooth.
    pub diffusion: f64,
}

impl ConstantVelocityAxis {
    /// The step over `elapsed`: covariance `q [[t^3/3, t^2/2], [t^2/2, t]]` with `q = diffusion^2`.
    ///
    /// # Errors
    /// [`FilterError::OutOfRange`] for a negative span or diffusion.
    pub fn over(&self, elapsed: Span) -> Result<GaussianStep, FilterError> {
        let seconds = elapsed_secs(elapsed)?;
        FilterError::check_not_negative("diffusion", self.diffusion)?;
        let velocity_noise = self.diffusion * seconds.sqrt();
        Ok(GaussianStep {
            velocity_from_velocity: 1.0,
            position_from_velocity: seconds,
            velocity_noise,
            shared_noise: 0.5 * seconds * velocity_noise,
            // What is left of t^3/3 when the shared t^3/4 is taken out.
            position_noise: seconds * velocity_noise / 12.0_f64.sqrt(),
        })
    }
}

impl Motion for ConstantVelocity {
    fn step(
        &self,
        particles: &mut Particles,
        elapsed: Span,
        generator: &mut Generator,
    ) -> Result<(), FilterError> {
        check_axes(
            particles,
            self.axes.iter().map(|axis| [axis.position, axis.velocity]),
        )?;
        for axis in &self.axes {
            axis.over(elapsed)?;
        }
        if elapsed == Span::ZERO {
            return Ok(());
        }
        for axis in &self.axes {
            axis.over(elapsed)?
                .apply(particles, axis.position, axis.velocity, generator)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::consistency::{assert_halves_equal_whole, assert_moves_as};
    use nalgebra::Matrix2;

    const AXIS: ConstantVelocityAxis = ConstantVelocityAxis {
        position: 2,
        velocity: 0,
        diffusion: 1.7,
    };

    #[test]
    fn two_halves_are_distributed_as_one_whole() {
        let second = ConstantVelocityAxis {
            position: 1,
            velocity: 3,
            diffusion: 0.3,
        };
        assert_halves_equal_whole(
            &ConstantVelocity {
                axes: vec![AXIS, second],
            },
            4,
            0.8,
        );
    }

    #[test]
    fn the_step_has_the_published_covariance_and_particles_follow_it() {
        let (t, q) = (0.6_f64, 1.7_f64.powi(2));
        let step = AXIS.over(Span::from_seconds(t)).unwrap();
        let published = Matrix2::new(q * t.powi(3) / 3.0, q * t * t / 2.0, q * t * t / 2.0, q * t);
        assert!((step.covariance() - published).norm() < 1e-14);
        assert_moves_as(&ConstantVelocity { axes: vec![AXIS] }, 3, [2, 0], t, &step);
    }

    #[test]
    fn mistakes_are_errors() {
        let mut particles = Particles::new(3, 5).unwrap();
        let mut random = crate::random::generator(1, "test", 0);
        let mut step = |axes: Vec<ConstantVelocityAxis>, seconds: f64| {
            ConstantVelocity { axes }.step(&mut particles, Span::from_seconds(seconds), &mut random)
        };
        assert!(step(vec![AXIS], 0.0).is_ok());
        assert!(step(vec![AXIS], -0.1).is_err());
        assert!(step(vec![AXIS, AXIS], 0.1).is_err());
        assert!(step(vec![ConstantVelocityAxis { position: 3, ..AXIS }], 0.1).is_err());
        assert!(step(vec![ConstantVelocityAxis { position: 0, ..AXIS }], 0.1).is_err());
        assert!(
            step(
                vec![ConstantVelocityAxis {
                    diffusion: f64::NAN,
                    ..AXIS
                }],
                0.1
            )
            .is_err()
        );
    }
}
