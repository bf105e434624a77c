//! One sequence: who is where and what was found, instant by instant, and how near each is to each.
//!
//! What metrics of place see. Both sides are at the same instants already; who does not count is no longer here.

use crate::measure::{Measure, Place};
use thiserror::Error;

/// Most pairs of people and tracks in one frame, and in a group of people and tracks that meet.
pub(crate) const MOST_PAIRS: usize = 1 << 24;

/// A person or a track at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// Index of the person or track, from 0 without gaps.
    pub who: u32,
    /// Where.
    pub place: Place,
    /// Whether they speak; none where that is not known.
    pub speaking: Option<bool>,
    /// Probability that they speak, 0 to 1; none where that is not known.
    pub speaking_probability: Option<f64>,
    /// Probability that there is a person at all, 0 to 1; none where that is not known.
    pub existence: Option<f64>,
}

impl Sighting {
    /// Somebody of whom nothing but the place is known.
    pub const fn new(who: u32, place: Place) -> Self {
        Self {
            who,
            place,
            speaking: None,
            speaking_probability: None,
            existence: None,
        }
    }
}

/// Why a frame cannot be added.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SequenceError {
    /// Someone has a place that cannot be compared by this measure, or one that is not finite.
    #[error("frame {frame}: the place {place:?} cannot be compared by {measure:?}; choose another distance")]
    WrongPlace {
        /// Number of the frame.
        frame: u64,
        /// The place.
        place: Place,
        /// The measure.
        measure: Measure,
    },
    /// The same person or track is there twice.
    #[error("frame {frame}: {side} {who} is there twice; leave out one of the two")]
    Twice {
        /// Number of the frame.
        frame: u64,
        /// "person" or "track".
        side: &'static str,
        /// Index of the person or track.
        who: u32,
    },
    /// More than can be compared.
    #[error("{what} has {people} people and {tracks} tracks, more than can be compared; split the sequence")]
    TooLarge {
        /// What is too large.
        what: String,
        /// People in it.
        people: usize,
        /// Tracks in it.
        tracks: usize,
    },
    /// A gate that nothing can pass or that is not a number.
    #[error("the gate must be a number above 0, found {found}")]
    BadGate {
        /// The gate.
        found: f64,
    },
}

/// A sequence of frames with both sides and their distances.
#[derive(Clone, Debug)]
pub struct Sequence {
    measure: Measure,
    gate: f64,
    frames: Vec<FrameEnd>,
    truth: Vec<Sighting>,
    tracks: Vec<Sighting>,
    /// People x tracks of each frame in turn.
    raw: Vec<f64>,
    person_count: usize,
    track_count: usize,
}

/// Where a frame's parts end.
#[derive(Clone, Copy, Debug)]
struct FrameEnd {
    number: u64,
    time_s: Option<f64>,
    truth: usize,
    tracks: usize,
    raw: usize,
}

/// One frame of a sequence.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Number of the frame or tick.
    pub number: u64,
    /// Time, seconds; none where it is not known.
    pub time_s: Option<f64>,
    /// The people.
    pub truth: &'a [Sighting],
    /// The tracks.
    pub tracks: &'a [Sighting],
    /// Place of the first person in [`Sequence::truth`].
    pub first_truth: usize,
    /// Place of the first track in [`Sequence::tracks`].
    pub first_track: usize,
    measure: Measure,
    gate: f64,
    raw: &'a [f64],
}

impl Sequence {
    /// A sequence without frames. Pairs farther apart than `gate`, in the measure's unit, are no match.
    ///
    /// # Errors
    /// [`SequenceError::BadGate`].
    pub fn new(measure: Measure, gate: f64) -> Result<Self, SequenceError> {
        if !(gate > 0.0 && gate.is_finite()) {
            return Err(SequenceError::BadGate { found: gate });
        }
        Ok(Self {
            measure,
            gate,
            frames: Vec::new(),
            truth: Vec::new(),
            tracks: Vec::new(),
            raw: Vec::new(),
            person_count: 0,
            track_count: 0,
        })
    }

    /// Adds a frame. The order of the sightings matters where a track could go on with either of two people.
    ///
    /// # Errors
    /// [`SequenceError::WrongPlace`], [`SequenceError::Twice`], [`SequenceError::TooLarge`]; nothing is added then.
    pub fn push(
        &mut self,
        number: u64,
        time_s: Option<f64>,
        truth: &[Sighting],
        tracks: &[Sighting],
    ) -> Result<(), SequenceError> {
        if truth.len().saturating_mul(tracks.len()) > MOST_PAIRS {
            return Err(SequenceError::TooLarge {
                what: format!("frame {number}"),
                people: truth.len(),
                tracks: tracks.len(),
            });
        }
        for (side, sightings) in [("person", truth), ("track", tracks)] {
            if let Some(who) = twice(sightings) {
                let frame = number;
                return Err(SequenceError::Twice { frame, side, who });
            }
            let bad = |seen: &&Sighting| !(seen.place.is_finite() && self.measure.can_use(&seen.place));
            if let Some(seen) = sightings.iter().find(bad) {
                return Err(SequenceError::WrongPlace {
                    frame: number,
                    place: seen.place,
                    measure: self.measure,
                });
            }
        }
        for person in truth {
            for track in tracks {
                let raw = self.measure.raw(&person.place, &track.place);
                self.raw.push(raw.unwrap_or(f64::INFINITY));
            }
        }
        let count = |sightings: &[Sighting]| {
            sightings
                .iter()
                .map(|seen| seen.who as usize + 1)
                .max()
                .unwrap_or(0)
        };
        self.person_count = self.person_count.max(count(truth));
        self.track_count = self.track_count.max(count(tracks));
        self.truth.extend_from_slice(truth);
        self.tracks.extend_from_slice(tracks);
        self.frames.push(FrameEnd {
            number,
            time_s,
            truth: self.truth.len(),
            tracks: self.tracks.len(),
            raw: self.raw.len(),
        });
        Ok(())
    }

    /// What distances are.
    pub fn measure(&self) -> Measure {
        self.measure
    }

    /// Pairs farther apart than this are no match.
    pub fn gate(&self) -> f64 {
        self.gate
    }

    /// Number of frames.
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Whether there are no frames.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// The frames in turn.
    pub fn frames(&self) -> impl Iterator<Item = Frame<'_>> + '_ {
        let (mut truth, mut tracks, mut raw) = (0, 0, 0);
        self.frames.iter().map(move |end| {
            let frame = Frame {
                number: end.number,
                time_s: end.time_s,
                truth: &self.truth[truth..end.truth],
                tracks: &self.tracks[tracks..end.tracks],
                first_truth: truth,
                first_track: tracks,
                measure: self.measure,
                gate: self.gate,
                raw: &self.raw[raw..end.raw],
            };
            (truth, tracks, raw) = (end.truth, end.tracks, end.raw);
            frame
        })
    }

    /// Number and time of a frame, by its place in the sequence.
    pub fn instant(&self, frame: usize) -> Option<(u64, Option<f64>)> {
        self.frames.get(frame).map(|end| (end.number, end.time_s))
    }

    /// Everyone who is there, frame by frame.
    pub fn truth(&self) -> &[Sighting] {
        &self.truth
    }

    /// Every track, frame by frame.
    pub fn tracks(&self) -> &[Sighting] {
        &self.tracks
    }

    /// One more than the largest index of a person.
    pub fn person_count(&self) -> usize {
        self.person_count
    }

    /// One more than the largest index of a track.
    pub fn track_count(&self) -> usize {
        self.track_count
    }
}

impl Frame<'_> {
    /// Distance of a person from a track, both by their place in the frame.
    pub fn distance(&self, person: usize, track: usize) -> f64 {
        self.measure
            .distance_of(self.raw[person * self.tracks.len() + track])
    }

    /// Person, track and similarity of every pair that is similar at all, by person and track.
    pub(crate) fn similar(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let (measure, gate) = (self.measure, self.gate);
        self.rows().flat_map(move |(person, row)| {
            row.iter().enumerate().filter_map(move |(track, &raw)| {
                let similarity = measure.similarity_of(raw, gate);
                (similarity > 0.0).then_some((person, track, similarity))
            })
        })
    }

    /// Person, track and distance of every pair that is near enough, by person and track.
    pub(crate) fn near(
        &self,
        is_near: impl Fn(f64) -> bool + Copy,
    ) -> impl Iterator<Item = (usize, usize, f64)> {
        let measure = self.measure;
        self.rows().flat_map(move |(person, row)| {
            row.iter().enumerate().filter_map(move |(track, &raw)| {
                let distance = measure.distance_of(raw);
                is_near(distance).then_some((person, track, distance))
            })
        })
    }

    /// Each person with what is kept of the pairs with all tracks.
    fn rows(&self) -> impl Iterator<Item = (usize, &[f64])> + '_ {
        self.raw.chunks_exact(self.tracks.len().max(1)).enumerate()
    }

    /// Similarity of a person and a track, 0 to 1; see [`Measure`].
    pub fn similarity(&self, person: usize, track: usize) -> f64 {
        self.measure
            .similarity_of(self.raw[person * self.tracks.len() + track], self.gate)
    }
}

/// Somebody who is there twice. Few people are compared directly, many by sorting.
fn twice(sightings: &[Sighting]) -> Option<u32> {
    if sightings.len() <= 32 {
        return sightings.iter().enumerate().find_map(|(index, seen)| {
            let again = sightings[..index].iter().any(|other| other.who == seen.who);
            again.then_some(seen.who)
        });
    }
    let mut who: Vec<u32> = sightings.iter().map(|seen| seen.who).collect();
    who.sort_unstable();
    who.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0])
}
