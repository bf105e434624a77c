//! Late reverberation: convolution with responses that are renewed as source or microphones move.
//!
//! Blocks of the source's signal are convolved with the response of the time when they were emitted; where a response
//! is renewed, one block fades from the old to the new one. So nothing clicks, and what was emitted before goes on
//! decaying with its own response. Convolution is partitioned: a block's spectrum times that of each part of the
//! response is added to the spectrum of the block where that part is heard.

use super::error::AcousticsError;
use super::lattice::Lattice;
use super::synthesis::{Link, Scratch, Split, Synthesis};
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::sync::Arc;

/// What all late responses of an array have in common.
pub(crate) struct TailPlan {
    /// Samples of a block.
    pub(crate) block: usize,
    /// Parts of a response.
    pub(crate) parts: usize,
    /// What makes late responses, where there are any.
    pub(crate) late: Option<LatePlan>,
    forward: Arc<dyn RealToComplex<f32>>,
    inverse: Arc<dyn ComplexToReal<f32>>,
}

/// The images of the late responses.
pub(crate) struct LatePlan {
    pub(crate) lattice: Lattice,
    pub(crate) synthesis: Synthesis,
    pub(crate) split: Split,
}

impl TailPlan {
    /// For responses of so many samples.
    pub(crate) fn new(block: usize, samples: usize, late: Option<LatePlan>) -> Self {
        let mut planner = RealFftPlanner::new();
        Self {
            block,
            parts: samples.div_ceil(block),
            late,
            forward: planner.plan_fft_forward(2 * block),
            inverse: planner.plan_fft_inverse(2 * block),
        }
    }

    fn bins(&self) -> usize {
        self.block + 1
    }
}

/// What a source feeds into the late reverberation in one block.
pub(crate) struct TailInput {
    /// Signal as the array's clock samples it.
    pub(crate) signal: Vec<f32>,
    padded: Vec<f32>,
    scratch: Vec<Complex<f32>>,
    /// Spectrum of what belongs to the response held until now, and to the one made for this block.
    spectra: [Vec<Complex<f32>>; 2],
    pub(crate) feed: Feed,
}

/// With which responses a block is convolved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feed {
    /// It is silent.
    Nothing,
    /// With the one held.
    Held,
    /// With a new one.
    Renewed,
    /// Fading from the one held to a new one.
    Faded,
}

impl TailInput {
    pub(crate) fn new(plan: &TailPlan) -> Self {
        Self {
            signal: vec![0.0; plan.block],
            padded: plan.forward.make_input_vec(),
            scratch: plan.forward.make_scratch_vec(),
            spectra: [plan.forward.make_output_vec(), plan.forward.make_output_vec()],
            feed: Feed::Nothing,
        }
    }

    /// Transforms the signal as `feed` says.
    pub(crate) fn transform(&mut self, plan: &TailPlan) -> Result<(), AcousticsError> {
        let uses = match self.feed {
            Feed::Nothing => [false, false],
            Feed::Held => [true, false],
            Feed::Renewed => [false, true],
            Feed::Faded => [true, true],
        };
        for (which, uses) in uses.into_iter().enumerate() {
            if !uses {
                continue;
            }
            let step = 1.0 / plan.block as f32;
            for (number, (padded, sample)) in self.padded.iter_mut().zip(&self.signal).enumerate() {
                let part = (number as f32 + 0.5) * step;
                let rise = part * part * (3.0 - 2.0 * part);
                *padded = match (self.feed, which) {
                    (Feed::Faded, 0) => *sample * (1.0 - rise),
                    (Feed::Faded, _) => *sample * rise,
                    _ => *sample,
                };
            }
            self.padded[plan.block..].fill(0.0);
            let spectrum = &mut self.spectra[which];
            plan.forward
                .process_with_scratch(&mut self.padded, spectrum, &mut self.scratch)?;
        }
        Ok(())
    }
}

/// The response of one source at one microphone, as spectra of its parts.
pub(crate) struct Filter {
    /// `parts` x bins, or empty as long as there is none.
    parts: Vec<Complex<f32>>,
    renewed: Vec<Complex<f32>>,
    /// Parts that are not silent: the first and the one after the last.
    range: [usize; 2],
    renewed_range: [usize; 2],
}

impl Filter {
    pub(crate) const EMPTY: Self = Self {
        parts: Vec::new(),
        renewed: Vec::new(),
        range: [0, 0],
        renewed_range: [0, 0],
    };
}

/// The late reverberation of one microphone.
pub(crate) struct TailEar {
    /// Spectra of the blocks to come, `parts` x bins, in a ring.
    ahead: Vec<Complex<f32>>,
    /// Blocks ahead that something has been added to.
    busy: usize,
    next: usize,
    overlap: Vec<f32>,
    /// What is heard in this block.
    pub(crate) output: Vec<f32>,
    scratch: Option<Scratch>,
    padded: Vec<f32>,
    spectrum: Vec<Complex<f32>>,
    transform: Vec<Complex<f32>>,
}

impl TailEar {
    pub(crate) fn new(plan: &TailPlan) -> Self {
        let longest = plan.forward.get_scratch_len().max(plan.inverse.get_scratch_len());
        Self {
            ahead: vec![Complex::ZERO; plan.parts * plan.bins()],
            busy: 0,
            next: 0,
            overlap: vec![0.0; plan.block],
            output: vec![0.0; plan.block],
            scratch: plan.late.as_ref().map(|late| late.synthesis.scratch()),
            padded: vec![0.0; 2 * plan.block],
            spectrum: vec![Complex::ZERO; plan.bins()],
            transform: vec![Complex::ZERO; longest],
        }
    }

    /// Makes the new response from the late images.
    pub(crate) fn renew(
        &mut self,
        plan: &TailPlan,
        link: &Link,
        filter: &mut Filter,
    ) -> Result<(), AcousticsError> {
        // Taken out meanwhile: its samples are loaded from it.
        let (Some(late), Some(mut scratch)) = (&plan.late, self.scratch.take()) else {
            return Ok(());
        };
        late.synthesis
            .add(&late.lattice, link, Some(&late.split), &mut scratch);
        let loaded = late.synthesis.finish(&mut scratch).and_then(|samples| {
            let lead = late.synthesis.lead();
            let count = samples.len().min(lead + plan.parts * plan.block);
            self.load(plan, &samples[lead..count], filter)
        });
        self.scratch = Some(scratch);
        loaded
    }

    /// Takes a measured response.
    pub(crate) fn measure(
        plan: &TailPlan,
        response: &[f32],
        filter: &mut Filter,
    ) -> Result<(), AcousticsError> {
        let mut ear = Self::new(plan);
        ear.load(plan, response, filter)?;
        filter.accept();
        Ok(())
    }

    fn load(&mut self, plan: &TailPlan, response: &[f32], filter: &mut Filter) -> Result<(), AcousticsError> {
        filter.renewed.resize(plan.parts * plan.bins(), Complex::ZERO);
        filter.renewed_range = [plan.parts, 0];
        // Each part of the spectrum is divided by the length of the transform here, once.
        let scale = 1.0 / (2 * plan.block) as f32;
        let parts = filter.renewed.chunks_exact_mut(plan.bins());
        for ((number, to), from) in parts.enumerate().zip(response.chunks(plan.block)) {
            if from.iter().all(|sample| *sample == 0.0) {
                to.fill(Complex::ZERO);
                continue;
            }
            filter.renewed_range = [filter.renewed_range[0].min(number), number + 1];
            self.padded.fill(0.0);
            for (padded, sample) in self.padded.iter_mut().zip(from) {
                *padded = *sample * scale;
            }
            let length = plan.forward.get_scratch_len();
            plan.forward
                .process_with_scratch(&mut self.padded, to, &mut self.transform[..length])?;
        }
        let filled = response.len().div_ceil(plan.block).min(plan.parts);
        filter.renewed[filled * plan.bins()..].fill(Complex::ZERO);
        Ok(())
    }

    /// Adds what comes of a source's block.
    pub(crate) fn feed(&mut self, plan: &TailPlan, input: &TailInput, filter: &mut Filter) {
        if matches!(input.feed, Feed::Held | Feed::Faded) {
            self.add(plan, &input.spectra[0], &filter.parts, filter.range);
        }
        if matches!(input.feed, Feed::Renewed | Feed::Faded) {
            self.add(plan, &input.spectra[1], &filter.renewed, filter.renewed_range);
            filter.accept();
        }
    }

    /// Adds what comes of a source's block by a measured response, which is never renewed.
    pub(crate) fn feed_measured(&mut self, plan: &TailPlan, input: &TailInput, filter: &Filter) {
        if matches!(input.feed, Feed::Held | Feed::Faded) {
            self.add(plan, &input.spectra[0], &filter.parts, filter.range);
        }
        if matches!(input.feed, Feed::Renewed | Feed::Faded) {
            self.add(plan, &input.spectra[1], &filter.parts, filter.range);
        }
    }

    fn add(&mut self, plan: &TailPlan, input: &[Complex<f32>], parts: &[Complex<f32>], range: [usize; 2]) {
        let bins = plan.bins();
        for part in range[0]..range[1] {
            let slot = (self.next + part) % plan.parts;
            let to = &mut self.ahead[slot * bins..(slot + 1) * bins];
            multiply_add(input, &parts[part * bins..(part + 1) * bins], to);
        }
        self.busy = self.busy.max(range[1]);
    }

    /// Turns what belongs to this block into samples.
    pub(crate) fn finish(&mut self, plan: &TailPlan) -> Result<(), AcousticsError> {
        self.output.copy_from_slice(&self.overlap);
        self.overlap.fill(0.0);
        if self.busy == 0 {
            return Ok(());
        }
        self.busy -= 1;
        let bins = plan.bins();
        let slot = &mut self.ahead[self.next * bins..(self.next + 1) * bins];
        self.spectrum.copy_from_slice(slot);
        slot.fill(Complex::ZERO);
        self.next = (self.next + 1) % plan.parts;
        (self.spectrum[0].im, self.spectrum[bins - 1].im) = (0.0, 0.0);
        let length = plan.inverse.get_scratch_len();
        let transform = &mut self.transform[..length];
        plan.inverse
            .process_with_scratch(&mut self.spectrum, &mut self.padded, transform)?;
        for (output, sample) in self.output.iter_mut().zip(&self.padded) {
            *output += sample;
        }
        self.overlap.copy_from_slice(&self.padded[plan.block..]);
        Ok(())
    }
}

impl Filter {
    /// Holds the new response from now on.
    fn accept(&mut self) {
        std::mem::swap(&mut self.parts, &mut self.renewed);
        self.range = self.renewed_range;
    }
}

#[multiversion::multiversion(targets("x86_64+avx2"))]
fn multiply_add(a: &[Complex<f32>], b: &[Complex<f32>], to: &mut [Complex<f32>]) {
    for ((a, b), to) in a.iter().zip(b).zip(to) {
        to.re += a.re * b.re - a.im * b.im;
        to.im += a.re * b.im + a.im * b.re;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_convolved() {
        let plan = TailPlan::new(60, 200, None);
        let response: Vec<f32> = (0..200)
            .map(|n| ((n * 7919) % 101) as f32 / 101.0 - 0.5)
            .collect();
        let signal: Vec<f32> = (0..600)
            .map(|n| ((n * 104_729) % 97) as f32 / 97.0 - 0.5)
            .collect();
        let mut filter = Filter::EMPTY;
        TailEar::measure(&plan, &response, &mut filter).unwrap();
        let (mut ear, mut input) = (TailEar::new(&plan), TailInput::new(&plan));
        let mut found = Vec::new();
        for block in signal
            .chunks(60)
            .chain(std::iter::repeat_n([0.0; 60].as_slice(), 5))
        {
            input.signal.copy_from_slice(block);
            input.feed = if block.iter().all(|sample| *sample == 0.0) {
                Feed::Nothing
            } else {
                Feed::Held
            };
            input.transform(&plan).unwrap();
            ear.feed(&plan, &input, &mut filter);
            ear.finish(&plan).unwrap();
            found.extend_from_slice(&ear.output);
        }
        for (n, found) in found.iter().enumerate() {
            let wanted: f32 = (0..200.min(n + 1))
                .map(|lag| response[lag] * signal.get(n - lag).copied().unwrap_or(0.0))
                .sum();
            assert!((found - wanted).abs() < 1e-4, "{n}: {found} {wanted}");
        }
    }

    #[test]
    fn a_fade_between_equal_responses_changes_nothing() {
        let plan = TailPlan::new(64, 128, None);
        let response = [0.3; 128];
        let signal: Vec<f32> = (0..64).map(|n| (n as f32 * 0.3).sin()).collect();
        let run = |feed: Feed| {
            let mut filter = Filter::EMPTY;
            TailEar::measure(&plan, &response, &mut filter).unwrap();
            let (mut ear, mut input) = (TailEar::new(&plan), TailInput::new(&plan));
            ear.load(&plan, &response, &mut filter).unwrap();
            input.signal.copy_from_slice(&signal);
            input.feed = feed;
            input.transform(&plan).unwrap();
            ear.feed(&plan, &input, &mut filter);
            ear.finish(&plan).unwrap();
            ear.output
        };
        let (held, faded) = (run(Feed::Held), run(Feed::Faded));
        assert!(held.iter().zip(&faded).all(|(a, b)| (a - b).abs() < 1e-5));
        assert!(held.iter().any(|sample| sample.abs() > 0.1));
    }
}
