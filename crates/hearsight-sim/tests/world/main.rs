//! Scenarios and the world that comes of them: everything that needs neither pictures nor sound.

mod bodies;
mod common;
mod devices;
mod refusals;
mod scenes;
mod truth;
