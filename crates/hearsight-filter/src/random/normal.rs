//! Standard normal variates by the method of Box and Muller (1958) in vector form.
//!
//! The usual ziggurat asks the platform's `exp` and `ln` on one draw in a hundred, whose last bits differ between
//! systems, and consumes a varying number of words, which keeps it from vector registers. This form takes one word
//! for two variates, always, and uses only operations that IEEE 754 defines to the last bit.

use multiversion::multiversion;
use rand::Rng;

const PAIRS: usize = 64;

/// Fills `variates` with independent standard normal numbers, of magnitude up to 6.7.
///
/// Takes `ceil(n / 2)` words from the generator, so what follows does not depend on the values drawn. The same words
/// give the same bits on every machine.
pub fn fill_standard_normal(generator: &mut impl Rng, variates: &mut [f32]) {
    let (mut radii, mut angles) = ([0_u32; PAIRS], [0_u32; PAIRS]);
    for block in variates.chunks_mut(2 * PAIRS) {
        let (front, back) = block.split_at_mut(block.len().div_ceil(2));
        for (radius, angle) in radii.iter_mut().zip(&mut angles).take(front.len()) {
            let word = generator.next_u64();
            (*radius, *angle) = ((word >> 32) as u32, word as u32);
        }
        transform(&radii, &angles, front, back);
        // Of an odd number, the last has no partner.
        if let Some(last) = front.get_mut(back.len()) {
            *last = pair(radii[back.len()], angles[back.len()]).0;
        }
    }
}

/// Turns each pair of words into two variates, as many as `second` holds. The wider registers change the speed, not
/// the bits; words of 32 bits keep all lanes of one width, which doubles the speed.
#[multiversion(targets("x86_64+avx2"))]
fn transform(radii: &[u32], angles: &[u32], first: &mut [f32], second: &mut [f32]) {
    for (((radius, angle), first), second) in radii.iter().zip(angles).zip(first).zip(second) {
        (*first, *second) = pair(*radius, *angle);
    }
}

/// One standard normal number; where many are needed, [`fill_standard_normal`] is several times faster.
pub fn standard_normal(generator: &mut impl Rng) -> f64 {
    let word = generator.next_u64();
    f64::from(pair((word >> 32) as u32, word as u32).0)
}

/// Two independent normal variates from 64 random bits: 31 for the radius, 30 for the angle within an eighth of a
/// turn to either side, two for sign and axis.
#[inline(always)]
fn pair(high: u32, low: u32) -> (f32, f32) {
    // In (0, 1]: rounding keeps the resolution near zero, where the tail of the distribution comes from.
    let uniform = ((high >> 1) as i32 as f32 + 0.5) * (1.0 / 2_147_483_648.0);
    let square = -2.0 * ln(uniform);
    let radius = (if square > 0.0 { square } else { 0.0 }).sqrt();
    // In [-pi/4, pi/4).
    let angle = (((low << 2) as i32) >> 2) as f32 * (std::f32::consts::FRAC_PI_4 / 536_870_912.0);
    let square = angle * angle;
    let sine =
        angle + angle * square * (-1.666_665_5e-1 + square * (8.332_161e-3 + square * -1.951_529_6e-4));
    let cosine = 1.0 - 0.5 * square
        + square * square * (4.166_664_6e-2 + square * (-1.388_731_6e-3 + square * 2.443_315_7e-5));
    let long = f32::from_bits((radius * cosine).to_bits() ^ (low & 0x8000_0000));
    let short = radius * sine;
    // All ones if the long side lies along the second axis.
    let swap = 0_u32.wrapping_sub((low >> 30) & 1);
    let exchanged = (long.to_bits() ^ short.to_bits()) & swap;
    (
        f32::from_bits(long.to_bits() ^ exchanged),
        f32::from_bits(short.to_bits() ^ exchanged),
    )
}

/// The natural logarithm of a positive normal number within 2 units in the last place (Cephes `logf`, Moshier 1989).
#[inline(always)]
fn ln(x: f32) -> f32 {
    let exponent = (x.to_bits().wrapping_sub(0x3F35_04F3) as i32) >> 23;
    let part = f32::from_bits(x.to_bits().wrapping_sub((exponent << 23) as u32)) - 1.0;
    let exponent = exponent as f32;
    // Estrin's scheme: half the depth of Horner's, so that the steps overlap.
    let square = part * part;
    let fourth = square * square;
    let low = (3.333_333e-1 - 2.499_999_4e-1 * part) + (2.000_071_5e-1 - 1.666_805_8e-1 * part) * square;
    let high = (1.424_932_3e-1 - 1.242_014_1e-1 * part) + (1.167_699_9e-1 - 1.151_461e-1 * part) * square;
    let series = low + (high + 7.037_683_6e-2 * fourth) * fourth;
    let tail = series * part * square + exponent * -2.121_944_4e-4 - 0.5 * square;
    part + tail + exponent * 0.693_359_4
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::generator;

    #[test]
    fn logarithm_and_circle_are_accurate() {
        for index in 0..200_000_u32 {
            let x = (f64::from(index) + 0.5) / 200_000.0;
            let expected = f64::from(x as f32).ln();
            assert!(
                (f64::from(ln(x as f32)) - expected).abs() <= 3e-7 * expected.abs().max(1e-3),
                "{x}"
            );
        }
        let mut words = generator(3, "test", 0);
        for _ in 0..100_000 {
            let word = words.next_u64();
            let (a, b) = pair((word >> 32) as u32, word as u32);
            let uniform = (((word >> 33) as f64) + 0.5) / 2_147_483_648.0;
            let radius = (-2.0 * uniform.ln()).sqrt();
            assert!((f64::from(a).hypot(f64::from(b)) - radius).abs() < 1e-5 + 4e-4 / (radius + 1e-3) * 1e-3);
        }
    }

    #[test]
    fn every_length_is_filled_and_extremes_are_finite() {
        for length in 0..300 {
            let mut variates = vec![f32::NAN; length];
            fill_standard_normal(&mut generator(1, "test", length as u64), &mut variates);
            assert!(
                variates
                    .iter()
                    .all(|variate| variate.is_finite() && variate.abs() < 6.8)
            );
        }
        for word in [
            0,
            u64::MAX,
            0xFFFF_FFFF,
            0xFFFF_FFFF_0000_0000,
            0x8000_0000,
            0x4000_0000,
        ] {
            let (a, b) = pair((word >> 32) as u32, word as u32);
            assert!(a.is_finite() && b.is_finite());
        }
    }

    #[test]
    fn moments_tails_and_independence_are_those_of_the_normal_distribution() {
        let count = 4_000_000;
        let mut variates = vec![0.0_f32; count];
        fill_standard_normal(&mut generator(11, "test", 0), &mut variates);
        let mean_of = |term: &dyn Fn(f64) -> f64| {
            variates
                .iter()
                .map(|variate| term(f64::from(*variate)))
                .sum::<f64>()
                / count as f64
        };
        // Five standard errors: the variances of x, x^2, x^3 and x^4 are 1, 2, 15 and 96.
        let tolerance = |variance: f64| 5.0 * (variance / count as f64).sqrt();
        assert!(mean_of(&|x| x).abs() < tolerance(1.0));
        assert!((mean_of(&|x| x * x) - 1.0).abs() < tolerance(2.0));
        assert!(mean_of(&|x| x * x * x).abs() < tolerance(15.0));
        assert!((mean_of(&|x| x.powi(4)) - 3.0).abs() < tolerance(96.0));
        // Distribution function at some points, from tables.
        for (point, below) in [
            (-3.0, 0.001_349_898),
            (-2.0, 0.022_750_132),
            (-1.0, 0.158_655_254),
            (0.5, 0.691_462_461),
            (4.0, 0.999_968_329),
        ] {
            let fraction = mean_of(&|x| f64::from(u8::from(x < point)));
            assert!(
                (fraction - below).abs() < tolerance(below * (1.0 - below)),
                "{point}: {fraction} {below}"
            );
        }
        // The two of a pair lie 64 apart.
        let product = |lag: usize, power: i32| {
            variates
                .iter()
                .zip(&variates[lag..])
                .map(|(a, b)| f64::from(a.powi(power) * b.powi(power)))
                .sum::<f64>()
                / (count - lag) as f64
        };
        for lag in [1, 2, 64] {
            assert!(product(lag, 1).abs() < tolerance(1.0), "lag {lag}");
            assert!((product(lag, 2) - 1.0).abs() < tolerance(8.0), "lag {lag}");
        }
    }

    #[test]
    fn the_same_bits_on_every_machine() {
        let mut variates = [0.0_f32; 1000];
        fill_standard_normal(&mut generator(2024, "golden", 7), &mut variates);
        let digest = variates.iter().fold(0_u64, |hash, variate| {
            (hash.rotate_left(5) ^ u64::from(variate.to_bits())).wrapping_mul(0x517C_C1B7_2722_0A95)
        });
        assert_eq!(digest, 0xE4E4_580A_C9EB_1823, "{digest:#x}");
    }
}
