//! Rational resampling by a polyphase filter, so that every array arrives at the rate the bands are made for.
//!
//! The filter is linear-phase and its delay is compensated: output sample m *is* the sound at m / output rate after the
//! first input sample, for all channels alike. Own work rather than a library's, because here the exact time of every
//! sample, equal phases of all channels and a saved state matter more than any conversion ratio.

use crate::error::{AudioError, MOST_COUNTED, check_setting, check_shape, check_state};
use crate::timeline::{Timeline, check_block};
use hearsight_core::{AudioBlock, Span};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Stop band attenuation in decibels: below the quantization noise of most recordings.
const ATTENUATION_DB: f64 = 80.0;
/// The pass band ends at this share of the lower of the two Nyquist frequencies, the stop band begins at 1.
const PASS_SHARE: f64 = 0.9;

/// What a [`Resampler`] must remember: serializable, apart from the filter, which is made anew.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResamplerState {
    timeline: Timeline,
    /// Input samples still needed, a vector a channel.
    pending: Vec<Vec<f32>>,
    /// Index in the run of the first pending sample; negative at the start, where silence is taken to precede.
    first: i64,
    /// Index in the run of the output sample that comes next.
    next: i64,
    non_finite: u64,
}

/// Resamples blocks of all channels of an array from one rate to another.
pub struct Resampler {
    input_hz: u32,
    output_hz: u32,
    /// Output samples for each `down` input samples, in lowest terms.
    up: i64,
    down: i64,
    /// Input samples on each side of an output sample that bear on it.
    reach: i64,
    /// `up` phases x `2 * reach + 1` taps.
    taps: Vec<f32>,
    state: ResamplerState,
}

impl Resampler {
    /// A resampler of `channels` channels from `input_hz` to `output_hz`; gaps up to `longest_fill` are filled with
    /// zeros, longer ones begin a new run.
    ///
    /// Pass band to 0.9 of the lower Nyquist frequency within 0.01 dB, stop band from 1.0 on by 80 dB (Kaiser window).
    ///
    /// # Errors
    /// [`AudioError::Setting`] where a rate is outside 1 kHz to 400 kHz, there is no channel, or the ratio is so odd
    /// that it would need more than 2000 phases.
    pub fn new(
        channels: usize,
        input_hz: u32,
        output_hz: u32,
        longest_fill: Span,
    ) -> Result<Self, AudioError> {
        check_setting(channels > 0, "channels", "above 0", channels as f64)?;
        for (name, rate) in [("input_hz", input_hz), ("output_hz", output_hz)] {
            check_setting(
                (1000..=400_000).contains(&rate),
                name,
                "within 1000 and 400000",
                f64::from(rate),
            )?;
        }
        let divisor = greatest_common_divisor(input_hz, output_hz);
        let (up, down) = (i64::from(output_hz / divisor), i64::from(input_hz / divisor));
        check_setting(
            up <= 2000,
            "output_hz",
            "in a ratio of at most 2000 phases",
            f64::from(output_hz),
        )?;
        let (reach, taps) = if up == down {
            (0, vec![1.0])
        } else {
            design(input_hz, output_hz, up)
        };
        let timeline = Timeline::new(input_hz, longest_fill)?;
        let mut state = ResamplerState {
            timeline,
            pending: vec![Vec::new(); channels],
            first: -reach,
            next: 0,
            non_finite: 0,
        };
        state.restart(reach);
        Ok(Self {
            input_hz,
            output_hz,
            up,
            down,
            reach,
            taps,
            state,
        })
    }

    /// Everything that must be saved to go on later with the same samples.
    pub fn state(&self) -> &ResamplerState {
        &self.state
    }

    /// Checks a state that was saved by a resampler made with the same arguments.
    ///
    /// # Errors
    /// [`AudioError::State`] or [`AudioError::Shape`] where it was made with others or contradicts itself.
    pub fn check_saved(&self, saved: &ResamplerState) -> Result<(), AudioError> {
        self.state.timeline.check_saved(&saved.timeline)?;
        check_shape(
            "channels of a saved state",
            self.state.pending.len(),
            saved.pending.len(),
        )?;
        // What every block leaves: the samples that the next output needs, and no output that could be made of them.
        let held = saved.pending.first().map_or(0, Vec::len);
        for samples in &saved.pending {
            check_shape("samples of a saved channel", held, samples.len())?;
            check_state(
                samples.iter().all(|sample| sample.is_finite()),
                "a sample is not finite",
            )?;
        }
        let counted = (0..=MOST_COUNTED as i64).contains(&saved.next) && saved.non_finite <= MOST_COUNTED;
        check_state(counted, "the number of samples")?;
        let placed = saved.first == self.place(saved.next) - self.reach && held as i64 <= 2 * self.reach;
        check_state(placed, "the place of the samples")
    }

    /// Goes on from a state saved by a resampler made with the same arguments.
    ///
    /// # Errors
    /// As [`Self::check_saved`]; nothing is changed then.
    pub fn restore(&mut self, state: ResamplerState) -> Result<(), AudioError> {
        self.check_saved(&state)?;
        self.state = state;
        Ok(())
    }

    /// Input sample on which output sample `next` is centred, rounded down.
    fn place(&self, next: i64) -> i64 {
        next * self.down / self.up
    }

    /// How long after a sound its samples come out, at the least: half the filter's length.
    pub fn latency(&self) -> Span {
        Span::of_samples(self.reach, self.input_hz)
    }

    /// Samples so far that were not finite and were taken as zero.
    pub fn non_finite(&self) -> u64 {
        self.state.non_finite
    }

    /// Takes a block and puts into `output` the samples that it completes, with their time and the new rate.
    ///
    /// `output` may come out empty. After a gap too long to fill, a new run begins at the block's first sample, and the
    /// last few samples before the gap (see [`Self::latency`]) are lost.
    ///
    /// # Errors
    /// [`AudioError::Shape`] where the block has another number of channels, another rate or channels of unequal
    /// length; it is then ignored, and `output` is empty.
    pub fn process(&mut self, block: &AudioBlock, output: &mut AudioBlock) -> Result<(), AudioError> {
        let channels = self.state.pending.len();
        output.rate_hz = self.output_hz;
        output.channels.resize_with(channels, Vec::new);
        output.clear();
        check_block(block, channels, self.input_hz)?;
        if block.is_empty() {
            return Ok(());
        }
        let state = &mut self.state;
        let arrival = state.timeline.accept(block.time, block.len());
        if arrival.restart {
            state.restart(self.reach);
        }
        for (pending, samples) in state.pending.iter_mut().zip(&block.channels) {
            pending.resize(pending.len() + arrival.fill, 0.0);
            for &sample in &samples[arrival.skip..] {
                pending.push(if sample.is_finite() { sample } else { 0.0 });
                state.non_finite += u64::from(!sample.is_finite());
            }
        }
        output.time = state.timeline.time_at_rate(state.next, self.output_hz);
        let width = (2 * self.reach + 1) as usize;
        let held = state.pending.first().map_or(0, Vec::len) as i64;
        let mut next = state.next;
        if self.up == self.down {
            // The same rate: what arrived is what comes out (a negative zero as a positive one).
            let start = (next - state.first) as usize;
            for (pending, output) in state.pending.iter().zip(&mut output.channels) {
                output.extend(pending[start..].iter().map(|sample| sample + 0.0));
            }
            next = state.first + held;
        }
        let ready = |next: i64| next * self.down / self.up + self.reach < state.first + held;
        while ready(next) {
            let place = next * self.down;
            let start = (place / self.up - self.reach - state.first) as usize;
            let phase = (place % self.up) as usize;
            let taps = &self.taps[phase * width..(phase + 1) * width];
            for (pending, output) in state.pending.iter().zip(&mut output.channels) {
                output.push(dot(&pending[start..start + width], taps));
            }
            next += 1;
        }
        state.next = next;
        let needed = next * self.down / self.up - self.reach;
        let done = (needed - state.first).clamp(0, held);
        for pending in &mut state.pending {
            pending.drain(..done as usize);
        }
        state.first += done;
        Ok(())
    }
}

impl ResamplerState {
    fn restart(&mut self, reach: i64) {
        for pending in &mut self.pending {
            pending.clear();
            pending.resize(reach as usize, 0.0);
        }
        self.first = -reach;
        self.next = 0;
    }
}

/// Taps for each phase: a Kaiser-windowed sinc centred on the output sample, each phase of unit gain at 0 Hz.
fn design(input_hz: u32, output_hz: u32, up: i64) -> (i64, Vec<f32>) {
    let input_hz = f64::from(input_hz);
    let nyquist_hz = 0.5 * input_hz.min(f64::from(output_hz));
    let transition = (1.0 - PASS_SHARE) * nyquist_hz / input_hz;
    // Kaiser's formulas for length and shape; lengths in input samples.
    let reach = ((ATTENUATION_DB - 7.95) / (14.36 * transition) / 2.0).ceil();
    let beta = 0.1102 * (ATTENUATION_DB - 8.7);
    let cutoff = 0.5 * (1.0 + PASS_SHARE) * nyquist_hz / input_hz;
    let width = 2 * reach as i64 + 1;
    let mut taps = Vec::with_capacity((up * width) as usize);
    for phase in 0..up {
        let tap = |k: i64| {
            let offset = phase as f64 / up as f64 - (k as f64 - reach);
            let edge = 1.0 - (offset / reach).powi(2);
            if edge < 0.0 {
                return 0.0;
            }
            let angle = 2.0 * PI * cutoff * offset;
            let sinc = if angle.abs() < 1e-9 {
                1.0
            } else {
                angle.sin() / angle
            };
            sinc * bessel_i0(beta * edge.sqrt())
        };
        let sum: f64 = (0..width).map(tap).sum();
        taps.extend((0..width).map(|k| (tap(k) / sum) as f32));
    }
    (reach as i64, taps)
}

/// The modified Bessel function of the first kind and order 0, by its power series.
fn bessel_i0(x: f64) -> f64 {
    let quarter = 0.25 * x * x;
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..60 {
        term *= quarter / f64::from(k * k);
        sum += term;
    }
    sum
}

/// Sum of products in eight partial sums of fixed order: fast, and the same on every machine.
fn dot(samples: &[f32], taps: &[f32]) -> f32 {
    let mut partial = [0.0_f32; 8];
    let (sample_parts, tap_parts) = (samples.chunks_exact(8), taps.chunks_exact(8));
    let rest: f32 = sample_parts
        .remainder()
        .iter()
        .zip(tap_parts.remainder())
        .map(|(x, h)| x * h)
        .sum();
    for (samples, taps) in sample_parts.zip(tap_parts) {
        for k in 0..8 {
            partial[k] += samples[k] * taps[k];
        }
    }
    partial.iter().sum::<f32>() + rest
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 {
        a
    } else {
        greatest_common_divisor(b, a % b)
    }
}

#[cfg(test)]
mod tests;
