//! Pictures and sounds to work on, made in code or given.

use crate::Failure;
use hearsight_core::{GrayView, RgbView};

/// Size of the pictures made in code.
const SIZE: (usize, usize) = (360, 288);
/// How many are made.
const COUNT: usize = 8;

/// A picture in colour and in grey.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Interleaved R, G, B.
    pub rgb: Vec<u8>,
    /// One byte a pixel.
    pub grey: Vec<u8>,
}

/// All that pieces of work are prepared from.
#[derive(Clone, Debug)]
pub struct Inputs {
    /// Pictures of one camera in order of time, all of one size.
    pub pictures: Vec<Picture>,
}

impl Picture {
    /// The colours.
    pub fn rgb_view(&self) -> RgbView<'_> {
        RgbView {
            width: self.width,
            height: self.height,
            data: &self.rgb,
        }
    }

    /// The grey values.
    pub fn grey_view(&self) -> GrayView<'_> {
        GrayView {
            width: self.width,
            height: self.height,
            data: &self.grey,
        }
    }

    /// The part of at most `width x height` pixels at the top left.
    pub fn cropped(&self, width: usize, height: usize) -> Self {
        let (width, height) = (width.min(self.width), height.min(self.height));
        let part = |data: &[u8], bytes: usize| {
            let rows = data.chunks_exact(self.width * bytes).take(height);
            rows.flat_map(|row| row[..width * bytes].iter().copied())
                .collect()
        };
        Self {
            width,
            height,
            rgb: part(&self.rgb, 3),
            grey: part(&self.grey, 1),
        }
    }
}

impl Inputs {
    /// Two people walk through a room: eight pictures, the same on every machine.
    pub fn synthetic() -> Self {
        Self {
            pictures: (0..COUNT).map(paint).collect(),
        }
    }

    /// The pictures whose bytes are given one after the other.
    ///
    /// # Errors
    /// Where the bytes are not those of one or more pictures of this size, as many in grey as in colour.
    pub fn from_bytes(rgb: &[u8], grey: &[u8], width: usize, height: usize) -> Result<Self, Failure> {
        let pixels = width * height;
        if pixels == 0 || grey.is_empty() || !grey.len().is_multiple_of(pixels) || rgb.len() != 3 * grey.len()
        {
            return Err(format!(
                "{} and {} bytes are no pictures of {width} x {height}",
                rgb.len(),
                grey.len()
            )
            .into());
        }
        let pairs = rgb.chunks_exact(3 * pixels).zip(grey.chunks_exact(pixels));
        let pictures = pairs.map(|(rgb, grey)| Picture {
            width,
            height,
            rgb: rgb.to_vec(),
            grey: grey.to_vec(),
        });
        Ok(Self {
            pictures: pictures.collect(),
        })
    }

    /// Samples of noise, uniform within -1 and 1.
    pub fn noise(seed: u64, count: usize) -> Vec<f32> {
        let mut random = Random(seed);
        (0..count)
            .map(|_| random.next() as f32 / f32::from(1_u16 << 15) - 1.0)
            .collect()
    }
}

/// Numbers of 16 bits that look random (Knuth's MMIX).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u16 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 48) as u16
    }
}

/// A wall with furniture and grain, and two people who have gone `number` steps.
fn paint(number: usize) -> Picture {
    let (width, height) = SIZE;
    let mut random = Random(number as u64);
    let (mut rgb, mut grey) = (Vec::new(), Vec::new());
    let people = [
        (90.0 + 14.0 * number as f32, 60.0, 15.0),
        (260.0 - 9.0 * number as f32, 90.0, 12.0),
    ];
    for y in 0..height {
        for x in 0..width {
            let grain = f32::from(random.next() >> 13);
            let colour =
                colour_at(&people, x as f32, y as f32).map(|level| (level + grain).clamp(0.0, 255.0) as u8);
            let [red, green, blue] = colour.map(f32::from);
            rgb.extend(colour);
            grey.push((0.299 * red + 0.587 * green + 0.114 * blue) as u8);
        }
    }
    Picture {
        width,
        height,
        rgb,
        grey,
    }
}

fn colour_at(people: &[(f32, f32, f32)], x: f32, y: f32) -> [f32; 3] {
    for (person, &(middle, top, half)) in people.iter().enumerate() {
        let (dx, dy) = ((x - middle) / half, (y - top) / (1.3 * half) - 1.0);
        let eye = (dx.abs() - 0.4).abs() < 0.18 && (dy + 0.1).abs() < 0.12;
        let mouth = dx.abs() < 0.35 && (dy - 0.5).abs() < 0.08;
        if dx * dx + dy * dy < 1.0 {
            return if eye || mouth || dy < -0.6 {
                [60.0, 40.0, 35.0]
            } else {
                [205.0, 160.0, 135.0]
            };
        }
        if dx.abs() < 2.0 && dy > 0.9 {
            return if person == 0 {
                [40.0, 60.0, 150.0]
            } else {
                [150.0, 50.0, 40.0]
            };
        }
    }
    let shelf = ((x / 23.0) as i32 + (y / 31.0) as i32) % 5 == 0;
    let light = 120.0 + 0.15 * x - 0.1 * y;
    if shelf {
        [0.6 * light, 0.5 * light, 0.4 * light]
    } else {
        [light, light, 0.9 * light]
    }
}
