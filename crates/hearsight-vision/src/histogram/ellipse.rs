//! Reading the pixels of an ellipse into bins.

use hearsight_core::Rectangle;
use multiversion::multiversion;

/// Pixels take turns among as many sums, so that one need not wait for its neighbour of the same colour.
const TURNS: usize = 4;
/// As many as there are values of a bin's number: indexing needs no check.
const SLOTS: usize = 1 << 16;
/// Pixels of a row worked on together.
const GROUP: usize = 32;

/// Sums of the kernel by bin.
#[derive(Clone, Debug, Default)]
pub(super) struct BinSums {
    slots: Vec<[f32; TURNS]>,
}

impl BinSums {
    /// Makes the sums of the first `bins` bins zero.
    pub(super) fn clear(&mut self, bins: usize) {
        self.slots.resize(SLOTS, [0.0; TURNS]);
        self.slots[..bins].fill([0.0; TURNS]);
    }

    /// Makes the sums of these bins zero.
    pub(super) fn clear_those(&mut self, bins: impl Iterator<Item = u16>) {
        self.slots.resize(SLOTS, [0.0; TURNS]);
        for bin in bins {
            self.slots[usize::from(bin)] = [0.0; TURNS];
        }
    }

    pub(super) fn of(&self, bin: u16) -> f32 {
        let [a, b, c, d] = self.slots[usize::from(bin)];
        (a + b) + (c + d)
    }
}

/// An ellipse on the grid of pixels, clipped to the picture.
pub(super) struct Ellipse {
    /// Middle in pixels, (0, 0) being the centre of the top-left pixel.
    x: f32,
    y: f32,
    half_width: f32,
    inverse_width: f32,
    inverse_height: f32,
    /// Every `step`-th row and column is read, counted from the picture's corner so that equal ellipses read equal
    /// pixels.
    step: usize,
    first_row: usize,
    end_row: usize,
    picture_width: usize,
}

impl Ellipse {
    pub(super) fn new(bounds: &Rectangle, width: usize, height: usize, step: usize) -> Self {
        let (x, y) = bounds.centre();
        // Rectangles count from the pixel's edge, not its centre.
        let (x, y) = (x - 0.5, y - 0.5);
        let (half_width, half_height) = (bounds.width / 2.0, bounds.height / 2.0);
        // Conversions of floats saturate, so what lies far outside is clipped.
        let first_row = ((y - half_height).ceil().max(0.0) as usize).div_ceil(step) * step;
        let end_row = (((y + half_height).floor() + 1.0).max(0.0) as usize).min(height);
        Self {
            x,
            y,
            half_width,
            inverse_width: 1.0 / half_width,
            inverse_height: 1.0 / half_height,
            step,
            first_row,
            end_row,
            picture_width: width,
        }
    }

    /// 1 - r^2 on the axis of row `y`, and the columns within, first and end.
    #[inline(always)]
    fn row(&self, y: usize, step: usize) -> (f32, usize, usize) {
        let offset = (y as f32 - self.y) * self.inverse_height;
        let axis = (1.0 - offset * offset).max(0.0);
        let chord = self.half_width * axis.sqrt();
        let first = ((self.x - chord).ceil().max(0.0) as usize).div_ceil(step) * step;
        let end = (((self.x + chord).floor() + 1.0).max(0.0) as usize).min(self.picture_width);
        (axis, first, end)
    }
}

/// Adds the kernel of each pixel to its bin; returns the sum of all and the number of pixels read.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
pub(super) fn add_pixels(bins: &[u16], width: usize, ellipse: &Ellipse, sums: &mut BinSums) -> (f32, usize) {
    // A step known beforehand spares the divisions by it, of which small ellipses would mostly consist.
    match ellipse.step {
        1 => add_every(bins, width, ellipse, sums, 1),
        step => add_every(bins, width, ellipse, sums, step),
    }
}

#[inline(always)]
fn add_every(bins: &[u16], width: usize, ellipse: &Ellipse, sums: &mut BinSums, step: usize) -> (f32, usize) {
    let Some(slots) = sums.slots.first_chunk_mut::<SLOTS>() else {
        return (0.0, 0);
    };
    let mut totals = [0.0; TURNS];
    let mut pixels = 0;
    for y in (ellipse.first_row..ellipse.end_row).step_by(step) {
        let (axis, first, end) = ellipse.row(y, step);
        if first >= end {
            continue;
        }
        let row = &bins[y * width + first..y * width + end];
        let mut place = first as f32 - ellipse.x;
        for group in row.chunks(GROUP * step) {
            let mut weights = [0.0; GROUP];
            for (i, weight) in weights.iter_mut().enumerate() {
                let offset = (place + (i * step) as f32) * ellipse.inverse_width;
                *weight = (axis - offset * offset).max(0.0);
            }
            place += (GROUP * step) as f32;
            let mut add = |turn: usize, bin: u16, weight: f32| {
                slots[usize::from(bin)][turn] += weight;
                totals[turn] += weight;
            };
            if step == 1 {
                let (bins, rest) = group.as_chunks::<TURNS>();
                let (weights, _) = weights.as_chunks::<TURNS>();
                for (bins, weights) in bins.iter().zip(weights) {
                    for turn in 0..TURNS {
                        add(turn, bins[turn], weights[turn]);
                    }
                }
                if let Some(weights) = weights.get(bins.len()) {
                    for (turn, (&bin, &weight)) in rest.iter().zip(weights).enumerate() {
                        add(turn, bin, weight);
                    }
                }
            } else {
                for (i, (&bin, &weight)) in group.iter().step_by(step).zip(&weights).enumerate() {
                    add(i % TURNS, bin, weight);
                }
            }
            pixels += group.len().div_ceil(step);
        }
    }
    let [a, b, c, d] = totals;
    ((a + b) + (c + d), pixels)
}
