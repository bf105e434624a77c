//! Weighted hypotheses in structure of arrays, with logarithmic weights.
//!
//! [`Particles`] holds the states of one belief, one contiguous column a dimension, so that motion models and cues run
//! over columns in vector instructions. What a dimension means is the owner's affair. Non-finite states and weights
//! are set aside here, once, so that nothing above has to look for them.

mod initial;
mod moments;
mod normalization;
mod resample;
mod saved;

pub use normalization::{Normalization, NormalizationOutcome};

use crate::elementary;
use crate::error::FilterError;
use serde::{Deserialize, Serialize};

/// Weighted states: dimensions x particles.
///
/// States are `f32`: a pixel or a metre keeps six digits, which is finer than any sensor here, at half the memory and
/// twice the speed of `f64`. Logarithmic weights are `f64`: the log-likelihood of thousands of pixels and samples
/// reaches a million, where `f32` steps by 0.06, which is 6 % of a weight. Sums over particles are `f64`.
///
/// The linear weights are those of the last [`normalize`](Self::normalize); every method that changes the logarithmic
/// weights normalizes before it returns. After that every state is finite and the weights sum to one.
///
/// ```
/// use hearsight_filter::{Particles, Resampling, generator};
///
/// let mut random = generator(1, "track", 0);
/// let mut particles = Particles::new(2, 1000)?;
/// particles.draw_gaussian(&[3.0, 1.0], &[0.5, 0.5], &mut random)?;
/// let report = particles.reweight(|columns, log_weights| {
///     for (log_weight, x) in log_weights.iter_mut().zip(&columns[0]) {
///         *log_weight -= 0.5 * f64::from((x - 3.2) / 0.1).powi(2);
///     }
/// });
/// assert_eq!(report.quarantined, 0);
/// particles.resample(Resampling::Systematic, &mut random)?;
/// assert!((particles.mean_of(0) - 3.2).abs() < 0.05);
/// # Ok::<(), hearsight_filter::FilterError>(())
/// ```
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "saved::Saved", into = "saved::Saved")]
pub struct Particles {
    columns: Vec<Vec<f32>>,
    log_weights: Vec<f64>,
    weights: Vec<f64>,
    /// The other buffer of resampling: columns are gathered into it and exchanged with it, one after another.
    spare: Vec<f32>,
    ancestors: Vec<u32>,
}

impl PartialEq for Particles {
    /// Compares states and weights, not buffers.
    fn eq(&self, other: &Self) -> bool {
        self.columns == other.columns
            && self.log_weights == other.log_weights
            && self.weights == other.weights
    }
}

impl Particles {
    /// `count` particles of `dimensions` dimensions, all states zero, weights uniform.
    ///
    /// # Errors
    /// [`FilterError::OutOfRange`] unless there are 1 to 2^32 - 1 particles and at least one dimension.
    pub fn new(dimensions: usize, count: usize) -> Result<Self, FilterError> {
        if dimensions == 0 {
            return Err(FilterError::OutOfRange {
                what: "dimensions",
                range: "at least 1",
                found: 0.0,
            });
        }
        if count == 0 || count >= u32::MAX as usize {
            return Err(FilterError::OutOfRange {
                what: "the number of particles",
                range: "from 1 to 2^32 - 2",
                found: count as f64,
            });
        }
        let mut particles = Self {
            columns: vec![vec![0.0; count]; dimensions],
            log_weights: vec![0.0; count],
            weights: vec![0.0; count],
            spare: vec![0.0; count],
            ancestors: vec![0; count],
        };
        particles.make_uniform();
        Ok(particles)
    }

    /// How many particles there are, at least one.
    pub fn count(&self) -> usize {
        self.log_weights.len()
    }

    /// How many dimensions a state has, at least one.
    pub fn dimensions(&self) -> usize {
        self.columns.len()
    }

    /// All columns: dimensions x particles.
    pub fn columns(&self) -> &[Vec<f32>] {
        &self.columns
    }

    /// One dimension of all particles. A dimension that does not exist panics, as indexing a slice does.
    pub fn column(&self, dimension: usize) -> &[f32] {
        &self.columns[dimension]
    }

    /// One dimension of all particles, to change. A dimension that does not exist panics, as indexing a slice does.
    pub fn column_mut(&mut self, dimension: usize) -> &mut [f32] {
        &mut self.columns[dimension]
    }

    /// Several dimensions at once, to change.
    ///
    /// # Errors
    /// [`FilterError::BadIndex`] if one does not exist or is named twice.
    pub fn columns_mut<const N: usize>(
        &mut self,
        dimensions: [usize; N],
    ) -> Result<[&mut [f32]; N], FilterError> {
        self.check_dimensions(&dimensions)?;
        let index = dimensions.first().copied().unwrap_or(0);
        let available = self.columns.len();
        match self.columns.get_disjoint_mut(dimensions) {
            Ok(columns) => Ok(columns.map(Vec::as_mut_slice)),
            Err(_) => Err(FilterError::BadIndex {
                what: "dimension",
                index,
                available,
            }),
        }
    }

    pub(crate) fn check_dimensions(&self, dimensions: &[usize]) -> Result<(), FilterError> {
        let available = self.dimensions();
        for (position, index) in dimensions.iter().enumerate() {
            if *index >= available || dimensions[..position].contains(index) {
                return Err(FilterError::BadIndex {
                    what: "dimension",
                    index: *index,
                    available,
                });
            }
        }
        Ok(())
    }

    /// The state of one particle, dimension by dimension. One that does not exist panics.
    pub fn state(&self, particle: usize) -> impl ExactSizeIterator<Item = f32> + '_ {
        self.columns.iter().map(move |column| column[particle])
    }

    /// Sets the state of one particle; its weight stays.
    ///
    /// # Errors
    /// [`FilterError::BadIndex`] if there is no such particle, [`FilterError::SizeMismatch`] for another number of
    /// dimensions.
    pub fn set_state(&mut self, particle: usize, state: &[f32]) -> Result<(), FilterError> {
        FilterError::check_length("state", self.dimensions(), state.len())?;
        if particle >= self.count() {
            return Err(FilterError::BadIndex {
                what: "particle",
                index: particle,
                available: self.count(),
            });
        }
        for (column, value) in self.columns.iter_mut().zip(state) {
            column[particle] = *value;
        }
        Ok(())
    }

    /// The weights as of the last normalization: not negative, sum one.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The logarithms of the weights; negative infinity for a weight of zero. They tell weights apart that are too
    /// small for [`weights`](Self::weights).
    pub fn log_weights(&self) -> &[f64] {
        &self.log_weights
    }

    /// Gives every particle the same weight.
    pub fn make_uniform(&mut self) {
        let weight = 1.0 / self.count() as f64;
        self.weights.fill(weight);
        self.log_weights.fill(elementary::ln(weight));
    }

    /// Changes the logarithmic weights in place, given all columns, and normalizes.
    ///
    /// `change` gets the columns (dimensions x particles) and the logarithms of the normalized weights.
    pub fn reweight(&mut self, change: impl FnOnce(&[Vec<f32>], &mut [f64])) -> Normalization {
        change(&self.columns, &mut self.log_weights);
        self.normalize()
    }

    /// Adds one log-likelihood (or logarithm of an importance weight) to each particle and normalizes.
    ///
    /// # Errors
    /// [`FilterError::SizeMismatch`] unless there is one for each particle.
    pub fn add_log_likelihoods(&mut self, log_likelihoods: &[f64]) -> Result<Normalization, FilterError> {
        FilterError::check_length("log-likelihoods", self.count(), log_likelihoods.len())?;
        for (log_weight, log_likelihood) in self.log_weights.iter_mut().zip(log_likelihoods) {
            *log_weight += log_likelihood;
        }
        Ok(self.normalize())
    }
}

#[cfg(test)]
#[path = "particles/tests.rs"]
mod tests;
