//! Colour histograms inside ellipses, weighted towards the middle, and their Bhattacharyya distance.
//!
//! Made for hundreds of hypotheses on one picture: [`BinPicture`] finds the bin of every pixel once, and
//! [`BinPicture::score_ellipses`] reads each ellipse from it without allocating. An ellipse is given by the [`Rectangle`] it
//! touches from inside.

mod ellipse;

use crate::VisionError;
use ellipse::{BinSums, Ellipse, add_pixels};
use hearsight_core::{Rectangle, RgbView};
use serde::{Deserialize, Serialize};

/// How colours are divided into bins and ellipses are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HistogramOptions {
    /// Bins of the red channel, 1 to 40, default 10 (Bregonzio et al., section 3.2). Raising any of the three tells
    /// finer colours apart and notices changes of light more.
    pub red: u8,
    /// Bins of the green channel, 1 to 40, default 10.
    pub green: u8,
    /// Bins of the blue channel, 1 to 40, default 10.
    pub blue: u8,
    /// Most pixels read of an ellipse, at least 16, default 2048. Of larger ellipses every second (third, ...) row and
    /// column is read. Raising it makes large ellipses slower and their histograms smoother.
    pub pixels: u32,
}

impl Default for HistogramOptions {
    fn default() -> Self {
        Self {
            red: 10,
            green: 10,
            blue: 10,
            pixels: 2048,
        }
    }
}

impl HistogramOptions {
    /// Bins in all.
    pub fn bins(&self) -> usize {
        usize::from(self.red) * usize::from(self.green) * usize::from(self.blue)
    }

    /// # Errors
    /// [`VisionError::Parameter`] where a number is outside its range.
    pub fn validate(&self) -> Result<(), VisionError> {
        for (name, bins) in [("red", self.red), ("green", self.green), ("blue", self.blue)] {
            VisionError::within(name, f64::from(bins), 1.0, 40.0, "1 to 40")?;
        }
        VisionError::within(
            "pixels",
            f64::from(self.pixels),
            16.0,
            f64::from(u32::MAX),
            "16 or more",
        )
    }
}

/// The bin of every pixel of a picture: (red bin * green bins + green bin) * blue bins + blue bin, where the bin of a
/// channel is value * bins / 256, rounded down.
#[derive(Clone, Debug)]
pub struct BinPicture {
    options: HistogramOptions,
    tables: Box<[[u16; 256]; 3]>,
    width: usize,
    height: usize,
    bins: Vec<u16>,
}

/// A colour histogram that sums to 1, or is zero everywhere where nothing was seen.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Histogram {
    values: Vec<f32>,
}

impl Clone for Histogram {
    fn clone(&self) -> Self {
        Self {
            values: self.values.clone(),
        }
    }

    /// Keeps the memory, which a derived one would not.
    fn clone_from(&mut self, other: &Self) {
        self.values.clone_from(&other.values);
    }
}

/// What reading histograms needs besides the picture; one for each thread.
#[derive(Clone, Debug, Default)]
pub struct HistogramScratch {
    sums: BinSums,
    /// Bins in which the reference is not zero, with the roots of its values.
    roots: Vec<(u16, f32)>,
}

/// How alike an ellipse and a reference are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    /// Bhattacharyya coefficient sum(sqrt(p q)), 0 to 1.
    pub coefficient: f32,
    /// Distance sqrt(1 - coefficient), 0 (the same) to 1 (Bregonzio et al., eq. 10).
    pub distance: f32,
    /// Share of the ellipse's area inside the picture, 0 to 1. At 0 nothing was seen and the distance is 1.
    pub inside: f32,
}

impl BinPicture {
    /// An empty picture (0 x 0) with these bins.
    ///
    /// # Errors
    /// [`VisionError::Parameter`] where a number of the options is outside its range.
    pub fn new(options: HistogramOptions) -> Result<Self, VisionError> {
        options.validate()?;
        let (green, blue) = (u32::from(options.green), u32::from(options.blue));
        let steps = [
            (options.red, green * blue),
            (options.green, blue),
            (options.blue, 1),
        ];
        let mut tables = Box::new([[0; 256]; 3]);
        for (table, (bins, step)) in tables.iter_mut().zip(steps) {
            for (value, entry) in (0_u32..).zip(table.iter_mut()) {
                *entry = (value * u32::from(bins) / 256 * step) as u16;
            }
        }
        Ok(Self {
            options,
            tables,
            width: 0,
            height: 0,
            bins: Vec::new(),
        })
    }

    /// Finds the bins of all pixels of `picture`; to be called once a picture.
    pub fn compute(&mut self, picture: RgbView<'_>) {
        (self.width, self.height) = (picture.width, picture.height);
        self.bins.resize(picture.width * picture.height, 0);
        let [red, green, blue] = &*self.tables;
        let (pixels, _) = picture.data.as_chunks::<3>();
        for (bin, pixel) in self.bins.iter_mut().zip(pixels) {
            *bin = red[usize::from(pixel[0])] + green[usize::from(pixel[1])] + blue[usize::from(pixel[2])];
        }
    }

    /// The options.
    pub fn options(&self) -> HistogramOptions {
        self.options
    }

    /// Size of the picture, (width, height).
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The bins, row-major, each below [`HistogramOptions::bins`].
    pub fn bins(&self) -> &[u16] {
        &self.bins
    }

    /// The histogram inside the ellipse that touches `bounds` from inside, written into `histogram`; returns the share
    /// of the ellipse inside the picture (0 to 1). Nothing inside, an empty or a non-finite ellipse: zeros and 0.
    ///
    /// Each pixel counts K(r^2) = 1 - r^2, where r is 0 in the middle and 1 on the ellipse (Epanechnikov; Bregonzio et
    /// al., eq. 11, corrected: K is that of Comaniciu, Ramesh and Meer 2003).
    pub fn histogram(
        &self,
        bounds: &Rectangle,
        scratch: &mut HistogramScratch,
        histogram: &mut Histogram,
    ) -> f32 {
        let bins = self.options.bins();
        histogram.values.clear();
        histogram.values.resize(bins, 0.0);
        scratch.sums.clear(bins);
        let (total, inside) = self.read(bounds, &mut scratch.sums);
        if total > 0.0 {
            for (bin, value) in (0_u16..).zip(&mut histogram.values) {
                *value = scratch.sums.of(bin) / total;
            }
        }
        inside
    }

    /// Scores every ellipse against one reference; `scores` is overwritten with one entry for each.
    ///
    /// A reference with another number of bins is nothing like any ellipse: coefficient 0, distance 1.
    pub fn score_ellipses(
        &self,
        ellipses: &[Rectangle],
        reference: &Histogram,
        scratch: &mut HistogramScratch,
        scores: &mut Vec<Similarity>,
    ) {
        let HistogramScratch { sums, roots } = scratch;
        let bins = self.options.bins();
        roots.clear();
        if reference.values.len() == bins {
            let used = (0_u16..)
                .zip(&reference.values)
                .filter(|(_, value)| **value > 0.0);
            roots.extend(used.map(|(bin, value)| (bin, value.sqrt())));
        }
        scores.clear();
        scores.extend(ellipses.iter().map(|bounds| {
            // What is in other bins is never asked for.
            sums.clear_those(roots.iter().map(|(bin, _)| *bin));
            let (total, inside) = self.read(bounds, sums);
            if total <= 0.0 {
                return Similarity {
                    coefficient: 0.0,
                    distance: 1.0,
                    inside,
                };
            }
            let sum: f32 = roots.iter().map(|&(bin, root)| sums.of(bin).sqrt() * root).sum();
            let coefficient = (sum / total.sqrt()).min(1.0);
            Similarity {
                coefficient,
                distance: (1.0 - coefficient).sqrt(),
                inside,
            }
        }));
    }

    /// Adds the kernel up by bin; returns the sum of all and the share inside the picture.
    fn read(&self, bounds: &Rectangle, sums: &mut BinSums) -> (f32, f32) {
        let (half_width, half_height) = (bounds.width / 2.0, bounds.height / 2.0);
        if !bounds.is_finite() || half_width <= 0.0 || half_height <= 0.0 {
            return (0.0, 0.0);
        }
        let area = std::f64::consts::PI * f64::from(half_width) * f64::from(half_height);
        let picture = Rectangle::new(0.0, 0.0, self.width as f32, self.height as f32);
        let seen = area.min(f64::from(bounds.intersection(&picture).area()));
        let step = ((seen / f64::from(self.options.pixels)).sqrt().ceil() as usize).max(1);
        let ellipse = Ellipse::new(bounds, self.width, self.height, step);
        let (total, pixels) = add_pixels(&self.bins, self.width, &ellipse, sums);
        let inside = if bounds.left >= 0.0
            && bounds.top >= 0.0
            && bounds.right() <= self.width as f32
            && bounds.bottom() <= self.height as f32
        {
            1.0
        } else {
            (pixels as f64 * (step as f64).powi(2) / area).min(1.0) as f32
        };
        if total > 0.0 { (total, inside) } else { (0.0, 0.0) }
    }
}

impl Histogram {
    /// A histogram with these values, which are scaled to sum to 1. `None` where a value is negative or not finite or
    /// all are zero.
    pub fn new(mut values: Vec<f32>) -> Option<Self> {
        let total: f32 = values.iter().sum();
        if !total.is_finite() || total <= 0.0 || values.iter().any(|&value| value < 0.0) {
            return None;
        }
        for value in &mut values {
            *value /= total;
        }
        Some(Self { values })
    }

    /// Replaces the values by `values`, each times `scale`; no change where their number differs. To stay a histogram
    /// they must be scaled to sum to 1.
    pub fn set_scaled(&mut self, values: &[f32], scale: f32) {
        if values.len() == self.values.len() {
            for (value, new) in self.values.iter_mut().zip(values) {
                *value = scale * new;
            }
        }
    }

    /// The values, one a bin.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Makes it one of nothing, keeping its memory.
    pub fn clear(&mut self) {
        self.values.clear();
    }

    /// Whether nothing was seen: all values zero.
    pub fn is_zero(&self) -> bool {
        self.values.iter().all(|&value| value == 0.0)
    }

    /// Bhattacharyya coefficient sum(sqrt(p q)), 0 (nothing in common) to 1 (the same); 0 where the numbers of bins
    /// differ.
    pub fn coefficient(&self, other: &Self) -> f32 {
        if self.values.len() != other.values.len() {
            return 0.0;
        }
        let sum: f32 = self
            .values
            .iter()
            .zip(&other.values)
            .map(|(p, q)| (p * q).sqrt())
            .sum();
        sum.min(1.0)
    }

    /// Distance sqrt(1 - coefficient), 0 to 1 (Bregonzio et al., eq. 10).
    pub fn distance(&self, other: &Self) -> f32 {
        (1.0 - self.coefficient(other)).sqrt()
    }

    /// Moves towards `other`: (1 - share) * self + share * other, `share` clamped to 0..=1. No change where the
    /// numbers of bins differ or `other` is zero; a histogram that is zero becomes `other`.
    pub fn blend(&mut self, other: &Self, share: f32) {
        if other.is_zero() {
            return;
        }
        if self.is_zero() {
            self.values.clone_from(&other.values);
            return;
        }
        if self.values.len() != other.values.len() {
            return;
        }
        let share = share.clamp(0.0, 1.0);
        for (value, &new) in self.values.iter_mut().zip(&other.values) {
            *value += share * (new - *value);
        }
    }
}

#[cfg(test)]
mod tests;
