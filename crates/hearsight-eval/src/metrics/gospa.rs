//! Generalized optimal sub-pattern assignment: how far the set of tracks is from the set of people, in three parts.
//!
//! Rahmathullah, García-Fernández and Svensson, "Generalized optimal sub-pattern assignment metric", 2017, with alpha = 2,
//! without a penalty for switches. The cut-off is the gate, the order of the table 2. Numbers are those of Stone Soup:
//! the parts are powers, the distance is the root of their sum.

use super::ospa::Pairing;
use super::{Better, Counts, Family, JudgeError, MetricInfo, NOT_NEGATIVE, Unit, metric, ratio};
use crate::case::Case;
use crate::sequence::{Sequence, SequenceError};

/// The family.
pub struct Gospa;

/// The order of the table.
const ORDER: f64 = 2.0;

/// The metric at one instant, or sums of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GospaParts {
    /// The distance, in the measure's unit.
    pub distance: f64,
    /// Of pairs: the sum of the powers of their distances.
    pub localisation: f64,
    /// Of people without a track: half the power of the cut-off each.
    pub missed: f64,
    /// Of tracks without a person: half the power of the cut-off each.
    pub false_tracks: f64,
}

/// What is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GospaCounts {
    /// Sums over frames.
    pub sum: GospaParts,
    /// Frames with people or tracks.
    pub frames: u64,
}

/// The metric at each frame; none at frames without people and tracks. `cutoff` (c) in the measure's unit and `order` (p,
/// at least 1) as in the paper.
///
/// # Errors
/// [`SequenceError::TooLarge`].
pub fn gospa(sequence: &Sequence, cutoff: f64, order: f64) -> Result<Vec<Option<GospaParts>>, SequenceError> {
    let mut pairing = Pairing::default();
    let each = sequence.frames().map(|frame| {
        if frame.truth.is_empty() && frame.tracks.is_empty() {
            return Ok(None);
        }
        pairing.pair(&frame, cutoff, order)?;
        let half = cutoff.powf(order) / 2.0;
        let missed = half * (frame.truth.len() - pairing.pairs.len()) as f64;
        let false_tracks = half * (frame.tracks.len() - pairing.pairs.len()) as f64;
        Ok(Some(GospaParts {
            distance: (pairing.near + missed + false_tracks).powf(1.0 / order),
            localisation: pairing.near,
            missed,
            false_tracks,
        }))
    });
    each.collect()
}

impl GospaParts {
    fn add(&mut self, other: &Self) {
        self.distance += other.distance;
        self.localisation += other.localisation;
        self.missed += other.missed;
        self.false_tracks += other.false_tracks;
    }
}

impl Counts for GospaCounts {
    fn add(&mut self, other: &Self) {
        self.sum.add(&other.sum);
        self.frames += other.frames;
    }

    fn values(&self) -> Vec<Option<f64>> {
        let mean = |sum: f64| ratio(sum, self.frames as f64);
        let GospaParts {
            distance,
            localisation,
            missed,
            false_tracks,
        } = self.sum;
        [distance, localisation, missed, false_tracks].map(mean).to_vec()
    }
}

const fn part(name: &'static str, unit: Unit, meaning: &'static str) -> MetricInfo {
    metric(name, unit, NOT_NEGATIVE, Better::Down, meaning)
}

impl Family for Gospa {
    type Counts = GospaCounts;
    const NAME: &'static str = "GOSPA";
    const SOURCE: &'static str = "Rahmathullah, García-Fernández and Svensson 2017; numbers as Stone Soup";
    const METRICS: &'static [MetricInfo] = &[
        part(
            "gospa_distance",
            Unit::Distance,
            "Mean distance of the set of tracks from the set of people; order 2, cut off at the gate.",
        ),
        part("gospa_localisation", Unit::DistanceToOrder, "Mean part of pairs."),
        part(
            "gospa_missed",
            Unit::DistanceToOrder,
            "Mean part of people without a track.",
        ),
        part(
            "gospa_false",
            Unit::DistanceToOrder,
            "Mean part of tracks without a person.",
        ),
    ];

    fn count(case: &Case) -> Result<Option<GospaCounts>, JudgeError> {
        if case.sequence.is_empty() {
            return Ok(None);
        }
        let mut counts = GospaCounts::default();
        for parts in gospa(&case.sequence, case.sequence.gate(), ORDER)?
            .iter()
            .flatten()
        {
            counts.sum.add(parts);
            counts.frames += 1;
        }
        Ok(Some(counts))
    }
}
