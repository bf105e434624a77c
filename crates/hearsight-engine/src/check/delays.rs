//! Delays between neighbouring channels, frame by frame.

use hearsight_audio::AudioError;
use hearsight_audio::correlation::{Correlator, CorrelatorSettings};
use hearsight_audio::curve::CorrelationCurve;
use hearsight_audio::frames::{Frame, FrameSettings, Framer};
use hearsight_audio::spectrum::{Spectra, SpectrumAnalyzer, Window, transform_length};
use hearsight_core::{AudioBlock, Instant};

/// Length of a frame, seconds.
pub(super) const FRAME_S: f64 = 0.08;
/// Frames within this of the loudest are taken for speech, decibels.
const LOUD_DB: f32 = 20.0;
/// Peaks of the phase transform below this are noise.
const CLEAR_PEAK: f32 = 0.12;

/// A clear delay of one pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Delay {
    /// The middle of the frame.
    pub(super) time: Instant,
    /// t_i - t_j, seconds.
    pub(super) delay_s: f64,
    power_db: f32,
}

/// Finds the delays of one array.
pub(super) struct DelayFinder {
    framer: Framer,
    analyzer: SpectrumAnalyzer,
    correlator: Correlator,
    spectra: Spectra,
    curve: CorrelationCurve,
    /// For each pair of neighbours, its clear delays.
    found: Vec<Vec<Delay>>,
}

impl DelayFinder {
    /// A finder of delays up to `max_delay_s` on both sides.
    pub(super) fn new(channels: usize, rate_hz: u32, max_delay_s: f64) -> Result<Self, AudioError> {
        let length = (FRAME_S * f64::from(rate_hz)) as usize;
        let settings = FrameSettings {
            length,
            hop: length / 2,
            ..FrameSettings::half_overlapping(FRAME_S, rate_hz, channels)
        };
        let padded = transform_length(length, max_delay_s, rate_hz);
        let correlator = CorrelatorSettings {
            interpolation: 4,
            ..CorrelatorSettings::new(padded, rate_hz, max_delay_s)
        };
        Ok(Self {
            framer: Framer::new(settings)?,
            analyzer: SpectrumAnalyzer::new(length, padded, Window::Hann)?,
            correlator: Correlator::new(correlator)?,
            spectra: Spectra::default(),
            curve: CorrelationCurve::default(),
            found: vec![Vec::new(); channels - 1],
        })
    }

    /// Takes the next samples.
    pub(super) fn observe(&mut self, block: &AudioBlock) -> Result<(), AudioError> {
        let Self {
            framer,
            analyzer,
            correlator,
            spectra,
            curve,
            found,
        } = self;
        let mut outcome = Ok(());
        framer.push(block, |frame| {
            if outcome.is_ok() {
                outcome = find(&frame, analyzer, correlator, spectra, curve, found);
            }
        })?;
        outcome
    }

    /// Of each pair, the delays of loud frames.
    pub(super) fn clear(mut self) -> Vec<Vec<Delay>> {
        for delays in &mut self.found {
            let loudest = delays
                .iter()
                .map(|delay| delay.power_db)
                .fold(f32::NEG_INFINITY, f32::max);
            delays.retain(|delay| delay.power_db > loudest - LOUD_DB);
        }
        self.found
    }
}

fn find(
    frame: &Frame<'_>,
    analyzer: &mut SpectrumAnalyzer,
    correlator: &mut Correlator,
    spectra: &mut Spectra,
    curve: &mut CorrelationCurve,
    found: &mut [Vec<Delay>],
) -> Result<(), AudioError> {
    analyzer.transform_all(frame.channels, spectra)?;
    for (pair, delays) in found.iter_mut().enumerate() {
        let (first, second) = (&spectra.channels[pair], &spectra.channels[pair + 1]);
        correlator.correlate(first, second, None, None, curve)?;
        let power: f32 = first.iter().map(|value| value.norm_sqr()).sum();
        if let Some(peak) = curve.peak().filter(|peak| peak.value > CLEAR_PEAK && power > 0.0) {
            delays.push(Delay {
                time: frame.middle(),
                delay_s: peak.delay_s,
                power_db: 10.0 * power.log10(),
            });
        }
    }
    Ok(())
}
