//! CLEAR MOT: misses, false positives, switches, and what is made of them.
//!
//! Bernardin and Stiefelhagen, "Evaluating multiple object tracking performance: the CLEAR MOT metrics", 2008. Numbers
//! are those of motmetrics: MOTP is the mean *distance* of pairs; who is tracked for at least 0.8 of their time is mostly
//! tracked. TrackEval has the mean similarity, more than 0.8, and goes on only with pairs of the frame before. Where
//! nothing is there to divide by, a value is not defined (motmetrics gives infinities).

use super::{Better, Counts, Family, JudgeError, MetricInfo, NOT_NEGATIVE, UNIT_RANGE, Unit, metric, ratio};
use crate::case::Case;
use crate::events::Event;
use crate::sequence::Sequence;

/// The family.
pub struct Clear;

/// What is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClearCounts {
    /// Frames.
    pub frames: u64,
    /// People, summed over frames.
    pub objects: u64,
    /// Tracks, summed over frames.
    pub predictions: u64,
    /// Different people.
    pub unique_objects: u64,
    /// Pairs that go on, or are the first of their person.
    pub matches: u64,
    /// Pairs with another track than before.
    pub switches: u64,
    /// People without a track.
    pub misses: u64,
    /// Tracks without a person.
    pub false_positives: u64,
    /// Sum of the distances of pairs.
    pub distance: f64,
    /// People tracked for at least 0.8 of their frames.
    pub mostly_tracked: u64,
    /// People tracked for at least 0.2 and less than 0.8 of their frames.
    pub partially_tracked: u64,
    /// People tracked for less than 0.2 of their frames.
    pub mostly_lost: u64,
    /// How often a tracked person was missed and then tracked again.
    pub fragmentations: u64,
}

/// Counts the events of a sequence.
pub fn clear(sequence: &Sequence, events: &[Event]) -> ClearCounts {
    let mut counts = ClearCounts {
        frames: sequence.len() as u64,
        objects: sequence.truth().len() as u64,
        predictions: sequence.tracks().len() as u64,
        ..ClearCounts::default()
    };
    let mut people = vec![Life::default(); sequence.person_count()];
    for event in events {
        match event {
            Event::Match(pair) | Event::Switch(pair) => {
                counts.distance += pair.distance;
                if matches!(event, Event::Match(_)) {
                    counts.matches += 1;
                } else {
                    counts.switches += 1;
                }
                people[sequence.truth()[pair.truth].who as usize].step(true);
            }
            Event::Miss { truth, .. } => {
                counts.misses += 1;
                people[sequence.truth()[*truth].who as usize].step(false);
            }
            Event::FalsePositive { .. } => counts.false_positives += 1,
        }
    }
    for life in people.iter().filter(|life| life.frames > 0) {
        counts.unique_objects += 1;
        counts.fragmentations += life.fragmentations;
        let tracked = life.tracked as f64 / life.frames as f64;
        if tracked >= 0.8 {
            counts.mostly_tracked += 1;
        } else if tracked >= 0.2 {
            counts.partially_tracked += 1;
        } else {
            counts.mostly_lost += 1;
        }
    }
    counts
}

/// What became of one person.
#[derive(Clone, Copy, Default)]
struct Life {
    frames: u64,
    tracked: u64,
    fragmentations: u64,
    missed_since_tracked: bool,
}

impl Life {
    fn step(&mut self, tracked: bool) {
        self.frames += 1;
        if tracked {
            self.fragmentations += u64::from(self.missed_since_tracked && self.tracked > 0);
            self.tracked += 1;
        }
        self.missed_since_tracked = !tracked;
    }
}

impl ClearCounts {
    /// Multiple object tracking accuracy, 1 - (misses + false positives + switches) / objects, at most 1.
    pub fn mota(&self) -> Option<f64> {
        let wrong = (self.misses + self.false_positives + self.switches) as f64;
        ratio(wrong, self.objects as f64).map(|wrong| 1.0 - wrong)
    }

    /// Multiple object tracking precision: the mean distance of pairs, in the measure's unit.
    pub fn motp(&self) -> Option<f64> {
        ratio(self.distance, self.detections() as f64)
    }

    /// Part of the people that have a track, 0 to 1.
    pub fn recall(&self) -> Option<f64> {
        ratio(self.detections() as f64, self.objects as f64)
    }

    /// Part of the tracks that have a person, 0 to 1.
    pub fn precision(&self) -> Option<f64> {
        let detections = self.detections();
        ratio(detections as f64, (detections + self.false_positives) as f64)
    }

    /// Pairs.
    pub fn detections(&self) -> u64 {
        self.matches + self.switches
    }
}

impl Counts for ClearCounts {
    fn add(&mut self, other: &Self) {
        self.frames += other.frames;
        self.objects += other.objects;
        self.predictions += other.predictions;
        self.unique_objects += other.unique_objects;
        self.matches += other.matches;
        self.switches += other.switches;
        self.misses += other.misses;
        self.false_positives += other.false_positives;
        self.distance += other.distance;
        self.mostly_tracked += other.mostly_tracked;
        self.partially_tracked += other.partially_tracked;
        self.mostly_lost += other.mostly_lost;
        self.fragmentations += other.fragmentations;
    }

    fn values(&self) -> Vec<Option<f64>> {
        let number = |count: u64| Some(count as f64);
        vec![
            self.mota(),
            self.motp(),
            self.recall(),
            self.precision(),
            number(self.misses),
            number(self.false_positives),
            number(self.switches),
            number(self.fragmentations),
            number(self.mostly_tracked),
            number(self.partially_tracked),
            number(self.mostly_lost),
            number(self.unique_objects),
            number(self.objects),
            number(self.predictions),
            number(self.frames),
        ]
    }
}

const fn count(name: &'static str, better: Better, meaning: &'static str) -> MetricInfo {
    metric(name, Unit::Count, NOT_NEGATIVE, better, meaning)
}

impl Family for Clear {
    type Counts = ClearCounts;
    const NAME: &'static str = "CLEAR MOT";
    const SOURCE: &'static str = "Bernardin and Stiefelhagen 2008; numbers as motmetrics";
    const METRICS: &'static [MetricInfo] = &[
        metric(
            "mota",
            Unit::Ratio,
            [f64::NEG_INFINITY, 1.0],
            Better::Up,
            "Accuracy: 1 less misses, false positives and switches, each a person and frame.",
        ),
        metric(
            "motp",
            Unit::Distance,
            NOT_NEGATIVE,
            Better::Down,
            "Mean distance of pairs.",
        ),
        metric(
            "recall",
            Unit::Ratio,
            UNIT_RANGE,
            Better::Up,
            "Part of the people that have a track.",
        ),
        metric(
            "precision",
            Unit::Ratio,
            UNIT_RANGE,
            Better::Up,
            "Part of the tracks that have a person.",
        ),
        count(
            "num_misses",
            Better::Down,
            "People without a track, summed over frames.",
        ),
        count(
            "num_false_positives",
            Better::Down,
            "Tracks without a person, summed over frames.",
        ),
        count(
            "num_switches",
            Better::Down,
            "How often a person got another track.",
        ),
        count(
            "num_fragmentations",
            Better::Down,
            "How often a tracked person was missed and tracked again.",
        ),
        count(
            "mostly_tracked",
            Better::Up,
            "People tracked for at least 0.8 of their frames.",
        ),
        count(
            "partially_tracked",
            Better::Neither,
            "People tracked for 0.2 to 0.8 of their frames.",
        ),
        count(
            "mostly_lost",
            Better::Down,
            "People tracked for less than 0.2 of their frames.",
        ),
        count("num_unique_objects", Better::Neither, "Different people."),
        count("num_objects", Better::Neither, "People, summed over frames."),
        count("num_predictions", Better::Neither, "Tracks, summed over frames."),
        count("num_frames", Better::Neither, "Frames."),
    ];

    fn count(case: &Case) -> Result<Option<ClearCounts>, JudgeError> {
        Ok((!case.sequence.is_empty()).then(|| clear(&case.sequence, &case.events)))
    }
}
