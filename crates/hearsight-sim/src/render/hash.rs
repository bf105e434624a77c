//! Numbers that look random and are functions of their place: the same for any order of threads and at any time.

/// The finalizer of SplitMix64 (Steele, Lea and Flood 2014).
#[inline(always)]
pub(super) const fn mix(number: u64) -> u64 {
    let mixed = number.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    mixed ^ (mixed >> 31)
}

/// A number for a cell of a grid.
#[inline(always)]
pub(super) const fn cell(seed: u64, x: i64, y: i64) -> u64 {
    mix(mix(seed ^ (x as u64).wrapping_mul(0xD6E8_FEB8_6659_FD93)) ^ (y as u64))
}

/// Evenly from 0 to 1, from the `which`-th 16 bits of a number.
#[inline(always)]
pub(super) const fn unit(number: u64, which: u32) -> f32 {
    ((number >> (16 * (which & 3))) & 0xFFFF) as f32 / 65_536.0
}

/// Evenly from -1 to 1, for the `which`-th property of something with this seed.
pub(super) const fn trait_of(seed: u64, which: u64) -> f32 {
    2.0 * unit(mix(mix(seed) ^ which), 0) - 1.0
}

/// Smooth noise, 0 to 1, that changes over a distance of 1.
#[inline]
pub(super) fn smooth(seed: u64, x: f32, y: f32) -> f32 {
    let (column, row) = (x.floor(), y.floor());
    let ease = |part: f32| part * part * (3.0 - 2.0 * part);
    let (across, down) = (ease(x - column), ease(y - row));
    let (column, row) = (column as i64, row as i64);
    let at = |dx: i64, dy: i64| unit(cell(seed, column + dx, row + dy), 0);
    let top = at(0, 0) + across * (at(1, 0) - at(0, 0));
    let bottom = at(0, 1) + across * (at(1, 1) - at(0, 1));
    top + down * (bottom - top)
}
