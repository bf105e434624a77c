//! Noise from everywhere: as many plane waves from all directions alike (spherically isotropic).
//!
//! The coherence of two microphones d apart is then sin(k d) / (k d), k = 2 pi f / c (Cook et al. 1955). Independent
//! noises are mixed for each frequency by the square root of the matrix of coherences, after Habets, Cohen and Gannot
//! (2008), but by the symmetric root, which no order of microphones changes, and with windows whose squares add up to 1.

use super::error::{AcousticsError, check};
use super::random::{generator, normal};
use nalgebra::DMatrix;
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::sync::Arc;

/// Noise that fills the room: ventilation, a crowd far away.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DiffuseNoise {
    /// Its root mean square at every microphone, decibels relative to full scale, -200 to 0; default -70.
    pub level_db: f64,
    /// How much it falls an octave above 125 Hz, decibels, 0 to 24; default 5. Raising it makes it duller.
    pub fall_db: f64,
}

impl Default for DiffuseNoise {
    fn default() -> Self {
        Self {
            level_db: -70.0,
            fall_db: 5.0,
        }
    }
}

impl DiffuseNoise {
    pub(crate) fn check(&self) -> Result<(), AcousticsError> {
        let (level, fall) = (self.level_db, self.fall_db);
        check(
            (-200.0..=0.0).contains(&level),
            "noise.level_db",
            "within -200 and 0",
            level,
        )?;
        check(
            (0.0..=24.0).contains(&fall),
            "noise.fall_db",
            "within 0 and 24",
            fall,
        )
    }
}

/// Positions that differ by no more than this are the same, metres.
const SAME_M: f64 = 1e-4;

/// Makes the noise of all microphones of an array, a stretch at a time.
pub(crate) struct DiffuseField {
    seed: u64,
    speed_m_s: f64,
    rate_hz: u32,
    /// Samples of a window; half of it is a stretch.
    window: Vec<f32>,
    /// Amplitude of each bin.
    shape: Vec<f32>,
    /// Distances for which the mixing was made.
    distances_m: Vec<f64>,
    /// Bins x microphones x microphones.
    mixing: Vec<f32>,
    microphones: usize,
    inverse: Arc<dyn ComplexToReal<f32>>,
    spectrum: Vec<Complex<f32>>,
    scratch: Vec<Complex<f32>>,
    segment: Vec<f32>,
    /// Noise of each bin and independent channel.
    independent: Vec<Complex<f32>>,
    /// For each microphone what the next stretch begins with.
    overlap: Vec<Vec<f32>>,
    /// For each microphone the stretch made last.
    pub(crate) output: Vec<Vec<f32>>,
    /// Number of that stretch.
    made: Option<i64>,
}

impl DiffuseField {
    pub(crate) fn new(
        noise: &DiffuseNoise,
        microphones: usize,
        rate_hz: u32,
        speed_m_s: f64,
        seed: u64,
    ) -> Self {
        // About 64 ms: bins narrow enough for the coherence at low frequencies.
        let length = (f64::from(rate_hz) * 0.064) as usize;
        let length = length.next_power_of_two().max(64);
        let inverse = RealFftPlanner::new().plan_fft_inverse(length);
        let bins = length / 2 + 1;
        let mut shape: Vec<f64> = (0..bins)
            .map(|bin| {
                let frequency = bin as f64 * f64::from(rate_hz) / length as f64;
                let octaves = (frequency / 125.0).max(1.0).log2();
                10.0_f64.powf(-noise.fall_db * octaves / 20.0)
            })
            .collect();
        // No constant, and no bin without a phase.
        (shape[0], shape[bins - 1]) = (0.0, 0.0);
        // A sum of bins a e^(i p) and their conjugates has twice the mean square of |a|^2 each.
        let power: f64 = shape.iter().map(|amplitude| 2.0 * amplitude * amplitude).sum();
        let scale = 10.0_f64.powf(noise.level_db / 20.0) / power.sqrt();
        Self {
            seed,
            speed_m_s,
            rate_hz,
            window: (0..length)
                .map(|n| (PI * (n as f64 + 0.5) / length as f64).sin() as f32)
                .collect(),
            shape: shape.iter().map(|amplitude| (amplitude * scale) as f32).collect(),
            distances_m: Vec::new(),
            mixing: vec![0.0; bins * microphones * microphones],
            microphones,
            spectrum: inverse.make_input_vec(),
            scratch: inverse.make_scratch_vec(),
            segment: inverse.make_output_vec(),
            inverse,
            independent: vec![Complex::ZERO; bins * microphones],
            overlap: vec![vec![0.0; length / 2]; microphones],
            output: vec![vec![0.0; length / 2]; microphones],
            made: None,
        }
    }

    /// Samples of a stretch.
    pub(crate) fn stretch(&self) -> usize {
        self.window.len() / 2
    }

    /// Makes stretch `number` into `output`, for microphones at these places.
    pub(crate) fn make(&mut self, number: i64, positions_m: &[[f64; 3]]) -> Result<(), AcousticsError> {
        if self.made == Some(number) {
            return Ok(());
        }
        self.adapt(positions_m);
        if self.made != Some(number - 1) {
            self.segment_of(number - 1)?;
        }
        for (output, overlap) in self.output.iter_mut().zip(&self.overlap) {
            output.copy_from_slice(overlap);
        }
        self.segment_of(number)?;
        self.made = Some(number);
        Ok(())
    }

    /// Adds the first half of a segment to the output and keeps the second.
    fn segment_of(&mut self, number: i64) -> Result<(), AcousticsError> {
        let count = self.microphones;
        let mut random = generator(self.seed, "diffuse noise", number.cast_unsigned());
        for value in &mut self.independent {
            *value = Complex::new(normal(&mut random) as f32, normal(&mut random) as f32);
        }
        let half = self.stretch();
        for microphone in 0..count {
            for (bin, to) in self.spectrum.iter_mut().enumerate() {
                let rows = &self.mixing[(bin * count + microphone) * count..][..count];
                let from = &self.independent[bin * count..][..count];
                let sum: Complex<f32> = rows.iter().zip(from).map(|(weight, value)| value * weight).sum();
                // Real and imaginary part have a variance of 1 each.
                *to = sum * (self.shape[bin] * std::f32::consts::FRAC_1_SQRT_2);
            }
            self.inverse
                .process_with_scratch(&mut self.spectrum, &mut self.segment, &mut self.scratch)?;
            let (first, second) = self.segment.split_at(half);
            for (n, output) in self.output[microphone].iter_mut().enumerate() {
                *output += first[n] * self.window[n];
            }
            for (n, overlap) in self.overlap[microphone].iter_mut().enumerate() {
                *overlap = second[n] * self.window[half + n];
            }
        }
        Ok(())
    }

    /// Finds the mixing for these places, unless they are as far from each other as before.
    fn adapt(&mut self, positions_m: &[[f64; 3]]) {
        let count = self.microphones;
        let distance = |i: usize, j: usize| {
            (0..3)
                .map(|axis| (positions_m[i][axis] - positions_m[j][axis]).powi(2))
                .sum::<f64>()
                .sqrt()
        };
        let known = self.distances_m.len() == count * count;
        let same = known
            && (0..count * count)
                .all(|pair| (self.distances_m[pair] - distance(pair / count, pair % count)).abs() < SAME_M);
        if same {
            return;
        }
        self.distances_m.clear();
        self.distances_m
            .extend((0..count * count).map(|pair| distance(pair / count, pair % count)));
        let per_bin = 2.0 * PI * f64::from(self.rate_hz) / self.window.len() as f64 / self.speed_m_s;
        for bin in 0..self.shape.len() {
            let coherence = DMatrix::from_fn(count, count, |i, j| {
                let phase = per_bin * bin as f64 * self.distances_m[i * count + j];
                if phase < 1e-9 { 1.0 } else { phase.sin() / phase }
            });
            let eigen = coherence.symmetric_eigen();
            let roots = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
            let root = &eigen.eigenvectors * DMatrix::from_diagonal(&roots) * eigen.eigenvectors.transpose();
            for i in 0..count {
                for j in 0..count {
                    self.mixing[(bin * count + i) * count + j] = root[(i, j)] as f32;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realfft::RealToComplex;

    #[test]
    fn the_coherence_is_that_of_an_isotropic_field() {
        let noise = DiffuseNoise {
            level_db: -20.0,
            fall_db: 5.0,
        };
        let places = [
            [1.0, 1.0, 1.0],
            [1.05, 1.0, 1.0],
            [1.0, 1.2, 1.0],
            [1.0, 1.0, 1.95],
        ];
        let mut field = DiffuseField::new(&noise, 4, 16_000, 343.0, 5);
        let mut channels = vec![Vec::new(); 4];
        for number in 0..2000 {
            field.make(number, &places).unwrap();
            for (channel, output) in channels.iter_mut().zip(&field.output) {
                channel.extend_from_slice(output);
            }
        }
        let power = channels[2].iter().map(|x| f64::from(x * x)).sum::<f64>() / channels[2].len() as f64;
        assert!((10.0 * power.log10() + 20.0).abs() < 0.2, "{power}");
        let length = 512;
        let forward = RealFftPlanner::<f32>::new().plan_fft_forward(length);
        let spectra: Vec<Vec<Vec<Complex<f32>>>> = channels
            .iter()
            .map(|channel| transform(forward.as_ref(), channel, length))
            .collect();
        for (i, j) in [(0, 1), (0, 2), (0, 3), (2, 3)] {
            let apart = (0..3)
                .map(|axis| (places[i][axis] - places[j][axis]).powi(2))
                .sum::<f64>()
                .sqrt();
            let mut worst: f64 = 0.0;
            for bin in 4..240 {
                let (mut cross, mut first, mut second) = (Complex::<f32>::ZERO, 0.0_f32, 0.0_f32);
                for (a, b) in spectra[i].iter().zip(&spectra[j]) {
                    cross += a[bin] * b[bin].conj();
                    first += a[bin].norm_sqr();
                    second += b[bin].norm_sqr();
                }
                let phase = 2.0 * PI * bin as f64 * 16_000.0 / length as f64 * apart / 343.0;
                let found = f64::from(cross.re / (first * second).sqrt());
                worst = worst.max((found - phase.sin() / phase).abs());
                assert!(f64::from(cross.im / (first * second).sqrt()).abs() < 0.1);
            }
            println!("{apart:.2} m: coherence within {worst:.3}");
            assert!(worst < 0.1, "{worst}");
        }
    }

    fn transform(forward: &dyn RealToComplex<f32>, channel: &[f32], length: usize) -> Vec<Vec<Complex<f32>>> {
        channel
            .chunks_exact(length)
            .map(|chunk| {
                let mut windowed: Vec<f32> = chunk
                    .iter()
                    .enumerate()
                    .map(|(n, x)| x * (PI * (n as f64 + 0.5) / length as f64).sin().powi(2) as f32)
                    .collect();
                let mut output = forward.make_output_vec();
                forward.process(&mut windowed, &mut output).unwrap();
                output
            })
            .collect()
    }

    #[test]
    fn stretches_are_the_same_wherever_one_begins() {
        let places = [[1.0, 1.0, 1.0], [1.1, 1.0, 1.0]];
        let field = || DiffuseField::new(&DiffuseNoise::default(), 2, 16_000, 343.0, 1);
        let (mut one, mut two) = (field(), field());
        for number in 0..5 {
            one.make(number, &places).unwrap();
        }
        two.make(4, &places).unwrap();
        assert_eq!(one.output, two.output);
    }
}
