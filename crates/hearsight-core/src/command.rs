//! What is said to devices that move: cameras on pan-tilt heads, robots that carry sensors.
//!
//! Commands carry the time at which they are sent; how long a device takes to obey, and how fast it is, is its own. The
//! state of a simulated device is a function of the commands that it received.

use crate::time::Instant;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One command to one device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeviceCommand {
    /// When it is sent, on the common clock.
    pub time: Instant,
    /// The device's name: a camera or a moving base.
    pub device: String,
    /// What it is to do. A new order replaces the one before.
    pub order: DeviceOrder,
}

/// What a device is to do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DeviceOrder {
    /// A pan-tilt-zoom camera: go there and stay.
    Aim {
        /// To the left, against the direction in which the camera was mounted, radians.
        pan_rad: f64,
        /// Up from there, radians.
        tilt_rad: f64,
        /// Focal length over the shortest one, 1 or more.
        zoom: f64,
    },
    /// A pan-tilt-zoom camera: go on at these speeds, as far as it can turn.
    Turn {
        /// To the left, radians a second.
        pan_rad_s: f64,
        /// Up, radians a second.
        tilt_rad_s: f64,
        /// Change of the zoom a second.
        zoom_per_s: f64,
    },
    /// A moving base: drive on at these speeds.
    Drive {
        /// Forward, metres a second.
        forward_m_s: f64,
        /// To the left, radians a second.
        turn_rad_s: f64,
    },
    /// Any device: come to rest.
    Stop,
}
