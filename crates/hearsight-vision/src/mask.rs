//! Cleaning binary masks: a median takes away single pixels, a dilation closes gaps within a person.

use crate::VisionError;
use crate::bits::{self, BitRows, Span};
use hearsight_core::Mask;
use serde::{Deserialize, Serialize};

/// Largest side of the median's square, pixels.
pub const LARGEST_MEDIAN: usize = 15;
/// Largest side of the dilation's ellipse, pixels.
pub const LARGEST_DILATION: usize = 127;

/// How much a mask is cleaned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CleanOptions {
    /// Side of the median's square, pixels: odd, 1 (off) to 15, default 5 (Bregonzio et al., section 4). Raising it
    /// takes away larger specks, and thin parts of people with them.
    pub median: usize,
    /// Width of the dilating ellipse, pixels: 1 (off) to 127, default 15 (Bregonzio et al., section 4). Raising it
    /// closes wider gaps and widens every region by as much.
    pub dilation_width: usize,
    /// Height of the dilating ellipse, pixels: 1 (off) to 127, default 5 (Bregonzio et al., section 4). Raising it
    /// closes higher gaps and heightens every region by as much.
    pub dilation_height: usize,
}

impl Default for CleanOptions {
    fn default() -> Self {
        Self {
            median: 5,
            dilation_width: 15,
            dilation_height: 5,
        }
    }
}

/// Cleans masks, with the buffers that takes.
#[derive(Clone, Debug)]
pub struct MaskCleaner {
    options: CleanOptions,
    element: Vec<Span>,
    input: BitRows,
    output: BitRows,
    scratch: Vec<u64>,
}

impl MaskCleaner {
    /// A cleaner with these options.
    ///
    /// # Errors
    /// [`VisionError::Parameter`] where a size is outside its range or the median's is even.
    pub fn new(options: CleanOptions) -> Result<Self, VisionError> {
        let sides = 1.0..=LARGEST_DILATION as f64;
        if options.median.is_multiple_of(2) || options.median > LARGEST_MEDIAN {
            return Err(VisionError::Parameter {
                name: "median",
                value: options.median as f64,
                allowed: "an odd number from 1 to 15",
            });
        }
        for (name, value) in [
            ("dilation_width", options.dilation_width),
            ("dilation_height", options.dilation_height),
        ] {
            VisionError::within(name, value as f64, *sides.start(), *sides.end(), "1 to 127")?;
        }
        Ok(Self {
            options,
            element: ellipse(options.dilation_width, options.dilation_height),
            input: BitRows::default(),
            output: BitRows::default(),
            scratch: Vec::new(),
        })
    }

    /// The options.
    pub fn options(&self) -> CleanOptions {
        self.options
    }

    /// Median, then dilation, in place.
    pub fn clean(&mut self, mask: &mut Mask) {
        self.input.pack(mask.width, mask.height, &mask.data);
        self.median_bits();
        self.dilate_bits();
        self.input.unpack(&mut mask.data);
    }

    /// Median only, in place; pixels outside the mask count as those nearest to them.
    pub fn median(&mut self, mask: &mut Mask) {
        self.input.pack(mask.width, mask.height, &mask.data);
        self.median_bits();
        self.input.unpack(&mut mask.data);
    }

    /// Dilation only, in place; pixels outside the mask count as off.
    pub fn dilate(&mut self, mask: &mut Mask) {
        self.input.pack(mask.width, mask.height, &mask.data);
        self.dilate_bits();
        self.input.unpack(&mut mask.data);
    }

    /// The packed picture that the operations below work on.
    pub(crate) fn bits_mut(&mut self) -> &mut BitRows {
        &mut self.input
    }

    pub(crate) fn median_bits(&mut self) {
        if self.options.median > 1 {
            bits::median(
                self.options.median,
                &mut self.input,
                &mut self.scratch,
                &mut self.output,
            );
            std::mem::swap(&mut self.input, &mut self.output);
        }
    }

    pub(crate) fn dilate_bits(&mut self) {
        if self.element.len() > 1 || self.options.dilation_width > 1 {
            bits::dilate(
                &self.element,
                &mut self.input,
                &mut self.scratch,
                &mut self.output,
            );
            std::mem::swap(&mut self.input, &mut self.output);
        }
    }

    /// Writes the packed picture into `mask`.
    pub(crate) fn write(&self, mask: &mut Mask) {
        let (width, height) = self.input.size();
        mask.resize(width, height);
        self.input.unpack(&mut mask.data);
    }
}

/// The rows of the ellipse that OpenCV's `getStructuringElement(MORPH_ELLIPSE, (width, height))` draws around its
/// middle pixel (width / 2, height / 2), equal spans next to each other.
fn ellipse(width: usize, height: usize) -> Vec<Span> {
    let (reach_x, reach_y) = ((width / 2) as i32, (height / 2) as i32);
    let inverse = if reach_y > 0 {
        1.0 / f64::from(reach_y * reach_y)
    } else {
        0.0
    };
    let mut spans: Vec<Span> = (0..height as i32)
        .map(|row| {
            let dy = row - reach_y;
            let chord = f64::from(reach_x) * (f64::from(reach_y * reach_y - dy * dy) * inverse).sqrt();
            let half = chord.round_ties_even() as i32;
            // An even size has no pixel at the far end.
            let right = half.min(width as i32 - 1 - reach_x);
            Span {
                dy,
                left: -half,
                right,
            }
        })
        .filter(|span| span.left <= span.right)
        .collect();
    spans.sort_by_key(|span| (span.left, span.right, span.dy));
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(width: usize, height: usize, seed: u32, share: u8) -> Mask {
        let mut state = seed;
        let mut mask = Mask::new(width, height);
        for pixel in &mut mask.data {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *pixel = if (state >> 24) as u8 <= share { 255 } else { 0 };
        }
        mask
    }

    fn slow_median(mask: &Mask, size: usize) -> Mask {
        let mut out = Mask::new(mask.width, mask.height);
        let reach = (size / 2) as i64;
        for y in 0..mask.height {
            for x in 0..mask.width {
                let mut count = 0;
                for dy in -reach..=reach {
                    for dx in -reach..=reach {
                        let from_y = (y as i64 + dy).clamp(0, mask.height as i64 - 1) as usize;
                        let from_x = (x as i64 + dx).clamp(0, mask.width as i64 - 1) as usize;
                        count += usize::from(mask.data[from_y * mask.width + from_x] > 0);
                    }
                }
                out.data[y * mask.width + x] = if count * 2 > size * size { 255 } else { 0 };
            }
        }
        out
    }

    fn slow_dilation(mask: &Mask, width: usize, height: usize) -> Mask {
        let mut out = Mask::new(mask.width, mask.height);
        for span in ellipse(width, height) {
            for y in 0..mask.height as i32 {
                for x in 0..mask.width as i32 {
                    for dx in span.left..=span.right {
                        let (from_x, from_y) = (x + dx, y + span.dy);
                        if from_x >= 0
                            && from_y >= 0
                            && from_x < mask.width as i32
                            && from_y < mask.height as i32
                            && mask.data[from_y as usize * mask.width + from_x as usize] > 0
                        {
                            out.data[y as usize * mask.width + x as usize] = 255;
                        }
                    }
                }
            }
        }
        out
    }

    #[test]
    fn cleaning_equals_its_definition() {
        for (width, height) in [(1, 1), (3, 2), (63, 9), (64, 9), (65, 8), (130, 11), (300, 20)] {
            for median in [1, 3, 5, 7, 9, 11, 13, 15] {
                let mut cleaner = MaskCleaner::new(CleanOptions {
                    median,
                    ..Default::default()
                })
                .unwrap();
                let mask = noise(width, height, median as u32, 128);
                let mut found = mask.clone();
                cleaner.median(&mut found);
                assert!(
                    found == slow_median(&mask, median),
                    "median {median} of {width} x {height}"
                );
            }
            for (dilation_width, dilation_height) in [(1, 1), (15, 5), (1, 7), (4, 6), (31, 2), (127, 3)] {
                let options = CleanOptions {
                    median: 1,
                    dilation_width,
                    dilation_height,
                };
                let mut cleaner = MaskCleaner::new(options).unwrap();
                let mask = noise(width, height, 5, 3);
                let mut found = mask.clone();
                cleaner.clean(&mut found);
                let expected = slow_dilation(&mask, dilation_width, dilation_height);
                assert!(
                    found == expected,
                    "dilation {dilation_width} x {dilation_height} of {width} x {height}"
                );
            }
        }
    }

    #[test]
    fn sizes_out_of_range_are_refused() {
        for (median, dilation_width, dilation_height) in [(4, 1, 1), (17, 1, 1), (1, 0, 1), (1, 1, 128)] {
            assert!(
                MaskCleaner::new(CleanOptions {
                    median,
                    dilation_width,
                    dilation_height
                })
                .is_err()
            );
        }
    }

    #[test]
    fn an_empty_mask_stays_empty() {
        let mut mask = Mask::new(0, 0);
        MaskCleaner::new(CleanOptions::default())
            .unwrap()
            .clean(&mut mask);
        assert_eq!(mask, Mask::new(0, 0));
    }
}
