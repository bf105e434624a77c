//! Paints a frame: a wall with pictures, two figures of head, hair and clothes, and the noise of a sensor.

use super::world::{HEIGHT, Noise, Truth, WIDTH};

/// Standard deviation of the sensor's noise, of 255.
const NOISE: f64 = 2.0;

/// Colours of a figure: hair, skin, clothes.
const COLOURS: [[[f64; 3]; 3]; 2] = [
    [[52.0, 36.0, 24.0], [214.0, 166.0, 138.0], [170.0, 40.0, 46.0]],
    [[150.0, 112.0, 60.0], [196.0, 146.0, 116.0], [38.0, 84.0, 150.0]],
];

/// Paints frames of one video.
pub(crate) struct Painter {
    wall: Vec<[f64; 3]>,
    noise: Noise,
}

impl Painter {
    pub(crate) fn new(seed: u64) -> Self {
        Self {
            wall: wall(),
            noise: Noise::new(seed),
        }
    }

    /// Interleaved R, G, B of a frame; whoever is farther away is painted first.
    pub(crate) fn paint(&mut self, people: &[Truth], rgb: &mut Vec<u8>) {
        let mut order: Vec<usize> = (0..people.len()).collect();
        order.sort_by(|&one, &other| people[other].mouth_m[1].total_cmp(&people[one].mouth_m[1]));
        rgb.clear();
        for row in 0..HEIGHT {
            for column in 0..WIDTH {
                let mut colour = self.wall[row * WIDTH + column];
                for &person in &order {
                    if let Some(own) = figure(&people[person], COLOURS[person % 2], column as f64, row as f64)
                    {
                        colour = own;
                    }
                }
                let noise = NOISE * self.noise.normal();
                rgb.extend(colour.map(|value| (value + noise).round().clamp(0.0, 255.0) as u8));
            }
        }
    }
}

/// The colour of a figure at a pixel, or nothing beside it.
fn figure(person: &Truth, colours: [[f64; 3]; 3], column: f64, row: f64) -> Option<[f64; 3]> {
    let [hair, skin, clothes] = colours;
    // Metres from the middle of the head, right and down.
    let x = (column - person.head_px[0]) / person.scale_px;
    let y = (row - person.head_px[1]) / person.scale_px;
    if (x / 0.085).powi(2) + (y / 0.12).powi(2) <= 1.0 {
        let eye = (x.abs() - 0.033).hypot(y + 0.01) < 0.012;
        let mouth = (x / 0.03).powi(2) + ((y - 0.06) / 0.008).powi(2) < 1.0;
        return Some(match () {
            () if y < -0.045 => hair,
            () if eye => [40.0, 30.0, 28.0],
            () if mouth => [150.0, 60.0, 60.0],
            () => skin.map(|value| value * (1.0 - 1.2 * x.abs())),
        });
    }
    if x.abs() < 0.05 && (0.1..0.17).contains(&y) {
        return Some(skin.map(|value| 0.85 * value));
    }
    // Shoulders that slope, then straight down; stripes, so that clothes have texture.
    let half_width = if y < 0.27 { 0.06 + 1.6 * (y - 0.15) } else { 0.25 };
    (y > 0.15 && x.abs() < half_width).then(|| {
        let stripe = if ((y * 40.0).floor() as i64).rem_euclid(3) == 0 {
            0.8
        } else {
            1.0
        };
        clothes.map(|value| value * stripe * (1.0 - 0.5 * x.abs()))
    })
}

/// A wall with light from the left, a door and two pictures.
fn wall() -> Vec<[f64; 3]> {
    let frames = [
        (30..75, 28..62, [70.0, 100.0, 80.0]),
        (230..290, 22..58, [120.0, 90.0, 60.0]),
    ];
    let pixel = |row: usize, column: usize| {
        let light = 1.0 - 0.25 * column as f64 / WIDTH as f64;
        let floor = row > 205;
        let mut colour = if floor {
            [96.0, 84.0, 72.0]
        } else {
            [176.0, 178.0, 168.0]
        };
        if (140..188).contains(&column) && (60..206).contains(&row) {
            colour = [126.0, 104.0, 82.0];
        }
        for (columns, rows, own) in &frames {
            if columns.contains(&column) && rows.contains(&row) {
                colour = *own;
            }
        }
        let grain = 4.0 * ((row * 7 + column * 13) % 5) as f64 / 5.0;
        colour.map(|value| value * light + grain)
    };
    (0..HEIGHT * WIDTH)
        .map(|place| pixel(place / WIDTH, place % WIDTH))
        .collect()
}
