//! The belief of a sound: where in the room something sounds, whoever it belongs to.
//!
//! A particle filter over position and velocity (Pnevmatikakis and Talantzis, section 2.1): residual resampling, Langevin
//! motion, the steered response of all pairs as likelihood, and an [`External`] that starts anew at every frame and
//! takes over where the filter is trapped. A sound may belong to nobody who is seen.

mod external;

pub use external::External;
pub use hearsight_audio::steered_response::{Bounds, SteeredResponse};

use external::{Outsider, Taking};
use hearsight_audio::AudioError;
use hearsight_core::{Instant, Span, WorldPoint};
use hearsight_filter::motion::{Langevin, LangevinAxis, LangevinIntegration, Motion};
use hearsight_filter::{FilterError, Generator, Particles, Resampling, generator};
use nalgebra::{Matrix3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A Gaussian over a point of the room.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointEstimate {
    /// Its mean.
    pub mean: WorldPoint,
    /// Its covariance, square metres.
    pub covariance: Matrix3<f64>,
}

/// Heights at which people's mouths are: what an array tells that cannot see height.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeightPrior {
    /// Mean height above the floor (the lower side of the room), metres.
    pub mean_m: f64,
    /// Standard deviation, metres, above 0.
    pub deviation_m: f64,
}

/// How a sound is followed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SoundSettings {
    /// Particles. Default 200; the paper's 50 are few for six dimensions.
    pub particles: usize,
    /// How fast a velocity is forgotten, per second (beta). Default 10 (Ward, Lehmann and Williamson 2003; the paper
    /// does not say).
    pub rate_per_s: f64,
    /// Root mean square of the velocity, metres a second (v). Default 1.
    pub velocity_m_s: f64,
    /// Whether the position follows the velocity as printed (eqs. 6-9). Default false: exactly.
    pub printed_motion: bool,
    /// How survivors are drawn, before every step. Default residual.
    #[schemars(with = "String")]
    pub resampling: Resampling,
    /// Where mouths are. Default 1.4 m, deviation 0.35 m; null for arrays that see height well enough.
    pub height: Option<HeightPrior>,
    /// What watches from outside.
    pub external: External,
}

impl Default for SoundSettings {
    fn default() -> Self {
        Self {
            particles: 200,
            rate_per_s: 10.0,
            velocity_m_s: 1.0,
            printed_motion: false,
            resampling: Resampling::Residual,
            height: Some(HeightPrior {
                mean_m: 1.4,
                deviation_m: 0.35,
            }),
            external: External::default(),
        }
    }
}

/// Why a sound cannot be followed with these settings.
#[derive(Debug, thiserror::Error)]
pub enum SoundError {
    /// Of the room or the search.
    #[error(transparent)]
    Audio(#[from] AudioError),
    /// Of the filter.
    #[error(transparent)]
    Filter(#[from] FilterError),
}

/// What is remembered of a sound.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SoundBelief {
    /// Position and velocity: x, y, z in metres, then metres a second.
    particles: Particles,
    generator: Generator,
    last: Option<Instant>,
    estimate: Option<PointEstimate>,
    /// For how long the external has been elsewhere, seconds.
    apart_s: f64,
    /// How often it took over.
    takeovers: u64,
}

/// Follows one sound.
pub struct SoundTracker {
    settings: SoundSettings,
    bounds: Bounds,
    motion: Langevin,
    belief: SoundBelief,
    outsider: Outsider,
    likelihood: Likelihood,
    quarantined: u64,
}

/// Scores of particles and what turns them into likelihoods.
#[derive(Clone, Default)]
struct Likelihood {
    scores: Vec<f32>,
    logarithms: Vec<f64>,
    height: Option<HeightPrior>,
    floor_m: f64,
}

/// After a longer silence the voice may be anywhere.
const LONGEST_STEP: Span = Span::from_nanoseconds(1_000_000_000);

impl Likelihood {
    /// ln p(height), up to a constant.
    fn prior(&self, z_m: f64) -> f64 {
        self.height.map_or(0.0, |height| {
            -0.5 * ((z_m - self.floor_m - height.mean_m) / height.deviation_m).powi(2)
        })
    }

    /// Log-likelihoods of all particles.
    fn score(&mut self, response: &mut SteeredResponse, particles: &Particles) -> &[f64] {
        let count = particles.count();
        self.scores.resize(count, 0.0);
        let [x, y, z] = [0, 1, 2].map(|axis| particles.column(axis));
        response.score_points([x, y, z], &mut self.scores);
        self.logarithms.clear();
        for (score, z) in self.scores.iter().zip(z) {
            let value = f64::from(response.log_likelihood(*score)) + self.prior(f64::from(*z));
            self.logarithms.push(value);
        }
        &self.logarithms
    }
}

impl SoundTracker {
    /// A tracker that has heard nothing, in the box `bounds`, for the array of `response`. `role` tells its random
    /// numbers from those of other sounds.
    ///
    /// # Errors
    /// [`SoundError`] where a setting is out of its range.
    pub fn new(
        settings: SoundSettings,
        bounds: Bounds,
        response: &SteeredResponse,
        seed: u64,
        role: &str,
    ) -> Result<Self, SoundError> {
        if let Some(HeightPrior { mean_m, deviation_m }) = settings.height
            && !(mean_m.is_finite() && deviation_m > 0.0 && deviation_m.is_finite())
        {
            return Err(FilterError::OutOfRange {
                what: "height.deviation_m",
                range: "above 0, with a finite mean",
                found: deviation_m,
            }
            .into());
        }
        let axis = |position: usize| LangevinAxis {
            position,
            velocity: position + 3,
            rate_per_sec: settings.rate_per_s,
            rms_velocity: settings.velocity_m_s,
        };
        let motion = Langevin {
            axes: (0..3).map(axis).collect(),
            integration: if settings.printed_motion {
                LangevinIntegration::NewVelocity
            } else {
                LangevinIntegration::Exact
            },
        };
        axis(0).over(LONGEST_STEP, motion.integration)?;
        bounds.validate()?;
        Ok(Self {
            outsider: Outsider::new(&settings.external, bounds, response)?,
            belief: SoundBelief {
                particles: Particles::new(6, settings.particles)?,
                generator: generator(seed, role, 0),
                last: None,
                estimate: None,
                apart_s: 0.0,
                takeovers: 0,
            },
            likelihood: Likelihood {
                height: settings.height,
                floor_m: bounds.low_m[2],
                ..Likelihood::default()
            },
            settings,
            bounds,
            motion,
            quarantined: 0,
        })
    }

    /// What is remembered.
    pub fn belief(&self) -> &SoundBelief {
        &self.belief
    }

    /// Whether this tracker could have left a belief.
    pub fn accepts(&self, belief: &SoundBelief) -> bool {
        let real = belief
            .particles
            .columns()
            .iter()
            .flatten()
            .all(|value| value.is_finite());
        belief.particles.count() == self.settings.particles
            && belief.particles.dimensions() == 6
            && real
            && belief.apart_s >= 0.0
    }

    /// Goes on from what was remembered, which must be a belief that [`Self::accepts`].
    pub fn set_belief(&mut self, belief: SoundBelief) {
        self.belief = belief;
    }

    /// The box in which it is followed.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Where the sound of the newest frame is; none before the first.
    pub fn estimate(&self) -> Option<PointEstimate> {
        self.belief.estimate
    }

    /// The log-likelihood of the best place in the room for the newest frame, as far as the external's grid found it;
    /// where there is no grid, of the estimate.
    pub fn best(&self, response: &mut SteeredResponse) -> Option<f32> {
        let point = self
            .outsider
            .best()
            .or(self.belief.estimate.map(|own| own.mean))?;
        let score = response.score(point);
        Some(response.log_likelihood(score))
    }

    /// How often the external has taken over.
    pub fn takeovers(&self) -> u64 {
        self.belief.takeovers
    }

    /// Numbers that were not finite and were set aside since the start.
    pub fn quarantined(&self) -> u64 {
        self.quarantined
    }

    /// Takes in the frame that `response` observed last, whose middle is at `time`: steps 2 to 8 of the paper.
    ///
    /// # Errors
    /// [`FilterError`] or [`AudioError`] where `response` is of another array; nothing is believed of the frame then.
    pub fn listen(&mut self, response: &mut SteeredResponse, time: Instant) -> Result<(), SoundError> {
        let elapsed = self
            .belief
            .last
            .map(|last| (time - last).min(LONGEST_STEP).max(Span::ZERO));
        match elapsed {
            None => self.spread()?,
            Some(elapsed) => {
                let SoundBelief {
                    particles, generator, ..
                } = &mut self.belief;
                particles.resample(self.settings.resampling, generator)?;
                self.motion.step(particles, elapsed, generator)?;
                keep_inside(particles, &self.bounds);
            }
        }
        self.belief.last = Some(time);
        self.weigh(response)?;
        self.watch(response, elapsed.unwrap_or(Span::ZERO))
    }

    /// Anywhere in the room, at rest.
    fn spread(&mut self) -> Result<(), FilterError> {
        let Bounds { low_m, high_m } = self.bounds;
        let [low, high] = [low_m, high_m].map(|[x, y, z]| [x, y, z, 0.0, 0.0, 0.0]);
        self.belief
            .particles
            .draw_uniform(&low, &high, &mut self.belief.generator)
    }

    fn weigh(&mut self, response: &mut SteeredResponse) -> Result<(), FilterError> {
        let logarithms = self.likelihood.score(response, &self.belief.particles);
        let report = self.belief.particles.add_log_likelihoods(logarithms)?;
        self.quarantined += report.quarantined as u64;
        self.belief.estimate = Some(estimate(&self.belief.particles));
        Ok(())
    }

    /// Lets the external take over where it has been elsewhere for long enough.
    fn watch(&mut self, response: &mut SteeredResponse, elapsed: Span) -> Result<(), SoundError> {
        let Some(own) = self.belief.estimate else {
            return Ok(());
        };
        let taking = self.outsider.look(
            &self.settings.external,
            response,
            &mut self.likelihood,
            own.mean,
            &mut self.belief.generator,
        )?;
        let Some(Taking { is_elsewhere, time_s }) = taking else {
            return Ok(());
        };
        // A counter over consecutive frames: the external has no memory of its own (erratum 13).
        self.belief.apart_s = if is_elsewhere {
            self.belief.apart_s + elapsed.seconds()
        } else {
            0.0
        };
        if is_elsewhere && self.belief.apart_s >= time_s {
            self.belief.apart_s = 0.0;
            self.belief.takeovers += 1;
            self.outsider
                .hand_over(&mut self.belief.particles, &mut self.belief.generator)?;
            keep_inside(&mut self.belief.particles, &self.bounds);
            self.weigh(response)?;
        }
        Ok(())
    }
}

/// Weighted mean and covariance of the positions.
fn estimate(particles: &Particles) -> PointEstimate {
    let mean = Vector3::from_fn(|axis, _| particles.mean_of(axis));
    let covariance =
        Matrix3::from_fn(|row, column| particles.covariance_of(row.min(column), row.max(column)));
    PointEstimate {
        mean: WorldPoint(mean.into()),
        covariance,
    }
}

/// Stops particles at the walls.
fn keep_inside(particles: &mut Particles, bounds: &Bounds) {
    for axis in 0..3 {
        let [low, high] = [bounds.low_m[axis], bounds.high_m[axis]].map(|value| value as f32);
        for value in particles.column_mut(axis) {
            // Not a number stays one, to be set aside and counted.
            *value = if value.is_nan() {
                *value
            } else {
                value.clamp(low, high)
            };
        }
    }
}

#[cfg(test)]
mod tests;
