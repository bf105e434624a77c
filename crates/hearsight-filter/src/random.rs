//! One generator a belief, the same on every machine and in every order of threads.
//!
//! Two runs with one seed must agree byte for byte, so nothing here depends on a clock, an address or a hash that
//! changes between runs, and normal variates are computed without the platform's mathematics library.

mod normal;

pub use normal::{fill_standard_normal, standard_normal};

use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// The generator of a belief: xoshiro256++ (Blackman and Vigna 2021), period 2^256 - 1, saved with the belief.
pub type Generator = Xoshiro256PlusPlus;

/// The generator of one belief of one run.
///
/// `role` says what the numbers are for ("track", "sound", "scout", ...): beliefs with one `id` and different roles
/// get unrelated numbers. The mix, part of the format of saved runs: start from `run_seed`; for FNV-1a (64 bits) of
/// the bytes of `role` and then for `id`, replace the state by SplitMix64(state xor part); four further outputs of
/// SplitMix64 from that state, as little-endian bytes, are the state of the generator.
///
/// ```
/// use hearsight_filter::generator;
/// assert_eq!(generator(7, "track", 1), generator(7, "track", 1));
/// assert_ne!(generator(7, "track", 1), generator(7, "sound", 1));
/// ```
pub fn generator(run_seed: u64, role: &str, id: u64) -> Generator {
    let mut state = run_seed;
    for part in [fnv_1a(role.as_bytes()), id] {
        state ^= part;
        state = split_mix(&mut state);
    }
    let mut seed = [0_u8; 32];
    for word in seed.chunks_exact_mut(8) {
        word.copy_from_slice(&split_mix(&mut state).to_le_bytes());
    }
    Generator::from_seed(seed)
}

/// A number drawn uniformly from `[0, 1)`, a multiple of 2^-53.
#[inline]
pub fn uniform(generator: &mut impl Rng) -> f64 {
    (generator.next_u64() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
}

/// SplitMix64 (Steele, Lea and Flood 2014): steps the state and returns its next output.
fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut output = *state;
    output = (output ^ (output >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    output = (output ^ (output >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    output ^ (output >> 31)
}

/// FNV-1a of 64 bits (Fowler, Noll and Vo): a hash of a name that never changes between versions.
fn fnv_1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01B3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_parts_agree_with_their_published_values() {
        // SplitMix64 from zero, and FNV-1a of "" and "foobar", as their authors publish them.
        let mut state = 0;
        assert_eq!(split_mix(&mut state), 0xE220_A839_7B1D_CDAF);
        assert_eq!(split_mix(&mut state), 0x6E78_9E6A_A1B9_65F4);
        assert_eq!(fnv_1a(b""), 0xCBF2_9CE4_8422_2325);
        assert_eq!(fnv_1a(b"foobar"), 0x8594_4171_F739_67E8);
    }

    #[test]
    fn neighbours_get_different_generators() {
        let mut first = BTreeSet::new();
        for seed in 0..10 {
            for role in ["track", "sound", "scout", ""] {
                for id in 0..100 {
                    assert!(
                        first.insert(generator(seed, role, id).next_u64()),
                        "{seed} {role} {id}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_saved_generator_goes_on_where_it_was() {
        let mut original = generator(1, "track", 2);
        original.next_u64();
        let text = serde_json::to_string(&original).unwrap();
        let mut restored: Generator = serde_json::from_str(&text).unwrap();
        assert_eq!(original.next_u64(), restored.next_u64());
    }

    #[test]
    fn uniform_numbers_stay_below_one() {
        let mut generator = generator(1, "test", 0);
        let count = 100_000;
        let mean = (0..count)
            .map(|_| uniform(&mut generator))
            .inspect(|u| assert!((0.0..1.0).contains(u)))
            .sum::<f64>()
            / f64::from(count);
        // Five standard errors.
        assert!((mean - 0.5).abs() < 5.0 * (1.0 / 12.0_f64).sqrt() / f64::from(count).sqrt());
    }
}
