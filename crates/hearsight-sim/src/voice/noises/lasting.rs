//! Noise that lasts: fans and streets, from periods that repeat.

use super::Form;
use crate::acoustics::random::{between, generator, normal};
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use std::f64::consts::TAU;

/// How the level of lasting noise moves.
#[derive(Clone, Debug)]
pub(super) struct Swell {
    /// Decibels up and down.
    depth_db: f64,
    phases: [f64; 3],
}

impl Swell {
    pub(super) fn none() -> Self {
        Self {
            depth_db: 0.0,
            phases: [0.0; 3],
        }
    }

    pub(super) fn gain(&self, time_s: f64) -> f64 {
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
pub(super) fn periods(rate_hz: u32, seed: u64, amplitude: impl Fn(f64) -> f64) -> Vec<Vec<f32>> {
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

pub(super) fn fan(rate_hz: u32, seed: u64) -> Form {
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

pub(super) fn street(rate_hz: u32, seed: u64) -> Form {
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
