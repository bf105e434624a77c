//! The unscented Kalman filter in the scaled form: for measurements that are no linear function of the state.
//!
//! Sigma points, weights and order of steps are those of Wan and van der Merwe 2000 and of filterpy, against which the
//! numbers are tested. Noise is additive, so the state need not be augmented.

use crate::error::FilterError;
use nalgebra::{Cholesky, SMatrix, SVector};
use serde::{Deserialize, Serialize};

/// Where sigma points are placed and how they count.
///
/// The points are the mean and `mean ± sqrt((n + lambda) P)` with `lambda = alpha^2 (n + kappa) - n`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct UnscentedForm {
    /// How far from the mean, above 0 to 1. Default 1: with the usual 0.001 the middle point counts minus a million and
    /// digits are lost.
    pub alpha: f64,
    /// What is known of the distribution's tails. Default 2, best for a Gaussian.
    pub beta: f64,
    /// Secondary scaling, above minus the number of dimensions. Default 0.
    pub kappa: f64,
}

impl Default for UnscentedForm {
    fn default() -> Self {
        Self {
            alpha: 1.0,
            beta: 2.0,
            kappa: 0.0,
        }
    }
}

/// Weights of the middle point (mean, covariance) and of each of the others, and the factor of the covariance.
struct Weights {
    middle_mean: f64,
    middle_covariance: f64,
    other: f64,
    spread: f64,
}

impl UnscentedForm {
    /// # Errors
    /// [`FilterError::OutOfRange`] where a number is out of its range for a state of `dimensions`.
    pub fn check(&self, dimensions: usize) -> Result<(), FilterError> {
        self.weights(dimensions).map(|_| ())
    }

    fn weights(&self, dimensions: usize) -> Result<Weights, FilterError> {
        let n = dimensions as f64;
        let out = |what, range, found| Err(FilterError::OutOfRange { what, range, found });
        if !(self.alpha > 0.0 && self.alpha <= 1.0) {
            return out("alpha", "above 0 to 1", self.alpha);
        }
        if !self.beta.is_finite() || self.beta < 0.0 {
            return out("beta", "finite and not negative", self.beta);
        }
        if !(self.kappa.is_finite() && n + self.kappa > 0.0) {
            return out(
                "kappa",
                "finite and above minus the number of dimensions",
                self.kappa,
            );
        }
        let lambda = self.alpha * self.alpha * (n + self.kappa) - n;
        let middle = lambda / (n + lambda);
        Ok(Weights {
            middle_mean: middle,
            middle_covariance: middle + 1.0 - self.alpha * self.alpha + self.beta,
            other: 0.5 / (n + lambda),
            spread: n + lambda,
        })
    }
}

/// Mean and covariance of a state of `STATE` dimensions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnscentedKalman<const STATE: usize> {
    mean: SVector<f64, STATE>,
    covariance: SMatrix<f64, STATE, STATE>,
}

/// Buffers of an update, so that it allocates nothing once it has seen the largest measurement.
#[derive(Clone, Debug, Default)]
pub struct UnscentedScratch {
    /// Measurements of the sigma points, one after another.
    points: Vec<f64>,
    predicted: Vec<f64>,
    /// Covariance of the innovation, then its Cholesky factor in the lower triangle.
    innovation: Vec<f64>,
    /// State x measured: covariance of both, then that divided by the factor.
    cross: Vec<f64>,
    difference: Vec<f64>,
}

impl<const STATE: usize> UnscentedKalman<STATE> {
    /// A filter that starts from a Gaussian.
    ///
    /// # Errors
    /// [`FilterError::NotFinite`] for numbers that are not finite, [`FilterError::NotPositiveDefinite`] for the covariance.
    pub fn new(
        mean: SVector<f64, STATE>,
        covariance: SMatrix<f64, STATE, STATE>,
    ) -> Result<Self, FilterError> {
        let mut filter = Self {
            mean: SVector::zeros(),
            covariance: SMatrix::identity(),
        };
        filter.set(mean, covariance)?;
        Ok(filter)
    }

    /// Starts anew from another Gaussian.
    ///
    /// # Errors
    /// As [`Self::new`]; nothing has changed then.
    pub fn set(
        &mut self,
        mean: SVector<f64, STATE>,
        covariance: SMatrix<f64, STATE, STATE>,
    ) -> Result<(), FilterError> {
        if !mean.iter().all(|value| value.is_finite()) {
            return Err(FilterError::NotFinite { what: "the mean" });
        }
        let covariance = symmetric(&covariance);
        factor(&covariance)?;
        (self.mean, self.covariance) = (mean, covariance);
        Ok(())
    }

    /// The mean of the state.
    pub fn mean(&self) -> &SVector<f64, STATE> {
        &self.mean
    }

    /// The covariance of the state: symmetric and positive definite.
    pub fn covariance(&self) -> &SMatrix<f64, STATE, STATE> {
        &self.covariance
    }

    /// Moves the state by `motion` and adds the covariance `noise`.
    ///
    /// # Errors
    /// [`FilterError::OutOfRange`] for a bad form, [`FilterError::NotPositiveDefinite`] or [`FilterError::NotFinite`]
    /// where the moved Gaussian is none; nothing has changed then.
    pub fn predict(
        &mut self,
        form: &UnscentedForm,
        motion: impl Fn(&SVector<f64, STATE>) -> SVector<f64, STATE>,
        noise: &SMatrix<f64, STATE, STATE>,
    ) -> Result<(), FilterError> {
        let weights = form.weights(STATE)?;
        let root = factor(&(self.covariance * weights.spread))?;
        let middle = motion(&self.mean);
        let pair = |axis: usize| {
            let offset = root.column(axis);
            [motion(&(self.mean + offset)), motion(&(self.mean - offset))]
        };
        let mut mean = middle * weights.middle_mean;
        for axis in 0..STATE {
            let [up, down] = pair(axis);
            mean += (up + down) * weights.other;
        }
        let offset = middle - mean;
        let mut covariance = offset * offset.transpose() * weights.middle_covariance;
        for axis in 0..STATE {
            for point in pair(axis) {
                let offset = point - mean;
                covariance += offset * offset.transpose() * weights.other;
            }
        }
        self.set(mean, covariance + noise)
    }

    /// Takes a measurement in. `measured` are its numbers, `variances` the variances of their independent noise (above
    /// 0), and `observe` writes what a state would measure. Returns the squared Mahalanobis distance of the innovation:
    /// chi-square with as many degrees of freedom as numbers.
    ///
    /// The covariance is lowered by the square of a triangular solution rather than by a product with the gain, made
    /// symmetric, and checked by its Cholesky factor.
    ///
    /// # Errors
    /// [`FilterError::SizeMismatch`] for variances that are not as many; [`FilterError::NotFinite`] for a measurement,
    /// [`FilterError::NotPositiveDefinite`] where the innovation or the result has no proper covariance. Nothing has
    /// changed then.
    pub fn update(
        &mut self,
        form: &UnscentedForm,
        measured: &[f64],
        variances: &[f64],
        mut observe: impl FnMut(&SVector<f64, STATE>, &mut [f64]),
        scratch: &mut UnscentedScratch,
    ) -> Result<f64, FilterError> {
        let size = measured.len();
        FilterError::check_length("variances", size, variances.len())?;
        let weights = form.weights(STATE)?;
        let root = factor(&(self.covariance * weights.spread))?;
        let points = 2 * STATE + 1;
        scratch.resize(STATE, points, size);
        if size == 0 {
            return Ok(0.0);
        }
        let (middle, others) = scratch.points.split_at_mut(size);
        observe(&self.mean, middle);
        for (axis, pair) in others.chunks_exact_mut(2 * size).enumerate() {
            let (up, down) = pair.split_at_mut(size);
            observe(&(self.mean + root.column(axis)), up);
            observe(&(self.mean - root.column(axis)), down);
        }
        for (row, predicted) in scratch.predicted.iter_mut().enumerate() {
            let others: f64 = (1..points).map(|point| scratch.points[point * size + row]).sum();
            *predicted = weights.middle_mean * scratch.points[row] + weights.other * others;
        }
        for (point, values) in scratch.points.chunks_exact_mut(size).enumerate() {
            for (value, predicted) in values.iter_mut().zip(&scratch.predicted) {
                *value -= predicted;
            }
            let weight = if point == 0 {
                weights.middle_covariance
            } else {
                weights.other
            };
            for row in 0..size {
                let scaled = weight * values[row];
                let entries = &mut scratch.innovation[row * size..row * size + row + 1];
                for (entry, value) in entries.iter_mut().zip(&*values) {
                    *entry += scaled * value;
                }
            }
        }
        for (row, variance) in variances.iter().enumerate() {
            scratch.innovation[row * size + row] += variance;
        }
        // The covariance of state and measurement: points go in pairs along the columns of the root.
        for axis in 0..STATE {
            let up = &scratch.points[(2 * axis + 1) * size..(2 * axis + 2) * size];
            let down = &scratch.points[(2 * axis + 2) * size..(2 * axis + 3) * size];
            for state in axis..STATE {
                let offset = weights.other * root[(state, axis)];
                let row = &mut scratch.cross[state * size..(state + 1) * size];
                for ((entry, up), down) in row.iter_mut().zip(up).zip(down) {
                    *entry += offset * (up - down);
                }
            }
        }
        for ((difference, measured), predicted) in scratch
            .difference
            .iter_mut()
            .zip(measured)
            .zip(&scratch.predicted)
        {
            *difference = measured - predicted;
        }
        if !scratch.difference.iter().all(|value| value.is_finite()) {
            return Err(FilterError::NotFinite {
                what: "the innovation",
            });
        }
        factor_in_place(&mut scratch.innovation, size)?;
        // With S = L L', the gain times the difference is (L^-1 P_xz')' (L^-1 d), and the covariance falls by the square
        // of the first factor.
        solve_lower(&scratch.innovation, size, &mut scratch.difference);
        for row in scratch.cross.chunks_exact_mut(size) {
            solve_lower(&scratch.innovation, size, row);
        }
        let row = |state: usize| &scratch.cross[state * size..(state + 1) * size];
        let mean = SVector::from_fn(|state, _| self.mean[state] + dot(row(state), &scratch.difference));
        let covariance =
            SMatrix::from_fn(|first, second| self.covariance[(first, second)] - dot(row(first), row(second)));
        let distance = dot(&scratch.difference, &scratch.difference);
        self.set(mean, covariance)?;
        Ok(distance)
    }
}

impl UnscentedScratch {
    /// Buffers for measurements of up to `measured` numbers of a state of `dimensions`.
    pub fn for_measurements(dimensions: usize, measured: usize) -> Self {
        let mut scratch = Self::default();
        scratch.resize(dimensions, 2 * dimensions + 1, measured);
        scratch
    }

    fn resize(&mut self, state: usize, points: usize, size: usize) {
        let fill = |buffer: &mut Vec<f64>, length: usize| {
            buffer.clear();
            buffer.resize(length, 0.0);
        };
        fill(&mut self.points, points * size);
        fill(&mut self.predicted, size);
        fill(&mut self.innovation, size * size);
        fill(&mut self.cross, state * size);
        fill(&mut self.difference, size);
    }
}

fn symmetric<const SIZE: usize>(matrix: &SMatrix<f64, SIZE, SIZE>) -> SMatrix<f64, SIZE, SIZE> {
    (matrix + matrix.transpose()) * 0.5
}

fn factor<const SIZE: usize>(
    covariance: &SMatrix<f64, SIZE, SIZE>,
) -> Result<SMatrix<f64, SIZE, SIZE>, FilterError> {
    if !covariance.iter().all(|value| value.is_finite()) {
        return Err(FilterError::NotFinite {
            what: "the covariance",
        });
    }
    Cholesky::new(*covariance)
        .map(|factor| factor.l())
        .ok_or(FilterError::NotPositiveDefinite {
            what: "the covariance",
        })
}

/// The Cholesky factor in the lower triangle, row by row; the upper one is not read.
fn factor_in_place(matrix: &mut [f64], size: usize) -> Result<(), FilterError> {
    for row in 0..size {
        let (before, rest) = matrix.split_at_mut(row * size);
        let own = &mut rest[..row + 1];
        for column in 0..row {
            let other = &before[column * size..column * size + column + 1];
            let sum = dot(&own[..column], &other[..column]);
            own[column] = (own[column] - sum) / other[column];
        }
        let square = own[row] - dot(&own[..row], &own[..row]);
        if !(square.is_finite() && square > 0.0) {
            return Err(FilterError::NotPositiveDefinite {
                what: "the covariance of the innovation",
            });
        }
        own[row] = square.sqrt();
    }
    Ok(())
}

/// Replaces `values` by the solution of `L x = values`.
fn solve_lower(factor: &[f64], size: usize, values: &mut [f64]) {
    for row in 0..size {
        let line = &factor[row * size..row * size + row + 1];
        let sum = dot(&line[..row], &values[..row]);
        values[row] = (values[row] - sum) / line[row];
    }
}

fn dot(first: &[f64], second: &[f64]) -> f64 {
    first.iter().zip(second).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
#[path = "unscented_tests.rs"]
mod tests;
