//! Looking delays up: distances of points, places in the tables of pairs, scores.

use crate::error::{AudioError, check_shape};
use hearsight_core::WorldPoint;

/// Points worked on together.
pub(super) const LANES: usize = 64;
/// Points of a table worked on together: their scores stay in the fastest memory while the pairs pass.
const BLOCK: usize = 1024;
/// Bits of a place behind the point.
const FRACTION_BITS: u32 = 12;

/// The score at one delay and the step to the next delay's.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Entry {
    pub(super) value: f32,
    pub(super) step: f32,
}

/// From differences of distance to places in a pair's table.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaceScale {
    /// Entries of the table a metre.
    pub(super) per_metre: f32,
    /// Entry of the delay 0.
    pub(super) middle: f32,
}

/// The delays of fixed points at all pairs of one array: pairs x points.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayTable {
    points: usize,
    /// In blocks of points; in each, pair after pair: places in fixed-point numbers.
    places: Vec<u32>,
    pairs: usize,
    length: usize,
}

impl DelayTable {
    pub(super) fn new(
        points: &[WorldPoint],
        positions: &[[f32; 3]],
        pairs: &[(usize, usize)],
        scale: PlaceScale,
        length: usize,
    ) -> Self {
        let mut places = Vec::with_capacity(points.len() * pairs.len());
        let last = (length - 1) as f32;
        for block in points.chunks(BLOCK) {
            for &(i, j) in pairs {
                places.extend(block.iter().map(|point| {
                    let [first, second] = [positions[i], positions[j]].map(|p| point.distance_m(wide(p)));
                    let place = (first - second) * f64::from(scale.per_metre) + f64::from(scale.middle);
                    // Conversion of what is not a number gives 0.
                    (place.clamp(0.0, f64::from(last)) * f64::from(1_u32 << FRACTION_BITS)) as u32
                }));
            }
        }
        Self {
            points: points.len(),
            places,
            pairs: pairs.len(),
            length,
        }
    }

    /// How many points there are.
    pub fn points(&self) -> usize {
        self.points
    }

    pub(super) fn score(
        &self,
        entries: &[Entry],
        pairs: usize,
        length: usize,
        scores: &mut Vec<f32>,
    ) -> Result<(), AudioError> {
        check_shape("pairs of a delay table", pairs, self.pairs)?;
        check_shape("delays of a delay table", length, self.length)?;
        scores.clear();
        scores.resize(self.points, 0.0);
        let blocks = self.places.chunks(BLOCK * pairs).zip(scores.chunks_mut(BLOCK));
        for (places, scores) in blocks {
            let rows = places.chunks_exact(scores.len());
            for (places, entries) in rows.zip(entries.chunks_exact(length)) {
                add_places(places, entries, scores);
            }
        }
        Ok(())
    }
}

fn wide(position: [f32; 3]) -> WorldPoint {
    let [x, y, z] = position.map(f64::from);
    WorldPoint::new(x, y, z)
}

/// Adds to each score that of its place.
#[multiversion::multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn add_places(places: &[u32], entries: &[Entry], scores: &mut [f32]) {
    let Some(last) = entries.len().checked_sub(1) else {
        return;
    };
    const UNIT: f32 = 1.0 / (1_u32 << FRACTION_BITS) as f32;
    for (score, &place) in scores.iter_mut().zip(places) {
        let entry = entries[((place >> FRACTION_BITS) as usize).min(last)];
        let part = (place & ((1 << FRACTION_BITS) - 1)) as i32 as f32 * UNIT;
        *score += entry.value + part * entry.step;
    }
}

/// Distances of a block of at most [`LANES`] points from every microphone.
#[multiversion::multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
pub(super) fn distances(points: [&[f32]; 3], positions: &[[f32; 3]], distances: &mut [[f32; LANES]]) {
    let [x, y, z] = points;
    for (position, distances) in positions.iter().zip(distances) {
        for (((distance, x), y), z) in distances.iter_mut().zip(x).zip(y).zip(z) {
            let [dx, dy, dz] = [x - position[0], y - position[1], z - position[2]];
            *distance = (dx * dx + dy * dy + dz * dz).sqrt();
        }
    }
}

/// Adds to each score that of its difference of distances.
#[multiversion::multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
pub(super) fn add_differences(
    first: &[f32; LANES],
    second: &[f32; LANES],
    scale: PlaceScale,
    entries: &[Entry],
    scores: &mut [f32],
) {
    let Some(last) = entries.len().checked_sub(1) else {
        return;
    };
    for ((score, first), second) in scores.iter_mut().zip(first).zip(second) {
        let place = ((first - second) * scale.per_metre + scale.middle).clamp(0.0, last as f32);
        let index = place as i32;
        let entry = entries[(index as usize).min(last)];
        *score += entry.value + (place - index as f32) * entry.step;
    }
}

/// The natural logarithm of a positive, normal number to 2e-7 of its value or 1e-7, the same on every machine.
pub(super) fn ln(x: f32) -> f32 {
    let bits = x.to_bits();
    // The mantissa in sqrt(1/2) to sqrt(2).
    let exponent = ((bits as i32) - 0x3F35_04F3) >> 23;
    let mantissa = f32::from_bits((bits as i32 - (exponent << 23)) as u32);
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let z = s * s;
    let series = 2.0 + z * (0.666_666_7 + z * (0.4 + z * (0.285_714_3 + z * 0.222_222_2)));
    exponent as f32 * std::f32::consts::LN_2 + s * series
}
