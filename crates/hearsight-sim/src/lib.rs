//! Simulated rooms: people who walk and talk, what cameras and microphones make of them, and the exact truth.
//!
//! A scenario is the single source of truth. People and sounds are pure functions of time and seed; devices also of the
//! commands that they receive. What comes out are pictures and samples like those of real sensors, and apart from them
//! the truth, which only a judge may see. This crate tracks nobody and knows no tracker.
//!
//! * [`scenario`] — the file that says it all, and how it is read.
//! * [`simulation`] — the scenario at work: sources as of real sensors, and the truth beside them.
//! * [`world`] — who and what is in the room, and where it is at any instant.
//! * [`render`] — pictures of it, and the truth of who is seen in them.
//! * [`acoustics`] — what microphones hear of sources that move in a room with echoes.
//! * [`voice`] — what people and things sound like, and who speaks when.

pub mod acoustics;
pub mod render;
pub mod scenario;
pub mod simulation;
pub mod voice;
pub mod world;
