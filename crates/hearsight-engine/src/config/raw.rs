//! What people write in a `room.toml`: syntax only, nothing is read, opened or checked here.
//!
//! Every key has a default where one makes sense; an unknown key is an error. Times are seconds, lengths metres,
//! paths relative to the file.

use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A whole `room.toml`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawRoom {
    /// Name of the room or recording, written into reports and RTTM. Default: the name of the file.
    pub name: Option<String>,
    /// Speed of sound, metres a second. Default 343. A larger value makes delays point closer to the middle.
    pub speed_of_sound: Option<f64>,
    /// The cameras, in the order in which results name them.
    pub camera: Vec<RawCamera>,
    /// Cameras around one point that are used as one.
    pub panorama: Vec<RawPanorama>,
    /// The microphone arrays.
    pub array: Vec<RawArray>,
    /// Which system tracks, with its parameters in a table of its own name.
    pub system: RawSystem,
    /// What is written, and where.
    pub output: RawOutput,
    /// How the run goes.
    pub run: RawRun,
}

/// One camera: exactly one of `file`, `device`, `stream` and `images`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawCamera {
    /// Name, unique among all sensors; output files are called by it. Default `cam1`, `cam2`, ...
    pub name: Option<String>,
    /// A video file.
    pub file: Option<String>,
    /// A capture device, such as `/dev/video0`.
    pub device: Option<String>,
    /// The address of a network stream, such as `rtsp://...`.
    pub stream: Option<String>,
    /// Pictures with their number in the name, such as `frames/%06d.png`.
    pub images: Option<String>,
    /// Frames a second of `images`. Default 25. Elsewhere the source knows.
    pub rate: Option<f64>,
    /// When the first frame was taken, seconds on the common clock. Default 0 for files; live sources start on
    /// arrival.
    pub start: Option<f64>,
    /// How much faster than the common clock this sensor's clock runs, parts per million. Default 0.
    pub drift: Option<f64>,
    /// Whether a file is played at its own pace as if it were live, dropping what comes too fast. Default false.
    pub paced: Option<bool>,
    /// For how long a live source that was lost is opened again, seconds. Default 300; 0 ends it at once.
    pub reconnect: Option<f64>,
    /// Name of the input format where it cannot be guessed, such as `v4l2`.
    pub format: Option<String>,
    /// Options of the input format, such as `video_size = "640x480"`.
    pub options: BTreeMap<String, String>,
    /// Lens and place: a file's name, a table `{ file, index, format }`, or the calibration itself. Default: none,
    /// which systems that work in the picture can do without.
    pub calibration: Option<RawCalibration>,
}

/// Several calibrated cameras that look outwards from about one point, stitched to one picture of 360 degrees. They are no
/// cameras of their own then; arrays that are paired with one of them are paired with the panorama.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawPanorama {
    /// Name, unique among all sensors. Default `panorama1`, ...
    pub name: Option<String>,
    /// Names of the cameras. The first one looks at the middle of the panorama and keeps the time.
    pub cameras: Vec<String>,
    /// Width and height, pixels. Default `[1500, 240]`.
    pub size: Option<[usize; 2]>,
    /// Distance at which the pictures of neighbours meet without a step, metres. Default 2.
    pub radius: Option<f64>,
    /// Width of the seam over which two pictures blend, as a share of the smaller side of a picture, above 0 to 1. Default
    /// 0.1. Raising it hides steps of brightness and doubles what is nearer or farther than `radius`.
    pub seam: Option<f64>,
}

/// Where a camera's calibration comes from.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum RawCalibration {
    /// A file with one camera.
    Path(String),
    /// A file, which of its cameras, and its format.
    File(RawCalibrationFile),
    /// The calibration itself, written as in our own TOML calibration files.
    Inline(#[schemars(with = "BTreeMap<String, serde_json::Value>")] toml::Table),
}

/// One camera out of a calibration file.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawCalibrationFile {
    /// The file.
    pub file: String,
    /// Which camera in the file, from 0. Default 0.
    pub index: Option<usize>,
    /// `opencv`, `bouguet` or `toml`. Default: seen from the file.
    pub format: Option<String>,
}

/// One microphone array: exactly one of `file`, `device` and `stream`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawArray {
    /// Name, unique among all sensors. Default `array1`, `array2`, ...
    pub name: Option<String>,
    /// A sound file, or a video file with sound.
    pub file: Option<String>,
    /// A capture device.
    pub device: Option<String>,
    /// The address of a network stream.
    pub stream: Option<String>,
    /// When the first sample was taken, seconds on the common clock. Default 0 for files; live sources start on
    /// arrival.
    pub start: Option<f64>,
    /// How much faster than the common clock this sensor's clock runs, parts per million. Default 0.
    pub drift: Option<f64>,
    /// Whether a file is played at its own pace as if it were live. Default false.
    pub paced: Option<bool>,
    /// For how long a live source that was lost is opened again, seconds. Default 300; 0 ends it at once.
    pub reconnect: Option<f64>,
    /// Name of the input format where it cannot be guessed, such as `alsa`.
    pub format: Option<String>,
    /// Options of the input format.
    pub options: BTreeMap<String, String>,
    /// Samples a second to convert to. Default: the source's own.
    pub rate: Option<u32>,
    /// Which channels of the source, from 0, in the order of the microphones. Default: all.
    pub channels: Option<Vec<usize>>,
    /// Place of each channel's microphone in the world, metres: `[[x, y, z], ...]`.
    pub microphones: Option<Vec<Vec<f64>>>,
    /// A JSON file with the microphones' places instead.
    pub microphones_file: Option<RawMicrophonesFile>,
    /// Name of the camera that a single-view system pairs this array with. Default: the camera, where there is
    /// exactly one.
    pub camera: Option<String>,
}

/// One array out of a file of microphone positions: `{"arrays_m": {"<array>": [[x, y, z], ...]}}`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawMicrophonesFile {
    /// The file.
    pub file: String,
    /// Name of the array in the file. Default: the sensor's own name.
    pub array: Option<String>,
}

/// Which system tracks. Beside `name` there may be one table a system, `[system.stac]`; each system checks its own.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(default)]
pub struct RawSystem {
    /// Name of the system. Default `stac`.
    pub name: Option<String>,
    /// Parameters by system.
    #[serde(flatten)]
    #[schemars(with = "BTreeMap<String, serde_json::Value>")]
    pub parameters: BTreeMap<String, toml::Value>,
}

/// What is written, and where. Beside `directory` each output may be switched by its name, `overlay = true`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(default)]
pub struct RawOutput {
    /// The directory; it is made where it is missing. Default `out`, beside the configuration.
    pub directory: Option<String>,
    /// Outputs by name, on or off.
    #[serde(flatten)]
    #[schemars(with = "BTreeMap<String, bool>")]
    pub formats: BTreeMap<String, toml::Value>,
}

/// How the run goes.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawRun {
    /// Seed of every random number. Default 1.
    pub seed: Option<u64>,
    /// Threads for tracking; 0 takes one a processor. Default 0. Results do not depend on it.
    pub threads: Option<usize>,
    /// Where to begin, seconds on the common clock. Default: where the first sensor begins.
    pub from: Option<f64>,
    /// Where to end, seconds on the common clock. Default: where the last sensor ends.
    pub until: Option<f64>,
    /// Seconds from tick to tick. Default: the fastest camera's interval.
    pub tick: Option<f64>,
}

impl<'de> Deserialize<'de> for RawCalibration {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = toml::Value::deserialize(deserializer)?;
        match value {
            toml::Value::String(file) => Ok(Self::Path(file)),
            toml::Value::Table(table) if table.contains_key("file") => toml::Value::Table(table)
                .try_into()
                .map(Self::File)
                .map_err(|error| serde::de::Error::custom(error.message())),
            toml::Value::Table(table) => Ok(Self::Inline(table)),
            other => Err(serde::de::Error::custom(format!(
                "a calibration is a file's name or a table, not {}",
                other.type_str()
            ))),
        }
    }
}
