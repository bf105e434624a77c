//! The noise floor of a channel by minimum statistics: speech has pauses, so the least power of the last few seconds is
//! that of the noise, but for a known bias (Martin, "Noise power spectral density estimation based on optimal smoothing
//! and minimum statistics", 2001).
//!
//! The same tracker follows the power of a whole frame (one bin) or of each bin of a spectrum.

use crate::error::{AudioError, MOST_COUNTED, check_setting, check_shape, check_state};
use multiversion::multiversion;
use serde::{Deserialize, Serialize};

/// How the noise floor is followed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NoiseSettings {
    /// Time constant in seconds of the smoothing before the minimum is sought; above 0, default 0.05. Raising it makes
    /// the estimate steadier but misses short pauses.
    pub smoothing_s: f64,
    /// Seconds over which the minimum is sought; above 0, default 3. Raising it bridges longer speech without a pause,
    /// but follows a rising noise later.
    pub window_s: f64,
    /// Seconds from the start during which the floor stays at most at `first_power`; 0 or more, default 1.5. Speech at
    /// once is then still speech; noise that is louder is taken for speech that long.
    pub start_s: f64,
    /// Mean square of the loudest noise believed at the start; above 0, default 1e-5 (-50 dB of full scale).
    pub first_power: f32,
    /// The fastest rise in decibels a second; above 0, default 10. Falls are followed at once.
    pub rise_db_s: f64,
}

impl Default for NoiseSettings {
    fn default() -> Self {
        Self {
            smoothing_s: 0.05,
            window_s: 3.0,
            start_s: 1.5,
            first_power: 1e-5,
            rise_db_s: 10.0,
        }
    }
}

/// The window is sought in this many parts: the oldest part is forgotten as a whole.
const PARTS: usize = 8;
/// Frames below this mean square (-110 dB of full scale) are digital silence, not a quiet room.
const SILENCE: f32 = 1e-11;
/// Share of the window's minimum that correlates, by frames of the window: Martin 2001, table III.
const MINIMUM_MEAN: [(f64, f64); 13] = [
    (1.0, 0.0),
    (2.0, 0.26),
    (5.0, 0.48),
    (8.0, 0.58),
    (10.0, 0.61),
    (15.0, 0.668),
    (20.0, 0.705),
    (30.0, 0.762),
    (40.0, 0.8),
    (60.0, 0.841),
    (80.0, 0.865),
    (120.0, 0.89),
    (160.0, 0.91),
];

/// Follows the noise floor of one channel. Its whole state is serializable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoiseFloor {
    forgetting: f32,
    rise: f32,
    bias: f32,
    /// Mean square of a frame times this is the power of a bin.
    scale: f32,
    first_power: f32,
    start_frames: u64,
    part_frames: u64,
    frames: u64,
    smoothed: Vec<f32>,
    /// Minimum of the current part, then of the parts before; parts x bins.
    minima: Vec<Vec<f32>>,
    floor: Vec<f32>,
}

impl NoiseFloor {
    /// A tracker of the mean square of whole frames of `frame_length` samples, one each `interval_s` seconds.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where a setting is out of its range.
    pub fn of_frames(
        settings: &NoiseSettings,
        interval_s: f64,
        frame_length: usize,
    ) -> Result<Self, AudioError> {
        // Noise is seldom white: an eighth of the samples are taken as independent.
        Self::new(settings, interval_s, 1, 1.0, (frame_length as f64 / 8.0).max(2.0))
    }

    /// A tracker of the power |X|² of each of `bins` bins, one spectrum each `interval_s` seconds; `window_energy` is that
    /// of the analyzer.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where a setting is out of its range.
    pub fn of_spectra(
        settings: &NoiseSettings,
        interval_s: f64,
        bins: usize,
        window_energy: f32,
    ) -> Result<Self, AudioError> {
        Self::new(settings, interval_s, bins, window_energy, 2.0)
    }

    /// A tracker of the mean power |X|² of each of `bands` bands of frequencies, one spectrum each `interval_s` seconds; the
    /// narrowest band has `independent` bins that do not depend on each other, and `window_energy` is that of the analyzer.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where a setting is out of its range.
    pub fn of_bands(
        settings: &NoiseSettings,
        interval_s: f64,
        bands: usize,
        window_energy: f32,
        independent: f64,
    ) -> Result<Self, AudioError> {
        Self::new(
            settings,
            interval_s,
            bands,
            window_energy,
            (2.0 * independent).max(2.0),
        )
    }

    fn new(
        settings: &NoiseSettings,
        interval_s: f64,
        bins: usize,
        scale: f32,
        freedom: f64,
    ) -> Result<Self, AudioError> {
        let NoiseSettings {
            smoothing_s,
            window_s,
            start_s,
            first_power,
            rise_db_s,
        } = *settings;
        for (name, value) in [
            ("interval_s", interval_s),
            ("smoothing_s", smoothing_s),
            ("window_s", window_s),
            ("first_power", f64::from(first_power)),
            ("rise_db_s", rise_db_s),
            ("window_energy", f64::from(scale)),
            ("bins", bins as f64),
        ] {
            check_setting(value > 0.0 && value.is_finite(), name, "above 0", value)?;
        }
        check_setting(start_s >= 0.0, "start_s", "0 or more", start_s)?;
        let forgetting = (-interval_s / smoothing_s).exp();
        let window_frames = (window_s / interval_s).max(1.0);
        Ok(Self {
            forgetting: forgetting as f32,
            rise: 10.0_f64.powf(0.1 * rise_db_s * interval_s) as f32,
            bias: bias(window_frames, freedom * (1.0 + forgetting) / (1.0 - forgetting)) as f32,
            scale,
            first_power: first_power * scale,
            start_frames: (start_s / interval_s).round() as u64,
            part_frames: (window_frames / PARTS as f64).ceil() as u64,
            frames: 0,
            smoothed: vec![0.0; bins],
            minima: vec![vec![f32::MAX; bins]; PARTS],
            floor: vec![first_power * scale; bins],
        })
    }

    /// Checks a tracker that was saved: whether this one could have become it.
    ///
    /// # Errors
    /// [`AudioError::State`] or [`AudioError::Shape`] where it is of other settings or contradicts itself.
    pub fn check_saved(&self, saved: &Self) -> Result<(), AudioError> {
        let settings = |floor: &Self| {
            let numbers = [
                floor.forgetting,
                floor.rise,
                floor.bias,
                floor.scale,
                floor.first_power,
            ];
            (numbers, floor.start_frames, floor.part_frames)
        };
        check_state(
            settings(saved) == settings(self),
            "the settings of the noise floor",
        )?;
        check_state(saved.frames <= MOST_COUNTED, "the number of frames")?;
        check_shape(
            "parts of a saved noise floor",
            self.minima.len(),
            saved.minima.len(),
        )?;
        for powers in saved.minima.iter().chain([&saved.smoothed, &saved.floor]) {
            check_shape("bins of a saved noise floor", self.floor.len(), powers.len())?;
            let real = powers.iter().all(|&power| power >= 0.0 && power.is_finite());
            check_state(real, "the powers of a noise floor")?;
        }
        Ok(())
    }

    /// The noise power of each bin. Before the first frame it is the greatest believed.
    pub fn power(&self) -> &[f32] {
        &self.floor
    }

    /// The noise power of a tracker of whole frames.
    pub fn mean_square(&self) -> f32 {
        self.floor.first().copied().unwrap_or(0.0)
    }

    /// How far `power` is above the floor of a tracker of whole frames, in decibels, -100 to 200.
    pub fn snr_db(&self, power: f32) -> f32 {
        let ratio = power / self.mean_square().max(f32::MIN_POSITIVE);
        if ratio.is_nan() {
            -100.0
        } else {
            (10.0 * ratio.log10()).clamp(-100.0, 200.0)
        }
    }

    /// Takes in the power of one frame: its mean square, or |X|² of each bin. Frames of digital silence and values that
    /// are not finite change nothing; frames with samples filled in should not be given.
    ///
    /// # Errors
    /// [`AudioError::Shape`] where there is not one value a bin.
    pub fn observe(&mut self, power: &[f32]) -> Result<(), AudioError> {
        check_shape("powers of a frame", self.floor.len(), power.len())?;
        let finite = power.iter().fold(true, |all, value| all & value.is_finite());
        let silence = SILENCE * self.scale;
        if !finite || !power.iter().any(|&value| value > silence) {
            return Ok(());
        }
        if self.frames > 0 && self.frames.is_multiple_of(self.part_frames) {
            self.minima.rotate_right(1);
            self.minima[0].copy_from_slice(&self.smoothed);
        }
        let forgetting = if self.frames == 0 { 0.0 } else { self.forgetting };
        let starting = self.frames < self.start_frames;
        let limits = Limits {
            forgetting,
            silence,
            bias: self.bias,
            most: if starting { self.first_power } else { f32::MAX },
            rise: if self.frames == 0 { f32::MAX } else { self.rise },
        };
        follow(
            power,
            &limits,
            &mut self.smoothed,
            &mut self.minima,
            &mut self.floor,
        );
        self.frames += 1;
        Ok(())
    }
}

/// What bins have in common while a frame is taken in.
struct Limits {
    forgetting: f32,
    silence: f32,
    bias: f32,
    most: f32,
    rise: f32,
}

/// Bins that are followed side by side.
const LANES: usize = 32;

/// Takes a frame in: smoothed power, its minimum, and the floor of each bin.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn follow(power: &[f32], limits: &Limits, smoothed: &mut [f32], minima: &mut [Vec<f32>], floor: &mut [f32]) {
    let less = |a: f32, b: f32| if a < b { a } else { b };
    for (first, power) in (0..).step_by(LANES).zip(power.chunks(LANES)) {
        let range = first..first + power.len();
        let mut least = [f32::MAX; LANES];
        for ((value, smoothed), least) in power.iter().zip(&mut smoothed[range.clone()]).zip(&mut least) {
            let value = if *value > limits.silence {
                *value
            } else {
                limits.silence
            };
            *smoothed = limits.forgetting * *smoothed + (1.0 - limits.forgetting) * value;
            *least = *smoothed;
        }
        for (part, minima) in minima.iter_mut().enumerate() {
            let minima = &mut minima[range.clone()];
            for (least, minimum) in least.iter_mut().zip(minima.iter_mut()) {
                *least = less(*minimum, *least);
            }
            if part == 0 {
                minima.copy_from_slice(&least[..power.len()]);
            }
        }
        for (floor, least) in floor[range].iter_mut().zip(least) {
            *floor = less(less(limits.bias * least, limits.most), *floor * limits.rise);
        }
    }
}

/// How much the mean of the noise exceeds the minimum of `frames` smoothed powers with `freedom` degrees of freedom
/// (Martin 2001, equation 17).
fn bias(frames: f64, freedom: f64) -> f64 {
    let above = MINIMUM_MEAN
        .iter()
        .position(|&(count, _)| count >= frames)
        .unwrap_or(MINIMUM_MEAN.len() - 1);
    let (high, high_mean) = MINIMUM_MEAN[above];
    let (low, low_mean) = MINIMUM_MEAN[above.saturating_sub(1)];
    let part = if high > low {
        ((frames - low) / (high - low)).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let mean = low_mean + part * (high_mean - low_mean);
    let freedom = ((freedom - 2.0 * mean) / (1.0 - mean)).max(0.5);
    1.0 + (frames - 1.0) * 2.0 / freedom
}

/// The mean square of samples, those that are not finite taken as zero; 0 of none.
pub fn mean_square(samples: &[f32]) -> f32 {
    let squares = samples.iter().map(|&x| {
        if x.is_finite() {
            f64::from(x) * f64::from(x)
        } else {
            0.0
        }
    });
    (squares.sum::<f64>() / samples.len().max(1) as f64) as f32
}

#[cfg(test)]
mod tests;
