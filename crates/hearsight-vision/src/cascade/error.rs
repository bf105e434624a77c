//! What can be wrong with a cascade's file.

use thiserror::Error;

/// A file that is no usable cascade. Take another file; the one at hand will not get better by trying again, unless it
/// could not be read.
#[derive(Debug, Error)]
pub enum CascadeError {
    /// The file cannot be read.
    #[error(
        "{file}: cannot be read; check the path (Debian: package opencv-data, /usr/share/opencv4/haarcascades)"
    )]
    Read {
        /// The file's name.
        file: String,
        /// The reason.
        source: std::io::Error,
    },
    /// The file is no XML.
    #[error("{file}: no XML: {reason}; take one of OpenCV's cascade files as it is")]
    Xml {
        /// The file's name.
        file: String,
        /// The reason and place.
        reason: String,
    },
    /// An element is missing or says what it cannot say.
    #[error("{file}: element <{element}> (line {line}): {problem}; take an unchanged cascade file")]
    Element {
        /// The file's name.
        file: String,
        /// The element's name.
        element: String,
        /// Its line, from 1.
        line: u32,
        /// What is wrong.
        problem: String,
    },
    /// A cascade of another kind.
    #[error(
        "{file}: element <{element}> (line {line}): {found} is not supported; take a Haar cascade (haarcascade_*.xml)"
    )]
    Unsupported {
        /// The file's name.
        file: String,
        /// The element's name.
        element: String,
        /// Its line, from 1.
        line: u32,
        /// What it says.
        found: String,
    },
}
