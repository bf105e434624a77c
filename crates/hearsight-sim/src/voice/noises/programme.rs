//! What a television says and plays, and telephones.

use crate::acoustics::random::{Generator, between, derive, generator};
use crate::acoustics::{AcousticsError, Sound};
use crate::voice::talker::{Talker, TalkerKind};
use crate::voice::turns::Turn;
use std::f64::consts::TAU;

/// Somebody talks, then there is music, in turn.
pub(super) fn television(length_s: f64, rate_hz: u32, seed: u64) -> Result<Vec<f32>, AcousticsError> {
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

pub(super) fn telephone(length_s: f64, rate: f64) -> Vec<f32> {
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
