//! From `room.toml` to scenes: opens sensors, drives a system tick by tick, writes results, saves and restores.
//!
//! * [`config`] — the configuration, in two stages.
//! * [`Engine`] — sources and system of one room; [`Engine::step`] gives a scene a tick.
//! * [`run`] — the whole run with its outputs; [`sinks`] — what is written.
//! * [`check`] — is this room sane?
//!
//! No algorithm of tracking lives here, and nothing of the command line.

pub mod check;
pub mod config;
mod engine;
mod error;
mod progress;
mod run;
mod saved;
pub mod sinks;
mod sources;
mod summary;

pub use engine::Engine;
pub use error::EngineError;
pub use progress::Progress;
pub use run::run;
pub use saved::SavedRun;
pub use sinks::{Outputs, Sink, SinkError, Tick};
pub use summary::{Counts, FaultSummary, Outcome, StageTime, Summary};
