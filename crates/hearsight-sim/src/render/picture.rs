//! A finished picture: planes as a codec takes them, and the truth of who is seen in it.

use super::Range;
use hearsight_core::Rectangle;
use hearsight_core::yuv::{Primaries, YuvMatrix};

/// Where something is in a picture, hidden or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Edges of its outline as if nothing hid it and the picture had no borders, pixels; the picture's top-left corner
    /// is (0, 0). In a panorama it may reach beyond the picture's left or right edge and go on at the other. Far
    /// outside, one picture's size from the borders, it is cut.
    pub whole: Rectangle,
    /// The part of `whole` that lies in the picture, of zero size where none does.
    pub inside: Rectangle,
    /// Share of the outline's pixels that are seen: neither outside the picture nor hidden by furniture, by others or,
    /// for a head, by the person's own arms. 0 to 1.
    pub visible: f64,
    /// Pixels of the outline that are seen.
    pub seen_px: f64,
}

/// What a picture shows of one person.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sight {
    /// The head with ears, nose and hair down to the chin; `None` where the lens cannot see it.
    pub head: Option<Extent>,
    /// All of the person, head included; `None` where the lens cannot see any of them.
    pub body: Option<Extent>,
}

/// A picture in YUV 4:2:0 with the weights of BT.601, and what is seen in it.
///
/// A chroma sample is the mean of the pixels that it covers and sits amid them, as in JPEG and MPEG-1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The codes of the planes.
    pub range: Range,
    /// Luma, `width * height` codes, row-major.
    pub luma: Vec<u8>,
    /// Cb and Cr, each half the width and half the height, rounded up.
    pub chroma: [Vec<u8>; 2],
    /// One for each person of the shot, in its order.
    pub sights: Vec<Sight>,
}

impl Picture {
    /// Width and height of the chroma planes.
    pub const fn chroma_size(&self) -> (usize, usize) {
        (self.width.div_ceil(2), self.height.div_ceil(2))
    }

    /// Gives the planes the size of a picture, keeping their memory.
    pub(super) fn resize(&mut self, width: usize, height: usize) {
        (self.width, self.height) = (width, height);
        self.luma.resize(width * height, 0);
        let (columns, rows) = self.chroma_size();
        for plane in &mut self.chroma {
            plane.resize(columns * rows, 0);
        }
    }

    /// Interleaved R, G, B and full-range luma, exactly as they are read from a lossless file of these planes that is
    /// tagged with their range: by [`YuvMatrix`].
    pub fn to_rgb(&self, rgb: &mut Vec<u8>, luma: &mut Vec<u8>) {
        let matrix = YuvMatrix::new(Primaries::Bt601, self.range == Range::Full);
        rgb.resize(self.width * self.height * 3, 0);
        luma.resize(self.width * self.height, 0);
        if rgb.is_empty() {
            return;
        }
        let columns = self.chroma_size().0;
        let rows = self.luma.chunks_exact(self.width);
        let out = rgb
            .chunks_exact_mut(3 * self.width)
            .zip(luma.chunks_exact_mut(self.width));
        for ((y, codes), (rgb, luma)) in rows.enumerate().zip(out) {
            let [u, v] = [0, 1].map(|plane| &self.chroma[plane][y / 2 * columns..][..columns]);
            matrix.luma_row(codes, luma);
            matrix.row_of_pairs(codes, u, v, rgb);
        }
    }
}
