//! What an array hears: for each frame that is louder than the noise the delay of every pair.

use hearsight_audio::AudioError;
use hearsight_audio::correlation::{Correlator, CorrelatorSettings};
use hearsight_audio::curve::CorrelationCurve;
use hearsight_audio::frames::{FrameSettings, Framer};
use hearsight_audio::noise::mean_square;
use hearsight_audio::spectrum::{Spectra, SpectrumAnalyzer, Window, transform_length};
use hearsight_core::microphones::MicrophoneArray;
use hearsight_core::{AudioBlock, Instant};

/// Length of a frame, seconds.
const FRAME_S: f64 = 0.256;
/// Time from one frame to the next, seconds.
pub(super) const HOP_S: f64 = 0.064;
/// How far apart microphones may be from where they are declared, as a share of their distances: delays beyond those of
/// the declared places are looked for as far.
const SLACK: f64 = 1.1;
/// A frame counts from so many decibels above the noise.
const LOUDER_DB: f64 = 9.0;
/// Share of the frames that are noise at the least.
const NOISE_SHARE: f64 = 0.1;

/// One frame of sound.
#[derive(Clone, Debug, PartialEq)]
pub struct HeardDelays {
    /// The instant in its middle, by the declared clock of the array.
    pub time: Instant,
    /// The delay of every pair, in the order of [`MicrophoneArray::pairs`], seconds; not a number where there is no peak.
    pub delays_s: Vec<f64>,
    power: f64,
}

impl HeardDelays {
    /// A frame that counts, with these delays.
    pub fn new(time: Instant, delays_s: Vec<f64>) -> Self {
        Self {
            time,
            delays_s,
            power: 1.0,
        }
    }
}

/// Listens to an array from its first sample to its last.
pub struct Listener {
    framer: Framer,
    analyzer: SpectrumAnalyzer,
    spectra: Spectra,
    correlator: Correlator,
    curve: CorrelationCurve,
    pairs: Vec<(usize, usize)>,
    heard: Vec<HeardDelays>,
}

impl Listener {
    /// A listener to an array as it is declared.
    ///
    /// # Errors
    /// [`AudioError`] where the rate is impossible.
    pub fn new(array: &MicrophoneArray, rate_hz: u32) -> Result<Self, AudioError> {
        let channels = array.positions().len();
        let samples = |seconds: f64| (seconds * f64::from(rate_hz)).round().max(1.0) as usize;
        let frames = FrameSettings {
            length: samples(FRAME_S),
            hop: samples(HOP_S),
            ..FrameSettings::half_overlapping(FRAME_S, rate_hz, channels)
        };
        let reach_s = SLACK * array.max_delay_s();
        let transform = transform_length(frames.length, reach_s, rate_hz);
        Ok(Self {
            analyzer: SpectrumAnalyzer::new(frames.length, transform, Window::Hann)?,
            framer: Framer::new(frames)?,
            spectra: Spectra::default(),
            correlator: Correlator::new(CorrelatorSettings::new(transform, rate_hz, reach_s))?,
            curve: CorrelationCurve::default(),
            pairs: (0..channels)
                .flat_map(|first| (first + 1..channels).map(move |second| (first, second)))
                .collect(),
            heard: Vec::new(),
        })
    }

    /// Takes in more samples.
    ///
    /// # Errors
    /// [`AudioError`] where a block is of another array.
    pub fn hear(&mut self, block: &AudioBlock) -> Result<(), AudioError> {
        let (analyzer, spectra) = (&mut self.analyzer, &mut self.spectra);
        let (correlator, curve) = (&mut self.correlator, &mut self.curve);
        let (pairs, heard) = (&self.pairs, &mut self.heard);
        let mut failed = None;
        self.framer.push(block, |frame| {
            let powers: f32 = frame.channels.iter().map(|channel| mean_square(channel)).sum();
            let mut measure = || {
                analyzer.transform_all(frame.channels, spectra)?;
                let mut delays_s = Vec::with_capacity(pairs.len());
                for &(first, second) in pairs {
                    let (one, other) = (&spectra.channels[first], &spectra.channels[second]);
                    correlator.correlate(one, other, None, None, curve)?;
                    delays_s.push(curve.peak().map_or(f64::NAN, |peak| peak.delay_s));
                }
                Ok::<_, AudioError>(delays_s)
            };
            match measure() {
                Ok(delays_s) if frame.filled == 0 => heard.push(HeardDelays {
                    time: frame.middle(),
                    delays_s,
                    power: f64::from(powers),
                }),
                Ok(_) => {}
                Err(error) => failed = Some(error),
            }
        })?;
        failed.map_or(Ok(()), Err)
    }

    /// The frames that are louder than the noise, which is what the quietest tenth has.
    pub fn loud(self) -> Vec<HeardDelays> {
        let mut powers: Vec<f64> = self.heard.iter().map(|frame| frame.power).collect();
        powers.sort_by(f64::total_cmp);
        let noise = powers
            .get((powers.len() as f64 * NOISE_SHARE) as usize)
            .copied()
            .unwrap_or(0.0);
        let least = noise * 10.0_f64.powf(LOUDER_DB / 10.0);
        let mut loud = self.heard;
        loud.retain(|frame| frame.power > least.max(1e-12));
        loud
    }
}
