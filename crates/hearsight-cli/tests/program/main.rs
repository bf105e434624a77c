//! The real program, on a recording that it makes itself.

#![expect(clippy::unwrap_used, reason = "a helper of a test fails it by panicking")]

mod bad_input;
mod calibrating;
mod common;
mod contracts;
mod judging;
mod reproducing;
mod simulated;
