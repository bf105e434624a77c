//! Built-in talkers are like speech, and unlike each other.

use super::*;
use crate::acoustics::Sound;
use crate::voice::speech::loudness;
use realfft::RealFftPlanner;

const RATE: u32 = 16_000;

fn turn(start_s: f64, end_s: f64) -> Vec<Turn> {
    vec![Turn {
        person: 0,
        start_s,
        end_s,
    }]
}

fn samples(talker: &Talker, start_s: f64, length_s: f64) -> Vec<f32> {
    let speech = talker.speak(&turn(start_s, start_s + length_s), 0, RATE).unwrap();
    let mut samples = vec![0.0; (length_s * f64::from(RATE)) as usize];
    speech.fill((start_s * f64::from(RATE)).round() as i64, &mut samples);
    samples
}

fn talkers() -> Vec<Talker> {
    (0..20)
        .map(|number| {
            let kind = [
                TalkerKind::Man,
                TalkerKind::Woman,
                TalkerKind::Man,
                TalkerKind::Woman,
                TalkerKind::Child,
            ];
            Talker::new(kind[number as usize % 5], 100 + number)
        })
        .collect()
}

/// Mean power of each bin, of Hann windows of 1024 samples.
fn long_term(samples: &[f32]) -> Vec<f64> {
    let length = 1024;
    let forward = RealFftPlanner::<f32>::new().plan_fft_forward(length);
    let mut mean = vec![0.0; length / 2 + 1];
    let mut spectrum = forward.make_output_vec();
    for window in samples.windows(length).step_by(length / 2) {
        let mut windowed: Vec<f32> = window
            .iter()
            .enumerate()
            .map(|(n, x)| x * (std::f32::consts::PI * n as f32 / length as f32).sin().powi(2))
            .collect();
        forward.process(&mut windowed, &mut spectrum).unwrap();
        for (mean, bin) in mean.iter_mut().zip(&spectrum) {
            *mean += f64::from(bin.norm_sqr());
        }
    }
    mean
}

/// Pitch of voiced frames by the highest peak of the autocorrelation, hertz: the median.
fn median_pitch(samples: &[f32]) -> f64 {
    let mut found = Vec::new();
    for frame in samples.windows(800).step_by(400) {
        let energy: f32 = frame.iter().map(|x| x * x).sum();
        if energy < 80.0 {
            continue;
        }
        let value = |lag: usize| {
            let product: f32 = frame[lag..].iter().zip(frame).map(|(a, b)| a * b).sum();
            let left: f32 = frame[lag..].iter().map(|x| x * x).sum();
            let right: f32 = frame[..800 - lag].iter().map(|x| x * x).sum();
            product / (left * right).sqrt().max(1e-9)
        };
        let values: Vec<f32> = (38..230).map(value).collect();
        let highest = values.iter().copied().fold(f32::MIN, f32::max);
        if highest < 0.6 {
            continue;
        }
        // The first peak nearly as high: not a multiple of the period.
        let peak = (1..values.len() - 1).find(|at| {
            values[*at] > 0.9 * highest && values[*at] >= values[at - 1] && values[*at] >= values[at + 1]
        });
        if let Some(peak) = peak {
            found.push(f64::from(RATE) / (38 + peak) as f64);
        }
    }
    found.sort_by(f64::total_cmp);
    found[found.len() / 2]
}

/// Median pitch, and the level of 18 bands against their mean.
fn features(samples: &[f32]) -> Vec<f64> {
    let power = long_term(samples);
    let edges: Vec<usize> = (0..=18)
        .map(|band| (10.0 * 1.243_f64.powi(band)) as usize)
        .map(|bin| bin.min(512))
        .collect();
    let mut bands: Vec<f64> = edges
        .windows(2)
        .map(|edge| 10.0 * (power[edge[0]..edge[1]].iter().sum::<f64>() + 1e-9).log10())
        .collect();
    let mean = bands.iter().sum::<f64>() / bands.len() as f64;
    bands.iter_mut().for_each(|band| *band -= mean);
    // Half a semitone of pitch counts as much as a decibel in one band.
    bands.push(24.0 * median_pitch(samples).log2());
    bands
}

#[test]
fn voices_are_known_again() {
    let talkers = talkers();
    // Each voice is learnt from two utterances, and how much each feature varies within voices from those of all.
    let pairs: Vec<[Vec<f64>; 2]> = talkers
        .iter()
        .map(|talker| [10.0, 50.0].map(|start| features(&samples(talker, start, 15.0))))
        .collect();
    let count = pairs[0][0].len();
    let spread: Vec<f64> = (0..count)
        .map(|at| pairs.iter().map(|[a, b]| (a[at] - b[at]).powi(2)).sum::<f64>() / pairs.len() as f64)
        .collect();
    let (mut right, mut all) = (0, 0);
    for (number, talker) in talkers.iter().enumerate() {
        for start in [90.0, 130.0] {
            let heard = features(&samples(talker, start, 8.0));
            let apart = |voice: &usize| -> f64 {
                let [a, b] = &pairs[*voice];
                (0..count)
                    .map(|at| (0.5 * (a[at] + b[at]) - heard[at]).powi(2) / spread[at])
                    .sum()
            };
            let nearest = (0..20).min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap();
            right += usize::from(nearest == number);
            all += 1;
        }
    }
    println!("{right} of {all} utterances known by pitch and spectrum");
    assert!(right * 100 >= all * 95);
}

#[test]
fn pitch_is_that_of_the_voice() {
    for talker in talkers() {
        let found = median_pitch(&samples(&talker, 3.0, 12.0));
        let octaves = (found / talker.pitch_hz()).log2();
        println!("{:.0} Hz heard at {found:.0}", talker.pitch_hz());
        assert!(octaves.abs() < 0.25);
    }
}

#[test]
fn it_sounds_like_speech() {
    let (mut pauses, mut rates) = (Vec::new(), Vec::new());
    for talker in talkers() {
        let samples = samples(&talker, 1.0, 40.0);
        let loudness = loudness(&samples, RATE);
        // The level of speech is 1; pauses are 20 dB below it.
        let quiet = loudness.iter().filter(|value| **value < 0.01).count();
        pauses.push(quiet as f64 / loudness.len() as f64);
        let power = long_term(&samples);
        let whole: f64 = power.iter().sum();
        let within = |low: usize, high: usize| power[low..high].iter().sum::<f64>() / whole;
        // Bins are 15.6 Hz apart.
        // From 78 Hz on: deep voices begin there.
        assert!(within(5, 512) > 0.95);
        let high = 10.0 * within(256, 512).log10();
        // Recordings of read speech have -13 to -42 dB there.
        assert!((-42.0..-12.0).contains(&high), "above 4 kHz {high} dB");
        // Modulation of loudness: most between 2 and 8 Hz, as syllables.
        let level: Vec<f32> = loudness.iter().map(|value| value.sqrt()).collect();
        rates.push(modulation_hz(&level));
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    println!(
        "pauses {:.2}, modulation around {:.2} Hz",
        mean(&pauses),
        mean(&rates)
    );
    assert!((0.28..0.42).contains(&mean(&pauses)));
    assert!((3.0..5.5).contains(&mean(&rates)));
}

/// The middle of the power of modulation between 1 and 16 Hz.
fn modulation_hz(level: &[f32]) -> f64 {
    let forward = RealFftPlanner::<f32>::new().plan_fft_forward(level.len());
    let mean = level.iter().sum::<f32>() / level.len() as f32;
    let mut input: Vec<f32> = level.iter().map(|value| value - mean).collect();
    let mut spectrum = forward.make_output_vec();
    forward.process(&mut input, &mut spectrum).unwrap();
    let per_bin = 100.0 / level.len() as f64;
    let band = spectrum
        .iter()
        .enumerate()
        .map(|(bin, value)| (bin as f64 * per_bin, f64::from(value.norm_sqr())));
    let (mut sum, mut whole) = (0.0, 0.0);
    for (frequency, power) in band.filter(|(frequency, _)| (1.0..16.0).contains(frequency)) {
        sum += frequency.ln() * power;
        whole += power;
    }
    (sum / whole).exp()
}

#[test]
fn the_mouth_moves_with_the_syllables() {
    let talker = Talker::new(TalkerKind::Woman, 5);
    let speech = talker.speak(&turn(1.0, 21.0), 0, RATE).unwrap();
    let mut samples = vec![0.0; 20 * RATE as usize];
    speech.fill(i64::from(RATE), &mut samples);
    let level: Vec<f64> = loudness(&samples, RATE)
        .iter()
        .map(|value| f64::from(value.sqrt()))
        .collect();
    let mouth: Vec<f64> = (0..level.len())
        .map(|n| speech.mouth_opening(1.005 + n as f64 * 0.01))
        .collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (a, b) = (mean(&level), mean(&mouth));
    let product: f64 = level.iter().zip(&mouth).map(|(x, y)| (x - a) * (y - b)).sum();
    let squares: f64 = level.iter().map(|x| (x - a).powi(2)).sum::<f64>()
        * mouth.iter().map(|y| (y - b).powi(2)).sum::<f64>();
    let correlation = product / squares.sqrt();
    println!(
        "loudness and mouth correlate by {correlation:.2}; it opens up to {:.2}",
        mouth.iter().copied().fold(0.0, f64::max)
    );
    assert!(correlation > 0.5);
    assert!(mouth.iter().any(|opening| *opening > 0.6) && mouth.iter().any(|opening| *opening < 0.05));
    assert_eq!(speech.mouth_opening(0.5), 0.0);
    assert_eq!(speech.mouth_opening(30.0), 0.0);
}

#[test]
fn a_turn_does_not_depend_on_the_others() {
    let talker = Talker::new(TalkerKind::Man, 1);
    let alone = samples(&talker, 4.0, 2.0);
    let mut turns = turn(0.5, 3.0);
    turns.extend(turn(4.0, 6.0));
    turns.push(Turn {
        person: 1,
        start_s: 4.5,
        end_s: 9.0,
    });
    let speech = talker.speak(&turns, 0, RATE).unwrap();
    let mut among = vec![0.0; alone.len()];
    speech.fill(64_000, &mut among);
    assert_eq!(alone, among);
    assert_eq!(speech.spans_s().count(), 2);
    assert!(among.iter().all(|sample| sample.is_finite()));
    assert!(talker.speak(&turn(3.0, 1.0), 0, RATE).is_err());
    assert!(talker.speak(&turn(f64::NAN, 1.0), 0, RATE).is_err());
}
