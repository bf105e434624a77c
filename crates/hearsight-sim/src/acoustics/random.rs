//! Random numbers: one generator for each role and number, so that no order of calls or threads changes a sample.

use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// xoshiro256++ (Blackman and Vigna 2021).
pub(crate) type Generator = Xoshiro256PlusPlus;

/// The generator for one purpose: `role` says what the numbers are for, `id` which of them.
pub(crate) fn generator(seed: u64, role: &str, id: u64) -> Generator {
    Generator::seed_from_u64(derive(seed, role, id))
}

/// The seed of something that belongs to what has `seed`.
pub(crate) fn derive(seed: u64, role: &str, id: u64) -> u64 {
    // FNV-1a of the role: the same in every version and on every machine.
    let role = role.bytes().fold(0xCBF2_9CE4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3)
    });
    mix(mix(seed ^ role) ^ id)
}

/// One step of SplitMix64 (Steele, Lea and Flood 2014).
pub(crate) fn mix(state: u64) -> u64 {
    let mut output = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    output = (output ^ (output >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    output = (output ^ (output >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    output ^ (output >> 31)
}

/// A number drawn uniformly from `[low, high)`.
pub(crate) fn between(generator: &mut impl Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * (generator.next_u64() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
}

/// A standard normal number.
pub(crate) fn normal(generator: &mut impl Rng) -> f64 {
    use rand_distr::Distribution;
    rand_distr::StandardNormal.sample(generator)
}

/// A positive number with this mean, exponentially distributed.
pub(crate) fn exponential(generator: &mut impl Rng, mean: f64) -> f64 {
    -mean * (1.0 - between(generator, 0.0, 1.0)).ln()
}
