//! Why an engine could not be opened, or a run not go on; a variant for each thing that a caller can do.

use crate::config::ConfigurationError;
use crate::sinks::SinkError;
use hearsight_core::calibration::CalibrationError;
use hearsight_media::{MediaError, MomentError};
use hearsight_systems::{StateError, SystemError};
use std::path::PathBuf;

/// Why an engine could not be opened, or a run not go on.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum EngineError {
    /// Something in `room.toml` is wrong: correct it.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Configuration(#[from] ConfigurationError),
    /// A camera or array cannot be opened: mend or replace what it reads.
    #[error("{sensor}: {error}")]
    #[diagnostic(code(hearsight::sensor))]
    Sensor {
        /// The sensor's name.
        sensor: String,
        /// What is wrong. It is part of the message, and so no source of its own, which would be printed again.
        error: MediaError,
    },
    /// The sensors do not fit each other or their geometry: correct the configuration.
    #[error("{what}")]
    #[diagnostic(code(hearsight::room))]
    Room {
        /// Sensor, value, and what is wrong with it.
        what: String,
        /// What helps.
        #[help]
        cure: String,
    },
    /// Sources of the caller's own are not one for each sensor: give as many.
    #[error(
        "the configuration has {} cameras and {} arrays, but {} and {} sources are given",
        wanted[0], wanted[1], given[0], given[1]
    )]
    #[diagnostic(
        code(hearsight::sources),
        help("give one source for each sensor, in the configuration's order")
    )]
    Sources {
        /// Cameras and arrays of the configuration.
        wanted: [usize; 2],
        /// Sources of cameras and arrays.
        given: [usize; 2],
    },
    /// Ticks cannot be made: correct the configuration.
    #[error(transparent)]
    #[diagnostic(code(hearsight::room))]
    Moments(#[from] MomentError),
    /// A calibration does not fit its camera: name another, or leave it out.
    #[error("camera {camera}: {error}")]
    #[diagnostic(
        code(hearsight::calibration),
        help("name the calibration of this very camera and resolution (is `index` right?)")
    )]
    Calibration {
        /// The camera's name.
        camera: String,
        /// What is wrong, part of the message.
        error: CalibrationError,
    },
    /// The system refuses the room or its parameters: correct the configuration.
    #[error(transparent)]
    #[diagnostic(code(hearsight::system))]
    System(#[from] SystemError),
    /// An output cannot be written: free space or choose another directory. What was written before is closed.
    #[error(transparent)]
    #[diagnostic(
        code(hearsight::output),
        help("check that the directory is writable and has space, or choose another with --out")
    )]
    Output(#[from] SinkError),
    /// A saved state cannot be written or taken over: start without it.
    #[error("{}: {reason}", path.display())]
    #[diagnostic(code(hearsight::state))]
    Saved {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
        /// What helps.
        #[help]
        cure: String,
    },
    /// A state in memory cannot be made or taken over.
    #[error(transparent)]
    #[diagnostic(code(hearsight::state))]
    State(#[from] StateError),
    /// The machine gives no threads.
    #[error("{threads} threads cannot be started: {reason}")]
    #[diagnostic(code(hearsight::threads), help("ask for fewer with --threads"))]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
}
