//! Integral images: the sum over any rectangle from four reads (Viola and Jones 2001; tilted: Lienhart 2002).
//!
//! Every table has one row and one column more than the picture; entry (x, y) is the sum over all pixels above row
//! `y` and left of column `x`. Buffers are reused: computing again at the same size allocates nothing.

use hearsight_core::GrayView;
use multiversion::multiversion;

/// Sums of grey values, `(height + 1) x (width + 1)` entries, modulo 2^32.
///
/// Differences wrap, so the sum over a rectangle is exact as long as the rectangle itself has fewer than 16.8 million
/// pixels, however large the picture.
#[derive(Clone, Debug, Default)]
pub struct SumTable {
    stride: usize,
    values: Vec<u32>,
}

/// Sums of squared grey values, `(height + 1) x (width + 1)` entries, exact.
#[derive(Clone, Debug, Default)]
pub struct SquareTable {
    stride: usize,
    values: Vec<u64>,
}

/// Sums of grey values over half planes turned by 45 degrees, `(height + 1) x (width + 1)` entries, modulo 2^32.
///
/// Entry (X, Y) is the sum of picture(x, y) over y < Y, |x - X + 1| <= Y - y - 1, as OpenCV's `integral` defines it.
#[derive(Clone, Debug, Default)]
pub struct TiltedTable {
    stride: usize,
    values: Vec<u32>,
}

/// The tables that a cascade needs of one picture.
#[derive(Clone, Debug, Default)]
pub struct Integrals {
    /// Sums.
    pub sums: SumTable,
    /// Sums of squares.
    pub squares: SquareTable,
    /// Tilted sums; empty (0 x 0) where they were not asked for.
    pub tilted: TiltedTable,
}

impl Integrals {
    /// Computes sums and squares, and with `tilted` the tilted sums as well.
    pub fn compute(&mut self, picture: GrayView<'_>, tilted: bool) {
        self.sums.compute(picture);
        self.squares.compute(picture);
        if tilted {
            self.tilted.compute(picture);
        } else {
            self.tilted.stride = 0;
            self.tilted.values.clear();
        }
    }

    /// Size of the picture, (width, height).
    pub fn size(&self) -> (usize, usize) {
        size(self.sums.stride, self.sums.values.len())
    }

    /// Whether the tilted sums belong to the same picture.
    pub fn has_tilted(&self) -> bool {
        self.tilted.stride == self.sums.stride && self.tilted.values.len() == self.sums.values.len()
    }
}

fn size(stride: usize, length: usize) -> (usize, usize) {
    match length.checked_div(stride) {
        Some(rows) => (stride - 1, rows - 1),
        None => (0, 0),
    }
}

/// Resizes a table for `picture`; the first row is zero.
fn prepare<T: Copy + Default>(values: &mut Vec<T>, stride: &mut usize, picture: GrayView<'_>) {
    *stride = picture.width + 1;
    values.resize(*stride * (picture.height + 1), T::default());
    values[..*stride].fill(T::default());
}

impl SumTable {
    /// Sums of `picture`.
    pub fn compute(&mut self, picture: GrayView<'_>) {
        prepare(&mut self.values, &mut self.stride, picture);
        if picture.width > 0 {
            sum_rows(picture.data, picture.width, self.stride, &mut self.values);
        }
    }

    /// Size of the picture, (width, height).
    pub fn size(&self) -> (usize, usize) {
        size(self.stride, self.values.len())
    }

    /// Entries a row: the picture's width plus one.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// All entries, row-major.
    pub fn values(&self) -> &[u32] {
        &self.values
    }

    /// Sum over columns `left..right` and rows `top..bottom`, which must lie in the picture.
    pub fn rectangle(&self, left: usize, top: usize, right: usize, bottom: usize) -> u32 {
        let (upper, lower) = (top * self.stride, bottom * self.stride);
        self.values[lower + right]
            .wrapping_sub(self.values[lower + left])
            .wrapping_sub(self.values[upper + right])
            .wrapping_add(self.values[upper + left])
    }
}

impl SquareTable {
    /// Sums of squares of `picture`.
    pub fn compute(&mut self, picture: GrayView<'_>) {
        prepare(&mut self.values, &mut self.stride, picture);
        if picture.width > 0 {
            square_rows(picture.data, picture.width, &mut self.values);
        }
    }

    /// Size of the picture, (width, height).
    pub fn size(&self) -> (usize, usize) {
        size(self.stride, self.values.len())
    }

    /// Entries a row: the picture's width plus one.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// All entries, row-major.
    pub fn values(&self) -> &[u64] {
        &self.values
    }

    /// Sum over columns `left..right` and rows `top..bottom`, which must lie in the picture.
    pub fn rectangle(&self, left: usize, top: usize, right: usize, bottom: usize) -> u64 {
        let (upper, lower) = (top * self.stride, bottom * self.stride);
        self.values[lower + right]
            .wrapping_sub(self.values[lower + left])
            .wrapping_sub(self.values[upper + right])
            .wrapping_add(self.values[upper + left])
    }
}

impl TiltedTable {
    /// Tilted sums of `picture`.
    pub fn compute(&mut self, picture: GrayView<'_>) {
        prepare(&mut self.values, &mut self.stride, picture);
        if picture.width > 0 {
            tilted_rows(picture.data, picture.width, self.stride, &mut self.values);
        }
    }

    /// Size of the picture, (width, height).
    pub fn size(&self) -> (usize, usize) {
        size(self.stride, self.values.len())
    }

    /// Entries a row: the picture's width plus one.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// All entries, row-major.
    pub fn values(&self) -> &[u32] {
        &self.values
    }

    /// Sum over the rectangle turned by 45 degrees whose top corner is at (`x`, `y`), which goes `width` pixels down
    /// to the right and `height` pixels down to the left, all of which must lie in the picture.
    pub fn rectangle(&self, x: usize, y: usize, width: usize, height: usize) -> u32 {
        let at = |x: usize, y: usize| self.values[y * self.stride + x];
        at(x, y)
            .wrapping_sub(at(x - height, y + height))
            .wrapping_sub(at(x + width, y + width))
            .wrapping_add(at(x + width - height, y + width + height))
    }
}

/// Fills all rows but the first of a table with sums; rows are `stride` entries apart, at least `width + 1`. Running sums along a row do not vectorize by themselves, so
/// there is a form by hand where the processor allows it, three times as fast at 320 x 240.
pub(crate) fn sum_rows(pixels: &[u8], width: usize, stride: usize, table: &mut [u32]) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "calling a function compiled for AVX2")]
        // SAFETY: the processor has AVX2, as just checked.
        unsafe {
            sum_rows_avx2(pixels, width, stride, table);
        }
        return;
    }
    sum_rows_plain(pixels, width, stride, table);
}

fn sum_rows_plain(pixels: &[u8], width: usize, stride: usize, table: &mut [u32]) {
    for (y, row) in pixels.chunks_exact(width).enumerate() {
        let (above, below) = table[y * stride..(y + 2) * stride].split_at_mut(stride);
        below[0] = 0;
        sum_row(row, &above[1..=width], &mut below[1..=width], 0);
    }
}

/// Running sums of `row` starting at `carry`, added to the row above.
#[inline(always)]
fn sum_row(row: &[u8], above: &[u32], below: &mut [u32], mut carry: u32) {
    for ((&pixel, &above), below) in row.iter().zip(above).zip(below) {
        carry += u32::from(pixel);
        *below = above.wrapping_add(carry);
    }
}

/// Sixteen pixels at once: running 16-bit sums in each half by three shifted additions (below 8 * 255), widened, with
/// the carry added outside the chain of dependencies.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn sum_rows_avx2(pixels: &[u8], width: usize, stride: usize, table: &mut [u32]) {
    use crate::registers::{load_bytes, load_words, store_words};
    use std::arch::x86_64::*;
    let last = _mm256_set1_epi32(7);
    for (y, row) in pixels.chunks_exact(width).enumerate() {
        let (above, below) = table[y * stride..(y + 2) * stride].split_at_mut(stride);
        below[0] = 0;
        let (blocks, rest) = row.as_chunks::<16>();
        let (blocks_above, rest_above) = above[1..=width].as_chunks::<16>();
        let (blocks_below, rest_below) = below[1..=width].as_chunks_mut::<16>();
        let mut carry = _mm256_setzero_si256();
        for ((block, above), below) in blocks.iter().zip(blocks_above).zip(blocks_below) {
            let mut sums = _mm256_cvtepu8_epi16(load_bytes(block));
            sums = _mm256_add_epi16(sums, _mm256_slli_si256::<2>(sums));
            sums = _mm256_add_epi16(sums, _mm256_slli_si256::<4>(sums));
            sums = _mm256_add_epi16(sums, _mm256_slli_si256::<8>(sums));
            let near = _mm256_cvtepu16_epi32(_mm256_castsi256_si128(sums));
            let far = _mm256_cvtepu16_epi32(_mm256_extracti128_si256::<1>(sums));
            let middle = _mm256_add_epi32(carry, _mm256_permutevar8x32_epi32(near, last));
            let [above_near, above_far] = load_words(above);
            let near = _mm256_add_epi32(_mm256_add_epi32(near, carry), above_near);
            carry = _mm256_add_epi32(middle, _mm256_permutevar8x32_epi32(far, last));
            let far = _mm256_add_epi32(_mm256_add_epi32(far, middle), above_far);
            store_words(below, [near, far]);
        }
        sum_row(
            rest,
            rest_above,
            rest_below,
            _mm256_extract_epi32::<0>(carry) as u32,
        );
    }
}

#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn square_rows(pixels: &[u8], width: usize, table: &mut [u64]) {
    let stride = width + 1;
    for (y, row) in pixels.chunks_exact(width).enumerate() {
        let (above, below) = table[y * stride..(y + 2) * stride].split_at_mut(stride);
        below[0] = 0;
        let mut carry = 0_u64;
        for ((&pixel, &above), below) in row.iter().zip(&above[1..]).zip(&mut below[1..]) {
            carry += u64::from(pixel) * u64::from(pixel);
            *below = above.wrapping_add(carry);
        }
    }
}

/// Each entry from the two rows above it: T(x, y) = T(x-1, y-1) + T(x+1, y-1) - T(x, y-2) + p(x-1, y-1) + p(x-1, y-2).
/// At the left and right edge the entries outside follow from the definition, since all pixels outside are zero:
/// T(-1, y) = T(0, y-1) and T(width+1, y) = T(width, y-1).
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
pub(crate) fn tilted_rows(pixels: &[u8], width: usize, stride: usize, table: &mut [u32]) {
    table[stride] = 0;
    for (entry, &pixel) in table[stride + 1..=stride + width].iter_mut().zip(pixels) {
        *entry = u32::from(pixel);
    }
    let height = pixels.len() / width;
    for y in 1..height {
        let (before, rest) = table.split_at_mut((y + 1) * stride);
        let (two_above, above) = before[(y - 1) * stride..].split_at(stride);
        let row = &mut rest[..stride];
        let near = &pixels[y * width..(y + 1) * width];
        let far = &pixels[(y - 1) * width..y * width];
        row[0] = above[1];
        let inner = width - 1;
        let (left, right) = (&above[..inner], &above[2..2 + inner]);
        let (over, entries) = (&two_above[1..1 + inner], &mut row[1..1 + inner]);
        let (near_inner, far_inner) = (&near[..inner], &far[..inner]);
        for x in 0..inner {
            let fresh = u32::from(near_inner[x]) + u32::from(far_inner[x]);
            entries[x] = left[x]
                .wrapping_add(right[x])
                .wrapping_sub(over[x])
                .wrapping_add(fresh);
        }
        let last = u32::from(near[inner]) + u32::from(far[inner]);
        row[width] = above[width - 1].wrapping_add(last);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(width: usize, height: usize) -> Vec<u8> {
        let mut state = 7_u32;
        (0..width * height)
            .map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 24) as u8
            })
            .collect()
    }

    #[test]
    fn tables_agree_with_their_definitions_at_every_entry() {
        for (width, height) in [(1, 1), (1, 5), (5, 1), (2, 3), (17, 9), (33, 12)] {
            let data = noise(width, height);
            let view = GrayView::new(width, height, &data).unwrap();
            let mut tables = Integrals::default();
            tables.compute(view, true);
            assert_eq!(tables.size(), (width, height));
            assert!(tables.has_tilted());
            for bottom in 0..=height {
                for right in 0..=width {
                    let (mut sum, mut square, mut tilted) = (0, 0, 0);
                    for y in 0..bottom {
                        for x in 0..width {
                            let pixel = u32::from(view.row(y)[x]);
                            if x < right {
                                sum += pixel;
                                square += u64::from(pixel * pixel);
                            }
                            if (x as i64 - right as i64 + 1).abs() < bottom as i64 - y as i64 {
                                tilted += pixel;
                            }
                        }
                    }
                    assert_eq!(tables.sums.rectangle(0, 0, right, bottom), sum);
                    assert_eq!(tables.squares.rectangle(0, 0, right, bottom), square);
                    let at = bottom * (width + 1) + right;
                    assert_eq!(
                        tables.tilted.values()[at],
                        tilted,
                        "{width}x{height} at {right},{bottom}"
                    );
                }
            }
        }
    }

    #[test]
    fn both_forms_of_sums_agree() {
        for (width, height) in [(1, 2), (15, 3), (16, 3), (17, 3), (100, 7)] {
            let data = noise(width, height);
            let mut tables = [
                vec![0; (width + 4) * (height + 1)],
                vec![0; (width + 4) * (height + 1)],
            ];
            sum_rows(&data, width, width + 4, &mut tables[0]);
            sum_rows_plain(&data, width, width + 4, &mut tables[1]);
            assert_eq!(tables[0], tables[1], "{width} x {height}");
        }
    }

    #[test]
    fn an_empty_picture_gives_empty_tables() {
        let mut tables = Integrals::default();
        tables.compute(GrayView::new(0, 0, &[]).unwrap(), true);
        assert_eq!(tables.size(), (0, 0));
        tables.compute(GrayView::new(0, 3, &[]).unwrap(), true);
        assert_eq!(tables.size(), (0, 3));
    }
}
