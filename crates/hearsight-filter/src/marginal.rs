//! Weights of particles that were drawn from anywhere, not from an ancestor of their own.
//!
//! A proposal that is one mixture for all particles draws states that no longer belong to an ancestor. The printed weight
//! (Chen and Rui, equation 8) takes the transition density from the i-th ancestor all the same, and most particles are
//! wasted. The marginal particle filter (Klaas, de Freitas and Doucet 2005) takes it from all of them:
//!
//! ```text
//! w_i ∝ p(Z | X_i) [ sum_j w_j p(X_i | X_j) ] / q(X_i)
//! ```
//!
//! [`PredictedCloud`] is that sum, exactly (O(N^2)). Where the cloud is near a Gaussian, [`Gaussian`](crate::Gaussian)
//! fitted to it does the same in O(N).

use crate::elementary::{exp, greatest, ln};
use crate::error::FilterError;
use crate::log_sum_exp::log_sum_exp;
use crate::random::uniform;
use rand::Rng;

/// The distribution that all particles of the last step predict together: one Gaussian around where each would be carried
/// to, with one variance a dimension, the noise of the transition.
#[derive(Clone, Debug, Default)]
pub struct PredictedCloud {
    /// Where each particle is carried to, divided by the deviation: one column a dimension.
    centres: Vec<Vec<f64>>,
    /// Logarithms of the weights, with the constant of the Gaussians.
    log_weights: Vec<f64>,
    inverse_deviations: Vec<f64>,
    exponents: Vec<f64>,
}

impl PredictedCloud {
    /// Takes the places where particles are carried to (one column a dimension), the logarithms of their weights (sum of
    /// the weights 1), and the variances of the noise, above 0.
    ///
    /// # Errors
    /// [`FilterError::SizeMismatch`] for columns of unequal length or other numbers of variances,
    /// [`FilterError::OutOfRange`] for a variance that is not finite and positive.
    pub fn load(
        &mut self,
        columns: &[&[f64]],
        log_weights: &[f64],
        variances: &[f64],
    ) -> Result<(), FilterError> {
        FilterError::check_length("variances", columns.len(), variances.len())?;
        for column in columns {
            FilterError::check_length("column", log_weights.len(), column.len())?;
        }
        if let Some(bad) = variances
            .iter()
            .find(|variance| !(variance.is_finite() && **variance > 0.0))
        {
            return Err(FilterError::OutOfRange {
                what: "the variance of a transition",
                range: "finite and positive",
                found: *bad,
            });
        }
        self.inverse_deviations.clear();
        self.inverse_deviations
            .extend(variances.iter().map(|variance| 1.0 / variance.sqrt()));
        self.centres.resize_with(columns.len(), Vec::new);
        for ((centres, column), scale) in self.centres.iter_mut().zip(columns).zip(&self.inverse_deviations) {
            centres.clear();
            centres.extend(column.iter().map(|value| value * scale));
        }
        let log_scale: f64 = variances
            .iter()
            .map(|variance| -0.5 * ln(std::f64::consts::TAU * variance))
            .sum();
        self.log_weights.clear();
        self.log_weights
            .extend(log_weights.iter().map(|weight| weight + log_scale));
        Ok(())
    }

    /// The logarithm of the density at a point, one number a dimension.
    pub fn log_density(&mut self, point: &[f64]) -> f64 {
        self.explain(point);
        log_sum_exp(&self.exponents)
    }

    /// A particle drawn in proportion to how well it explains a point: its ancestor, as far as it has one. The first one
    /// where nothing explains it.
    pub fn draw_ancestor(&mut self, point: &[f64], generator: &mut impl Rng) -> usize {
        self.explain(point);
        let shift = greatest(&self.exponents);
        let mut left = uniform(generator);
        if !shift.is_finite() {
            return 0;
        }
        let total: f64 = self.exponents.iter().map(|value| exp(value - shift)).sum();
        left *= total;
        for (place, value) in self.exponents.iter().enumerate() {
            left -= exp(value - shift);
            if left < 0.0 {
                return place;
            }
        }
        self.exponents.len() - 1
    }

    /// Log-likelihoods of the point under each particle's Gaussian, weighted.
    fn explain(&mut self, point: &[f64]) {
        self.exponents.clear();
        self.exponents.extend_from_slice(&self.log_weights);
        for ((centres, value), scale) in self.centres.iter().zip(point).zip(&self.inverse_deviations) {
            let value = value * scale;
            for (exponent, centre) in self.exponents.iter_mut().zip(centres) {
                let offset = value - centre;
                *exponent -= 0.5 * offset * offset;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaussian::Gaussian;
    use crate::random::{generator, standard_normal};
    use nalgebra::{Matrix1, Vector1};

    #[test]
    fn the_density_is_the_weighted_sum() {
        let mut cloud = PredictedCloud::default();
        let columns: [&[f64]; 2] = [&[0.0, 1.0, 5.0], &[2.0, -1.0, 0.5]];
        let weights = [0.2, 0.5, 0.3_f64];
        cloud.load(&columns, &weights.map(f64::ln), &[0.5, 2.0]).unwrap();
        let point = [0.7, -0.4];
        let direct: f64 = (0..3)
            .map(|j| {
                let square =
                    (point[0] - columns[0][j]).powi(2) / 0.5 + (point[1] - columns[1][j]).powi(2) / 2.0;
                weights[j] * (-0.5 * square).exp() / (std::f64::consts::TAU * 1.0_f64.sqrt())
            })
            .sum();
        assert!((cloud.log_density(&point).exp() - direct).abs() < 1e-12);
        let mut random = generator(3, "test", 0);
        let drawn = (0..4000)
            .filter(|_| cloud.draw_ancestor(&point, &mut random) == 1)
            .count();
        let square = (point[0] - 1.0_f64).powi(2) / 0.5 + (point[1] + 1.0_f64).powi(2) / 2.0;
        let share = 0.5 * (-0.5 * square).exp() / std::f64::consts::TAU / direct;
        assert!((drawn as f64 / 4000.0 - share).abs() < 0.03);
        assert!(cloud.load(&columns, &[0.0; 2], &[1.0; 2]).is_err());
        assert!(cloud.load(&columns, &[0.0; 3], &[1.0, 0.0]).is_err());
    }

    /// One dimension, one hundred particles, a proposal near the likelihood: the marginal weights keep most particles, the
    /// printed ones a few, and the mean is surer (the method sheet's figures: 90 against 15, 0.052 against 0.096).
    #[test]
    fn marginal_weights_waste_far_fewer_particles_than_the_printed_ones() {
        const COUNT: usize = 100;
        let one =
            |mean: f64, variance: f64| Gaussian::new(Vector1::new(mean), Matrix1::new(variance)).unwrap();
        let (spread, noise, likelihood) = (1.0, 0.05, one(0.4, 0.3));
        // Prior N(0, spread + noise) times the likelihood: the exact posterior.
        let precision = 1.0 / (spread + noise) + 1.0 / 0.3;
        let exact = 0.4 / 0.3 / precision;
        let proposal = one(exact, 1.3 / precision);
        let mut random = generator(1, "marginal", 0);
        let mut cloud = PredictedCloud::default();
        // Effective sample size and squared error: marginal, Gaussian fit, printed.
        let mut sizes = [0.0; 3];
        let mut errors = [0.0; 3];
        let rounds = 300;
        for _ in 0..rounds {
            let before: Vec<f64> = (0..COUNT)
                .map(|_| spread.sqrt() * standard_normal(&mut random))
                .collect();
            cloud
                .load(&[&before], &[-(COUNT as f64).ln(); COUNT], &[noise])
                .unwrap();
            let mean = before.iter().sum::<f64>() / COUNT as f64;
            let variance = before.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / COUNT as f64;
            let fitted = one(mean, variance + noise);
            let points: Vec<f64> = (0..COUNT).map(|_| proposal.draw(&mut random)[0]).collect();
            for rule in 0..3 {
                let logs: Vec<f64> = points
                    .iter()
                    .zip(&before)
                    .map(|(point, ancestor)| {
                        let at = Vector1::new(*point);
                        let prior = match rule {
                            0 => cloud.log_density(&[*point]),
                            1 => fitted.log_density(&at),
                            _ => one(*ancestor, noise).log_density(&at),
                        };
                        prior + likelihood.log_density(&at) - proposal.log_density(&at)
                    })
                    .collect();
                let total = log_sum_exp(&logs);
                let weights: Vec<f64> = logs.iter().map(|log| (log - total).exp()).collect();
                let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
                let estimate: f64 = weights.iter().zip(&points).map(|(weight, x)| weight * x).sum();
                sizes[rule] += 1.0 / squares / f64::from(rounds);
                errors[rule] += (estimate - exact).powi(2) / f64::from(rounds);
            }
        }
        let roots = errors.map(f64::sqrt);
        assert!(sizes[0] > 80.0 && sizes[1] > 85.0 && sizes[2] < 40.0, "{sizes:?}");
        assert!(
            roots[0] < 0.75 * roots[2] && roots[1] < 0.75 * roots[2],
            "{roots:?}"
        );
    }
}
