//! Pictures of the simulated room, taken through the project's own lenses, and what is seen in them.
//!
//! A [`Shot`] says what a picture is taken of and with, a [`Renderer`] takes it, a [`Picture`] is what comes out: YUV
//! 4:2:0 planes as a codec takes them, and for each person boxes and visibility. Light is linear until the sensor: the
//! room is traced, four samples a pixel, and kept while nothing changes; people are surfaces of triangles, drawn over it
//! several times while the shutter is open; then come exposure, white balance, noise, and the gamma of sRGB.
//!
//! Nothing here moves by itself: a picture is a function of its shot, the setting and the seed.

mod band;
mod bins;
mod body;
mod develop;
mod face;
mod figure;
mod hash;
mod head;
mod lamps;
mod mesh;
mod pattern;
mod picture;
mod raster;
mod renderer;
mod shadow;
mod shot;
mod sight;
mod stage;
mod texture;
mod view;

pub use picture::{Extent, Picture, Sight};
pub use renderer::Renderer;
pub use shot::{Person, Range, SensorNoise, Shot};
