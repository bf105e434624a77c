//! One tile of the map of outlines: the logarithm of equation 10 at a patch of places for lines of one direction.

use crate::contour::gradient::GradientPicture;
use multiversion::multiversion;

/// Size of a tile in values; the last row and column are the first of its neighbours, so that one tile holds all four
/// pixels around a place.
pub(super) const TILE: [usize; 2] = [16, 8];
pub(super) const VALUES: usize = TILE[0] * TILE[1];
/// Smallest deviation whose Gaussian the polynomial follows, pixels.
pub(super) const SMOOTH_PX: f32 = 1.5;

pub(super) type Values = [f32; VALUES];

/// A place between four pixels: the upper left one relative to the line's middle, and what each counts.
#[derive(Clone, Copy, Debug)]
struct Tap {
    column: i32,
    row: i32,
    weights: [f32; 4],
}

/// The samples along a line of one direction, from one before its reach to one behind.
#[derive(Clone, Debug)]
pub(super) struct Direction {
    products: [f32; 3],
    taps: Vec<Tap>,
}

/// Polynomials of the Gaussian around each whole pixel of a line.
pub(super) type Kernel = Vec<[f32; 4]>;

#[derive(Clone, Debug, Default)]
pub(super) struct Work {
    /// Strengths around a tile.
    strengths: Vec<f32>,
    /// Strengths at each tap of each value of a tile.
    samples: Vec<Values>,
}

/// What all tiles have in common.
#[derive(Clone, Debug)]
pub(super) struct Rule {
    /// Pixels along a line to either side in which edges count.
    pub(super) reach: usize,
    pub(super) kernel: Kernel,
    /// Least strength of an edge.
    pub(super) least: f32,
    /// Of the sum of the edges' Gaussians, in the likelihood of a line.
    pub(super) gain: f32,
}

impl Work {
    /// The values of lines of one direction around the places from the pixel `corner` on; none where no edge is near.
    pub(super) fn make(
        &mut self,
        gradients: &GradientPicture,
        direction: &Direction,
        rule: &Rule,
        corner: [i32; 2],
    ) -> Option<Values> {
        let halo = rule.reach + 2;
        // Whole registers a row.
        let size = [(TILE[0] + 2 * halo).next_multiple_of(8), TILE[1] + 2 * halo];
        let from = corner.map(|place| place - halo as i32);
        let least = rule.least;
        if gradients.strongest_within(from, size) < least * least {
            return None;
        }
        let Self { strengths, samples } = self;
        strengths.resize(size[0] * size[1], 0.0);
        let strongest = gradients.strengths(from, size, direction.products, strengths);
        if strongest < least {
            return None;
        }
        samples.resize(direction.taps.len(), [0.0; VALUES]);
        sample(strengths, size[0], halo, &direction.taps, samples);
        let mut tile = [0.0; VALUES];
        add_edges(samples, &rule.kernel, least, &mut tile);
        logarithms(rule.gain, &mut tile);
        Some(tile)
    }
}

impl Direction {
    pub(super) fn new([nx, ny]: [f64; 2], reach: usize) -> Self {
        let end = reach as i32 + 1;
        let taps = (-end..=end).map(|step| {
            let (x, y) = (f64::from(step) * nx, f64::from(step) * ny);
            let (part_x, part_y) = (x - x.floor(), y - y.floor());
            Tap {
                column: x.floor() as i32,
                row: y.floor() as i32,
                weights: [
                    (1.0 - part_x) * (1.0 - part_y),
                    part_x * (1.0 - part_y),
                    (1.0 - part_x) * part_y,
                    part_x * part_y,
                ]
                .map(|weight| weight as f32),
            }
        });
        Self {
            products: [nx * nx, 2.0 * nx * ny, ny * ny].map(|product| product as f32),
            taps: taps.collect(),
        }
    }
}

/// Taylor polynomials of `exp(-(step + shift)^2 / (2 sigma^2))` in the shift, for each step of a line.
pub(super) fn kernel(deviation: f32, reach: usize) -> Kernel {
    let deviation = f64::from(deviation);
    let reach = reach as i32;
    (-reach..=reach)
        .map(|step| {
            // Hermite's polynomials, over factorials.
            let t = f64::from(step) / deviation;
            let height = (-0.5 * t * t).exp();
            [
                height,
                -height * t / deviation,
                height * (t * t - 1.0) / (2.0 * deviation.powi(2)),
                -height * (t * t * t - 3.0 * t) / (6.0 * deviation.powi(3)),
            ]
            .map(|coefficient| coefficient as f32)
        })
        .collect()
}

/// Interpolates the strengths around a tile at every tap of each of its values.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn sample(strengths: &[f32], width: usize, halo: usize, taps: &[Tap], samples: &mut [Values]) {
    const NEEDED: usize = TILE[0] + 1;
    for (tap, values) in taps.iter().zip(samples) {
        let [a, b, c, d] = tap.weights;
        let first = (halo as i32 + tap.row) as usize * width + (halo as i32 + tap.column) as usize;
        let (rows, _) = values.as_chunks_mut::<{ TILE[0] }>();
        for (row, values) in rows.iter_mut().enumerate() {
            let at = first + row * width;
            let (Some(above), Some(below)) = (
                strengths.get(at..).and_then(|row| row.first_chunk::<NEEDED>()),
                strengths
                    .get(at + width..)
                    .and_then(|row| row.first_chunk::<NEEDED>()),
            ) else {
                continue;
            };
            for (i, value) in values.iter_mut().enumerate() {
                *value = (a * above[i] + b * above[i + 1]) + (c * below[i] + d * below[i + 1]);
            }
        }
    }
}

/// Adds to each value the Gaussians of the distances of all edges on its line: of the places of its samples that are
/// stronger than both neighbours, refined by the parabola through the three.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn add_edges(samples: &[Values], kernel: &[[f32; 4]], least: f32, tile: &mut Values) {
    for (three, [c0, c1, c2, c3]) in samples.windows(3).zip(kernel) {
        let [before, here, after] = three else { continue };
        for i in 0..VALUES {
            let (a, b, c) = (before[i], here[i], after[i]);
            let bend = (a - b) + (c - b);
            let shift = 0.5 * (a - c) / bend;
            let near = c0 + shift * (c1 + shift * (c2 + shift * c3));
            let is_edge = (b > a) & (b >= c) & (b >= least);
            tile[i] += if is_edge { near } else { 0.0 };
        }
    }
}

/// Replaces each sum s by `ln(1 + gain s)`, within 1e-6.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn logarithms(gain: f32, tile: &mut Values) {
    for value in tile.iter_mut() {
        let ratio = 1.0 + gain * *value;
        // Mantissa in [sqrt(1/2), sqrt(2)): ln m = 2 artanh((m - 1) / (m + 1)).
        let offset = ratio.to_bits().wrapping_sub(0x3F35_04F3);
        let exponent = (offset as i32) >> 23;
        let mantissa = f32::from_bits(ratio.to_bits().wrapping_sub((exponent as u32) << 23));
        let part = (mantissa - 1.0) / (mantissa + 1.0);
        let square = part * part;
        let series = 2.0 + square * (2.0 / 3.0 + square * (2.0 / 5.0 + square * (2.0 / 7.0)));
        *value = exponent as f32 * std::f32::consts::LN_2 + part * series;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polynomials_follow_the_gaussian() {
        for deviation in [1.5_f32, 2.0, 5.0] {
            let reach = (2.5 * deviation).ceil() as usize;
            for (step, [c0, c1, c2, c3]) in kernel(deviation, reach).into_iter().enumerate() {
                for shift in [-0.5_f32, -0.3, 0.0, 0.25, 0.5] {
                    let distance = step as f32 - reach as f32 + shift;
                    let expected = (-0.5 * (distance / deviation).powi(2)).exp();
                    let found = c0 + shift * (c1 + shift * (c2 + shift * c3));
                    assert!(
                        (found - expected).abs() < 2e-3,
                        "{deviation} {distance}: {found} {expected}"
                    );
                }
            }
        }
        let mut values: Values = std::array::from_fn(|i| i as f32 * 0.07);
        let expected = values.map(|value| (1.0 + 39.9 * value).ln());
        logarithms(39.9, &mut values);
        for (value, expected) in values.iter().zip(expected) {
            assert!((value - expected).abs() < 2e-6, "{value} {expected}");
        }
    }
}
