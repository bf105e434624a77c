//! Whether people are found under their own number, and how soon.
//!
//! The own track of a person is the one that serves best overall ([`own_tracks`]). A stay begins
//! when a person is there for the first time, or again after more than a second; they are identified in it when they are
//! first paired with their own track.

use super::identity::{OwnTracks, own_tracks};
use super::{Better, Counts, Family, JudgeError, MetricInfo, NOT_NEGATIVE, UNIT_RANGE, Unit, metric, ratio};
use crate::case::Case;
use crate::events::Event;
use crate::sequence::Sequence;

/// Who is away for longer comes anew, seconds.
const AWAY_S: f64 = 1.0;

/// The family.
pub struct Identification;

/// What is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IdentificationCounts {
    /// Pairs.
    pub pairs: u64,
    /// Pairs with a track that is not the person's own.
    pub wrong: u64,
    /// Stays of people; zero where times are not known.
    pub stays: u64,
    /// Stays in which the person was identified.
    pub identified: u64,
    /// Sum of the times from the beginning of a stay until then, seconds.
    pub time_s: f64,
}

/// Counts in a sequence.
pub fn identification(sequence: &Sequence, events: &[Event], own: &OwnTracks) -> IdentificationCounts {
    let mut counts = IdentificationCounts::default();
    let mut stays: Vec<Option<Stay>> = vec![None; sequence.person_count()];
    for event in events {
        let (truth, track) = match event {
            Event::Match(pair) | Event::Switch(pair) => (pair.truth, Some(pair.track)),
            Event::Miss { truth, .. } => (*truth, None),
            Event::FalsePositive { .. } => continue,
        };
        let who = sequence.truth()[truth].who as usize;
        let own_track = own.track_of_person.get(who).copied().flatten();
        let is_own = track.is_some_and(|track| Some(sequence.tracks()[track].who) == own_track);
        if track.is_some() {
            counts.pairs += 1;
            counts.wrong += u64::from(!is_own);
        }
        let Some((_, Some(now_s))) = sequence.instant(event.frame()) else {
            continue;
        };
        let goes_on = stays[who].filter(|stay| now_s - stay.last_s <= AWAY_S);
        let mut stay = goes_on.unwrap_or_else(|| {
            counts.stays += 1;
            Stay {
                start_s: now_s,
                last_s: now_s,
                identified: false,
            }
        });
        stay.last_s = now_s;
        if is_own && !stay.identified {
            stay.identified = true;
            counts.identified += 1;
            counts.time_s += now_s - stay.start_s;
        }
        stays[who] = Some(stay);
    }
    counts
}

#[derive(Clone, Copy)]
struct Stay {
    start_s: f64,
    last_s: f64,
    identified: bool,
}

impl Counts for IdentificationCounts {
    fn add(&mut self, other: &Self) {
        self.pairs += other.pairs;
        self.wrong += other.wrong;
        self.stays += other.stays;
        self.identified += other.identified;
        self.time_s += other.time_s;
    }

    fn values(&self) -> Vec<Option<f64>> {
        let timed = self.stays > 0;
        let stays = |count: u64| timed.then_some(count as f64);
        vec![
            ratio(self.wrong as f64, self.pairs as f64),
            ratio(self.time_s, self.identified as f64),
            stays(self.stays - self.identified),
            stays(self.stays),
        ]
    }
}

impl Family for Identification {
    type Counts = IdentificationCounts;
    const NAME: &'static str = "Identification";
    const SOURCE: &'static str = "pairs beside the best track of each person";
    const METRICS: &'static [MetricInfo] = &[
        metric(
            "identification_error",
            Unit::Ratio,
            UNIT_RANGE,
            Better::Down,
            "Part of the pairs in which the person has another track than their own.",
        ),
        metric(
            "time_to_identify",
            Unit::Seconds,
            NOT_NEGATIVE,
            Better::Down,
            "Mean time from coming until paired with the own track, where that happens.",
        ),
        metric(
            "num_never_identified",
            Unit::Count,
            NOT_NEGATIVE,
            Better::Down,
            "Stays in which that does not happen.",
        ),
        metric(
            "num_stays",
            Unit::Count,
            NOT_NEGATIVE,
            Better::Neither,
            "How often people come, for the first time or after more than a second.",
        ),
    ];

    fn count(case: &Case) -> Result<Option<IdentificationCounts>, JudgeError> {
        if case.sequence.is_empty() {
            return Ok(None);
        }
        let own = own_tracks(&case.sequence)?;
        Ok(Some(identification(&case.sequence, &case.events, &own)))
    }
}
