//! Langevin motion: a velocity that is pulled to zero and kicked at random, as people move.

use super::gaussian_step::{GaussianStep, check_axes};
use super::{Motion, elapsed_secs};
use crate::elementary::exp;
use crate::error::FilterError;
use crate::particles::Particles;
use crate::random::Generator;
use hearsight_core::Span;
use serde::{Deserialize, Serialize};

/// Axes of Langevin motion (Vermaak and Blake 2001; Chen and Rui, equation 12; Pnevmatikakis and Talantzis, equations
/// 6 to 9).
///
/// Over a span `t` the velocity becomes `a v + b n` with `a = exp(-rate t)`, `b = rms_velocity sqrt(1 - a^2)` and `n`
/// standard normal. How the position follows is [`LangevinIntegration`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Langevin {
    /// The axes that move; other dimensions stay.
    pub axes: Vec<LangevinAxis>,
    /// How the position follows the velocity; exactly, unless said otherwise.
    #[serde(default)]
    pub integration: LangevinIntegration,
}

/// One axis: a position and its velocity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LangevinAxis {
    /// The dimension of the position.
    pub position: usize,
    /// The dimension of the velocity, in units of the position per second.
    pub velocity: usize,
    /// How fast a velocity is forgotten, per second, from 0. 10 is usual for people (Ward, Lehmann and Williamson
    /// 2003); greater is less persistent.
    pub rate_per_sec: f64,
    /// Root mean square of the velocity in the long run, in units of the position per second, from 0. 1 m/s is usual
    /// for people.
    pub rms_velocity: f64,
}

/// How the position follows the velocity within a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LangevinIntegration {
    /// The exact integral of the velocity: one step of `t` is distributed as two of `t/2`.
    #[default]
    Exact,
    /// The old velocity times the span, as Chen and Rui print it (equation 12). The spread depends on the frame rate.
    OldVelocity,
    /// The new velocity times the span, as Pnevmatikakis and Talantzis print it (equations 6 to 9). The spread
    /// depends on the frame rate.
    NewVelocity,
}

impl LangevinAxis {
    /// The step over `elapsed`.
    ///
    /// # Errors
    /// [`FilterError::OutOfRange`] for a negative span, rate or velocity.
    pub fn over(&self, elapsed: Span, integration: LangevinIntegration) -> Result<GaussianStep, FilterError> {
        let seconds = elapsed_secs(elapsed)?;
        FilterError::check_not_negative("rate_per_sec", self.rate_per_sec)?;
        FilterError::check_not_negative("rms_velocity", self.rms_velocity)?;
        let decays = self.rate_per_sec * seconds;
        let keep = exp(-decays);
        // sqrt(1 - a^2), without cancellation for short steps.
        let kick = (2.0 * decays * mean_decay(2.0 * decays)).sqrt();
        let velocity_noise = self.rms_velocity * kick;
        let (position_from_velocity, shared_noise, position_noise) = match integration {
            LangevinIntegration::OldVelocity => (seconds, 0.0, 0.0),
            LangevinIntegration::NewVelocity => (seconds * keep, seconds * velocity_noise, 0.0),
            LangevinIntegration::Exact => {
                let mean = mean_decay(decays);
                // Gillespie 1996, equations 2.12 and 2.13: the covariance with the velocity is
                // rms^2 (1 - a)^2 / rate and the variance rms^2 (2 rate t - 3 + 4 a - a^2) / rate^2.
                let covariance = decays * mean * mean;
                let shared = if kick > 0.0 { covariance / kick } else { 0.0 };
                let own = (decays * position_spread(decays) - shared * shared)
                    .max(0.0)
                    .sqrt();
                let reach = self.rms_velocity * seconds;
                (seconds * mean, reach * shared, reach * own)
            }
        };
        Ok(GaussianStep {
            velocity_from_velocity: keep,
            position_from_velocity,
            velocity_noise,
            shared_noise,
            position_noise,
        })
    }
}

/// `(1 - exp(-t)) / t`, 1 at zero.
fn mean_decay(t: f64) -> f64 {
    if t > 0.5 {
        return (1.0 - exp(-t)) / t;
    }
    // sum (-t)^k / (k + 1)!
    let mut sum = 0.0;
    let mut term = 1.0;
    for k in 1..=16 {
        sum += term;
        term *= -t / f64::from(k + 1);
    }
    sum
}

/// `(2 t - 3 + 4 exp(-t) - exp(-2 t)) / t^3`, 2/3 at zero.
fn position_spread(t: f64) -> f64 {
    if t > 0.5 {
        let keep = exp(-t);
        return (2.0 * t - 3.0 + 4.0 * keep - keep * keep) / (t * t * t);
    }
    // sum over n >= 3 of (-1)^n (4 - 2^n) t^(n - 3) / n!
    let mut sum = 0.0;
    let mut over_factorial = -1.0 / 6.0;
    let mut power_of_two = 8.0;
    for n in 3..=20 {
        sum += over_factorial * (4.0 - power_of_two);
        over_factorial *= -t / f64::from(n + 1);
        power_of_two *= 2.0;
    }
    sum
}

impl Motion for Langevin {
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
            axis.over(elapsed, self.integration)?;
        }
        if elapsed == Span::ZERO {
            return Ok(());
        }
        for axis in &self.axes {
            let step = axis.over(elapsed, self.integration)?;
            step.apply(particles, axis.position, axis.velocity, generator)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::consistency::{assert_halves_equal_whole, assert_moves_as};
    use nalgebra::Matrix2;

    const AXIS: LangevinAxis = LangevinAxis {
        position: 0,
        velocity: 1,
        rate_per_sec: 3.0,
        rms_velocity: 2.0,
    };

    fn step(axis: LangevinAxis, seconds: f64, integration: LangevinIntegration) -> GaussianStep {
        axis.over(Span::from_seconds(seconds), integration).unwrap()
    }

    fn chained(step: &GaussianStep, times: usize) -> (Matrix2<f64>, Matrix2<f64>) {
        let (mut transition, mut covariance) = (Matrix2::identity(), Matrix2::zeros());
        for _ in 0..times {
            transition = step.transition() * transition;
            covariance = step.transition() * covariance * step.transition().transpose() + step.covariance();
        }
        (transition, covariance)
    }

    #[test]
    fn two_halves_are_distributed_as_one_whole() {
        let second = LangevinAxis {
            position: 3,
            velocity: 2,
            rate_per_sec: 0.4,
            rms_velocity: 0.7,
        };
        let model = Langevin {
            axes: vec![AXIS, second],
            integration: LangevinIntegration::Exact,
        };
        assert_halves_equal_whole(&model, 4, 0.5);
    }

    #[test]
    fn exact_steps_compose_at_every_rate() {
        for rate_per_sec in [0.0, 1e-9, 1e-3, 0.49, 0.51, 1.0, 10.0, 100.0, 1e4] {
            let axis = LangevinAxis { rate_per_sec, ..AXIS };
            let whole = step(axis, 1.0, LangevinIntegration::Exact);
            let (transition, covariance) = chained(&step(axis, 0.125, LangevinIntegration::Exact), 8);
            assert!((transition - whole.transition()).norm() < 1e-12, "{rate_per_sec}");
            let expected = whole.covariance();
            for (a, b) in covariance.iter().zip(expected.iter()) {
                assert!(
                    (a - b).abs() <= 1e-11 * b.abs(),
                    "{rate_per_sec}: {covariance} {expected}"
                );
            }
        }
    }

    #[test]
    fn the_printed_forms_tend_to_the_exact_one_and_are_off_for_long_steps() {
        let exact = step(AXIS, 0.27, LangevinIntegration::Exact);
        for printed in [LangevinIntegration::OldVelocity, LangevinIntegration::NewVelocity] {
            let (transition, covariance) = chained(&step(AXIS, 0.27 / 4096.0, printed), 4096);
            assert!((transition - exact.transition()).norm() < 1e-3);
            assert!((covariance - exact.covariance()).norm() < 1e-3 * exact.covariance().norm());
            let once = step(AXIS, 0.27, printed);
            // The velocity is right; the position is not.
            assert!((once.covariance().m22 - exact.covariance().m22).abs() < 1e-12);
            assert!((once.covariance().m11 / exact.covariance().m11 - 1.0).abs() > 0.5);
        }
    }

    #[test]
    fn printed_constants_are_those_of_the_papers() {
        // At 0.27 s and 10 per second, a = 0.067 and b = 0.998.
        let axis = LangevinAxis {
            rate_per_sec: 10.0,
            rms_velocity: 1.0,
            ..AXIS
        };
        let old = step(axis, 0.27, LangevinIntegration::OldVelocity);
        assert!((old.velocity_from_velocity - 0.067_205_5).abs() < 1e-7);
        assert!((old.velocity_noise - (1.0 - old.velocity_from_velocity.powi(2)).sqrt()).abs() < 1e-15);
        assert_eq!(
            (old.position_from_velocity, old.shared_noise, old.position_noise),
            (0.27, 0.0, 0.0)
        );
        let new = step(axis, 0.27, LangevinIntegration::NewVelocity);
        assert_eq!(new.position_from_velocity, 0.27 * new.velocity_from_velocity);
        assert_eq!(new.shared_noise, 0.27 * new.velocity_noise);
    }

    #[test]
    fn particles_follow_the_step() {
        for integration in [
            LangevinIntegration::Exact,
            LangevinIntegration::OldVelocity,
            LangevinIntegration::NewVelocity,
        ] {
            let model = Langevin {
                axes: vec![AXIS],
                integration,
            };
            assert_moves_as(&model, 2, [0, 1], 0.3, &step(AXIS, 0.3, integration));
        }
    }

    #[test]
    fn mistakes_are_errors() {
        let span = Span::from_seconds(0.1);
        assert!(
            AXIS.over(Span::from_seconds(-0.1), LangevinIntegration::Exact)
                .is_err()
        );
        for axis in [
            LangevinAxis {
                rate_per_sec: -1.0,
                ..AXIS
            },
            LangevinAxis {
                rms_velocity: f64::NAN,
                ..AXIS
            },
        ] {
            assert!(axis.over(span, LangevinIntegration::Exact).is_err());
        }
        let mut particles = Particles::new(2, 5).unwrap();
        let mut random = crate::random::generator(1, "test", 0);
        let twice = Langevin {
            axes: vec![AXIS, AXIS],
            ..Langevin::default()
        };
        assert!(twice.step(&mut particles, span, &mut random).is_err());
    }
}
