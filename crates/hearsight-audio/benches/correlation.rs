//! Time and allocations of one pair's correlation, both forward transforms included: 4096 samples zero-padded to 8192,
//! and three bands at 12 kHz.

use hearsight_audio::agreement::{Agreement, AgreementSettings};
use hearsight_audio::bands::{BandBank, BandShape, THREE_BANDS};
use hearsight_audio::correlation::{Correlator, CorrelatorSettings, Normalization};
use hearsight_audio::curve::CorrelationCurve;
use hearsight_audio::spectrum::{SpectrumAnalyzer, Window};
use hearsight_audio::weighting::{PairNoise, Weighting};

#[global_allocator]
static ALLOCATIONS: divan::AllocProfiler = divan::AllocProfiler::system();

fn main() {
    divan::main();
}

fn noise(seed: u64) -> Vec<f32> {
    let mut state = seed;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 23) as f32 - 1.0
    };
    (0..4096).map(|_| next()).collect()
}

#[divan::bench(args = [1, 8])]
fn phase_transform_of_a_pair(bencher: divan::Bencher<'_, '_>, interpolation: usize) {
    let settings = CorrelatorSettings {
        interpolation,
        normalization: Normalization::None,
        ..CorrelatorSettings::new(8192, 16_000, 0.003)
    };
    run(bencher, settings);
}

#[divan::bench]
fn phase_transform_normalized(bencher: divan::Bencher<'_, '_>) {
    let settings = CorrelatorSettings {
        interpolation: 1,
        ..CorrelatorSettings::new(8192, 16_000, 0.003)
    };
    run(bencher, settings);
}

/// A frame of 128 ms of a pair at 12 kHz, from samples to the combined curve of three bands.
#[divan::bench]
fn three_bands_of_a_pair(bencher: divan::Bencher<'_, '_>) {
    let settings = CorrelatorSettings {
        weighting: Weighting::NoiseRegularized { gamma: 0.3 },
        ..CorrelatorSettings::new(2048, 12_000, 0.0028)
    };
    let (Ok(mut analyzer), Ok(mut correlator), Ok(mut bank), Ok(mut agreement)) = (
        SpectrumAnalyzer::new(1536, 2048, Window::Hann),
        Correlator::new(settings),
        BandBank::new(&THREE_BANDS, BandShape::default(), 12_000, 2048),
        Agreement::new(AgreementSettings::default()),
    ) else {
        return;
    };
    let (first, second, floor) = (noise(1), noise(2), vec![1.0; 1025]);
    let (mut x, mut y) = (Vec::new(), Vec::new());
    let mut combined = CorrelationCurve::default();
    bencher.bench_local(|| {
        let floors = PairNoise {
            first: &floor,
            second: &floor,
            cross: None,
        };
        analyzer.transform(&first[..1536], &mut x).is_ok()
            && analyzer.transform(&second[..1536], &mut y).is_ok()
            && bank.correlate(&mut correlator, &x, &y, Some(floors)).is_ok()
            && agreement.combine(&bank, &mut combined).is_ok()
    });
}

fn run(bencher: divan::Bencher<'_, '_>, settings: CorrelatorSettings) {
    let (Ok(mut analyzer), Ok(mut correlator)) = (
        SpectrumAnalyzer::new(4096, 8192, Window::Hann),
        Correlator::new(settings),
    ) else {
        return;
    };
    let (first, second) = (noise(1), noise(2));
    let (mut x, mut y) = (Vec::new(), Vec::new());
    let mut curve = CorrelationCurve::default();
    bencher.bench_local(|| {
        analyzer.transform(&first, &mut x).is_ok()
            && analyzer.transform(&second, &mut y).is_ok()
            && correlator.correlate(&x, &y, None, None, &mut curve).is_ok()
    });
}
