//! What else makes sound: fans, streets, televisions, telephones, and people who cough, laugh and clap.

use super::speech::loudness;
use super::talker::{Talker, TalkerKind};
use super::turns::Turn;
use crate::acoustics::error::check;
use crate::acoustics::random::{Generator, between, derive, generator, normal};
use crate::acoustics::source::add_clip;
use crate::acoustics::{AcousticsError, Sound};
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

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

/// How the level of lasting noise moves.
#[derive(Clone, Debug)]
struct Swell {
    /// Decibels up and down.
    depth_db: f64,
    phases: [f64; 3],
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

impl Swell {
    fn none() -> Self {
        Self {
            depth_db: 0.0,
            phases: [0.0; 3],
        }
    }

    fn gain(&self, time_s: f64) -> f64 {
        if self.depth_db == 0.0 {
            return 1.0;
        }
        // Periods that do not fit each other: no two passes alike.
        let [a, b, c] = self.phases;
        let sum = (TAU * (time_s / 7.3 + a)).sin()
            + 0.7 * (TAU * (time_s / 4.1 + b)).sin()
            + 0.5 * (TAU * (time_s / 2.3 + c)).sin();
        10.0_f64.powf(self.depth_db * sum / 2.2 / 20.0)
    }
}

/// Two periods of noise of this spectrum of amplitudes, each of some seconds, together of variance 1.
fn periods(rate_hz: u32, seed: u64, amplitude: impl Fn(f64) -> f64) -> Vec<Vec<f32>> {
    // Seconds without a common measure: the sum repeats after hours.
    [5.03, 7.19]
        .iter()
        .enumerate()
        .map(|(number, seconds)| {
            let length = (seconds * f64::from(rate_hz)) as usize / 2 * 2;
            let inverse = RealFftPlanner::<f32>::new().plan_fft_inverse(length);
            let mut random = generator(seed, "noise", number as u64);
            let mut spectrum = inverse.make_input_vec();
            let bins = spectrum.len();
            for (bin, value) in spectrum.iter_mut().enumerate().take(bins - 1).skip(1) {
                let gain = amplitude(bin as f64 * f64::from(rate_hz) / length as f64) as f32;
                *value = Complex::new(normal(&mut random) as f32, normal(&mut random) as f32) * gain;
            }
            let mut samples = inverse.make_output_vec();
            // Fails only for buffers of a wrong length, and these are its own.
            if inverse.process(&mut spectrum, &mut samples).is_err() {
                samples.fill(0.0);
            }
            let power = samples
                .iter()
                .map(|sample| f64::from(sample * sample))
                .sum::<f64>()
                / length as f64;
            let scale = if power > 0.0 {
                (0.5 / power).sqrt() as f32
            } else {
                0.0
            };
            samples.iter_mut().for_each(|sample| *sample *= scale);
            samples
        })
        .collect()
}

fn fan(rate_hz: u32, seed: u64) -> Form {
    let mut random = generator(seed, "fan", 0);
    let hum_hz = if between(&mut random, 0.0, 1.0) < 0.5 {
        100.0
    } else {
        120.0
    };
    let blades_hz = between(&mut random, 60.0, 240.0);
    let fall = |hz: f64| (hz.max(80.0) / 80.0).powf(-4.0 / 6.02) * if hz < 40.0 { 0.1 } else { 1.0 };
    // Hum: narrow peaks in the spectrum, not quite steady, as motors are.
    let peak = |hz: f64, middle: f64| (-((hz - middle) / 0.6).powi(2)).exp();
    let spectrum = |hz: f64| {
        let hum: f64 = (1..=3)
            .map(|n| peak(hz, hum_hz * f64::from(n)) * 12.0 / f64::from(n))
            .sum();
        let blades: f64 = (1..=4)
            .map(|n| peak(hz, blades_hz * f64::from(n)) * 8.0 / f64::from(n))
            .sum();
        fall(hz) * (1.0 + hum + blades)
    };
    Form::Lasting(periods(rate_hz, seed, spectrum), Swell::none())
}

fn street(rate_hz: u32, seed: u64) -> Form {
    let mut random = generator(seed, "street", 0);
    let swell = Swell {
        depth_db: 6.0,
        phases: [0; 3].map(|_| between(&mut random, 0.0, 1.0)),
    };
    // Engines below 200 Hz, tyres around 1 kHz.
    let spectrum = |hz: f64| {
        let low = (hz.max(60.0) / 60.0).powf(-1.1) * if hz < 30.0 { 0.0 } else { 1.0 };
        low + 0.12 * (-((hz.max(1.0) / 900.0).ln() / 0.7).powi(2)).exp()
    };
    Form::Lasting(periods(rate_hz, seed, spectrum), swell)
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

fn television(length_s: f64, rate_hz: u32, seed: u64) -> Result<Vec<f32>, AcousticsError> {
    let rate = f64::from(rate_hz);
    let mut samples = vec![0.0; (length_s * rate) as usize];
    let mut random = generator(seed, "television", 0);
    let mut from_s = 0.0;
    while from_s < length_s {
        let talk_s = between(&mut random, 3.0, 9.0);
        let kind = [TalkerKind::Man, TalkerKind::Woman][usize::from(between(&mut random, 0.0, 1.0) < 0.5)];
        let talker = Talker::new(kind, derive(seed, "speaker", (from_s * 10.0) as u64));
        let turn = Turn {
            person: 0,
            start_s: from_s,
            end_s: (from_s + talk_s).min(length_s),
        };
        let speech = talker.speak(&[turn], 0, rate_hz)?;
        let mut heard = vec![0.0; samples.len()];
        speech.fill(0, &mut heard);
        for (sample, heard) in samples.iter_mut().zip(&heard) {
            *sample += heard;
        }
        from_s += talk_s;
        let tune_s = between(&mut random, 1.5, 4.0);
        tune(
            &mut samples,
            rate,
            from_s,
            (from_s + tune_s).min(length_s),
            &mut random,
        );
        from_s += tune_s + 0.2;
    }
    Ok(samples)
}

/// Tones of a scale with overtones, struck and fading, two at a time.
fn tune(samples: &mut [f32], rate: f64, from_s: f64, to_s: f64, random: &mut Generator) {
    let mut at_s = from_s;
    while at_s < to_s {
        let length_s = between(random, 0.18, 0.4).min(to_s - at_s);
        for _ in 0..2 {
            let step = [0.0, 2.0, 4.0, 7.0, 9.0, 12.0][(between(random, 0.0, 6.0) as usize).min(5)];
            let hz = 220.0 * 2.0_f64.powf(step / 12.0 + (between(random, 0.0, 2.0) as usize) as f64);
            let begin = (at_s * rate) as usize;
            for n in 0..(length_s * rate) as usize {
                let Some(sample) = samples.get_mut(begin + n) else {
                    break;
                };
                let time = n as f64 / rate;
                let shape =
                    (time / 0.01).min(1.0) * ((length_s - time) / 0.02).min(1.0) * (-time / 0.25).exp();
                let tone: f64 = (1..=4)
                    .filter(|overtone| hz * f64::from(*overtone) < 0.45 * rate)
                    .map(|overtone| (TAU * hz * f64::from(overtone) * time).sin() / f64::from(overtone))
                    .sum();
                *sample += (0.9 * shape * tone) as f32;
            }
        }
        at_s += length_s;
    }
}

fn telephone(length_s: f64, rate: f64) -> Vec<f32> {
    (0..(length_s * rate) as usize)
        .map(|n| {
            let time = n as f64 / rate;
            let within = time % 3.0;
            if within >= 1.0 {
                return 0.0;
            }
            // Two tones, 20 changes a second; both with their odd overtone, as small loudspeakers have.
            let hz = if (time * 20.0) as i64 % 2 == 0 {
                1000.0
            } else {
                1250.0
            };
            let edge = (within / 0.01).min(1.0) * ((1.0 - within) / 0.01).min(1.0);
            (edge * ((TAU * hz * time).sin() + 0.2 * (3.0 * TAU * hz * time).sin())) as f32
        })
        .collect()
}

/// Noise through a resonance that moves, shaped by `envelope` of the share of the length.
fn burst(
    samples: &mut [f32],
    rate: f64,
    from_s: f64,
    length_s: f64,
    hz: [f64; 2],
    width_hz: f64,
    random: &mut Generator,
    envelope: impl Fn(f64) -> f64,
) {
    let begin = (from_s * rate) as usize;
    let count = (length_s * rate) as usize;
    let (mut before, mut last) = (0.0, 0.0);
    for n in 0..count {
        let Some(sample) = samples.get_mut(begin + n) else {
            break;
        };
        let share = n as f64 / count as f64;
        let radius = (-PI * width_hz / rate).exp();
        let middle = (hz[0] + share * (hz[1] - hz[0])).min(0.45 * rate);
        let value = normal(random) * (1.0 - radius) + 2.0 * radius * (TAU * middle / rate).cos() * last
            - radius * radius * before;
        (before, last) = (last, value);
        *sample += (envelope(share) * value) as f32;
    }
}

fn coughs(length_s: f64, rate: f64, seed: u64) -> Vec<f32> {
    let mut samples = vec![0.0; (length_s * rate) as usize];
    let mut random = generator(seed, "cough", 0);
    let mut at_s = 0.0;
    while at_s < length_s {
        for _ in 0..2 + usize::from(between(&mut random, 0.0, 1.0) < 0.5) {
            let long_s = between(&mut random, 0.2, 0.32);
            // A blow, then breath.
            let shape = |share: f64| (-share * 9.0).exp() + 0.15 * (PI * share).sin();
            burst(
                &mut samples,
                rate,
                at_s,
                long_s,
                [900.0, 600.0],
                600.0,
                &mut random,
                shape,
            );
            burst(
                &mut samples,
                rate,
                at_s,
                long_s,
                [2600.0, 2200.0],
                1200.0,
                &mut random,
                |share| 0.5 * shape(share),
            );
            at_s += long_s + between(&mut random, 0.05, 0.15);
        }
        at_s += between(&mut random, 2.0, 6.0);
    }
    samples
}

fn laughter(length_s: f64, rate: f64, seed: u64) -> Vec<f32> {
    let mut samples = vec![0.0; (length_s * rate) as usize];
    let mut random = generator(seed, "laugh", 0);
    let (mut pitch_hz, mut at_s) = (between(&mut random, 180.0, 350.0), 0.0);
    let usual_hz = pitch_hz;
    while at_s < length_s {
        // Ha: breath, then voice that falls, about five a second; breath is drawn after some of them.
        let voiced_s = between(&mut random, 0.07, 0.11);
        burst(
            &mut samples,
            rate,
            at_s,
            0.06,
            [1200.0, 1000.0],
            900.0,
            &mut random,
            |share| 0.4 * (PI * share).sin(),
        );
        let begin = ((at_s + 0.05) * rate) as usize;
        let count = (voiced_s * rate) as usize;
        let (mut phase, mut memory) = (0.0, [[0.0; 2]; 3]);
        for n in 0..count {
            let Some(sample) = samples.get_mut(begin + n) else {
                break;
            };
            let share = n as f64 / count as f64;
            phase = (phase + pitch_hz * (1.1 - 0.2 * share) / rate) % 1.0;
            let mut value = if phase < 0.6 {
                (PI * phase / 0.6).sin() - 0.38
            } else {
                -0.38
            };
            for (memory, (hz, width_hz)) in
                memory
                    .iter_mut()
                    .zip([(750.0, 90.0), (1250.0, 110.0), (2500.0, 160.0)])
            {
                let radius: f64 = (-PI * width_hz / rate).exp();
                let (b, c) = (2.0 * radius * (TAU * hz / rate).cos(), -radius * radius);
                value = (1.0 - b - c) * value + b * memory[0] + c * memory[1];
                *memory = [value, memory[0]];
            }
            *sample += ((PI * share).sin() * value) as f32;
        }
        pitch_hz *= between(&mut random, 0.93, 1.0);
        at_s += voiced_s + between(&mut random, 0.08, 0.13);
        if pitch_hz < 0.7 * usual_hz {
            burst(
                &mut samples,
                rate,
                at_s,
                0.3,
                [1500.0, 2200.0],
                1500.0,
                &mut random,
                |share| 0.15 * (PI * share).sin(),
            );
            at_s += 0.4;
            pitch_hz = usual_hz * between(&mut random, 0.9, 1.15);
        }
    }
    samples
}

fn claps(length_s: f64, rate: f64, seed: u64) -> Vec<f32> {
    let mut samples = vec![0.0; (length_s * rate) as usize];
    let mut random = generator(seed, "clap", 0);
    let hollow_hz = between(&mut random, 900.0, 1800.0);
    let mut at_s = 0.0;
    while at_s < length_s {
        let strength = between(&mut random, 0.7, 1.0);
        burst(
            &mut samples,
            rate,
            at_s,
            0.05,
            [hollow_hz; 2],
            700.0,
            &mut random,
            |share| strength * (-share * 14.0).exp(),
        );
        burst(
            &mut samples,
            rate,
            at_s,
            0.02,
            [3200.0; 2],
            3000.0,
            &mut random,
            |share| strength * (-share * 10.0).exp(),
        );
        if length_s <= 1.0 {
            break;
        }
        at_s += between(&mut random, 0.2, 0.28);
    }
    samples
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [NoiseKind; 8] = [
        NoiseKind::Fan,
        NoiseKind::Street,
        NoiseKind::Band {
            low_hz: 1000.0,
            high_hz: 2000.0,
        },
        NoiseKind::Television,
        NoiseKind::Telephone,
        NoiseKind::Cough,
        NoiseKind::Laugh,
        NoiseKind::Clap,
    ];

    fn samples(noise: &Noise, first: i64, count: usize) -> Vec<f32> {
        let mut samples = vec![9.0; count];
        noise.fill(first, &mut samples);
        samples
    }

    #[test]
    fn noises_sound_within_their_spans_and_nowhere_else() {
        for kind in KINDS {
            let noise = Noise::new(kind, &[[0.5, 2.5], [4.0, 9.0]], 16_000, 3).unwrap();
            let all = samples(&noise, 0, 160_000);
            assert!(all.iter().all(|sample| sample.is_finite()), "{kind:?}");
            let energy = |from: usize, to: usize| all[from..to].iter().map(|x| x * x).sum::<f32>();
            assert_eq!(
                energy(0, 8000) + energy(40_000, 64_000) + energy(144_000, 160_000),
                0.0,
                "{kind:?}"
            );
            assert!(
                energy(8000, 40_000) > 100.0 && energy(64_000, 144_000) > 100.0,
                "{kind:?}"
            );
            // In parts, and once more.
            let parts: Vec<f32> = [0, 70_001, 70_002]
                .iter()
                .zip([70_001, 1, 89_998])
                .flat_map(|(first, count)| samples(&noise, *first, count))
                .collect();
            assert_eq!(all, parts, "{kind:?}");
            assert_eq!(
                all,
                samples(
                    &Noise::new(kind, &[[0.5, 2.5], [4.0, 9.0]], 16_000, 3).unwrap(),
                    0,
                    160_000
                )
            );
        }
    }

    #[test]
    fn levels_are_the_same() {
        for kind in KINDS {
            let noise = Noise::new(kind, &[[0.0, 20.0]], 16_000, 1).unwrap();
            let loudness = loudness(&samples(&noise, 0, 320_000), 16_000);
            let loudest = loudness.windows(10).map(mean).fold(0.0, f32::max);
            let whole = mean(&loudness);
            println!("{kind:?}: loudest {loudest:.2}, mean {whole:.3}");
            match kind {
                NoiseKind::Fan | NoiseKind::Band { .. } => assert!((whole - 1.0).abs() < 0.1),
                NoiseKind::Street => assert!((0.5..2.0).contains(&whole)),
                _ => assert!((loudest - 1.0).abs() < 0.01),
            }
        }
    }

    #[test]
    fn a_band_stays_in_its_band() {
        let kind = NoiseKind::Band {
            low_hz: 1000.0,
            high_hz: 2000.0,
        };
        let noise = Noise::new(kind, &[[0.0, 10.0]], 16_000, 1).unwrap();
        let mut input = samples(&noise, 16_000, 65_536);
        for (n, sample) in input.iter_mut().enumerate() {
            *sample *= (PI * n as f64 / 65_536.0).sin().powi(2) as f32;
        }
        let forward = RealFftPlanner::<f32>::new().plan_fft_forward(65_536);
        let mut spectrum = forward.make_output_vec();
        forward.process(&mut input, &mut spectrum).unwrap();
        let power = |low: f64, high: f64| -> f32 {
            let bin = |hz: f64| (hz / 16_000.0 * 65_536.0) as usize;
            spectrum[bin(low)..bin(high)]
                .iter()
                .map(|value| value.norm_sqr())
                .sum()
        };
        assert!(power(990.0, 2010.0) > 1e4 * (power(0.0, 990.0) + power(2010.0, 8000.0)));
    }

    #[test]
    fn impossible_noises_are_refused() {
        let make = |kind, spans: &[[f64; 2]]| Noise::new(kind, spans, 16_000, 0);
        assert!(
            make(NoiseKind::Fan, &[[1.0, 2.0], [1.5, 3.0]])
                .unwrap_err()
                .to_string()
                .contains("span 1")
        );
        assert!(make(NoiseKind::Fan, &[[f64::NAN, 2.0]]).is_err());
        assert!(make(NoiseKind::Laugh, &[[0.0, 1e6]]).is_err());
        assert!(
            make(
                NoiseKind::Band {
                    low_hz: 100.0,
                    high_hz: 9000.0
                },
                &[[0.0, 1.0]]
            )
            .is_err()
        );
        assert!(
            make(
                NoiseKind::Band {
                    low_hz: -1.0,
                    high_hz: 900.0
                },
                &[[0.0, 1.0]]
            )
            .is_err()
        );
    }
}
