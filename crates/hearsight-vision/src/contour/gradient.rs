//! Gradients of all colour channels together, found once a picture.
//!
//! Each pixel holds the sums over the channels of the products of both derivatives (Di Zenzo 1986). From them the
//! strength of an edge across any direction follows without looking at the channels again, and an edge between two
//! colours of equal brightness counts like any other.

use hearsight_core::RgbView;
use multiversion::multiversion;

/// Products of derivatives, sums over channels: xx, xy, yy; the last is unused, so that a pixel fills a register.
type Tensor = [f32; 4];

/// The gradients of a picture, (grey levels a pixel)^2.
#[derive(Clone, Debug, Default)]
pub struct GradientPicture {
    width: usize,
    height: usize,
    tensors: Vec<Tensor>,
    rows: Rows,
}

/// Products along one row, channels interleaved.
#[derive(Clone, Debug, Default)]
struct Rows {
    xx: Vec<i32>,
    xy: Vec<i32>,
    yy: Vec<i32>,
}

/// Sobel's operator weighs eight differences of neighbours.
const SCALE: f32 = 1.0 / 64.0;

impl GradientPicture {
    /// Takes a picture in; to be called once a picture. The outermost pixels have no gradient.
    pub fn compute(&mut self, picture: RgbView<'_>) {
        let (width, height) = (picture.width, picture.height);
        if (width, height) != (self.width, self.height) {
            (self.width, self.height) = (width, height);
            self.tensors.clear();
            self.tensors.resize(width * height, [0.0; 4]);
            for row in [&mut self.rows.xx, &mut self.rows.xy, &mut self.rows.yy] {
                row.clear();
                row.resize(3 * width, 0);
            }
        }
        if width < 3 || height < 3 {
            return;
        }
        for y in 1..height - 1 {
            let rows = [picture.row(y - 1), picture.row(y), picture.row(y + 1)];
            multiply(rows, &mut self.rows.xx, &mut self.rows.xy, &mut self.rows.yy);
            let out = &mut self.tensors[y * width + 1..(y + 1) * width - 1];
            gather(&self.rows.xx[3..], &self.rows.xy[3..], &self.rows.yy[3..], out);
        }
    }

    /// Size of the picture, (width, height).
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Squared strength of an edge across `direction` (unit length), (grey levels a pixel)^2, at a place between the
    /// pixels; places count from the picture's corner, so that the first pixel's centre is at (0.5, 0.5). 0 outside.
    #[inline]
    pub fn squared_strength(&self, x: f32, y: f32, direction: [f32; 2]) -> f32 {
        let [nx, ny] = direction;
        self.weighted(x, y, [nx * nx, 2.0 * nx * ny, ny * ny])
    }

    /// As [`Self::squared_strength`], by the products of the direction that are the same along a line.
    #[inline(always)]
    pub(super) fn weighted(&self, x: f32, y: f32, products: [f32; 3]) -> f32 {
        let (x, y) = (x - 0.5, y - 0.5);
        // Not a number is outside as well.
        let inside = x >= 0.0 && y >= 0.0 && x < (self.width as f32 - 1.0) && y < (self.height as f32 - 1.0);
        if !inside {
            return 0.0;
        }
        let (column, row) = (x as usize, y as usize);
        let (part_x, part_y) = (x - column as f32, y - row as f32);
        let at = row * self.width + column;
        let (Some([first, second]), Some([third, fourth])) = (
            self.tensors
                .get(at..at + 2)
                .and_then(|pair| pair.first_chunk::<2>()),
            self.tensors
                .get(at + self.width..at + self.width + 2)
                .and_then(|pair| pair.first_chunk::<2>()),
        ) else {
            return 0.0;
        };
        let dot =
            |tensor: &Tensor| tensor[0] * products[0] + tensor[1] * products[1] + tensor[2] * products[2];
        let (above, right_above, below, right_below) = (dot(first), dot(second), dot(third), dot(fourth));
        let upper = above + part_x * (right_above - above);
        let lower = below + part_x * (right_below - below);
        upper + part_y * (lower - upper)
    }
}

/// Products of the derivatives of every channel of a row, by Sobel's operator; the ends stay as they are.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn multiply([above, here, below]: [&[u8]; 3], xx: &mut [i32], xy: &mut [i32], yy: &mut [i32]) {
    let length = here.len();
    let inner = 3..length - 3;
    let (xx, xy, yy) = (&mut xx[inner.clone()], &mut xy[inner.clone()], &mut yy[inner]);
    let size = length - 6;
    let (above_left, above_here, above_right) = (&above[..size], &above[3..3 + size], &above[6..6 + size]);
    let (left, right) = (&here[..size], &here[6..6 + size]);
    let (below_left, below_here, below_right) = (&below[..size], &below[3..3 + size], &below[6..6 + size]);
    for i in 0..size {
        let value = |byte: u8| i32::from(byte);
        let dx = (value(above_right[i]) - value(above_left[i]))
            + 2 * (value(right[i]) - value(left[i]))
            + (value(below_right[i]) - value(below_left[i]));
        let dy = (value(below_left[i]) - value(above_left[i]))
            + 2 * (value(below_here[i]) - value(above_here[i]))
            + (value(below_right[i]) - value(above_right[i]));
        xx[i] = dx * dx;
        xy[i] = dx * dy;
        yy[i] = dy * dy;
    }
}

/// Sums over the three channels of each pixel.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn gather(xx: &[i32], xy: &[i32], yy: &[i32], out: &mut [Tensor]) {
    let (xx, _) = xx.as_chunks::<3>();
    let (xy, _) = xy.as_chunks::<3>();
    let (yy, _) = yy.as_chunks::<3>();
    for (((tensor, xx), xy), yy) in out.iter_mut().zip(xx).zip(xy).zip(yy) {
        let sum = |values: &[i32; 3]| (values[0] + values[1] + values[2]) as f32 * SCALE;
        *tensor = [sum(xx), sum(xy), sum(yy), 0.0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: usize, height: usize, of: impl Fn(usize, usize) -> [u8; 3]) -> GradientPicture {
        let data: Vec<u8> = (0..width * height)
            .flat_map(|i| of(i % width, i / width))
            .collect();
        let mut gradients = GradientPicture::default();
        gradients.compute(RgbView::new(width, height, &data).unwrap());
        gradients
    }

    #[test]
    fn a_slope_has_its_steepness_in_every_direction() {
        // Three and four grey levels a pixel along x and y, in one channel only.
        let gradients = picture(20, 16, |x, y| [0, (3 * x + 4 * y) as u8, 90]);
        for (direction, expected) in [
            ([1.0, 0.0], 9.0),
            ([0.0, 1.0], 16.0),
            ([0.6, 0.8], 25.0),
            ([0.8, -0.6], 0.0),
        ] {
            let found = gradients.squared_strength(9.3, 7.8, direction);
            assert!((found - expected).abs() < 1e-3, "{direction:?}: {found}");
        }
    }

    #[test]
    fn channels_add_up_even_where_brightness_does_not_change() {
        let gradients = picture(12, 12, |x, _| [(8 * x) as u8, (96 - 8 * x) as u8, 0]);
        assert!((gradients.squared_strength(6.0, 6.0, [1.0, 0.0]) - 128.0).abs() < 1e-3);
    }

    #[test]
    fn outside_is_nothing_and_small_pictures_have_no_gradient() {
        let gradients = picture(8, 8, |x, _| [(20 * x) as u8; 3]);
        for (x, y) in [
            (-1.0, 4.0),
            (4.0, 9.0),
            (f32::NAN, 4.0),
            (f32::INFINITY, 4.0),
            (8.0, 8.0),
        ] {
            assert_eq!(gradients.squared_strength(x, y, [1.0, 0.0]), 0.0);
        }
        assert_eq!(
            picture(2, 2, |_, _| [0; 3]).squared_strength(1.0, 1.0, [1.0, 0.0]),
            0.0
        );
        assert_eq!(
            GradientPicture::default().squared_strength(0.5, 0.5, [1.0, 0.0]),
            0.0
        );
    }
}
