//! The short-time Fourier transform of one frame: window, zero-padding, transform, with plans and buffers kept.
//!
//! Channels are transformed once and every pair shares the result.

use crate::Complex;
use crate::error::{AudioError, check_setting, check_shape};
use realfft::{RealFftPlanner, RealToComplex};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

/// The taper laid over a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Window {
    /// Raised cosine to zero: the default, with the fastest falling side lobes.
    #[default]
    Hann,
    /// Raised cosine to 0.08.
    Hamming,
    /// No taper.
    Rectangular,
}

impl Window {
    /// The `length` coefficients, 0 to 1, periodic (as for a transform, not as for filter design).
    pub fn coefficients(self, length: usize) -> Vec<f32> {
        let cosine = |k: usize| (TAU * k as f64 / length as f64).cos();
        (0..length)
            .map(|k| match self {
                Self::Hann => (0.5 - 0.5 * cosine(k)) as f32,
                Self::Hamming => (0.54 - 0.46 * cosine(k)) as f32,
                Self::Rectangular => 1.0,
            })
            .collect()
    }
}

/// The spectra of all channels of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spectra {
    /// Channels x (transform length / 2 + 1), unscaled: a constant c gives c times the sum of the window at bin 0.
    pub channels: Vec<Vec<Complex>>,
    /// Samples of the frame that were not finite and were taken as zero, all channels together.
    pub non_finite: usize,
}

/// Transforms frames of one length. Holds plan, window and scratch; saves nothing from frame to frame.
pub struct SpectrumAnalyzer {
    window: Vec<f32>,
    window_energy: f32,
    plan: Arc<dyn RealToComplex<f32>>,
    input: Vec<f32>,
    scratch: Vec<Complex>,
}

impl SpectrumAnalyzer {
    /// An analyzer for frames of `length` samples, zero-padded to `transform_length`.
    ///
    /// For a linear (not circular) correlation the transform must be at least as long as the frame and the greatest
    /// lag together: see [`transform_length`].
    ///
    /// # Errors
    /// [`AudioError::Setting`] where the frame is empty or longer than the transform, or the transform is odd.
    pub fn new(length: usize, transform_length: usize, window: Window) -> Result<Self, AudioError> {
        check_setting(length > 0, "length", "above 0", length as f64)?;
        let fits = transform_length >= length && transform_length.is_multiple_of(2);
        check_setting(
            fits,
            "transform_length",
            "even and not below the length",
            transform_length as f64,
        )?;
        let plan = RealFftPlanner::new().plan_fft_forward(transform_length);
        let window = window.coefficients(length);
        Ok(Self {
            window_energy: window.iter().map(|w| w * w).sum(),
            window,
            input: plan.make_input_vec(),
            scratch: plan.make_scratch_vec(),
            plan,
        })
    }

    /// Samples a frame.
    pub fn length(&self) -> usize {
        self.window.len()
    }

    /// Samples of the zero-padded transform.
    pub fn transform_length(&self) -> usize {
        self.input.len()
    }

    /// Bins of a spectrum: half the transform length and one.
    pub fn bins(&self) -> usize {
        self.input.len() / 2 + 1
    }

    /// The sum of squares of the window: white noise of power p has the expectation `p * window_energy` in each |X|².
    pub fn window_energy(&self) -> f32 {
        self.window_energy
    }

    /// Transforms one channel into `output` (resized to [`Self::bins`]) and returns how many samples were not finite
    /// and were taken as zero.
    ///
    /// # Errors
    /// [`AudioError::Shape`] where `samples` is not one frame long.
    pub fn transform(&mut self, samples: &[f32], output: &mut Vec<Complex>) -> Result<usize, AudioError> {
        check_shape("samples of a frame", self.window.len(), samples.len())?;
        let (used, padding) = self.input.split_at_mut(samples.len());
        for ((value, &sample), &weight) in used.iter_mut().zip(samples).zip(&self.window) {
            *value = sample * weight;
        }
        padding.fill(0.0);
        let mut non_finite = 0;
        // A pass without branches tells whether any sample is bad; only then is each looked at.
        if !used.iter().fold(true, |all, value| all & value.is_finite()) {
            for value in used.iter_mut().filter(|value| !value.is_finite()) {
                *value = 0.0;
                non_finite += 1;
            }
        }
        output.resize(self.input.len() / 2 + 1, Complex::default());
        self.plan
            .process_with_scratch(&mut self.input, output, &mut self.scratch)?;
        Ok(non_finite)
    }

    /// Transforms every channel of a frame into `spectra`.
    ///
    /// # Errors
    /// [`AudioError::Shape`] where a channel is not one frame long.
    pub fn transform_all(&mut self, channels: &[Vec<f32>], spectra: &mut Spectra) -> Result<(), AudioError> {
        spectra.channels.resize_with(channels.len(), Vec::new);
        spectra.non_finite = 0;
        for (samples, output) in channels.iter().zip(&mut spectra.channels) {
            spectra.non_finite += self.transform(samples, output)?;
        }
        Ok(())
    }

    /// The mean square of the frame's samples in a range of bins (see [`bin_range`]): full range over white noise gives
    /// its power, whatever the window.
    pub fn mean_square(&self, spectrum: &[Complex], bins: Range<usize>) -> f32 {
        let last = spectrum.len().saturating_sub(1);
        let end = bins.end.min(spectrum.len());
        let start = bins.start.min(end);
        let mut sum = 2.0 * spectrum[start..end].iter().map(|x| x.norm_sqr()).sum::<f32>();
        for edge in [0, last] {
            if (start..end).contains(&edge) {
                sum -= spectrum[edge].norm_sqr();
            }
        }
        sum / (self.input.len() as f32 * self.window_energy)
    }
}

/// The power |X|² of each bin, into a reused vector.
pub fn power_into(spectrum: &[Complex], power: &mut Vec<f32>) {
    power.clear();
    power.extend(spectrum.iter().map(|x| x.norm_sqr()));
}

/// The bins from `low_hz` up to but not including `high_hz`; at and above half the rate the last bin is included.
pub fn bin_range(low_hz: f64, high_hz: f64, rate_hz: u32, transform_length: usize) -> Range<usize> {
    let bins = transform_length / 2 + 1;
    let bin = |frequency: f64| {
        let place = (frequency * transform_length as f64 / f64::from(rate_hz.max(1)) - 1e-9).ceil();
        (place.max(0.0) as usize).min(bins)
    };
    let end = if high_hz >= 0.5 * f64::from(rate_hz) {
        bins
    } else {
        bin(high_hz)
    };
    bin(low_hz).min(end)..end
}

/// A fast transform length, the least power of two, that keeps lags up to `max_delay_s` free of wrap-around.
pub fn transform_length(frame_length: usize, max_delay_s: f64, rate_hz: u32) -> usize {
    let lags = (max_delay_s.abs() * f64::from(rate_hz)).ceil() as usize + 2;
    (frame_length + lags).next_power_of_two().max(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_samples_are_zero_and_counted() {
        let mut analyzer = SpectrumAnalyzer::new(8, 8, Window::Rectangular).unwrap();
        let (mut clean, mut dirty) = (Vec::new(), Vec::new());
        let mut samples = [0.5, -0.25, 0.0, 0.1, 0.9, 0.0, 0.0, 0.3];
        assert_eq!(analyzer.transform(&samples, &mut clean).unwrap(), 0);
        samples[2] = f32::NAN;
        samples[5] = f32::NEG_INFINITY;
        assert_eq!(analyzer.transform(&samples, &mut dirty).unwrap(), 2);
        assert_eq!(clean, dirty);
        assert!(analyzer.transform(&samples[1..], &mut dirty).is_err());
    }

    #[test]
    fn mean_square_is_that_of_the_samples() {
        let mut analyzer = SpectrumAnalyzer::new(64, 128, Window::Rectangular).unwrap();
        let samples: Vec<f32> = (0..64).map(|k| ((k * k) as f32 * 0.37).sin()).collect();
        let mut spectrum = Vec::new();
        analyzer.transform(&samples, &mut spectrum).unwrap();
        let expected = samples.iter().map(|x| x * x).sum::<f32>() / 64.0;
        let bins = analyzer.bins();
        approx::assert_relative_eq!(analyzer.mean_square(&spectrum, 0..bins), expected, epsilon = 1e-5);
        let parts = analyzer.mean_square(&spectrum, 0..20) + analyzer.mean_square(&spectrum, 20..bins);
        approx::assert_relative_eq!(parts, expected, epsilon = 1e-5);
    }

    #[test]
    fn neighbouring_bands_share_no_bin_and_leave_none_out() {
        assert_eq!(bin_range(0.0, 1500.0, 12_000, 1024), 0..128);
        assert_eq!(bin_range(1500.0, 3600.0, 12_000, 1024), 128..308);
        assert_eq!(bin_range(3600.0, 6000.0, 12_000, 1024), 308..513);
        assert_eq!(bin_range(9000.0, 9500.0, 12_000, 1024), 513..513);
    }
}
