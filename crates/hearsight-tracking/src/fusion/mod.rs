//! Fusion: gives the raw scores of cues a meaning and turns them into logarithmic weights.
//!
//! To add a rule: its own file, its test, one line here.

mod calibration;
mod product;

pub use calibration::Calibration;
pub use product::{Product, Term};

use crate::cues::Evidence;

/// Combines raw scores, one row a cue, into logarithmic weights.
pub trait Fusion: Send + Sync {
    /// Adds each hypothesis' log-likelihood to `log_weights`. `scores` holds one row a cue, in the order of the
    /// system's cues; a row marked missing is left out.
    fn fuse(&self, scores: &[Vec<f32>], evidence: &[Evidence], log_weights: &mut [f64]);

    /// The log-likelihood of one raw score of the cue in row `cue`.
    fn log_likelihood(&self, cue: usize, score: f32) -> f64;
}
