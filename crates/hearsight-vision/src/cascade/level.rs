//! The tables of one scale of the picture, laid out so that neighbouring windows are neighbours in memory.

use crate::integral::{sum_rows, tilted_rows};
use hearsight_core::GrayView;

/// Windows worked on together; tables end with as many entries to spare.
pub(crate) const LANES: usize = 16;

/// Where the entry of column x is in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Layout {
    /// At x: for windows at every column.
    Every,
    /// Even columns first, then the odd ones: for windows at every second column.
    Second,
}

/// Size of the tables, the same for all scales of a picture so that one plan serves them all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Shape {
    /// Entries a row, even.
    pub(crate) stride: usize,
    /// Rows.
    pub(crate) rows: usize,
    /// Whether tilted sums follow the sums.
    pub(crate) tilted: bool,
}

impl Shape {
    /// The shape for pictures to `width x height`.
    pub(crate) fn new(width: usize, height: usize, tilted: bool) -> Self {
        Self {
            stride: (width + 2) & !1,
            rows: height + 1,
            tilted,
        }
    }

    /// Entries of one table.
    pub(crate) fn area(&self) -> usize {
        self.stride * self.rows
    }

    /// Index of the entry of column `x` and row `y`.
    pub(crate) fn at(&self, layout: Layout, x: usize, y: usize) -> usize {
        match layout {
            Layout::Every => y * self.stride + x,
            Layout::Second => y * self.stride + x % 2 * (self.stride / 2) + x / 2,
        }
    }
}

/// Sums, tilted sums and sums of squares of one scale.
#[derive(Clone, Debug, Default)]
pub(crate) struct Level {
    pub(crate) shape: Shape,
    /// Sums, then tilted sums.
    pub(crate) sums: Vec<u32>,
    /// Sums of squares modulo 2^32, exact over any window.
    pub(crate) squares: Vec<u32>,
    plain: Vec<u32>,
}

impl Level {
    /// Computes the tables of `picture`, which must not be larger than `shape`.
    pub(crate) fn compute(&mut self, picture: GrayView<'_>, shape: Shape, layout: Layout) {
        let area = shape.area();
        if self.shape != shape {
            self.shape = shape;
            let tables = if shape.tilted { 2 } else { 1 };
            for (table, size) in [
                (&mut self.sums, tables * area),
                (&mut self.squares, area),
                (&mut self.plain, area),
            ] {
                table.clear();
                table.resize(size + LANES, 0);
            }
        }
        if picture.data.is_empty() {
            return;
        }
        let (width, stride) = (picture.width, shape.stride);
        let used = stride * (picture.height + 1);
        let (sums, tilted) = self.sums.split_at_mut(area);
        let kernels: [(Kernel, &mut [u32]); 3] = [
            (sum_rows, sums),
            (square_rows, &mut self.squares),
            (tilted_rows, tilted),
        ];
        for (kernel, table) in kernels.into_iter().take(if shape.tilted { 3 } else { 2 }) {
            let out = if layout == Layout::Every {
                &mut table[..used]
            } else {
                &mut self.plain[..used]
            };
            out[..stride].fill(0);
            kernel(picture.data, width, stride, out);
            if layout == Layout::Second {
                split_columns(&self.plain[..used], stride, &mut table[..used]);
            }
        }
    }
}

type Kernel = fn(&[u8], usize, usize, &mut [u32]);

fn square_rows(pixels: &[u8], width: usize, stride: usize, table: &mut [u32]) {
    for (y, row) in pixels.chunks_exact(width).enumerate() {
        let (above, below) = table[y * stride..(y + 2) * stride].split_at_mut(stride);
        below[0] = 0;
        let mut carry = 0_u32;
        for ((&pixel, &above), below) in row.iter().zip(&above[1..]).zip(&mut below[1..]) {
            carry = carry.wrapping_add(u32::from(pixel) * u32::from(pixel));
            *below = above.wrapping_add(carry);
        }
    }
}

#[multiversion::multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn split_columns(from: &[u32], stride: usize, to: &mut [u32]) {
    for (from, to) in from.chunks_exact(stride).zip(to.chunks_exact_mut(stride)) {
        let (pairs, _) = from.as_chunks::<2>();
        let (even, odd) = to.split_at_mut(stride / 2);
        for ((pair, even), odd) in pairs.iter().zip(even).zip(odd) {
            (*even, *odd) = (pair[0], pair[1]);
        }
    }
}
