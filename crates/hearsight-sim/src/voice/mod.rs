//! What people and things sound like, and who speaks when. Everything is a pure function of time and seed.
//!
//! * [`draw_turns`] — a conversation: who speaks from when to when.
//! * [`Talker`] — a built-in voice; it gives the [`Speech`] of one person's turns, and the mouth that goes with it.
//! * [`RecordedVoice`] — the same from a folder of recordings.
//! * [`Noise`] — fans, streets, televisions, telephones, coughs, laughter, claps.
//! * [`read_sound`] — WAV and FLAC files.

mod file;
mod noises;
mod recording;
mod speech;
mod talker;
mod turns;

pub use file::{SoundFile, read_sound};
pub use noises::{Noise, NoiseKind};
pub use recording::RecordedVoice;
pub use speech::Speech;
pub use talker::{Talker, TalkerKind};
pub use turns::{Turn, TurnSettings, draw_turns};
