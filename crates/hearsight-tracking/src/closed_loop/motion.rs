//! How heads move in a picture: Langevin motion whose speed is measured in heads (Chen and Rui, equation 12).

use hearsight_core::Span;
use hearsight_filter::FilterError;
use hearsight_filter::motion::{GaussianStep, LangevinAxis, LangevinIntegration};
use nalgebra::{SMatrix, SVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Speeds of heads.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct HeadMotionSettings {
    /// How fast a velocity is forgotten (beta_0), per second, above 0. Default 10.
    pub rate_per_s: f64,
    /// Root mean square of the velocity in the long run, head heights a second, above 0. Default 5: a little above 1 m/s.
    pub speed_heads_s: f64,
    /// The same of the size, shares of it a second. Default 0.1: heads come nearer slowly, and an outline alone that may
    /// shrink as it likes ends on the nose.
    pub growth_per_s: f64,
}

impl Default for HeadMotionSettings {
    fn default() -> Self {
        Self {
            rate_per_s: 10.0,
            speed_heads_s: 5.0,
            growth_per_s: 0.1,
        }
    }
}

/// The step of x, y and half height over one span.
#[derive(Clone, Copy, Debug)]
pub struct HeadMotion {
    /// One step an axis.
    pub axes: [GaussianStep; 3],
    /// Root mean square of each velocity in the long run, pixels a second.
    pub speeds: [f64; 3],
}

impl HeadMotion {
    /// The step over `elapsed` of a head that is `half_height` pixels high from its middle. The position is integrated
    /// exactly, so that the frame rate does not change how far heads spread.
    ///
    /// # Errors
    /// [`FilterError::OutOfRange`] for a negative span or settings out of their range.
    pub fn over(settings: &HeadMotionSettings, elapsed: Span, half_height: f64) -> Result<Self, FilterError> {
        let half_height = half_height.max(1.0);
        let speed = settings.speed_heads_s * 2.0 * half_height;
        let speeds = [speed, speed, settings.growth_per_s * half_height];
        let mut axes = [GaussianStep {
            velocity_from_velocity: 1.0,
            position_from_velocity: 0.0,
            velocity_noise: 0.0,
            shared_noise: 0.0,
            position_noise: 0.0,
        }; 3];
        for (number, (axis, rms_velocity)) in axes.iter_mut().zip(speeds).enumerate() {
            let langevin = LangevinAxis {
                position: number,
                velocity: number + 3,
                rate_per_sec: settings.rate_per_s,
                rms_velocity,
            };
            *axis = langevin.over(elapsed, LangevinIntegration::Exact)?;
        }
        Ok(Self { axes, speeds })
    }

    /// Where the state (places, then velocities) is carried to.
    pub fn carry(&self, state: &SVector<f64, 6>) -> SVector<f64, 6> {
        SVector::from_fn(|row, _| {
            let axis = &self.axes[row % 3];
            if row < 3 {
                state[row] + axis.position_from_velocity * state[row + 3]
            } else {
                axis.velocity_from_velocity * state[row]
            }
        })
    }

    /// Covariance of the noise of the state.
    pub fn noise(&self) -> SMatrix<f64, 6, 6> {
        let mut noise = SMatrix::zeros();
        for (number, axis) in self.axes.iter().enumerate() {
            let covariance = axis.covariance();
            for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                noise[(number + 3 * row, number + 3 * column)] = covariance[(row, column)];
            }
        }
        noise
    }
}
