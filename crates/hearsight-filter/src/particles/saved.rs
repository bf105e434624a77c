//! The saved form of particles: states and weights, no buffers, checked when read.

use super::Particles;
use crate::error::FilterError;
use serde::{Deserialize, Serialize};

/// What is written. A logarithmic weight of negative infinity is written as "none", since JSON has no infinity.
/// The linear weights are saved as well: computing them again could differ in the last bit, and a restored run must
/// go on exactly as the first would have.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Saved {
    columns: Vec<Vec<f32>>,
    log_weights: Vec<Option<f64>>,
    weights: Vec<f64>,
}

impl From<Particles> for Saved {
    fn from(particles: Particles) -> Self {
        Self {
            columns: particles.columns,
            log_weights: particles
                .log_weights
                .into_iter()
                .map(|weight| weight.is_finite().then_some(weight))
                .collect(),
            weights: particles.weights,
        }
    }
}

impl TryFrom<Saved> for Particles {
    type Error = FilterError;

    fn try_from(saved: Saved) -> Result<Self, FilterError> {
        let mut particles = Self::new(saved.columns.len(), saved.log_weights.len())?;
        let count = particles.count();
        FilterError::check_length("weights", count, saved.weights.len())?;
        for column in &saved.columns {
            FilterError::check_length("column", count, column.len())?;
        }
        let total: f64 = saved.weights.iter().sum();
        let sum_to_one = (total - 1.0).abs() <= 1e-9;
        if !sum_to_one || saved.weights.iter().any(|weight| *weight < 0.0) {
            return Err(FilterError::OutOfRange {
                what: "the sum of the weights",
                range: "one",
                found: total,
            });
        }
        particles.columns = saved.columns;
        particles.weights = saved.weights;
        particles.log_weights = saved
            .log_weights
            .into_iter()
            .map(|weight| weight.unwrap_or(f64::NEG_INFINITY))
            .collect();
        Ok(particles)
    }
}
