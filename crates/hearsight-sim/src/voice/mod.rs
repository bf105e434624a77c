//! What people and things sound like, and who speaks when. Everything is a pure function of time and seed.
//!
//! * [`draw_turns`] — a conversation: who speaks from when to when.
//! * [`read_sound`] — WAV and FLAC files.

mod file;
mod turns;

pub use file::{SoundFile, read_sound};
pub use turns::{Turn, TurnSettings, draw_turns};
