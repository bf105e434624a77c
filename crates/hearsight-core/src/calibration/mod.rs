//! Calibration files to cameras.
//!
//! One file a format, one line in [`FORMATS`]. A format reads a tree and never asks whether it came as JSON, YAML or
//! TOML. Pixel (0, 0) is the centre of the top-left pixel in all of them, poses map the world into the camera, and
//! lengths are metres: a file in millimetres must be converted first, nothing in it says so.
//!
//! Every error names the file, the field, its value and the cure. No text, however damaged, makes this panic.

mod bouguet;
mod document;
mod error;
mod node;
mod opencv;
mod rotation;
mod toml;
mod words;

pub use self::toml::to_toml;
pub use error::CalibrationError;

use crate::camera::{Camera, CameraModel};
use crate::geometry::Pose;
use node::Node;
use std::path::{Path, PathBuf};

/// Every format, in the order in which they are tried.
pub const FORMATS: &[&CalibrationFormat] = &[&toml::FORMAT, &bouguet::FORMAT, &opencv::FORMAT];

/// A camera further from the origin is a mistake in the file, and arithmetic with it would lose its digits.
const LARGEST_DISTANCE_M: f64 = 1e6;

/// A way to write calibrations, which describes itself.
pub struct CalibrationFormat {
    /// Its name in configurations.
    pub name: &'static str,
    /// What it is, one sentence.
    pub meaning: &'static str,
    /// Its fields: one line each, with unit and default.
    pub fields: &'static [&'static str],
    /// Whether a tree seems to be of this format.
    recognizes: fn(&Node<'_>) -> bool,
    /// Reads the camera with this index, from 0.
    read: fn(&Node<'_>, usize) -> Result<Calibration, CalibrationError>,
}

/// What a file says of one camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// The file it came from.
    pub file: PathBuf,
    /// The camera's name, where the file gives one.
    pub name: Option<String>,
    /// The lens.
    pub model: CameraModel,
    /// Where the camera is, where the file says so.
    pub pose: Option<Pose>,
    /// Width and height of the pictures that it was made from, pixels, where the file says so.
    pub size: Option<[usize; 2]>,
}

impl CalibrationFormat {
    /// The format of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        FORMATS.iter().copied().find(|format| format.name == name)
    }
}

impl std::fmt::Debug for CalibrationFormat {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_tuple("CalibrationFormat")
            .field(&self.name)
            .finish()
    }
}

impl Calibration {
    /// The camera for pictures of this size; one without a pose stands at the world's origin.
    ///
    /// # Errors
    /// [`CalibrationError::PictureSize`] where the calibration was made at another size: whether the picture was
    /// resized or cropped cannot be known here.
    pub fn camera(&self, width: usize, height: usize) -> Result<Camera, CalibrationError> {
        match self.size {
            Some(calibrated) if calibrated != [width, height] => Err(CalibrationError::PictureSize {
                file: self.file.clone(),
                calibrated,
                picture: [width, height],
            }),
            _ => Ok(Camera {
                model: self.model,
                pose: self.pose.unwrap_or_else(Pose::identity),
                width,
                height,
            }),
        }
    }

    /// The calibration for the same pictures resized (not cropped) to another size; unchanged where its own size is
    /// unknown.
    ///
    /// # Errors
    /// [`CalibrationError::Invalid`] where a size is zero.
    pub fn resized(&self, width: usize, height: usize) -> Result<Self, CalibrationError> {
        let Some([old_width, old_height]) = self.size else {
            return Ok(self.clone());
        };
        let scale = |new: usize, old: usize| new as f64 / old as f64;
        let model = (self.model.projection())
            .scaled(scale(width, old_width), scale(height, old_height))
            .map_err(|error| CalibrationError::from_parameter(&self.file, "", error))?;
        Ok(Self {
            model,
            size: Some([width, height]),
            ..self.clone()
        })
    }
}

/// Reads the calibration of one camera from a file. Without a format, the first of [`FORMATS`] that recognizes the
/// file is taken; `index` counts the file's cameras from 0.
///
/// # Errors
/// Every variant of [`CalibrationError`] except `PictureSize`.
pub fn load_camera(
    file: &Path,
    format: Option<&CalibrationFormat>,
    index: usize,
) -> Result<Calibration, CalibrationError> {
    let read = |source| CalibrationError::Read {
        file: file.to_owned(),
        source,
    };
    let length = std::fs::metadata(file).map_err(read)?.len();
    if length > document::LARGEST_FILE_BYTES as u64 {
        return Err(document::too_large(file, length));
    }
    let bytes = std::fs::read(file).map_err(read)?;
    let text = str::from_utf8(&bytes).map_err(|error| CalibrationError::Syntax {
        file: file.to_owned(),
        syntax: "UTF-8",
        detail: error.to_string(),
        cure: "save the file as UTF-8 text".into(),
    })?;
    parse_camera(text, file, format, index)
}

/// Like [`load_camera`], from text; `file` names it in errors, and its extension tells the syntax where the text does
/// not.
///
/// # Errors
/// Every variant of [`CalibrationError`] except `Read` and `PictureSize`.
pub fn parse_camera(
    text: &str,
    file: &Path,
    format: Option<&CalibrationFormat>,
    index: usize,
) -> Result<Calibration, CalibrationError> {
    let tree = document::parse(text, file)?;
    let root = Node::root(file, &tree);
    let recognized = || FORMATS.iter().copied().find(|format| (format.recognizes)(&root));
    let format = format.or_else(recognized).ok_or_else(|| {
        let names: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
        CalibrationError::Format {
            file: file.to_owned(),
            detail: "this is no known calibration format".into(),
            cure: format!("write one of: {}", names.join(", ")),
        }
    })?;
    let calibration = (format.read)(&root, index)?;
    let distance_m = calibration
        .pose
        .map_or(0.0, |pose| pose.sensor_from_world.translation.vector.norm());
    if distance_m.is_nan() || distance_m > LARGEST_DISTANCE_M {
        return Err(CalibrationError::Invalid {
            file: file.to_owned(),
            field: "position".into(),
            value: format!("{distance_m:e} m from the world's origin"),
            cure: "give it in metres, from an origin in the room".into(),
        });
    }
    Ok(calibration)
}

/// The camera with this index, or that there are fewer.
fn choose<'a>(root: &Node<'_>, cameras: Vec<Node<'a>>, index: usize) -> Result<Node<'a>, CalibrationError> {
    let count = cameras.len();
    let missing = || CalibrationError::NoSuchCamera {
        file: root.file.to_owned(),
        index,
        count,
    };
    cameras.into_iter().nth(index).ok_or_else(missing)
}

/// Focal lengths and principal point of a camera matrix.
fn intrinsics(node: &Node<'_>) -> Result<([f64; 2], [f64; 2]), CalibrationError> {
    let k = node.matrix::<3, 3>()?;
    let (focal, centre) = ([k[(0, 0)], k[(1, 1)]], [k[(0, 2)], k[(1, 2)]]);
    if focal.iter().any(|focal| *focal <= 0.0) {
        return Err(node.invalid(format!(
            "focal lengths must be positive, not {} and {}; calibrate again",
            focal[0], focal[1]
        )));
    }
    if [k[(1, 0)], k[(2, 0)], k[(2, 1)]].iter().any(|zero| *zero != 0.0) || k[(2, 2)] != 1.0 {
        return Err(node.invalid("it must be [fx 0 cx; 0 fy cy; 0 0 1]; check the order of its numbers"));
    }
    // A thousandth of a pixel across a picture is less than any calibration knows.
    if k[(0, 1)].abs() > 1e-6 * focal[0] {
        return Err(node.invalid(format!(
            "skew {} is not supported; calibrate with it fixed at 0",
            k[(0, 1)]
        )));
    }
    Ok((focal, centre))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_describes_itself_under_a_name_of_its_own() {
        for (place, format) in FORMATS.iter().enumerate() {
            assert!(
                format.meaning.ends_with('.') && !format.fields.is_empty(),
                "{format:?}"
            );
            assert!(FORMATS[..place].iter().all(|other| other.name != format.name));
            assert_eq!(
                CalibrationFormat::named(format.name).map(|found| found.name),
                Some(format.name)
            );
        }
        assert!(CalibrationFormat::named("matlab").is_none());
    }

    #[test]
    fn a_missing_or_unreadable_file_says_what_to_do() {
        let folder = tempfile::tempdir().unwrap();
        let missing = load_camera(&folder.path().join("none.yaml"), None, 0).unwrap_err();
        assert!(
            matches!(missing, CalibrationError::Read { .. }) && missing.to_string().contains("none.yaml")
        );
        let binary = folder.path().join("binary.yaml");
        std::fs::write(&binary, [0xff, 0xfe, 0x00]).unwrap();
        assert!(matches!(
            load_camera(&binary, None, 0),
            Err(CalibrationError::Syntax { .. })
        ));
        let unknown = parse_camera("{\"a\": 1}", Path::new("a.json"), None, 0).unwrap_err();
        assert!(matches!(unknown, CalibrationError::Format { .. }), "{unknown}");
    }
}
