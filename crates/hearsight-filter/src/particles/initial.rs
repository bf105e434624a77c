//! First states: drawn from a Gaussian or evenly from a box.

use super::Particles;
use crate::error::FilterError;
use crate::random::{fill_standard_normal, uniform};
use rand::Rng;

impl Particles {
    /// Draws every dimension independently from a Gaussian and makes the weights equal.
    ///
    /// `mean` and `sigma` (standard deviation, not negative): one value a dimension, in its unit.
    ///
    /// # Errors
    /// [`FilterError::SizeMismatch`], [`FilterError::NotFinite`] for a mean or [`FilterError::OutOfRange`] for a sigma.
    pub fn draw_gaussian(
        &mut self,
        mean: &[f64],
        sigma: &[f64],
        generator: &mut impl Rng,
    ) -> Result<(), FilterError> {
        FilterError::check_length("mean", self.dimensions(), mean.len())?;
        FilterError::check_length("sigma", self.dimensions(), sigma.len())?;
        if mean.iter().any(|mean| !mean.is_finite()) {
            return Err(FilterError::NotFinite { what: "mean" });
        }
        for sigma in sigma {
            FilterError::check_not_negative("sigma", *sigma)?;
        }
        for ((column, mean), sigma) in self.columns.iter_mut().zip(mean).zip(sigma) {
            fill_standard_normal(generator, column);
            for value in column {
                *value = (mean + sigma * f64::from(*value)) as f32;
            }
        }
        self.make_uniform();
        Ok(())
    }

    /// Draws every dimension evenly between `low` and `high` (one value a dimension, in its unit; low <= high) and
    /// makes the weights equal.
    ///
    /// # Errors
    /// [`FilterError::SizeMismatch`], or [`FilterError::OutOfRange`] unless the bounds are finite and in order.
    pub fn draw_uniform(
        &mut self,
        low: &[f64],
        high: &[f64],
        generator: &mut impl Rng,
    ) -> Result<(), FilterError> {
        FilterError::check_length("low", self.dimensions(), low.len())?;
        FilterError::check_length("high", self.dimensions(), high.len())?;
        for (low, high) in low.iter().zip(high) {
            FilterError::check_not_negative("high - low", high - low)?;
        }
        for ((column, low), high) in self.columns.iter_mut().zip(low).zip(high) {
            for value in column {
                *value = (low + (high - low) * uniform(generator)) as f32;
            }
        }
        self.make_uniform();
        Ok(())
    }
}
