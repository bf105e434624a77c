//! How far what an array hears stands above the noise of its room, in bands, by the newest part of each frame.
//!
//! A frame long enough to find a direction is longer than the gaps between phrases; that somebody speaks is told by the
//! last few hundredths of a second of it.

use hearsight_audio::noise::{NoiseFloor, NoiseSettings};
use hearsight_audio::spectrum::{SpectrumAnalyzer, Window, bin_range};
use hearsight_audio::{AudioError, Complex};
use std::ops::Range;

/// Bands in which voice is told from noise.
const BANDS: usize = 12;

/// Measures the bands of voice; what it learned of the noise is kept outside, in a [`NoiseFloor`].
pub(super) struct VoiceBands {
    analyzer: SpectrumAnalyzer,
    spectrum: Vec<Complex>,
    /// Bins of the bands, and the mean powers in them.
    bands: [Range<usize>; BANDS],
    powers: [f32; BANDS],
}

impl VoiceBands {
    /// Bands of equal ratio between two frequencies in hertz, of the last `length` samples of each frame.
    ///
    /// # Errors
    /// [`AudioError`] where the frequencies are not in order or too close together for bands of their own.
    pub(super) fn new(length: usize, rate_hz: u32, voice_hz: [f64; 2]) -> Result<Self, AudioError> {
        // Twice as long as the window, or the narrowest bands have no bin.
        let transform = (2 * length).next_power_of_two();
        let analyzer = SpectrumAnalyzer::new(length, transform, Window::Hann)?;
        Ok(Self {
            bands: bands(voice_hz, rate_hz, transform)?,
            powers: [0.0; BANDS],
            spectrum: Vec::with_capacity(analyzer.bins()),
            analyzer,
        })
    }

    /// A floor for these bands, one frame each `hop_s` seconds.
    ///
    /// # Errors
    /// [`AudioError`] where a setting is out of its range.
    pub(super) fn floor(&self, settings: &NoiseSettings, hop_s: f64) -> Result<NoiseFloor, AudioError> {
        let narrowest = self.bands.iter().map(Range::len).min().unwrap_or(0) as f64;
        // Zeros that fill the transform add no knowledge, and the window makes neighbours alike.
        let zeros = self.analyzer.transform_length() as f64 / self.analyzer.length() as f64;
        let independent = (narrowest / zeros / 1.5).max(1.0);
        let energy = self.analyzer.window_energy();
        NoiseFloor::of_bands(settings, hop_s, BANDS, energy, independent)
    }

    /// The mean over the bands of the power over that of the noise, all channels together, decibels, each and all within
    /// -100 and 100; the noise is learned where `learns`.
    ///
    /// # Errors
    /// [`AudioError`] where the channels are shorter than the part that is looked at.
    pub(super) fn ratio_db(
        &mut self,
        channels: &[Vec<f32>],
        learns: bool,
        floor: &mut NoiseFloor,
    ) -> Result<f32, AudioError> {
        self.powers.fill(0.0);
        let share = 1.0 / channels.len().max(1) as f32;
        for channel in channels {
            let newest = channel.len().saturating_sub(self.analyzer.length());
            self.analyzer.transform(&channel[newest..], &mut self.spectrum)?;
            for (power, band) in self.powers.iter_mut().zip(&self.bands) {
                let sum: f32 = self.spectrum[band.clone()].iter().map(|bin| bin.norm_sqr()).sum();
                *power += share * sum / band.len() as f32;
            }
        }
        if learns {
            floor.observe(&self.powers)?;
        }
        let ratios = self.powers.iter().zip(floor.power()).map(|(power, noise)| {
            let ratio = power.max(f32::MIN_POSITIVE) / noise.max(f32::MIN_POSITIVE);
            (10.0 * ratio.log10()).clamp(-100.0, 100.0)
        });
        Ok(ratios.sum::<f32>() / BANDS as f32)
    }
}

/// Bins of bands of equal ratio.
fn bands(
    [low_hz, high_hz]: [f64; 2],
    rate_hz: u32,
    transform: usize,
) -> Result<[Range<usize>; BANDS], AudioError> {
    let wrong = AudioError::Setting {
        name: "voice_hz",
        rule: "two frequencies above 0 and far enough apart, the lower one first, below half the rate",
        value: low_hz,
    };
    if !(low_hz > 0.0 && low_hz < high_hz && high_hz.is_finite()) {
        return Err(wrong);
    }
    let high_hz = high_hz.min(0.46 * f64::from(rate_hz));
    let edge = |number: usize| low_hz * (high_hz / low_hz).powf(number as f64 / BANDS as f64);
    let bands = std::array::from_fn(|number| bin_range(edge(number), edge(number + 1), rate_hz, transform));
    if bands.iter().any(Range::is_empty) {
        return Err(wrong);
    }
    Ok(bands)
}
