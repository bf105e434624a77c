//! Work on samples.

use super::Work;
use crate::{Failure, Inputs};
use hearsight_audio::agreement::{Agreement, AgreementSettings};
use hearsight_audio::bands::{BandBank, BandShape, THREE_BANDS};
use hearsight_audio::correlation::{Correlator, CorrelatorSettings, Normalization};
use hearsight_audio::curve::CorrelationCurve;
use hearsight_audio::spectrum::{SpectrumAnalyzer, Window};
use hearsight_audio::weighting::{PairNoise, Weighting};

/// Samples by which the second channel hears earlier.
const LEAD: usize = 7;

/// Two channels of one noise, the first `LEAD` samples later, each with some noise of its own.
fn pair(length: usize) -> (Vec<f32>, Vec<f32>) {
    let common = Inputs::noise(1, length + LEAD);
    let mixed = |common: &[f32], seed| {
        common
            .iter()
            .zip(Inputs::noise(seed, length))
            .map(|(common, own)| common + 0.3 * own)
            .collect()
    };
    (mixed(&common[..length], 2), mixed(&common[LEAD..], 3))
}

fn delay_s(curve: &CorrelationCurve) -> f64 {
    let best = (0..curve.values.len()).max_by(|&a, &b| curve.values[a].total_cmp(&curve.values[b]));
    best.map_or(f64::NAN, |best| curve.delay_s(best))
}

/// Both forward transforms included. No window, one value a sample and no normalization: what scipy is asked for.
pub(super) fn phase_transform(_: &Inputs) -> Result<Work, Failure> {
    let settings = CorrelatorSettings {
        interpolation: 1,
        normalization: Normalization::None,
        ..CorrelatorSettings::new(8192, 16_000, 0.003)
    };
    let (first, second) = pair(4096);
    let mut analyzer = SpectrumAnalyzer::new(first.len(), 8192, Window::Rectangular)?;
    let mut correlator = Correlator::new(settings)?;
    let (mut x, mut y, mut curve) = (Vec::new(), Vec::new(), CorrelationCurve::default());
    Ok(Box::new(move || {
        let done = analyzer
            .transform(&first, &mut x)
            .and_then(|_| analyzer.transform(&second, &mut y))
            .and_then(|_| correlator.correlate(&x, &y, None, None, &mut curve));
        done.map_or(f64::NAN, |()| delay_s(&curve))
    }))
}

/// Frames of 128 ms, the noise-regularized weighting, eight values a sample: as the system stac listens.
pub(super) fn bands(_: &Inputs) -> Result<Work, Failure> {
    let settings = CorrelatorSettings {
        weighting: Weighting::NoiseRegularized { gamma: 0.3 },
        ..CorrelatorSettings::new(2048, 12_000, 0.0028)
    };
    let (first, second) = pair(1536);
    let floor = vec![1.0; 1025];
    let mut analyzer = SpectrumAnalyzer::new(first.len(), 2048, Window::Hann)?;
    let mut correlator = Correlator::new(settings)?;
    let mut bank = BandBank::new(&THREE_BANDS, BandShape::default(), 12_000, 2048)?;
    let mut agreement = Agreement::new(AgreementSettings::default())?;
    let (mut x, mut y, mut combined) = (Vec::new(), Vec::new(), CorrelationCurve::default());
    Ok(Box::new(move || {
        let noise = PairNoise {
            first: &floor,
            second: &floor,
            cross: None,
        };
        let done = analyzer
            .transform(&first, &mut x)
            .and_then(|_| analyzer.transform(&second, &mut y))
            .and_then(|_| bank.correlate(&mut correlator, &x, &y, Some(noise)).map(|_| ()))
            .and_then(|()| agreement.combine(&bank, &mut combined));
        done.map_or(f64::NAN, |()| delay_s(&combined))
    }))
}
