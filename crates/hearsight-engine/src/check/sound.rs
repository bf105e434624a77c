//! Channels: are they there, loud enough, of the right sign, and do their delays fit the microphones?

use super::CheckReport;
use hearsight_audio::correlation::{Correlator, CorrelatorSettings};
use hearsight_audio::curve::CorrelationCurve;
use hearsight_audio::frames::{FrameSettings, Framer};
use hearsight_audio::levels::LevelMeter;
use hearsight_audio::spectrum::{Spectra, SpectrumAnalyzer, Window, transform_length};
use hearsight_audio::{AudioError, frames::Frame};
use hearsight_core::room::ArraySensor;
use hearsight_core::{AudioBlock, Instant};

/// Length of a frame, seconds.
const FRAME_S: f64 = 0.08;
/// Delays are looked for in this multiple of what the microphones' distance allows.
const MARGIN: f64 = 2.0;
/// The longest delay that is looked for, seconds.
const LONGEST_DELAY_S: f64 = 0.02;
/// Delay between microphones of unknown place, seconds: a metre.
const UNKNOWN_DELAY_S: f64 = 0.003;
/// Frames within this of the loudest are taken for speech, decibels.
const LOUD_DB: f32 = 20.0;
/// Peaks of the phase transform below this are noise.
const CLEAR_PEAK: f32 = 0.12;
/// More than this part of clear delays beyond the possible contradicts the geometry.
const IMPOSSIBLE_PART: f64 = 0.5;
/// Fewer clear frames than this tell nothing.
const FEWEST: usize = 15;

/// A clear delay of one pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Delay {
    /// The middle of the frame.
    pub(super) time: Instant,
    /// t_i - t_j, seconds.
    pub(super) delay_s: f64,
    power_db: f32,
}

/// What was heard by one array.
pub(super) struct Heard {
    /// Number of the array.
    pub(super) array: usize,
    /// Delays of channels 0 and 1, in order of time.
    pub(super) delays: Vec<Delay>,
    /// Length of a frame, seconds.
    pub(super) frame_s: f64,
    start: Option<Instant>,
}

impl Heard {
    /// When the first sample was heard; nothing where there is too little to compare with.
    pub(super) fn start(&self) -> Option<Instant> {
        self.start.filter(|_| self.delays.len() >= FEWEST)
    }
}

/// Listens to one array.
pub(super) struct Ear {
    meter: Option<LevelMeter>,
    delays: Option<DelayFinder>,
    start: Option<Instant>,
    trouble: Option<AudioError>,
}

struct DelayFinder {
    framer: Framer,
    analyzer: SpectrumAnalyzer,
    correlator: Correlator,
    spectra: Spectra,
    curve: CorrelationCurve,
    /// For each pair of neighbours, its clear delays.
    found: Vec<Vec<Delay>>,
}

/// The longest possible delay of two neighbours, seconds.
fn possible_s(array: &ArraySensor, pair: usize, speed_m_s: f64) -> f64 {
    match (array.microphones.get(pair), array.microphones.get(pair + 1)) {
        (Some(one), Some(other)) => one.distance_m(*other) / speed_m_s,
        _ => UNKNOWN_DELAY_S,
    }
}

impl Ear {
    pub(super) fn new(array: &ArraySensor, speed_m_s: f64) -> Self {
        let widest = (0..array.channels.saturating_sub(1))
            .map(|pair| possible_s(array, pair, speed_m_s))
            .fold(UNKNOWN_DELAY_S / 10.0, f64::max);
        let longest = (MARGIN * widest).min(LONGEST_DELAY_S);
        let mut trouble = None;
        let mut keep = |error| trouble = Some(error);
        let meter = LevelMeter::new(array.channels, array.rate_hz, longest).map_err(&mut keep).ok();
        let delays = if array.channels > 1 {
            DelayFinder::new(array.channels, array.rate_hz, longest).map_err(&mut keep).ok()
        } else {
            None
        };
        Self { meter, delays, start: None, trouble }
    }

    pub(super) fn hear(&mut self, block: &AudioBlock) {
        if block.is_empty() {
            return;
        }
        self.start.get_or_insert(block.time);
        let metered = self.meter.as_mut().map_or(Ok(()), |meter| meter.observe(block));
        let found = self.delays.as_mut().map_or(Ok(()), |delays| delays.observe(block));
        if let Err(error) = metered.and(found) {
            self.trouble = Some(error);
        }
    }

    pub(super) fn report(self, number: usize, array: &ArraySensor, report: &mut CheckReport) -> Heard {
        let name = &array.name;
        if let Some(error) = &self.trouble {
            report.warn(name, "sound", error.to_string(), "the checks of this array are not complete");
        }
        if self.start.is_none() {
            let cure = "check `start`, `from` and `until`, and whether the file can be played".to_owned();
            report.fail(name, "sound", "no sample came", Some(cure));
        } else if let Some(meter) = &self.meter {
            report_levels(name, meter, report);
        }
        let mut found = self.delays.map(|delays| delays.clear()).unwrap_or_default();
        for (pair, delays) in found.iter().enumerate() {
            report_delays(array, pair, delays, report);
        }
        let delays = if found.is_empty() { Vec::new() } else { found.swap_remove(0) };
        Heard { array: number, delays, frame_s: FRAME_S, start: self.start }
    }
}

fn report_levels(name: &str, meter: &LevelMeter, report: &mut CheckReport) {
    let channels = meter.channels();
    let loudest = channels.iter().map(|channel| channel.rms_dbfs).fold(-200.0, f64::max);
    for (number, channel) in channels.iter().enumerate() {
        let level = format!("channel {number}: {:.0} dB of full scale, peak {:.2}", channel.rms_dbfs, channel.peak);
        if channel.silent {
            let cure = "check the cable, the gain, and `channels`";
            report.fail(name, "level", format!("channel {number} is silent"), Some(cure.to_owned()));
        } else if channel.clipped > 1e-4 {
            let what = format!("{level}; {:.2} % of its samples are clipped", 100.0 * channel.clipped);
            report.warn(name, "level", what, "lower the gain: clipped sound has no true delays");
        } else if loudest - channel.rms_dbfs > 12.0 {
            let what = format!("{level}, {:.0} dB below the loudest", loudest - channel.rms_dbfs);
            report.warn(name, "level", what, "check the gain and the place of this microphone");
        } else {
            report.pass(name, "level", level);
        }
        if channel.non_finite > 0 {
            let what = format!("channel {number}: {} samples are not numbers", channel.non_finite);
            report.warn(name, "samples", what, "they count as zero: convert the file again");
        }
        if channel.offset.abs() > 0.02 {
            let what = format!("channel {number} has an offset of {:.3}", channel.offset);
            report.warn(name, "offset", what, "check the sound card; the offset hides soft sound");
        }
    }
    let pairs = meter.pairs();
    let inverted: Vec<_> = pairs.iter().filter(|pair| pair.inverted).collect();
    match inverted.as_slice() {
        [] if pairs.is_empty() => {
            let cure = "delays need two or more: pick more with `channels`";
            report.warn(name, "channels", "only one channel", cure);
        }
        [] => report.pass(name, "sign", "all channels have the same sign"),
        [first, ..] => {
            // The channel that is in every inverted pair is the one, where there are three or more.
            let counts = (0..channels.len())
                .map(|channel| inverted.iter().filter(|pair| pair.channels.contains(&channel)).count());
            let guilty: Vec<_> = counts.enumerate().filter(|(_, count)| *count == inverted.len()).collect();
            let [one, other] = first.channels;
            let what = match guilty.as_slice() {
                [(channel, _)] => format!("channel {channel} is inverted"),
                _ => format!("channel {one} or {other} is inverted (correlation {:.2})", first.correlation),
            };
            report.warn(name, "sign", what, "swap the two wires of that microphone");
        }
    }
}

fn report_delays(array: &ArraySensor, pair: usize, delays: &[Delay], report: &mut CheckReport) {
    if array.microphones.len() < pair + 2 || delays.len() < FEWEST {
        return;
    }
    // The speed of sound is near enough here: half of the margin.
    let possible = possible_s(array, pair, 343.0) * 1.1 + 1.0 / f64::from(array.rate_hz.max(1));
    let beyond = delays.iter().filter(|delay| delay.delay_s.abs() > possible).count();
    let part = beyond as f64 / delays.len() as f64;
    let other = pair + 1;
    if part > IMPOSSIBLE_PART {
        let what = format!(
            "{:.0} % of the delays between channels {pair} and {other} are longer than their distance allows",
            100.0 * part
        );
        let cure = "the order of `channels` or of `microphones` is wrong, or the positions are not in metres";
        report.warn(&array.name, "order of channels", what, cure);
    } else if pair == 0 {
        let what = format!("{} clear delays of channels 0 and 1, {:.0} % impossible", delays.len(), 100.0 * part);
        report.pass(&array.name, "delays", what);
    }
}

impl DelayFinder {
    fn new(channels: usize, rate_hz: u32, max_delay_s: f64) -> Result<Self, AudioError> {
        let length = (FRAME_S * f64::from(rate_hz)) as usize;
        let settings = FrameSettings { length, hop: length, ..FrameSettings::half_overlapping(FRAME_S, rate_hz, channels) };
        let padded = transform_length(length, max_delay_s, rate_hz);
        let correlator = CorrelatorSettings { interpolation: 4, ..CorrelatorSettings::new(padded, rate_hz, max_delay_s) };
        Ok(Self {
            framer: Framer::new(settings)?,
            analyzer: SpectrumAnalyzer::new(length, padded, Window::Hann)?,
            correlator: Correlator::new(correlator)?,
            spectra: Spectra::default(),
            curve: CorrelationCurve::default(),
            found: vec![Vec::new(); channels - 1],
        })
    }

    fn observe(&mut self, block: &AudioBlock) -> Result<(), AudioError> {
        let Self { framer, analyzer, correlator, spectra, curve, found } = self;
        let mut outcome = Ok(());
        framer.push(block, |frame| {
            if outcome.is_ok() {
                outcome = find(&frame, analyzer, correlator, spectra, curve, found);
            }
        })?;
        outcome
    }

    /// Of each pair, the delays of loud frames.
    fn clear(mut self) -> Vec<Vec<Delay>> {
        for delays in &mut self.found {
            let loudest = delays.iter().map(|delay| delay.power_db).fold(f32::NEG_INFINITY, f32::max);
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
            delays.push(Delay { time: frame.middle(), delay_s: peak.delay_s, power_db: 10.0 * power.log10() });
        }
    }
    Ok(())
}
