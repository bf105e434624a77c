//! What can be wrong with a calibration file, always with the place, the value and the cure.

use crate::camera::InvalidParameter;
use std::path::{Path, PathBuf};

/// Why a calibration could not be read. Each variant calls for something else from the user: another path, a repaired
/// file, another value, another camera or another picture size.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationError {
    /// The file could not be opened or read: check the path and the permissions, then try again.
    #[error("cannot read the calibration: {source}; check the path and the permissions ({file})", file = file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The text is not well-formed.
    #[error("not well-formed {syntax}: {detail}; {cure} ({file})", file = file.display())]
    Syntax {
        /// The file.
        file: PathBuf,
        /// What it was read as: "JSON", "YAML" or "TOML".
        syntax: &'static str,
        /// What the parser said.
        detail: String,
        /// What to do.
        cure: String,
    },
    /// The text is well-formed but of no known format, or the named format does not exist.
    #[error("{detail}; {cure} ({file})", file = file.display())]
    Format {
        /// The file.
        file: PathBuf,
        /// What was found.
        detail: String,
        /// What to do.
        cure: String,
    },
    /// A field that must be there is not.
    #[error("`{field}` is missing; {cure} ({file})", file = file.display())]
    Missing {
        /// The file.
        file: PathBuf,
        /// Name of the field.
        field: String,
        /// What to do.
        cure: String,
    },
    /// A field has a value that it cannot have.
    #[error("`{field}` is {value}: {cure} ({file})", file = file.display())]
    Invalid {
        /// The file.
        file: PathBuf,
        /// Name of the field, with the path to it.
        field: String,
        /// Its value, shortened.
        value: String,
        /// What it must be and what to do.
        cure: String,
    },
    /// The file has fewer cameras than asked for.
    #[error("there is no camera {index}: the file has {count}, counted from 0; choose another ({file})", file = file.display())]
    NoSuchCamera {
        /// The file.
        file: PathBuf,
        /// The camera asked for, from 0.
        index: usize,
        /// Cameras in the file.
        count: usize,
    },
    /// The calibration was made at another picture size.
    #[error(
        "calibrated at {calibrated:?} pixels but the picture has {picture:?}; scale the calibration if the picture was \
         resized, calibrate again if it was cropped ({file})",
        file = file.display()
    )]
    PictureSize {
        /// The file.
        file: PathBuf,
        /// Width and height of the calibration.
        calibrated: [usize; 2],
        /// Width and height of the picture.
        picture: [usize; 2],
    },
}

impl CalibrationError {
    /// The file that is at fault.
    pub fn file(&self) -> &Path {
        match self {
            Self::Read { file, .. }
            | Self::Syntax { file, .. }
            | Self::Format { file, .. }
            | Self::Missing { file, .. }
            | Self::Invalid { file, .. }
            | Self::NoSuchCamera { file, .. }
            | Self::PictureSize { file, .. } => file,
        }
    }

    /// The field that is at fault, where it is a single one.
    pub fn field(&self) -> Option<&str> {
        match self {
            Self::Missing { field, .. } | Self::Invalid { field, .. } => Some(field),
            _ => None,
        }
    }

    /// A lens that refused its parameters, under the name of the part of the file that they came from.
    pub(super) fn from_parameter(file: &Path, part: &str, error: InvalidParameter) -> Self {
        let field = if part.is_empty() {
            error.field.to_owned()
        } else {
            format!("{part}.{}", error.field)
        };
        Self::Invalid {
            file: file.to_owned(),
            field,
            value: error.value,
            cure: format!("it must be {}; correct it or calibrate again", error.requirement),
        }
    }
}
