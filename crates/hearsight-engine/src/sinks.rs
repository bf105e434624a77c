//! Where scenes go: files of several formats, each of its own file here and one line in [`registry`].
//!
//! A sink sees each tick once and is closed once, also after an error or an interruption; whatever it has written by
//! then is a valid file. It never changes what is tracked.

mod lines;
mod mot;
mod overlay;
mod report;
mod scenes;
mod speech;
mod tracks;

use crate::config::ResolvedRoom;
use crate::summary::Summary;
use hearsight_core::Moment;
use hearsight_core::record::Scene;
use hearsight_core::room::Room;
use hearsight_systems::System;
use std::path::{Path, PathBuf};

/// Every sink that there is.
pub fn registry() -> &'static [SinkInfo] {
    &[
        scenes::INFO,
        mot::INFO,
        tracks::INFO,
        speech::INFO,
        report::INFO,
        overlay::INFO,
    ]
}

/// What a sink is, for configuration, help and reference.
#[derive(Clone, Copy, Debug)]
pub struct SinkInfo {
    /// Its name in `[output]` and on the command line.
    pub name: &'static str,
    /// The file that it writes; `<camera>` stands for each camera's name.
    pub file: &'static str,
    /// One sentence for people.
    pub summary: &'static str,
    /// Whether it is on unless switched off.
    pub default: bool,
    /// Opens its files.
    pub open: fn(&SinkContext<'_>) -> Result<Box<dyn Sink>, SinkError>,
}

/// What a sink may know before the first tick.
#[derive(Clone, Copy)]
pub struct SinkContext<'a> {
    /// Where its files go; the directory is there.
    pub directory: &'a Path,
    /// The sensors.
    pub room: &'a Room,
    /// The configuration.
    pub configuration: &'a ResolvedRoom,
    /// From tick to tick, seconds.
    pub tick_s: f64,
}

/// What a sink sees of one tick.
#[derive(Clone, Copy)]
pub struct Tick<'a> {
    /// The published result.
    pub scene: &'a Scene,
    /// What it was made from.
    pub moment: &'a Moment,
    /// The system, for what only a picture shows.
    pub system: &'a dyn System,
}

/// Takes the results of a run, tick by tick.
pub trait Sink: Send {
    /// Takes one tick.
    ///
    /// # Errors
    /// [`SinkError`] where it cannot be written; the run ends then.
    fn write(&mut self, tick: Tick<'_>) -> Result<(), SinkError>;

    /// Completes and closes the files. Called once, also after an error of this or another sink.
    ///
    /// # Errors
    /// [`SinkError`] where they cannot be completed.
    fn finish(&mut self, summary: &Summary) -> Result<(), SinkError>;
}

/// Why an output could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {reason}", path.display())]
pub struct SinkError {
    /// The file or directory.
    pub path: PathBuf,
    /// What the system said.
    pub reason: String,
}

impl SinkError {
    /// An error at `path`.
    pub fn new(path: &Path, reason: impl ToString) -> Self {
        Self {
            path: path.to_path_buf(),
            reason: reason.to_string(),
        }
    }
}

/// The sinks of a run.
pub struct Outputs {
    sinks: Vec<Box<dyn Sink>>,
}

impl Outputs {
    /// No outputs at all.
    pub fn none() -> Self {
        Self { sinks: Vec::new() }
    }

    /// Makes the directory and opens every output that the configuration wants.
    ///
    /// # Errors
    /// [`SinkError`] where the directory or a file cannot be made.
    pub fn open(context: &SinkContext<'_>) -> Result<Self, SinkError> {
        let wanted = &context.configuration.output.formats;
        let mut outputs = Self::none();
        if !wanted.is_empty() {
            std::fs::create_dir_all(context.directory)
                .map_err(|error| SinkError::new(context.directory, error))?;
        }
        for info in registry().iter().filter(|info| wanted.contains(info.name)) {
            outputs.sinks.push((info.open)(context)?);
        }
        Ok(outputs)
    }

    /// One more output, such as a caller's own.
    pub fn add(&mut self, sink: Box<dyn Sink>) {
        self.sinks.push(sink);
    }

    /// Gives one tick to every sink.
    ///
    /// # Errors
    /// The first [`SinkError`].
    pub fn write(&mut self, tick: Tick<'_>) -> Result<(), SinkError> {
        self.sinks.iter_mut().try_for_each(|sink| sink.write(tick))
    }

    /// Closes every sink, whatever happens to the others.
    ///
    /// # Errors
    /// The first [`SinkError`]; the others are logged.
    pub fn finish(mut self, summary: &Summary) -> Result<(), SinkError> {
        let mut result = Ok(());
        for sink in &mut self.sinks {
            if let Err(error) = sink.finish(summary) {
                tracing::error!(%error, "an output could not be completed");
                result = result.and(Err(error));
            }
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_registry_describes_itself() {
        let names: BTreeSet<_> = registry().iter().map(|info| info.name).collect();
        let files: BTreeSet<_> = registry().iter().map(|info| info.file).collect();
        assert_eq!(names.len(), registry().len());
        assert_eq!(files.len(), registry().len());
        for info in registry() {
            assert!(
                info.summary.ends_with('.') && info.summary.len() > 20,
                "{}",
                info.name
            );
            assert!(info.name.chars().all(|c| c.is_ascii_lowercase()), "{}", info.name);
            assert_ne!(info.name, "directory");
        }
    }
}
