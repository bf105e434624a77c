//! Exponential, logarithm and sums from additions, multiplications, divisions and bit patterns only.
//!
//! The standard library calls the platform's mathematics library, whose last bits differ between systems, and one
//! bit can change which particle is drawn. These forms give the same bits on every IEEE 754 machine. They have no
//! branches, so that loops over slices become vector instructions. Sums run in eight lanes whose order is fixed.

use std::f64::consts::LOG2_E;

const LANES: usize = 8;
// ln 2 in two parts (fdlibm): the product of the first with any exponent is exact.
const LN_2_HIGH: f64 = f64::from_bits(0x3FE6_2E42_FEE0_0000);
const LN_2_LOW: f64 = f64::from_bits(0x3DEA_39EF_3579_3C76);
// Adding 1.5 * 2^52 rounds to the nearest integer and leaves it in the low bits.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// `e^x` within 1.5 units in the last place; 0 below -708 (no subnormal results), infinity above 709.7, NaN for NaN.
#[inline(always)]
pub(crate) fn exp(x: f64) -> f64 {
    let shifted = x * LOG2_E + ROUNDING;
    let whole = shifted - ROUNDING;
    let rest = (x - whole * LN_2_HIGH) - whole * LN_2_LOW;
    // Taylor's series by Estrin's scheme: for |rest| <= ln(2)/2 the first term left out is below 5e-18.
    let (square, fourth) = (rest * rest, rest * rest * (rest * rest));
    let low = (1.0 / 2.0 + rest * (1.0 / 6.0)) + (1.0 / 24.0 + rest * (1.0 / 120.0)) * square;
    let middle =
        (1.0 / 720.0 + rest * (1.0 / 5_040.0)) + (1.0 / 40_320.0 + rest * (1.0 / 362_880.0)) * square;
    let high = (1.0 / 3_628_800.0 + rest * (1.0 / 39_916_800.0))
        + (1.0 / 479_001_600.0 + rest * (1.0 / 6_227_020_800.0)) * square;
    let series = 1.0 + (rest + square * (low + (middle + high * fourth) * fourth));
    let power = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    let value = series * power;
    let value = if x < -708.0 { 0.0 } else { value };
    if x > 709.0 { f64::INFINITY } else { value }
}

/// The nearest whole number (the even one of two) of a value from -0.5 to 2^32 - 1.
#[inline(always)]
pub(crate) fn nearest(value: f64) -> u32 {
    (value + ROUNDING).to_bits() as u32
}

/// The natural logarithm of a positive normal number within 2 units in the last place; of zero, negative
/// infinity; of anything negative, NaN.
#[inline(always)]
pub(crate) fn ln(x: f64) -> f64 {
    if x.is_nan() || x < 0.0 {
        return f64::NAN;
    }
    if x < f64::MIN_POSITIVE {
        return f64::NEG_INFINITY;
    }
    if x == f64::INFINITY {
        return x;
    }
    // x = 2^exponent * mantissa with the mantissa in [sqrt(1/2), sqrt(2)).
    let offset = x.to_bits().wrapping_sub(0x3FE6_A09E_667F_3BCD);
    let exponent = (offset as i64) >> 52;
    let mantissa = f64::from_bits(x.to_bits().wrapping_sub((exponent as u64) << 52));
    // ln m = 2 artanh(s) with s = (m - 1) / (m + 1), |s| < 0.1716; the first term left out is below 2e-18.
    let ratio = (mantissa - 1.0) / (mantissa + 1.0);
    let square = ratio * ratio;
    let mut series = 1.0 / 21.0;
    for denominator in [19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0] {
        series = series * square + 1.0 / denominator;
    }
    let exponent = exponent as f64;
    exponent * LN_2_HIGH + (2.0 * ratio + (2.0 * ratio * square * series + exponent * LN_2_LOW))
}

#[inline(always)]
fn fold(lanes: [f64; LANES]) -> f64 {
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// The sum of `term(a[i], b[i])`, as long as the shorter slice.
#[inline(always)]
pub(crate) fn sum_of_pairs<A: Copy, B: Copy>(a: &[A], b: &[B], term: impl Fn(A, B) -> f64) -> f64 {
    let mut lanes = [0.0; LANES];
    let (mut a_chunks, mut b_chunks) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    for (a, b) in (&mut a_chunks).zip(&mut b_chunks) {
        for lane in 0..LANES {
            lanes[lane] += term(a[lane], b[lane]);
        }
    }
    for (lane, (a, b)) in a_chunks.remainder().iter().zip(b_chunks.remainder()).enumerate() {
        lanes[lane] += term(*a, *b);
    }
    fold(lanes)
}

/// The sum of `term(a[i])`.
#[inline(always)]
pub(crate) fn sum_of<A: Copy>(a: &[A], term: impl Fn(A) -> f64) -> f64 {
    sum_of_pairs(a, a, |value, _| term(value))
}

/// The greatest value, NaN not counted; negative infinity if there is none.
#[inline(always)]
pub(crate) fn greatest(values: &[f64]) -> f64 {
    let mut lanes = [f64::NEG_INFINITY; LANES];
    let mut chunks = values.chunks_exact(LANES);
    for chunk in &mut chunks {
        for lane in 0..LANES {
            lanes[lane] = if chunk[lane] > lanes[lane] {
                chunk[lane]
            } else {
                lanes[lane]
            };
        }
    }
    for value in chunks.remainder().iter().chain(&lanes.clone()) {
        lanes[0] = if *value > lanes[0] { *value } else { lanes[0] };
    }
    lanes[0]
}

/// Whether every value is finite: one pass without branches.
#[inline(always)]
pub(crate) fn all_finite(values: &[f32]) -> bool {
    let mut lanes = [0.0_f32; LANES];
    let mut chunks = values.chunks_exact(LANES);
    for chunk in &mut chunks {
        for lane in 0..LANES {
            // Zero for finite values; NaN for NaN and for either infinity, and NaN stays.
            lanes[lane] += chunk[lane] * 0.0;
        }
    }
    lanes.iter().sum::<f32>() == 0.0 && chunks.remainder().iter().all(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponential_agrees_with_the_platform() {
        for step in -70_800..70_900 {
            let x = f64::from(step) * 0.01 + 1e-3;
            let expected = x.exp();
            assert!(
                (exp(x) - expected).abs() <= 4e-16 * expected,
                "{x}: {} {expected}",
                exp(x)
            );
        }
        assert_eq!(exp(0.0), 1.0);
        assert_eq!(exp(f64::NEG_INFINITY), 0.0);
        assert_eq!(exp(-1e300), 0.0);
        assert_eq!(exp(f64::INFINITY), f64::INFINITY);
        assert!(exp(f64::NAN).is_nan());
    }

    #[test]
    fn logarithm_agrees_with_the_platform() {
        for step in -30_000..30_000 {
            let x = (f64::from(step) * 0.0233).exp();
            assert!((ln(x) - x.ln()).abs() <= 3e-16 * x.ln().abs().max(0.1), "{x}");
        }
        assert_eq!(ln(1.0), 0.0);
        assert_eq!(ln(0.0), f64::NEG_INFINITY);
        assert!(ln(-1.0).is_nan());
        assert!(ln(f64::NAN).is_nan());
        assert_eq!(ln(f64::INFINITY), f64::INFINITY);
    }

    #[test]
    fn lanes_cover_every_length() {
        for length in 0..40 {
            let values: Vec<f64> = (0..length).map(|index| f64::from(index) - 50.0).collect();
            assert_eq!(sum_of(&values, |value| value), values.iter().sum::<f64>());
            assert_eq!(
                greatest(&values),
                values.last().copied().unwrap_or(f64::NEG_INFINITY)
            );
            for bad in 0..length as usize {
                let mut states = vec![1.0_f32; length as usize];
                assert!(all_finite(&states));
                states[bad] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY][bad % 3];
                assert!(!all_finite(&states));
            }
        }
    }
}
