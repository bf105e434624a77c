//! Pictures of the simulated room, taken through the project's own lenses, and what is seen in them.
//!
//! A [`Shot`] says what a picture is taken of and with, a [`Picture`] is what comes out: YUV 4:2:0 planes as a codec
//! takes them, and for each person boxes and visibility.

mod picture;
mod shot;

pub use picture::{Extent, Picture, Sight};
pub use shot::{Person, Range, SensorNoise, Shot};
