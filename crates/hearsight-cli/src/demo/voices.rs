//! What both microphones hear: voices, each delayed by its way through the air, and a little noise.

use super::world::{MICROPHONES_M, Noise, RATE_HZ, SPEED_OF_SOUND_M_S, World};
use std::f64::consts::TAU;

/// Standard deviation of the noise, full scale being 1.
const NOISE: f64 = 0.002;
/// Syllables a second.
const SYLLABLES_HZ: f64 = 4.0;

/// The samples of left and right.
pub(crate) fn render(world: &World) -> impl Iterator<Item = [f32; 2]> {
    let rate = f64::from(RATE_HZ);
    let count = (world.seconds * rate) as usize;
    let voices = [voice(world, 0), voice(world, 1)];
    let mut noise = Noise::new(11);
    let world = *world;
    (0..count).map(move |sample| {
        let time_s = sample as f64 / rate;
        let people = world.people(time_s);
        let mut heard = [0.0; 2];
        for (channel, microphone) in MICROPHONES_M.iter().enumerate() {
            for (voice, person) in voices.iter().zip(&people) {
                let way: f64 = microphone
                    .iter()
                    .zip(person.mouth_m)
                    .map(|(a, b)| (a - b).powi(2))
                    .sum();
                let way_m = way.sqrt();
                heard[channel] += at(voice, (time_s - way_m / SPEED_OF_SOUND_M_S) * rate) / way_m;
            }
            heard[channel] += NOISE * noise.normal();
        }
        heard.map(|value| value as f32)
    })
}

/// A voice at the mouth: a buzz and breath, in syllables, while the person talks.
fn voice(world: &World, person: usize) -> Vec<f64> {
    let rate = f64::from(RATE_HZ);
    let count = (world.seconds * rate) as usize + 1;
    let mut noise = Noise::new(23 + person as u64);
    let pitch_hz = if person == 0 { 112.0 } else { 196.0 };
    let (mut phase, mut breath, mut loudness) = (0.0_f64, 0.0, 0.0);
    let sample = |number: usize| {
        let time_s = number as f64 / rate;
        let talking = world.people(time_s)[person].talking;
        let syllable = (0.5 - 0.5 * (TAU * SYLLABLES_HZ * time_s).cos()).powi(2);
        // Ten milliseconds from silence to full voice.
        loudness += ((if talking { 0.15 + 0.85 * syllable } else { 0.0 }) - loudness) / (0.01 * rate);
        phase += pitch_hz * (1.0 + 0.1 * (TAU * 0.9 * time_s).sin()) / rate;
        let buzz: f64 = (1..=24)
            .map(|k| (TAU * f64::from(k) * phase).sin() / f64::from(k))
            .sum();
        let white = noise.normal();
        breath += 0.6 * (white - breath);
        loudness * (0.10 * buzz + 0.12 * breath)
    };
    (0..count).map(sample).collect()
}

/// A signal between its samples, by cubic interpolation; zero outside.
fn at(signal: &[f64], place: f64) -> f64 {
    let index = place.floor();
    let part = place - index;
    let value = |offset: i64| {
        let at = index as i64 + offset;
        usize::try_from(at)
            .ok()
            .and_then(|at| signal.get(at))
            .copied()
            .unwrap_or(0.0)
    };
    let (a, b, c, d) = (value(-1), value(0), value(1), value(2));
    let slopes =
        0.5 * (c - a) + part * (a - 2.5 * b + 2.0 * c - 0.5 * d + part * (1.5 * (b - c) + 0.5 * (d - a)));
    b + part * slopes
}
