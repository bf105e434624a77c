//! Channels: are they there, loud enough, of the right sign, and do their delays fit the microphones?

use super::CheckReport;
use super::delays::{Delay, DelayFinder, FRAME_S};
use super::levels;
use hearsight_audio::AudioError;
use hearsight_audio::levels::LevelMeter;
use hearsight_core::room::ArraySensor;
use hearsight_core::{AudioBlock, Instant};

/// Delays are looked for in this multiple of what the microphones' distance allows.
const MARGIN: f64 = 2.0;
/// The longest delay that is looked for, seconds.
const LONGEST_DELAY_S: f64 = 0.02;
/// Delay between microphones of unknown place, seconds: a metre.
const UNKNOWN_DELAY_S: f64 = 0.003;
/// More than this part of clear delays beyond the possible contradicts the geometry.
const IMPOSSIBLE_PART: f64 = 0.5;
/// Fewer clear frames than this tell nothing.
const FEWEST: usize = 15;

/// What was heard by one array.
pub(super) struct Heard {
    /// Number of the array.
    pub(super) array: usize,
    /// Delays of channels 0 and 1, in order of time.
    pub(super) delays: Vec<Delay>,
    /// Length of a frame, seconds.
    pub(super) frame_s: f64,
    /// When the first sample was heard.
    pub(super) start: Option<Instant>,
}

/// Listens to one array.
pub(super) struct Ear {
    meter: Option<LevelMeter>,
    delays: Option<DelayFinder>,
    start: Option<Instant>,
    trouble: Option<AudioError>,
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
        let meter = LevelMeter::new(array.channels, array.rate_hz, longest)
            .map_err(&mut keep)
            .ok();
        let delays = if array.channels > 1 {
            DelayFinder::new(array.channels, array.rate_hz, longest)
                .map_err(&mut keep)
                .ok()
        } else {
            None
        };
        Self {
            meter,
            delays,
            start: None,
            trouble,
        }
    }

    pub(super) fn hear(&mut self, block: &AudioBlock) {
        if block.is_empty() {
            return;
        }
        self.start.get_or_insert(block.time);
        let metered = self.meter.as_mut().map_or(Ok(()), |meter| meter.observe(block));
        let found = self
            .delays
            .as_mut()
            .map_or(Ok(()), |delays| delays.observe(block));
        if let Err(error) = metered.and(found) {
            self.trouble = Some(error);
        }
    }

    pub(super) fn report(self, number: usize, array: &ArraySensor, report: &mut CheckReport) -> Heard {
        let name = &array.name;
        if let Some(error) = &self.trouble {
            report.warn(
                name,
                "sound",
                error.to_string(),
                "the checks of this array are not complete",
            );
        }
        if self.start.is_none() {
            let cure = "check `start`, `from` and `until`, and whether the file can be played".to_owned();
            report.fail(name, "sound", "no sample came", Some(cure));
        } else if let Some(meter) = &self.meter {
            levels::report(name, meter, report);
        }
        let mut found = self.delays.map(|delays| delays.clear()).unwrap_or_default();
        for (pair, delays) in found.iter().enumerate() {
            report_delays(array, pair, delays, report);
        }
        let delays = if found.is_empty() {
            Vec::new()
        } else {
            found.swap_remove(0)
        };
        Heard {
            array: number,
            delays,
            frame_s: FRAME_S,
            start: self.start,
        }
    }
}

fn report_delays(array: &ArraySensor, pair: usize, delays: &[Delay], report: &mut CheckReport) {
    if array.microphones.len() < pair + 2 || delays.len() < FEWEST {
        return;
    }
    // The speed of sound is near enough here: half of the margin.
    let possible = possible_s(array, pair, 343.0) * 1.1 + 1.0 / f64::from(array.rate_hz.max(1));
    let beyond = delays
        .iter()
        .filter(|delay| delay.delay_s.abs() > possible)
        .count();
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
        let what = format!(
            "{} clear delays of channels 0 and 1, {:.0} % impossible",
            delays.len(),
            100.0 * part
        );
        report.pass(&array.name, "delays", what);
    }
}
