//! Time of one pair's correlation: 4096 samples zero-padded to 8192, both forward transforms, weighting and inverse.

use hearsight_audio::correlation::{Correlator, CorrelatorSettings, Normalization};
use hearsight_audio::curve::CorrelationCurve;
use hearsight_audio::spectrum::{SpectrumAnalyzer, Window};

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
