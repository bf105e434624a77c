//! The equal-error point of the probabilities of speaking: the threshold at which as large a part of the silent is taken
//! for speaking as of those who speak is missed.
//!
//! Between thresholds that occur the two rates are taken as linear, as scikit-learn's curve with linear interpolation.
//! A person without a track has the probability 0; so have tracks that give none.

use super::speaking::{is_known, trials};
use super::{Better, Counts, Family, JudgeError, MetricInfo, UNIT_RANGE, Unit, metric};
use crate::case::Case;

/// The family.
pub struct EqualError;

/// What is counted: the probabilities themselves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EqualErrorCounts {
    /// Of everyone who speaks, frame by frame.
    pub speaking: Vec<f64>,
    /// Of everyone who is silent, and of tracks without a person.
    pub silent: Vec<f64>,
}

/// Where both errors are equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EqualErrorPoint {
    /// The rate of both errors, 0 to 1.
    pub rate: f64,
    /// The threshold: at or above it someone is taken to speak.
    pub threshold: f64,
}

impl EqualErrorCounts {
    /// Where both errors are equal; none where nobody speaks or nobody is silent.
    pub fn point(&self) -> Option<EqualErrorPoint> {
        if self.speaking.is_empty() || self.silent.is_empty() {
            return None;
        }
        let mut scores: Vec<(f64, bool)> = self.speaking.iter().map(|&score| (score, true)).collect();
        scores.extend(self.silent.iter().map(|&score| (score, false)));
        scores.sort_by(|one, other| other.0.total_cmp(&one.0));
        let (speaking, silent) = (self.speaking.len() as f64, self.silent.len() as f64);
        // From the threshold above all on: nobody is taken to speak.
        let (mut false_alarm, mut missed) = (0.0, 1.0);
        let mut threshold = f64::INFINITY;
        let (mut taken, mut alarmed) = (0.0, 0.0);
        for group in scores.chunk_by(|one, other| one.0 == other.0) {
            for &(_, speaks) in group {
                if speaks {
                    taken += 1.0;
                } else {
                    alarmed += 1.0;
                }
            }
            let (next_alarm, next_missed) = (alarmed / silent, 1.0 - taken / speaking);
            if next_alarm >= next_missed {
                let (before, after) = (missed - false_alarm, next_alarm - next_missed);
                let part = if before + after > 0.0 {
                    before / (before + after)
                } else {
                    0.0
                };
                let score = group[0].0;
                return Some(EqualErrorPoint {
                    rate: false_alarm + part * (next_alarm - false_alarm),
                    threshold: if threshold.is_finite() {
                        threshold + part * (score - threshold)
                    } else {
                        score
                    },
                });
            }
            (false_alarm, missed, threshold) = (next_alarm, next_missed, group[0].0);
        }
        None
    }
}

impl Counts for EqualErrorCounts {
    fn add(&mut self, other: &Self) {
        self.speaking.extend_from_slice(&other.speaking);
        self.silent.extend_from_slice(&other.silent);
    }

    fn values(&self) -> Vec<Option<f64>> {
        let point = self.point();
        vec![point.map(|point| point.rate), point.map(|point| point.threshold)]
    }
}

impl Family for EqualError {
    type Counts = EqualErrorCounts;
    const NAME: &'static str = "Equal error";
    const SOURCE: &'static str = "probabilities of speaking; interpolated as scikit-learn's curve";
    const METRICS: &'static [MetricInfo] = &[
        metric(
            "speaking_eer",
            Unit::Ratio,
            UNIT_RANGE,
            Better::Down,
            "Rate of false alarms and of misses where both are equal.",
        ),
        metric(
            "speaking_eer_threshold",
            Unit::Ratio,
            UNIT_RANGE,
            Better::Neither,
            "The probability at which they are equal.",
        ),
    ];

    fn count(case: &Case) -> Result<Option<EqualErrorCounts>, JudgeError> {
        let gives = |track: &crate::sequence::Sighting| track.speaking_probability.is_some();
        if !is_known(&case.sequence) || !case.sequence.tracks().iter().any(gives) {
            return Ok(None);
        }
        let mut counts = EqualErrorCounts::default();
        for trial in trials(&case.sequence, &case.events) {
            let side = if trial.speaks {
                &mut counts.speaking
            } else {
                &mut counts.silent
            };
            side.push(trial.probability.unwrap_or(0.0));
        }
        Ok(Some(counts))
    }
}
