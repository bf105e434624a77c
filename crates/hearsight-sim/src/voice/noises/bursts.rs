//! What bodies do besides speaking: coughs, laughter, claps.

use crate::acoustics::random::{Generator, between, generator, normal};
use std::f64::consts::{PI, TAU};

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

pub(super) fn coughs(length_s: f64, rate: f64, seed: u64) -> Vec<f32> {
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

pub(super) fn laughter(length_s: f64, rate: f64, seed: u64) -> Vec<f32> {
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

pub(super) fn claps(length_s: f64, rate: f64, seed: u64) -> Vec<f32> {
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
