//! Sums of exponentials without overflow or underflow.

use crate::elementary;
use multiversion::multiversion;

/// `ln(sum(exp(values)))`, exact to rounding whatever the size of the values.
///
/// Values that are negative infinity (a weight of zero) add nothing; of an empty slice or of zero weights only, the
/// result is negative infinity. Infinity or NaN among the values comes out as infinity or NaN: set such weights aside
/// first, as [`Particles::normalize`](crate::Particles::normalize) does.
///
/// ```
/// use hearsight_filter::log_sum_exp;
/// assert!((log_sum_exp(&[-1000.0, -1000.0]) - (-1000.0 + 2.0_f64.ln())).abs() < 1e-12);
/// assert_eq!(log_sum_exp(&[]), f64::NEG_INFINITY);
/// ```
pub fn log_sum_exp(values: &[f64]) -> f64 {
    let greatest = elementary::greatest(values);
    if greatest == f64::INFINITY {
        return if values.iter().any(|value| value.is_nan()) {
            f64::NAN
        } else {
            greatest
        };
    }
    if greatest == f64::NEG_INFINITY {
        return if values.iter().any(|value| value.is_nan()) {
            f64::NAN
        } else {
            greatest
        };
    }
    greatest
        + elementary::ln(elementary::sum_of(values, |value| {
            elementary::exp(value - greatest)
        }))
}

/// Writes `exp(log_weights - shift)` with the greatest written value 1, and returns `(shift, sum)`.
///
/// The sum is NaN if a weight is NaN; `shift` is infinite, and nothing is written, if no weight is finite or one is
/// infinity.
pub(crate) fn exponentiate(log_weights: &[f64], weights: &mut [f64]) -> (f64, f64) {
    let shift = elementary::greatest(log_weights);
    if shift.is_infinite() {
        return (shift, 0.0);
    }
    (shift, exponentiate_shifted(log_weights, shift, weights))
}

/// Writes `exp(log_weights - shift)` and returns the sum. The wider registers change the speed, not the bits.
#[multiversion(targets("x86_64+avx2"))]
fn exponentiate_shifted(log_weights: &[f64], shift: f64, weights: &mut [f64]) -> f64 {
    for (weight, log_weight) in weights.iter_mut().zip(log_weights) {
        *weight = elementary::exp(log_weight - shift);
    }
    elementary::sum_of(weights, |weight| weight)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn shifts_come_out_and_order_does_not_matter(
            mut values in prop::collection::vec(-50.0..50.0_f64, 1..60), shift in -1e6..1e6_f64,
        ) {
            let direct = values.iter().map(|value| value.exp()).sum::<f64>().ln();
            prop_assert!((log_sum_exp(&values) - direct).abs() < 1e-12 * direct.abs().max(1.0));
            values.reverse();
            let shifted: Vec<f64> = values.iter().map(|value| value + shift).collect();
            prop_assert!((log_sum_exp(&shifted) - direct - shift).abs() < 1e-9);
        }
    }

    #[test]
    fn zero_weights_and_bad_weights() {
        let none = f64::NEG_INFINITY;
        assert_eq!(log_sum_exp(&[none, none]), none);
        assert_eq!(log_sum_exp(&[none, 3.0]), 3.0);
        assert_eq!(log_sum_exp(&[f64::INFINITY, 3.0]), f64::INFINITY);
        assert!(log_sum_exp(&[f64::NAN, 3.0]).is_nan());
        assert!(log_sum_exp(&[f64::NAN, f64::INFINITY]).is_nan());
        assert!(log_sum_exp(&[f64::NAN]).is_nan());
    }
}
