//! What a picture is taken of and with: the camera, the people, the light and the sensor.

use crate::world::{Looks, Posture};
use hearsight_core::{Camera, Pose};
use serde::{Deserialize, Serialize};

/// Somebody before the camera.
#[derive(Clone, Copy, Debug)]
pub struct Person<'a> {
    /// How they look.
    pub looks: &'a Looks,
    /// Their posture when the shutter opens.
    pub opening: &'a Posture,
    /// Their posture when it closes; between the two every point moves evenly. The truth is that of the middle.
    pub closing: &'a Posture,
}

/// How much a sensor's samples scatter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SensorNoise {
    /// Standard deviation in the dark, as a share of full scale (linear light), 0 or more; 0.002 is a usual camera's.
    pub dark: f64,
    /// Variance that light adds, as a share of full scale, at full scale (proportional to light), 0 or more; 1e-4 is
    /// a usual camera's (10 000 electrons), 1e-3 one in a dim room.
    pub shot: f64,
}

/// Which codes a picture's planes use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Range {
    /// Luma 16 to 235, chroma 16 to 240: what video usually is.
    #[default]
    Limited,
    /// 0 to 255.
    Full,
}

/// One picture to be taken.
#[derive(Clone, Copy, Debug)]
pub struct Shot<'a> {
    /// The camera's number in the room: its noise differs from others', and the drawn room is kept by it.
    pub view: usize,
    /// The picture's number: its noise differs from others'.
    pub frame: u64,
    /// Lens, size, and pose when the shutter opens.
    pub camera: &'a Camera,
    /// Pose when the shutter closes, of a camera that moves; `None` for one that rests.
    pub closing_pose: Option<&'a Pose>,
    /// Who is there. The order is that of [`super::Picture::sights`].
    pub people: &'a [Person<'a>],
    /// How bright each lamp of the setting is now, 1 as the setting says; what is missing is 1.
    pub lamps: &'a [f64],
    /// Gain: a radiance of 1 over this is full scale.
    pub exposure: f64,
    /// Further gains of red, green and blue, 1 for a sensor that sees white as white.
    pub white_balance: [f64; 3],
    /// The sensor's noise.
    pub noise: SensorNoise,
    /// The codes of the planes.
    pub range: Range,
}

impl Default for SensorNoise {
    fn default() -> Self {
        Self {
            dark: 0.002,
            shot: 1e-4,
        }
    }
}
