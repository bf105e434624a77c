//! Streaming conversion of the sample rate: no delay, the same for all channels.

use rubato::audioadapter_buffers::direct::SequentialSliceOfVecs;
use rubato::{Fft, FixedSync, Indexing, Resampler, ResamplerConstructionError, WindowFunction};

/// Input samples that one step of the transform takes, about; longer steps pass more of the highest frequencies but
/// delay a live source by their length.
const CHUNK: usize = 1024;

/// Converts planar samples from one rate to another, sample 0 to sample 0.
pub(crate) struct RateConverter {
    fft: Fft<f32>,
    from_hz: u64,
    to_hz: u64,
    /// Input not yet consumed.
    pending: Vec<Vec<f32>>,
    output: Vec<Vec<f32>>,
    /// Samples of the filter's delay still to be left out at the beginning.
    delay: usize,
    taken: u64,
    given: u64,
}

impl RateConverter {
    pub(crate) fn new(from_hz: u32, to_hz: u32, channels: usize) -> Result<Self, ResamplerConstructionError> {
        let fft = Fft::new_custom(
            from_hz as usize,
            to_hz as usize,
            even_chunk(from_hz, to_hz),
            1,
            channels,
            WindowFunction::BlackmanHarris2,
            FixedSync::Input,
        )?;
        Ok(Self {
            pending: vec![Vec::new(); channels],
            output: vec![vec![0.0; fft.output_frames_max()]; channels],
            delay: fft.output_delay(),
            from_hz: u64::from(from_hz),
            to_hz: u64::from(to_hz),
            taken: 0,
            given: 0,
            fft,
        })
    }

    /// Samples that `input` samples become.
    pub(crate) fn length(&self, input: u64) -> u64 {
        (u128::from(input) * u128::from(self.to_hz)).div_ceil(u128::from(self.from_hz.max(1))) as u64
    }

    /// Takes `input` and appends what is ready to `output`.
    pub(crate) fn push(&mut self, input: &[Vec<f32>], output: &mut [Vec<f32>]) {
        self.taken += input.first().map_or(0, Vec::len) as u64;
        for (pending, input) in self.pending.iter_mut().zip(input) {
            pending.extend_from_slice(input);
        }
        loop {
            let wanted = self.fft.input_frames_next();
            if self.pending.first().map_or(0, Vec::len) < wanted || !self.step(None, output) {
                return;
            }
            for pending in &mut self.pending {
                pending.drain(..wanted);
            }
        }
    }

    /// Appends what the filter still holds, up to the length that the input stands for.
    pub(crate) fn finish(&mut self, output: &mut [Vec<f32>]) {
        let whole = self.length(self.taken);
        while self.given < whole {
            let before = self.given;
            let left = self.pending.first().map_or(0, Vec::len);
            let delay = self.delay;
            if !self.step(Some(left), output) || (self.given == before && self.delay == delay && left == 0) {
                break;
            }
            self.pending.iter_mut().for_each(Vec::clear);
        }
        let surplus = self.given.saturating_sub(whole) as usize;
        self.given -= surplus as u64;
        for channel in output {
            channel.truncate(channel.len().saturating_sub(surplus));
        }
    }

    /// One step of the transform; `false` where it refuses, which its own sizes rule out.
    fn step(&mut self, partial: Option<usize>, output: &mut [Vec<f32>]) -> bool {
        let (channels, length) = (self.pending.len(), self.pending.first().map_or(0, Vec::len));
        let capacity = self.output.first().map_or(0, Vec::len);
        let indexing = partial.map(|length| Indexing::new().partial_len(length));
        let produced = {
            let Ok(source) = SequentialSliceOfVecs::new(&self.pending, channels, length) else {
                return false;
            };
            let Ok(mut sink) = SequentialSliceOfVecs::new_mut(&mut self.output, channels, capacity) else {
                return false;
            };
            match self
                .fft
                .process_into_buffer(&source, &mut sink, indexing.as_ref())
            {
                Ok((_, produced)) => produced,
                Err(error) => {
                    tracing::error!(%error, "the rate converter refused its own sizes");
                    return false;
                }
            }
        };
        let skipped = self.delay.min(produced);
        self.delay -= skipped;
        self.given += (produced - skipped) as u64;
        for (channel, ready) in output.iter_mut().zip(&self.output) {
            channel.extend_from_slice(&ready[skipped..produced]);
        }
        true
    }
}

/// A block of about [`CHUNK`] samples that is whole at both rates and even: the filter of an odd block would be off
/// by half an input sample.
fn even_chunk(from_hz: u32, to_hz: u32) -> usize {
    let (mut divisor, mut rest) = (from_hz, to_hz);
    while rest != 0 {
        (divisor, rest) = (rest, divisor % rest);
    }
    let unit = 2 * (from_hz / divisor.max(1)).max(1) as usize;
    CHUNK.div_ceil(unit) * unit
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(rate: u32, count: usize, phase: f64) -> Vec<f32> {
        let step = std::f64::consts::TAU * 440.0 / f64::from(rate);
        (0..count)
            .map(|i| (step * i as f64 + phase).sin() as f32)
            .collect()
    }

    #[test]
    fn a_sine_keeps_its_phase_at_any_rate_and_block_size() {
        for (from, to, block) in [(48_000, 16_000, 777), (44_100, 16_000, 1), (16_000, 48_000, 4000)] {
            let count = from as usize / 4 + 13;
            let input = [sine(from, count, 0.0), sine(from, count, 1.0)];
            let mut converter = RateConverter::new(from, to, 2).unwrap();
            let mut output = vec![Vec::new(), Vec::new()];
            for at in (0..count).step_by(block) {
                let end = (at + block).min(count);
                converter.push(
                    &[input[0][at..end].to_vec(), input[1][at..end].to_vec()],
                    &mut output,
                );
            }
            converter.finish(&mut output);
            let length = converter.length(count as u64) as usize;
            for (channel, phase) in output.iter().zip([0.0, 1.0]) {
                assert_eq!(channel.len(), length);
                let expected = sine(to, length, phase);
                let worst = (200..length - 200)
                    .map(|i| (channel[i] - expected[i]).abs())
                    .fold(0.0, f32::max);
                assert!(worst < 2e-3, "{from} to {to}: {worst}");
            }
        }
    }
}
