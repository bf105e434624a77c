//! Short delays from long spectra: a window over the delays, applied to the spectrum, so that few bins are left.
//!
//! The correlation of a frame of thousands of samples reaches over as many delays, of which an array needs a few dozen.
//! Smoothing its spectrum multiplies the correlation by a window; where the window has faded, the smoothed spectrum may be
//! sampled so sparsely that delays wrap around. What is left is inverted by a transform that is shorter by the same
//! factor, at no loss within the delays that are needed.

/// How much of a delay that wraps around is left: 60 dB.
const ATTENUATION_DB: f64 = 60.0;
/// Delays left at the least: fewer would cut the sidelobes of a peak so near to it that they are missed between samples.
const SHORTEST: usize = 128;
/// Values of the kernel worked on together.
pub(super) const LANES: usize = 8;

/// Smooths and thins spectra.
#[derive(Clone, Debug)]
pub(super) struct LagWindow {
    /// Every `step`-th bin is left.
    pub(super) step: usize,
    /// Values of the kernel before its middle; as many follow, and zeros up to a multiple of [`LANES`].
    pub(super) before: usize,
    kernel: Vec<f32>,
}

impl LagWindow {
    /// A window that keeps delays up to `half` samples out of spectra of `transform_length`, a power of two.
    pub(super) fn new(transform_length: usize, half: usize) -> Self {
        let period = (4 * half).next_power_of_two().max(SHORTEST);
        if 2 * period > transform_length || !transform_length.is_power_of_two() {
            return Self {
                step: 1,
                before: 0,
                kernel: vec![1.0],
            };
        }
        let step = transform_length / period;
        // Kaiser's design (Kaiser 1974): a low pass over the bins, with the delays in the part of frequencies.
        let transition = std::f64::consts::TAU * (period - 2 * half) as f64 / transform_length as f64;
        let before = ((ATTENUATION_DB - 7.95) / (2.285 * transition) / 2.0).ceil() as usize;
        let beta = 0.1102 * (ATTENUATION_DB - 8.7);
        let value = |k: usize| {
            let offset = k as f64 - before as f64;
            let place = offset / (before as f64 + 1.0);
            sinc(offset / step as f64) * bessel(beta * (1.0 - place * place).sqrt())
        };
        let mut kernel: Vec<f64> = (0..=2 * before).map(value).collect();
        let sum: f64 = kernel.iter().sum();
        kernel.iter_mut().for_each(|value| *value /= sum);
        let mut kernel: Vec<f32> = kernel.into_iter().map(|value| value as f32).collect();
        kernel.resize(kernel.len().next_multiple_of(LANES), 0.0);
        Self { step, before, kernel }
    }

    /// Values needed after the last bin that is asked for.
    pub(super) fn after(&self) -> usize {
        self.kernel.len() - 1 - self.before
    }

    /// Smooths `padded`, which has `before` values in front of bin 0, and leaves every `step`-th bin in `thinned`.
    pub(super) fn thin(&self, padded: &[f32], thinned: &mut [f32]) {
        if self.step == 1 {
            thinned.copy_from_slice(&padded[..thinned.len()]);
        } else {
            convolve(padded, &self.kernel, self.step, thinned);
        }
    }
}

/// Lanes are summed apart and then in a fixed order: the same on every machine.
#[multiversion::multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn convolve(padded: &[f32], kernel: &[f32], step: usize, thinned: &mut [f32]) {
    let (kernel, _) = kernel.as_chunks::<LANES>();
    for (k, thinned) in thinned.iter_mut().enumerate() {
        let (values, _) = padded[k * step..].as_chunks::<LANES>();
        let mut sums = [0.0_f32; LANES];
        for (values, kernel) in values.iter().zip(kernel) {
            for lane in 0..LANES {
                sums[lane] += values[lane] * kernel[lane];
            }
        }
        let [a, b, c, d, e, f, g, h] = sums;
        *thinned = ((a + e) + (b + f)) + ((c + g) + (d + h));
    }
}

fn sinc(x: f64) -> f64 {
    let x = std::f64::consts::PI * x;
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

/// The modified Bessel function of order 0 by its series.
fn bessel(x: f64) -> f64 {
    let quarter = x * x / 4.0;
    let (mut sum, mut term) = (1.0, 1.0);
    for k in 1..40 {
        term *= quarter / f64::from(k * k);
        sum += term;
    }
    sum
}
