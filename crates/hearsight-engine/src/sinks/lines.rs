//! A text file that grows by whole lines: what is on the disk ends at the end of a line, even if the program is
//! killed.

use super::SinkError;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Written to the disk once so much has gathered.
const BUFFER_BYTES: usize = 64 * 1024;

/// A text file of lines.
pub(super) struct Lines {
    path: PathBuf,
    file: File,
    buffer: Vec<u8>,
}

impl Lines {
    /// Makes or empties the file.
    pub(super) fn create(path: PathBuf) -> Result<Self, SinkError> {
        let file = File::create(&path).map_err(|error| SinkError::new(&path, error))?;
        Ok(Self {
            path,
            file,
            buffer: Vec::new(),
        })
    }

    /// Where the file is.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Takes one line, without its end.
    pub(super) fn line(&mut self, line: &[u8]) -> Result<(), SinkError> {
        self.buffer.extend_from_slice(line);
        self.buffer.push(b'\n');
        if self.buffer.len() >= BUFFER_BYTES {
            self.flush()
        } else {
            Ok(())
        }
    }

    /// Brings everything to the disk.
    pub(super) fn flush(&mut self) -> Result<(), SinkError> {
        let result = self
            .file
            .write_all(&self.buffer)
            .map_err(|error| SinkError::new(&self.path, error));
        self.buffer.clear();
        result
    }
}

impl Drop for Lines {
    fn drop(&mut self) {
        // After `finish` there is nothing left; this serves a run that panics elsewhere.
        let _ = self.flush();
    }
}
