//! What can be wrong with a file, always with the place, the value and the cure.

use std::path::{Path, PathBuf};

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file could not be opened or read: check the path and the permissions.
    #[error("cannot read {file}; check the path and the permissions", file = file.display())]
    Read {
        /// The file or directory.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Nothing tells what the file is, or the directory holds nothing known.
    #[error("{detail}; {cure} ({file})", file = file.display())]
    Format {
        /// The file or directory.
        file: PathBuf,
        /// What was found.
        detail: String,
        /// What to do.
        cure: String,
    },
    /// A line is not well-formed.
    #[error("line {line}: {detail}; {cure} ({file})", file = file.display())]
    Syntax {
        /// The file.
        file: PathBuf,
        /// The line, from 1.
        line: u64,
        /// What is wrong.
        detail: String,
        /// What to do.
        cure: String,
    },
    /// A field has a value that it cannot have.
    #[error("line {line}: `{field}` is {value}: {cure} ({file})", file = file.display())]
    Invalid {
        /// The file.
        file: PathBuf,
        /// The line, from 1.
        line: u64,
        /// Name of the field.
        field: String,
        /// Its value, shortened.
        value: String,
        /// What it must be and what to do.
        cure: String,
    },
}

impl ReadError {
    /// The file that is at fault.
    pub fn file(&self) -> &Path {
        match self {
            Self::Read { file, .. }
            | Self::Format { file, .. }
            | Self::Syntax { file, .. }
            | Self::Invalid { file, .. } => file,
        }
    }

    /// The line that is at fault, from 1, where it is a single one.
    pub fn line(&self) -> Option<u64> {
        match self {
            Self::Syntax { line, .. } | Self::Invalid { line, .. } => Some(*line),
            Self::Read { .. } | Self::Format { .. } => None,
        }
    }

    /// A field with a value that it cannot have.
    pub(super) fn invalid(
        file: &Path,
        line: u64,
        field: impl Into<String>,
        value: &str,
        cure: impl Into<String>,
    ) -> Self {
        let mut shortened: String = value.chars().take(40).collect();
        if shortened.len() < value.len() {
            shortened.push_str("...");
        }
        Self::Invalid {
            file: file.to_owned(),
            line,
            field: field.into(),
            value: if shortened.trim().is_empty() {
                "empty".to_owned()
            } else {
                shortened
            },
            cure: cure.into(),
        }
    }
}
