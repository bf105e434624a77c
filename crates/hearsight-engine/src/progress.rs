//! How far a run is.

use hearsight_core::{Instant, Span};

/// How far a run is, on the common clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Where the run began.
    pub start: Instant,
    /// The last tick.
    pub position: Instant,
    /// Where it will end; nothing for live sources.
    pub end: Option<Instant>,
    /// Ticks so far.
    pub ticks: u64,
    /// Tracks published in the last scene.
    pub tracks: usize,
}

impl Progress {
    /// Time of the recording that is done.
    pub fn done(&self) -> Span {
        self.position - self.start
    }

    /// Part that is done, 0 to 1; nothing where the end is unknown.
    pub fn part(&self) -> Option<f64> {
        let whole = (self.end? - self.start).seconds();
        (whole > 0.0).then(|| (self.done().seconds() / whole).clamp(0.0, 1.0))
    }
}
