//! Scenarios and the world that comes of them: everything that needs neither pictures nor sound.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a helper of a test fails it by panicking"
)]

mod bodies;
mod common;
mod devices;
mod experiments;
mod refusals;
mod scenes;
mod truth;
