//! Drawing on RGB pictures: boxes, ellipses, lines, strips of numbers and text, clipped to the picture.
//!
//! Only what overlays need. Coordinates are pixels with (0, 0) at the centre of the top-left pixel; rectangles are
//! edges, as [`Rectangle`] defines. What is not finite is not drawn.

use font8x8::legacy::BASIC_LEGACY;
use hearsight_core::{Rectangle, VideoFrame};

/// Pixels of a character at scale 1, each way.
pub const CHARACTER_SIZE: usize = 8;

/// A colour: red, green, blue.
pub type Color = [u8; 3];

/// A picture to draw on.
pub struct Canvas<'a> {
    width: usize,
    height: usize,
    rgb: &'a mut [u8],
}

impl<'a> Canvas<'a> {
    /// A canvas on interleaved R, G, B bytes, or `None` where their number is not `width * height * 3`.
    pub fn new(width: usize, height: usize, rgb: &'a mut [u8]) -> Option<Self> {
        (rgb.len() == width.checked_mul(height)?.checked_mul(3)?).then_some(Self { width, height, rgb })
    }

    /// A canvas on a frame's colour picture, or `None` where its bytes do not fit its size.
    pub fn on(frame: &'a mut VideoFrame) -> Option<Self> {
        Self::new(frame.width, frame.height, &mut frame.rgb)
    }

    /// Pixels a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Paints one pixel; outside the picture nothing happens.
    pub fn pixel(&mut self, x: i64, y: i64, color: Color) {
        if (0..self.width as i64).contains(&x) && (0..self.height as i64).contains(&y) {
            let at = (y as usize * self.width + x as usize) * 3;
            self.rgb[at..at + 3].copy_from_slice(&color);
        }
    }

    /// Fills a rectangle; `opacity` from 0 (nothing) to 1 (solid).
    pub fn fill(&mut self, rectangle: &Rectangle, color: Color, opacity: f32) {
        if !rectangle.is_finite() || !opacity.is_finite() {
            return;
        }
        let columns = covered(rectangle.left, rectangle.right(), self.width);
        let share = (opacity.clamp(0.0, 1.0) * 256.0) as u32;
        for y in covered(rectangle.top, rectangle.bottom(), self.height) {
            let row = &mut self.rgb[y * self.width * 3..][..self.width * 3];
            for pixel in row[columns.start * 3..columns.end * 3].chunks_exact_mut(3) {
                for (old, new) in pixel.iter_mut().zip(color) {
                    *old = ((u32::from(*old) * (256 - share) + u32::from(new) * share) >> 8) as u8;
                }
            }
        }
    }

    /// Draws a rectangle's outline, `thickness` pixels inwards from its edges.
    pub fn outline(&mut self, rectangle: &Rectangle, thickness: f32, color: Color) {
        let Rectangle {
            left,
            top,
            width,
            height,
        } = *rectangle;
        let across = thickness.max(1.0).min(width);
        let down = thickness.max(1.0).min(height);
        self.fill(&Rectangle::new(left, top, width, down), color, 1.0);
        self.fill(
            &Rectangle::new(left, rectangle.bottom() - down, width, down),
            color,
            1.0,
        );
        self.fill(&Rectangle::new(left, top, across, height), color, 1.0);
        self.fill(
            &Rectangle::new(rectangle.right() - across, top, across, height),
            color,
            1.0,
        );
    }

    /// Draws a line, `thickness` pixels wide, with square ends.
    pub fn line(&mut self, from: (f32, f32), to: (f32, f32), thickness: f32, color: Color) {
        if ![from.0, from.1, to.0, to.1, thickness]
            .iter()
            .all(|number| number.is_finite())
        {
            return;
        }
        let margin = thickness.max(1.0);
        let Some((from, to)) = self.clip(from, to, margin) else {
            return;
        };
        let steps = (to.0 - from.0).abs().max((to.1 - from.1).abs()).ceil().max(1.0);
        for step in 0..=steps as usize {
            let share = step as f32 / steps;
            self.dot(
                from.0 + (to.0 - from.0) * share,
                from.1 + (to.1 - from.1) * share,
                margin,
                color,
            );
        }
    }

    /// Draws lines from point to point.
    pub fn polyline(&mut self, points: &[(f32, f32)], thickness: f32, color: Color) {
        for pair in points.windows(2) {
            self.line(pair[0], pair[1], thickness, color);
        }
    }

    /// Draws an ellipse around `centre` with half-axes `radii`, turned by `angle` radians from x towards y.
    pub fn ellipse(
        &mut self,
        centre: (f32, f32),
        radii: (f32, f32),
        angle: f32,
        thickness: f32,
        color: Color,
    ) {
        if ![centre.0, centre.1, radii.0, radii.1, angle]
            .iter()
            .all(|number| number.is_finite())
        {
            return;
        }
        let (sine, cosine) = angle.sin_cos();
        // Chords of about three pixels look round; a giant ellipse is still a bounded amount of work.
        let chords = (radii.0.abs().max(radii.1.abs()) * 2.1)
            .clamp(12.0, 2000.0)
            .ceil();
        let point = |index: usize| {
            let (s, c) = (std::f32::consts::TAU * index as f32 / chords).sin_cos();
            let (x, y) = (radii.0 * c, radii.1 * s);
            (centre.0 + x * cosine - y * sine, centre.1 + x * sine + y * cosine)
        };
        for index in 0..chords as usize {
            self.line(point(index), point(index + 1), thickness, color);
        }
    }

    /// Draws a strip of numbers, such as a correlation, as a curve that fills `area` from `low` (bottom) to `high`.
    pub fn strip(&mut self, area: &Rectangle, values: &[f32], (low, high): (f32, f32), color: Color) {
        let range = high - low;
        if !area.is_finite() || !range.is_finite() || range == 0.0 || values.is_empty() {
            return;
        }
        let step = area.width.max(1.0) / values.len() as f32;
        let place = |index: usize, value: f32| {
            let height = ((value - low) / range).clamp(0.0, 1.0) * (area.height - 1.0).max(0.0);
            (
                area.left + step * (index as f32 + 0.5) - 0.5,
                area.bottom() - 1.0 - height,
            )
        };
        let mut last: Option<(f32, f32)> = None;
        for (index, value) in values.iter().enumerate() {
            let point = value.is_finite().then(|| place(index, *value));
            if let Some(point) = point {
                self.line(last.unwrap_or(point), point, 1.0, color);
            }
            last = point;
        }
    }

    /// Writes ASCII text with its top-left corner at (`x`, `y`), characters of 8 times `scale` pixels; other
    /// characters become question marks.
    pub fn text(&mut self, x: f32, y: f32, scale: usize, color: Color, text: &str) {
        if !x.is_finite() || !y.is_finite() {
            return;
        }
        let scale = scale.clamp(1, 1000) as i64;
        // Text beyond a million pixels is out of sight anyway and must not overflow.
        let (mut left, top) = (
            x.clamp(-1e6, 1e6).round() as i64,
            y.clamp(-1e6, 1e6).round() as i64,
        );
        for character in text.chars() {
            let glyph = BASIC_LEGACY
                .get(character as usize)
                .unwrap_or(&BASIC_LEGACY[b'?' as usize]);
            for (row, bits) in (0..).zip(glyph) {
                for column in (0..CHARACTER_SIZE as i64).filter(|column| bits >> column & 1 == 1) {
                    for (dx, dy) in (0..scale).flat_map(|dy| (0..scale).map(move |dx| (dx, dy))) {
                        self.pixel(left + column * scale + dx, top + row * scale + dy, color);
                    }
                }
            }
            left += CHARACTER_SIZE as i64 * scale;
            if left > self.width as i64 {
                break;
            }
        }
    }

    /// Writes text on a filled box of another colour, moved to lie inside the picture.
    pub fn label(&mut self, x: f32, y: f32, scale: usize, color: Color, ground: Color, text: &str) {
        let size = (CHARACTER_SIZE * scale.max(1)) as f32;
        let width = text.chars().count() as f32 * size + 2.0;
        let left = x.min(self.width as f32 - width).max(0.0);
        let top = y.min(self.height as f32 - size - 2.0).max(0.0);
        self.fill(
            &Rectangle::new(left - 0.5, top - 0.5, width, size + 2.0),
            ground,
            1.0,
        );
        self.text(left + 1.0, top + 1.0, scale, color, text);
    }

    /// A square of `size` pixels around a point.
    fn dot(&mut self, x: f32, y: f32, size: f32, color: Color) {
        let first = |centre: f32| (centre - (size - 1.0) / 2.0).round() as i64;
        let (left, top) = (first(x), first(y));
        for dy in 0..size as i64 {
            for dx in 0..size as i64 {
                self.pixel(left + dx, top + dy, color);
            }
        }
    }

    /// The part of a line near the picture (Liang and Barsky), so that a line to far away costs little.
    fn clip(&self, from: (f32, f32), to: (f32, f32), margin: f32) -> Option<((f32, f32), (f32, f32))> {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let (right, bottom) = (self.width as f32 + margin, self.height as f32 + margin);
        let (mut enter, mut leave) = (0.0_f32, 1.0_f32);
        let sides = [
            (-dx, from.0 + margin),
            (dx, right - from.0),
            (-dy, from.1 + margin),
            (dy, bottom - from.1),
        ];
        for (direction, distance) in sides {
            if direction == 0.0 && distance < 0.0 {
                return None;
            }
            if direction < 0.0 {
                enter = enter.max(distance / direction);
            } else if direction > 0.0 {
                leave = leave.min(distance / direction);
            }
        }
        let at = |share: f32| (from.0 + dx * share, from.1 + dy * share);
        (enter <= leave && dx.is_finite() && dy.is_finite()).then(|| (at(enter), at(leave)))
    }
}

/// The pixels whose centres lie between two edges.
fn covered(from: f32, to: f32, limit: usize) -> std::ops::Range<usize> {
    let index = |edge: f32| (edge.ceil().max(0.0) as usize).min(limit);
    let (from, to) = (index(from), index(to));
    from..to.max(from)
}

/// A colour for an identity: neighbours in number are far apart in hue, and the same number is always the same.
pub fn identity_color(identity: u64) -> Color {
    // Steps of the golden ratio spread any number of hues evenly.
    let hue = (identity as f64 * 0.618_033_988_749_895 + 0.08).fract() * 6.0;
    let (saturation, value) = [(0.85, 1.0), (0.55, 1.0), (0.9, 0.75)][(identity % 3) as usize];
    let channel = |shift: f64| {
        let k = (shift + hue) % 6.0;
        let level = value - value * saturation * k.min(4.0 - k).clamp(0.0, 1.0);
        (level * 255.0_f64).round() as u8
    };
    [channel(5.0), channel(3.0), channel(1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Color = [255, 0, 0];

    fn drawn(draw: impl Fn(&mut Canvas<'_>)) -> Vec<String> {
        let mut rgb = vec![0; 12 * 8 * 3];
        draw(&mut Canvas::new(12, 8, &mut rgb).unwrap());
        let marks: Vec<char> = rgb
            .chunks_exact(3)
            .map(|pixel| if pixel == RED { '#' } else { '.' })
            .collect();
        marks.chunks_exact(12).map(|row| row.iter().collect()).collect()
    }

    #[test]
    fn an_outline_lies_on_its_edges() {
        let rows = drawn(|canvas| canvas.outline(&Rectangle::new(1.0, 1.0, 5.0, 4.0), 1.0, RED));
        let expected = [
            "............",
            ".#####......",
            ".#...#......",
            ".#...#......",
            ".#####......",
        ];
        assert_eq!(rows[..5], expected);
        assert!(rows[5..].iter().all(|row| !row.contains('#')));
    }

    #[test]
    fn lines_and_ellipses_reach_their_points() {
        let rows = drawn(|canvas| canvas.line((0.0, 0.0), (7.0, 7.0), 1.0, RED));
        assert!(rows.iter().enumerate().all(|(y, row)| row.find('#') == Some(y)));
        let rows = drawn(|canvas| canvas.ellipse((5.0, 4.0), (4.0, 3.0), 0.0, 1.0, RED));
        for (x, y) in [(1, 4), (9, 4), (5, 1), (5, 7)] {
            assert_eq!(&rows[y][x..=x], "#", "{x} {y}: {rows:?}");
        }
        assert_eq!(&rows[4][5..6], ".");
    }

    #[test]
    fn text_is_readable() {
        let rows = drawn(|canvas| canvas.text(1.0, 0.0, 1, RED, "L"));
        assert_eq!(rows[0], ".####.......");
        assert_eq!(rows[6], ".#######....");
    }

    #[test]
    fn nothing_outside_or_unreal_is_drawn() {
        let everywhere = [-1e30, -5.0, 3.0, 400.0, 1e30, f32::NAN, f32::INFINITY];
        drawn(|canvas| {
            for x in everywhere {
                for y in everywhere {
                    canvas.fill(&Rectangle::new(x, y, y, x), RED, 0.5);
                    canvas.outline(&Rectangle::new(y, x, 50.0, 50.0), 3.0, RED);
                    canvas.line((x, y), (y, 3.0), 2.0, RED);
                    canvas.ellipse((3.0, x), (y.min(1e6), 4.0), x, 1.0, RED);
                    canvas.text(x, y, 2, RED, "é?");
                    canvas.label(x, y, 1, RED, RED, "away");
                    canvas.strip(
                        &Rectangle::new(0.0, 0.0, 12.0, 8.0),
                        &[x, y, 1.0],
                        (0.0, 1.0),
                        RED,
                    );
                }
            }
        });
        assert!(Canvas::new(usize::MAX, 2, &mut []).is_none());
    }

    #[test]
    fn a_strip_spans_its_area() {
        let rows = drawn(|canvas| {
            canvas.strip(
                &Rectangle::new(0.0, 0.0, 12.0, 8.0),
                &[0.0, 1.0, f32::NAN, 1.0],
                (0.0, 1.0),
                RED,
            );
        });
        assert!(rows[0].contains('#') && rows[7].contains('#'), "{rows:?}");
    }

    #[test]
    fn identities_have_distinct_colors() {
        for first in 0..16_u64 {
            for second in 0..first {
                let (a, b) = (identity_color(first), identity_color(second));
                let distance: i32 = a
                    .iter()
                    .zip(b)
                    .map(|(a, b)| (i32::from(*a) - i32::from(b)).abs())
                    .sum();
                assert!(distance > 40, "{first} {second}: {a:?} {b:?}");
            }
        }
    }
}
