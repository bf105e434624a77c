use super::*;
use crate::spectrum::{SpectrumAnalyzer, Window};
use std::f64::consts::TAU;

/// White sound of flat magnitude and deterministic phases; the second microphone is ahead by `delay` samples.
fn delayed(length: usize, delay: f64) -> [Vec<Complex>; 2] {
    let mut phase = 0.37_f64;
    let mut spectra = [Vec::new(), Vec::new()];
    for k in 0..=length / 2 {
        phase = (phase * 997.0 + 0.123).fract();
        let lag = TAU * k as f64 * delay / length as f64;
        let ends = k == 0 || k == length / 2;
        let angle = if ends { 0.0 } else { TAU * phase };
        spectra[0].push(Complex::from_polar(
            1.0 + phase as f32,
            (angle - if ends { 0.0 } else { lag }) as f32,
        ));
        spectra[1].push(Complex::from_polar(1.0 + phase as f32, angle as f32));
    }
    spectra
}

#[test]
fn fractional_delays_are_recovered_with_their_sign() {
    let rate = 16_000;
    for weighting in [Weighting::Plain, Weighting::Phat, Weighting::Scot] {
        let settings = CorrelatorSettings {
            weighting,
            ..CorrelatorSettings::new(2048, rate, 0.003)
        };
        let mut correlator = Correlator::new(settings).unwrap();
        let mut curve = CorrelationCurve::default();
        let mut worst = 0.0_f64;
        for step in -940..=940 {
            let delay = f64::from(step) * 0.0511;
            let [first, second] = delayed(2048, delay);
            correlator
                .correlate(&first, &second, None, None, &mut curve)
                .unwrap();
            let peak = curve.peak().unwrap();
            worst = worst.max((peak.delay_s * f64::from(rate) - delay).abs());
            assert!(
                peak.value > 0.9 && peak.value < 1.01,
                "{weighting:?} {delay}: {}",
                peak.value
            );
        }
        println!("{weighting:?}: worst error {worst:.5} samples");
        assert!(worst < 0.01, "{weighting:?}: {worst}");
    }
}

#[test]
fn noisy_weightings_need_the_noise() {
    for weighting in [
        Weighting::MaximumLikelihood { reverberation: 0.3 },
        Weighting::NoiseRegularized { gamma: 0.5 },
    ] {
        let settings = CorrelatorSettings {
            weighting,
            ..CorrelatorSettings::new(256, 16_000, 0.001)
        };
        let mut correlator = Correlator::new(settings).unwrap();
        let [first, second] = delayed(256, 3.25);
        let mut curve = CorrelationCurve::default();
        let refused = correlator.correlate(&first, &second, None, None, &mut curve);
        assert_eq!(refused, Err(AudioError::NoiseMissing));
        let noise = vec![0.01; 129];
        let noise = Some(PairNoise {
            first: &noise,
            second: &noise,
            cross: None,
        });
        correlator
            .correlate(&first, &second, noise, None, &mut curve)
            .unwrap();
        assert!((curve.peak().unwrap().delay_s * 16_000.0 - 3.25).abs() < 0.05);
    }
}

#[test]
fn silence_gives_zeros_not_nonsense() {
    let mut analyzer = SpectrumAnalyzer::new(256, 512, Window::Hann).unwrap();
    let mut spectrum = Vec::new();
    analyzer.transform(&[0.0; 256], &mut spectrum).unwrap();
    for normalization in [Normalization::None, Normalization::Magnitude, Normalization::Peak] {
        let settings = CorrelatorSettings {
            normalization,
            ..CorrelatorSettings::new(512, 16_000, 0.001)
        };
        let mut curve = CorrelationCurve::default();
        Correlator::new(settings)
            .unwrap()
            .correlate(&spectrum, &spectrum, None, None, &mut curve)
            .unwrap();
        assert!(curve.values.iter().all(|&value| value == 0.0));
        assert_eq!(curve.peak(), None);
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let good = CorrelatorSettings::new(512, 16_000, 0.001);
    assert!(Correlator::new(good).is_ok());
    assert!(
        Correlator::new(CorrelatorSettings {
            transform_length: 511,
            ..good
        })
        .is_err()
    );
    assert!(
        Correlator::new(CorrelatorSettings {
            max_delay_s: 0.1,
            ..good
        })
        .is_err()
    );
    assert!(
        Correlator::new(CorrelatorSettings {
            max_delay_s: f64::NAN,
            ..good
        })
        .is_err()
    );
    assert!(
        Correlator::new(CorrelatorSettings {
            interpolation: 0,
            ..good
        })
        .is_err()
    );
    let weighting = Weighting::NoiseRegularized { gamma: 1.5 };
    assert!(Correlator::new(CorrelatorSettings { weighting, ..good }).is_err());
}
