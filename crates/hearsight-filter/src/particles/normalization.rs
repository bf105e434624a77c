//! Making weights sum to one, and setting aside what is not finite.

use super::Particles;
use crate::elementary;
use crate::log_sum_exp::exponentiate;
use serde::{Deserialize, Serialize};

/// What [`Particles::normalize`] found.
#[must_use = "a reset or lost belief must be reported"]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Normalization {
    /// What became of the weights.
    pub outcome: NormalizationOutcome,
    /// The logarithm of the sum of the weights before: if they were normalized when log-likelihoods were added, the
    /// log-likelihood of all the observations. Negative infinity if none was positive.
    pub log_evidence: f64,
    /// `1 / sum(weight^2)` of the normalized weights, from 1 to the number of particles.
    pub effective_sample_size: f64,
    /// How many particles had a non-finite state, or a weight of NaN or infinity, and were set aside this time.
    pub quarantined: usize,
}

/// What became of the weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NormalizationOutcome {
    /// They sum to one.
    Normalized,
    /// All were zero: they are uniform now, the observation taught nothing.
    Reset,
    /// No state was finite: states are zero and weights uniform. The owner must draw the particles anew.
    Lost,
}

impl Particles {
    /// Sets aside what is not finite and makes the weights sum to one.
    ///
    /// A particle with a non-finite state, or a weight of NaN or infinity, gets weight zero and the state of the
    /// heaviest healthy particle, and is counted. If then no weight is positive, all are made equal: see
    /// [`NormalizationOutcome`].
    pub fn normalize(&mut self) -> Normalization {
        let finite = self.columns.iter().all(|column| elementary::all_finite(column));
        let (quarantined, lost) = if finite && all_below_infinity(&self.log_weights) {
            (0, false)
        } else {
            self.quarantine()
        };
        let (shift, sum) = exponentiate(&self.log_weights, &mut self.weights);
        if shift == f64::NEG_INFINITY {
            self.make_uniform();
            return Normalization {
                outcome: if lost {
                    NormalizationOutcome::Lost
                } else {
                    NormalizationOutcome::Reset
                },
                log_evidence: shift,
                effective_sample_size: self.count() as f64,
                quarantined,
            };
        }
        let log_evidence = shift + elementary::ln(sum);
        let scale = 1.0 / sum;
        for (weight, log_weight) in self.weights.iter_mut().zip(&mut self.log_weights) {
            *weight *= scale;
            *log_weight -= log_evidence;
        }
        Normalization {
            outcome: NormalizationOutcome::Normalized,
            log_evidence,
            effective_sample_size: self.effective_sample_size(),
            quarantined,
        }
    }

    /// Sets aside particles with a non-finite state or a weight of NaN or infinity; returns how many, and whether no
    /// state was finite.
    #[cold]
    fn quarantine(&mut self) -> (usize, bool) {
        let finite =
            |columns: &[Vec<f32>], particle: usize| columns.iter().all(|column| column[particle].is_finite());
        // The heaviest particle with a finite state, or, if its weight is bad as well, any with a finite state.
        let rank = |log_weight: f64| {
            if log_weight < f64::INFINITY {
                log_weight
            } else {
                f64::NEG_INFINITY
            }
        };
        let donor = (0..self.count())
            .filter(|particle| finite(&self.columns, *particle))
            .max_by(|a, b| rank(self.log_weights[*a]).total_cmp(&rank(self.log_weights[*b])));
        let mut quarantined = 0;
        for particle in 0..self.count() {
            let bad_state = !finite(&self.columns, particle);
            if bad_state {
                for column in &mut self.columns {
                    column[particle] = donor.map_or(0.0, |donor| column[donor]);
                }
            }
            if bad_state || !all_below_infinity(&self.log_weights[particle..=particle]) {
                self.log_weights[particle] = f64::NEG_INFINITY;
                quarantined += 1;
            }
        }
        (quarantined, donor.is_none())
    }
}

/// Whether no weight is NaN or infinity; zero weights (negative infinity) are in order.
fn all_below_infinity(log_weights: &[f64]) -> bool {
    elementary::sum_of(log_weights, |value| if value < f64::INFINITY { 0.0 } else { 1.0 }) == 0.0
}
