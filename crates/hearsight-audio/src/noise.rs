//! The noise floor of a channel by minimum statistics: speech has pauses, so the least power of the last few seconds is
//! that of the noise, but for a known bias (Martin, "Noise power spectral density estimation based on optimal smoothing
//! and minimum statistics", 2001).
//!
//! The same tracker follows the power of a whole frame (one bin) or of each bin of a spectrum.

use crate::error::{AudioError, check_setting, check_shape};
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
        for (bin, &value) in power.iter().enumerate() {
            let smoothed = forgetting * self.smoothed[bin] + (1.0 - forgetting) * value.max(silence);
            self.smoothed[bin] = smoothed;
            self.minima[0][bin] = self.minima[0][bin].min(smoothed);
            let least = self
                .minima
                .iter()
                .fold(f32::MAX, |least, part| least.min(part[bin]));
            let mut target = self.bias * least;
            if starting {
                target = target.min(self.first_power);
            }
            let floor = &mut self.floor[bin];
            *floor = if self.frames == 0 {
                target
            } else {
                target.min(*floor * self.rise)
            };
        }
        self.frames += 1;
        Ok(())
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
mod tests {
    use super::*;
    use crate::spectrum::{SpectrumAnalyzer, Window, power_into};

    struct White(u64);

    impl White {
        /// Near Gaussian: the sum of twelve uniform numbers, of unit variance.
        fn sample(&mut self) -> f32 {
            let mut uniform = || {
                self.0 = self
                    .0
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (self.0 >> 40) as f32 / (1 << 24) as f32
            };
            (0..12).map(|_| uniform()).sum::<f32>() - 6.0
        }

        fn frame(&mut self, amplitude: f32) -> Vec<f32> {
            (0..640).map(|_| amplitude * self.sample()).collect()
        }
    }

    fn decibels(ratio: f32) -> f32 {
        10.0 * ratio.log10()
    }

    #[test]
    fn the_floor_of_white_noise_is_its_power() {
        let mut white = White(5);
        let settings = NoiseSettings {
            first_power: 1.0,
            ..NoiseSettings::default()
        };
        let mut analyzer = SpectrumAnalyzer::new(640, 1024, Window::Hann).unwrap();
        let mut whole = NoiseFloor::of_frames(&settings, 0.02, 640).unwrap();
        let mut bins = NoiseFloor::of_spectra(&settings, 0.02, 513, analyzer.window_energy()).unwrap();
        let (mut spectrum, mut power) = (Vec::new(), Vec::new());
        let (mut past, mut error_db) = (vec![0.0; 640], 0.0);
        for frame in 0..1000 {
            // Half overlap, as in use.
            past.copy_within(320.., 0);
            past[320..].copy_from_slice(&white.frame(0.01)[..320]);
            whole.observe(&[mean_square(&past)]).unwrap();
            analyzer.transform(&past, &mut spectrum).unwrap();
            power_into(&spectrum, &mut power);
            bins.observe(&power).unwrap();
            if frame >= 500 {
                let mean = bins.power()[1..512].iter().sum::<f32>() / 511.0;
                error_db += decibels(mean / (1e-4 * analyzer.window_energy())) / 500.0;
            }
        }
        let whole_db = decibels(whole.mean_square() / 1e-4);
        println!("bias left: whole {whole_db:.2} dB, bins {error_db:.2} dB");
        assert!(whole_db.abs() < 0.7, "{whole_db}");
        assert!(error_db.abs() < 2.0, "{error_db}");
    }

    #[test]
    fn speech_at_once_is_not_taken_for_noise_and_a_pause_tells() {
        let mut floor = NoiseFloor::of_frames(&NoiseSettings::default(), 0.02, 640).unwrap();
        let mut white = White(9);
        for _ in 0..40 {
            let power = mean_square(&white.frame(0.1));
            floor.observe(&[power]).unwrap();
            assert!(floor.snr_db(power) > 25.0);
        }
        for _ in 0..30 {
            floor.observe(&[mean_square(&white.frame(0.001))]).unwrap();
        }
        assert!(decibels(floor.mean_square() / 1e-6).abs() < 1.5);
        // Two seconds of speech without a pause leave it where it is.
        for _ in 0..100 {
            floor.observe(&[mean_square(&white.frame(0.1))]).unwrap();
        }
        assert!(decibels(floor.mean_square() / 1e-6).abs() < 1.5);
    }

    #[test]
    fn a_louder_noise_is_followed_slowly() {
        let mut floor = NoiseFloor::of_frames(&NoiseSettings::default(), 0.02, 640).unwrap();
        let mut white = White(2);
        let mut last = 0.0;
        for frame in 0..600 {
            let amplitude = if frame < 200 { 0.001 } else { 0.01 };
            floor.observe(&[mean_square(&white.frame(amplitude))]).unwrap();
            if frame > 0 {
                assert!(decibels(floor.mean_square() / last) < 0.21);
            }
            last = floor.mean_square();
        }
        assert!(decibels(last / 1e-4).abs() < 1.0);
    }

    #[test]
    fn silence_bad_values_and_saving_change_nothing() {
        let mut floor = NoiseFloor::of_frames(&NoiseSettings::default(), 0.02, 640).unwrap();
        let mut white = White(1);
        for _ in 0..70 {
            floor.observe(&[mean_square(&white.frame(0.001))]).unwrap();
        }
        let before = floor.clone();
        floor.observe(&[0.0]).unwrap();
        floor.observe(&[f32::NAN]).unwrap();
        assert!(floor.observe(&[1.0, 2.0]).is_err());
        assert_eq!(floor, before);
        let mut restored: NoiseFloor = serde_json::from_str(&serde_json::to_string(&floor).unwrap()).unwrap();
        for _ in 0..200 {
            let power = [mean_square(&white.frame(0.002))];
            floor.observe(&power).unwrap();
            restored.observe(&power).unwrap();
        }
        assert_eq!(floor, restored);
    }
}
