//! The product of likelihoods, each with a floor (stac, eq. 13).

use super::{Calibration, Fusion};
use crate::cues::Evidence;

/// One factor of the product.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// From raw score to log-likelihood.
    pub calibration: Calibration,
    /// Smallest log-likelihood: what a hypothesis loses at most to one cue, so that one wrong cue cannot veto all
    /// others. Not positive.
    pub floor: f32,
    /// Exponent of the factor, 0 or more; 1 is the plain product.
    pub exponent: f32,
}

/// Product of the likelihoods of all cues that are not missing.
#[derive(Clone, Debug)]
pub struct Product {
    terms: Vec<Term>,
}

impl Product {
    /// One term a cue, in the order of the cues.
    pub fn new(terms: Vec<Term>) -> Self {
        Self { terms }
    }
}

impl Fusion for Product {
    fn fuse(&self, scores: &[Vec<f32>], evidence: &[Evidence], log_weights: &mut [f64]) {
        for ((term, row), evidence) in self.terms.iter().zip(scores).zip(evidence) {
            if *evidence == Evidence::Missing {
                continue;
            }
            for (weight, &score) in log_weights.iter_mut().zip(row) {
                *weight += f64::from(term.log_likelihood(score));
            }
        }
    }

    fn log_likelihood(&self, cue: usize, score: f32) -> f64 {
        self.terms
            .get(cue)
            .map_or(0.0, |term| f64::from(term.log_likelihood(score)))
    }
}

impl Term {
    /// A score that is not a number stays one, so that the particle is set aside and counted.
    fn log_likelihood(&self, score: f32) -> f32 {
        let raw = self.calibration.log_likelihood(score);
        if raw < self.floor {
            self.exponent * self.floor
        } else {
            self.exponent * raw
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn term(exponent: f32) -> Term {
        Term {
            calibration: Calibration::Distance { sigma: 1.0 },
            floor: -2.0,
            exponent,
        }
    }

    #[test]
    fn a_missing_modality_has_likelihood_one() {
        let fusion = Product::new(vec![term(1.0), term(1.0)]);
        let mut weights = [0.0; 2];
        fusion.fuse(
            &[vec![1.0, 0.5], vec![0.3, 9.0]],
            &[Evidence::Scored, Evidence::Missing],
            &mut weights,
        );
        assert_eq!(weights, [-1.0, -0.25]);
    }

    #[test]
    fn the_floor_bounds_a_cue_and_not_a_number_stays() {
        let fusion = Product::new(vec![term(0.5)]);
        let mut weights = [0.0; 2];
        fusion.fuse(&[vec![100.0, f32::NAN]], &[Evidence::Scored], &mut weights);
        assert_eq!(weights[0], -1.0);
        assert!(weights[1].is_nan());
    }
}
