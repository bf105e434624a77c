//! From raw scores to log-likelihoods, one small function a rule.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a raw score becomes a log-likelihood.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Calibration {
    /// exp(-(d / sigma)^2) of a distance d (stac, eq. 9).
    Distance {
        /// sigma, in the unit of the distance, above 0.
        sigma: f32,
    },
    /// The raw score is a likelihood already.
    Likelihood,
    /// The raw score is the logarithm of a likelihood.
    Logarithm,
    /// exp(-(1 - R)^2 / (2 sigma^2)) of a normalized correlation R (stac, eq. 8, corrected by E4).
    Correlation {
        /// sigma_A, above 0.
        sigma: f32,
    },
    /// exp(-R^2 / (2 sigma^2)): stac, eq. 8 as printed, smallest at the peak. Kept to show that it fails.
    PrintedCorrelation {
        /// sigma_A, above 0.
        sigma: f32,
    },
}

impl Calibration {
    /// The log-likelihood of a raw score, up to a constant that is the same for every hypothesis.
    pub fn log_likelihood(self, score: f32) -> f32 {
        match self {
            Self::Distance { sigma } => -(score / sigma).powi(2),
            Self::Likelihood => score.ln(),
            Self::Logarithm => score,
            Self::Correlation { sigma } => -0.5 * ((1.0 - score) / sigma).powi(2),
            Self::PrintedCorrelation { sigma } => -0.5 * (score / sigma).powi(2),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corrected_correlation_is_best_at_the_peak_and_the_printed_form_worst() {
        let (peak, floor) = (1.0, 0.0);
        let corrected = Calibration::Correlation { sigma: 0.3 };
        let printed = Calibration::PrintedCorrelation { sigma: 0.3 };
        assert!(corrected.log_likelihood(peak) > corrected.log_likelihood(floor));
        assert!(printed.log_likelihood(peak) < printed.log_likelihood(floor));
    }

    #[test]
    fn distance_is_equation_nine() {
        let calibration = Calibration::Distance { sigma: 0.2 };
        assert!((calibration.log_likelihood(0.4) - -4.0).abs() < 1e-5);
    }
}
