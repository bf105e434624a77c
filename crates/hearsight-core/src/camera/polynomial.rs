//! Roots and inverses of the odd polynomials that lens models are made of.
//!
//! A distortion polynomial is only meaningful up to its first turning point; beyond it far-away directions would fold
//! back into the picture. Nothing here knows a camera.

/// Halvings of an interval after which `f64` cannot tell its ends apart, from any starting length that occurs.
const BISECTIONS: usize = 200;

/// The value at `x` of the polynomial with `coefficients`, constant term first.
pub(super) fn evaluate(coefficients: &[f64], x: f64) -> f64 {
    coefficients
        .iter()
        .rev()
        .fold(0.0, |sum, coefficient| sum * x + coefficient)
}

/// Where the polynomial (constant term first) changes sign in (0, `limit`), ascending.
///
/// Between neighbouring turning points a polynomial is monotonic, so one bisection a piece finds every crossing,
/// and the turning points are the crossings of the derivative.
fn sign_changes(coefficients: &[f64], limit: f64) -> Vec<f64> {
    if coefficients.len() < 2 {
        return Vec::new();
    }
    let derivative: Vec<f64> = coefficients
        .iter()
        .enumerate()
        .skip(1)
        .map(|(power, coefficient)| power as f64 * coefficient)
        .collect();
    let mut ends = vec![0.0];
    ends.extend(sign_changes(&derivative, limit));
    ends.push(limit);
    let mut crossings = Vec::new();
    for pair in ends.windows(2) {
        let (mut low, mut high) = (pair[0], pair[1]);
        let rising = evaluate(coefficients, high) > 0.0;
        if rising == (evaluate(coefficients, low) > 0.0) {
            continue;
        }
        for _ in 0..BISECTIONS {
            let middle = low + (high - low) / 2.0;
            if (evaluate(coefficients, middle) > 0.0) == rising {
                high = middle;
            } else {
                low = middle;
            }
        }
        crossings.push(low);
    }
    crossings
}

/// The first x in (0, `limit`) at which the polynomial (constant term first) changes sign.
pub(super) fn first_sign_change(coefficients: &[f64], limit: f64) -> Option<f64> {
    sign_changes(coefficients, limit).first().copied()
}

/// The x in \[0, `upper`\] at which a rising function with `function(0) = 0` reaches `target`, to rounding; `None`
/// where it does not. `function` gives value and slope. Newton's method, kept in a shrinking bracket.
pub(super) fn inverse_of_rising(
    function: impl Fn(f64) -> (f64, f64),
    target: f64,
    upper: f64,
) -> Option<f64> {
    if !(target >= 0.0 && upper.is_finite() && function(upper).0 >= target) {
        return None;
    }
    let (mut low, mut high) = (0.0, upper);
    let mut x = target.min(upper);
    for _ in 0..BISECTIONS {
        let (value, slope) = function(x);
        if value >= target {
            high = x;
        } else {
            low = x;
        }
        let newton = x - (value - target) / slope;
        // One end of the bracket is x itself: a step of nothing is an answer, not a reason to halve.
        let next = if newton >= low && newton <= high {
            newton
        } else {
            low + (high - low) / 2.0
        };
        if (next - x).abs() <= f64::EPSILON * x {
            return Some(next);
        }
        x = next;
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_takes_few_steps() {
        let steps = |factor: [f64; 4], slope: [f64; 4], target: f64| {
            let count = std::cell::Cell::new(0);
            let found = inverse_of_rising(
                |x| {
                    count.set(count.get() + 1);
                    (x * evaluate(&factor, x * x), evaluate(&slope, x * x))
                },
                target,
                5.0,
            );
            (found.unwrap(), count.get())
        };
        // A lens that bends nothing, and one that does.
        assert_eq!(steps([1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], 0.37), (0.37, 2));
        for target in [0.01, 0.2, 0.37, 0.8] {
            let (k1, k2) = (-0.1, 0.02);
            let (_, count) = steps([1.0, k1, k2, 0.0], [1.0, 3.0 * k1, 5.0 * k2, 0.0], target);
            assert!(count < 12, "{target}: {count}");
        }
    }

    #[test]
    fn finds_the_first_of_several_roots() {
        // (x - 1)(x - 2)(x - 3)
        let root = first_sign_change(&[-6.0, 11.0, -6.0, 1.0], 10.0).unwrap();
        assert!((root - 1.0).abs() < 1e-12, "{root}");
        assert_eq!(first_sign_change(&[1.0, 0.0, 1.0], 1e6), None);
        assert_eq!(first_sign_change(&[1.0], 1e6), None);
    }

    #[test]
    fn inverts_a_rising_function_at_its_ends_too() {
        let cubic = |x: f64| (x + x * x * x, 1.0 + 3.0 * x * x);
        assert_eq!(inverse_of_rising(cubic, 0.0, 4.0), Some(0.0));
        assert!((inverse_of_rising(cubic, 10.0, 4.0).unwrap() - 2.0).abs() < 1e-14);
        assert!((inverse_of_rising(cubic, 68.0, 4.0).unwrap() - 4.0).abs() < 1e-14);
        assert_eq!(inverse_of_rising(cubic, 69.0, 4.0), None);
        assert_eq!(inverse_of_rising(cubic, f64::NAN, 4.0), None);
    }
}
