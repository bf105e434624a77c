//! Agreement with scipy: see `goldens/make_goldens.py`.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use hearsight_audio::Complex;
use hearsight_audio::bands::{FILTER_ORDER, THREE_BANDS, filter_taps};
use hearsight_audio::correlation::{Correlator, CorrelatorSettings, Normalization};
use hearsight_audio::curve::CorrelationCurve;
use hearsight_audio::spectrum::{SpectrumAnalyzer, Window};
use hearsight_audio::weighting::{PairAverage, PairNoise, Weighting};
use serde_json::Value;

fn goldens() -> Value {
    serde_json::from_str(include_str!("goldens/goldens.json")).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|number| number.as_f64().unwrap())
        .collect()
}

fn samples(value: &Value) -> Vec<f32> {
    numbers(value).into_iter().map(|number| number as f32).collect()
}

fn size(value: &Value) -> usize {
    value.as_u64().unwrap() as usize
}

fn share(value: &Value) -> f32 {
    value.as_f64().unwrap() as f32
}

/// The greatest difference as a share of the greatest expected magnitude.
fn difference(found: &[f32], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let scale = expected.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let differences = found
        .iter()
        .zip(expected)
        .map(|(&found, expected)| (f64::from(found) - expected).abs());
    differences.fold(0.0, f64::max) / scale
}

#[test]
fn spectra() {
    let goldens = goldens();
    let (length, padded) = (size(&goldens["length"]), size(&goldens["padded"]));
    let first = samples(&goldens["first"]);
    for (name, window) in [
        ("hann", Window::Hann),
        ("hamming", Window::Hamming),
        ("rectangular", Window::Rectangular),
    ] {
        let mut analyzer = SpectrumAnalyzer::new(length, padded, window).unwrap();
        let mut spectrum = Vec::new();
        analyzer.transform(&first[..length], &mut spectrum).unwrap();
        let parts: [Vec<f32>; 2] = [
            spectrum.iter().map(|x| x.re).collect(),
            spectrum.iter().map(|x| x.im).collect(),
        ];
        for (part, found) in parts.iter().enumerate() {
            let error = difference(found, &numbers(&goldens["spectra"][name][part]));
            assert!(error < 1e-6, "{name}: {error}");
        }
    }
}

#[test]
fn taps() {
    let goldens = goldens();
    for (index, band) in THREE_BANDS.iter().enumerate() {
        let taps = filter_taps(band.low_hz, band.high_hz, 12_000, FILTER_ORDER).unwrap();
        let taps: Vec<f32> = taps.into_iter().map(|tap| tap as f32).collect();
        let error = difference(&taps, &numbers(&goldens["taps"][index]));
        assert!(error < 1e-6, "band {index}: {error}");
    }
}

fn correlator(goldens: &Value, weighting: Weighting) -> Correlator {
    let (rate_hz, factor) = (size(&goldens["rate_hz"]) as u32, size(&goldens["factor"]));
    let max_delay_s = (size(&goldens["half"]) - 2) as f64 / (f64::from(rate_hz) * factor as f64);
    Correlator::new(CorrelatorSettings {
        interpolation: factor,
        weighting,
        normalization: Normalization::None,
        ..CorrelatorSettings::new(size(&goldens["padded"]), rate_hz, max_delay_s)
    })
    .unwrap()
}

/// The Hann spectra of all frames of both channels.
fn frames(goldens: &Value) -> Vec<[Vec<Complex>; 2]> {
    let length = size(&goldens["length"]);
    let mut analyzer = SpectrumAnalyzer::new(length, size(&goldens["padded"]), Window::Hann).unwrap();
    let channels = [samples(&goldens["first"]), samples(&goldens["second"])];
    let count = channels[0].len() / length;
    (0..count)
        .map(|frame| {
            channels.each_ref().map(|channel| {
                let mut spectrum = Vec::new();
                analyzer
                    .transform(&channel[frame * length..(frame + 1) * length], &mut spectrum)
                    .unwrap();
                spectrum
            })
        })
        .collect()
}

#[test]
fn curves_of_one_frame() {
    let goldens = goldens();
    let noises = [samples(&goldens["noises"][0]), samples(&goldens["noises"][1])];
    let [first, second] = frames(&goldens)[0].clone();
    for (name, weighting) in [
        ("plain", Weighting::Plain),
        ("phat", Weighting::Phat),
        ("phat", Weighting::NoiseRegularized { gamma: 1.0 }),
        (
            "maximum_likelihood",
            Weighting::MaximumLikelihood {
                reverberation: share(&goldens["reverberation"]),
            },
        ),
        (
            "noise_regularized",
            Weighting::NoiseRegularized {
                gamma: share(&goldens["gamma"]),
            },
        ),
    ] {
        let mut curve = CorrelationCurve::default();
        let noise = Some(PairNoise {
            first: &noises[0],
            second: &noises[1],
            cross: None,
        });
        correlator(&goldens, weighting)
            .correlate(&first, &second, noise, None, &mut curve)
            .unwrap();
        let error = difference(&curve.values, &numbers(&goldens["curves"][name]));
        assert!(error < 1e-5, "{weighting:?}: {error}");
        // The first channel hears five samples later.
        let peak = curve.peak().unwrap();
        assert!(
            (peak.delay_s * 16_000.0 - 5.0).abs() < 0.3,
            "{weighting:?}: {peak:?}"
        );
    }
}

#[test]
fn curves_of_an_average() {
    let goldens = goldens();
    let mut average = PairAverage::new(share(&goldens["forgetting"])).unwrap();
    for [first, second] in frames(&goldens) {
        average.observe(&first, &second).unwrap();
        // What was saved goes on with the same numbers.
        average = serde_json::from_str(&serde_json::to_string(&average).unwrap()).unwrap();
    }
    for (name, weighting) in [("scot", Weighting::Scot), ("coherence", Weighting::Coherence)] {
        let mut curve = CorrelationCurve::default();
        correlator(&goldens, weighting)
            .correlate_average(&average, None, None, &mut curve)
            .unwrap();
        let error = difference(&curve.values, &numbers(&goldens["averaged_curves"][name]));
        assert!(error < 2e-5, "{name}: {error}");
    }
}
