//! Binary pictures packed 64 pixels to a word, with room at both sides of each row: medians and dilations of whole
//! words at once. Private; the public form is a [`hearsight_core::Mask`].

use multiversion::multiversion;

/// Words worked on together.
const LANES: usize = 4;
type Lane = [u64; LANES];

/// Rows of bits. Pixel x of a row is bit x % 64 of its word 1 + x / 64; word 0 and the words after the last pixel are
/// the border, whose content the operations choose.
#[derive(Clone, Debug, Default)]
pub(crate) struct BitRows {
    width: usize,
    height: usize,
    groups: usize,
    data: Vec<u64>,
}

/// Which value pixels outside the picture have.
#[derive(Clone, Copy)]
enum Border {
    Off,
    Nearest,
}

impl BitRows {
    pub(crate) fn resize(&mut self, width: usize, height: usize) {
        self.width = width;
        self.height = height;
        self.groups = width.div_ceil(64).div_ceil(LANES);
        self.data.clear();
        self.data.resize(self.stride() * height, 0);
    }

    /// Words a row: the groups, one word before and one after.
    fn stride(&self) -> usize {
        self.groups * LANES + 2
    }

    pub(crate) fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The words of row `y` that hold pixels.
    pub(crate) fn row_mut(&mut self, y: usize) -> &mut [u64] {
        let start = y * self.stride() + 1;
        let words = self.width.div_ceil(64);
        &mut self.data[start..start + words]
    }

    fn fill_border(&mut self, border: Border) {
        if self.width == 0 {
            return;
        }
        let last = self.width - 1;
        let stride = self.stride();
        for row in self.data.chunks_exact_mut(stride) {
            let word = |x: usize| 1 + x / 64;
            let (before, after) = match border {
                Border::Off => (0, 0),
                Border::Nearest => (
                    0_u64.wrapping_sub(row[word(0)] & 1),
                    0_u64.wrapping_sub(row[word(last)] >> (last % 64) & 1),
                ),
            };
            row[0] = before;
            let used = u64::MAX >> (63 - last % 64);
            let end = &mut row[word(last)];
            *end = (*end & used) | (after & !used);
            row[word(last) + 1..].fill(after);
        }
    }

    /// Packs bytes, of which bit 7 counts.
    pub(crate) fn pack(&mut self, width: usize, height: usize, bytes: &[u8]) {
        self.resize(width, height);
        if width == 0 {
            return;
        }
        for (y, row) in bytes.chunks_exact(width).enumerate() {
            pack_row(row, self.row_mut(y));
        }
    }

    /// Unpacks to bytes, 0 or 255.
    pub(crate) fn unpack(&self, bytes: &mut [u8]) {
        if self.width == 0 {
            return;
        }
        let stride = self.stride();
        for (row, words) in bytes
            .chunks_exact_mut(self.width)
            .zip(self.data.chunks_exact(stride))
        {
            for (pixels, &word) in row.chunks_mut(64).zip(&words[1..]) {
                let (whole, rest) = pixels.as_chunks_mut::<8>();
                for (i, group) in whole.iter_mut().enumerate() {
                    *group = SPREAD[usize::from((word >> (8 * i)) as u8)].to_le_bytes();
                }
                let done = whole.len() * 8;
                for (i, pixel) in rest.iter_mut().enumerate() {
                    *pixel = if word >> (done + i) & 1 == 1 { 255 } else { 0 };
                }
            }
        }
    }
}

/// Eight bits as eight bytes of 0 or 255, the lowest bit first.
static SPREAD: [u64; 256] = {
    let mut table = [0; 256];
    let mut value = 0;
    while value < 256 {
        let mut bit = 0;
        while bit < 8 {
            if value >> bit & 1 == 1 {
                table[value] |= 0xff << (8 * bit);
            }
            bit += 1;
        }
        value += 1;
    }
    table
};

/// Packs the highest bit of each byte into `words`, 64 to a word; bits after the last pixel are zero.
pub(crate) fn pack_row(bytes: &[u8], words: &mut [u64]) {
    for (pixels, word) in bytes.chunks(64).zip(words) {
        let (whole, rest) = pixels.as_chunks::<8>();
        let mut packed = 0;
        for (i, &group) in whole.iter().enumerate() {
            // Each byte's flag moves to its place in the highest byte of the product.
            let flags = u64::from_le_bytes(group) >> 7 & 0x0101_0101_0101_0101;
            packed |= (flags.wrapping_mul(0x0102_0408_1020_4080) >> 56) << (8 * i);
        }
        let done = whole.len() * 8;
        for (i, &pixel) in rest.iter().enumerate() {
            packed |= u64::from(pixel >> 7) << (done + i);
        }
        *word = packed;
    }
}

/// The four words whose bit x is bit x + `by` of the row; `at` is the index of the first word, |by| < 64.
#[inline(always)]
fn shifted(row: &[u64], at: usize, by: i32) -> Lane {
    let mut out = [0; LANES];
    if by == 0 {
        out.copy_from_slice(&row[at..at + LANES]);
    } else if by > 0 {
        let (near, far) = (&row[at..at + LANES], &row[at + 1..at + 1 + LANES]);
        for i in 0..LANES {
            out[i] = near[i] >> by | far[i] << (64 - by);
        }
    } else {
        let (near, far) = (&row[at..at + LANES], &row[at - 1..at - 1 + LANES]);
        for i in 0..LANES {
            out[i] = near[i] << -by | far[i] >> (64 + by);
        }
    }
    out
}

/// Adds the number in `addend` to the one in `total`, both a bit a plane.
#[inline(always)]
fn add<const TOTAL: usize, const ADDEND: usize>(total: &mut [Lane; TOTAL], addend: &[Lane; ADDEND]) {
    let mut carry = [0; LANES];
    for plane in 0..TOTAL {
        for i in 0..LANES {
            let a = total[plane][i];
            let b = if plane < ADDEND { addend[plane][i] } else { 0 };
            let half = a ^ b;
            total[plane][i] = half ^ carry[i];
            carry[i] = (a & b) | (half & carry[i]);
        }
    }
}

/// The majority over `size x size` pixels of `input`, pixels outside being those nearest to them, as OpenCV's
/// `medianBlur` of a picture of two values. `counts` is scratch. Odd sizes to 15; others count as 1: a copy.
pub(crate) fn median(size: usize, input: &mut BitRows, counts: &mut Vec<u64>, output: &mut BitRows) {
    input.fill_border(Border::Nearest);
    output.resize(input.width, input.height);
    match size {
        3 => median_rows::<2, 4>(size, input, counts, output),
        5 => median_rows::<3, 5>(size, input, counts, output),
        7 => median_rows::<3, 6>(size, input, counts, output),
        9 | 11 => median_rows::<4, 7>(size, input, counts, output),
        13 | 15 => median_rows::<4, 8>(size, input, counts, output),
        _ => output.data.copy_from_slice(&input.data),
    }
}

/// `COLUMN` planes hold counts along a row (to `size`), `TOTAL` planes those of the square (to `size^2`).
#[multiversion(targets("x86_64+avx2"))]
fn median_rows<const COLUMN: usize, const TOTAL: usize>(
    size: usize,
    input: &BitRows,
    counts: &mut Vec<u64>,
    output: &mut BitRows,
) {
    let reach = (size / 2) as i32;
    let (stride, groups, height) = (input.stride(), input.groups, input.height);
    let row_counts = groups * COLUMN * LANES;
    counts.clear();
    counts.resize(row_counts * height, 0);
    let (lanes, _) = counts.as_chunks_mut::<LANES>();
    let (cells, _) = lanes.as_chunks_mut::<COLUMN>();
    for y in 0..height {
        let row = &input.data[y * stride..(y + 1) * stride];
        for group in 0..groups {
            let mut sum = [[0; LANES]; COLUMN];
            for by in -reach..=reach {
                add(&mut sum, &[shifted(row, 1 + group * LANES, by)]);
            }
            cells[y * groups + group] = sum;
        }
    }
    let majority = (size * size).div_ceil(2);
    for y in 0..height {
        for group in 0..groups {
            let mut sum = [[0; LANES]; TOTAL];
            for dy in -reach..=reach {
                let from = (y as i32 + dy).clamp(0, height as i32 - 1) as usize;
                add(&mut sum, &cells[from * groups + group]);
            }
            let (mut above, mut equal) = ([0; LANES], [u64::MAX; LANES]);
            for plane in (0..TOTAL).rev() {
                let wanted = 0_u64.wrapping_sub((majority >> plane & 1) as u64);
                for i in 0..LANES {
                    above[i] |= equal[i] & sum[plane][i] & !wanted;
                    equal[i] &= !(sum[plane][i] ^ wanted);
                }
            }
            let at = y * stride + 1 + group * LANES;
            for i in 0..LANES {
                output.data[at + i] = above[i] | equal[i];
            }
        }
    }
}

/// One row of a structuring element: the pixels at `dy` rows and `left..=right` columns from its anchor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    pub(crate) dy: i32,
    pub(crate) left: i32,
    pub(crate) right: i32,
}

/// A pixel is on where any pixel of `input` under the element is; pixels outside are off. |left|, |right| < 64 and
/// equal spans must stand next to each other.
pub(crate) fn dilate(element: &[Span], input: &mut BitRows, spread: &mut Vec<u64>, output: &mut BitRows) {
    input.fill_border(Border::Off);
    output.resize(input.width, input.height);
    dilate_rows(element, input, spread, output);
}

#[multiversion(targets("x86_64+avx2"))]
fn dilate_rows(element: &[Span], input: &BitRows, spread: &mut Vec<u64>, output: &mut BitRows) {
    let stride = input.stride();
    spread.clear();
    spread.resize(2 * stride, 0);
    let (spread, moved) = spread.split_at_mut(stride);
    for (y, row) in input.data.chunks_exact(stride).enumerate() {
        if row.iter().all(|&word| word == 0) {
            continue;
        }
        let mut done = None;
        for span in element {
            // A pixel on in row y turns on those of row y - dy.
            let to = y as i32 - span.dy;
            if to < 0 || to >= input.height as i32 {
                continue;
            }
            if done != Some((span.left, span.right)) {
                spread_row(row, *span, spread, moved);
                done = Some((span.left, span.right));
            }
            let start = to as usize * stride;
            for (out, &word) in output.data[start..start + stride].iter_mut().zip(spread.iter()) {
                *out |= word;
            }
        }
    }
}

/// Bit x of `spread` becomes the union of bits x + left to x + right of `row`, by doubling.
#[inline(always)]
fn spread_row(row: &[u64], span: Span, spread: &mut [u64], moved: &mut [u64]) {
    let length = span.right - span.left + 1;
    spread.copy_from_slice(row);
    let mut reached = 1;
    while reached < length {
        let step = reached.min(length - reached);
        move_row(spread, step, moved);
        for (word, &other) in spread.iter_mut().zip(moved.iter()) {
            *word |= other;
        }
        reached += step;
    }
    move_row(spread, span.left, moved);
    spread.copy_from_slice(moved);
}

/// Bit x of `to` becomes bit x + `by` of `from`; off outside.
#[inline(always)]
fn move_row(from: &[u64], by: i32, to: &mut [u64]) {
    let last = from.len() - 1;
    if by == 0 {
        to.copy_from_slice(from);
    } else if by > 0 {
        for i in 0..last {
            to[i] = from[i] >> by | from[i + 1] << (64 - by);
        }
        to[last] = from[last] >> by;
    } else {
        to[0] = from[0] << -by;
        for i in 1..=last {
            to[i] = from[i] << -by | from[i - 1] >> (64 + by);
        }
    }
}
