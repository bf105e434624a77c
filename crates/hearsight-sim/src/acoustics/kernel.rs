//! Fractional delays: the one interpolation kernel that everything here uses, and a form of it for delays that change.
//!
//! The kernel is a sinc under a Hann window of 81 samples, as usual for image sources. To read a signal between its
//! samples as often as there are images, microphones and samples, it is not applied each time: for each of
//! [`PHASES`] positions between two samples the kernel is a polynomial in the rest (Farrow 1988), whose coefficients
//! filter the signal once ([`Branches`]). What is left for each image is a polynomial of degree [`DEGREE`].

use multiversion::multiversion;
use std::f64::consts::PI;

/// Samples of the kernel on each side of its middle.
pub(crate) const HALF: usize = 40;
/// Taps of the kernel.
pub(crate) const TAPS: usize = 2 * HALF + 1;
/// Positions between two samples for which there are polynomials.
pub(crate) const PHASES: usize = 4;
/// Degree of the polynomials. With four positions their error is below -75 dB up to half the rate.
pub(crate) const DEGREE: usize = 3;
/// Filtered signals needed: one for each position and power.
pub(crate) const BRANCHES: usize = PHASES * (DEGREE + 1);

/// The kernel at `t` samples from its middle.
pub(crate) fn kernel(t: f64) -> f64 {
    if t.abs() >= HALF as f64 {
        return 0.0;
    }
    let window = 0.5 + 0.5 * (PI * t / HALF as f64).cos();
    let sinc = if t.abs() < 1e-9 {
        1.0
    } else {
        (PI * t).sin() / (PI * t)
    };
    sinc * window
}

/// The filters of the branches: `BRANCHES` x `TAPS`, those of position r and power m at index r (DEGREE + 1) + m.
///
/// With them, x(n + (r + u) / PHASES) is the sum over m of u^m times branch (r, m) at n, for u within ±0.5.
pub(crate) fn branch_filters() -> Vec<[f32; TAPS]> {
    let nodes: Vec<f64> = (0..=DEGREE)
        .map(|node| 0.5 * (PI * (node as f64 + 0.5) / (DEGREE + 1) as f64).cos())
        .collect();
    let mut filters = vec![[0.0; TAPS]; BRANCHES];
    for phase in 0..PHASES {
        for tap in 0..TAPS {
            let away = tap as f64 - HALF as f64;
            let values: Vec<f64> = nodes
                .iter()
                .map(|rest| kernel((phase as f64 + rest) / PHASES as f64 - away))
                .collect();
            for (power, coefficient) in polynomial_through(&nodes, &values).into_iter().enumerate() {
                filters[phase * (DEGREE + 1) + power][tap] = coefficient as f32;
            }
        }
    }
    filters
}

/// Coefficients of the polynomial through these points, lowest power first (Newton's divided differences).
fn polynomial_through(nodes: &[f64], values: &[f64]) -> Vec<f64> {
    let mut differences = values.to_vec();
    for step in 1..nodes.len() {
        for place in (step..nodes.len()).rev() {
            differences[place] =
                (differences[place] - differences[place - 1]) / (nodes[place] - nodes[place - step]);
        }
    }
    let mut polynomial = vec![0.0; nodes.len()];
    for place in (0..nodes.len()).rev() {
        // polynomial = polynomial (u - node) + difference
        for power in (0..nodes.len()).rev() {
            let below = if power > 0 { polynomial[power - 1] } else { 0.0 };
            polynomial[power] = below - nodes[place] * polynomial[power];
        }
        polynomial[0] += differences[place];
    }
    polynomial
}

/// Writes `signal` filtered by `taps` into `output`: output n is the sum of taps j times signal n + j.
///
/// `signal` must be longer than `output` by the taps but one.
#[multiversion(targets("x86_64+avx2"))]
pub(crate) fn correlate_into(signal: &[f32], taps: &[f32], output: &mut [f32]) {
    const WIDTH: usize = 32;
    let (blocks, rest) = output.as_chunks_mut::<WIDTH>();
    let whole = blocks.len() * WIDTH;
    for (number, block) in blocks.iter_mut().enumerate() {
        let mut sums = [0.0_f32; WIDTH];
        for (signal, tap) in signal[number * WIDTH..].windows(WIDTH).zip(taps) {
            for (sum, sample) in sums.iter_mut().zip(signal) {
                *sum += *tap * *sample;
            }
        }
        *block = sums;
    }
    for (number, output) in rest.iter_mut().enumerate() {
        let mut sum = 0.0_f32;
        for (sample, tap) in signal[whole + number..].iter().zip(taps) {
            sum += *tap * *sample;
        }
        *output = sum;
    }
}

/// A signal ready to be read at any fraction of a sample: its branches over a stretch of samples.
#[derive(Clone, Debug)]
pub(crate) struct Branches {
    /// Number of the first sample for which there are branches.
    first: i64,
    length: usize,
    /// `BRANCHES` rows of `capacity` samples.
    data: Vec<f32>,
    capacity: usize,
}

impl Branches {
    /// Room for branches of `capacity` samples.
    pub(crate) fn new(capacity: usize) -> Self {
        Self {
            // Before all samples: the first stretch may begin anywhere.
            first: i64::MIN / 2,
            length: 0,
            data: vec![0.0; BRANCHES * capacity],
            capacity,
        }
    }

    /// Number of the sample after the last one for which there are branches.
    pub(crate) fn end(&self) -> i64 {
        self.first + self.length as i64
    }

    /// Forgets what is before sample `keep_from`, and everything where nothing of it is left.
    pub(crate) fn forget(&mut self, keep_from: i64) {
        let gone = (keep_from - self.first).clamp(0, self.length as i64) as usize;
        if gone > 0 {
            for row in self.data.chunks_exact_mut(self.capacity) {
                row.copy_within(gone..self.length, 0);
            }
        }
        self.length -= gone;
        self.first = if self.length == 0 {
            keep_from
        } else {
            self.first + gone as i64
        };
    }

    /// Appends the branches of as many samples as `signal` has without the kernel's [`HALF`] samples on each side.
    pub(crate) fn append(&mut self, filters: &[[f32; TAPS]], signal: &[f32]) {
        let count = signal.len().saturating_sub(2 * HALF);
        if self.length + count > self.capacity {
            let mut grown = Self::new((self.length + count).next_power_of_two());
            for (to, from) in grown
                .data
                .chunks_exact_mut(grown.capacity)
                .zip(self.data.chunks_exact(self.capacity))
            {
                to[..self.length].copy_from_slice(&from[..self.length]);
            }
            (self.data, self.capacity) = (grown.data, grown.capacity);
        }
        let silent = signal.iter().all(|sample| *sample == 0.0);
        for (row, taps) in self.data.chunks_exact_mut(self.capacity).zip(filters) {
            let output = &mut row[self.length..self.length + count];
            if silent {
                output.fill(0.0);
            } else {
                correlate_into(signal, taps, output);
            }
        }
        self.length += count;
    }

    /// Adds to `output` the signal read at places that move evenly: output n is read at sample `start + n (1 + slope)`,
    /// with a gain that moves evenly from `gain` by `gain_step` a sample. Nothing where the branches do not reach.
    pub(crate) fn read(&self, start: f64, slope: f64, gain: f32, gain_step: f32, output: &mut [f32]) {
        let length = output.len();
        let scale = PHASES as f64;
        // Whole samples apart: what is left is the same wherever the stretch happens to begin.
        let whole = floor(start);
        let base = whole - self.first;
        // In units of a position, apart from the step of one sample an output.
        let (begin, step) = ((start - whole as f64) * scale, slope * scale);
        let mut done = 0;
        while done < length {
            let place = begin + step * done as f64;
            let nearest = floor(place + 0.5);
            // How far it is from the nearest position, and how long that stays the nearest one.
            let rest = place - nearest as f64;
            let left = if step > 0.0 {
                (0.5 - rest) / step
            } else if step < 0.0 {
                (-0.5 - rest) / step
            } else {
                f64::INFINITY
            };
            let run = if left < (length - done - 1) as f64 {
                left as usize + 1
            } else {
                length - done
            };
            let sample = base + nearest.div_euclid(PHASES as i64) + done as i64;
            let phase = nearest.rem_euclid(PHASES as i64) as usize;
            if sample >= 0 && sample as usize + run <= self.length {
                let row = |power: usize| {
                    let at = (phase * (DEGREE + 1) + power) * self.capacity + sample as usize;
                    &self.data[at..at + run]
                };
                let gains = (gain + gain_step * done as f32, gain_step);
                run_of(
                    [row(0), row(1), row(2), row(3)],
                    (rest as f32, step as f32),
                    gains,
                    &mut output[done..done + run],
                );
            }
            done += run;
        }
    }
}

/// The largest integer not above `value`; the standard library's is a call where SSE 4.1 is not taken for granted.
#[inline]
fn floor(value: f64) -> i64 {
    let toward_zero = value as i64;
    toward_zero - i64::from(value < toward_zero as f64)
}

/// Adds a cubic in a place that moves evenly, times a gain that moves evenly.
#[multiversion(targets("x86_64+avx2"))]
fn run_of(rows: [&[f32]; DEGREE + 1], place: (f32, f32), gain: (f32, f32), output: &mut [f32]) {
    let [a, b, c, d] = rows;
    let length = output.len();
    let (a, b, c, d) = (&a[..length], &b[..length], &c[..length], &d[..length]);
    if place.1 == 0.0 && gain.1 == 0.0 {
        let (one, two, three) = (
            place.0 * gain.0,
            place.0 * place.0 * gain.0,
            place.0 * place.0 * place.0 * gain.0,
        );
        for n in 0..length {
            output[n] += gain.0 * a[n] + one * b[n] + (two * c[n] + three * d[n]);
        }
        return;
    }
    for n in 0..length {
        let count = n as i32 as f32;
        let u = place.0 + place.1 * count;
        let g = gain.0 + gain.1 * count;
        output[n] += g * (a[n] + u * (b[n] + u * (c[n] + u * d[n])));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tone(frequency: f64, sample: f64) -> f64 {
        (2.0 * PI * frequency * sample + 0.3).sin()
    }

    fn branches(frequency: f64, first: i64, count: usize) -> Branches {
        let mut branches = Branches::new(16);
        branches.forget(first);
        let signal: Vec<f32> = (0..count + 2 * HALF)
            .map(|n| tone(frequency, (first + n as i64 - HALF as i64) as f64) as f32)
            .collect();
        branches.append(&branch_filters(), &signal);
        branches
    }

    #[test]
    fn tones_are_read_between_their_samples() {
        for frequency in [0.001, 0.05, 0.2, 0.35, 0.44] {
            let branches = branches(frequency, -20, 1000);
            for (start, slope) in [(100.3, 0.0), (50.77, 0.006), (70.0, -0.003), (3.999, 0.1)] {
                let mut output = vec![0.0; 500];
                branches.read(start, slope, 1.0, 0.0, &mut output);
                for (n, output) in output.iter().enumerate() {
                    let wanted = tone(frequency, start + n as f64 * (1.0 + slope));
                    assert!(
                        (f64::from(*output) - wanted).abs() < 1.5e-3,
                        "{frequency} {start} {slope} {n}: {output} {wanted}"
                    );
                }
            }
        }
    }

    #[test]
    fn polynomials_are_as_good_as_the_kernel() {
        let filters = branch_filters();
        let mut worst: f64 = 0.0;
        for step in 0..400 {
            let place = step as f64 / 100.0;
            let nearest = place.round() as usize;
            if nearest >= PHASES {
                continue;
            }
            let rest = place - nearest as f64;
            let error: f64 = (0..TAPS)
                .map(|tap| {
                    let polynomial: f64 = (0..=DEGREE)
                        .map(|power| f64::from(filters[nearest * 4 + power][tap]) * rest.powi(power as i32))
                        .sum();
                    (polynomial - kernel(place / PHASES as f64 - (tap as f64 - HALF as f64))).powi(2)
                })
                .sum();
            worst = worst.max(error.sqrt());
        }
        println!("{:.1} dB", 20.0 * worst.log10());
        assert!(20.0 * worst.log10() < -75.0);
    }

    #[test]
    fn branches_go_on_where_they_were() {
        let whole = branches(0.11, 0, 700);
        let mut parts = branches(0.11, 0, 300);
        parts.forget(120);
        let signal: Vec<f32> = (300 - HALF..700 + HALF)
            .map(|n| tone(0.11, n as f64) as f32)
            .collect();
        parts.append(&branch_filters(), &signal);
        let (mut one, mut two) = (vec![0.0; 400], vec![0.0; 400]);
        whole.read(200.4, 0.004, 0.5, 1e-3, &mut one);
        parts.read(200.4, 0.004, 0.5, 1e-3, &mut two);
        assert_eq!((parts.end(), &one), (700, &two));
    }
}
