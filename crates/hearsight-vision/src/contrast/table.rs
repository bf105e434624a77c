//! Counts of colours of many ellipses near each other: sums along rows are taken once, so that a row of an ellipse costs
//! as much as its four ends. The counts are those of reading every pixel.

use hearsight_core::Rectangle;
use multiversion::multiversion;

/// Bins that are counted side by side.
const LANES: usize = 32;
/// Rows whose ends are found side by side.
const ROWS: usize = 8;
const NONE: u16 = u16::MAX;
/// Sums for which there is memory from the start, at most.
const RESERVED: usize = 1 << 16;

type Sums = [u16; LANES];

/// An ellipse and its ring on a lattice: every `step`-th row and column, from the picture's first on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) inner: [f32; 2],
    pub(super) outer: [f32; 2],
    pub(super) step: usize,
}

/// Ends of so many rows in lattice columns: of the ring, of the ellipse in it, of the ring again.
type Ends = [[i32; ROWS]; 4];

/// Sums of colours along the rows of a part of a picture.
#[derive(Clone, Debug, Default)]
pub(super) struct Table {
    /// The part, lattice columns and rows: first, and how many.
    first: [usize; 2],
    size: [usize; 2],
    step: usize,
    /// Size of the picture, pixels.
    picture: [usize; 2],
    /// Which of the colours there are each bin is.
    palette: Vec<u16>,
    /// Which of the colours each place of the lattice has.
    colours: Vec<u16>,
    /// Groups of [`LANES`] colours, rows, and one column more than there are.
    sums: Vec<Sums>,
    groups: usize,
    ends: Vec<Ends>,
}

impl Table {
    /// Sums up the part of the picture in `window`.
    pub(super) fn load(
        &mut self,
        bins: &[u16],
        picture: [usize; 2],
        window: &Rectangle,
        step: usize,
        all: usize,
    ) {
        let lattice = |from: f32, limit: usize| (from.max(0.0) as usize).min(limit).div_ceil(step);
        let [width, height] = picture;
        self.first = [lattice(window.left, width), lattice(window.top, height)];
        let end = [
            lattice(window.right() + 1.0, width),
            lattice(window.bottom() + 1.0, height),
        ];
        self.size = [0, 1].map(|axis| end[axis].saturating_sub(self.first[axis]));
        (self.step, self.picture) = (step, picture);
        self.palette.clear();
        self.palette.resize(all, NONE);
        let [columns, rows] = self.size;
        let mut found = 0;
        self.colours.clear();
        self.colours.reserve(RESERVED);
        for row in 0..rows {
            let from = (row + self.first[1]) * step * width + self.first[0] * step;
            for bin in bins[from..].iter().step_by(step).take(columns) {
                let place = &mut self.palette[usize::from(*bin)];
                if *place == NONE {
                    *place = found;
                    found += 1;
                }
                self.colours.push(*place);
            }
        }
        self.groups = usize::from(found).div_ceil(LANES);
        self.sums.clear();
        self.sums.reserve(RESERVED);
        self.sums.resize(self.groups * rows * (columns + 1), [0; LANES]);
        if columns > 0 {
            sum_up(&self.colours, columns, &mut self.sums);
        }
    }

    /// The coefficient of an ellipse within the window and its ring; none where either has no pixel.
    pub(super) fn score(&mut self, shape: &Shape) -> Option<f32> {
        let [columns, rows] = self.size;
        // Rows whose centres are within the ring.
        let step = self.step as f32;
        let lowest = ((shape.y - shape.outer[1]) / step)
            .ceil()
            .max(self.first[1] as f32) as usize;
        let end = ((shape.y + shape.outer[1]) / step).floor() as i64 + 1;
        let end = (end.max(0) as usize).min(self.first[1] + rows);
        if lowest >= end {
            return None;
        }
        let count = end - lowest;
        self.ends.resize(count.div_ceil(ROWS), [[0; ROWS]; 4]);
        find_ends(
            shape,
            [
                lowest as f32,
                self.first[0] as f32,
                columns as f32,
                self.picture[0] as f32,
            ],
            &mut self.ends,
        );
        let (mut inside, mut whole) = (0, 0);
        for row in 0..count {
            let [from, middle_from, middle_to, to] = self.ends[row / ROWS].map(|ends| ends[row % ROWS]);
            whole += to - from;
            inside += middle_to - middle_from;
        }
        if inside <= 0 || whole <= inside {
            return None;
        }
        let product = add_up(
            &self.sums,
            [self.groups, rows, columns + 1],
            lowest - self.first[1],
            count,
            &self.ends,
        );
        Some((product / (inside as f32 * (whole - inside) as f32).sqrt()).min(1.0))
    }
}

/// Sums along each row of so many columns, for each group of colours; the first of each row stays 0.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn sum_up(colours: &[u16], columns: usize, sums: &mut [Sums]) {
    let each: Sums = std::array::from_fn(|lane| lane as u16);
    let rows = colours.len() / columns;
    for (group, plane) in sums.chunks_exact_mut(rows * (columns + 1)).enumerate() {
        let first = (group * LANES) as u16;
        let lines = plane.chunks_exact_mut(columns + 1);
        for (line, colours) in lines.zip(colours.chunks_exact(columns)) {
            let mut sum = [0; LANES];
            for (place, colour) in line.iter_mut().skip(1).zip(colours) {
                let own = colour.wrapping_sub(first);
                // All lanes at once: a single one would have to be written before the rest can be read.
                for i in 0..LANES {
                    sum[i] += u16::from(each[i] == own);
                }
                *place = sum;
            }
        }
    }
}

/// Finds where rows of the lattice from `lowest` on enter and leave ring and ellipse.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn find_ends(shape: &Shape, [lowest, first, columns, width]: [f32; 4], ends: &mut [Ends]) {
    let (step, inverse) = (shape.step as f32, 1.0 / shape.step as f32);
    let bound = |value: f32, low: f32, high: f32| {
        let value = if value > low { value } else { low };
        if value < high { value } else { high }
    };
    // The first lattice column at or after a whole pixel: half a pixel less, so that rounding cannot pass one.
    let lattice = |pixel: f32| {
        bound(
            ((bound(pixel, 0.0, width) - 0.5) * inverse).ceil() - first,
            0.0,
            columns,
        )
    };
    let inverse_heights = [1.0 / shape.inner[1], 1.0 / shape.outer[1]];
    for (group, ends) in ends.iter_mut().enumerate() {
        let mut row = lowest + (group * ROWS) as f32;
        let mut offsets = [0.0; ROWS];
        for offset in &mut offsets {
            *offset = row * step - shape.y;
            row += 1.0;
        }
        let [froms, middle_froms, middle_tos, tos] = ends;
        for i in 0..ROWS {
            let chord = |part: f32, half_width: f32| {
                let left = 1.0 - part * part;
                half_width * (if left > 0.0 { left } else { 0.0 }).sqrt()
            };
            let outer = chord(offsets[i] * inverse_heights[1], shape.outer[0]);
            let from = lattice((shape.x - outer).ceil());
            let to = bound(lattice((shape.x + outer).floor() + 1.0), from, columns);
            let inner = chord(offsets[i] * inverse_heights[0], shape.inner[0]);
            let crossed = offsets[i].abs() < shape.inner[1];
            let middle_from = bound(lattice((shape.x - inner).ceil()), from, to);
            let middle_to = bound(lattice((shape.x + inner).floor() + 1.0), middle_from, to);
            froms[i] = from as i32;
            middle_froms[i] = if crossed { middle_from } else { to } as i32;
            middle_tos[i] = if crossed { middle_to } else { to } as i32;
            tos[i] = to as i32;
        }
    }
}

/// The sum over all colours of the root of an ellipse's count times its ring's.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn add_up(
    sums: &[Sums],
    [groups, rows, columns]: [usize; 3],
    first: usize,
    count: usize,
    ends: &[Ends],
) -> f32 {
    let mut product = [0.0_f32; LANES];
    for group in 0..groups {
        let (mut object, mut whole) = ([0_u16; LANES], [0_u16; LANES]);
        let plane = &sums[group * rows * columns..(group + 1) * rows * columns];
        let lines = plane.chunks_exact(columns).skip(first).take(count);
        for (row, line) in lines.enumerate() {
            let ends = &ends[row / ROWS];
            let at = |end: usize| line.get(ends[end][row % ROWS] as usize);
            let (Some(a), Some(b), Some(c), Some(d)) = (at(0), at(1), at(2), at(3)) else {
                continue;
            };
            for i in 0..LANES {
                whole[i] = whole[i].wrapping_add(d[i].wrapping_sub(a[i]));
                object[i] = object[i].wrapping_add(c[i].wrapping_sub(b[i]));
            }
        }
        for i in 0..LANES {
            let ring = whole[i].wrapping_sub(object[i]);
            product[i] += (f32::from(object[i]) * f32::from(ring)).sqrt();
        }
    }
    product.iter().sum()
}
