//! Optimal sub-pattern assignment: how far the set of tracks is from the set of people, instant by instant.
//!
//! Schuhmacher, Vo and Vo, "A consistent metric for performance evaluation of multi-object filters", 2008, equation 3.
//! The cut-off is the gate, the order of the table 1. Stone Soup gives the same numbers at order 1; at other orders it
//! pairs by the distances and not by their powers, which is not the least sum, so the definition is kept here.

use super::{Better, Counts, Family, JudgeError, MetricInfo, NOT_NEGATIVE, Unit, metric, ratio};
use crate::case::Case;
use crate::matching::{Aim, Edge, Matcher};
use crate::sequence::{Frame, Sequence, SequenceError};

/// The family.
pub struct Ospa;

/// The order of the table.
const ORDER: f64 = 1.0;

/// What is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OspaCounts {
    /// Sum of the distances, in the measure's unit.
    pub distance: f64,
    /// Frames with people or tracks.
    pub frames: u64,
}

/// The distance at each frame, 0 to `cutoff`, in the measure's unit; none at frames without people and tracks.
///
/// `cutoff` (c) and `order` (p, at least 1) as in the paper.
///
/// # Errors
/// [`SequenceError::TooLarge`].
pub fn ospa(sequence: &Sequence, cutoff: f64, order: f64) -> Result<Vec<Option<f64>>, SequenceError> {
    let mut pairing = Pairing::default();
    let each = sequence.frames().map(|frame| {
        let largest = frame.truth.len().max(frame.tracks.len());
        if largest == 0 {
            return Ok(None);
        }
        pairing.pair(&frame, cutoff, order)?;
        let apart = cutoff.powf(order) * (largest - pairing.pairs.len()) as f64;
        Ok(Some(((pairing.near + apart) / largest as f64).powf(1.0 / order)))
    });
    each.collect()
}

/// Pairs people and tracks so that the sum of powers of the distances is least, each at most the cut-off's.
#[derive(Default)]
pub(super) struct Pairing {
    edges: Vec<Edge>,
    matcher: Matcher,
    /// Who is paired, closer than the cut-off.
    pub(super) pairs: Vec<(u32, u32)>,
    /// The sum of the powers of their distances.
    pub(super) near: f64,
}

impl Pairing {
    pub(super) fn pair(&mut self, frame: &Frame<'_>, cutoff: f64, order: f64) -> Result<(), SequenceError> {
        let most = power(cutoff, order);
        self.edges.clear();
        let near = frame.near(|distance| distance < cutoff);
        self.edges.extend(near.map(|(person, track, distance)| Edge {
            row: person as u32,
            column: track as u32,
            cost: power(distance, order) - most,
        }));
        let (people, tracks) = (frame.truth.len(), frame.tracks.len());
        self.matcher
            .pair(people, tracks, &self.edges, Aim::Least, &mut self.pairs)?;
        let distance = |&(person, track): &(u32, u32)| frame.distance(person as usize, track as usize);
        self.near = self.pairs.iter().map(|pair| power(distance(pair), order)).sum();
        Ok(())
    }
}

/// A distance to the power of the order, which is 1 or 2 in all that is judged here.
fn power(distance: f64, order: f64) -> f64 {
    match order {
        1.0 => distance,
        2.0 => distance * distance,
        order => distance.powf(order),
    }
}

impl Counts for OspaCounts {
    fn add(&mut self, other: &Self) {
        self.distance += other.distance;
        self.frames += other.frames;
    }

    fn values(&self) -> Vec<Option<f64>> {
        vec![ratio(self.distance, self.frames as f64)]
    }
}

impl Family for Ospa {
    type Counts = OspaCounts;
    const NAME: &'static str = "OSPA";
    const SOURCE: &'static str = "Schuhmacher, Vo and Vo 2008; numbers as Stone Soup";
    const METRICS: &'static [MetricInfo] = &[metric(
        "ospa_distance",
        Unit::Distance,
        NOT_NEGATIVE,
        Better::Down,
        "Mean distance of the set of tracks from the set of people; order 1, cut off at the gate.",
    )];

    fn count(case: &Case) -> Result<Option<OspaCounts>, JudgeError> {
        if case.sequence.is_empty() {
            return Ok(None);
        }
        let distances = ospa(&case.sequence, case.sequence.gate(), ORDER)?;
        let known = distances.iter().flatten();
        Ok(Some(OspaCounts {
            distance: known.clone().sum(),
            frames: known.count() as u64,
        }))
    }
}
