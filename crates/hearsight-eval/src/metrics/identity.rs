//! Identity: how well one track serves one person over the whole sequence.
//!
//! Ristani, Solera, Zou, Cucchiara and Tomasi, "Performance measures and a data set for multi-target, multi-camera
//! tracking", 2016. Numbers are those of motmetrics; TrackEval's are the same but for overlaps that equal the gate.

use super::pairs::PairNumbers;
use super::{Better, Counts, Family, JudgeError, MetricInfo, NOT_NEGATIVE, UNIT_RANGE, Unit, metric, ratio};
use crate::case::Case;
use crate::matching::{Aim, Edge, Matcher};
use crate::sequence::{Sequence, SequenceError};

/// The family.
pub struct Identity;

/// What is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IdentityCounts {
    /// People within the gate of their own track, summed over frames.
    pub true_positives: u64,
    /// Tracks that are not, summed over frames.
    pub false_positives: u64,
    /// People that are not, summed over frames.
    pub false_negatives: u64,
}

/// The one track of each person that serves best overall.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OwnTracks {
    /// By person; none for whom no track serves.
    pub track_of_person: Vec<Option<u32>>,
    /// What was counted with it.
    pub counts: IdentityCounts,
}

/// Gives each person at most one track, and each track at most one person, so that they are within the gate of each
/// other in as many frames as possible.
///
/// # Errors
/// [`SequenceError::TooLarge`].
pub fn own_tracks(sequence: &Sequence) -> Result<OwnTracks, SequenceError> {
    let mut numbers = PairNumbers::new(sequence.person_count());
    let mut frames_together: Vec<u64> = Vec::new();
    let gate = sequence.gate();
    for frame in sequence.frames() {
        for (person, track, _) in frame.near(|distance| distance <= gate) {
            let number = numbers.number(frame.truth[person].who, frame.tracks[track].who);
            frames_together.resize(numbers.len(), 0);
            frames_together[number] += 1;
        }
    }
    let edges: Vec<Edge> = numbers
        .iter()
        .map(|(row, column, number)| Edge {
            row,
            column,
            cost: -(frames_together[number] as f64),
        })
        .collect();
    let mut pairs = Vec::new();
    let (people, tracks) = (sequence.person_count(), sequence.track_count());
    Matcher::default().pair(people, tracks, &edges, Aim::Least, &mut pairs)?;
    let mut track_of_person = vec![None; people];
    let mut true_positives = 0;
    for (person, track) in pairs {
        track_of_person[person as usize] = Some(track);
        true_positives += numbers
            .known(person, track)
            .map_or(0, |number| frames_together[number]);
    }
    Ok(OwnTracks {
        track_of_person,
        counts: IdentityCounts {
            true_positives,
            false_positives: sequence.tracks().len() as u64 - true_positives,
            false_negatives: sequence.truth().len() as u64 - true_positives,
        },
    })
}

impl IdentityCounts {
    /// 2 IDTP / (people + tracks), 0 to 1.
    pub fn idf1(&self) -> Option<f64> {
        let all = 2 * self.true_positives + self.false_positives + self.false_negatives;
        ratio((2 * self.true_positives) as f64, all as f64)
    }
}

impl Counts for IdentityCounts {
    fn add(&mut self, other: &Self) {
        self.true_positives += other.true_positives;
        self.false_positives += other.false_positives;
        self.false_negatives += other.false_negatives;
    }

    fn values(&self) -> Vec<Option<f64>> {
        let true_positives = self.true_positives as f64;
        vec![
            self.idf1(),
            ratio(
                true_positives,
                (self.true_positives + self.false_positives) as f64,
            ),
            ratio(
                true_positives,
                (self.true_positives + self.false_negatives) as f64,
            ),
            Some(true_positives),
            Some(self.false_positives as f64),
            Some(self.false_negatives as f64),
        ]
    }
}

const fn count(name: &'static str, better: Better, meaning: &'static str) -> MetricInfo {
    metric(name, Unit::Count, NOT_NEGATIVE, better, meaning)
}

impl Family for Identity {
    type Counts = IdentityCounts;
    const NAME: &'static str = "Identity";
    const SOURCE: &'static str = "Ristani et al. 2016; numbers as motmetrics";
    const METRICS: &'static [MetricInfo] = &[
        metric(
            "idf1",
            Unit::Ratio,
            UNIT_RANGE,
            Better::Up,
            "Harmonic mean of idp and idr.",
        ),
        metric(
            "idp",
            Unit::Ratio,
            UNIT_RANGE,
            Better::Up,
            "Part of the tracks that are a person's own.",
        ),
        metric(
            "idr",
            Unit::Ratio,
            UNIT_RANGE,
            Better::Up,
            "Part of the people that have their own track.",
        ),
        count(
            "idtp",
            Better::Up,
            "People with their own track, summed over frames.",
        ),
        count(
            "idfp",
            Better::Down,
            "Tracks that are nobody's own, summed over frames.",
        ),
        count(
            "idfn",
            Better::Down,
            "People without their own track, summed over frames.",
        ),
    ];

    fn count(case: &Case) -> Result<Option<IdentityCounts>, JudgeError> {
        if case.sequence.is_empty() {
            return Ok(None);
        }
        Ok(Some(own_tracks(&case.sequence)?.counts))
    }
}
