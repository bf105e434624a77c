//! Simulated rooms: people who walk and talk, what cameras and microphones make of them, and the exact truth.
//!
//! A scenario is the single source of truth. People and sounds are pure functions of time and seed; devices also of the
//! commands that they receive. What comes out are pictures and samples like those of real sensors, and apart from them
//! the truth, which only a judge may see. This crate tracks nobody and knows no tracker.
//!
//! * [`render`] — pictures of it, and the truth of who is seen in them.
//! * [`world`] — who and what is in the room, and where it is at any instant.

pub mod render;
pub mod world;
