//! One person: looks, body, voice, and all that they do.

use super::character::Character;
use super::ease::smooth;
use super::figure::Figure;
use super::gaze::Look;
use super::gesture::Gesture;
use super::motion::Motion;
use super::setting::Looks;
use crate::voice::TalkerKind;
use std::path::PathBuf;
use std::sync::Arc;

/// How long before and after a turn somebody begins and ends to gesture, seconds.
const TALK_RAMP_S: f64 = 0.5;

/// What a voice does at any time.
pub trait Speech: Send + Sync {
    /// How far the mouth is open, 0 to 1.
    fn opening(&self, time_s: f64) -> f64;
    /// Whether the voice sounds: pauses within a turn are silence.
    fn sounds(&self, time_s: f64) -> bool;
}

/// What somebody's voice is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct VoiceSpec {
    /// Level one metre before the mouth while it sounds, decibels relative to full scale.
    pub level_db: f64,
    /// Whose voice the built-in talker has.
    pub kind: TalkerKind,
    /// A folder of recorded speech to be played instead.
    pub recording: Option<PathBuf>,
    /// What distinguishes the built-in talkers.
    pub seed: u64,
}

/// One person.
#[derive(Clone)]
pub struct Person {
    /// Number, from 1.
    pub id: u64,
    /// Name, unique in the scenario.
    pub name: String,
    /// How they look.
    pub looks: Looks,
    /// Their measures.
    pub figure: Figure,
    /// Their little movements.
    pub character: Character,
    /// What the body does.
    pub motion: Motion,
    /// What hands and head do, in order of time.
    pub gestures: Vec<Gesture>,
    /// Where they look, in order of time.
    pub gaze: Vec<Look>,
    /// When they speak: from and until, seconds, in order of time and without overlap.
    pub turns: Vec<[f64; 2]>,
    /// Their voice.
    pub voice: VoiceSpec,
    /// What the voice does; until it is known, the mouth stays closed and turns have no pauses.
    pub speech: Option<Arc<dyn Speech>>,
}

impl Person {
    /// The turn at a time.
    pub fn turn(&self, time_s: f64) -> Option<[f64; 2]> {
        let begun = self.turns.partition_point(|turn| turn[0] <= time_s);
        let turn = *self.turns.get(begun.checked_sub(1)?)?;
        (time_s < turn[1]).then_some(turn)
    }

    /// Whether the voice sounds.
    pub fn is_speaking(&self, time_s: f64) -> bool {
        match &self.speech {
            Some(speech) => speech.sounds(time_s),
            None => self.turn(time_s).is_some(),
        }
    }

    /// How much somebody is about talking, from 0 to 1 without jumps.
    pub(crate) fn talking(&self, time_s: f64) -> f64 {
        let begun = self.turns.partition_point(|turn| turn[0] - TALK_RAMP_S <= time_s);
        let near = self.turns[..begun].iter().rev().take(2);
        near.map(|[from, until]| {
            let begin = smooth((time_s - (from - 0.5 * TALK_RAMP_S)) / TALK_RAMP_S);
            begin.min(smooth((until + 0.5 * TALK_RAMP_S - time_s) / TALK_RAMP_S))
        })
        .fold(0.0, f64::max)
    }

    /// How far the mouth is open.
    pub(crate) fn mouth_opening(&self, time_s: f64) -> f64 {
        self.speech.as_ref().map_or(0.0, |speech| speech.opening(time_s))
    }
}

impl std::fmt::Debug for Person {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Person")
            .field("id", &self.id)
            .field("name", &self.name)
            .field("turns", &self.turns)
            .finish_non_exhaustive()
    }
}
