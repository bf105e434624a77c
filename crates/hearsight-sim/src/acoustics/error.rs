//! What can be wrong with a room, its sources, its microphones or their sounds.

use hearsight_core::WorldPoint;
use std::path::PathBuf;
use thiserror::Error;

/// An error of acoustics or voices. Each names the entry that is wrong and what would be right.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum AcousticsError {
    /// A setting is out of its range.
    #[error("{entry} must be {rule}, but is {value}")]
    Setting {
        /// Which setting, perhaps with the name of its owner.
        entry: String,
        /// What it must be.
        rule: &'static str,
        /// What it is.
        value: f64,
    },
    /// A source or a microphone is not within the walls, or nowhere at all.
    #[error(
        "{entry} at {time_s:.3} s is at ({:.3}, {:.3}, {:.3}) m, outside the room from ({:.3}, {:.3}, {:.3}) to \
         ({:.3}, {:.3}, {:.3}) m: move it inside or make the room larger",
        position.0.x, position.0.y, position.0.z, lowest.0.x, lowest.0.y, lowest.0.z, highest.0.x, highest.0.y, highest.0.z
    )]
    Outside {
        /// Which source or microphone.
        entry: String,
        /// When, seconds of the scenario.
        time_s: f64,
        /// Where it is, metres.
        position: WorldPoint,
        /// The room's corner with the smallest coordinates, metres.
        lowest: WorldPoint,
        /// The room's corner with the largest coordinates, metres.
        highest: WorldPoint,
    },
    /// No absorption gives the reverberation time in this room.
    #[error(
        "{entry} is {wanted_s} s, which no absorption of up to {:.0} % of a wall's sound reaches in a room of this \
         size: choose at least {shortest_s:.2} s, a smaller room, or anechoic walls",
        100.0 * most_absorbed
    )]
    Unreachable {
        /// Which setting.
        entry: String,
        /// The reverberation time asked for, seconds.
        wanted_s: f64,
        /// The shortest one that this room can have, seconds.
        shortest_s: f64,
        /// The largest absorption that is tried, a share of the sound's energy.
        most_absorbed: f64,
    },
    /// Numbers of things that must be equal are not.
    #[error("{entry}: expected {expected}, found {found}")]
    Count {
        /// What is counted.
        entry: String,
        /// How many there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A sound has another rate than the renderer.
    #[error(
        "{entry} has {found_hz} samples a second, the renderer {expected_hz}: make the sound at {expected_hz} Hz"
    )]
    Rate {
        /// Whose sound.
        entry: String,
        /// Samples a second of the renderer.
        expected_hz: u32,
        /// Samples a second of the sound.
        found_hz: u32,
    },
    /// A file or folder of sound cannot be used.
    #[error("{path}: {reason}", path = path.display())]
    File {
        /// Which one.
        path: PathBuf,
        /// Why not, and what would do.
        reason: String,
    },
    /// The Fourier transform refused its buffers.
    #[error("Fourier transform: {0}")]
    Transform(String),
}

impl From<realfft::FftError> for AcousticsError {
    fn from(error: realfft::FftError) -> Self {
        Self::Transform(error.to_string())
    }
}

/// An error where a setting breaks its rule; a value that is not a number breaks every rule.
pub(crate) fn check(
    holds: bool,
    entry: impl Into<String>,
    rule: &'static str,
    value: f64,
) -> Result<(), AcousticsError> {
    if holds {
        return Ok(());
    }
    Err(AcousticsError::Setting {
        entry: entry.into(),
        rule,
        value,
    })
}
