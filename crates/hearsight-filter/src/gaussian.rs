//! Gaussians with a density, draws and marginals, and mixtures of them: proposals of particle filters.

use crate::elementary::{exp, ln};
use crate::error::FilterError;
use crate::log_sum_exp::log_sum_exp;
use crate::particles::Particles;
use crate::random::{standard_normal, uniform};
use nalgebra::{Cholesky, SMatrix, SVector};
use rand::Rng;

/// A Gaussian over `SIZE` dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Gaussian<const SIZE: usize> {
    mean: SVector<f64, SIZE>,
    covariance: SMatrix<f64, SIZE, SIZE>,
    /// Lower triangle, whose square is the covariance.
    root: SMatrix<f64, SIZE, SIZE>,
    log_determinant: f64,
}

impl<const SIZE: usize> Gaussian<SIZE> {
    /// A Gaussian from its mean and covariance.
    ///
    /// # Errors
    /// [`FilterError::NotFinite`], or [`FilterError::NotPositiveDefinite`] for the covariance.
    pub fn new(mean: SVector<f64, SIZE>, covariance: SMatrix<f64, SIZE, SIZE>) -> Result<Self, FilterError> {
        if !mean
            .iter()
            .chain(covariance.iter())
            .all(|value| value.is_finite())
        {
            return Err(FilterError::NotFinite { what: "a Gaussian" });
        }
        let covariance = (covariance + covariance.transpose()) * 0.5;
        let root =
            Cholesky::new(covariance)
                .map(|factor| factor.l())
                .ok_or(FilterError::NotPositiveDefinite {
                    what: "the covariance of a Gaussian",
                })?;
        let log_determinant = 2.0 * root.diagonal().iter().map(|entry| ln(*entry)).sum::<f64>();
        Ok(Self {
            mean,
            covariance,
            root,
            log_determinant,
        })
    }

    /// The Gaussian with the mean and covariance of some dimensions of weighted particles, to which `floor` (variances)
    /// is added: a cloud that has collapsed to one point still has a density.
    ///
    /// # Errors
    /// [`FilterError::BadIndex`] for a dimension that the particles lack; else as [`Self::new`].
    pub fn of_particles(
        particles: &Particles,
        dimensions: [usize; SIZE],
        floor: [f64; SIZE],
    ) -> Result<Self, FilterError> {
        particles.check_dimensions(&dimensions)?;
        let mean = SVector::from_fn(|row, _| particles.mean_of(dimensions[row]));
        let covariance = SMatrix::from_fn(|row, column| {
            let extra = if row == column { floor[row] } else { 0.0 };
            particles.covariance_of(dimensions[row], dimensions[column]) + extra
        });
        Self::new(mean, covariance)
    }

    /// The mean.
    pub fn mean(&self) -> &SVector<f64, SIZE> {
        &self.mean
    }

    /// The covariance.
    pub fn covariance(&self) -> &SMatrix<f64, SIZE, SIZE> {
        &self.covariance
    }

    /// The same Gaussian elsewhere.
    #[must_use]
    pub fn moved(mut self, offset: &SVector<f64, SIZE>) -> Self {
        self.mean += offset;
        self
    }

    /// The squared Mahalanobis distance of a point.
    pub fn squared_distance(&self, point: &SVector<f64, SIZE>) -> f64 {
        // The triangular solution by hand: a factor of this size needs no check for a zero on its diagonal.
        let offset = point - self.mean;
        let mut solved = SVector::<f64, SIZE>::zeros();
        for row in 0..SIZE {
            let mut value = offset[row];
            for column in 0..row {
                value -= self.root[(row, column)] * solved[column];
            }
            solved[row] = value / self.root[(row, row)];
        }
        solved.norm_squared()
    }

    /// The logarithm of the density at a point.
    pub fn log_density(&self, point: &SVector<f64, SIZE>) -> f64 {
        -0.5 * (self.squared_distance(point) + self.log_determinant + SIZE as f64 * ln(std::f64::consts::TAU))
    }

    /// A point drawn from it.
    pub fn draw(&self, generator: &mut impl Rng) -> SVector<f64, SIZE> {
        let mut normal = SVector::<f64, SIZE>::zeros();
        for value in normal.iter_mut() {
            *value = standard_normal(generator);
        }
        self.mean + self.root * normal
    }

    /// The distribution of some of the dimensions, whatever the others are.
    ///
    /// # Errors
    /// [`FilterError::BadIndex`] for a dimension that does not exist or is named twice.
    pub fn marginal<const PART: usize>(
        &self,
        dimensions: [usize; PART],
    ) -> Result<Gaussian<PART>, FilterError> {
        for (place, index) in dimensions.iter().enumerate() {
            if *index >= SIZE || dimensions[..place].contains(index) {
                return Err(FilterError::BadIndex {
                    what: "dimension",
                    index: *index,
                    available: SIZE,
                });
            }
        }
        Gaussian::new(
            SVector::from_fn(|row, _| self.mean[dimensions[row]]),
            SMatrix::from_fn(|row, column| self.covariance[(dimensions[row], dimensions[column])]),
        )
    }

    /// The Bhattacharyya coefficient of two Gaussians, the integral of the root of the product of their densities: 1
    /// for equal ones, 0 where they have nothing in common.
    pub fn coefficient(&self, other: &Self) -> f64 {
        let between = (self.covariance + other.covariance) * 0.5;
        let Ok(between) = Self::new(self.mean, between) else {
            return 0.0;
        };
        let distance = between.squared_distance(&other.mean) / 8.0;
        let spread = 0.5 * (between.log_determinant - 0.5 * (self.log_determinant + other.log_determinant));
        exp(-(distance + spread)).min(1.0)
    }
}

/// A weighted sum of Gaussians.
///
/// A proposal made of what trackers believe should keep a share of the transition prior, the defensive component:
/// without it the importance weight is unbounded where all of them are wrong (Hesterberg 1995).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mixture<const SIZE: usize> {
    components: Vec<(f64, Gaussian<SIZE>)>,
    logs: Vec<f64>,
}

impl<const SIZE: usize> Mixture<SIZE> {
    /// Forgets all components, keeping the memory.
    pub fn clear(&mut self) {
        self.components.clear();
    }

    /// Adds a component. Weights may have any scale; one that is not finite and positive adds nothing.
    pub fn push(&mut self, weight: f64, component: Gaussian<SIZE>) {
        if weight.is_finite() && weight > 0.0 {
            self.components.push((weight, component));
        }
    }

    /// Scales the weights to sum to 1.
    pub fn normalize(&mut self) {
        let sum: f64 = self.components.iter().map(|(weight, _)| weight).sum();
        for (weight, _) in &mut self.components {
            *weight /= sum;
        }
    }

    /// Weights and components.
    pub fn components(&self) -> &[(f64, Gaussian<SIZE>)] {
        &self.components
    }

    /// The logarithm of the density at a point; the weights must be normalized. Negative infinity without components.
    pub fn log_density(&mut self, point: &SVector<f64, SIZE>) -> f64 {
        self.logs.clear();
        self.logs.extend(
            self.components
                .iter()
                .map(|(weight, component)| ln(*weight) + component.log_density(point)),
        );
        log_sum_exp(&self.logs)
    }

    /// A point drawn from it with the number of its component; none without components. The weights must be normalized.
    pub fn draw(&self, generator: &mut impl Rng) -> Option<(usize, SVector<f64, SIZE>)> {
        let mut left = uniform(generator);
        let last = self.components.len().checked_sub(1)?;
        let mut chosen = last;
        for (place, (weight, _)) in self.components.iter().enumerate() {
            left -= weight;
            if left < 0.0 {
                chosen = place;
                break;
            }
        }
        let (_, component) = self.components.get(chosen)?;
        Some((chosen, component.draw(generator)))
    }

    /// The mixture of some of the dimensions, written into `marginal`.
    ///
    /// # Errors
    /// As [`Gaussian::marginal`].
    pub fn marginal_into<const PART: usize>(
        &self,
        dimensions: [usize; PART],
        marginal: &mut Mixture<PART>,
    ) -> Result<(), FilterError> {
        marginal.clear();
        for (weight, component) in &self.components {
            marginal.push(*weight, component.marginal(dimensions)?);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::generator;
    use nalgebra::{Matrix1, Matrix2, Vector1, Vector2};

    fn one(mean: f64, deviation: f64) -> Gaussian<1> {
        Gaussian::new(Vector1::new(mean), Matrix1::new(deviation * deviation)).unwrap()
    }

    fn two() -> Gaussian<2> {
        Gaussian::new(Vector2::new(1.0, -2.0), Matrix2::new(2.0, 0.6, 0.6, 0.5)).unwrap()
    }

    #[test]
    fn densities_are_those_of_the_formula_and_integrate_to_one() {
        let gaussian = two();
        let point = Vector2::new(0.3, -1.1);
        let offset = point - Vector2::new(1.0, -2.0);
        let covariance = gaussian.covariance();
        let square = (offset.transpose() * covariance.try_inverse().unwrap() * offset)[0];
        let expected = -0.5 * (square + (std::f64::consts::TAU.powi(2) * covariance.determinant()).ln());
        assert!((gaussian.log_density(&point) - expected).abs() < 1e-12);
        let mut mixture = Mixture::default();
        mixture.push(3.0, one(-1.0, 0.5));
        mixture.push(1.0, one(2.0, 1.5));
        mixture.push(f64::NAN, one(0.0, 1.0));
        mixture.normalize();
        let step = 0.01;
        let integral: f64 = (-1500..1500)
            .map(|k| step * mixture.log_density(&Vector1::new(step * f64::from(k))).exp())
            .sum();
        assert!((integral - 1.0).abs() < 1e-9, "{integral}");
    }

    #[test]
    fn draws_have_the_moments_of_the_mixture_and_marginals_agree() {
        let mut mixture = Mixture::default();
        mixture.push(0.25, two());
        mixture.push(0.75, two().moved(&Vector2::new(3.0, 1.0)));
        mixture.normalize();
        let mut random = generator(1, "test", 0);
        let count = 40_000;
        let (mut mean, mut second) = (Vector2::zeros(), 0);
        for _ in 0..count {
            let (component, point) = mixture.draw(&mut random).unwrap();
            mean += point / f64::from(count);
            second += component;
        }
        assert!(
            (mean - Vector2::new(1.0 + 2.25, -2.0 + 0.75)).norm() < 0.05,
            "{mean}"
        );
        assert!((second as f64 / f64::from(count) - 0.75).abs() < 0.01);
        let mut marginal = Mixture::<1>::default();
        mixture.marginal_into([1], &mut marginal).unwrap();
        let at = Vector1::new(-1.4);
        let direct = 0.25 * one(-2.0, 0.5_f64.sqrt()).log_density(&at).exp()
            + 0.75 * one(-1.0, 0.5_f64.sqrt()).log_density(&at).exp();
        assert!((marginal.log_density(&at).exp() - direct).abs() < 1e-12);
        assert!(two().marginal([0, 0]).is_err() && two().marginal([2]).is_err());
        assert_eq!(Mixture::<1>::default().draw(&mut random), None);
    }

    /// The sheet's figures for a tracker biased by 0, 1 and 3 of its deviations.
    #[test]
    fn the_coefficient_is_the_integral_of_the_root_of_the_product() {
        for (bias, expected) in [(0.0, 1.0), (1.0, 0.882), (3.0, 0.325)] {
            let value = one(0.0, 1.0).coefficient(&one(bias, 1.0));
            assert!((value - expected).abs() < 1e-3, "{bias}: {value}");
        }
        let (first, second) = (one(0.2, 0.7), one(-1.0, 2.5));
        let step = 0.002;
        let integral: f64 = (-10_000..10_000)
            .map(|k| {
                let at = Vector1::new(step * f64::from(k));
                step * (0.5 * (first.log_density(&at) + second.log_density(&at))).exp()
            })
            .sum();
        assert!((first.coefficient(&second) - integral).abs() < 1e-6);
    }

    #[test]
    fn a_collapsed_cloud_has_the_floor_as_its_spread() {
        let particles = Particles::new(2, 10).unwrap();
        assert!(Gaussian::of_particles(&particles, [0, 1], [0.0; 2]).is_err());
        let fitted = Gaussian::of_particles(&particles, [0, 1], [4.0, 1.0]).unwrap();
        assert_eq!(*fitted.covariance(), Matrix2::new(4.0, 0.0, 0.0, 1.0));
        assert!(Gaussian::of_particles(&particles, [0, 2], [1.0; 2]).is_err());
        assert!(Gaussian::new(Vector1::new(f64::NAN), Matrix1::new(1.0)).is_err());
    }
}
