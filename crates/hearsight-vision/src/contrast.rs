//! How much an ellipse differs from what is around it: Bhattacharyya coefficients of an object and its ring (Chen and
//! Rui, equation 21).
//!
//! Made for hundreds of ellipses on one picture; colours are binned coarsely, eight values a channel. An ellipse is given
//! by the [`Rectangle`] it touches from inside. Of ellipses near each other, as those of one person are, the counts come
//! from sums along rows that are taken once; all others are counted pixel by pixel.

mod table;

use crate::VisionError;
use hearsight_core::{Rectangle, RgbView};
use serde::{Deserialize, Serialize};
use table::{Shape, Table};

/// How an object is compared with its surroundings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ContrastOptions {
    /// Outer size of the ring over that of the ellipse, 1.05 to 4, default 1.5.
    pub ring: f32,
    /// Most pixels read of ellipse and ring together, at least 32, default 700. Of larger ones every second (third, ...)
    /// row and column is read.
    pub pixels: u32,
}

impl Default for ContrastOptions {
    fn default() -> Self {
        Self {
            ring: 1.5,
            pixels: 700,
        }
    }
}

/// Bins of all channels together.
const BINS: usize = 512;
/// Fewer ellipses than this are not worth sums along rows.
const MANY: usize = 24;
/// Size of the part that is summed up, over that of a ring: about as far as one person's hypotheses are spread.
const WINDOW: f32 = 2.0;

/// The coarse colours of a picture, and buffers.
#[derive(Clone, Debug)]
pub struct ContrastPicture {
    options: ContrastOptions,
    width: usize,
    height: usize,
    bins: Vec<u16>,
}

/// Counts of one ellipse; one for each thread.
#[derive(Clone, Debug)]
pub struct ContrastScratch {
    /// Two counts a bin of the object and two of the ring, so that neighbours of one colour need not wait for each other.
    counts: Box<[[[u16; 2]; 2]; BINS]>,
    table: Table,
    /// Ellipses that are some, with their places.
    shapes: Vec<(usize, Shape)>,
    columns: Vec<f32>,
    rows: Vec<f32>,
}

impl Default for ContrastScratch {
    fn default() -> Self {
        Self {
            counts: Box::new([[[0; 2]; 2]; BINS]),
            table: Table::default(),
            shapes: Vec::new(),
            columns: Vec::new(),
            rows: Vec::new(),
        }
    }
}

impl ContrastPicture {
    /// An empty picture.
    ///
    /// # Errors
    /// [`VisionError::Parameter`] where an option is outside its range.
    pub fn new(options: ContrastOptions) -> Result<Self, VisionError> {
        VisionError::within("ring", options.ring.into(), 1.05, 4.0, "1.05 to 4")?;
        // Counts have sixteen bits.
        VisionError::within("pixels", options.pixels.into(), 32.0, 60_000.0, "32 to 60000")?;
        Ok(Self {
            options,
            width: 0,
            height: 0,
            bins: Vec::new(),
        })
    }

    /// Takes a picture in; to be called once a picture.
    pub fn compute(&mut self, picture: RgbView<'_>) {
        (self.width, self.height) = (picture.width, picture.height);
        self.bins.resize(picture.width * picture.height, 0);
        let (pixels, _) = picture.data.as_chunks::<3>();
        for (bin, [red, green, blue]) in self.bins.iter_mut().zip(pixels) {
            *bin = (u16::from(red >> 5) << 6) | (u16::from(green >> 5) << 3) | u16::from(blue >> 5);
        }
    }

    /// Writes the coefficient of each ellipse's colours and those of its ring into `scores`: 0 nothing in common, 1 the
    /// same; 1 as well where either is not in the picture, and not a number for an ellipse that is none.
    pub fn score(&self, ellipses: &[Rectangle], scratch: &mut ContrastScratch, scores: &mut [f32]) {
        let mut shapes = std::mem::take(&mut scratch.shapes);
        shapes.clear();
        for (place, (score, bounds)) in scores.iter_mut().zip(ellipses).enumerate() {
            *score = if bounds.is_finite() { 1.0 } else { f32::NAN };
            shapes.extend(self.shape(bounds).map(|shape| (place, shape)));
        }
        shapes.sort_unstable_by_key(|(place, shape)| (shape.step, *place));
        for alike in shapes.chunk_by(|a, b| a.1.step == b.1.step) {
            let window = if alike.len() < MANY {
                None
            } else {
                self.load(alike, scratch)
            };
            for (place, shape) in alike {
                scores[*place] = match window {
                    Some(window) if is_within(shape, &window) => scratch.table.score(shape).unwrap_or(1.0),
                    _ => self.count(shape, scratch),
                };
            }
        }
        scratch.shapes = shapes;
    }

    /// An ellipse and its ring, and which pixels of it are read; none where it is none.
    fn shape(&self, bounds: &Rectangle) -> Option<Shape> {
        let (x, y) = bounds.centre();
        let inner = [0.5 * bounds.width, 0.5 * bounds.height];
        let outer = inner.map(|half| self.options.ring * half);
        let area = std::f32::consts::PI * outer[0] * outer[1];
        let whole = self.width as f32 * self.height as f32;
        let is_one = bounds.is_finite() && area.is_finite() && inner.iter().all(|half| *half > 0.0);
        is_one.then(|| Shape {
            x: x - 0.5,
            y: y - 0.5,
            inner,
            outer,
            step: ((area.min(whole) / self.options.pixels as f32).sqrt().ceil() as usize).max(1),
        })
    }

    /// Sums up what is around the middle one of ellipses of about one size; returns which part of the picture that is.
    fn load(&self, shapes: &[(usize, Shape)], scratch: &mut ContrastScratch) -> Option<Rectangle> {
        let median = |values: &mut Vec<f32>, of: &dyn Fn(&Shape) -> f32| {
            values.clear();
            values.extend(shapes.iter().map(|(_, shape)| of(shape)));
            let middle = values.len() / 2;
            *values.select_nth_unstable_by(middle, f32::total_cmp).1
        };
        let x = median(&mut scratch.columns, &|shape| shape.x);
        let y = median(&mut scratch.rows, &|shape| shape.y);
        let width = median(&mut scratch.columns, &|shape| shape.outer[0]);
        let height = median(&mut scratch.rows, &|shape| shape.outer[1]);
        let step = shapes.first()?.1.step;
        let window = Rectangle::from_centre(x, y, 2.0 * WINDOW * width, 2.0 * WINDOW * height);
        let picture = [self.width, self.height];
        scratch.table.load(&self.bins, picture, &window, step, BINS);
        Some(window)
    }

    /// Counts pixel by pixel.
    fn count(&self, shape: &Shape, scratch: &mut ContrastScratch) -> f32 {
        let Shape { x, y, step, .. } = *shape;
        let ([inner_width, inner_height], [outer_width, outer_height]) = (shape.inner, shape.outer);
        scratch.counts.fill([[0; 2]; 2]);
        let counts = &mut *scratch.counts;
        let (mut inside, mut outside) = (0_u32, 0_u32);
        let first = |from: f32| (from.ceil().max(0.0) as usize).div_ceil(step) * step;
        let end = |to: f32, limit: usize| ((to.floor() + 1.0).max(0.0) as usize).min(limit);
        let chord = |offset: f32, half_width: f32, half_height: f32| {
            let part = offset / half_height;
            half_width * (1.0 - part * part).max(0.0).sqrt()
        };
        for row in (first(y - outer_height)..end(y + outer_height, self.height)).step_by(step) {
            let offset = row as f32 - y;
            let outer = chord(offset, outer_width, outer_height);
            let (from, to) = (first(x - outer), end(x + outer, self.width));
            if from >= to {
                continue;
            }
            let (middle_from, middle_to) = if offset.abs() < inner_height {
                let inner = chord(offset, inner_width, inner_height);
                let middle_from = first(x - inner).clamp(from, to);
                (middle_from, end(x + inner, self.width).clamp(middle_from, to))
            } else {
                (to, to)
            };
            let line = &self.bins[row * self.width..(row + 1) * self.width];
            let mut add = |part: usize, range: std::ops::Range<usize>| {
                let begin = first(range.start as f32);
                let Some(pixels) = line.get(begin..range.end) else {
                    return 0;
                };
                let mut added = 0_u32;
                for (turn, bin) in pixels.iter().step_by(step).enumerate() {
                    counts[usize::from(*bin) % BINS][part][turn % 2] += 1;
                    added += 1;
                }
                added
            };
            outside += add(1, from..middle_from);
            inside += add(0, middle_from..middle_to);
            outside += add(1, middle_to..to);
        }
        if inside == 0 || outside == 0 {
            return 1.0;
        }
        let product: f32 = counts
            .iter()
            .map(|[object, ring]| {
                let object = f32::from(object[0]) + f32::from(object[1]);
                let ring = f32::from(ring[0]) + f32::from(ring[1]);
                (object * ring).sqrt()
            })
            .sum();
        (product / (inside as f32 * outside as f32).sqrt()).min(1.0)
    }
}

/// Whether an ellipse and its ring are within a part of the picture, or beside the picture where the part is.
fn is_within(shape: &Shape, window: &Rectangle) -> bool {
    shape.x - shape.outer[0] >= window.left
        && shape.x + shape.outer[0] <= window.right()
        && shape.y - shape.outer[1] >= window.top
        && shape.y + shape.outer[1] <= window.bottom()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (usize, usize) = (120, 100);

    fn picture() -> (ContrastPicture, Vec<u8>) {
        let (width, height) = SIZE;
        let data: Vec<u8> = (0..width * height)
            .flat_map(|i| {
                let (u, v) = (
                    ((i % width) as f32 - 59.5) / 15.0,
                    ((i / width) as f32 - 49.5) / 18.0,
                );
                if u * u + v * v < 1.0 {
                    [200, 150, 120]
                } else {
                    [(i % 97) as u8, 100, 90]
                }
            })
            .collect();
        let mut picture = ContrastPicture::new(ContrastOptions {
            pixels: 60_000,
            ..ContrastOptions::default()
        })
        .unwrap();
        picture.compute(RgbView::new(width, height, &data).unwrap());
        (picture, data)
    }

    /// Counts pixel by pixel.
    fn direct(data: &[u8], bounds: &Rectangle, ring: f32) -> f32 {
        let (x, y) = bounds.centre();
        let mut counts = vec![[0.0_f32; 2]; BINS];
        for (i, pixel) in data.chunks_exact(3).enumerate() {
            let u = ((i % SIZE.0) as f32 + 0.5 - x) / (0.5 * bounds.width);
            let v = ((i / SIZE.0) as f32 + 0.5 - y) / (0.5 * bounds.height);
            let radius = (u * u + v * v).sqrt();
            let bin =
                usize::from(pixel[0] / 32) * 64 + usize::from(pixel[1] / 32) * 8 + usize::from(pixel[2] / 32);
            if radius <= ring {
                counts[bin][usize::from(radius > 1.0)] += 1.0;
            }
        }
        let totals = [0, 1].map(|part| counts.iter().map(|bin| bin[part]).sum::<f32>());
        counts.iter().map(|bin| (bin[0] * bin[1]).sqrt()).sum::<f32>() / (totals[0] * totals[1]).sqrt()
    }

    #[test]
    fn coefficients_are_those_of_counting_pixels() {
        let (picture, data) = picture();
        let ellipses = [
            Rectangle::from_centre(60.0, 50.0, 30.0, 36.0),
            Rectangle::from_centre(66.0, 47.0, 30.0, 36.0),
            Rectangle::from_centre(60.2, 50.7, 41.3, 49.6),
            Rectangle::from_centre(4.0, 95.0, 30.0, 36.0),
        ];
        let mut scores = [0.0; 4];
        picture.score(&ellipses, &mut ContrastScratch::default(), &mut scores);
        for (score, bounds) in scores.iter().zip(&ellipses) {
            let expected = direct(&data, bounds, 1.5);
            assert!((score - expected).abs() < 0.01, "{score} {expected}");
        }
        assert!(
            scores[0] < 0.05 && scores[1] > scores[0] + 0.1 && scores[2] > scores[0] + 0.1,
            "{scores:?}"
        );
    }

    #[test]
    fn sums_along_rows_count_what_reading_every_pixel_counts() {
        let (_, data) = picture();
        for pixels in [60_000, 700, 150] {
            let mut picture = ContrastPicture::new(ContrastOptions {
                pixels,
                ..ContrastOptions::default()
            })
            .unwrap();
            picture.compute(RgbView::new(SIZE.0, SIZE.1, &data).unwrap());
            // Around the middle, at the picture's corner, and beside it.
            for (x, y) in [(60.0, 50.0), (4.0, 6.0), (118.0, 97.0), (-9.0, 50.0)] {
                let ellipses: Vec<Rectangle> = (0..300_u16)
                    .map(|k| {
                        let k = f32::from(k);
                        let size = 20.0 + (0.83 * k) % 8.0;
                        let (across, down) = ((1.37 * k) % 24.0 - 12.0, (2.11 * k) % 18.0 - 9.0);
                        Rectangle::from_centre(x + across, y + down, size, 1.2 * size)
                    })
                    .collect();
                let mut scratch = ContrastScratch::default();
                let mut scores = vec![0.0; ellipses.len()];
                picture.score(&ellipses, &mut scratch, &mut scores);
                for (score, bounds) in scores.iter().zip(&ellipses) {
                    let expected = picture.count(&picture.shape(bounds).unwrap(), &mut scratch);
                    assert!(
                        (score - expected).abs() < 2e-5,
                        "{pixels} {bounds:?}: {score} {expected}"
                    );
                }
                let shape = |bounds: &Rectangle| picture.shape(bounds).map(|shape| (0, shape));
                let mut shapes: Vec<_> = ellipses.iter().filter_map(shape).collect();
                let step = shapes[0].1.step;
                shapes.retain(|(_, shape)| shape.step == step);
                let window = picture.load(&shapes, &mut scratch).unwrap();
                shapes.retain(|(_, shape)| is_within(shape, &window));
                assert!(shapes.len() > 40, "{} in {window:?}", shapes.len());
                for (_, shape) in &shapes {
                    let (summed, counted) = (scratch.table.score(shape), picture.count(shape, &mut scratch));
                    assert!(
                        (summed.unwrap_or(1.0) - counted).abs() < 2e-5,
                        "{shape:?}: {summed:?} {counted}"
                    );
                }
            }
        }
    }

    #[test]
    fn reading_fewer_pixels_says_nearly_the_same() {
        let (picture, data) = picture();
        let mut coarse = ContrastPicture::new(ContrastOptions {
            pixels: 300,
            ..ContrastOptions::default()
        })
        .unwrap();
        coarse.compute(RgbView::new(SIZE.0, SIZE.1, &data).unwrap());
        let ellipses = [Rectangle::from_centre(64.0, 50.0, 30.0, 36.0)];
        let (mut all, mut few) = ([0.0], [0.0]);
        picture.score(&ellipses, &mut ContrastScratch::default(), &mut all);
        coarse.score(&ellipses, &mut ContrastScratch::default(), &mut few);
        assert!((all[0] - few[0]).abs() < 0.1, "{all:?} {few:?}");
    }

    #[test]
    fn ellipses_that_show_nothing_are_like_their_surroundings() {
        let (picture, _) = picture();
        let ellipses = [
            Rectangle::from_centre(-100.0, 50.0, 30.0, 36.0),
            Rectangle::from_centre(60.0, 50.0, 0.0, 0.0),
            Rectangle::from_centre(f32::INFINITY, 50.0, 30.0, 36.0),
            Rectangle::from_centre(60.0, 50.0, 1e9, 1e9),
        ];
        let mut scores = [0.0; 4];
        picture.score(&ellipses, &mut ContrastScratch::default(), &mut scores);
        assert_eq!((scores[0], scores[1]), (1.0, 1.0));
        assert!(scores[2].is_nan());
        assert_eq!(
            scores[3], 1.0,
            "the ring of a picture-filling ellipse is not in the picture"
        );
        assert!(
            ContrastPicture::new(ContrastOptions {
                ring: 1.0,
                ..ContrastOptions::default()
            })
            .is_err()
        );
    }
}
