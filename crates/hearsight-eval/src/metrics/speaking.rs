//! Whether the right person is marked as speaking, frame by frame.
//!
//! A person who speaks is found where their track of the event log is marked. A mark on a track without a person, or whose
//! person is silent, is wrong.

use super::{Better, Counts, Family, JudgeError, MetricInfo, NOT_NEGATIVE, UNIT_RANGE, Unit, metric, ratio};
use crate::case::Case;
use crate::events::Event;
use crate::sequence::{Sequence, Sighting};

/// The family.
pub struct Speaking;

/// What is counted, each a person or track and a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SpeakingCounts {
    /// People who speak and are marked.
    pub right: u64,
    /// Marks on those who are silent, or on nobody.
    pub wrong: u64,
    /// People who speak and are not marked.
    pub missed: u64,
}

/// Somebody of whom it is known whether they speak, and what the result says of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Trial {
    /// Whether a person speaks; false for a track without a person.
    pub(crate) speaks: bool,
    /// Whether there is a track, and whether it is marked.
    pub(crate) marked: Option<bool>,
    /// Probability of speaking that the track has.
    pub(crate) probability: Option<f64>,
}

/// Everyone of whom it is known whether they speak, frame by frame.
pub(crate) fn trials<'a>(sequence: &'a Sequence, events: &'a [Event]) -> impl Iterator<Item = Trial> + 'a {
    events.iter().filter_map(|event| {
        let (person, track): (Option<&Sighting>, Option<&Sighting>) = match event {
            Event::Match(pair) | Event::Switch(pair) => (
                Some(&sequence.truth()[pair.truth]),
                Some(&sequence.tracks()[pair.track]),
            ),
            Event::Miss { truth, .. } => (Some(&sequence.truth()[*truth]), None),
            Event::FalsePositive { track, .. } => (None, Some(&sequence.tracks()[*track])),
        };
        Some(Trial {
            speaks: person.map_or(Some(false), |person| person.speaking)?,
            marked: track.and_then(|track| track.speaking),
            probability: track.and_then(|track| track.speaking_probability),
        })
    })
}

/// Whether the truth says who speaks.
pub(crate) fn is_known(sequence: &Sequence) -> bool {
    sequence.truth().iter().any(|person| person.speaking.is_some())
}

/// Counts in a sequence.
pub fn speaking(sequence: &Sequence, events: &[Event]) -> SpeakingCounts {
    let mut counts = SpeakingCounts::default();
    for trial in trials(sequence, events) {
        match (trial.speaks, trial.marked.unwrap_or(false)) {
            (true, true) => counts.right += 1,
            (false, true) => counts.wrong += 1,
            (true, false) => counts.missed += 1,
            (false, false) => {}
        }
    }
    counts
}

impl Counts for SpeakingCounts {
    fn add(&mut self, other: &Self) {
        self.right += other.right;
        self.wrong += other.wrong;
        self.missed += other.missed;
    }

    fn values(&self) -> Vec<Option<f64>> {
        let right = self.right as f64;
        vec![
            ratio(right, (self.right + self.wrong) as f64),
            ratio(right, (self.right + self.missed) as f64),
            ratio(2.0 * right, (2 * self.right + self.wrong + self.missed) as f64),
            Some(right),
            Some(self.wrong as f64),
            Some(self.missed as f64),
        ]
    }
}

const fn count(name: &'static str, better: Better, meaning: &'static str) -> MetricInfo {
    metric(name, Unit::Count, NOT_NEGATIVE, better, meaning)
}

const fn part(name: &'static str, meaning: &'static str) -> MetricInfo {
    metric(name, Unit::Ratio, UNIT_RANGE, Better::Up, meaning)
}

impl Family for Speaking {
    type Counts = SpeakingCounts;
    const NAME: &'static str = "Active speaker";
    const SOURCE: &'static str = "marks of the tracks of pairs, frame by frame";
    const METRICS: &'static [MetricInfo] = &[
        part(
            "speaking_precision",
            "Part of the marks that are on someone who speaks.",
        ),
        part("speaking_recall", "Part of those who speak that are marked."),
        part("speaking_f1", "Harmonic mean of the two."),
        count(
            "speaking_tp",
            Better::Up,
            "People who speak and are marked, summed over frames.",
        ),
        count(
            "speaking_fp",
            Better::Down,
            "Marks on the silent or on nobody, summed over frames.",
        ),
        count(
            "speaking_fn",
            Better::Down,
            "People who speak and are not marked, summed over frames.",
        ),
    ];

    fn count(case: &Case) -> Result<Option<SpeakingCounts>, JudgeError> {
        let tracks = case.sequence.tracks();
        let result_says = tracks.is_empty() || tracks.iter().any(|track| track.speaking.is_some());
        Ok((is_known(&case.sequence) && result_says).then(|| speaking(&case.sequence, &case.events)))
    }
}
