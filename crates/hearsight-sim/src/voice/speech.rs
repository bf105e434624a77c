//! Speech that is ready to be heard: stretches of samples, and the mouth that goes with them.

use crate::acoustics::Sound;
use crate::acoustics::source::add_clip;

/// Seconds between two openings of the mouth.
pub(crate) const MOUTH_S: f64 = 0.01;
/// Frames quieter than this against the loudest ones do not count for the level, decibels.
const ACTIVE_DB: f32 = -30.0;

/// One stretch of speech.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Utterance {
    pub(crate) samples: Vec<f32>,
    /// Opening of the mouth every [`MOUTH_S`], 0 to 1.
    pub(crate) mouth: Vec<f32>,
}

/// What one person says in the course of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Speech {
    rate_hz: u32,
    /// Stretches by their first sample, in order and apart.
    stretches: Vec<(i64, Utterance)>,
}

impl Speech {
    pub(crate) fn new(rate_hz: u32, mut stretches: Vec<(i64, Utterance)>) -> Self {
        stretches.sort_by_key(|stretch| stretch.0);
        Self { rate_hz, stretches }
    }

    /// How far the mouth is open at a time (seconds of the scenario): 0 closed, 1 as far as speech opens it.
    pub fn mouth_opening(&self, time_s: f64) -> f64 {
        let sample = (time_s * f64::from(self.rate_hz)).floor() as i64;
        let after = self.stretches.partition_point(|stretch| stretch.0 <= sample);
        let Some((first, utterance)) = after.checked_sub(1).and_then(|at| self.stretches.get(at)) else {
            return 0.0;
        };
        let place = (time_s - *first as f64 / f64::from(self.rate_hz)) / MOUTH_S;
        let (index, part) = (place.floor().max(0.0) as usize, place.fract());
        let opening = |index: usize| f64::from(utterance.mouth.get(index).copied().unwrap_or(0.0));
        (opening(index) + part * (opening(index + 1) - opening(index))).clamp(0.0, 1.0)
    }

    /// From when to when there is speech, seconds, in order; the short pauses within a turn are part of it.
    pub fn spans_s(&self) -> impl Iterator<Item = [f64; 2]> {
        let rate = f64::from(self.rate_hz);
        self.stretches.iter().map(move |(first, utterance)| {
            [
                *first as f64 / rate,
                (*first + utterance.samples.len() as i64) as f64 / rate,
            ]
        })
    }
}

impl Sound for Speech {
    fn rate_hz(&self) -> u32 {
        self.rate_hz
    }

    fn fill(&self, first: i64, samples: &mut [f32]) {
        samples.fill(0.0);
        let end = first + samples.len() as i64;
        // The last stretch that begins before may still go on.
        let begin = self
            .stretches
            .partition_point(|stretch| stretch.0 <= first)
            .saturating_sub(1);
        for (at, utterance) in &self.stretches[begin..] {
            if *at >= end {
                break;
            }
            add_clip(*at, &utterance.samples, first, samples);
        }
    }
}

/// Mean square of each 10 ms.
pub(crate) fn loudness(samples: &[f32], rate_hz: u32) -> Vec<f32> {
    let frame = (f64::from(rate_hz) * MOUTH_S).round().max(1.0) as usize;
    samples
        .chunks(frame)
        .map(|chunk| chunk.iter().map(|sample| sample * sample).sum::<f32>() / chunk.len() as f32)
        .collect()
}

/// The loudness that the loudest twentieth exceeds, less [`ACTIVE_DB`]: what is above it is speech.
pub(crate) fn active_floor(loudness: &[f32]) -> f32 {
    let mut sorted = loudness.to_vec();
    sorted.sort_by(f32::total_cmp);
    let high = sorted.get(sorted.len() * 19 / 20).copied().unwrap_or(0.0);
    high * 10.0_f32.powf(0.1 * ACTIVE_DB)
}

/// Scales samples to a root mean square of 1 where they are not pauses. Silence stays.
pub(crate) fn normalize(samples: &mut [f32], rate_hz: u32) {
    let loudness = loudness(samples, rate_hz);
    let floor = active_floor(&loudness);
    let (mut sum, mut count) = (0.0_f64, 0);
    for value in loudness.iter().filter(|value| **value > floor) {
        sum += f64::from(*value);
        count += 1;
    }
    if count > 0 && sum > 0.0 {
        let scale = (f64::from(count) / sum).sqrt() as f32;
        samples.iter_mut().for_each(|sample| *sample *= scale);
    }
}

/// The mouth of a recording: closed below -30 dB of the loudest frames, wide open at their level, smoothed over 50 ms.
pub(crate) fn mouth_of(samples: &[f32], rate_hz: u32) -> Vec<f32> {
    let loudness = loudness(samples, rate_hz);
    let floor = active_floor(&loudness);
    if floor <= 0.0 {
        return vec![0.0; loudness.len()];
    }
    let raw: Vec<f32> = loudness
        .iter()
        .map(|value| {
            (10.0 * (value.max(1e-12) / floor).log10() / -ACTIVE_DB)
                .clamp(0.0, 1.0)
                .powf(1.5)
        })
        .collect();
    smooth(&raw, 2)
}

/// Means over `reach` neighbours on each side, twice: a triangle.
pub(crate) fn smooth(values: &[f32], reach: usize) -> Vec<f32> {
    let once = |values: &[f32]| -> Vec<f32> {
        (0..values.len())
            .map(|at| {
                let part = &values[at.saturating_sub(reach)..(at + reach + 1).min(values.len())];
                part.iter().sum::<f32>() / part.len() as f32
            })
            .collect()
    };
    once(&once(values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speech_is_where_it_was_put() {
        let utterance = Utterance {
            samples: vec![1.0; 160],
            mouth: vec![1.0, 0.5],
        };
        let speech = Speech::new(16_000, vec![(1600, utterance.clone()), (320, utterance)]);
        let mut samples = [0.0; 2000];
        speech.fill(0, &mut samples);
        assert_eq!(samples.iter().sum::<f32>(), 320.0);
        assert_eq!((samples[319], samples[320], samples[1600]), (0.0, 1.0, 1.0));
        let mut part = [0.0; 10];
        speech.fill(475, &mut part);
        assert_eq!(part, [1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(speech.mouth_opening(0.0), 0.0);
        assert!((speech.mouth_opening(0.1 + 0.005) - 0.75).abs() < 1e-6);
        assert_eq!(speech.mouth_opening(0.5), 0.0);
        assert_eq!(speech.spans_s().collect::<Vec<_>>(), [[0.02, 0.03], [0.1, 0.11]]);
    }

    #[test]
    fn pauses_do_not_count_for_the_level() {
        let mut samples: Vec<f32> = (0..32_000)
            .map(|n| if n % 8000 < 4000 { 0.01 } else { 0.0 })
            .collect();
        normalize(&mut samples, 16_000);
        assert!((samples[0] - 1.0).abs() < 0.01);
        let mut silence = [0.0; 100];
        normalize(&mut silence, 16_000);
        assert_eq!(silence, [0.0; 100]);
    }
}
