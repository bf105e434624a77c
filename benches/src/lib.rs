//! What the benchmarks measure: named pieces of work on the public interface, and what they work on.
//!
//! The suite (`cargo bench -p hearsight-benches`) measures each alone; the program `one` runs them by name for
//! `compare.py`, which measures the same work of other libraries in turn with it. A piece of work is added by one
//! line in [`KERNELS`].

mod curves;
mod inputs;
mod kernels;
mod rooms;

pub use curves::{Curves, curves, sittings};
pub use inputs::{Inputs, Picture};
pub use kernels::{KERNELS, Kernel, Topic, Work};
pub use rooms::{Dice, Sitting, standing};

/// What kept a piece of work from being prepared.
pub type Failure = Box<dyn std::error::Error>;
