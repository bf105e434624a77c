//! Configuration files that people write: TOML text to typed values, and errors that point at the place in the text.
//!
//! `room.toml` and scenario files go the same way: text becomes raw values here, where an unknown key is an error with
//! a suggestion, and whoever owns the format resolves them, pointing at a [`Field`] of the [`Document`] where something
//! is wrong. Nothing here knows a key of any format.

mod document;
mod parse;
mod problem;

pub use document::{Document, Field, nearest, suggest};
pub use parse::{Overrides, parse};
pub use problem::{ConfigurationError, Problem};
