//! Scenario files, in two stages: raw text, then a resolved [`World`].
//!
//! [`raw`] holds what people may write; [`load`] and [`resolve`] fill in what is not said, draw what is left to the seed,
//! and refuse what cannot be: people in walls, sources outside the room, times out of order. Errors name the entry.
//! Nothing is rendered here, and no file but the scenario is read; recordings and photographs are checked to exist.

mod actions;
mod arrays;
mod bases;
mod cameras;
mod checks;
mod colours;
mod conversations;
mod furniture;
mod lenses;
mod looks;
mod names;
mod people;
pub mod raw;
mod resolve;
mod sounds;
mod surroundings;
mod walls;
mod wandering;

pub use resolve::{load, resolve};

use crate::world::World;
use hearsight_core::configuration::{ConfigurationError, Overrides, parse};

/// The JSON schema of a scenario file, generated from the types.
pub fn scenario_schema() -> serde_json::Value {
    schemars::schema_for!(raw::RawScene).to_value()
}

/// Reads and resolves the text of a scenario that is not in a file; `name` is what errors call it. Paths are relative
/// to the working directory.
///
/// # Errors
/// [`ConfigurationError`] where something in it is wrong.
pub fn from_text(name: &str, text: &str, overrides: &Overrides) -> Result<World, ConfigurationError> {
    let raw: raw::RawScene = parse(name, text, overrides)?;
    resolve(&raw, name, text, std::path::Path::new(""), "scene")
}
