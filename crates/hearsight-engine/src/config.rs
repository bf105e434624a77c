//! `room.toml`, in two stages: raw text, then resolved objects.
//!
//! [`raw`] holds what people may write, [`parse`] turns text into it and does nothing else, [`resolve`] reads the
//! files that it names and checks that it makes sense. Paths are relative to the configuration file.

mod geometry;
mod panoramas;
mod parameters;
mod parse;
pub mod raw;
mod resolve;
mod resolved;
mod sensors;

pub use hearsight_core::configuration::{ConfigurationError, Overrides, Problem};
pub use parse::{parse, room_schema};
pub use resolve::{load, load_room, resolve};
pub use resolved::{
    Input, ResolvedArray, ResolvedCamera, ResolvedOutput, ResolvedRing, ResolvedRoom, ResolvedRun,
    ResolvedSystem,
};
