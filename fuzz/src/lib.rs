//! Damaged files for everything that reads bytes from outside: none may make it panic, hang or exhaust the memory,
//! and what is read of them must be usable.
//!
//! * [`TARGETS`] — what is fed, each with small seeds of its own; one line adds a target.
//! * [`run`] — damages seeds and what came of them, keeps what showed something new, and reports what went wrong.
//!
//! A run depends on nothing but its seed and the code, so what it found can be found again. `README.md` says how long
//! runs are started, and how the compiler's coverage guides them.

mod coverage;
mod guard;
mod memory;
mod mutate;
mod random;
mod run;
mod shrink;
mod targets;

pub use run::{Finding, Options, Report, run, run_one};
pub use targets::{TARGETS, Target, Trial, Verdict};
