//! Who and what is in the room, and where it is at any instant: what the renderer and the acoustics are told.
//!
//! World frame: metres, right-handed, z up, the floor at z = 0. A yaw of 0 looks along x and grows counter-clockwise seen
//! from above; a pitch grows upwards; a roll grows towards the right shoulder.

mod posture;
mod setting;

pub use posture::{Limb, Posture};
pub use setting::{Block, Colour, Hair, Light, Looks, Material, Pattern, Setting, Wear};
