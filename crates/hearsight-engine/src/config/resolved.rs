//! A configuration with every default filled in and every file that describes geometry read. Media are not open yet.

use hearsight_core::calibration::Calibration;
use hearsight_core::{Instant, Span, WorldPoint};
use serde::{Serialize, Serializer};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// A room, ready to be opened.
#[derive(Clone, Debug, Serialize)]
pub struct ResolvedRoom {
    /// Name of the room or recording.
    pub name: String,
    /// The cameras, in the order of the configuration.
    pub cameras: Vec<ResolvedCamera>,
    /// The microphone arrays, in the order of the configuration.
    pub arrays: Vec<ResolvedArray>,
    /// Metres a second.
    pub speed_of_sound_m_s: f64,
    /// Which system tracks.
    pub system: ResolvedSystem,
    /// What is written, and where.
    pub output: ResolvedOutput,
    /// How the run goes.
    pub run: ResolvedRun,
}

/// Where the data of a sensor come from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Input {
    /// A file.
    File(PathBuf),
    /// A capture device.
    Device(String),
    /// The address of a network stream.
    Stream(String),
    /// Numbered pictures.
    Images(PathBuf),
    /// Several cameras that are stitched: those of [`ResolvedCamera::ring`].
    Panorama,
}

/// Cameras around one point that are stitched to one.
#[derive(Clone, Debug, Serialize)]
pub struct ResolvedRing {
    /// The cameras, each with a calibration.
    pub cameras: Vec<ResolvedCamera>,
    /// Width and height of the panorama, pixels.
    pub size: [usize; 2],
    /// Distance at which the pictures of neighbours meet without a step, metres.
    pub radius_m: f64,
    /// Width of a seam, as a share of the smaller side of a picture.
    pub seam: f64,
}

/// A camera.
#[derive(Clone, Debug, Serialize)]
pub struct ResolvedCamera {
    /// Unique name.
    pub name: String,
    /// Where the frames come from.
    pub input: Input,
    /// When the first frame was taken; nothing for a live source that starts on arrival.
    #[serde(rename = "start_s", serialize_with = "write_time")]
    pub start: Option<Instant>,
    /// How much faster than the common clock the camera's clock runs, parts per million.
    pub drift_ppm: f64,
    /// Whether a file is played at its own pace.
    pub paced: bool,
    /// For how long a live source that was lost is opened again, seconds.
    pub reconnect_s: f64,
    /// Frames a second of numbered pictures.
    pub rate_hz: f64,
    /// Name of the input format, where given.
    pub format: Option<String>,
    /// Options of the input format.
    pub options: BTreeMap<String, String>,
    /// Lens and place, where known.
    #[serde(serialize_with = "write_calibration")]
    pub calibration: Option<Calibration>,
    /// What a panorama is stitched of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ring: Option<ResolvedRing>,
}

/// A microphone array.
#[derive(Clone, Debug, Serialize)]
pub struct ResolvedArray {
    /// Unique name.
    pub name: String,
    /// Where the samples come from.
    pub input: Input,
    /// When the first sample was taken; nothing for a live source that starts on arrival.
    #[serde(rename = "start_s", serialize_with = "write_time")]
    pub start: Option<Instant>,
    /// How much faster than the common clock the array's clock runs, parts per million.
    pub drift_ppm: f64,
    /// Whether a file is played at its own pace.
    pub paced: bool,
    /// For how long a live source that was lost is opened again, seconds.
    pub reconnect_s: f64,
    /// Name of the input format, where given.
    pub format: Option<String>,
    /// Options of the input format.
    pub options: BTreeMap<String, String>,
    /// Samples a second to convert to; nothing for the source's own.
    pub rate_hz: Option<u32>,
    /// Which channels of the source, in the order of the microphones; nothing for all.
    pub channels: Option<Vec<usize>>,
    /// Place of each channel's microphone; empty where unknown.
    pub microphones: Vec<WorldPoint>,
    /// Number of the camera that the array is paired with.
    pub camera: Option<usize>,
}

/// Which system tracks.
#[derive(Clone, Debug, Serialize)]
pub struct ResolvedSystem {
    /// Its name.
    pub name: String,
    /// Its parameters, as given.
    #[serde(skip)]
    pub given: serde_json::Value,
    /// Its parameters with every default, for people to read.
    pub parameters: serde_json::Value,
}

/// What is written, and where.
#[derive(Clone, Debug, Serialize)]
pub struct ResolvedOutput {
    /// The directory.
    pub directory: PathBuf,
    /// Names of the outputs that are on.
    pub formats: BTreeSet<&'static str>,
}

/// How the run goes.
#[derive(Clone, Debug, Serialize)]
pub struct ResolvedRun {
    /// Seed of every random number.
    pub seed: u64,
    /// Threads for tracking, at least 1.
    pub threads: usize,
    /// Where to begin; nothing for where the first sensor begins.
    #[serde(rename = "from_s", serialize_with = "write_time")]
    pub from: Option<Instant>,
    /// Where to end; nothing for where the last sensor ends.
    #[serde(rename = "until_s", serialize_with = "write_time")]
    pub until: Option<Instant>,
    /// Time from tick to tick; nothing for the fastest camera's interval.
    #[serde(rename = "tick_s", serialize_with = "write_span")]
    pub tick: Option<Span>,
}

impl ResolvedCamera {
    /// A camera that plays a file from the zero of the common clock, without calibration.
    pub fn from_file(name: &str, file: impl Into<PathBuf>) -> Self {
        Self {
            name: name.to_owned(),
            input: Input::File(file.into()),
            start: Some(Instant::ZERO),
            drift_ppm: 0.0,
            paced: false,
            reconnect_s: super::sensors::DEFAULT_RECONNECT_S,
            rate_hz: 25.0,
            format: None,
            options: BTreeMap::new(),
            calibration: None,
            ring: None,
        }
    }
}

impl ResolvedArray {
    /// An array that plays a file from the zero of the common clock, with microphones at unknown places.
    pub fn from_file(name: &str, file: impl Into<PathBuf>) -> Self {
        Self {
            name: name.to_owned(),
            input: Input::File(file.into()),
            start: Some(Instant::ZERO),
            drift_ppm: 0.0,
            paced: false,
            reconnect_s: super::sensors::DEFAULT_RECONNECT_S,
            format: None,
            options: BTreeMap::new(),
            rate_hz: None,
            channels: None,
            microphones: Vec::new(),
            camera: None,
        }
    }
}

fn write_time<S: Serializer>(time: &Option<Instant>, serializer: S) -> Result<S::Ok, S::Error> {
    time.map(Instant::seconds).serialize(serializer)
}

fn write_span<S: Serializer>(span: &Option<Span>, serializer: S) -> Result<S::Ok, S::Error> {
    span.map(Span::seconds).serialize(serializer)
}

fn write_calibration<S: Serializer>(
    calibration: &Option<Calibration>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Written<'a> {
        file: &'a std::path::Path,
        size: Option<[usize; 2]>,
        lens: &'a hearsight_core::CameraModel,
        pose: Option<hearsight_core::Pose>,
    }
    let written = calibration.as_ref().map(|calibration| Written {
        file: &calibration.file,
        size: calibration.size,
        lens: &calibration.model,
        pose: calibration.pose,
    });
    written.serialize(serializer)
}
