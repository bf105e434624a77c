//! Images to samples: what all impulse responses are made by.
//!
//! Each image is an impulse at a fraction of a sample under the kernel of 81 taps. To write 81 taps for each of some
//! hundred thousand images would take most of the time. Instead an image is written as 8 samples of a smooth bump on a
//! grid of twice the rate (the spreading of a non-uniform Fourier transform: Barnett, Magland and af Klinteberg 2019),
//! and the transform of the whole grid is divided by that of the bump and multiplied by that of the kernel. The result
//! is the same to about -90 dB.

use super::bands;
use super::error::AcousticsError;
use super::kernel::{HALF, kernel};
use super::lattice::{Lattice, Mirror};
use super::room::Shoebox;
use super::source::Directivity;
use multiversion::multiversion;
use nalgebra::Vector3;
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

/// Samples of the bump.
const WIDTH: usize = 8;
/// Samples of the grid for each sample of a response.
const FINER: usize = 2;
/// Places between two samples of the grid for which the bump is kept; between them it is interpolated.
const PLACES: usize = 512;
/// Images whose distances are computed at a time.
const CHUNK: usize = 256;
/// Sources nearer than this to a microphone are as loud as at this distance, metres.
pub(crate) const NEAREST_M: f64 = 0.1;

/// The bump at z half widths from its middle ("exponential of semicircle").
fn bump(z: f64) -> f64 {
    let inside = 1.0 - z * z;
    if inside <= 0.0 {
        0.0
    } else {
        (2.3 * WIDTH as f64 * (inside.sqrt() - 1.0)).exp()
    }
}

/// Which images count, by distance: early ones are heard one by one as they move, late ones in responses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Split {
    /// Up to here an image is early, metres.
    pub(crate) early_m: f64,
    /// From here on it is late; between both it is partly either.
    pub(crate) late_m: f64,
}

impl Split {
    /// The share of an image at this distance that is early.
    pub(crate) fn early(&self, distance_m: f64) -> f64 {
        let part = ((distance_m - self.early_m) / (self.late_m - self.early_m)).clamp(0.0, 1.0);
        1.0 - part * part * (3.0 - 2.0 * part)
    }
}

/// A source and a microphone from the room's corner, and what is between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    pub(crate) source_m: [f64; 3],
    /// Of length 1.
    pub(crate) facing: [f64; 3],
    pub(crate) directivity: Directivity,
    pub(crate) microphone_m: [f64; 3],
    /// Added to the time of travel, seconds.
    pub(crate) delay_s: f64,
}

/// A direction of length 1; forward along x where there is none.
pub(crate) fn unit(direction: Vector3<f64>) -> [f64; 3] {
    let unit = direction.try_normalize(1e-12).unwrap_or_else(Vector3::x);
    if unit.iter().all(|part| part.is_finite()) {
        [unit.x, unit.y, unit.z]
    } else {
        [1.0, 0.0, 0.0]
    }
}

/// What is needed to make responses of one length: shared by all that make them.
pub(crate) struct Synthesis {
    rate_hz: u32,
    speed_m_s: f64,
    /// Samples before time zero, into which the kernels reach.
    lead: usize,
    /// Samples of the transform of a response.
    length: usize,
    /// Place on the grid from which on images are left out: their kernels do not reach back into the response.
    end: f64,
    table: Vec<[f32; WIDTH]>,
    /// Kernel over bump: length + 1 bins, up to the rate.
    correction: Vec<f32>,
    /// For each band its share of length / 2 + 1 bins; empty where there is one band.
    shares: Vec<Vec<f32>>,
    forward: Arc<dyn RealToComplex<f32>>,
    inverse: Arc<dyn ComplexToReal<f32>>,
}

/// What one maker of responses works in.
pub(crate) struct Scratch {
    grids: Vec<Vec<f32>>,
    fine: Vec<Complex<f32>>,
    sum: Vec<Complex<f32>>,
    forward: Vec<Complex<f32>>,
    inverse: Vec<Complex<f32>>,
    samples: Vec<f32>,
    positions: [f64; CHUNK],
    amplitudes: [f32; CHUNK],
}

impl Synthesis {
    /// For responses with `samples` samples from time zero on.
    pub(crate) fn new(room: &Shoebox, rate_hz: u32, samples: usize) -> Self {
        let banded = room.is_banded();
        let lead = HALF + if banded { bands::half_length(rate_hz) } else { 0 };
        let length = transform_length(3 * lead + samples + WIDTH);
        let mut planner = RealFftPlanner::new();
        let shares = if banded {
            bands::filters(rate_hz)
                .iter()
                .map(|taps| bands::response(taps, length))
                .collect()
        } else {
            Vec::new()
        };
        Self {
            rate_hz,
            speed_m_s: room.settings().speed_m_s,
            lead,
            length,
            end: (FINER * (2 * lead + samples)) as f64,
            table: table(),
            correction: correction(length),
            shares,
            forward: planner.plan_fft_forward(FINER * length),
            inverse: planner.plan_fft_inverse(length),
        }
    }

    pub(crate) fn scratch(&self) -> Scratch {
        let bands = self.shares.len().max(1);
        Scratch {
            grids: vec![vec![0.0; FINER * self.length]; bands],
            fine: self.forward.make_output_vec(),
            sum: self.inverse.make_input_vec(),
            forward: self.forward.make_scratch_vec(),
            inverse: self.inverse.make_scratch_vec(),
            samples: self.inverse.make_output_vec(),
            positions: [0.0; CHUNK],
            amplitudes: [0.0; CHUNK],
        }
    }

    /// Samples before time zero in what [`Self::finish`] gives.
    pub(crate) fn lead(&self) -> usize {
        self.lead
    }

    /// Writes all images into the grids of their bands, weighted as late ones where there is a split.
    pub(crate) fn add(&self, lattice: &Lattice, link: &Link, split: Option<&Split>, scratch: &mut Scratch) {
        let bands = scratch.grids.len();
        for mirror in &lattice.mirrors {
            self.add_mirror(mirror, link, split, 0..bands, scratch);
        }
        for (band, mirrors) in lattice.single.iter().enumerate() {
            for mirror in mirrors {
                self.add_mirror(mirror, link, split, band..band + 1, scratch);
            }
        }
    }

    /// Writes the direct sound into the grids.
    pub(crate) fn add_direct(&self, link: &Link, scratch: &mut Scratch) {
        let bands = scratch.grids.len();
        let direct = Mirror {
            sign: [1.0; 3],
            offset_m: [0, 1, 2].map(|_| vec![0.0]),
            gain: vec![vec![1.0]; bands],
        };
        self.add_mirror(&direct, link, None, 0..bands, scratch);
    }

    fn add_mirror(
        &self,
        mirror: &Mirror,
        link: &Link,
        split: Option<&Split>,
        bands: Range<usize>,
        scratch: &mut Scratch,
    ) {
        let from: [f64; 3] =
            [0, 1, 2].map(|axis| mirror.sign[axis] * link.source_m[axis] - link.microphone_m[axis]);
        let facing: [f64; 3] = [0, 1, 2].map(|axis| mirror.sign[axis] * link.facing[axis]);
        let per_m = FINER as f64 * f64::from(self.rate_hz) / self.speed_m_s;
        let zero = FINER as f64 * (self.lead as f64 + link.delay_s * f64::from(self.rate_hz));
        let places = Places {
            from,
            facing,
            everywhere: link.directivity.everywhere,
            per_m,
            zero,
            split: split.map_or([1e30, 1e31], |split| [split.early_m, split.late_m]),
            late: split.is_some(),
        };
        let count = mirror.offset_m[0].len();
        for begin in (0..count).step_by(CHUNK) {
            let end = (begin + CHUNK).min(count);
            let offsets: [&[f64]; 3] = [0, 1, 2].map(|axis| &mirror.offset_m[axis][begin..end]);
            let positions = &mut scratch.positions[..end - begin];
            let amplitudes = &mut scratch.amplitudes[..end - begin];
            places.compute(offsets, positions, amplitudes);
            for (grid, gains) in scratch.grids[bands.clone()].iter_mut().zip(&mirror.gain) {
                spread(
                    grid,
                    positions,
                    self.end,
                    amplitudes,
                    &gains[begin..end],
                    &self.table,
                );
            }
        }
    }

    /// Turns the grids into samples, of which `lead` precede time zero, and clears them.
    pub(crate) fn finish<'s>(&self, scratch: &'s mut Scratch) -> Result<&'s mut [f32], AcousticsError> {
        let Scratch {
            grids,
            fine,
            sum,
            forward,
            inverse,
            samples,
            ..
        } = scratch;
        sum.fill(Complex::ZERO);
        for (band, grid) in grids.iter_mut().enumerate() {
            self.forward.process_with_scratch(grid, fine, forward)?;
            grid.fill(0.0);
            let half = self.length / 2;
            let share = self.shares.get(band);
            for (bin, sum) in sum.iter_mut().enumerate().take(half + 1) {
                // What is above half the rate folds back: the kernel leaves a little there.
                let high = self.length - bin;
                let value = fine[bin] * self.correction[bin] + fine[high].conj() * self.correction[high];
                *sum += value * share.map_or(1.0, |share| share[bin]);
            }
        }
        let last = sum.len() - 1;
        // The two bins that a real signal has without a phase.
        (sum[0].im, sum[last].im) = (0.0, 0.0);
        self.inverse.process_with_scratch(sum, samples, inverse)?;
        Ok(samples)
    }
}

/// What turns offsets of images into places on the grid and amplitudes.
struct Places {
    from: [f64; 3],
    facing: [f64; 3],
    everywhere: f64,
    per_m: f64,
    zero: f64,
    split: [f64; 2],
    late: bool,
}

impl Places {
    fn compute(&self, offsets: [&[f64]; 3], positions: &mut [f64], amplitudes: &mut [f32]) {
        if self.everywhere < 1.0 || self.late {
            directed(self, offsets, positions, amplitudes);
        } else {
            plain(self, offsets, positions, amplitudes);
        }
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn plain(places: &Places, offsets: [&[f64]; 3], positions: &mut [f64], amplitudes: &mut [f32]) {
    let count = positions.len();
    let [x, y, z] = offsets.map(|offset| &offset[..count]);
    let amplitudes = &mut amplitudes[..count];
    let [from_x, from_y, from_z] = places.from;
    for image in 0..count {
        let (x, y, z) = (x[image] + from_x, y[image] + from_y, z[image] + from_z);
        let distance = (x * x + y * y + z * z).sqrt();
        positions[image] = distance * places.per_m + places.zero;
        amplitudes[image] = (1.0 / distance.max(NEAREST_M)) as f32;
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn directed(places: &Places, offsets: [&[f64]; 3], positions: &mut [f64], amplitudes: &mut [f32]) {
    let count = positions.len();
    let [x, y, z] = offsets.map(|offset| &offset[..count]);
    let amplitudes = &mut amplitudes[..count];
    let [from_x, from_y, from_z] = places.from;
    let [facing_x, facing_y, facing_z] = places.facing;
    let slope = 1.0 / (places.split[1] - places.split[0]);
    let base = if places.late { 0.0 } else { 1.0 };
    for image in 0..count {
        let (x, y, z) = (x[image] + from_x, y[image] + from_y, z[image] + from_z);
        let distance = (x * x + y * y + z * z).sqrt();
        let one_over = 1.0 / distance.max(NEAREST_M);
        // From the image towards the microphone.
        let cosine = -(x * facing_x + y * facing_y + z * facing_z) * one_over;
        let part = ((distance - places.split[0]) * slope).clamp(0.0, 1.0);
        let late = base + part * part * (3.0 - 2.0 * part);
        positions[image] = distance * places.per_m + places.zero;
        let gain = places.everywhere + (1.0 - places.everywhere) * cosine;
        amplitudes[image] = (gain * late * one_over) as f32;
    }
}

/// Adds a bump for each image to the grid; images from `last` on are left out.
#[multiversion(targets("x86_64+avx2"))]
fn spread(
    grid: &mut [f32],
    positions: &[f64],
    last: f64,
    amplitudes: &[f32],
    gains: &[f32],
    table: &[[f32; WIDTH]],
) {
    for ((position, amplitude), gain) in positions.iter().zip(amplitudes).zip(gains) {
        let amplitude = *amplitude * *gain;
        // False for what is not a number, too.
        if !(*position >= 4.0 && *position < last) || amplitude == 0.0 {
            continue;
        }
        let whole = *position as i32;
        let place = ((*position - f64::from(whole)) * PLACES as f64) as f32;
        let row = place as usize;
        let part = place - row as f32;
        let begin = whole as usize - 3;
        let Some([low, high]) = table.get(row..row + 2) else {
            continue;
        };
        let Some(to) = grid.get_mut(begin..begin + WIDTH) else {
            continue;
        };
        for tap in 0..WIDTH {
            to[tap] += amplitude * (low[tap] + part * (high[tap] - low[tap]));
        }
    }
}

/// The bump's samples for each place between two samples of the grid.
fn table() -> Vec<[f32; WIDTH]> {
    (0..=PLACES)
        .map(|place| {
            let part = place as f64 / PLACES as f64;
            std::array::from_fn(|tap| bump((tap as f64 - 3.0 - part) / (0.5 * WIDTH as f64)) as f32)
        })
        .collect()
}

/// For each bin up to the rate: the kernel's transform over the bump's.
fn correction(length: usize) -> Vec<f32> {
    let bins = length + 1;
    // Sums over samples close enough that no image of the spectrum falls into the range.
    let kernels = cosine_sums(bins, PI / length as f64 / 2.0, 4 * HALF, |step| {
        kernel(step as f64 / 4.0) / 4.0
    });
    let bumps = cosine_sums(bins, PI / length as f64 / 8.0, 8 * WIDTH / 2, |step| {
        bump(step as f64 / 32.0) / 8.0
    });
    kernels
        .iter()
        .zip(&bumps)
        .map(|(kernel, bump)| {
            // In the bump's transform a sample is one of the grid, in the kernel's one of the response.
            let value = if kernel.abs() < 1e-7 { 0.0 } else { kernel / bump };
            (value / length as f64) as f32
        })
        .collect()
}

/// For each bin b: value(0) + 2 sum over n of value(n) cos(n b angle), cosines by recurrence.
fn cosine_sums(bins: usize, angle: f64, reach: usize, value: impl Fn(usize) -> f64) -> Vec<f64> {
    /// Bins that go side by side: one alone would wait for its recurrence.
    const LANES: usize = 16;
    let values: Vec<f64> = (0..=reach).map(value).collect();
    let mut sums = vec![0.0; bins];
    for (block, sums) in sums.chunks_mut(LANES).enumerate() {
        let twice: [f64; LANES] =
            std::array::from_fn(|lane| 2.0 * (angle * (block * LANES + lane) as f64).cos());
        let (mut before, mut now, mut all) =
            (twice.map(|twice| 0.5 * twice), [1.0; LANES], [values[0]; LANES]);
        for value in &values[1..] {
            for lane in 0..LANES {
                let next = twice[lane] * now[lane] - before[lane];
                (before[lane], now[lane]) = (now[lane], next);
                all[lane] += 2.0 * value * next;
            }
        }
        for (sum, all) in sums.iter_mut().zip(all) {
            *sum = all;
        }
    }
    sums
}

/// The least even length of at least `least` that transforms fast.
pub(crate) fn transform_length(least: usize) -> usize {
    [1, 3, 5, 9, 15]
        .into_iter()
        .map(|factor| factor * least.div_ceil(factor).next_power_of_two().max(2))
        .min()
        .unwrap_or(least)
}
