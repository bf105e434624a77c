//! Sensors and what carries them, as people write them.

use super::people::{RawAction, RawDirection};
use schemars::JsonSchema;
use serde::Deserialize;

/// Something that moves and carries sensors.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawBase {
    /// Name, unique in the scenario. Default `base1`, ...
    pub name: Option<String>,
    /// Where it is at the beginning, metres.
    pub at: Option<[f64; 2]>,
    /// Where it looks at the beginning. Default 0.
    pub facing: Option<RawDirection>,
    /// The fastest that it drives, metres a second. Default 0.8.
    pub speed: Option<f64>,
    /// The fastest that it turns, degrees a second. Default 60.
    pub turn_speed: Option<f64>,
    /// From a command to its obedience, seconds. Default 0.1.
    pub latency: Option<f64>,
    /// What it does by itself: `walk` (drives) and `turn`.
    pub action: Vec<RawAction>,
    /// Commands to it, which end what it does by itself.
    pub command: Vec<RawCommand>,
}

/// A command of the scenario to one of its devices: a time, and where to go or how fast to go on.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawCommand {
    /// When it is sent, seconds.
    pub time: Option<f64>,
    /// A camera pans to here, degrees to the left of where it is mounted. Default 0 where `tilt` or `zoom` is given.
    pub pan: Option<f64>,
    /// A camera tilts to here, degrees up.
    pub tilt: Option<f64>,
    /// A camera zooms to this factor.
    pub zoom: Option<f64>,
    /// A camera pans, or a base turns, on at this speed, degrees a second to the left.
    pub pan_speed: Option<f64>,
    /// A camera tilts on at this speed, degrees a second up.
    pub tilt_speed: Option<f64>,
    /// A base drives on at this speed, metres a second.
    pub drive: Option<f64>,
}

/// A kind of lens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LensKind {
    /// An ordinary lens.
    Pinhole,
    /// A fisheye.
    Fisheye,
    /// A cylindrical panorama.
    Panorama,
}

/// A camera, or several of a kind.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawCamera {
    /// Name, unique among all sensors; files are called by it. Default `cam1`, `cam2`, ...
    pub name: Option<String>,
    /// Width and height, pixels. Default `[640, 480]`.
    pub size: Option<[usize; 2]>,
    /// Frames a second. Default 15.
    pub rate: Option<f64>,
    /// The lens. Default `pinhole`.
    pub lens: Option<LensKind>,
    /// Angle from the left edge to the right, degrees. Default 60, of a fisheye 180, of a panorama 360.
    pub view: Option<f64>,
    /// Focal length, pixels, instead of `view`.
    pub focal: Option<f64>,
    /// Distortion of the lens: k1, k2, p1, p2, k3 of a pinhole, k1 to k4 of a fisheye. Default none.
    pub distortion: Vec<f64>,
    /// Its place, metres; on a base: forward, left and up from its middle on the floor.
    pub at: Option<[f64; 3]>,
    /// A place in the middle of its picture, metres; on a base, from the base. Instead of `pan` and `tilt`.
    pub look_at: Option<[f64; 3]>,
    /// Where it looks, degrees; on a base, to the left of where the base looks. Default 0.
    pub pan: Option<f64>,
    /// How far up it looks, degrees. Default 0.
    pub tilt: Option<f64>,
    /// How far its right side is lower, degrees. Default 0.
    pub roll: Option<f64>,
    /// Name of the base that carries it.
    pub base: Option<String>,
    /// Makes two cameras of it, `<name>-left` and `<name>-right`, so far apart, metres.
    pub stereo: Option<f64>,
    /// Makes so many cameras of it around one point, `<name>-1`, ..., each turned on by an equal part of 360 degrees.
    pub ring: Option<usize>,
    /// How far the cameras of a ring are from the point, metres. Default 0.05.
    pub ring_radius: Option<f64>,
    /// Makes it a camera that pans, tilts and zooms by commands.
    pub head: Option<RawHead>,
    /// Commands that the scenario itself sends to it.
    pub command: Vec<RawCommand>,
    /// Brightness: what is as bright as one over this is full scale. Default 1.
    pub exposure: Option<f64>,
    /// Gains of red, green and blue. Default `[1, 1, 1]`.
    pub white_balance: Option<[f64; 3]>,
    /// How far brightness and colours drift to and fro, a share of them, 0 to 0.5. Default 0.01.
    pub drift: Option<f64>,
    /// How long a drift there and back takes, seconds. Default 40.
    pub drift_period: Option<f64>,
    /// Jumps of the brightness: from times on a factor, `[[seconds, factor], ...]`.
    pub exposure_changes: Vec<[f64; 2]>,
    /// Jumps of the white balance: from times on gains, `[[seconds, red, green, blue], ...]`.
    pub white_balance_changes: Vec<[f64; 4]>,
    /// How long the shutter is open, seconds; longer blurs what moves. Default 0.012.
    pub shutter: Option<f64>,
    /// Noise in the dark, a share of full scale. Default 0.002.
    pub noise: Option<f64>,
    /// Variance that light adds, a share of full scale. Default 0.0001.
    pub shot_noise: Option<f64>,
    /// Its clock.
    pub clock: RawClock,
}

/// A head that pans, tilts and zooms.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawHead {
    /// The fastest that it pans, degrees a second. Default 80.
    pub pan_speed: Option<f64>,
    /// The fastest that it tilts, degrees a second. Default 50.
    pub tilt_speed: Option<f64>,
    /// The fastest that it zooms, factors a second. Default 4.
    pub zoom_speed: Option<f64>,
    /// How fast it gains speed, degrees a second squared. Default 600.
    pub acceleration: Option<f64>,
    /// How far it pans right and left, degrees. Default `[-170, 170]`.
    pub pan_range: Option<[f64; 2]>,
    /// How far it tilts down and up, degrees. Default `[-30, 90]`.
    pub tilt_range: Option<[f64; 2]>,
    /// The longest focal length over the shortest. Default 12.
    pub zoom: Option<f64>,
    /// From a command to its obedience, seconds. Default 0.06.
    pub latency: Option<f64>,
}

/// The clock of a sensor.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawClock {
    /// When it takes its first frame or sample, seconds, 0 or more. Default 0.
    pub offset: Option<f64>,
    /// How much too fast it runs, parts per million. Default 0.
    pub drift: Option<f64>,
    /// Whether `room.toml` tells both; otherwise it is for others to find out. Default false.
    pub declared: Option<bool>,
}

/// The shape of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ArrayShape {
    /// Two microphones, `spacing` apart.
    Pair,
    /// `count` microphones in a line, `spacing` from one to the next.
    Line,
    /// `count` microphones on a level circle of `radius`.
    Circle,
}

/// A microphone array: `microphones`, or a `shape` at a place.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawArray {
    /// Name, unique among all sensors; files are called by it. Default `array1`, ...
    pub name: Option<String>,
    /// Samples a second. Default 16000.
    pub rate: Option<u32>,
    /// Place of each microphone, metres; on a base: forward, left and up from its middle on the floor.
    pub microphones: Vec<[f64; 3]>,
    /// The shape, where no microphones are given. Default `circle`.
    pub shape: Option<ArrayShape>,
    /// Its middle, metres.
    pub at: Option<[f64; 3]>,
    /// Where it looks, degrees: pairs and lines lie across, the first microphone to the left; the first microphone of a
    /// circle is there. Default 0.
    pub facing: Option<f64>,
    /// Number of microphones of a line (default 4) or a circle (default 8).
    pub count: Option<usize>,
    /// From one microphone to the next, metres. Default 0.2.
    pub spacing: Option<f64>,
    /// Radius of a circle, metres. Default 0.1.
    pub radius: Option<f64>,
    /// Name of the base that carries it.
    pub base: Option<String>,
    /// Name of the camera that it is paired with in `room.toml`. Default: the camera, where there is exactly one.
    pub camera: Option<String>,
    /// How far gains of microphones differ, decibels. Default 1.
    pub gain_mismatch: Option<f64>,
    /// How far microphones are late, seconds. Default 0.000005.
    pub delay_mismatch: Option<f64>,
    /// How far the lower ends of their responses differ, a share. Default 0.2.
    pub corner_mismatch: Option<f64>,
    /// Noise of each microphone itself, decibels relative to full scale. Default -80.
    pub noise: Option<f64>,
    /// Samples that never arrive: `[[from, until], ...]`, seconds.
    pub lost: Vec<[f64; 2]>,
    /// Share of the sound that never arrives, in blocks of `lost_block`, drawn from the seed, 0 to 0.9. Default 0.
    pub lost_share: Option<f64>,
    /// Length of a lost block, seconds. Default 0.02.
    pub lost_block: Option<f64>,
    /// Its clock.
    pub clock: RawClock,
}
