//! A run that was put aside: where it was, and what the system believed.

use crate::config::ResolvedRoom;
use crate::error::EngineError;
use crate::summary::{Counts, FaultSummary};
use hearsight_core::Instant;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Begins every file of a saved run; its last byte is the version of the format.
const MAGIC: &[u8; 8] = b"hearsav\x01";

/// A run that was put aside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedRun {
    /// Version of the program.
    pub version: String,
    /// What the run was made of: sensors, system and parameters, seed and tick, in a few bytes.
    pub fingerprint: u64,
    /// Ticks so far.
    pub ticks: u64,
    /// Number of the last tick.
    pub tick: u64,
    /// Time of the first tick.
    pub first: Option<Instant>,
    /// What was counted.
    pub counts: Counts,
    /// Identity of the newest track that was counted.
    pub last_track: u64,
    /// Faults so far.
    pub faults: Vec<FaultSummary>,
    /// What the system believes.
    pub system: Vec<u8>,
}

impl SavedRun {
    /// The run as bytes.
    ///
    /// # Errors
    /// [`EngineError::State`] where it cannot be written.
    pub fn to_bytes(&self) -> Result<Vec<u8>, EngineError> {
        let content = postcard::to_stdvec(self)
            .map_err(|error| hearsight_systems::StateError::Write(error.to_string()))?;
        Ok([MAGIC.as_slice(), &content].concat())
    }

    /// The run of these bytes.
    ///
    /// # Errors
    /// [`EngineError::State`] where they are none.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, EngineError> {
        let foreign = |what: &str| hearsight_systems::StateError::Foreign(what.to_owned());
        let content = bytes
            .strip_prefix(MAGIC)
            .ok_or_else(|| foreign("it does not begin as one"))?;
        let saved = postcard::from_bytes(content).map_err(|error| foreign(&error.to_string()))?;
        Ok(saved)
    }

    /// Writes the run to a file, which is either complete or not there.
    ///
    /// # Errors
    /// [`EngineError::Saved`] where it cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), EngineError> {
        let failed = |error: std::io::Error| EngineError::Saved {
            path: path.to_path_buf(),
            reason: format!("the state cannot be written: {error}"),
            cure: "check that the directory is there, writable and has space".to_owned(),
        };
        let mut partial = path.as_os_str().to_owned();
        partial.push(".partial");
        std::fs::write(&partial, self.to_bytes()?).map_err(failed)?;
        std::fs::rename(&partial, path).map_err(failed)
    }

    /// Reads a run from a file.
    ///
    /// # Errors
    /// [`EngineError::Saved`] where it cannot be read or is none.
    pub fn read(path: &Path) -> Result<Self, EngineError> {
        let failed = |reason: String| EngineError::Saved {
            path: path.to_path_buf(),
            reason,
            cure: "name a file that `--save` of the same version wrote, or start without it".to_owned(),
        };
        let bytes = std::fs::read(path).map_err(|error| failed(format!("cannot be read: {error}")))?;
        Self::from_bytes(&bytes).map_err(|error| failed(error.to_string()))
    }
}

/// A number that differs between runs whose states must not be mixed. Paths, threads, outputs and the end do not
/// count: a recording may be moved and a run prolonged.
pub(crate) fn fingerprint(room: &ResolvedRoom) -> u64 {
    let sensors: Vec<_> = room
        .cameras
        .iter()
        .map(|camera| {
            let lens = camera
                .calibration
                .as_ref()
                .map(|lens| (lens.model, lens.pose, lens.size));
            (camera.name.as_str(), camera.start, camera.drift_ppm, lens)
        })
        .collect();
    let arrays: Vec<_> = room
        .arrays
        .iter()
        .map(|array| {
            (
                array.name.as_str(),
                array.start,
                &array.channels,
                array.camera,
                array.rate_hz,
            )
        })
        .map(|facts| format!("{facts:?}"))
        .collect();
    let microphones: Vec<_> = room.arrays.iter().map(|array| &array.microphones).collect();
    let run = (
        room.run.seed,
        room.run.from,
        room.run.tick,
        room.speed_of_sound_m_s,
    );
    let system = (&room.system.name, room.system.given.to_string());
    let text = format!("{sensors:?}{arrays:?}{microphones:?}{run:?}{system:?}");
    // FNV-1a: the same on every machine and in every version of the language, which `Hash` is not.
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
