//! Putting a run aside and going on.

use super::Engine;
use crate::error::EngineError;
use crate::saved::{SavedRun, fingerprint};
use crate::summary::FaultBook;
use hearsight_systems::StateError;

impl Engine {
    /// Puts the run aside as it is after the last step.
    ///
    /// # Errors
    /// [`EngineError::State`] where the system cannot write its state.
    pub fn save(&self) -> Result<SavedRun, EngineError> {
        Ok(SavedRun {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            fingerprint: fingerprint(&self.configuration),
            ticks: self.counts.ticks,
            tick: self.moment.tick,
            first: self.first,
            counts: self.counts.clone(),
            last_track: self.last_track,
            faults: self.faults.list(),
            system: self.system.save()?,
        })
    }

    /// Goes on where a saved run of the same configuration was put aside: recordings are read up to there without
    /// tracking, live sources go on now. To be called before the first step.
    ///
    /// # Errors
    /// [`EngineError::State`] where the run is of another version or configuration, or the recordings end before it.
    pub fn restore(&mut self, saved: &SavedRun) -> Result<(), EngineError> {
        let foreign = |what: &str| StateError::Foreign(what.to_owned());
        if saved.version != env!("CARGO_PKG_VERSION") {
            return Err(foreign(&format!("it is of version {}", saved.version)).into());
        }
        if saved.fingerprint != fingerprint(&self.configuration) {
            return Err(foreign("its sensors, system, parameters, seed or beginning differ").into());
        }
        if self.counts.ticks > 0 {
            return Err(foreign("this run has already begun").into());
        }
        while !self.live && saved.ticks > 0 {
            if !self.advance() {
                return Err(foreign("the recordings end before it").into());
            }
            if self.moment.tick >= saved.tick {
                break;
            }
        }
        self.system.restore(&saved.system)?;
        self.counts = saved.counts.clone();
        self.restored_ticks = saved.counts.ticks;
        self.last_track = saved.last_track;
        self.first = saved.first;
        self.faults = FaultBook::from_list(saved.faults.clone());
        Ok(())
    }
}
