//! How the sound of a room is made for an array.

use super::diffuse::DiffuseNoise;
use super::error::{AcousticsError, check};
use super::measured::MeasuredResponse;
use super::microphones::DeviceClock;

/// How the sound of a room is made.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// Nominal samples a second of the array and of all sounds, 8000 to 192000.
    pub rate_hz: u32,
    /// The array's clock.
    pub clock: DeviceClock,
    /// How late reflections are still followed one by one, seconds of travel, 0.005 to 0.5; default 0.06, and at least
    /// the way across the room. Raising it costs time with its third power.
    pub early_s: f64,
    /// Movement of source and microphones after which late reverberation is renewed, metres, 0.01 to 10; default 0.1.
    pub renew_m: f64,
    /// Late reflections a sample at most, 0.5 to 1000; default 4. Where a room has more, so many are drawn and made as
    /// loud as all. Raising it costs time in proportion.
    pub late_per_sample: f64,
    /// Length of reverberation, seconds of travel, 0 to 10; by default the longest reverberation time, at most 3.
    pub late_s: Option<f64>,
    /// Noise from everywhere.
    pub noise: Option<DiffuseNoise>,
    /// Measured responses, each instead of the simulated one from its source to its microphone.
    pub measured: Vec<MeasuredResponse>,
    /// What distinguishes the noises of this array from those of others.
    pub seed: u64,
}

impl RenderSettings {
    /// The usual settings at a rate.
    pub fn new(rate_hz: u32) -> Self {
        Self {
            rate_hz,
            clock: DeviceClock::default(),
            early_s: 0.06,
            renew_m: 0.1,
            late_per_sample: 4.0,
            late_s: None,
            noise: None,
            measured: Vec::new(),
            seed: 0,
        }
    }

    pub(crate) fn check(&self) -> Result<(), AcousticsError> {
        check(
            (8000..=192_000).contains(&self.rate_hz),
            "rate_hz of the array",
            "within 8000 and 192000",
            f64::from(self.rate_hz),
        )?;
        self.clock.check()?;
        let late_s = self.late_s.unwrap_or(0.0);
        let rules = [
            (
                "early_s",
                (0.005..=0.5).contains(&self.early_s),
                "within 0.005 and 0.5",
                self.early_s,
            ),
            (
                "renew_m",
                (0.01..=10.0).contains(&self.renew_m),
                "within 0.01 and 10",
                self.renew_m,
            ),
            (
                "late_per_sample",
                (0.5..=1000.0).contains(&self.late_per_sample),
                "within 0.5 and 1000",
                self.late_per_sample,
            ),
            (
                "late_s",
                (0.0..=10.0).contains(&late_s),
                "within 0 and 10",
                late_s,
            ),
        ];
        for (name, holds, rule, value) in rules {
            check(holds, name, rule, value)?;
        }
        self.noise.as_ref().map_or(Ok(()), DiffuseNoise::check)
    }
}
