//! How far off the directions of tracks are, seen from one place, as an array hears them.

use super::{Better, Counts, Family, JudgeError, MetricInfo, Unit, metric, ratio};
use crate::case::Case;
use crate::events::Event;
use crate::measure::Measure;
use crate::sequence::Sequence;

/// The family.
pub struct Azimuth;

/// What is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AzimuthCounts {
    /// Sum of the absolute errors, radians.
    pub absolute_rad: f64,
    /// Sum of the squared errors, square radians.
    pub squared: f64,
    /// Pairs.
    pub pairs: u64,
}

/// Sums up the errors of the azimuths of pairs seen from a place, x and y in metres; the short way round.
pub fn azimuth_error(sequence: &Sequence, events: &[Event], from_m: [f64; 2]) -> AzimuthCounts {
    let azimuth = |point: [f64; 3]| libm::atan2(point[1] - from_m[1], point[0] - from_m[0]);
    let mut counts = AzimuthCounts::default();
    for pair in events.iter().filter_map(Event::pair) {
        let truth = azimuth(sequence.truth()[pair.truth].place.coordinates());
        let track = azimuth(sequence.tracks()[pair.track].place.coordinates());
        let turn = std::f64::consts::TAU;
        let apart = (track - truth).rem_euclid(turn);
        let error = apart.min(turn - apart);
        counts.absolute_rad += error;
        counts.squared += error * error;
        counts.pairs += 1;
    }
    counts
}

impl Counts for AzimuthCounts {
    fn add(&mut self, other: &Self) {
        self.absolute_rad += other.absolute_rad;
        self.squared += other.squared;
        self.pairs += other.pairs;
    }

    fn values(&self) -> Vec<Option<f64>> {
        let pairs = self.pairs as f64;
        vec![
            ratio(self.absolute_rad, pairs).map(f64::to_degrees),
            ratio(self.squared, pairs).map(|mean| libm::sqrt(mean).to_degrees()),
        ]
    }
}

impl Family for Azimuth {
    type Counts = AzimuthCounts;
    const NAME: &'static str = "Azimuth";
    const SOURCE: &'static str = "error of the direction of pairs, seen from --azimuth-from";
    const METRICS: &'static [MetricInfo] = &[
        metric(
            "azimuth_mae",
            Unit::Degrees,
            [0.0, 180.0],
            Better::Down,
            "Mean absolute error of the direction of pairs, seen from the place given.",
        ),
        metric(
            "azimuth_rmse",
            Unit::Degrees,
            [0.0, 180.0],
            Better::Down,
            "Root mean square of the same error.",
        ),
    ];

    fn count(case: &Case) -> Result<Option<AzimuthCounts>, JudgeError> {
        let applies = !case.sequence.is_empty() && case.sequence.measure() == Measure::Metres;
        let from_m = case.azimuth_from_m.filter(|_| applies);
        Ok(from_m.map(|from_m| azimuth_error(&case.sequence, &case.events, from_m)))
    }
}
