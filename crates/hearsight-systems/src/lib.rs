//! The tracking systems of Hearsight, by name: compositions of bodies, cues, stages and life cycle, no algorithm.
//!
//! To add a system: its own file, its test, and one line in [`REGISTRY`].

pub mod closed_loop;
mod limits;
mod parallel;
pub mod stac;
pub mod three_mics;
mod views;

pub use hearsight_tracking::system::{Bars, StateError, System};

use hearsight_core::room::Room;
use serde_json::Value;

/// What a system says of itself.
#[derive(Clone, Copy)]
pub struct SystemInfo {
    /// Name as in `room.toml`.
    pub name: &'static str,
    /// One sentence for help.
    pub summary: &'static str,
    /// The paper.
    pub source: &'static str,
    /// JSON schema of the parameters, with meaning and default of each.
    pub parameters: fn() -> Value,
    build: Build,
}

/// Builds a system from its parameters, the room and the seed of the run.
type Build = fn(&Value, &Room, u64) -> Result<Box<dyn System>, SystemError>;

/// Every system there is.
pub const REGISTRY: &[SystemInfo] = &[stac::INFO, closed_loop::INFO, three_mics::INFO];

/// Why a system could not be built.
#[derive(Debug, thiserror::Error)]
pub enum SystemError {
    /// There is no system of that name.
    #[error("there is no system \"{name}\"; known are: {known}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// A parameter is unknown, of the wrong type or at odds with another.
    #[error("parameters of the system \"{system}\": {reason}")]
    Parameters {
        /// The system.
        system: &'static str,
        /// Which parameter, what is wrong and what is allowed.
        reason: String,
    },
    /// A number among the parameters is out of its range, or not finite.
    #[error("`system.{system}.{parameter}` is {value}, allowed is {least} to {greatest}")]
    Range {
        /// The system.
        system: &'static str,
        /// Which parameter, as a path with dots.
        parameter: String,
        /// What it is.
        value: f64,
        /// The least that is allowed.
        least: f64,
        /// The greatest that is allowed.
        greatest: f64,
    },
    /// The room lacks what the system needs.
    #[error("the system \"{system}\" cannot run in this room: {reason}")]
    Room {
        /// The system.
        system: &'static str,
        /// What is missing and what to do.
        reason: String,
    },
}

/// Builds the system called `name` for a room. `parameters` is an object with the system's own fields; a field that is
/// not there has its default.
///
/// # Errors
/// [`SystemError`] for an unknown system or parameter, or a room that lacks what the system needs.
pub fn build(name: &str, parameters: &Value, room: &Room, seed: u64) -> Result<Box<dyn System>, SystemError> {
    let Some(info) = REGISTRY.iter().find(|info| info.name == name) else {
        let known: Vec<&str> = REGISTRY.iter().map(|info| info.name).collect();
        return Err(SystemError::Unknown {
            name: name.into(),
            known: known.join(", "),
        });
    };
    (info.build)(parameters, room, seed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_system_describes_itself_and_its_parameters() {
        for info in REGISTRY {
            assert!(!info.summary.is_empty() && !info.source.is_empty());
            let schema = (info.parameters)();
            for (name, property) in schema["properties"].as_object().unwrap() {
                let described = property["description"]
                    .as_str()
                    .is_some_and(|text| !text.is_empty());
                assert!(described, "{}.{name} has no description", info.name);
            }
        }
    }

    #[test]
    fn an_unknown_system_is_named_with_those_that_are_known() {
        let error = build("stack", &Value::Null, &Room::default(), 0)
            .err()
            .unwrap()
            .to_string();
        assert!(error.contains("stack") && error.contains("stac"), "{error}");
    }
}
