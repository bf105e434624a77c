//! The judge: results and truth to metrics and reports. Tracks nothing and knows no tracker.
//!
//! * [`statistics`] — intervals and tests for experiments with many seeds.

pub mod statistics;
