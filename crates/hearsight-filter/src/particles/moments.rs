//! Summaries of weighted particles, accumulated in `f64`.

use super::Particles;
use crate::elementary::sum_of_pairs;
use crate::error::FilterError;

const BLOCK: usize = 128;

impl Particles {
    /// `1 / sum(weight^2)`: how many equal particles would be as good, from 1 to their number (Kong, Liu and Wong
    /// 1994).
    pub fn effective_sample_size(&self) -> f64 {
        // At least one by rounding, so that nothing above has to guard a division.
        (1.0 / sum_of_pairs(&self.weights, &self.weights, |a, b| a * b)).clamp(1.0, self.count() as f64)
    }

    /// The weighted mean of one dimension. A dimension that does not exist panics, as indexing a slice does.
    ///
    /// Non-finite states that [`normalize`](Self::normalize) has not seen yet are left out; NaN if no other is left.
    pub fn mean_of(&self, dimension: usize) -> f64 {
        let column = self.column(dimension);
        let mean = sum_of_pairs(&self.weights, column, |weight, value| weight * f64::from(value));
        if mean.is_finite() {
            mean
        } else {
            self.mean_of_finite(column)
        }
    }

    #[cold]
    fn mean_of_finite(&self, column: &[f32]) -> f64 {
        let finite = |value: f32| if value.is_finite() { f64::from(value) } else { 0.0 };
        let sum = sum_of_pairs(&self.weights, column, |weight, value| weight * finite(value));
        sum / sum_of_pairs(&self.weights, column, |weight, value| {
            if value.is_finite() { weight } else { 0.0 }
        })
    }

    /// Writes the weighted mean of every dimension.
    ///
    /// # Errors
    /// [`FilterError::SizeMismatch`] unless `mean` has one place for each dimension.
    pub fn mean_into(&self, mean: &mut [f64]) -> Result<(), FilterError> {
        FilterError::check_length("mean", self.dimensions(), mean.len())?;
        for (dimension, mean) in mean.iter_mut().enumerate() {
            *mean = self.mean_of(dimension);
        }
        Ok(())
    }

    /// The weighted mean of every dimension, in a new vector.
    pub fn mean(&self) -> Vec<f64> {
        (0..self.dimensions())
            .map(|dimension| self.mean_of(dimension))
            .collect()
    }

    /// The weighted covariance of two dimensions, `sum(w (x - mean x) (y - mean y))`: of the distribution that the
    /// particles stand for, without the factor n / (n - 1). A dimension that does not exist panics.
    ///
    /// NaN if a state is not finite; cannot happen after [`normalize`](Self::normalize).
    pub fn covariance_of(&self, first: usize, second: usize) -> f64 {
        let (first_mean, second_mean) = (self.mean_of(first), self.mean_of(second));
        self.covariance_about(first, first_mean, second, second_mean)
    }

    fn covariance_about(&self, first: usize, first_mean: f64, second: usize, second_mean: f64) -> f64 {
        let (first, second) = (self.column(first), self.column(second));
        // Three slices: the products are summed in blocks of the eight lanes of `sum_of_pairs`.
        let mut total = 0.0;
        let blocks = first
            .chunks(BLOCK)
            .zip(second.chunks(BLOCK))
            .zip(self.weights.chunks(BLOCK));
        let mut products = [0.0; BLOCK];
        for ((first, second), weights) in blocks {
            for ((product, x), y) in products.iter_mut().zip(first).zip(second) {
                *product = (f64::from(*x) - first_mean) * (f64::from(*y) - second_mean);
            }
            total += sum_of_pairs(weights, &products[..weights.len()], |weight, product| {
                weight * product
            });
        }
        total
    }

    /// Writes the covariance matrix, dimensions x dimensions, row by row.
    ///
    /// # Errors
    /// [`FilterError::SizeMismatch`] unless `covariance` has dimensions x dimensions places.
    pub fn covariance_into(&self, covariance: &mut [f64]) -> Result<(), FilterError> {
        let dimensions = self.dimensions();
        FilterError::check_length("covariance", dimensions * dimensions, covariance.len())?;
        for row in 0..dimensions {
            let row_mean = self.mean_of(row);
            for column in 0..=row {
                let value = self.covariance_about(row, row_mean, column, self.mean_of(column));
                covariance[row * dimensions + column] = value;
                covariance[column * dimensions + row] = value;
            }
        }
        Ok(())
    }

    /// The weighted circular mean of a dimension that is an angle in radians, in `(-pi, pi]`, and the length of the
    /// mean direction: 1 if all agree, 0 if they cancel, when the angle means nothing.
    ///
    /// Uses the platform's sine, so its last bit may differ between systems. A dimension that does not exist panics.
    pub fn circular_mean_of(&self, dimension: usize) -> (f64, f64) {
        let column = self.column(dimension);
        let sine = sum_of_pairs(&self.weights, column, |weight, angle| {
            weight * f64::from(angle).sin()
        });
        let cosine = sum_of_pairs(&self.weights, column, |weight, angle| {
            weight * f64::from(angle).cos()
        });
        (sine.atan2(cosine), sine.hypot(cosine).min(1.0))
    }

    /// The particle of the greatest weight; the first of several.
    pub fn heaviest(&self) -> usize {
        let mut heaviest = 0;
        for (particle, log_weight) in self.log_weights.iter().enumerate() {
            if *log_weight > self.log_weights[heaviest] {
                heaviest = particle;
            }
        }
        heaviest
    }
}
