//! The phase-transformed correlation of every pair of an array, over the delays that the array allows.

use super::lag_window::LagWindow;
use crate::Complex;
use crate::error::{AudioError, check_setting, check_shape};
use realfft::{ComplexToReal, RealFftPlanner};
use std::ops::Range;
use std::sync::Arc;

/// Whitened spectra and what it takes to correlate them.
#[derive(Clone)]
pub(super) struct PairCurves {
    bins: Range<usize>,
    transform_length: usize,
    half: usize,
    window: LagWindow,
    plan: Arc<dyn ComplexToReal<f32>>,
    /// Channels x bins that count: X / |X|, 0 where there is nothing. Real and imaginary parts apart.
    white: Vec<[Vec<f32>; 2]>,
    /// Whether a channel has anything in a bin, 1 or 0.
    present: Vec<Vec<f32>>,
    cross: [Vec<f32>; 2],
    thinned: [Vec<f32>; 2],
    input: Vec<Complex>,
    lags: Vec<f32>,
    scratch: Vec<Complex>,
    curve: Vec<f32>,
}

impl PairCurves {
    /// Correlations of `channels` channels up to `max_delay` samples, `interpolation` values a sample.
    pub(super) fn new(
        transform_length: usize,
        max_delay: f64,
        interpolation: usize,
        bins: Range<usize>,
        channels: usize,
    ) -> Result<Self, AudioError> {
        let even = transform_length >= 2 && transform_length.is_multiple_of(2);
        check_setting(
            even,
            "transform_length",
            "even and above 0",
            transform_length as f64,
        )?;
        check_setting(
            (1..=64).contains(&interpolation),
            "interpolation",
            "within 1 and 64",
            interpolation as f64,
        )?;
        let reach = max_delay.ceil() + 2.0;
        check_setting(
            2.0 * reach < transform_length as f64,
            "transform_length",
            "more than twice the array's greatest delay in samples",
            transform_length as f64,
        )?;
        let window = LagWindow::new(transform_length, reach as usize);
        let period = transform_length / window.step;
        let plan = RealFftPlanner::new().plan_fft_inverse(period * interpolation);
        let padded = window.before + transform_length / 2 + 1 + window.after();
        let half = reach as usize * interpolation;
        Ok(Self {
            white: vec![[vec![0.0; bins.len()], vec![0.0; bins.len()]]; channels],
            present: vec![vec![0.0; bins.len()]; channels],
            cross: [vec![0.0; padded], vec![0.0; padded]],
            thinned: [vec![0.0; period / 2 + 1], vec![0.0; period / 2 + 1]],
            input: plan.make_input_vec(),
            lags: plan.make_output_vec(),
            scratch: plan.make_scratch_vec(),
            curve: vec![0.0; 2 * half + 1],
            bins,
            transform_length,
            half,
            window,
            plan,
        })
    }

    /// Values of a curve before its middle.
    pub(super) fn half(&self) -> usize {
        self.half
    }

    /// Values of a curve.
    pub(super) fn length(&self) -> usize {
        self.curve.len()
    }

    /// Divides every spectrum by its magnitude; the product of two is then the phase transform of the pair.
    pub(super) fn whiten(&mut self, channels: &[Vec<Complex>]) -> Result<(), AudioError> {
        check_shape("spectra of an array", self.white.len(), channels.len())?;
        for spectrum in channels {
            check_shape(
                "bins of a spectrum",
                self.transform_length / 2 + 1,
                spectrum.len(),
            )?;
        }
        for ((spectrum, [re, im]), present) in channels.iter().zip(&mut self.white).zip(&mut self.present) {
            whiten_channel(&spectrum[self.bins.clone()], re, im, present);
        }
        Ok(())
    }

    /// The correlation of channels i and j of the whitened frame, 1 where all frequencies agree on a delay: its middle is
    /// delay 0, and it reaches two samples beyond the greatest delay. Zeros where no frequency is in both.
    pub(super) fn correlate(&mut self, (i, j): (usize, usize)) -> Result<&[f32], AudioError> {
        let Self { bins, window, .. } = self;
        let start = window.before + bins.start;
        let [re, im] = &mut self.cross;
        let place = start..start + bins.len();
        multiply(
            &self.white[i],
            &self.white[j],
            &mut re[place.clone()],
            &mut im[place],
        );
        let last = self.transform_length / 2;
        mirror(re, window.before, last, 1.0);
        mirror(im, window.before, last, -1.0);
        for (cross, thinned) in self.cross.iter().zip(&mut self.thinned) {
            window.thin(cross, thinned);
        }
        let ends = |k: usize| if k == 0 || k == last { 1.0 } else { 2.0 };
        let mut total = 2.0 * dot(&self.present[i], &self.present[j]);
        for end in [0, last] {
            if bins.contains(&end) {
                let k = end - bins.start;
                total -= (2.0 - ends(end)) * self.present[i][k] * self.present[j][k];
            }
        }
        if total <= 0.0 {
            self.curve.fill(0.0);
            return Ok(&self.curve);
        }
        self.invert(total)?;
        Ok(&self.curve)
    }

    fn invert(&mut self, total: f32) -> Result<(), AudioError> {
        let [re, im] = &self.thinned;
        let used = re.len();
        let parts = re.iter().zip(im);
        for (value, (&re, &im)) in self.input.iter_mut().zip(parts) {
            *value = Complex::new(re, im);
        }
        if self.input.len() > used {
            // Half of the last bin belongs to the negative frequencies, which zero-padding moves away from it.
            self.input[used - 1] *= 0.5;
            self.input[used..].fill(Complex::default());
        }
        // The ends of the spectrum of a real signal are real; rounding must not make the transform refuse them.
        self.input[0].im = 0.0;
        if let Some(last) = self.input.last_mut() {
            last.im = 0.0;
        }
        self.plan
            .process_with_scratch(&mut self.input, &mut self.lags, &mut self.scratch)?;
        let scale = self.window.step as f32 / total;
        let wrapped = self.lags.len() - self.half;
        let (negative, positive) = self.curve.split_at_mut(self.half);
        for (value, lag) in negative.iter_mut().zip(&self.lags[wrapped..]) {
            *value = scale * lag;
        }
        for (value, lag) in positive.iter_mut().zip(&self.lags) {
            *value = scale * lag;
        }
        Ok(())
    }
}

/// Continues the spectrum of a real signal beyond both its ends. `sign` is -1 for imaginary parts.
fn mirror(padded: &mut [f32], before: usize, last: usize, sign: f32) {
    for k in 1..=before {
        padded[before - k] = sign * padded[before + k.min(last)];
    }
    let end = before + last;
    for k in 1..padded.len() - end {
        padded[end + k] = sign * padded[end - k.min(last)];
    }
}

#[multiversion::multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn whiten_channel(spectrum: &[Complex], re: &mut [f32], im: &mut [f32], present: &mut [f32]) {
    let parts = re.iter_mut().zip(im).zip(present);
    for (x, ((re, im), present)) in spectrum.iter().zip(parts) {
        let power = x.re * x.re + x.im * x.im;
        // What is not finite compares false and is left out.
        let is_there = power > f32::MIN_POSITIVE && power < f32::MAX;
        let scale = if is_there { 1.0 / power.sqrt() } else { 0.0 };
        *re = if is_there { x.re * scale } else { 0.0 };
        *im = if is_there { x.im * scale } else { 0.0 };
        *present = if is_there { 1.0 } else { 0.0 };
    }
}

/// X_i X_j*.
#[multiversion::multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn multiply(first: &[Vec<f32>; 2], second: &[Vec<f32>; 2], re: &mut [f32], im: &mut [f32]) {
    let first = first[0].iter().zip(&first[1]);
    let second = second[0].iter().zip(&second[1]);
    for (((a, b), (c, d)), (re, im)) in first.zip(second).zip(re.iter_mut().zip(im)) {
        *re = a * c + b * d;
        *im = b * c - a * d;
    }
}

#[multiversion::multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn dot(first: &[f32], second: &[f32]) -> f32 {
    // Counts below 2^24 are exact in any order.
    let mut sums = [0.0_f32; 8];
    let (chunks, rest) = first.as_chunks::<8>();
    let (others, other_rest) = second.as_chunks::<8>();
    for (a, b) in chunks.iter().zip(others) {
        for lane in 0..8 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f32 = rest.iter().zip(other_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f32>() + rest
}
