//! What happened to every person and track, instant by instant: the log that most metrics are counted from.
//!
//! The rule is that of CLEAR MOT (Bernardin and Stiefelhagen 2008, section 2.1.3) as motmetrics has it: who was paired
//! stays paired while both are there and within the gate, however long ago that was; the rest is paired anew, as many as
//! possible and among those at the least distance. TrackEval differs: it goes on only with pairs of the frame before.

use crate::matching::{Aim, Edge, Matcher};
use crate::sequence::{Frame, Sequence, SequenceError};

/// Something that happened at one instant. Places of people and tracks are those in [`Sequence::truth`] and
/// [`Sequence::tracks`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A person has the track they had before, or their first.
    Match(Pair),
    /// A person has another track than the one they had before.
    Switch(Pair),
    /// A person has no track.
    Miss {
        /// Place of the frame in the sequence.
        frame: usize,
        /// The person.
        truth: usize,
    },
    /// A track has no person.
    FalsePositive {
        /// Place of the frame in the sequence.
        frame: usize,
        /// The track.
        track: usize,
    },
}

/// A person and their track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Place of the frame in the sequence.
    pub frame: usize,
    /// The person.
    pub truth: usize,
    /// The track.
    pub track: usize,
    /// How far apart they are, in the measure's unit.
    pub distance: f64,
}

impl Event {
    /// The pair of a match or switch.
    pub fn pair(&self) -> Option<&Pair> {
        match self {
            Self::Match(pair) | Self::Switch(pair) => Some(pair),
            Self::Miss { .. } | Self::FalsePositive { .. } => None,
        }
    }

    /// Place of the frame in the sequence.
    pub fn frame(&self) -> usize {
        match self {
            Self::Match(pair) | Self::Switch(pair) => pair.frame,
            Self::Miss { frame, .. } | Self::FalsePositive { frame, .. } => *frame,
        }
    }
}

/// Every event of a sequence: frame by frame, in each the pairs, then misses, then false positives.
///
/// # Errors
/// [`SequenceError::TooLarge`].
pub fn events(sequence: &Sequence) -> Result<Vec<Event>, SequenceError> {
    let mut log = Vec::with_capacity(sequence.truth().len());
    let mut state = State {
        track_of_person: vec![None; sequence.person_count()],
        ..State::default()
    };
    for (index, frame) in sequence.frames().enumerate() {
        state.step(index, &frame, sequence.gate(), &mut log)?;
    }
    Ok(log)
}

#[derive(Default)]
struct State {
    /// The latest track of each person, kept also while they are gone or missed.
    track_of_person: Vec<Option<u32>>,
    person_done: Vec<bool>,
    track_done: Vec<bool>,
    edges: Vec<Edge>,
    pairs: Vec<(u32, u32)>,
    matcher: Matcher,
}

impl State {
    fn step(
        &mut self,
        index: usize,
        frame: &Frame<'_>,
        gate: f64,
        log: &mut Vec<Event>,
    ) -> Result<(), SequenceError> {
        let (people, tracks) = (frame.truth, frame.tracks);
        self.person_done.clear();
        self.person_done.resize(people.len(), false);
        self.track_done.clear();
        self.track_done.resize(tracks.len(), false);
        let pair = |person: usize, track: usize| Pair {
            frame: index,
            truth: frame.first_truth + person,
            track: frame.first_track + track,
            distance: frame.distance(person, track),
        };
        for (person, seen) in people.iter().enumerate() {
            let Some(before) = self.track_of_person[seen.who as usize] else {
                continue;
            };
            let found = tracks.iter().position(|track| track.who == before);
            if let Some(track) = found.filter(|&track| !self.track_done[track])
                && frame.distance(person, track) <= gate
            {
                self.person_done[person] = true;
                self.track_done[track] = true;
                log.push(Event::Match(pair(person, track)));
            }
        }
        self.edges.clear();
        for person in (0..people.len()).filter(|&person| !self.person_done[person]) {
            for track in (0..tracks.len()).filter(|&track| !self.track_done[track]) {
                let cost = frame.distance(person, track);
                if cost <= gate {
                    let (row, column) = (person as u32, track as u32);
                    self.edges.push(Edge { row, column, cost });
                }
            }
        }
        self.matcher.pair(
            people.len(),
            tracks.len(),
            &self.edges,
            Aim::Most,
            &mut self.pairs,
        )?;
        for &(person, track) in &self.pairs {
            let (person, track) = (person as usize, track as usize);
            let now = tracks[track].who;
            let before = self.track_of_person[people[person].who as usize].replace(now);
            self.person_done[person] = true;
            self.track_done[track] = true;
            log.push(match before {
                Some(before) if before != now => Event::Switch(pair(person, track)),
                _ => Event::Match(pair(person, track)),
            });
        }
        let missed = (0..people.len()).filter(|&person| !self.person_done[person]);
        log.extend(missed.map(|person| Event::Miss {
            frame: index,
            truth: frame.first_truth + person,
        }));
        let false_positives = (0..tracks.len()).filter(|&track| !self.track_done[track]);
        log.extend(false_positives.map(|track| Event::FalsePositive {
            frame: index,
            track: frame.first_track + track,
        }));
        Ok(())
    }
}
