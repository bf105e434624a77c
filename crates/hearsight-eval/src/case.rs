//! One sequence ready to be judged: places, events, speech and the options of the judge.

use crate::events::{Event, events};
use crate::sequence::{Sequence, SequenceError};
use crate::speech::Speech;

/// What is judged: one picture or the world of one recording.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name of the sequence, for the table.
    pub name: String,
    /// Who is where; without frames where only speech is known.
    pub sequence: Sequence,
    /// What happened, by [`events`].
    pub events: Vec<Event>,
    /// Who speaks when; none where one side does not say.
    pub speech: Option<Speech>,
    /// Where azimuths are taken from, x and y in metres; none for no azimuths.
    pub azimuth_from_m: Option<[f64; 2]>,
    /// Names of the people, by index.
    pub people: Vec<String>,
    /// Names of the tracks, by index.
    pub tracks: Vec<String>,
}

impl Case {
    /// Finds out what happened in a sequence.
    ///
    /// # Errors
    /// [`SequenceError::TooLarge`].
    pub fn new(name: impl Into<String>, sequence: Sequence) -> Result<Self, SequenceError> {
        let numbers = |count: usize| (1..=count).map(|number| number.to_string()).collect();
        Ok(Self {
            name: name.into(),
            events: events(&sequence)?,
            speech: None,
            azimuth_from_m: None,
            people: numbers(sequence.person_count()),
            tracks: numbers(sequence.track_count()),
            sequence,
        })
    }
}
