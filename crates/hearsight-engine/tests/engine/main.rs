//! The engine from outside: configuration, outputs and stepping.

#![expect(clippy::unwrap_used, reason = "a helper of a test fails it by panicking")]

mod configuration;
mod mutations;
mod outputs;
