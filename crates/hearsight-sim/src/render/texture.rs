//! Painted pictures that surfaces are covered with, at several sizes.

use super::pattern::paint;
use crate::world::{Colour, Material};

/// Texels of a cloth's texture each way.
const CLOTH_SIDE: usize = 128;
/// Repetitions of a pattern in a texture; the next ones are mirrored.
const REPETITIONS: f32 = 4.0;

/// A texture and smaller versions of it, each of half the size.
#[derive(Clone, Debug, Default)]
pub(super) struct Texture {
    levels: Vec<Level>,
    /// Texture coordinates a unit of the surface's: one over the size in metres for cloth, 1 else.
    scale: f32,
}

#[derive(Clone, Debug)]
struct Level {
    width: usize,
    height: usize,
    texels: Vec<[f32; 4]>,
}

impl Texture {
    /// One colour.
    pub(super) fn plain(colour: Colour) -> Self {
        let texels = vec![[colour[0], colour[1], colour[2], 1.0]];
        Self {
            levels: vec![Level {
                width: 1,
                height: 1,
                texels,
            }],
            scale: 1.0,
        }
    }

    /// Cloth of a material; the surface counts metres.
    pub(super) fn cloth(material: &Material) -> Self {
        let size_m = REPETITIONS
            * if material.scale_m.is_finite() {
                material.scale_m.clamp(0.01, 10.0)
            } else {
                1.0
            };
        let step = size_m / CLOTH_SIDE as f32;
        let mut cloth = Self::painted(CLOTH_SIDE, CLOTH_SIDE, |column, row| {
            paint(
                material,
                (column as f32 + 0.5) * step,
                (row as f32 + 0.5) * step,
                step,
            )
        });
        cloth.scale = 1.0 / size_m;
        cloth
    }

    /// What a function paints at each texel.
    pub(super) fn painted(width: usize, height: usize, colour: impl Fn(usize, usize) -> Colour) -> Self {
        let mut texture = Self {
            levels: Vec::new(),
            scale: 1.0,
        };
        let (mut wide, mut high) = (width, height);
        while wide >= 1 && high >= 1 {
            texture.levels.push(Level {
                width: wide,
                height: high,
                texels: vec![[0.0; 4]; wide * high],
            });
            (wide, high) = (wide / 2, high / 2);
        }
        texture.repaint([0, 0], [width, height], colour);
        texture
    }

    /// Paints a part anew, from column and row `from` to before `to`, and what smaller versions show of it.
    pub(super) fn repaint(
        &mut self,
        from: [usize; 2],
        to: [usize; 2],
        colour: impl Fn(usize, usize) -> Colour,
    ) {
        let Some(first) = self.levels.first_mut() else {
            return;
        };
        for row in from[1]..to[1].min(first.height) {
            for column in from[0]..to[0].min(first.width) {
                let [red, green, blue] = colour(column, row);
                first.texels[row * first.width + column] = [red, green, blue, 1.0];
            }
        }
        let (mut from, mut to) = (from, to);
        for number in 1..self.levels.len() {
            (from, to) = (from.map(|edge| edge / 2), to.map(|edge| edge.div_ceil(2)));
            let (finer, coarser) = self.levels.split_at_mut(number);
            let (finer, coarser) = (&finer[number - 1], &mut coarser[0]);
            for row in from[1]..to[1].min(coarser.height) {
                for column in from[0]..to[0].min(coarser.width) {
                    let texel =
                        |dx: usize, dy: usize| finer.texels[(2 * row + dy) * finer.width + 2 * column + dx];
                    let four = [texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1)];
                    coarser.texels[row * coarser.width + column] = std::array::from_fn(|channel| {
                        four.iter().map(|texel| texel[channel]).sum::<f32>() / 4.0
                    });
                }
            }
        }
    }

    /// The level whose texels are nearest to `units` of the surface, a pixel's size.
    pub(super) fn level(&self, units: f32) -> usize {
        let texels = units * self.scale * self.levels.first().map_or(1.0, |level| level.width as f32);
        let level = texels.max(1.0).log2().round() as usize;
        level.min(self.levels.len().saturating_sub(1))
    }

    /// The colour at a place of the surface, mirrored beyond the texture's edges.
    #[inline]
    pub(super) fn sample(&self, level: usize, at: [f32; 2]) -> Colour {
        let Some(level) = self.levels.get(level) else {
            return [0.0; 3];
        };
        if level.texels.len() == 1 {
            let [red, green, blue, _] = level.texels[0];
            return [red, green, blue];
        }
        let (left, right, across) = neighbours(at[0] * self.scale, level.width);
        let (top, bottom, down) = neighbours(at[1] * self.scale, level.height);
        let row = |row: usize| {
            let (a, b) = (
                level.texels[row * level.width + left],
                level.texels[row * level.width + right],
            );
            [0, 1, 2].map(|channel| a[channel] + across * (b[channel] - a[channel]))
        };
        let (upper, lower) = (row(top), row(bottom));
        [0, 1, 2].map(|channel| upper[channel] + down * (lower[channel] - upper[channel]))
    }
}

/// The texels on both sides of a coordinate and how far the second one counts.
#[inline(always)]
fn neighbours(coordinate: f32, count: usize) -> (usize, usize, f32) {
    // Mirrored at 0 as at every whole number.
    let distance = coordinate.abs();
    let whole = distance as i32;
    let part = distance - whole as f32;
    let folded = if whole & 1 == 1 { 1.0 - part } else { part };
    let place = (folded * count as f32 - 0.5).clamp(0.0, (count - 1) as f32);
    let first = place as i32;
    let index = first as usize;
    (index, (index + 1).min(count - 1), place - first as f32)
}
