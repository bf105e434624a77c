//! Gradients of all colour channels together, found once a picture.
//!
//! Each pixel has the sums over the channels of the products of both derivatives (Di Zenzo 1986). From them the
//! strength of an edge across any direction follows without looking at the channels again, and an edge between two
//! colours of equal brightness counts like any other.

use hearsight_core::RgbView;
use multiversion::multiversion;

/// The gradients of a picture, (grey levels a pixel)^2.
#[derive(Clone, Debug, Default)]
pub struct GradientPicture {
    width: usize,
    height: usize,
    /// Sums over the channels of the products of both derivatives.
    xx: Vec<f32>,
    xy: Vec<f32>,
    yy: Vec<f32>,
    /// The greatest squared strength in any direction, at most, in each block of [`BLOCK`] by [`BLOCK`] pixels.
    blocks: Vec<f32>,
    rows: Rows,
}

/// Products along one row, channels interleaved.
#[derive(Clone, Debug, Default)]
struct Rows {
    xx: Vec<i32>,
    xy: Vec<i32>,
    yy: Vec<i32>,
}

/// Pixels of a block each way.
const BLOCK: usize = 8;

/// Sobel's operator weighs eight differences of neighbours.
const SCALE: f32 = 1.0 / 64.0;

impl GradientPicture {
    /// Takes a picture in; to be called once a picture. The outermost pixels have no gradient.
    pub fn compute(&mut self, picture: RgbView<'_>) {
        let (width, height) = (picture.width, picture.height);
        if (width, height) != (self.width, self.height) {
            (self.width, self.height) = (width, height);
            for plane in [&mut self.xx, &mut self.xy, &mut self.yy] {
                plane.clear();
                plane.resize(width * height, 0.0);
            }
            self.blocks
                .resize(width.div_ceil(BLOCK) * height.div_ceil(BLOCK), 0.0);
            for row in [&mut self.rows.xx, &mut self.rows.xy, &mut self.rows.yy] {
                row.clear();
                row.resize(3 * width, 0);
            }
        }
        if width < 3 || height < 3 {
            return;
        }
        self.blocks.fill(0.0);
        let across = width.div_ceil(BLOCK);
        for y in 1..height - 1 {
            let rows = [picture.row(y - 1), picture.row(y), picture.row(y + 1)];
            multiply(rows, &mut self.rows.xx, &mut self.rows.xy, &mut self.rows.yy);
            let inner = y * width + 1..(y + 1) * width - 1;
            gather(&self.rows.xx[3..], &mut self.xx[inner.clone()]);
            gather(&self.rows.xy[3..], &mut self.xy[inner.clone()]);
            gather(&self.rows.yy[3..], &mut self.yy[inner]);
            let row = y * width..(y + 1) * width;
            let blocks = &mut self.blocks[y / BLOCK * across..][..across];
            greatest_traces(&self.xx[row.clone()], &self.yy[row], blocks);
        }
    }

    /// Size of the picture, (width, height).
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Squared strength of an edge across `direction` (unit length), (grey levels a pixel)^2, at a place between the
    /// pixels; places count from the picture's corner, so that the first pixel's centre is at (0.5, 0.5). 0 outside.
    #[inline]
    pub fn squared_strength(&self, x: f32, y: f32, direction: [f32; 2]) -> f32 {
        let [nx, ny] = direction;
        self.weighted(x, y, [nx * nx, 2.0 * nx * ny, ny * ny])
    }

    /// At least the greatest squared strength in any direction of `size` pixels from the pixel `from` on; 0 outside.
    pub(super) fn strongest_within(&self, from: [i32; 2], size: [usize; 2]) -> f32 {
        let blocks = |from: i32, size: usize, limit: usize| {
            let end = (from + size as i32).clamp(0, limit as i32) as usize;
            from.max(0) as usize / BLOCK..end.div_ceil(BLOCK)
        };
        let columns = blocks(from[0], size[0], self.width);
        let across = self.width.div_ceil(BLOCK);
        blocks(from[1], size[1], self.height)
            .filter_map(|row| self.blocks.get(row * across..)?.get(columns.clone()))
            .flatten()
            .fold(0.0, |most, value| if *value > most { *value } else { most })
    }

    /// Writes the strengths across one direction, given by its products as below, of `size` pixels from the pixel `from`
    /// on into `out`, row by row, 0 outside the picture; returns the greatest.
    pub(super) fn strengths(
        &self,
        from: [i32; 2],
        [columns, rows]: [usize; 2],
        products: [f32; 3],
        out: &mut [f32],
    ) -> f32 {
        out.fill(0.0);
        let [left, top] = from;
        let first = left.max(0) as usize;
        let end = (left + columns as i32).clamp(0, self.width as i32) as usize;
        let mut strongest = 0.0;
        if first >= end {
            return strongest;
        }
        for (row, out) in out.chunks_exact_mut(columns).take(rows).enumerate() {
            let y = top + row as i32;
            if y < 0 || y >= self.height as i32 {
                continue;
            }
            let range = y as usize * self.width + first..y as usize * self.width + end;
            let begin = (first as i32 - left) as usize;
            let planes = [&self.xx, &self.xy, &self.yy].map(|plane| &plane[range.clone()]);
            strongest = strengths_of(planes, products, strongest, &mut out[begin..begin + range.len()]);
        }
        strongest
    }

    /// As [`Self::squared_strength`], by the products of the direction that are the same along a line.
    #[inline(always)]
    pub(super) fn weighted(&self, x: f32, y: f32, products: [f32; 3]) -> f32 {
        let (x, y) = (x - 0.5, y - 0.5);
        // Not a number is outside as well.
        let inside = x >= 0.0 && y >= 0.0 && x < (self.width as f32 - 1.0) && y < (self.height as f32 - 1.0);
        if !inside {
            return 0.0;
        }
        let (column, row) = (x as usize, y as usize);
        let (part_x, part_y) = (x - column as f32, y - row as f32);
        let at = row * self.width + column;
        // Both derivatives' products at a pixel and its right neighbour, weighted.
        let pair = |at: usize| {
            let two = |plane: &[f32]| {
                plane
                    .get(at..at + 2)
                    .and_then(|pair| pair.first_chunk::<2>().copied())
            };
            let (xx, xy, yy) = (two(&self.xx)?, two(&self.xy)?, two(&self.yy)?);
            let dot = |i: usize| xx[i] * products[0] + xy[i] * products[1] + yy[i] * products[2];
            Some([dot(0), dot(1)])
        };
        let (Some([above, right_above]), Some([below, right_below])) = (pair(at), pair(at + self.width))
        else {
            return 0.0;
        };
        let upper = above + part_x * (right_above - above);
        let lower = below + part_x * (right_below - below);
        upper + part_y * (lower - upper)
    }
}

/// Raises each block of a row of pixels to the greatest sum of both squared derivatives in it: no direction has more.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn greatest_traces(xx: &[f32], yy: &[f32], blocks: &mut [f32]) {
    for ((block, xx), yy) in blocks.iter_mut().zip(xx.chunks(BLOCK)).zip(yy.chunks(BLOCK)) {
        for (xx, yy) in xx.iter().zip(yy) {
            let trace = xx + yy;
            *block = if trace > *block { trace } else { *block };
        }
    }
}

/// Strengths across one direction of a row of pixels; returns the greatest of these and `strongest`.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn strengths_of([xx, xy, yy]: [&[f32]; 3], [a, b, c]: [f32; 3], strongest: f32, out: &mut [f32]) -> f32 {
    const LANES: usize = 8;
    let greater = |a: f32, b: f32| if a > b { a } else { b };
    for (((out, xx), xy), yy) in out.iter_mut().zip(xx).zip(xy).zip(yy) {
        *out = greater(xx * a + xy * b + yy * c, 0.0).sqrt();
    }
    let (lanes, rest) = out.as_chunks::<LANES>();
    let mut most = [strongest; LANES];
    for values in lanes {
        for i in 0..LANES {
            most[i] = greater(values[i], most[i]);
        }
    }
    for value in rest {
        most[0] = greater(*value, most[0]);
    }
    most.into_iter().fold(strongest, greater)
}

/// Products of the derivatives of every channel of a row, by Sobel's operator; the ends stay as they are.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn multiply([above, here, below]: [&[u8]; 3], xx: &mut [i32], xy: &mut [i32], yy: &mut [i32]) {
    let length = here.len();
    let inner = 3..length - 3;
    let (xx, xy, yy) = (&mut xx[inner.clone()], &mut xy[inner.clone()], &mut yy[inner]);
    let size = length - 6;
    let (above_left, above_here, above_right) = (&above[..size], &above[3..3 + size], &above[6..6 + size]);
    let (left, right) = (&here[..size], &here[6..6 + size]);
    let (below_left, below_here, below_right) = (&below[..size], &below[3..3 + size], &below[6..6 + size]);
    for i in 0..size {
        let value = |byte: u8| i32::from(byte);
        let dx = (value(above_right[i]) - value(above_left[i]))
            + 2 * (value(right[i]) - value(left[i]))
            + (value(below_right[i]) - value(below_left[i]));
        let dy = (value(below_left[i]) - value(above_left[i]))
            + 2 * (value(below_here[i]) - value(above_here[i]))
            + (value(below_right[i]) - value(above_right[i]));
        xx[i] = dx * dx;
        xy[i] = dx * dy;
        yy[i] = dy * dy;
    }
}

/// Sums over the three channels of each pixel.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn gather(products: &[i32], out: &mut [f32]) {
    let (products, _) = products.as_chunks::<3>();
    for (value, [red, green, blue]) in out.iter_mut().zip(products) {
        *value = (red + green + blue) as f32 * SCALE;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: usize, height: usize, of: impl Fn(usize, usize) -> [u8; 3]) -> GradientPicture {
        let data: Vec<u8> = (0..width * height)
            .flat_map(|i| of(i % width, i / width))
            .collect();
        let mut gradients = GradientPicture::default();
        gradients.compute(RgbView::new(width, height, &data).unwrap());
        gradients
    }

    #[test]
    fn a_slope_has_its_steepness_in_every_direction() {
        // Three and four grey levels a pixel along x and y, in one channel only.
        let gradients = picture(20, 16, |x, y| [0, (3 * x + 4 * y) as u8, 90]);
        for (direction, expected) in [
            ([1.0, 0.0], 9.0),
            ([0.0, 1.0], 16.0),
            ([0.6, 0.8], 25.0),
            ([0.8, -0.6], 0.0),
        ] {
            let found = gradients.squared_strength(9.3, 7.8, direction);
            assert!((found - expected).abs() < 1e-3, "{direction:?}: {found}");
        }
    }

    #[test]
    fn channels_add_up_even_where_brightness_does_not_change() {
        let gradients = picture(12, 12, |x, _| [(8 * x) as u8, (96 - 8 * x) as u8, 0]);
        assert!((gradients.squared_strength(6.0, 6.0, [1.0, 0.0]) - 128.0).abs() < 1e-3);
    }

    #[test]
    fn no_direction_is_stronger_than_its_block() {
        let gradients = picture(30, 20, |x, y| {
            [(x * y) as u8, (7 * x) as u8, if y > 12 { 200 } else { 0 }]
        });
        for (from, size) in [
            ([0, 0], [8, 8]),
            ([3, 5], [20, 9]),
            ([-5, 11], [60, 30]),
            ([25, 14], [4, 3]),
        ] {
            let most = gradients.strongest_within(from, size);
            let mut out = vec![0.0; size[0] * size[1]];
            for direction in [[1.0, 0.0], [0.0, 1.0], [0.6, 0.8], [0.8, -0.6]] {
                let [x, y]: [f32; 2] = direction;
                let strongest = gradients.strengths(from, size, [x * x, 2.0 * x * y, y * y], &mut out);
                assert!(
                    strongest > 0.0 && strongest * strongest <= 1.001 * most,
                    "{strongest} {most}"
                );
                assert_eq!(out.iter().copied().fold(0.0, f32::max), strongest);
            }
        }
        assert_eq!(gradients.strongest_within([-50, 3], [20, 20]), 0.0);
        assert_eq!(gradients.strongest_within([3, 40], [20, 20]), 0.0);
    }

    #[test]
    fn outside_is_nothing_and_small_pictures_have_no_gradient() {
        let gradients = picture(8, 8, |x, _| [(20 * x) as u8; 3]);
        for (x, y) in [
            (-1.0, 4.0),
            (4.0, 9.0),
            (f32::NAN, 4.0),
            (f32::INFINITY, 4.0),
            (8.0, 8.0),
        ] {
            assert_eq!(gradients.squared_strength(x, y, [1.0, 0.0]), 0.0);
        }
        assert_eq!(
            picture(2, 2, |_, _| [0; 3]).squared_strength(1.0, 1.0, [1.0, 0.0]),
            0.0
        );
        assert_eq!(
            GradientPicture::default().squared_strength(0.5, 0.5, [1.0, 0.0]),
            0.0
        );
    }
}
