//! The sound field of a box: what microphones hear of sources that move and turn in it.
//!
//! * [`Shoebox`] — the room: size, walls, reverberation time; its absorption is sought so that responses decay as asked.
//! * [`SoundSource`] — a [`Path`] (where it is and faces at any time), a [`Sound`] (its samples), directivity and level.
//! * [`Microphone`], [`Mismatch`], [`DeviceClock`], [`Placement`] — the array that listens, where it is, and its clock.
//!
//! All positions are of the world, metres; all times seconds of the scenario. Sources are pure functions of time, which
//! may be asked ahead; placements are asked in the order of time and not ahead, since devices obey commands.

mod decay;
pub(crate) mod error;
mod microphones;
pub(crate) mod random;
mod room;
mod source;

pub use decay::reverberation_time_s;
pub use error::AcousticsError;
pub use microphones::{DeviceClock, Microphone, Mismatch, Placement};
pub use room::{BAND_CENTRES_HZ, BANDS, Shoebox, ShoeboxSettings, Walls};
pub use source::{Clip, Directivity, Emission, Path, Sound, SoundSource, Standing};
