//! Hypotheses of one person: what is predicted, where they are drawn from, their weights before anything is verified, and
//! what they say of the trackers afterwards (Chen and Rui, sections III and VI, corrected by E2 and E12).

use super::{FuserSettings, HeadMotion, TrackerKind, WeightRule};
use crate::belief::Belief;
use crate::stage::Sight;
use hearsight_filter::{
    FilterError, Gaussian, Mixture, PredictedCloud, Resampling, log_sum_exp, standard_normal,
};
use nalgebra::{Matrix1, SMatrix, SVector, Vector1};

/// Buffers of one proposal, kept until its loop is closed.
#[derive(Debug, Default)]
pub(super) struct Hypotheses {
    /// What each tracker proposes now.
    pub(super) proposed: [Option<Gaussian<3>>; 3],
    /// Where a detector saw the person now.
    pub(super) detected: Option<Gaussian<3>>,
    pub(super) mixture: Mixture<3>,
    cloud: PredictedCloud,
    /// Where each particle is carried to: places, then velocities.
    carried: [Vec<f64>; 6],
    before: Vec<f64>,
    log_proposal: Vec<f64>,
    corrections: Vec<f64>,
}

/// What was predicted of one person.
pub(super) struct Prediction {
    pub(super) places: Gaussian<3>,
    /// Velocity at the mean place, its change a pixel of place, and its deviation around that.
    velocities: [Velocity; 3],
}

#[derive(Clone, Copy, Default)]
struct Velocity {
    mean: f64,
    slope: f64,
    deviation: f64,
}

/// Smallest half height of a hypothesis, pixels.
const SMALLEST_PX: f64 = 2.0;

impl Hypotheses {
    /// Carries every particle on, and fits a Gaussian to where they come to and how fast they are there.
    pub(super) fn predict(
        &mut self,
        belief: &Belief,
        motion: &HeadMotion,
        rule: WeightRule,
    ) -> Result<Prediction, FilterError> {
        let particles = &belief.particles;
        let weights = particles.weights();
        self.before.clear();
        self.before.extend_from_slice(particles.log_weights());
        for axis in 0..3 {
            let step = &motion.axes[axis];
            let (positions, velocities) = (particles.column(axis), particles.column(axis + 3));
            self.carried[axis].clear();
            self.carried[axis].extend(
                positions
                    .iter()
                    .zip(velocities)
                    .map(|(x, v)| f64::from(*x) + step.position_from_velocity * f64::from(*v)),
            );
            self.carried[axis + 3].clear();
            self.carried[axis + 3].extend(
                velocities
                    .iter()
                    .map(|v| step.velocity_from_velocity * f64::from(*v)),
            );
        }
        let mean = |column: &[f64]| -> f64 { column.iter().zip(weights).map(|(x, w)| w * x).sum() };
        let means: [f64; 6] = std::array::from_fn(|row| mean(&self.carried[row]));
        let moment = |first: usize, second: usize| -> f64 {
            self.carried[first]
                .iter()
                .zip(&self.carried[second])
                .zip(weights)
                .map(|((x, y), w)| w * (x - means[first]) * (y - means[second]))
                .sum()
        };
        let noises = motion.axes.map(|axis| axis.covariance());
        // A hundredth of a pixel, so that a cloud that has collapsed still has a density before time has passed.
        let covariance = SMatrix::<f64, 3, 3>::from_fn(|row, column| {
            let noise = if row == column {
                noises[row][(0, 0)] + 1e-4
            } else {
                0.0
            };
            moment(row, column) + noise
        });
        let mut velocities = [Velocity::default(); 3];
        for (axis, velocity) in velocities.iter_mut().enumerate() {
            let shared = moment(axis, axis + 3) + noises[axis][(0, 1)];
            let own = moment(axis + 3, axis + 3) + noises[axis][(1, 1)];
            let slope = shared / covariance[(axis, axis)];
            *velocity = Velocity {
                mean: means[axis + 3],
                slope,
                deviation: (own - slope * shared).max(0.0).sqrt(),
            };
        }
        if rule == WeightRule::Marginal {
            let columns = [&self.carried[0], &self.carried[1], &self.carried[2]].map(Vec::as_slice);
            let variances = [0, 1, 2].map(|axis| noises[axis][(0, 0)] + 1e-4);
            self.cloud.load(&columns, &self.before, &variances)?;
        }
        Ok(Prediction {
            places: Gaussian::new(SVector::from([means[0], means[1], means[2]]), covariance)?,
            velocities,
        })
    }

    /// CONDENSATION: resample, carry on, add noise. Weights are equal then.
    pub(super) fn draw_from_prior(
        &mut self,
        belief: &mut Belief,
        motion: &HeadMotion,
        prediction: &Prediction,
    ) -> Result<(), FilterError> {
        let Belief {
            particles, generator, ..
        } = belief;
        particles.resample(Resampling::Systematic, generator)?;
        self.log_proposal.clear();
        for particle in 0..particles.count() {
            let mut state = [0.0_f32; 6];
            for (value, from) in state.iter_mut().zip(particles.state(particle)) {
                *value = from;
            }
            let carried = motion.carry(&SVector::from(state.map(f64::from)));
            for axis in 0..3 {
                let step = &motion.axes[axis];
                let (first, second) = (standard_normal(generator), standard_normal(generator));
                let place = carried[axis] + step.shared_noise * first + step.position_noise * second;
                state[axis] = place as f32;
                state[axis + 3] = (carried[axis + 3] + step.velocity_noise * first) as f32;
            }
            state[2] = state[2].max(SMALLEST_PX as f32);
            let point = SVector::from([state[0], state[1], state[2]].map(f64::from));
            self.log_proposal.push(prediction.places.log_density(&point));
            particles.set_state(particle, &state)?;
        }
        Ok(())
    }

    pub(super) fn draw_from_mixture(
        &mut self,
        belief: &mut Belief,
        sight: &Sight<'_>,
        motion: &HeadMotion,
        prediction: &Prediction,
        settings: &FuserSettings,
    ) -> Result<(), FilterError> {
        let Belief {
            particles, generator, ..
        } = belief;
        let rule = settings.weights;
        let largest = 0.75 * sight.camera.size().1.max(8) as f64;
        self.log_proposal.clear();
        self.corrections.clear();
        for particle in 0..particles.count() {
            let Some((_, mut point)) = self.mixture.draw(generator) else {
                return Ok(());
            };
            point[2] = point[2].clamp(SMALLEST_PX, largest);
            let log_proposal = self.mixture.log_density(&point);
            let place = [point[0], point[1], point[2]];
            let (log_prior, ancestor) = match rule {
                WeightRule::Gaussian => (prediction.places.log_density(&point), None),
                WeightRule::Marginal => {
                    let log_prior = self.cloud.log_density(&place);
                    (log_prior, Some(self.cloud.draw_ancestor(&place, generator)))
                }
                WeightRule::Printed => {
                    let own = self.transition(motion, particle, &place);
                    (self.before[particle] + own, Some(particle))
                }
            };
            // A person may also have come from nowhere to where they were detected.
            let log_prior = match &self.detected {
                Some(detected) => log_sum_exp(&[
                    (1.0 - settings.shares.detected).ln() + log_prior,
                    settings.shares.detected.ln() + detected.log_density(&point),
                ]),
                None => log_prior,
            };
            let mut state = [place[0] as f32, place[1] as f32, place[2] as f32, 0.0, 0.0, 0.0];
            for axis in 0..3 {
                let velocity = match ancestor {
                    None => {
                        let velocity = &prediction.velocities[axis];
                        let offset = place[axis] - prediction.places.mean()[axis];
                        velocity.mean
                            + velocity.slope * offset
                            + velocity.deviation * standard_normal(generator)
                    }
                    Some(ancestor) => {
                        let noise = motion.axes[axis].covariance();
                        let variance = noise[(0, 0)] + 1e-4;
                        let slope = noise[(0, 1)] / variance;
                        let offset = place[axis] - self.carried[axis][ancestor];
                        let rest = (noise[(1, 1)] - slope * noise[(0, 1)]).max(0.0).sqrt();
                        self.carried[axis + 3][ancestor] + slope * offset + rest * standard_normal(generator)
                    }
                };
                // Far from all that was predicted the regression means nothing.
                let most = 3.0 * motion.speeds[axis];
                state[axis + 3] = velocity.clamp(-most, most) as f32;
            }
            self.log_proposal.push(log_proposal);
            self.corrections.push(log_prior - log_proposal);
            particles.set_state(particle, &state)?;
        }
        let _ = particles.reweight(|_, log_weights| log_weights.copy_from_slice(&self.corrections));
        Ok(())
    }

    /// The logarithm of the density with which one ancestor comes to a place.
    fn transition(&self, motion: &HeadMotion, ancestor: usize, place: &[f64; 3]) -> f64 {
        (0..3)
            .map(|axis| {
                let variance = motion.axes[axis].covariance()[(0, 0)] + 1e-4;
                let offset = place[axis] - self.carried[axis][ancestor];
                -0.5 * (offset * offset / variance + (std::f64::consts::TAU * variance).ln())
            })
            .sum()
    }

    /// Equation 25, corrected: the importance-sampling estimate of the Bhattacharyya coefficient between what is believed
    /// and what each tracker proposed. Sound is compared on the column alone.
    pub(super) fn reliabilities(&self, belief: &Belief) -> [f64; 3] {
        let particles = &belief.particles;
        let weights = particles.weights();
        let count = particles.count() as f64;
        let [x, y, half] = [0, 1, 2].map(|dimension| particles.column(dimension));
        let mut reliabilities = [0.0; 3];
        for (kind, (reliability, proposed)) in reliabilities.iter_mut().zip(&self.proposed).enumerate() {
            let Some(proposed) = proposed else { continue };
            *reliability = if kind == TrackerKind::Sound as usize {
                let believed = Gaussian::new(
                    Vector1::new(particles.mean_of(0)),
                    Matrix1::new(particles.covariance_of(0, 0).max(0.0) + 0.25),
                );
                let heard = proposed.marginal([0]);
                match (believed, heard) {
                    (Ok(believed), Ok(heard)) => believed.coefficient(&heard),
                    _ => 0.0,
                }
            } else {
                (0..particles.count())
                    .map(|particle| {
                        let point = SVector::from([x[particle], y[particle], half[particle]].map(f64::from));
                        let log_ratio = proposed.log_density(&point) - self.log_proposal[particle];
                        (weights[particle] * log_ratio.exp() / count).sqrt()
                    })
                    .sum::<f64>()
                    .clamp(0.0, 1.0)
            };
        }
        reliabilities
    }
}
