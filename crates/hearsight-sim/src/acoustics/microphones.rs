//! Microphones: where they are, how they differ from each other, and the clock that takes their samples.

use super::error::{AcousticsError, check};
use super::random::{between, generator};
use hearsight_core::WorldPoint;
use serde::{Deserialize, Serialize};

/// Where the microphones of one array are.
///
/// Closures from seconds and a slice of points are placements. The renderer asks in the order of time and never later
/// than 10 ms after the last sample that it is to give, so that devices which obey commands can be asked.
pub trait Placement: Sync {
    /// Writes where each microphone is `time_s` seconds into the scenario.
    fn place(&self, time_s: f64, positions: &mut [WorldPoint]);
}

impl<F: Fn(f64, &mut [WorldPoint]) + Sync> Placement for F {
    fn place(&self, time_s: f64, positions: &mut [WorldPoint]) {
        self(time_s, positions);
    }
}

/// Microphones that never move. There must be as many as the array has.
impl Placement for [WorldPoint] {
    fn place(&self, _: f64, positions: &mut [WorldPoint]) {
        for (to, from) in positions.iter_mut().zip(self) {
            *to = *from;
        }
    }
}

impl Placement for Vec<WorldPoint> {
    fn place(&self, time_s: f64, positions: &mut [WorldPoint]) {
        self.as_slice().place(time_s, positions);
    }
}

/// What one microphone and its converter do to the sound.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Microphone {
    /// Gain, decibels, -60 to 60; default 0.
    pub gain_db: f64,
    /// How much later than others it delivers what it hears, seconds, within ±1 ms; default 0.
    pub delay_s: f64,
    /// Where its response begins (second-order high-pass, Butterworth), hertz, 1 to 1000; default 40. Besides, it takes
    /// away what image sources alone have: all reflections are positive, which piles up at 0 Hz.
    pub corner_hz: f64,
    /// Level of its own noise (white), decibels relative to full scale, -200 to 0; default -200, which is none.
    pub noise_db: f64,
}

impl Default for Microphone {
    fn default() -> Self {
        Self {
            gain_db: 0.0,
            delay_s: 0.0,
            corner_hz: 40.0,
            noise_db: -200.0,
        }
    }
}

impl Microphone {
    pub(crate) fn check(&self, owner: &str) -> Result<(), AcousticsError> {
        let rules = [
            (
                "gain_db",
                (-60.0..=60.0).contains(&self.gain_db),
                "within -60 and 60",
                self.gain_db,
            ),
            (
                "delay_s",
                (-1e-3..=1e-3).contains(&self.delay_s),
                "within -0.001 and 0.001",
                self.delay_s,
            ),
            (
                "corner_hz",
                (1.0..=1000.0).contains(&self.corner_hz),
                "within 1 and 1000",
                self.corner_hz,
            ),
            (
                "noise_db",
                (-200.0..=0.0).contains(&self.noise_db),
                "within -200 and 0",
                self.noise_db,
            ),
        ];
        for (name, holds, rule, value) in rules {
            check(holds, format!("{name} of {owner}"), rule, value)?;
        }
        Ok(())
    }
}

/// How much the microphones of an array differ: each is drawn uniformly from this far below to this far above.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Mismatch {
    /// Gain, decibels, 0 to 20; default 1.
    pub gain_db: f64,
    /// Delay, seconds, 0 to 0.001; default 5e-6, which is 7 degrees at 4 kHz.
    pub delay_s: f64,
    /// Corner of the high-pass, a share of it, 0 to 0.9; default 0.2, which is up to 8 degrees at 100 Hz.
    pub corner_share: f64,
}

impl Default for Mismatch {
    fn default() -> Self {
        Self {
            gain_db: 1.0,
            delay_s: 5e-6,
            corner_share: 0.2,
        }
    }
}

impl Mismatch {
    /// Microphones all like each other.
    pub const NONE: Self = Self {
        gain_db: 0.0,
        delay_s: 0.0,
        corner_share: 0.0,
    };

    /// As many microphones as asked for around `usual`, always the same for one seed.
    ///
    /// # Errors
    /// [`AcousticsError::Setting`] where a spread or what may come of it is out of range.
    pub fn draw(
        &self,
        usual: &Microphone,
        count: usize,
        seed: u64,
    ) -> Result<Vec<Microphone>, AcousticsError> {
        let rules = [
            (
                "mismatch.gain_db",
                (0.0..=20.0).contains(&self.gain_db),
                "within 0 and 20",
                self.gain_db,
            ),
            (
                "mismatch.delay_s",
                (0.0..=1e-3).contains(&self.delay_s),
                "within 0 and 0.001",
                self.delay_s,
            ),
            (
                "mismatch.corner_share",
                (0.0..=0.9).contains(&self.corner_share),
                "within 0 and 0.9",
                self.corner_share,
            ),
        ];
        for (name, holds, rule, value) in rules {
            check(holds, name, rule, value)?;
        }
        let draw = |number: usize| {
            let mut random = generator(seed, "microphone", number as u64);
            let mut spread = |width: f64| between(&mut random, -width, width);
            let microphone = Microphone {
                gain_db: usual.gain_db + spread(self.gain_db),
                delay_s: usual.delay_s + spread(self.delay_s),
                corner_hz: usual.corner_hz * (1.0 + spread(self.corner_share)),
                noise_db: usual.noise_db,
            };
            microphone.check(&format!("microphone {number}"))?;
            Ok(microphone)
        };
        (0..count).map(draw).collect()
    }
}

/// The clock of a device: its sample n is taken at offset + n / (rate (1 + drift)) seconds of the scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DeviceClock {
    /// When it takes its first sample, seconds, within ±100000; default 0.
    pub offset_s: f64,
    /// How much too fast it runs, parts per million, within ±1000; default 0.
    pub drift_ppm: f64,
}

impl DeviceClock {
    /// When sample `sample` is taken, seconds of the scenario, at a nominal rate of `rate_hz`.
    pub fn time_s(&self, sample: i64, rate_hz: u32) -> f64 {
        self.offset_s + sample as f64 / (f64::from(rate_hz) * (1.0 + self.drift_ppm * 1e-6))
    }

    pub(crate) fn check(&self) -> Result<(), AcousticsError> {
        let (offset, drift) = (self.offset_s, self.drift_ppm);
        check(
            offset.abs() <= 1e5,
            "clock.offset_s",
            "within -100000 and 100000",
            offset,
        )?;
        check(
            drift.abs() <= 1000.0,
            "clock.drift_ppm",
            "within -1000 and 1000",
            drift,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn microphones_differ_within_bounds_and_repeat() {
        let usual = Microphone::default();
        let drawn = Mismatch::default().draw(&usual, 200, 3).unwrap();
        assert_eq!(drawn, Mismatch::default().draw(&usual, 200, 3).unwrap());
        assert!(
            drawn
                .iter()
                .all(|one| one.gain_db.abs() <= 1.0 && one.delay_s.abs() <= 5e-6)
        );
        let largest = drawn.iter().map(|one| one.gain_db).fold(f64::MIN, f64::max);
        assert!(largest > 0.9);
        assert!(
            Mismatch::NONE
                .draw(&usual, 3, 1)
                .unwrap()
                .iter()
                .all(|one| *one == usual)
        );
        let bad = Mismatch {
            gain_db: f64::NAN,
            ..Mismatch::default()
        };
        assert!(
            bad.draw(&usual, 1, 0)
                .unwrap_err()
                .to_string()
                .contains("mismatch.gain_db")
        );
    }

    #[test]
    fn a_fast_clock_takes_its_samples_early() {
        let clock = DeviceClock {
            offset_s: 0.5,
            drift_ppm: 20.0,
        };
        // An hour of samples is taken 72 ms before the hour is over.
        let late = clock.time_s(16_000 * 3600, 16_000) - 0.5;
        assert!((3600.0 - late - 0.072).abs() < 1e-5);
    }
}
