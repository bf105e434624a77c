//! Files to recordings: our own JSON Lines, MOTChallenge text, RTTM, and the CSV of AV16.3 and of `hearsight track`.
//!
//! The format is known from the name and the first line. Whatever the bytes are, they are read or refused with file, line,
//! field, value and cure; numbers that are not finite are set aside with their row and counted.

mod directory;
mod error;
mod frames_csv;
mod mot;
mod places_csv;
mod rttm;
mod scenes;
mod table;
mod truth;

pub use error::ReadError;

use crate::recording::{Recording, Side};
use std::path::Path;

/// Every format there is.
pub const FORMATS: &[FormatInfo] = &[
    truth::FORMAT,
    scenes::FORMAT,
    mot::FORMAT,
    rttm::FORMAT,
    frames_csv::FORMAT,
    places_csv::FORMAT,
];

/// A format of files.
#[derive(Clone, Copy, Debug)]
pub struct FormatInfo {
    /// Its name, for `--truth-format` and `--tracks-format`.
    pub name: &'static str,
    /// One sentence.
    pub meaning: &'static str,
    /// Whether a file of this name and beginning is of it.
    recognize: fn(name: &str, first_line: &str) -> bool,
    /// Reads a file.
    read: fn(&Source<'_>) -> Result<Recording, ReadError>,
}

/// A file to be read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'a> {
    pub(crate) path: &'a Path,
    pub(crate) bytes: &'a [u8],
    pub(crate) side: Side,
}

impl Source<'_> {
    /// Name of the file; empty where it has none.
    fn name(&self) -> &str {
        name_of(self.path)
    }
}

/// Whether a number of seconds can be a time: within thirty years of the start, so that sums of times stay exact enough.
pub(crate) fn is_time(seconds: f64) -> bool {
    seconds.abs() <= 1e9
}

fn name_of(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).unwrap_or("")
}

/// The format of a name.
///
/// # Errors
/// [`ReadError::Format`] with the names that there are.
pub fn format_of_name(name: &str) -> Result<&'static FormatInfo, ReadError> {
    FORMATS.iter().find(|format| format.name == name).ok_or_else(|| {
        let known: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
        ReadError::Format {
            file: name.into(),
            detail: format!("there is no format `{name}`"),
            cure: format!("choose one of {}", known.join(", ")),
        }
    })
}

/// Reads a file or directory. A directory is what `hearsight track` or `hearsight simulate` wrote, the corpus AV16.3, or
/// a number of files of the formats here.
///
/// # Errors
/// [`ReadError`].
pub fn read(path: &Path, side: Side, format: Option<&FormatInfo>) -> Result<Recording, ReadError> {
    if path.is_dir() {
        return directory::read(path, side, format);
    }
    let bytes = std::fs::read(path).map_err(|source| ReadError::Read {
        file: path.to_owned(),
        source,
    })?;
    let mut recording = parse(path, &bytes, side, format)?;
    directory::add_neighbours(path, &mut recording)?;
    Ok(recording)
}

/// Reads the bytes of a file; `path` is for its name and for messages, nothing is opened.
///
/// # Errors
/// [`ReadError`].
pub fn parse(
    path: &Path,
    bytes: &[u8],
    side: Side,
    format: Option<&FormatInfo>,
) -> Result<Recording, ReadError> {
    let source = Source { path, bytes, side };
    let format = match format {
        Some(format) => format,
        None => recognize(&source)?,
    };
    (format.read)(&source)
}

fn recognize(source: &Source<'_>) -> Result<&'static FormatInfo, ReadError> {
    let line = source
        .bytes
        .split(|&byte| byte == b'\n')
        .find(|line| !line.trim_ascii().is_empty());
    let line = &line.unwrap_or_default()[..line.unwrap_or_default().len().min(4096)];
    let line = String::from_utf8_lossy(line);
    let name = source.name().to_ascii_lowercase();
    let fits = |format: &&FormatInfo| (format.recognize)(&name, line.trim());
    FORMATS.iter().find(fits).ok_or_else(|| {
        let known: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
        ReadError::Format {
            file: source.path.to_owned(),
            detail: if line.trim().is_empty() {
                "it is empty, and its name does not tell what it is".to_owned()
            } else {
                "neither its name nor its first line tells what it is".to_owned()
            },
            cure: format!("name its format: {}", known.join(", ")),
        }
    })
}
