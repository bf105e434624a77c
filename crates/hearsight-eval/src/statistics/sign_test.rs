//! Whether one system is better than another more often than chance: the exact sign test.

use super::{Alternative, StatisticsError};

/// Result of a sign test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignTest {
    /// Pairs whose difference is above zero.
    pub above: usize,
    /// Pairs whose difference is below zero.
    pub below: usize,
    /// Pairs without difference, which are left out.
    pub equal: usize,
    /// Probability of a result at least as extreme where neither is better, 0 to 1.
    pub p: f64,
}

/// The exact paired sign test: `differences` are ours less theirs. Pairs without difference are left out; where nothing
/// is left, p is 1. As `scipy.stats.binomtest(above, above + below, 0.5)`.
///
/// ```
/// use hearsight_eval::statistics::{Alternative, sign_test};
/// let seven_of_seven = sign_test(&[1.0; 7], Alternative::Greater)?;
/// assert_eq!(seven_of_seven.p, 1.0 / 128.0);
/// # Ok::<(), hearsight_eval::statistics::StatisticsError>(())
/// ```
///
/// # Errors
/// [`StatisticsError::NotFinite`].
pub fn sign_test(differences: &[f64], alternative: Alternative) -> Result<SignTest, StatisticsError> {
    StatisticsError::check("the differences", differences, 0)?;
    let count = |wanted: fn(&f64) -> bool| differences.iter().filter(|value| wanted(value)).count();
    let (above, below) = (count(|value| *value > 0.0), count(|value| *value < 0.0));
    let trials = above + below;
    let p = match alternative {
        Alternative::Greater => tail(below, trials),
        Alternative::Less => tail(above, trials),
        Alternative::TwoSided => (2.0 * tail(above.min(below), trials)).min(1.0),
    };
    Ok(SignTest {
        above,
        below,
        equal: differences.len() - trials,
        p,
    })
}

/// Probability of at most `most` heads in `trials` tosses of a fair coin.
fn tail(most: usize, trials: usize) -> f64 {
    if most >= trials {
        return 1.0;
    }
    // From the largest term on, relative to it, so that neither powers of two nor factorials leave the range.
    let logarithm_of_term = |heads: usize| {
        let gamma = |n: usize| libm::lgamma(n as f64 + 1.0);
        gamma(trials) - gamma(heads) - gamma(trials - heads) - trials as f64 * std::f64::consts::LN_2
    };
    if trials <= 1000 {
        // Exact products: below 2^1023 nothing is lost but rounding.
        let mut term = 0.5_f64.powi(trials as i32);
        let mut sum = term;
        for heads in 0..most {
            term *= (trials - heads) as f64 / (heads + 1) as f64;
            sum += term;
        }
        return sum.min(1.0);
    }
    let mut term = libm::exp(logarithm_of_term(most));
    let mut sum = 0.0;
    for heads in (0..=most).rev() {
        sum += term;
        term *= heads as f64 / (trials - heads + 1) as f64;
    }
    sum.min(1.0)
}
