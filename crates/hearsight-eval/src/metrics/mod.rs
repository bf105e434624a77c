//! The metrics: families of them, each counted from a case, added up over cases, and only then turned into values.
//!
//! A family is a file here and a line in [`FAMILIES`]. It counts what can be added ([`Family::count`]), so that many
//! sequences give what one long one would, and it describes its metrics: tables, help and tests are made from that.

pub mod azimuth;
pub mod calibration;
pub mod clear;
pub mod diarization;
pub mod equal_error;
pub mod gospa;
pub mod hota;
pub mod identification;
pub mod identity;
pub mod jaccard;
pub mod ospa;
pub mod place;
pub mod speaking;

mod pairs;

use crate::case::Case;
use crate::measure::Measure;
use crate::sequence::SequenceError;
use crate::speech::TooManyTurns;
use thiserror::Error;

/// Every family of metrics, in the order of the table.
pub const FAMILIES: &[&dyn Judge] = &[
    &clear::Clear,
    &identity::Identity,
    &hota::Hota,
    &ospa::Ospa,
    &gospa::Gospa,
    &place::PlaceError,
    &azimuth::Azimuth,
    &speaking::Speaking,
    &equal_error::EqualError,
    &diarization::Diarization,
    &jaccard::Jaccard,
    &identification::Identification,
    &calibration::SpeakingCalibration,
    &calibration::ExistenceCalibration,
];

/// What a metric is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetricInfo {
    /// Its name, as the source spells it.
    pub name: &'static str,
    /// One sentence.
    pub meaning: &'static str,
    /// What it is measured in.
    pub unit: Unit,
    /// Least and largest value.
    pub range: [f64; 2],
    /// Which values are better.
    pub better: Better,
}

/// The unit of a metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A ratio or probability.
    Ratio,
    /// A number of things.
    Count,
    /// That of distances: none for overlaps, pixels or metres.
    Distance,
    /// That of places: pixels or metres.
    Place,
    /// That of distances, to the power of the metric's order.
    DistanceToOrder,
    /// Seconds.
    Seconds,
    /// Degrees.
    Degrees,
}

impl Unit {
    /// Its name where distances are of a measure; empty for ratios and counts.
    pub fn name(self, measure: Measure) -> &'static str {
        match (self, measure) {
            (Self::Place, Measure::Overlap) => Measure::Pixels.unit(),
            (Self::Distance | Self::Place, measure) => measure.unit(),
            (Self::DistanceToOrder, Measure::Pixels) => "px\u{b2}",
            (Self::DistanceToOrder, Measure::Metres) => "m\u{b2}",
            (Self::Seconds, _) => "s",
            (Self::Degrees, _) => "\u{b0}",
            (Self::Ratio | Self::Count | Self::DistanceToOrder, _) => "",
        }
    }
}

/// Which values of a metric are better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// Larger ones.
    Up,
    /// Smaller ones.
    Down,
    /// Neither: it says what the others were counted from.
    Neither,
}

/// Why a case cannot be judged.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum JudgeError {
    /// People and places.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// Speech.
    #[error(transparent)]
    Speech(#[from] TooManyTurns),
}

/// What can be added up over cases.
pub trait Counts: Clone {
    /// Adds what was counted in another case.
    fn add(&mut self, other: &Self);
    /// The values, in the order of [`Family::METRICS`]; none where a value is not defined.
    fn values(&self) -> Vec<Option<f64>>;
}

/// A family of metrics that are counted together.
pub trait Family {
    /// What is counted.
    type Counts: Counts;
    /// Name for the table.
    const NAME: &'static str;
    /// Where the metrics are defined, and whose numbers they are.
    const SOURCE: &'static str;
    /// The metrics, in the order of their values.
    const METRICS: &'static [MetricInfo];
    /// Counts in one case; none where the case lacks what the family needs.
    ///
    /// # Errors
    /// [`JudgeError`], for cases that are too large.
    fn count(case: &Case) -> Result<Option<Self::Counts>, JudgeError>;
}

/// The values of a family.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// Of each case, in order; none where the family does not apply.
    pub of_each: Vec<Option<Vec<Option<f64>>>>,
    /// Of all cases together, from the sums of what was counted.
    pub overall: Vec<Option<f64>>,
}

/// A [`Family`] whatever it counts.
pub trait Judge: Sync {
    /// [`Family::NAME`].
    fn name(&self) -> &'static str;
    /// [`Family::SOURCE`].
    fn source(&self) -> &'static str;
    /// [`Family::METRICS`].
    fn metrics(&self) -> &'static [MetricInfo];
    /// The values of cases and of all together; none where the family applies to no case.
    ///
    /// # Errors
    /// [`JudgeError`], for cases that are too large.
    fn judge(&self, cases: &[Case]) -> Result<Option<Judged>, JudgeError>;
}

impl<F: Family + Sync> Judge for F {
    fn name(&self) -> &'static str {
        F::NAME
    }

    fn source(&self) -> &'static str {
        F::SOURCE
    }

    fn metrics(&self) -> &'static [MetricInfo] {
        F::METRICS
    }

    fn judge(&self, cases: &[Case]) -> Result<Option<Judged>, JudgeError> {
        let mut sum: Option<F::Counts> = None;
        let mut of_each = Vec::with_capacity(cases.len());
        for case in cases {
            let counts = F::count(case)?;
            if let Some(counts) = &counts {
                match &mut sum {
                    Some(sum) => sum.add(counts),
                    None => sum = Some(counts.clone()),
                }
            }
            of_each.push(counts.map(|counts| counts.values()));
        }
        Ok(sum.map(|sum| Judged {
            of_each,
            overall: sum.values(),
        }))
    }
}

/// A quotient; none where there is nothing to divide by.
fn ratio(numerator: f64, denominator: f64) -> Option<f64> {
    (denominator > 0.0).then(|| numerator / denominator)
}

/// A metric; `better` and `range` as in [`MetricInfo`].
const fn metric(
    name: &'static str,
    unit: Unit,
    range: [f64; 2],
    better: Better,
    meaning: &'static str,
) -> MetricInfo {
    MetricInfo {
        name,
        meaning,
        unit,
        range,
        better,
    }
}

/// The range of a ratio.
const UNIT_RANGE: [f64; 2] = [0.0, 1.0];
/// The range of what cannot be negative.
const NOT_NEGATIVE: [f64; 2] = [0.0, f64::INFINITY];
