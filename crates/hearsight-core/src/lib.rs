//! What every part of Hearsight agrees on: time, geometry, pictures, sound, moments and results.
//!
//! This crate knows no sensor driver, cue or filter. Everything else depends on it; it depends on no sibling.
//!
//! * [`Instant`], [`Span`] — nanoseconds on the common clock.
//! * [`geometry`] — poses, points and pixels, each frame of reference a type of its own.
//! * [`camera`] — lenses: points of the world to pixels and back; [`microphones`] — arrays and their delays.
//! * [`calibration`] — files to cameras; [`configuration`] — files that people write, and errors that point into them.
//! * [`picture`] — views of grey and colour pictures and binary masks; [`yuv`] — what video stores, to colours.
//! * [`moment`] — what arrived within one tick; [`source`] — the traits of what delivers it.
//! * [`command`] — what is said to devices that move.
//! * [`finite`] — whether every number in a value is one that can be written.
//! * [`record`] — the published scene, with its schema version.
//! * [`truth`] — what is really so, as a simulation writes and a judge reads it.

pub mod calibration;
pub mod camera;
pub mod command;
pub mod configuration;
pub mod finite;
pub mod geometry;
pub mod microphones;
pub mod moment;
pub mod picture;
pub mod record;
pub mod room;
pub mod source;
pub mod time;
pub mod truth;
pub mod yuv;

pub use camera::{Camera, CameraModel, Projection};
pub use geometry::{CameraPoint, DistortedPixel, Pose, Ray, UndistortedPixel, WorldPoint};
pub use microphones::{MicrophoneArray, MicrophonePair};
pub use moment::{AudioBlock, Fault, FaultKind, Moment, VideoFrame};
pub use picture::{GrayView, Mask, Rectangle, RgbView};
pub use time::{Instant, Span};
