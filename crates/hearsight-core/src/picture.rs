//! Views of pictures and binary masks: borrowed pixels with their size, nothing that computes.
//!
//! Rows are stored top to bottom without padding. Colour is interleaved R, G, B.

use serde::{Deserialize, Serialize};

/// A borrowed grey picture, one byte a pixel, `width * height` bytes.
#[derive(Clone, Copy, Debug)]
pub struct GrayView<'a> {
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row-major bytes, `width * height` of them.
    pub data: &'a [u8],
}

/// A borrowed colour picture, three bytes (R, G, B) a pixel, `width * height * 3` bytes.
#[derive(Clone, Copy, Debug)]
pub struct RgbView<'a> {
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row-major interleaved bytes, `width * height * 3` of them.
    pub data: &'a [u8],
}

/// An owned binary picture: 0 is off, 255 is on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mask {
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row-major bytes, `width * height` of them, each 0 or 255.
    pub data: Vec<u8>,
}

/// An axis-parallel rectangle in pixels; edges, not pixel centres, so `left + width` is the first column outside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rectangle {
    /// Left edge, pixels.
    pub left: f32,
    /// Top edge, pixels.
    pub top: f32,
    /// Width, pixels, not negative.
    pub width: f32,
    /// Height, pixels, not negative.
    pub height: f32,
}

impl<'a> GrayView<'a> {
    /// A view of `data`, or `None` where its length is not `width * height`.
    pub fn new(width: usize, height: usize, data: &'a [u8]) -> Option<Self> {
        (data.len() == width.checked_mul(height)?).then_some(Self { width, height, data })
    }

    /// The row with index `y`.
    pub fn row(&self, y: usize) -> &'a [u8] {
        &self.data[y * self.width..(y + 1) * self.width]
    }
}

impl<'a> RgbView<'a> {
    /// A view of `data`, or `None` where its length is not `width * height * 3`.
    pub fn new(width: usize, height: usize, data: &'a [u8]) -> Option<Self> {
        (data.len() == width.checked_mul(height)?.checked_mul(3)?).then_some(Self { width, height, data })
    }

    /// The row with index `y`, `width * 3` bytes.
    pub fn row(&self, y: usize) -> &'a [u8] {
        &self.data[y * self.width * 3..(y + 1) * self.width * 3]
    }

    /// The colour of the pixel in column `x` and row `y`.
    pub fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        let at = (y * self.width + x) * 3;
        [self.data[at], self.data[at + 1], self.data[at + 2]]
    }
}

impl Mask {
    /// A mask with every pixel off.
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            data: vec![0; width * height],
        }
    }

    /// Gives the mask a size, keeping its memory; contents are unspecified after a change of size.
    pub fn resize(&mut self, width: usize, height: usize) {
        self.width = width;
        self.height = height;
        self.data.resize(width * height, 0);
    }

    /// The mask as a grey picture.
    pub fn view(&self) -> GrayView<'_> {
        GrayView {
            width: self.width,
            height: self.height,
            data: &self.data,
        }
    }
}

impl Rectangle {
    /// A rectangle from its left and top edge, width and height.
    pub const fn new(left: f32, top: f32, width: f32, height: f32) -> Self {
        Self {
            left,
            top,
            width,
            height,
        }
    }

    /// A rectangle from its centre and size.
    pub fn from_centre(x: f32, y: f32, width: f32, height: f32) -> Self {
        Self {
            left: x - width / 2.0,
            top: y - height / 2.0,
            width,
            height,
        }
    }

    /// The first column outside on the right.
    pub fn right(&self) -> f32 {
        self.left + self.width
    }

    /// The first row outside at the bottom.
    pub fn bottom(&self) -> f32 {
        self.top + self.height
    }

    /// The middle, (x, y).
    pub fn centre(&self) -> (f32, f32) {
        (self.left + self.width / 2.0, self.top + self.height / 2.0)
    }

    /// Area in square pixels.
    pub fn area(&self) -> f32 {
        self.width.max(0.0) * self.height.max(0.0)
    }

    /// The common part, of zero size where there is none.
    pub fn intersection(&self, other: &Self) -> Self {
        let left = self.left.max(other.left);
        let top = self.top.max(other.top);
        let width = (self.right().min(other.right()) - left).max(0.0);
        let height = (self.bottom().min(other.bottom()) - top).max(0.0);
        Self {
            left,
            top,
            width,
            height,
        }
    }

    /// Intersection over union, 0 to 1; 0 for two empty rectangles.
    pub fn overlap(&self, other: &Self) -> f32 {
        let common = self.intersection(other).area();
        let union = self.area() + other.area() - common;
        if union > 0.0 { common / union } else { 0.0 }
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        self.left.is_finite() && self.top.is_finite() && self.width.is_finite() && self.height.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlap_of_half_shifted_squares_is_a_third() {
        let a = Rectangle::new(0.0, 0.0, 2.0, 2.0);
        let b = Rectangle::new(1.0, 0.0, 2.0, 2.0);
        assert!((a.overlap(&b) - 1.0 / 3.0).abs() < 1e-6);
        assert_eq!(a.overlap(&Rectangle::new(5.0, 5.0, 1.0, 1.0)), 0.0);
        assert_eq!(Rectangle::default().overlap(&Rectangle::default()), 0.0);
    }

    #[test]
    fn views_refuse_a_wrong_length() {
        assert!(GrayView::new(2, 2, &[0; 3]).is_none());
        assert!(RgbView::new(2, 2, &[0; 12]).is_some());
        assert!(RgbView::new(usize::MAX, 2, &[]).is_none());
    }
}
