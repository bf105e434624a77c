//! Damped least squares (Levenberg and Marquardt) with weights against outliers, for a few hundred unknowns.
//!
//! Normal equations are given, not residuals: who knows the structure of a problem adds only what is not zero.

use nalgebra::{DMatrix, DVector};

/// A problem: at some unknowns its cost, and the normal equations there.
pub(crate) trait Problem {
    /// Sum of weighted squares, halved; infinite where it is not defined.
    fn cost(&self, unknowns: &DVector<f64>) -> f64;
    /// Adds J^T W J and J^T W r to matrices of zeros.
    fn normal(&self, unknowns: &DVector<f64>, matrix: &mut DMatrix<f64>, side: &mut DVector<f64>);
    /// The unknowns after a step; where they are not a vector space, on their manifold.
    fn moved(&self, unknowns: &DVector<f64>, step: &DVector<f64>) -> DVector<f64> {
        unknowns + step
    }
}

/// A minimum that was found.
pub(crate) struct Minimum {
    /// The unknowns.
    pub(crate) unknowns: DVector<f64>,
    /// The inverse of J^T W J: their covariance, where residuals are in units of their deviations.
    pub(crate) covariance: DMatrix<f64>,
}

const STEPS: usize = 200;
/// Relative decrease of the cost at which it is good enough.
const ENOUGH: f64 = 1e-12;

/// The minimum next to `start`; none where the equations cannot be solved.
pub(crate) fn minimize(problem: &impl Problem, start: DVector<f64>) -> Option<Minimum> {
    let size = start.len();
    let mut unknowns = start;
    let mut cost = problem.cost(&unknowns);
    if !cost.is_finite() {
        return None;
    }
    let (mut matrix, mut side) = (DMatrix::zeros(size, size), DVector::zeros(size));
    let mut damping = 1e-3;
    let mut settled = 0;
    for _ in 0..STEPS {
        matrix.fill(0.0);
        side.fill(0.0);
        problem.normal(&unknowns, &mut matrix, &mut side);
        let mut improved = false;
        while damping < 1e12 {
            let mut damped = matrix.clone();
            for k in 0..size {
                damped[(k, k)] += damping * matrix[(k, k)].max(1e-12);
            }
            let step = damped.cholesky().map(|factors| factors.solve(&-&side));
            let next = step.map(|step| problem.moved(&unknowns, &step));
            let next_cost = next.as_ref().map_or(f64::INFINITY, |next| problem.cost(next));
            if let Some(next) = next
                && next_cost < cost
            {
                let gain = cost - next_cost;
                settled = if gain <= ENOUGH * cost { settled + 1 } else { 0 };
                (unknowns, cost, improved) = (next, next_cost, true);
                damping = (damping * 0.2).max(1e-12);
                break;
            }
            damping *= 4.0;
        }
        if !improved || settled >= 2 {
            break;
        }
    }
    matrix.fill(0.0);
    side.fill(0.0);
    problem.normal(&unknowns, &mut matrix, &mut side);
    let covariance = matrix.cholesky()?.inverse();
    covariance
        .iter()
        .all(|value| value.is_finite())
        .then_some(Minimum { unknowns, covariance })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley as least squares.
    struct Valley;

    impl Problem for Valley {
        fn cost(&self, x: &DVector<f64>) -> f64 {
            0.5 * ((1.0 - x[0]).powi(2) + 100.0 * (x[1] - x[0] * x[0]).powi(2))
        }

        fn normal(&self, x: &DVector<f64>, matrix: &mut DMatrix<f64>, side: &mut DVector<f64>) {
            let jacobian = DMatrix::from_row_slice(2, 2, &[-1.0, 0.0, -20.0 * x[0], 10.0]);
            let residual = DVector::from_vec(vec![1.0 - x[0], 10.0 * (x[1] - x[0] * x[0])]);
            *matrix += jacobian.transpose() * &jacobian;
            *side += jacobian.transpose() * residual;
        }
    }

    #[test]
    fn the_bottom_of_a_bent_valley_is_found() {
        let minimum = minimize(&Valley, DVector::from_vec(vec![-1.2, 1.0])).unwrap();
        assert!((minimum.unknowns[0] - 1.0).abs() < 1e-6 && (minimum.unknowns[1] - 1.0).abs() < 1e-6);
        assert!(minimum.covariance[(0, 0)] > 0.9 && minimum.covariance[(0, 0)] < 1.1);
    }
}
