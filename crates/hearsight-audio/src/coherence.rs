//! Noise that comes from somewhere: the phases of its cross-spectra between microphones.
//!
//! A fan is a source like a talker, and the phase transform makes all frequencies equal: between the sounds of speech it is
//! heard at its own direction. What it adds to the cross-spectrum of a pair is learnt while a frequency holds nothing else,
//! and taken out (after Rui and Florêncio 2003, subtraction of the cross-spectrum of ambient noise, to which Chen and Rui
//! 2004, equation 17, point). Here it is done behind the phase transform: the power of noise scatters from frame to frame,
//! its phases do not.

use crate::Complex;
use crate::error::{AudioError, check_setting, check_shape, check_state};
use serde::{Deserialize, Serialize};

/// A frequency whose power is below this many times that of the noise holds nothing but noise.
const NOISE_ALONE: f32 = 2.0;

/// The mean of min(1, N / P) over frames of noise, whose powers P are exponentially distributed about N: 1 - 1/e + E1(1).
const MEAN_SHARE: f32 = 0.851_5;

/// Follows the phases of the noise of the pairs of an array, a bin. Its whole state is serializable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoiseCoherence {
    forgetting: f32,
    bins: usize,
    /// Mean of exp(j phase) of the cross-spectrum over frames of noise, pairs x bins: real and imaginary part.
    phases: Vec<[f32; 2]>,
    /// Share of the noise in the power of the newest frame, one a bin, in the mean 1 where there is nothing else.
    shares: Vec<f32>,
}

impl NoiseCoherence {
    /// A follower of `pairs` pairs, one spectrum of `bins` bins each `interval_s` seconds, that remembers for `memory_s`
    /// seconds of noise.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where an argument is not above 0.
    pub fn new(pairs: usize, bins: usize, interval_s: f64, memory_s: f64) -> Result<Self, AudioError> {
        for (name, value) in [
            ("pairs", pairs as f64),
            ("bins", bins as f64),
            ("interval_s", interval_s),
            ("memory_s", memory_s),
        ] {
            check_setting(value > 0.0 && value.is_finite(), name, "above 0", value)?;
        }
        Ok(Self {
            forgetting: (-interval_s / memory_s).exp() as f32,
            bins,
            phases: vec![[0.0; 2]; pairs * bins],
            shares: vec![0.0; bins],
        })
    }

    /// Checks a follower that was saved: whether this one could have become it.
    ///
    /// # Errors
    /// [`AudioError::State`] or [`AudioError::Shape`] where it is of other settings or contradicts itself.
    pub fn check_saved(&self, saved: &Self) -> Result<(), AudioError> {
        check_state(
            (saved.forgetting, saved.bins) == (self.forgetting, self.bins),
            "the settings of the noise's phases",
        )?;
        check_shape("phases of the noise", self.phases.len(), saved.phases.len())?;
        check_shape("shares of the noise", self.shares.len(), saved.shares.len())?;
        let within = |part: &f32| part.abs() <= 2.0;
        let real = saved.phases.iter().flatten().all(within) && saved.shares.iter().all(within);
        check_state(real, "the phases of the noise")
    }

    /// Takes in the spectra of one frame: `power` is the mean of the microphones' powers and `noise` that of the noise, both a
    /// bin. Bins with more than noise in them, and frames that are not to be `learnt`, teach nothing.
    ///
    /// # Errors
    /// [`AudioError::Shape`] where there is not one value a bin, or not as many pairs as there are.
    pub fn observe(
        &mut self,
        channels: &[Vec<Complex>],
        pairs: &[[usize; 2]],
        [power, noise]: [&[f32]; 2],
        learnt: bool,
    ) -> Result<(), AudioError> {
        check_shape("powers of a frame", self.bins, power.len())?;
        check_shape("powers of the noise", self.bins, noise.len())?;
        check_shape("pairs", self.phases.len() / self.bins, pairs.len())?;
        for ((share, power), noise) in self.shares.iter_mut().zip(power).zip(noise) {
            *share = (noise / power.max(f32::MIN_POSITIVE)).min(1.0) / MEAN_SHARE;
        }
        if !learnt {
            return Ok(());
        }
        let rate = 1.0 - self.forgetting;
        for (pair, phases) in pairs.iter().zip(self.phases.chunks_exact_mut(self.bins)) {
            let [Some(first), Some(second)] = pair.map(|microphone| channels.get(microphone)) else {
                continue;
            };
            check_shape("bins of the first spectrum", self.bins, first.len())?;
            check_shape("bins of the second spectrum", self.bins, second.len())?;
            for (bin, ((phase, x), y)) in phases.iter_mut().zip(first).zip(second).enumerate() {
                let product = x * y.conj();
                let magnitude = product.norm_sqr().sqrt();
                if power[bin] < NOISE_ALONE * noise[bin] && magnitude > f32::MIN_POSITIVE {
                    phase[0] += rate * (product.re / magnitude - phase[0]);
                    phase[1] += rate * (product.im / magnitude - phase[1]);
                }
            }
        }
        Ok(())
    }

    /// Writes what the noise adds to the cross-spectrum of a pair in the newest frame into `cross`, as a share of its
    /// magnitude, one value a bin; nothing for a pair that there is not.
    pub fn cross_spectrum(&self, pair: usize, cross: &mut Vec<Complex>) {
        cross.clear();
        let own = self.phases.chunks_exact(self.bins).nth(pair).unwrap_or_default();
        let shared = own.iter().zip(&self.shares);
        cross.extend(shared.map(|(phase, share)| Complex::new(share * phase[0], share * phase[1])));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correlation::{Correlator, CorrelatorSettings};
    use crate::curve::CorrelationCurve;
    use crate::spectrum::{Spectra, SpectrumAnalyzer, Window, power_into};
    use crate::weighting::PairNoise;

    const RATE_HZ: u32 = 16_000;
    const LENGTH: usize = 512;

    /// White noise of a seed, one value a sample.
    fn white(seed: u32) -> impl Fn(i64) -> f32 {
        move |index| {
            let mut hash = (index as u32).wrapping_mul(0x9e37_79b9) ^ seed.wrapping_mul(0x85eb_ca6b);
            for _ in 0..3 {
                hash = (hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d);
            }
            (hash >> 8) as f32 / 8_388_608.0 - 1.0
        }
    }

    /// A fan at 6 samples of delay that always runs, and a weaker voice at -9 in the frame that is asked about.
    #[test]
    fn a_voice_weaker_than_a_fan_is_heard_once_the_fan_is_known() {
        let mut analyzer = SpectrumAnalyzer::new(LENGTH, 1024, Window::Hann).unwrap();
        let mut correlator = Correlator::new(CorrelatorSettings::new(1024, RATE_HZ, 0.001)).unwrap();
        let mut coherence = NoiseCoherence::new(1, 513, 0.016, 1.0).unwrap();
        let (fan, voice) = (white(1), white(2));
        let (mut spectra, mut power, mut cross) = (Spectra::default(), Vec::new(), Vec::new());
        let mut frame = |number: i64, loudness: f32, spectra: &mut Spectra| {
            let channel = |fan_late: i64, voice_late: i64| -> Vec<f32> {
                let at = |k: usize| number * 256 + k as i64;
                (0..LENGTH)
                    .map(|k| fan(at(k) - fan_late) + loudness * voice(at(k) - voice_late))
                    .collect()
            };
            let channels = [channel(6, 0), channel(0, 9)];
            analyzer.transform_all(&channels, spectra).unwrap();
        };
        let energy: f32 = Window::Hann.coefficients(LENGTH).iter().map(|w| w * w).sum();
        let noise = vec![energy / 3.0; 513];
        for number in 0..200 {
            frame(number, 0.0, &mut spectra);
            power_into(&spectra.channels[0], &mut power);
            let powers = [power.as_slice(), noise.as_slice()];
            coherence
                .observe(&spectra.channels, &[[0, 1]], powers, true)
                .unwrap();
        }
        let mut peaks = [0; 2];
        for number in 200..240 {
            frame(number, 0.7, &mut spectra);
            let [first, second] = [&spectra.channels[0], &spectra.channels[1]];
            power_into(first, &mut power);
            let powers = [power.as_slice(), noise.as_slice()];
            coherence
                .observe(&spectra.channels, &[[0, 1]], powers, false)
                .unwrap();
            coherence.cross_spectrum(0, &mut cross);
            for (known, peaks) in [None, Some(cross.as_slice())].into_iter().zip(&mut peaks) {
                let noise = PairNoise {
                    first: &noise,
                    second: &noise,
                    cross: known,
                };
                let mut curve = CorrelationCurve::default();
                correlator
                    .correlate(first, second, Some(noise), None, &mut curve)
                    .unwrap();
                let highest = (-12..=12).max_by(|a, b| {
                    let at = |lag: &i32| curve.at(f64::from(*lag) / f64::from(RATE_HZ));
                    at(a).total_cmp(&at(b))
                });
                *peaks += usize::from(highest == Some(-9));
            }
        }
        assert!(peaks[0] < 10, "{peaks:?}");
        assert!(peaks[1] > 35, "{peaks:?}");
    }

    #[test]
    fn a_microphone_that_falls_silent_is_correlated_with_nothing() {
        let mut correlator = Correlator::new(CorrelatorSettings::new(64, RATE_HZ, 0.001)).unwrap();
        let (alive, dead) = (vec![Complex::new(1.0, 0.5); 33], vec![Complex::default(); 33]);
        let (noise, cross) = (vec![1.0; 33], vec![Complex::new(0.8, 0.1); 33]);
        let noise = PairNoise {
            first: &noise,
            second: &noise,
            cross: Some(&cross),
        };
        let mut curve = CorrelationCurve::default();
        correlator
            .correlate(&alive, &dead, Some(noise), None, &mut curve)
            .unwrap();
        assert!(
            curve.values.iter().all(|value| *value == 0.0),
            "{:?}",
            curve.values
        );
    }

    #[test]
    fn a_saved_follower_of_other_settings_or_with_impossible_powers_is_refused() {
        let own = NoiseCoherence::new(2, 9, 0.02, 1.0).unwrap();
        assert!(own.check_saved(&own).is_ok());
        assert!(
            own.check_saved(&NoiseCoherence::new(3, 9, 0.02, 1.0).unwrap())
                .is_err()
        );
        assert!(
            own.check_saved(&NoiseCoherence::new(2, 9, 0.02, 2.0).unwrap())
                .is_err()
        );
        let mut broken = own.clone();
        broken.shares[3] = 3.0;
        assert!(own.check_saved(&broken).is_err());
        broken = own.clone();
        broken.phases[0][1] = f32::NAN;
        assert!(own.check_saved(&broken).is_err());
    }
}
