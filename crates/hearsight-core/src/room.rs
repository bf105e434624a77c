//! A room as it is after every file has been read: sensors with their geometry, by number.
//!
//! Systems are built from this; they never see a path or a configuration file. The place of a sensor in `cameras` or
//! `arrays` is its index everywhere else ([`crate::Moment::video`], [`crate::Moment::audio`]).

use crate::camera::Camera;
use crate::geometry::WorldPoint;
use crate::time::Span;

/// Everything that a system must know of the room before the first moment.
#[derive(Clone, Debug, Default)]
pub struct Room {
    /// The cameras, in the order of the configuration.
    pub cameras: Vec<CameraSensor>,
    /// The microphone arrays, in the order of the configuration.
    pub arrays: Vec<ArraySensor>,
    /// Metres a second.
    pub speed_of_sound_m_s: f64,
}

/// A camera.
#[derive(Clone, Debug)]
pub struct CameraSensor {
    /// Its name, unique in the room.
    pub name: String,
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Nominal interval between frames.
    pub interval: Span,
    /// Lens, size and place, where known.
    pub calibration: Option<Camera>,
}

/// A microphone array.
#[derive(Clone, Debug)]
pub struct ArraySensor {
    /// Its name, unique in the room.
    pub name: String,
    /// Samples a second.
    pub rate_hz: u32,
    /// Channels.
    pub channels: usize,
    /// Place of each channel's microphone in the world, where known.
    pub microphones: Vec<WorldPoint>,
    /// The camera that a single-view system pairs this array with.
    pub camera: Option<usize>,
}
