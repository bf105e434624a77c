//! What the engine sees of a system: it takes moments and gives scenes.

use hearsight_core::{Moment, record::Scene};
use std::time::Duration;

/// Columns of a picture that the overlay marks, pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bars {
    /// Where sound alone says that somebody speaks.
    pub sound: Option<f32>,
    /// Where the fused result says so.
    pub fused: Option<f32>,
}

/// A complete tracking system, ready to run.
///
/// The same moments in the same order give the same scenes, whatever the number of threads. A system that was saved
/// and restored into a fresh instance of the same configuration goes on with the same bytes.
pub trait System: Send {
    /// Name as in `room.toml`.
    fn name(&self) -> &'static str;

    /// Takes one moment and fills `scene` with what is believed now, reusing its memory.
    fn step(&mut self, moment: &Moment, scene: &mut Scene);

    /// Everything that the next steps depend on.
    ///
    /// # Errors
    /// [`StateError`] where the state cannot be written.
    fn save(&self) -> Result<Vec<u8>, StateError>;

    /// Takes over what [`System::save`] of the same version and configuration returned. On error nothing changes.
    ///
    /// # Errors
    /// [`StateError`] where the bytes are not such a state.
    fn restore(&mut self, state: &[u8]) -> Result<(), StateError>;

    /// Time spent since the start in each stage, by name, in the order of the data's way.
    fn timings(&self) -> Vec<(&'static str, Duration)>;

    /// Curve of correlation over the picture's columns heard in the last step by the array paired with `camera`, for
    /// the overlay: values 0 to 1 from the left edge to the right one. Empty without sound.
    fn correlation_strip(&self, camera: usize) -> &[f32];

    /// What this system cannot do in this room, each with its reason and cure: for people who expect it. Default nothing.
    fn warnings(&self) -> &[String] {
        &[]
    }

    /// Columns to mark in the picture of `camera`; none unless a system has them.
    fn bars(&self, _camera: usize) -> Bars {
        Bars::default()
    }

    /// Reliabilities, 0 to 1, of the contour, colour and sound trackers of a track in the picture of `camera`; none unless a
    /// system has such trackers.
    fn reliabilities(&self, _camera: usize, _track: u64) -> Option<[f64; 3]> {
        None
    }

    /// Numbers that were not finite and were set aside since the start.
    fn quarantined(&self) -> u64;
}

/// Why a state could not be saved or restored.
#[derive(Debug, thiserror::Error)]
pub enum StateError {
    /// The state could not be written.
    #[error("the state could not be written: {0}")]
    Write(String),
    /// The bytes are not a state of this version and configuration.
    #[error("this is not a saved state of the same version, room and system ({0}); start without it")]
    Foreign(String),
}
