//! Frequency bands: linear-phase filters, and the correlation of a pair in each band.
//!
//! A noise that both microphones hear in one band alone spoils that band's correlation and leaves the others
//! (Bregonzio, Taj and Cavallaro, section 2.2).

use crate::Complex;
use crate::correlation::Correlator;
use crate::curve::CorrelationCurve;
use crate::error::{AudioError, check_setting};
use crate::spectrum::bin_range;
use crate::weighting::PairNoise;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::ops::Range;

/// One band and what it counts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// Where it begins, in hertz.
    pub low_hz: f64,
    /// Where it ends, in hertz; at or above half the rate it is a high-pass.
    pub high_hz: f64,
    /// Its share in the combination, above 0; shares are divided by their sum.
    pub weight: f32,
}

/// The three bands of Bregonzio, Taj and Cavallaro: 0 to 1.5, to 3.6 and to 6 kHz, weights 0.5, 0.3 and 0.2. They are made
/// for sound at 12 kHz, of which the last is a high-pass.
pub const THREE_BANDS: [Band; 3] = [
    Band {
        low_hz: 0.0,
        high_hz: 1500.0,
        weight: 0.5,
    },
    Band {
        low_hz: 1500.0,
        high_hz: 3600.0,
        weight: 0.3,
    },
    Band {
        low_hz: 3600.0,
        high_hz: 6000.0,
        weight: 0.2,
    },
];

/// Order of the band filters: 36, that is 37 taps. The paper's "36 coefficients" of even length could not be the
/// high-pass that the third band needs, since they force a zero at half the rate (corrected).
pub const FILTER_ORDER: usize = 36;

/// The taps of a linear-phase band filter: windowed sinc with a Hamming window, `order + 1` taps, unit gain in the middle
/// of the pass band (at 0 Hz for a low-pass, at half the rate for a high-pass).
///
/// # Errors
/// [`AudioError::Setting`] where the order is odd (type I needs an odd number of taps) or the edges do not rise within 0
/// and half the rate.
pub fn filter_taps(low_hz: f64, high_hz: f64, rate_hz: u32, order: usize) -> Result<Vec<f64>, AudioError> {
    check_setting(
        order >= 2 && order.is_multiple_of(2),
        "order",
        "even and above 0",
        order as f64,
    )?;
    let nyquist = 0.5 * f64::from(rate_hz);
    check_setting(
        low_hz >= 0.0 && low_hz < nyquist,
        "low_hz",
        "within 0 and half the rate",
        low_hz,
    )?;
    check_setting(high_hz > low_hz, "high_hz", "above low_hz", high_hz)?;
    let (low, high) = (low_hz / nyquist, (high_hz / nyquist).min(1.0));
    let middle = order as f64 / 2.0;
    let ideal = |edge: f64, offset: f64| {
        if offset == 0.0 {
            edge
        } else {
            (PI * edge * offset).sin() / (PI * offset)
        }
    };
    let mut taps: Vec<f64> = (0..=order)
        .map(|k| {
            let offset = k as f64 - middle;
            let window = 0.54 - 0.46 * (2.0 * PI * k as f64 / order as f64).cos();
            (ideal(high, offset) - ideal(low, offset)) * window
        })
        .collect();
    let reference = if low == 0.0 {
        0.0
    } else if high == 1.0 {
        1.0
    } else {
        0.5 * (low + high)
    };
    let gain = zero_phase_response(&taps, PI * reference);
    for tap in &mut taps {
        *tap /= gain;
    }
    Ok(taps)
}

/// The real response of symmetric taps of odd number at `angle` radians a sample, their delay taken out.
fn zero_phase_response(taps: &[f64], angle: f64) -> f64 {
    let middle = taps.len() / 2;
    let sides = (1..=middle).map(|k| 2.0 * taps[middle + k] * (angle * k as f64).cos());
    taps[middle] + sides.sum::<f64>()
}

/// What confines a correlation to a band.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BandShape {
    /// The band's own bins alone, all alike: the default. It is what equation 7 of the paper comes to, where filtering
    /// signal and noise alike cancels between numerator and denominator.
    #[default]
    Bins,
    /// The squared response of the 37-tap filter, over its own bins and into those of its neighbours: a smoother curve
    /// with less ringing.
    Filter,
}

/// The bands of a pair's correlation: filters, bins and reused curves.
pub struct BandBank {
    bands: Vec<Band>,
    rate_hz: u32,
    bins: Vec<Range<usize>>,
    emphasis: Vec<Vec<f32>>,
    curves: Vec<CorrelationCurve>,
}

impl BandBank {
    /// A bank of bands for spectra of `transform_length` samples at `rate_hz`.
    ///
    /// The bin at 0 Hz is left out of every band: it is the offset of the converter, alike on all channels.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where there is no band, a band has no bin or no weight, or the edges are out of range.
    pub fn new(
        bands: &[Band],
        shape: BandShape,
        rate_hz: u32,
        transform_length: usize,
    ) -> Result<Self, AudioError> {
        check_setting(!bands.is_empty(), "bands", "at least one", 0.0)?;
        let total: f32 = bands.iter().map(|band| band.weight).sum();
        let mut bank = Self {
            bands: bands.to_vec(),
            rate_hz,
            bins: Vec::new(),
            emphasis: Vec::new(),
            curves: vec![CorrelationCurve::default(); bands.len()],
        };
        for band in &mut bank.bands {
            check_setting(band.weight > 0.0, "weight", "above 0", f64::from(band.weight))?;
            band.weight /= total;
            let taps = filter_taps(band.low_hz, band.high_hz, rate_hz, FILTER_ORDER)?;
            let own = bin_range(band.low_hz, band.high_hz, rate_hz, transform_length);
            check_setting(
                !own.is_empty(),
                "transform_length",
                "long enough for every band",
                own.len() as f64,
            )?;
            let emphasis = (0..transform_length / 2 + 1).map(|k| match shape {
                _ if k == 0 => 0.0,
                BandShape::Bins => f32::from(u8::from(own.contains(&k))),
                BandShape::Filter => {
                    let response =
                        zero_phase_response(&taps, 2.0 * PI * k as f64 / transform_length as f64).powi(2);
                    // What the stop band lets through is below a thousandth: leaving it out saves its weighting.
                    if response < 1e-3 { 0.0 } else { response as f32 }
                }
            });
            bank.emphasis.push(emphasis.collect());
            bank.bins.push(own);
        }
        Ok(bank)
    }

    /// The bands, their weights summing to 1.
    pub fn bands(&self) -> &[Band] {
        &self.bands
    }

    /// The bins of each band; neighbouring bands share none.
    pub fn bins(&self) -> &[Range<usize>] {
        &self.bins
    }

    /// How much each bin counts in each band, 0 to about 1: bands x bins.
    pub fn emphasis(&self) -> &[Vec<f32>] {
        &self.emphasis
    }

    /// The width in seconds of a correlation peak of each band: the inverse of its bandwidth.
    pub fn peak_width_s(&self, band: usize) -> f64 {
        self.bands.get(band).map_or(0.0, |band| {
            let high = band.high_hz.min(0.5 * f64::from(self.rate_hz));
            1.0 / (high - band.low_hz)
        })
    }

    /// The correlation of one frame of the pair (i, j) in each band, one curve a band in their order.
    ///
    /// # Errors
    /// As [`Correlator::correlate`]; the correlator must be for the same rate and transform length.
    pub fn correlate(
        &mut self,
        correlator: &mut Correlator,
        first: &[Complex],
        second: &[Complex],
        noise: Option<PairNoise<'_>>,
    ) -> Result<&[CorrelationCurve], AudioError> {
        for (emphasis, curve) in self.emphasis.iter().zip(&mut self.curves) {
            correlator.correlate(first, second, noise, Some(emphasis), curve)?;
        }
        Ok(&self.curves)
    }

    /// The curves of the last call of [`Self::correlate`].
    pub fn curves(&self) -> &[CorrelationCurve] {
        &self.curves
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_are_symmetric_and_the_third_is_a_high_pass() {
        for (band, pass, stop) in [(0, 200.0, 3000.0), (1, 2500.0, 5500.0), (2, 5990.0, 2000.0)] {
            let Band { low_hz, high_hz, .. } = THREE_BANDS[band];
            let taps = filter_taps(low_hz, high_hz, 12_000, FILTER_ORDER).unwrap();
            assert_eq!(taps.len(), 37);
            for k in 0..18 {
                approx::assert_relative_eq!(taps[k], taps[36 - k], epsilon = 1e-15);
            }
            let response = |hertz: f64| zero_phase_response(&taps, 2.0 * PI * hertz / 12_000.0).abs();
            assert!(
                (response(pass) - 1.0).abs() < 0.01,
                "band {band}: {}",
                response(pass)
            );
            assert!(response(stop) < 0.004, "band {band}: {}", response(stop));
        }
        assert!(filter_taps(0.0, 1500.0, 12_000, 35).is_err());
        assert!(filter_taps(1500.0, 1500.0, 12_000, 36).is_err());
    }

    #[test]
    fn the_bands_share_out_the_whole_spectrum() {
        let bank = BandBank::new(&THREE_BANDS, BandShape::Bins, 12_000, 1024).unwrap();
        for k in 1..513 {
            let sum: f32 = bank.emphasis().iter().map(|emphasis| emphasis[k]).sum();
            assert_eq!(sum, 1.0);
        }
        let weights: f32 = bank.bands().iter().map(|band| band.weight).sum();
        approx::assert_relative_eq!(weights, 1.0);
        approx::assert_relative_eq!(bank.peak_width_s(1), 1.0 / 2100.0);
        assert!(BandBank::new(&[], BandShape::Bins, 12_000, 1024).is_err());
    }
}
