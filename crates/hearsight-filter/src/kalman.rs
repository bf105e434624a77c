//! The linear Kalman filter: the exact answer where all is linear and Gaussian.
//!
//! Particle filters are tested against it; systems with Gaussian measurements use it as it is.

use crate::elementary::ln;
use crate::error::FilterError;
use nalgebra::{Cholesky, SMatrix, SVector};
use serde::{Deserialize, Serialize};

/// Mean and covariance of a state of `STATE` dimensions (Kalman 1960).
///
/// ```
/// use hearsight_filter::KalmanFilter;
/// use nalgebra::{Matrix1, Vector1};
///
/// let mut filter = KalmanFilter::new(Vector1::new(0.0), Matrix1::new(4.0))?;
/// filter.predict(&Matrix1::new(1.0), &Matrix1::new(0.0));
/// filter.update(&Vector1::new(1.0), &Matrix1::new(1.0), &Matrix1::new(4.0))?;
/// assert!((filter.mean()[0] - 0.5).abs() < 1e-12 && (filter.covariance()[0] - 2.0).abs() < 1e-12);
/// # Ok::<(), hearsight_filter::FilterError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KalmanFilter<const STATE: usize> {
    mean: SVector<f64, STATE>,
    covariance: SMatrix<f64, STATE, STATE>,
}

/// What a measurement of `MEASURED` dimensions told the filter.
#[derive(Clone, Debug, PartialEq)]
pub struct Innovation<const MEASURED: usize> {
    /// Measured minus predicted.
    pub difference: SVector<f64, MEASURED>,
    /// The covariance that the difference was expected to have.
    pub covariance: SMatrix<f64, MEASURED, MEASURED>,
    /// The squared Mahalanobis distance of the difference: chi-square with `MEASURED` degrees of freedom, for gates.
    pub squared_distance: f64,
    /// The logarithm of the density of the measurement.
    pub log_likelihood: f64,
}

impl<const STATE: usize> KalmanFilter<STATE> {
    /// A filter that starts from a Gaussian.
    ///
    /// # Errors
    /// [`FilterError::NotFinite`] for a mean or covariance that is not finite.
    pub fn new(
        mean: SVector<f64, STATE>,
        covariance: SMatrix<f64, STATE, STATE>,
    ) -> Result<Self, FilterError> {
        check_finite("the mean", &mean)?;
        check_finite("the covariance", &covariance)?;
        Ok(Self { mean, covariance })
    }

    /// The mean of the state.
    pub fn mean(&self) -> &SVector<f64, STATE> {
        &self.mean
    }

    /// The covariance of the state.
    pub fn covariance(&self) -> &SMatrix<f64, STATE, STATE> {
        &self.covariance
    }

    /// Moves the state by `transition` and adds the covariance `noise`.
    pub fn predict(&mut self, transition: &SMatrix<f64, STATE, STATE>, noise: &SMatrix<f64, STATE, STATE>) {
        self.mean = transition * self.mean;
        self.covariance = symmetric(&(transition * self.covariance * transition.transpose() + noise));
    }

    /// The innovation of a measurement without taking it in, to gate it.
    ///
    /// `observation` maps the state to the measurement, `noise` is the covariance of the measurement.
    ///
    /// # Errors
    /// [`FilterError::NotFinite`] for a measurement, matrix or state that is not finite,
    /// [`FilterError::NotPositiveDefinite`] if the covariance of the innovation is not.
    pub fn innovation<const MEASURED: usize>(
        &self,
        measurement: &SVector<f64, MEASURED>,
        observation: &SMatrix<f64, MEASURED, STATE>,
        noise: &SMatrix<f64, MEASURED, MEASURED>,
    ) -> Result<Innovation<MEASURED>, FilterError> {
        self.inverted_innovation(measurement, observation, noise)
            .map(|(innovation, _)| innovation)
    }

    /// Takes a measurement in, in Joseph's form, which keeps the covariance symmetric and positive whatever the
    /// rounding of the gain.
    ///
    /// # Errors
    /// As [`innovation`](Self::innovation); the state is then unchanged.
    pub fn update<const MEASURED: usize>(
        &mut self,
        measurement: &SVector<f64, MEASURED>,
        observation: &SMatrix<f64, MEASURED, STATE>,
        noise: &SMatrix<f64, MEASURED, MEASURED>,
    ) -> Result<Innovation<MEASURED>, FilterError> {
        let (innovation, factor) = self.inverted_innovation(measurement, observation, noise)?;
        let gain = factor.solve(&(observation * self.covariance)).transpose();
        let left = SMatrix::<f64, STATE, STATE>::identity() - gain * observation;
        let mean = self.mean + gain * innovation.difference;
        let covariance =
            symmetric(&(left * self.covariance * left.transpose() + gain * noise * gain.transpose()));
        check_finite("the updated mean", &mean)?;
        check_finite("the updated covariance", &covariance)?;
        (self.mean, self.covariance) = (mean, covariance);
        Ok(innovation)
    }

    fn inverted_innovation<const MEASURED: usize>(
        &self,
        measurement: &SVector<f64, MEASURED>,
        observation: &SMatrix<f64, MEASURED, STATE>,
        noise: &SMatrix<f64, MEASURED, MEASURED>,
    ) -> Result<(Innovation<MEASURED>, Cholesky<f64, nalgebra::Const<MEASURED>>), FilterError> {
        let difference = measurement - observation * self.mean;
        check_finite("the innovation", &difference)?;
        let covariance = symmetric(&(observation * self.covariance * observation.transpose() + noise));
        check_finite("the covariance of the innovation", &covariance)?;
        let factor = Cholesky::new(covariance).ok_or(FilterError::NotPositiveDefinite {
            what: "the covariance of the innovation",
        })?;
        let squared_distance = difference.dot(&factor.solve(&difference));
        let log_determinant: f64 = 2.0
            * factor
                .l_dirty()
                .diagonal()
                .iter()
                .map(|entry| ln(*entry))
                .sum::<f64>();
        let log_likelihood =
            -0.5 * (squared_distance + log_determinant + MEASURED as f64 * ln(std::f64::consts::TAU));
        Ok((
            Innovation {
                difference,
                covariance,
                squared_distance,
                log_likelihood,
            },
            factor,
        ))
    }
}

fn symmetric<const SIZE: usize>(matrix: &SMatrix<f64, SIZE, SIZE>) -> SMatrix<f64, SIZE, SIZE> {
    (matrix + matrix.transpose()) * 0.5
}

fn check_finite<const ROWS: usize, const COLUMNS: usize>(
    what: &'static str,
    matrix: &SMatrix<f64, ROWS, COLUMNS>,
) -> Result<(), FilterError> {
    if matrix.iter().all(|value| value.is_finite()) {
        Ok(())
    } else {
        Err(FilterError::NotFinite { what })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix1, Matrix1x2, Matrix2, Vector1, Vector2};

    /// A position and velocity observed by position, against the weighted least squares over all measurements.
    #[test]
    fn agrees_with_least_squares_over_all_measurements() {
        let prior = Matrix2::new(4.0, 0.5, 0.5, 1.0);
        let prior_mean = Vector2::new(1.0, -0.5);
        let mut filter = KalmanFilter::new(prior_mean, prior).unwrap();
        let mut information = prior.try_inverse().unwrap();
        let mut vector = information * prior_mean;
        let mut elapsed = 0.0;
        for (step, measured) in [(0.1, 1.2), (0.7, 0.4), (0.02, 0.5), (1.3, -0.9)] {
            elapsed += step;
            filter.predict(&Matrix2::new(1.0, step, 0.0, 1.0), &Matrix2::zeros());
            let noise = 0.3 + 0.1 * step;
            filter
                .update(
                    &Vector1::new(measured),
                    &Matrix1x2::new(1.0, 0.0),
                    &Matrix1::new(noise),
                )
                .unwrap();
            // The same measurement as a row on the state at time zero.
            let row = Matrix1x2::new(1.0, elapsed);
            information += row.transpose() * row / noise;
            vector += row.transpose() * measured / noise;
        }
        let covariance = information.try_inverse().unwrap();
        let to_now = Matrix2::new(1.0, elapsed, 0.0, 1.0);
        assert!((filter.mean() - to_now * covariance * vector).norm() < 1e-12);
        assert!((filter.covariance() - to_now * covariance * to_now.transpose()).norm() < 1e-12);
    }

    #[test]
    fn the_innovation_is_scored_by_the_gaussian_density() {
        let filter = KalmanFilter::new(Vector2::new(1.0, 2.0), Matrix2::new(2.0, 0.3, 0.3, 1.0)).unwrap();
        let noise = Matrix2::new(0.5, 0.1, 0.1, 0.7);
        let innovation = filter
            .innovation(&Vector2::new(0.2, 3.1), &Matrix2::identity(), &noise)
            .unwrap();
        let covariance = Matrix2::new(2.5, 0.4, 0.4, 1.7);
        let difference = Vector2::new(-0.8, 1.1);
        let distance = (difference.transpose() * covariance.try_inverse().unwrap() * difference)[0];
        assert!((innovation.squared_distance - distance).abs() < 1e-12);
        let log_density = -0.5 * distance
            - (std::f64::consts::TAU.powi(2) * covariance.determinant())
                .sqrt()
                .ln();
        assert!((innovation.log_likelihood - log_density).abs() < 1e-12);
    }

    #[test]
    fn a_nearly_perfect_measurement_keeps_the_covariance_positive() {
        let mut filter = KalmanFilter::new(Vector2::zeros(), Matrix2::identity() * 1e8).unwrap();
        for _ in 0..50 {
            filter.predict(&Matrix2::new(1.0, 0.1, 0.0, 1.0), &(Matrix2::identity() * 1e-12));
            filter
                .update(&Vector1::new(1.0), &Matrix1x2::new(1.0, 0.0), &Matrix1::new(1e-9))
                .unwrap();
            assert!(filter.covariance().cholesky().is_some());
            assert_eq!(*filter.covariance(), filter.covariance().transpose());
        }
    }

    #[test]
    fn bad_measurements_are_errors_and_leave_the_state() {
        let mut filter = KalmanFilter::new(Vector2::zeros(), Matrix2::identity()).unwrap();
        let before = filter.clone();
        let observation = Matrix1x2::new(1.0, 0.0);
        let update = filter.update(&Vector1::new(f64::NAN), &observation, &Matrix1::new(1.0));
        assert_eq!(
            update,
            Err(FilterError::NotFinite {
                what: "the innovation"
            })
        );
        assert!(
            filter
                .update(&Vector1::new(0.0), &observation, &Matrix1::new(-2.0))
                .is_err()
        );
        assert!(
            filter
                .update(&Vector1::new(0.0), &observation, &Matrix1::new(f64::INFINITY))
                .is_err()
        );
        assert_eq!(filter, before);
        assert!(KalmanFilter::new(Vector2::new(0.0, f64::NAN), Matrix2::identity()).is_err());
        let text = serde_json::to_string(&filter).unwrap();
        assert_eq!(serde_json::from_str::<KalmanFilter<2>>(&text).unwrap(), before);
    }
}
