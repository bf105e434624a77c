//! One curve from several bands: peaks that the bands agree on stay, those of a single band shrink.
//!
//! Bregonzio, Taj and Cavallaro, section 2.2: "A peak is retained if it is simultaneously located in the same position in
//! the three GCCs. Peaks that appear in a single band only are reduced proportional to the weight associated." Their
//! equation 7 does not say so; here R(tau) = c(tau) * sum_i w_i R_i(tau) with the agreement c(tau) = sum_i w_i c_i(tau)
//! (corrected). c_i is 1 at the highest local maximum of band i, lower at its lower ones in proportion to their height,
//! and falls off around each as a Gaussian whose width is that of a peak of the band: a sum over hard windows would leave
//! steps in what particles take for a likelihood.

use crate::bands::BandBank;
use crate::curve::CorrelationCurve;
use crate::error::{AudioError, check_setting, check_shape};
use serde::{Deserialize, Serialize};

/// How near is the same position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AgreementSettings {
    /// Standard deviation of the fall-off around a maximum, as a share of the peak width of its band (the inverse of
    /// the bandwidth); above 0, default 0.25, which for the three bands at 12 kHz is 1.25 to 2 samples. Raising it lets
    /// maxima farther apart count as the same.
    pub tolerance: f64,
    /// The least share of the combined curve that is left where no band has a maximum, 0 to 1; default 0.
    pub floor: f32,
}

impl Default for AgreementSettings {
    fn default() -> Self {
        Self {
            tolerance: 0.25,
            floor: 0.0,
        }
    }
}

/// Combines the curves of a bank of bands.
#[derive(Clone, Debug)]
pub struct Agreement {
    settings: AgreementSettings,
    support: Vec<f32>,
    agreement: Vec<f32>,
}

impl Agreement {
    /// A combiner.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where a setting is out of its range.
    pub fn new(settings: AgreementSettings) -> Result<Self, AudioError> {
        let tolerance = settings.tolerance;
        check_setting(
            tolerance > 0.0 && tolerance.is_finite(),
            "tolerance",
            "above 0",
            tolerance,
        )?;
        check_setting(
            (0.0..=1.0).contains(&settings.floor),
            "floor",
            "within 0 and 1",
            settings.floor.into(),
        )?;
        Ok(Self {
            settings,
            support: Vec::new(),
            agreement: Vec::new(),
        })
    }

    /// Combines the curves of the bank's last correlation. Where the bands' curves are normalized by magnitude, so is the
    /// result: 1 where all bands agree on one delay and nothing else is heard.
    ///
    /// # Errors
    /// [`AudioError::Shape`] where the curves are of unequal lengths, as before the first correlation.
    pub fn combine(&mut self, bank: &BandBank, combined: &mut CorrelationCurve) -> Result<(), AudioError> {
        let Some(model) = bank.curves().first() else {
            return Ok(());
        };
        let count = model.values.len();
        check_setting(count > 0, "curves", "correlated before they are combined", 0.0)?;
        combined.reset(model.step_s, count / 2);
        self.agreement.clear();
        self.agreement.resize(count, 0.0);
        for (index, (band, curve)) in bank.bands().iter().zip(bank.curves()).enumerate() {
            check_shape("values of a band's curve", count, curve.values.len())?;
            let width = self.settings.tolerance * bank.peak_width_s(index) / curve.step_s;
            self.find_support(curve, width);
            for k in 0..count {
                combined.values[k] += band.weight * curve.values[k];
                self.agreement[k] += band.weight * self.support[k];
            }
        }
        let floor = self.settings.floor;
        for (value, &agreement) in combined.values.iter_mut().zip(&self.agreement) {
            *value *= floor + (1.0 - floor) * agreement.min(1.0);
        }
        Ok(())
    }

    /// The agreement c(tau) of the last combination at each delay of its curve, 0 to 1.
    pub fn agreement(&self) -> &[f32] {
        &self.agreement
    }

    /// How much a band's maxima support each delay, 0 to 1; `width` is in values of the curve.
    fn find_support(&mut self, curve: &CorrelationCurve, width: f64) {
        let count = curve.values.len();
        self.support.clear();
        self.support.resize(count, 0.0);
        let Some(highest) = curve.peak().filter(|peak| peak.value > 0.0) else {
            return;
        };
        let reach = (4.0 * width).ceil() as usize;
        for index in curve.maxima().filter(|&index| curve.values[index] > 0.0) {
            let top = curve.refine(index);
            let place = top.delay_s / curve.step_s + (count / 2) as f64;
            let height = (top.value / highest.value).min(1.0);
            for k in index.saturating_sub(reach)..(index + reach + 1).min(count) {
                let distance = (k as f64 - place) / width;
                let support = height * (-0.5 * distance * distance).exp() as f32;
                self.support[k] = self.support[k].max(support);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Complex;
    use crate::bands::{BandShape, THREE_BANDS};
    use crate::correlation::{Correlator, CorrelatorSettings};
    use std::f64::consts::TAU;

    const RATE: u32 = 12_000;
    const LENGTH: usize = 1024;

    /// Spectra of white sound whose delay in seconds depends on the frequency.
    fn spectra(delay_s: impl Fn(f64) -> f64) -> [Vec<Complex>; 2] {
        let bins = 0..=LENGTH / 2;
        let first = bins.clone().map(|k| {
            let hertz = k as f64 * f64::from(RATE) / LENGTH as f64;
            Complex::from_polar(1.0, -(TAU * hertz * delay_s(hertz)) as f32)
        });
        [first.collect(), bins.map(|_| Complex::new(1.0, 0.0)).collect()]
    }

    fn combine(delay_s: impl Fn(f64) -> f64, settings: AgreementSettings) -> (CorrelationCurve, Agreement) {
        let mut bank = BandBank::new(&THREE_BANDS, BandShape::Filter, RATE, LENGTH).unwrap();
        let mut correlator = Correlator::new(CorrelatorSettings::new(LENGTH, RATE, 0.0028)).unwrap();
        let mut agreement = Agreement::new(settings).unwrap();
        let [first, second] = spectra(delay_s);
        bank.correlate(&mut correlator, &first, &second, None).unwrap();
        let mut combined = CorrelationCurve::default();
        agreement.combine(&bank, &mut combined).unwrap();
        (combined, agreement)
    }

    #[test]
    fn bands_that_agree_keep_their_peak_whole() {
        let (combined, _) = combine(|_| 0.00123, AgreementSettings::default());
        let peak = combined.peak().unwrap();
        assert!((peak.delay_s - 0.00123).abs() * f64::from(RATE) < 0.01);
        assert!((peak.value - 1.0).abs() < 0.01);
    }

    #[test]
    fn a_delay_of_one_band_alone_shrinks_with_its_weight() {
        // The lowest band, of half the weight, hears a hum from elsewhere.
        let (combined, agreement) = combine(
            |hertz| if hertz < 1500.0 { -0.001 } else { 0.001 },
            AgreementSettings::default(),
        );
        let index = |delay_s: f64| {
            ((delay_s / combined.step_s).round() + (combined.values.len() / 2) as f64) as usize
        };
        assert!((agreement.agreement()[index(-0.001)] - 0.5).abs() < 0.1);
        let (alone, both) = (combined.at(-0.001), combined.at(0.001));
        assert!(
            (0.15..0.35).contains(&alone) && (0.15..0.35).contains(&both),
            "{alone} {both}"
        );
        let plain = AgreementSettings {
            floor: 1.0,
            ..AgreementSettings::default()
        };
        let (sum, _) = combine(|hertz| if hertz < 1500.0 { -0.001 } else { 0.001 }, plain);
        assert!((sum.at(-0.001) - 0.5).abs() < 0.05);
    }

    #[test]
    fn the_combined_curve_has_no_steps() {
        let (combined, _) = combine(
            |hertz| if hertz < 3600.0 { 0.0004 } else { -0.002 },
            AgreementSettings::default(),
        );
        let steepest = combined
            .values
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).abs())
            .fold(0.0, f32::max);
        // Eight values a sample: even the sharpest peak takes several values to rise.
        assert!(steepest < 0.2 * combined.maximum(), "{steepest}");
    }
}
