//! Generalized cross-correlation of a pair from the spectra of its channels.
//!
//! Forward transforms are made once a channel (see [`crate::spectrum`]); here each pair costs one weighting and one
//! inverse transform, zero-padded so that the curve comes out finer than the samples.

use crate::Complex;
use crate::curve::CorrelationCurve;
use crate::error::{AudioError, check_setting, check_shape};
use crate::weighting::{PairAverage, PairNoise, Weighting};
use realfft::{ComplexToReal, RealFftPlanner};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What the values of a curve mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Normalization {
    /// As it comes out of the inverse transform.
    None,
    /// Divided by the sum of all weighted magnitudes: 1 where all frequencies agree on one delay, at most 1 in
    /// magnitude. The default.
    #[default]
    Magnitude,
    /// Divided by the root of the product of both weighted powers: for the plain weighting, the correlation
    /// coefficient; at most 1 in magnitude.
    Coefficient,
    /// Divided by its highest value, negative values set to 0: 0 to 1. Says nothing of how sure the peak is.
    Peak,
}

/// How pairs are correlated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CorrelatorSettings {
    /// Length of the forward transforms, even.
    pub transform_length: usize,
    /// Samples a second.
    pub rate_hz: u32,
    /// The greatest delay of interest in seconds: distance of the microphones over the speed of sound.
    pub max_delay_s: f64,
    /// Values of the curve a sample, 1 to 64; default 8. Raising it costs time in proportion.
    pub interpolation: usize,
    /// How much each frequency counts.
    pub weighting: Weighting,
    /// What the values mean.
    pub normalization: Normalization,
}

impl CorrelatorSettings {
    /// The phase transform, eight values a sample, normalized by magnitude.
    pub fn new(transform_length: usize, rate_hz: u32, max_delay_s: f64) -> Self {
        Self {
            transform_length,
            rate_hz,
            max_delay_s,
            interpolation: 8,
            weighting: Weighting::default(),
            normalization: Normalization::default(),
        }
    }
}

/// Correlates pairs of spectra. Holds plan and scratch; saves nothing from pair to pair.
pub struct Correlator {
    settings: CorrelatorSettings,
    half: usize,
    plan: Arc<dyn ComplexToReal<f32>>,
    weighted: Vec<Complex>,
    lags: Vec<f32>,
    scratch: Vec<Complex>,
}

impl Correlator {
    /// A correlator.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where a setting is out of its range, or the transform is too short for the delays.
    pub fn new(settings: CorrelatorSettings) -> Result<Self, AudioError> {
        let CorrelatorSettings {
            transform_length,
            rate_hz,
            max_delay_s,
            interpolation,
            weighting,
            ..
        } = settings;
        let even = transform_length >= 2 && transform_length.is_multiple_of(2);
        check_setting(
            even,
            "transform_length",
            "even and above 0",
            transform_length as f64,
        )?;
        check_setting(rate_hz > 0, "rate_hz", "above 0", f64::from(rate_hz))?;
        let factor = interpolation as f64;
        check_setting(
            (1..=64).contains(&interpolation),
            "interpolation",
            "within 1 and 64",
            factor,
        )?;
        weighting.check()?;
        // Two values more than the delays need, so that a peak at the very end is a peak and can be interpolated.
        let half = (max_delay_s * f64::from(rate_hz) * factor).ceil() + 2.0;
        let fits = max_delay_s >= 0.0 && half < 0.5 * transform_length as f64 * factor;
        check_setting(
            fits,
            "max_delay_s",
            "positive and below half the transform",
            max_delay_s,
        )?;
        let plan = RealFftPlanner::new().plan_fft_inverse(transform_length * interpolation);
        Ok(Self {
            settings,
            half: half as usize,
            weighted: plan.make_input_vec(),
            lags: plan.make_output_vec(),
            scratch: plan.make_scratch_vec(),
            plan,
        })
    }

    /// The settings it was made with.
    pub fn settings(&self) -> &CorrelatorSettings {
        &self.settings
    }

    /// The correlation of one frame of the pair (i, j): `first` is the spectrum of i, `second` that of j.
    ///
    /// `emphasis` multiplies the weight of each bin (0 leaves it out), as the bands do. The curve covers the greatest
    /// delay on both sides and two values more.
    ///
    /// # Errors
    /// [`AudioError::Shape`] where a slice does not have one value a bin; [`AudioError::NoiseMissing`] where the weighting
    /// needs `noise`.
    pub fn correlate(
        &mut self,
        first: &[Complex],
        second: &[Complex],
        noise: Option<PairNoise<'_>>,
        emphasis: Option<&[f32]>,
        curve: &mut CorrelationCurve,
    ) -> Result<(), AudioError> {
        let bins = self.settings.transform_length / 2 + 1;
        check_shape("bins of the first spectrum", bins, first.len())?;
        check_shape("bins of the second spectrum", bins, second.len())?;
        let coefficient = self.settings.normalization == Normalization::Coefficient;
        if self.settings.weighting == Weighting::Phat && !coefficient {
            self.whiten(first, second, noise.and_then(|noise| noise.cross), emphasis)?;
            return self.invert([0.0; 2], curve);
        }
        let pair = |k: usize| {
            let (x, y) = (first[k], second[k]);
            (x * y.conj(), [x.norm_sqr(), y.norm_sqr()])
        };
        let powers = self.weigh(pair, noise, emphasis)?;
        self.invert(powers, curve)
    }

    /// The correlation of a pair averaged over frames; otherwise as [`Self::correlate`]. An average without any frame
    /// gives a curve of zeros.
    ///
    /// # Errors
    /// As [`Self::correlate`].
    pub fn correlate_average(
        &mut self,
        average: &PairAverage,
        noise: Option<PairNoise<'_>>,
        emphasis: Option<&[f32]>,
        curve: &mut CorrelationCurve,
    ) -> Result<(), AudioError> {
        if average.cross.is_empty() {
            curve.reset(self.step_s(), self.half);
            return Ok(());
        }
        check_shape(
            "bins of the average",
            self.settings.transform_length / 2 + 1,
            average.cross.len(),
        )?;
        let pair = |k: usize| {
            (
                Complex::new(average.cross[k][0], average.cross[k][1]),
                average.powers[k],
            )
        };
        let powers = self.weigh(pair, noise, emphasis)?;
        self.invert(powers, curve)
    }

    /// The phase transform of one frame: the usual case, without anything that the general one must look up.
    fn whiten(
        &mut self,
        first: &[Complex],
        second: &[Complex],
        noise: Option<&[Complex]>,
        emphasis: Option<&[f32]>,
    ) -> Result<(), AudioError> {
        for ((weighted, x), y) in self.weighted.iter_mut().zip(first).zip(second) {
            let (re, im) = (x.re * y.re + x.im * y.im, x.im * y.re - x.re * y.im);
            let power = re * re + im * im;
            let scale = if power > f32::MIN_POSITIVE {
                power.sqrt().recip()
            } else {
                0.0
            };
            *weighted = Complex::new(re * scale, im * scale);
        }
        if let Some(noise) = noise {
            check_shape("bins of the noise of the pair", first.len(), noise.len())?;
            for (weighted, noise) in self.weighted.iter_mut().zip(noise) {
                // Where a channel is silent there is nothing that noise could have added to.
                if weighted.norm_sqr() > 0.0 {
                    *weighted -= noise;
                }
            }
        }
        if let Some(emphasis) = emphasis {
            check_shape("bins of the emphasis", first.len(), emphasis.len())?;
            for (weighted, &emphasis) in self.weighted.iter_mut().zip(emphasis) {
                *weighted *= emphasis;
            }
        }
        Ok(())
    }

    /// Any weighting. Returns the weighted powers of both channels where normalization needs them.
    fn weigh(
        &mut self,
        pair: impl Fn(usize) -> (Complex, [f32; 2]),
        noise: Option<PairNoise<'_>>,
        emphasis: Option<&[f32]>,
    ) -> Result<[f32; 2], AudioError> {
        let weighting = self.settings.weighting;
        let bins = self.settings.transform_length / 2 + 1;
        if weighting.needs_noise() && noise.is_none() {
            return Err(AudioError::NoiseMissing);
        }
        if let Some(noise) = noise {
            check_shape("bins of the noise of the first channel", bins, noise.first.len())?;
            check_shape(
                "bins of the noise of the second channel",
                bins,
                noise.second.len(),
            )?;
            if let Some(cross) = noise.cross {
                check_shape("bins of the noise of the pair", bins, cross.len())?;
            }
        }
        if let Some(emphasis) = emphasis {
            check_shape("bins of the emphasis", bins, emphasis.len())?;
        }
        let summed = self.settings.normalization == Normalization::Coefficient;
        let mut sums = [0.0; 2];
        for k in 0..bins {
            let emphasis = emphasis.map_or(1.0, |emphasis| emphasis[k]);
            if emphasis == 0.0 {
                self.weighted[k] = Complex::default();
                continue;
            }
            let (mut cross, powers) = pair(k);
            let noises = noise.map_or([0.0; 2], |noise| [noise.first[k], noise.second[k]]);
            let magnitude = cross.norm_sqr().sqrt();
            let weight = emphasis * weighting.weight(magnitude, powers, noises);
            if let Some(noise) = noise.and_then(|noise| noise.cross) {
                cross -= noise[k] * magnitude;
            }
            self.weighted[k] = cross * weight;
            if summed {
                let count = if k == 0 || k + 1 == bins {
                    weight
                } else {
                    2.0 * weight
                };
                sums[0] += count * powers[0];
                sums[1] += count * powers[1];
            }
        }
        Ok(sums)
    }

    fn step_s(&self) -> f64 {
        1.0 / (f64::from(self.settings.rate_hz) * self.settings.interpolation as f64)
    }

    /// Twice the sum of the weighted magnitudes but for the ends: that of the full spectrum.
    fn total_magnitude(&self) -> f32 {
        let bins = &self.weighted[..self.settings.transform_length / 2 + 1];
        let magnitude = |x: &Complex| x.norm_sqr().sqrt();
        // Eight partial sums of fixed order: fast, and the same on every machine.
        let mut partial = [0.0_f32; 8];
        let chunks = bins.chunks_exact(8);
        let rest: f32 = chunks.remainder().iter().map(magnitude).sum();
        for chunk in chunks {
            for k in 0..8 {
                partial[k] += magnitude(&chunk[k]);
            }
        }
        let ends = magnitude(&bins[0]) + magnitude(&bins[bins.len() - 1]);
        2.0 * (partial.iter().sum::<f32>() + rest) - ends
    }

    fn invert(&mut self, powers: [f32; 2], curve: &mut CorrelationCurve) -> Result<(), AudioError> {
        let bins = self.settings.transform_length / 2 + 1;
        let total = match self.settings.normalization {
            Normalization::Magnitude => self.total_magnitude(),
            _ => 0.0,
        };
        if self.settings.interpolation > 1 {
            // Half of the last bin belongs to the negative frequencies, which zero-padding moves away from it.
            self.weighted[bins - 1] *= 0.5;
            self.weighted[bins..].fill(Complex::default());
        }
        // The ends of the spectrum of a real signal are real; rounding must not make the transform refuse them.
        self.weighted[0].im = 0.0;
        if let Some(last) = self.weighted.last_mut() {
            last.im = 0.0;
        }
        self.plan
            .process_with_scratch(&mut self.weighted, &mut self.lags, &mut self.scratch)?;
        curve.reset(self.step_s(), self.half);
        let wrapped = self.lags.len() - self.half;
        curve.values[..self.half].copy_from_slice(&self.lags[wrapped..]);
        curve.values[self.half..].copy_from_slice(&self.lags[..=self.half]);
        match self.settings.normalization {
            Normalization::None => curve.divide(self.settings.transform_length as f32),
            Normalization::Magnitude => curve.divide(total),
            Normalization::Coefficient => curve.divide((powers[0] * powers[1]).sqrt()),
            Normalization::Peak => curve.normalize_to_peak(),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
