//! Whether probabilities mean what they say: of all that is said with probability 0.7, seven in ten should be so.
//!
//! Expected calibration error after Naeini, Cooper and Hauskrecht, "Obtaining well calibrated probabilities using Bayesian
//! binning", 2015, with ten bins of equal width.

use super::speaking::{is_known, trials};
use super::{Better, Counts, Family, JudgeError, MetricInfo, UNIT_RANGE, Unit, metric, ratio};
use crate::case::Case;
use crate::events::Event;

/// Bins of a reliability diagram.
pub const BINS: usize = 10;

/// What is counted: the bins of a reliability diagram.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reliability {
    /// How often something was said with a probability in each bin.
    pub count: [u64; BINS],
    /// How often it was so.
    pub happened: [u64; BINS],
    /// Sum of the probabilities.
    pub probability: [f64; BINS],
    /// Sum of the squares of probability less what was so, 0 or 1.
    pub squares: f64,
}

impl Reliability {
    /// Counts what was said with a probability. What is outside 0 to 1 or no number is left out.
    pub fn push(&mut self, probability: f64, happened: bool) {
        if !(0.0..=1.0).contains(&probability) {
            return;
        }
        let bin = ((probability * BINS as f64) as usize).min(BINS - 1);
        self.count[bin] += 1;
        self.happened[bin] += u64::from(happened);
        self.probability[bin] += probability;
        self.squares += (probability - f64::from(happened)).powi(2);
    }

    /// Mean probability, part that was so, and count of each bin; none for empty ones.
    pub fn bins(&self) -> [Option<(f64, f64, u64)>; BINS] {
        std::array::from_fn(|bin| {
            let count = self.count[bin] as f64;
            let mean = ratio(self.probability[bin], count)?;
            Some((mean, self.happened[bin] as f64 / count, self.count[bin]))
        })
    }

    /// Expected calibration error, 0 to 1: the mean distance of both, weighted by count.
    pub fn expected_error(&self) -> Option<f64> {
        let total: u64 = self.count.iter().sum();
        let bins = self.bins();
        let sum: f64 = bins
            .iter()
            .flatten()
            .map(|(mean, part, count)| (mean - part).abs() * *count as f64)
            .sum();
        ratio(sum, total as f64)
    }

    /// Mean squared error of the probabilities (Brier 1950), 0 to 1.
    pub fn brier(&self) -> Option<f64> {
        ratio(self.squares, self.count.iter().sum::<u64>() as f64)
    }
}

impl Counts for Reliability {
    fn add(&mut self, other: &Self) {
        for bin in 0..BINS {
            self.count[bin] += other.count[bin];
            self.happened[bin] += other.happened[bin];
            self.probability[bin] += other.probability[bin];
        }
        self.squares += other.squares;
    }

    fn values(&self) -> Vec<Option<f64>> {
        vec![self.expected_error(), self.brier()]
    }
}

/// Probabilities of speaking, beside whether the track's person speaks.
pub struct SpeakingCalibration;

/// Probabilities of existence, beside whether the track has a person.
pub struct ExistenceCalibration;

const fn error(name: &'static str, meaning: &'static str) -> MetricInfo {
    metric(name, Unit::Ratio, UNIT_RANGE, Better::Down, meaning)
}

impl Family for SpeakingCalibration {
    type Counts = Reliability;
    const NAME: &'static str = "Calibration of speaking";
    const SOURCE: &'static str = "Naeini, Cooper and Hauskrecht 2015; ten bins";
    const METRICS: &'static [MetricInfo] = &[
        error(
            "speaking_ece",
            "Expected calibration error of the probabilities of speaking.",
        ),
        error(
            "speaking_brier",
            "Mean squared error of the probabilities of speaking.",
        ),
    ];

    fn count(case: &Case) -> Result<Option<Reliability>, JudgeError> {
        if !is_known(&case.sequence) {
            return Ok(None);
        }
        let mut counts = Reliability::default();
        for trial in trials(&case.sequence, &case.events) {
            if let Some(probability) = trial.probability {
                counts.push(probability, trial.speaks);
            }
        }
        Ok(any(counts))
    }
}

impl Family for ExistenceCalibration {
    type Counts = Reliability;
    const NAME: &'static str = "Calibration of existence";
    const SOURCE: &'static str = "Naeini, Cooper and Hauskrecht 2015; ten bins";
    const METRICS: &'static [MetricInfo] = &[
        error(
            "existence_ece",
            "Expected calibration error of the probabilities of existence.",
        ),
        error(
            "existence_brier",
            "Mean squared error of the probabilities of existence.",
        ),
    ];

    fn count(case: &Case) -> Result<Option<Reliability>, JudgeError> {
        let mut counts = Reliability::default();
        for event in &case.events {
            let (track, happened) = match event {
                Event::Match(pair) | Event::Switch(pair) => (pair.track, true),
                Event::FalsePositive { track, .. } => (*track, false),
                Event::Miss { .. } => continue,
            };
            if let Some(probability) = case.sequence.tracks()[track].existence {
                counts.push(probability, happened);
            }
        }
        Ok(any(counts))
    }
}

/// The counts, where anything was counted.
fn any(counts: Reliability) -> Option<Reliability> {
    counts.count.iter().any(|&count| count > 0).then_some(counts)
}
