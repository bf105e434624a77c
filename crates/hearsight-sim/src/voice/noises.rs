//! What else makes sound: fans, streets, televisions, telephones, and people who cough, laugh and clap.

mod bursts;
mod lasting;
mod programme;

use super::speech::loudness;
use crate::acoustics::error::check;
use crate::acoustics::random::derive;
use crate::acoustics::source::add_clip;
use crate::acoustics::{AcousticsError, Sound};
use bursts::{claps, coughs, laughter};
use lasting::{Swell, fan, periods, street};
use programme::{telephone, television};
use serde::{Deserialize, Serialize};

/// A kind of noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case", tag = "kind", deny_unknown_fields)]
pub enum NoiseKind {
    /// A fan or an air conditioner: broad-band, falling by 4 dB an octave, with the hum of its motor and blades.
    Fan,
    /// A street: dull, swelling as cars pass.
    Street,
    /// Noise between two frequencies.
    Band {
        /// Lowest, hertz, above 0.
        low_hz: f64,
        /// Highest, hertz, below half the rate.
        high_hz: f64,
    },
    /// A television: somebody talks, and between that, tones like music.
    Television,
    /// A telephone that rings: two tones in turn, a second on and two off.
    Telephone,
    /// A cough of two or three bursts, at the begin of each span and every few seconds after.
    Cough,
    /// Laughter as long as each span.
    Laugh,
    /// Hands that clap once at the begin of each span; in spans above a second, applause of one person.
    Clap,
}

/// Samples of a noise within spans of time.
///
/// While it sounds, noise that lasts has a root mean square of 1; what comes in bursts has it over the loudest 100 ms.
#[derive(Clone, Debug)]
pub struct Noise {
    rate_hz: u32,
    /// First samples and lengths, in order and apart.
    spans: Vec<[i64; 2]>,
    form: Form,
}

#[derive(Clone, Debug)]
enum Form {
    /// Periods that repeat, added: together they repeat after a very long time.
    Lasting(Vec<Vec<f32>>, Swell),
    /// For each span what sounds in it.
    Clips(Vec<Vec<f32>>),
}

/// Lasting noise fades in and out in so many seconds.
const RAMP_S: f64 = 0.03;
/// Longest sum of spans of clips, seconds.
const LONGEST_S: f64 = 7200.0;

impl Noise {
    /// A noise of a kind that sounds in `spans_s` (from, to, seconds of the scenario) and always the same for one seed.
    ///
    /// # Errors
    /// [`AcousticsError::Setting`] where spans are not in order and apart, begin before 0 s, or are too long; for a rate
    /// outside 8000 to 192000 Hz; for frequencies that the rate cannot have.
    pub fn new(
        kind: NoiseKind,
        spans_s: &[[f64; 2]],
        rate_hz: u32,
        seed: u64,
    ) -> Result<Self, AcousticsError> {
        let rate = f64::from(rate_hz);
        check(
            (8000..=192_000).contains(&rate_hz),
            "the rate of noise",
            "within 8000 and 192000 Hz",
            rate,
        )?;
        let mut reached = 0.0;
        for (number, [from, to]) in spans_s.iter().enumerate() {
            let fits = *from >= reached && to > from && *to < 1e9;
            check(
                fits,
                format!("span {number} of a noise"),
                "after the span before it, and not empty",
                *from,
            )?;
            reached = *to;
        }
        let spans: Vec<[i64; 2]> = spans_s
            .iter()
            .map(|[from, to]| [(from * rate).round() as i64, ((to - from) * rate).round() as i64])
            .collect();
        let form = match kind {
            NoiseKind::Fan => fan(rate_hz, seed),
            NoiseKind::Street => street(rate_hz, seed),
            NoiseKind::Band { low_hz, high_hz } => {
                check(
                    low_hz > 0.0 && low_hz < high_hz,
                    "low_hz of a noise",
                    "above 0 and below high_hz",
                    low_hz,
                )?;
                check(
                    high_hz <= 0.5 * rate,
                    "high_hz of a noise",
                    "at most half the rate",
                    high_hz,
                )?;
                let inside = |hz: f64| {
                    if (low_hz..=high_hz).contains(&hz) {
                        1.0
                    } else {
                        0.0
                    }
                };
                Form::Lasting(periods(rate_hz, seed, inside), Swell::none())
            }
            NoiseKind::Television => clips(spans_s, seed, |length_s, seed| {
                television(length_s, rate_hz, seed)
            })?,
            NoiseKind::Telephone => clips(spans_s, seed, |length_s, _| Ok(telephone(length_s, rate)))?,
            NoiseKind::Cough => clips(spans_s, seed, |length_s, seed| Ok(coughs(length_s, rate, seed)))?,
            NoiseKind::Laugh => clips(spans_s, seed, |length_s, seed| Ok(laughter(length_s, rate, seed)))?,
            NoiseKind::Clap => clips(spans_s, seed, |length_s, seed| Ok(claps(length_s, rate, seed)))?,
        };
        let mut noise = Self { rate_hz, spans, form };
        noise.level();
        Ok(noise)
    }

    fn level(&mut self) {
        if let Form::Clips(clips) = &mut self.form {
            for clip in clips {
                let loudness = loudness(clip, self.rate_hz);
                let loudest = loudness
                    .windows(10.min(loudness.len().max(1)))
                    .map(mean)
                    .fold(0.0, f32::max);
                if loudest > 0.0 {
                    clip.iter_mut().for_each(|sample| *sample /= loudest.sqrt());
                }
            }
        }
    }
}

fn mean(values: &[f32]) -> f32 {
    values.iter().sum::<f32>() / values.len() as f32
}

impl Sound for Noise {
    fn rate_hz(&self) -> u32 {
        self.rate_hz
    }

    fn fill(&self, first: i64, samples: &mut [f32]) {
        samples.fill(0.0);
        let end = first + samples.len() as i64;
        let begin = self
            .spans
            .partition_point(|[from, length]| from + length <= first);
        for (number, [from, length]) in self.spans.iter().enumerate().skip(begin) {
            if *from >= end {
                break;
            }
            match &self.form {
                Form::Clips(clips) => add_clip(*from, &clips[number], first, samples),
                Form::Lasting(periods, swell) => {
                    let to = (from + length).min(end);
                    for sample in (*from).max(first)..to {
                        let value: f32 = periods
                            .iter()
                            .map(|period| period[sample.rem_euclid(period.len() as i64) as usize])
                            .sum();
                        let time_s = sample as f64 / f64::from(self.rate_hz);
                        let ramp = RAMP_S * f64::from(self.rate_hz);
                        let near = (sample - from + 1).min(from + length - sample) as f64 / ramp;
                        samples[(sample - first) as usize] =
                            value * (near.min(1.0) * swell.gain(time_s)) as f32;
                    }
                }
            }
        }
    }
}

/// One clip for each span.
fn clips(
    spans_s: &[[f64; 2]],
    seed: u64,
    make: impl Fn(f64, u64) -> Result<Vec<f32>, AcousticsError>,
) -> Result<Form, AcousticsError> {
    let total: f64 = spans_s.iter().map(|[from, to]| to - from).sum();
    check(
        total <= LONGEST_S,
        "the spans of a noise together",
        "at most 7200 s",
        total,
    )?;
    let made = spans_s
        .iter()
        .enumerate()
        .map(|(number, [from, to])| make(to - from, derive(seed, "span", number as u64)));
    Ok(Form::Clips(made.collect::<Result<_, _>>()?))
}

#[cfg(test)]
mod tests;
