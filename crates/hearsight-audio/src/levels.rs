//! Are the channels sane? Peak, loudness, clipping, silence, bad samples, and whether two channels are of opposite sign.
//!
//! For checking a room before a run, not for the run itself.

use crate::Complex;
use crate::correlation::{Correlator, CorrelatorSettings, Normalization};
use crate::curve::CorrelationCurve;
use crate::error::{AudioError, check_setting, check_shape};
use crate::frames::{FrameSettings, Framer};
use crate::spectrum::{Spectra, SpectrumAnalyzer, Window, transform_length};
use crate::weighting::Weighting;
use hearsight_core::{AudioBlock, Span};
use serde::{Deserialize, Serialize};

/// A sample of at least this magnitude is taken as clipped: full scale of 16 bits but for one step.
const CLIPPED: f32 = 0.999_9;
/// A channel whose loudness (without its offset) is below this is silent: the last bit of 16 is at -98.
const SILENT_DBFS: f64 = -90.0;
/// Mean correlations below this in magnitude say nothing about the sign.
const TELLING: f64 = 0.1;
/// Frames of this many seconds are correlated: long against the delays, short against people who move.
const FRAME_S: f64 = 0.064;

/// The levels of one channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ChannelLevels {
    /// Samples heard.
    pub samples: u64,
    /// The greatest magnitude, full scale being 1.
    pub peak: f64,
    /// Loudness in decibels of full scale, its offset left out: 10 log10 of the mean square; -200 for none.
    pub rms_dbfs: f64,
    /// The mean, which should be near 0.
    pub offset: f64,
    /// Share of samples at full scale, 0 to 1.
    pub clipped: f64,
    /// Samples that are not finite.
    pub non_finite: u64,
    /// Whether nothing is heard: below -90 dB of full scale.
    pub silent: bool,
}

/// How alike two channels are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairLevels {
    /// The two channels, from 0.
    pub channels: [usize; 2],
    /// Mean over frames, loud ones counting more, of the extreme of the correlation coefficient over the delays that
    /// the distance allows: -1 to 1.
    pub correlation: f64,
    /// Whether one of the two is likely of opposite sign (a wire the wrong way round).
    pub inverted: bool,
}

/// Measures blocks of an array.
pub struct LevelMeter {
    tallies: Vec<Tally>,
    framer: Framer,
    analyzer: SpectrumAnalyzer,
    correlator: Correlator,
    spectra: Spectra,
    curve: CorrelationCurve,
    pairs: Vec<PairTally>,
}

#[derive(Clone, Copy, Default)]
struct Tally {
    samples: u64,
    peak: f32,
    sum: f64,
    squares: f64,
    clipped: u64,
    non_finite: u64,
}

struct PairTally {
    channels: [usize; 2],
    signed: f64,
    weight: f64,
}

impl LevelMeter {
    /// A meter of `channels` channels whose microphones are at most `max_delay_s` apart (distance over the speed of sound).
    ///
    /// # Errors
    /// [`AudioError::Setting`] where there is no channel or the rate or the delay is out of range (0 to 20 ms).
    pub fn new(channels: usize, rate_hz: u32, max_delay_s: f64) -> Result<Self, AudioError> {
        let near = (0.0..=0.02).contains(&max_delay_s);
        check_setting(near, "max_delay_s", "within 0 and 0.02", max_delay_s)?;
        let hop = ((FRAME_S * f64::from(rate_hz)) as usize).max(1);
        let longest_fill = Span::ZERO;
        let framer = Framer::new(FrameSettings {
            length: hop,
            hop,
            rate_hz,
            channels,
            longest_fill,
        })?;
        let padded = transform_length(hop, max_delay_s, rate_hz);
        let settings = CorrelatorSettings {
            interpolation: 1,
            weighting: Weighting::Plain,
            normalization: Normalization::Coefficient,
            ..CorrelatorSettings::new(padded, rate_hz, max_delay_s)
        };
        let pairs = (0..channels).flat_map(|i| (i + 1..channels).map(move |j| [i, j]));
        Ok(Self {
            tallies: vec![Tally::default(); channels],
            framer,
            analyzer: SpectrumAnalyzer::new(hop, padded, Window::Hann)?,
            correlator: Correlator::new(settings)?,
            spectra: Spectra::default(),
            curve: CorrelationCurve::default(),
            pairs: pairs
                .map(|channels| PairTally {
                    channels,
                    signed: 0.0,
                    weight: 0.0,
                })
                .collect(),
        })
    }

    /// Takes in a block.
    ///
    /// # Errors
    /// [`AudioError::Shape`] where it has another number of channels, another rate or channels of unequal length.
    pub fn observe(&mut self, block: &AudioBlock) -> Result<(), AudioError> {
        check_shape("channels of a block", self.tallies.len(), block.channels.len())?;
        let Self {
            framer,
            analyzer,
            correlator,
            spectra,
            curve,
            pairs,
            ..
        } = self;
        let mut outcome = Ok(());
        framer.push(block, |frame| {
            if outcome.is_ok() {
                outcome = analyzer.transform_all(frame.channels, spectra).and_then(|()| {
                    remove_offset(spectra);
                    pairs
                        .iter_mut()
                        .try_for_each(|pair| pair.observe(correlator, &spectra.channels, curve))
                });
            }
        })?;
        outcome?;
        for (tally, samples) in self.tallies.iter_mut().zip(&block.channels) {
            for &sample in samples {
                tally.observe(sample);
            }
        }
        Ok(())
    }

    /// The levels of each channel so far.
    pub fn channels(&self) -> Vec<ChannelLevels> {
        self.tallies.iter().map(Tally::levels).collect()
    }

    /// Every pair of channels, in the order (0, 1), (0, 2), ..., (1, 2), ...
    pub fn pairs(&self) -> Vec<PairLevels> {
        let levels = |pair: &PairTally| {
            let correlation = if pair.weight > 0.0 {
                pair.signed / pair.weight
            } else {
                0.0
            };
            PairLevels {
                channels: pair.channels,
                correlation,
                inverted: correlation < -TELLING,
            }
        };
        self.pairs.iter().map(levels).collect()
    }
}

/// A constant voltage would correlate whatever the channels hear; the window spreads it over three bins.
fn remove_offset(spectra: &mut Spectra) {
    for spectrum in &mut spectra.channels {
        let low = spectrum.len().min(5);
        spectrum[..low].fill(Complex::default());
    }
}

impl PairTally {
    fn observe(
        &mut self,
        correlator: &mut Correlator,
        spectra: &[Vec<Complex>],
        curve: &mut CorrelationCurve,
    ) -> Result<(), AudioError> {
        let [first, second] = self.channels.map(|channel| &spectra[channel]);
        correlator.correlate(first, second, None, None, curve)?;
        let extreme = curve
            .values
            .iter()
            .fold(0.0_f32, |most, &x| if x.abs() > most.abs() { x } else { most });
        let power = |spectrum: &[Complex]| spectrum.iter().map(|x| f64::from(x.norm_sqr())).sum::<f64>();
        let weight = (power(first) * power(second)).sqrt();
        self.signed += weight * f64::from(extreme);
        self.weight += weight;
        Ok(())
    }
}

impl Tally {
    fn observe(&mut self, sample: f32) {
        self.samples += 1;
        if !sample.is_finite() {
            self.non_finite += 1;
            return;
        }
        self.peak = self.peak.max(sample.abs());
        self.sum += f64::from(sample);
        self.squares += f64::from(sample) * f64::from(sample);
        self.clipped += u64::from(sample.abs() >= CLIPPED);
    }

    fn levels(&self) -> ChannelLevels {
        let count = (self.samples - self.non_finite).max(1) as f64;
        let offset = self.sum / count;
        let power = (self.squares / count - offset * offset).max(0.0);
        let rms_dbfs = (10.0 * power.log10()).max(-200.0);
        ChannelLevels {
            samples: self.samples,
            peak: f64::from(self.peak),
            rms_dbfs,
            offset,
            clipped: self.clipped as f64 / count,
            non_finite: self.non_finite,
            silent: rms_dbfs < SILENT_DBFS,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight_core::Instant;

    fn block() -> AudioBlock {
        let mut state = 3_u64;
        let mut white = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1 << 23) as f32 - 1.0
        };
        let sound: Vec<f32> = (0..16_040).map(|_| 0.3 * white()).collect();
        let mut channels: Vec<Vec<f32>> = vec![
            sound[20..16_020].to_vec(),
            sound[7..16_007].iter().map(|x| -0.5 * x + 0.1).collect(),
            sound[30..16_030]
                .iter()
                .map(|x| (4.0 * x).clamp(-1.0, 1.0))
                .collect(),
            vec![0.02; 16_000],
        ];
        channels[0][5] = f32::NAN;
        AudioBlock {
            time: Instant::ZERO,
            rate_hz: 16_000,
            channels,
        }
    }

    #[test]
    fn every_defect_is_seen() {
        let mut meter = LevelMeter::new(4, 16_000, 0.002).unwrap();
        meter.observe(&block()).unwrap();
        let levels = meter.channels();
        assert_eq!(levels[0].non_finite, 1);
        assert!((levels[0].rms_dbfs - 20.0 * (0.3 / 3.0_f64.sqrt()).log10()).abs() < 0.2);
        assert!((levels[1].offset - 0.1).abs() < 0.01 && !levels[1].silent);
        assert!((levels[2].clipped - 1.0 / 6.0).abs() < 0.02 && levels[2].peak == 1.0);
        assert!(levels[3].silent && levels[3].clipped == 0.0);
        let pairs = meter.pairs();
        let inverted: Vec<bool> = pairs.iter().map(|pair| pair.inverted).collect();
        assert_eq!(pairs[3].channels, [1, 2]);
        assert_eq!(inverted, [true, false, false, true, false, false]);
        assert!(pairs[0].correlation < -0.95 && pairs[1].correlation > 0.9);
    }

    #[test]
    fn nothing_heard_says_nothing() {
        let meter = LevelMeter::new(2, 16_000, 0.002).unwrap();
        assert_eq!(meter.channels()[0].rms_dbfs, -200.0);
        assert!(!meter.pairs()[0].inverted);
        assert!(LevelMeter::new(0, 16_000, 0.002).is_err());
    }
}
