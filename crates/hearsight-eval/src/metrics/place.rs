//! How far off tracks are, coordinate by coordinate: root mean square over the pairs of the event log.

use super::{Better, Counts, Family, JudgeError, MetricInfo, NOT_NEGATIVE, Unit, metric, ratio};
use crate::case::Case;
use crate::events::Event;
use crate::measure::Measure;
use crate::sequence::Sequence;

/// The family.
pub struct PlaceError;

/// What is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaceCounts {
    /// Sums of the squared errors of each coordinate: metres, or pixels and zero.
    pub squares: [f64; 3],
    /// Pairs.
    pub pairs: u64,
    /// Whether there is a third coordinate.
    pub has_depth: bool,
}

/// Sums up the errors of pairs.
pub fn place_error(sequence: &Sequence, events: &[Event]) -> PlaceCounts {
    let mut counts = PlaceCounts {
        has_depth: sequence.measure() == Measure::Metres,
        ..PlaceCounts::default()
    };
    for pair in events.iter().filter_map(Event::pair) {
        let truth = sequence.truth()[pair.truth].place.coordinates();
        let track = sequence.tracks()[pair.track].place.coordinates();
        for axis in 0..3 {
            counts.squares[axis] += (track[axis] - truth[axis]).powi(2);
        }
        counts.pairs += 1;
    }
    counts
}

impl Counts for PlaceCounts {
    fn add(&mut self, other: &Self) {
        for axis in 0..3 {
            self.squares[axis] += other.squares[axis];
        }
        self.pairs += other.pairs;
        self.has_depth |= other.has_depth;
    }

    fn values(&self) -> Vec<Option<f64>> {
        let root = |sum: f64| ratio(sum, self.pairs as f64).map(libm::sqrt);
        let [x, y, z] = self.squares;
        vec![
            root(x),
            root(y),
            root(z).filter(|_| self.has_depth),
            root(x + y + z),
        ]
    }
}

/// A metric whose unit is that of places, also where pairs are found by overlap.
const fn error(name: &'static str, meaning: &'static str) -> MetricInfo {
    metric(name, Unit::Place, NOT_NEGATIVE, Better::Down, meaning)
}

impl Family for PlaceError {
    type Counts = PlaceCounts;
    const NAME: &'static str = "Place";
    const SOURCE: &'static str = "root mean square error of pairs";
    const METRICS: &'static [MetricInfo] = &[
        error(
            "rmse_x",
            "Error of pairs along x, or of columns; of boxes at half the width, 3/4 of the height.",
        ),
        error("rmse_y", "Error of pairs along y, or of rows."),
        error("rmse_z", "Error of pairs along z."),
        error("rmse", "Error of pairs in all coordinates together."),
    ];

    fn count(case: &Case) -> Result<Option<PlaceCounts>, JudgeError> {
        Ok((!case.sequence.is_empty()).then(|| place_error(&case.sequence, &case.events)))
    }
}
