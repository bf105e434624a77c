//! Microphone arrays: shapes, mismatch and losses.

use super::raw::{ArrayShape, RawArray, RawScene};
use super::resolve::Resolver;
use crate::acoustics::random::{between, generator};
use crate::world::{ArrayDevice, CameraDevice};
use hearsight_core::WorldPoint;
use hearsight_core::configuration::{ConfigurationError, Field};
use std::f64::consts::TAU;

/// Samples of all channels of an array a second: beyond it is a slip.
const MOST_MICROPHONES: usize = 256;

impl Resolver {
    pub(super) fn arrays(
        &self,
        raw: &RawScene,
        cameras: &[CameraDevice],
    ) -> Result<Vec<ArrayDevice>, ConfigurationError> {
        let arrays = raw.array.iter().enumerate();
        arrays
            .map(|(number, array)| self.array(&Field::of("array").index(number), array, cameras))
            .collect()
    }

    fn array(
        &self,
        field: &Field,
        raw: &RawArray,
        cameras: &[CameraDevice],
    ) -> Result<ArrayDevice, ConfigurationError> {
        let rate_hz = raw.rate.unwrap_or(16_000);
        if !(8_000..=192_000).contains(&rate_hz) {
            let what = format!("{rate_hz} samples a second is not possible");
            return Err(self.wrong(&field.key("rate"), what, "give 8000 to 192000, such as 16000"));
        }
        let base = self.base_number(field, &raw.base)?;
        let places = self.microphone_places(field, raw)?;
        let mut microphones = Vec::new();
        for (number, place) in places.iter().enumerate() {
            let at = if raw.microphones.is_empty() {
                field.key("at")
            } else {
                field.key("microphones").index(number)
            };
            let point = if base.is_some() {
                self.point(&at, *place)?
            } else {
                self.inside(&at, *place)?
            };
            if microphones
                .iter()
                .any(|other: &WorldPoint| other.distance_m(point) < 1e-3)
            {
                let what = format!("microphone {number} is at {place:?}, where another one is");
                return Err(self.wrong(&at, what, "an array of zero size hears no direction"));
            }
            microphones.push(point);
        }
        let camera = match &raw.camera {
            Some(name) => {
                let found = cameras.iter().position(|camera| &camera.name == name);
                let known: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
                let missing = || {
                    self.wrong(
                        &field.key("camera"),
                        format!("there is no camera `{name}`"),
                        Self::did_you_mean(name, &known),
                    )
                };
                Some(found.ok_or_else(missing)?)
            }
            None => (cameras.len() == 1).then_some(0),
        };
        self.spans(&field.key("lost"), &raw.lost, "a loss")?;
        let number = |key: &str, value, usual, range| {
            self.number(
                &field.key(key),
                value,
                usual,
                range,
                "see `hearsight schema scenario`",
            )
        };
        let share = number("lost_share", raw.lost_share, 0.0, [0.0, 0.9])?;
        let block = number("lost_block", raw.lost_block, 0.02, [0.005, 10.0])?;
        let name = self.name_of(field);
        Ok(ArrayDevice {
            rate_hz,
            base,
            microphones,
            mismatch: [
                number("gain_mismatch", raw.gain_mismatch, 1.0, [0.0, 20.0])?,
                number("delay_mismatch", raw.delay_mismatch, 5e-6, [0.0, 1e-3])?,
                number("corner_mismatch", raw.corner_mismatch, 0.2, [0.0, 0.9])?,
            ],
            noise_db: number("noise", raw.noise, -80.0, [-200.0, 0.0])?,
            camera,
            lost: self.losses(&name, &raw.lost, share, block),
            clock: self.clock(&field.key("clock"), &raw.clock)?,
            name,
        })
    }

    fn microphone_places(&self, field: &Field, raw: &RawArray) -> Result<Vec<[f64; 3]>, ConfigurationError> {
        if !raw.microphones.is_empty() {
            if raw.shape.is_some() || raw.at.is_some() {
                let what = "has `microphones` and a `shape` at a place";
                return Err(self.wrong(field, what, "keep one of them"));
            }
            if raw.microphones.len() > MOST_MICROPHONES {
                return Err(self.wrong(&field.key("microphones"), "are too many", "256 are the most"));
            }
            return Ok(raw.microphones.clone());
        }
        let Some([x, y, z]) = raw.at else {
            return Err(self.missing(field, "at", "give its middle, [x, y, z], or the `microphones`"));
        };
        let shape = raw.shape.unwrap_or(ArrayShape::Circle);
        let count = raw.count.unwrap_or(match shape {
            ArrayShape::Pair => 2,
            ArrayShape::Line => 4,
            ArrayShape::Circle => 8,
        });
        if count == 0 || count > MOST_MICROPHONES || (shape == ArrayShape::Pair && count != 2) {
            let what = format!("{count} microphones do not make this shape");
            return Err(self.wrong(&field.key("count"), what, "a pair has 2, others 1 to 256"));
        }
        let facing = self
            .number(
                &field.key("facing"),
                raw.facing,
                0.0,
                [-3600.0, 3600.0],
                "give degrees",
            )?
            .to_radians();
        let spacing = self.number(
            &field.key("spacing"),
            raw.spacing,
            0.2,
            [0.002, 20.0],
            "give metres",
        )?;
        let radius = self.number(
            &field.key("radius"),
            raw.radius,
            0.1,
            [0.002, 20.0],
            "give metres",
        )?;
        let place = |number: usize| match shape {
            ArrayShape::Pair | ArrayShape::Line => {
                let left = spacing * (0.5 * (count - 1) as f64 - number as f64);
                [x - left * facing.sin(), y + left * facing.cos(), z]
            }
            ArrayShape::Circle => {
                let angle = facing + TAU * number as f64 / count as f64;
                [x + radius * angle.cos(), y + radius * angle.sin(), z]
            }
        };
        Ok((0..count).map(place).collect())
    }

    /// Losses that are written and those that are drawn, in order and joined where they touch.
    fn losses(&self, name: &str, written: &[[f64; 2]], share: f64, block_s: f64) -> Vec<[f64; 2]> {
        let mut all = written.to_vec();
        if share > 0.0 {
            let mut random = generator(self.seed_of("losses", name), "losses", 0);
            let blocks = (self.seconds / block_s).ceil() as usize;
            for block in 0..blocks {
                if between(&mut random, 0.0, 1.0) < share {
                    all.push([block as f64 * block_s, (block + 1) as f64 * block_s]);
                }
            }
            all.sort_by(|one, other| one[0].total_cmp(&other[0]));
        }
        let mut joined: Vec<[f64; 2]> = Vec::new();
        for span in all {
            match joined.last_mut() {
                Some(last) if span[0] <= last[1] + 1e-9 => last[1] = last[1].max(span[1]),
                _ => joined.push(span),
            }
        }
        joined
    }
}
