//! A grey picture at another size, exactly as OpenCV's `INTER_LINEAR_EXACT` does: bilinear, coefficients in 1/256, no rounding
//! before the end. As nothing is rounded on the way, rows may be mixed before columns, which vectorizes.

use hearsight_core::GrayView;
use multiversion::multiversion;

/// A place between two neighbours: the first one's index and the second one's share in 1/256.
#[derive(Clone, Copy, Debug)]
struct Between {
    first: u32,
    share: u32,
}

/// Makes pictures smaller or larger, with the buffers that takes.
#[derive(Clone, Debug, Default)]
pub struct Resizer {
    columns: Vec<Between>,
    rows: Vec<Between>,
    mixed: Vec<u16>,
}

/// Which pixels of the resized picture are wanted along one side.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    /// Pixels of the resized picture in all.
    pub whole: usize,
    /// The first one wanted, which may lie between two or outside.
    pub start: f64,
    /// How many are wanted.
    pub count: usize,
    /// Whether the picture counts as turned end to end.
    pub turned: bool,
}

impl Resizer {
    /// Writes `picture` at the size `width x height` into `out`, if wanted turned left to right.
    pub fn resize(
        &mut self,
        picture: GrayView<'_>,
        width: usize,
        height: usize,
        turned: bool,
        out: &mut Vec<u8>,
    ) {
        if (width, height, turned) == (picture.width, picture.height, false) {
            out.clear();
            out.extend_from_slice(picture.data);
        } else {
            let across = Range {
                whole: width,
                start: 0.0,
                count: width,
                turned,
            };
            let down = Range {
                whole: height,
                start: 0.0,
                count: height,
                turned: false,
            };
            self.resize_part(picture, across, down, out);
        }
    }

    /// Writes a part of the resized picture into `out`; outside, the border's pixels are repeated. Nothing is written
    /// where either size is zero.
    pub fn resize_part(&mut self, picture: GrayView<'_>, across: Range, down: Range, out: &mut Vec<u8>) {
        out.clear();
        out.resize(across.count * down.count, 0);
        if out.is_empty() || picture.data.is_empty() {
            return;
        }
        places(picture.width, across, &mut self.columns);
        places(picture.height, down, &mut self.rows);
        let (Some(&left), Some(&last)) = (self.columns.first(), self.columns.last()) else {
            return;
        };
        let (left, last) = (left.first.min(last.first), left.first.max(last.first));
        // Up to the last one's second neighbour.
        let used = left as usize..(last as usize + 2).min(picture.width);
        self.mixed.resize(picture.width + 1, 0);
        let mixed = &mut self.mixed[used.start..];
        for (place, out) in self.rows.iter().zip(out.chunks_exact_mut(across.count)) {
            let first = place.first as usize;
            let second = (first + 1).min(picture.height - 1);
            let rows = [first, second].map(|row| &picture.row(row)[used.clone()]);
            mix_rows(rows[0], rows[1], place.share as u16, mixed);
            mix_columns(mixed, left, &self.columns, out);
        }
    }
}

/// Where the centres of the pixels of `range` fall among those of `from`, in OpenCV's arithmetic.
fn places(from: usize, range: Range, places: &mut Vec<Between>) {
    let scale = 1.0 / (range.whole as f64 / from as f64);
    places.clear();
    places.extend((0..range.count).map(|at| {
        let position = scale * (range.start + at as f64 + 0.5) - 0.5;
        let first = position.floor();
        let last = (from - 1) as u32;
        let (first, share) = if first < 0.0 {
            (0, 0)
        } else if first < f64::from(last) {
            (
                first as u32,
                ((position - first) * 256.0).round_ties_even() as u32,
            )
        } else {
            (last, 0)
        };
        match (range.turned, share) {
            (false, _) => Between { first, share },
            (true, 0) => Between {
                first: last - first,
                share,
            },
            // Between the same two, seen from the other side.
            (true, _) => Between {
                first: last - first - 1,
                share: 256 - share,
            },
        }
    }));
}

#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn mix_rows(first: &[u8], second: &[u8], share: u16, mixed: &mut [u16]) {
    for ((mixed, &a), &b) in mixed.iter_mut().zip(first).zip(second) {
        *mixed = (256 - share) * u16::from(a) + share * u16::from(b);
    }
}

/// `mixed` starts at column `start`.
fn mix_columns(mixed: &[u16], start: u32, columns: &[Between], out: &mut [u8]) {
    for (place, out) in columns.iter().zip(out) {
        let first = (place.first - start) as usize;
        let Some(&[a, b]) = mixed.get(first..).and_then(|rest| rest.first_chunk()) else {
            return;
        };
        let sum = (256 - place.share) * u32::from(a) + place.share * u32::from(b);
        *out = ((sum + (1 << 15)) >> 16) as u8;
    }
}

#[cfg(test)]
mod tests;
