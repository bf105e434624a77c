//! Framing: blocks of any length in, overlapping frames of one length with their exact instants out.
//!
//! The framer holds one frame a channel and nothing more, however long a block is: frames are handed to a closure as
//! they fill. How blocks are cut does not change the frames.

use crate::error::{AudioError, MOST_COUNTED, check_setting, check_shape, check_state};
use crate::timeline::{Timeline, check_block};
use hearsight_core::{AudioBlock, Instant, Span};
use serde::{Deserialize, Serialize};

/// How a stream is cut into frames.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameSettings {
    /// Samples a frame, at least 1.
    pub length: usize,
    /// Samples from the start of one frame to the start of the next, 1 to `length`.
    pub hop: usize,
    /// Samples a second.
    pub rate_hz: u32,
    /// Channels of the array, at least 1.
    pub channels: usize,
    /// Gaps up to this long are filled with zeros, longer ones begin anew at the first sample after them; 0 to 60 s.
    pub longest_fill: Span,
}

impl FrameSettings {
    /// Frames of `length_s` seconds (rounded to samples) overlapping by half; gaps up to 0.2 s are filled.
    ///
    /// Half overlap is the usual choice for a Hann window: every sample then counts alike over the frames.
    pub fn half_overlapping(length_s: f64, rate_hz: u32, channels: usize) -> Self {
        let hop = ((0.5 * length_s * f64::from(rate_hz)).round() as usize).max(1);
        Self {
            length: 2 * hop,
            hop,
            rate_hz,
            channels,
            longest_fill: Span::from_seconds(0.2),
        }
    }

    /// Seconds from one frame to the next.
    pub fn hop_s(&self) -> f64 {
        self.hop as f64 / f64::from(self.rate_hz.max(1))
    }
}

/// One frame of all channels, borrowed from the framer.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Number of the frame since the framer was made, from 0; it goes on after a gap.
    pub number: u64,
    /// When the first sample was taken.
    pub start: Instant,
    /// Just after the last sample.
    pub end: Instant,
    /// How many samples of the frame were never heard and are zero; such a frame says nothing about the noise.
    pub filled: usize,
    /// Channels x length, full scale ±1, all finite.
    pub channels: &'a [Vec<f32>],
}

impl Frame<'_> {
    /// The instant in the middle, which is what a delay measured on the frame speaks of.
    pub fn middle(&self) -> Instant {
        self.start + (self.end - self.start) / 2
    }
}

/// Cuts a stream of blocks into frames. Its whole state is serializable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Framer {
    settings: FrameSettings,
    timeline: Timeline,
    buffer: Vec<Vec<f32>>,
    heard: Vec<bool>,
    /// Samples now in the buffer, below `length` between calls.
    held: usize,
    /// Index in the timeline of the first sample in the buffer.
    first: i64,
    number: u64,
    non_finite: u64,
    restarts: u64,
    filled: u64,
    skipped: u64,
}

impl Framer {
    /// A framer with nothing heard yet.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where a setting is out of its range.
    pub fn new(settings: FrameSettings) -> Result<Self, AudioError> {
        let FrameSettings {
            length,
            hop,
            rate_hz,
            channels,
            longest_fill,
        } = settings;
        check_setting(length > 0, "length", "above 0", length as f64)?;
        check_setting(
            (1..=length).contains(&hop),
            "hop",
            "within 1 and the length",
            hop as f64,
        )?;
        check_setting(channels > 0, "channels", "above 0", channels as f64)?;
        Ok(Self {
            settings,
            timeline: Timeline::new(rate_hz, longest_fill)?,
            buffer: vec![vec![0.0; length]; channels],
            heard: vec![false; length],
            held: 0,
            first: 0,
            number: 0,
            non_finite: 0,
            restarts: 0,
            filled: 0,
            skipped: 0,
        })
    }

    /// The settings it was made with.
    pub fn settings(&self) -> &FrameSettings {
        &self.settings
    }

    /// Checks a framer that was saved: whether this one could have become it.
    ///
    /// # Errors
    /// [`AudioError::State`] or [`AudioError::Shape`] where it is of other settings or contradicts itself.
    pub fn check_saved(&self, saved: &Self) -> Result<(), AudioError> {
        check_state(
            saved.settings == self.settings,
            "the length, hop or channels of frames",
        )?;
        self.timeline.check_saved(&saved.timeline)?;
        let length = self.settings.length;
        check_shape(
            "channels of a saved frame",
            self.settings.channels,
            saved.buffer.len(),
        )?;
        for samples in &saved.buffer {
            check_shape("samples of a saved frame", length, samples.len())?;
            check_state(
                samples.iter().all(|sample| sample.is_finite()),
                "a sample is not finite",
            )?;
        }
        check_shape("marks of a saved frame", length, saved.heard.len())?;
        check_state(
            saved.held < length && (0..=MOST_COUNTED as i64).contains(&saved.first),
            "the place of the frame",
        )?;
        let counts = [
            saved.number,
            saved.non_finite,
            saved.restarts,
            saved.filled,
            saved.skipped,
        ];
        check_state(
            counts.iter().all(|&count| count <= MOST_COUNTED),
            "the number of frames",
        )
    }

    /// Samples so far that were not finite and were taken as zero.
    pub fn non_finite(&self) -> u64 {
        self.non_finite
    }

    /// Times so far that a gap was too long to fill.
    pub fn restarts(&self) -> u64 {
        self.restarts
    }

    /// Samples so far, a channel, that were filled with zeros.
    pub fn filled(&self) -> u64 {
        self.filled
    }

    /// Samples so far, a channel, left out because their time had been heard already.
    pub fn skipped(&self) -> u64 {
        self.skipped
    }

    /// Takes a block and calls `each` for every frame that it completes, in order of time.
    ///
    /// A block within 1 ms of where the last one ended follows on. After a gap up to `longest_fill` zeros are filled in;
    /// after a longer one the part of a frame held so far is dropped and framing begins at the block's first sample.
    /// Samples whose time was heard already are left out.
    ///
    /// # Errors
    /// [`AudioError::Shape`] where the block has another number of channels, another rate, or channels of unequal
    /// length; the block is then ignored.
    pub fn push(&mut self, block: &AudioBlock, mut each: impl FnMut(Frame<'_>)) -> Result<(), AudioError> {
        check_block(block, self.settings.channels, self.settings.rate_hz)?;
        if block.is_empty() {
            return Ok(());
        }
        let arrival = self.timeline.accept(block.time, block.len());
        if arrival.restart {
            self.restarts += u64::from(self.number > 0 || self.held > 0);
            self.held = 0;
            self.first = 0;
        }
        self.filled += arrival.fill as u64;
        self.skipped += arrival.skip as u64;
        self.append(None, arrival.fill, &mut each);
        self.append(Some((block, arrival.skip)), block.len() - arrival.skip, &mut each);
        Ok(())
    }

    fn append(
        &mut self,
        source: Option<(&AudioBlock, usize)>,
        count: usize,
        each: &mut impl FnMut(Frame<'_>),
    ) {
        let FrameSettings { length, hop, .. } = self.settings;
        let mut taken = 0;
        while taken < count {
            let part = (length - self.held).min(count - taken);
            let place = self.held..self.held + part;
            self.heard[place.clone()].fill(source.is_some());
            for (channel, buffer) in self.buffer.iter_mut().enumerate() {
                let Some((block, offset)) = source else {
                    buffer[place.clone()].fill(0.0);
                    continue;
                };
                let samples = &block.channels[channel][offset + taken..offset + taken + part];
                for (held, &sample) in buffer[place.clone()].iter_mut().zip(samples) {
                    *held = if sample.is_finite() { sample } else { 0.0 };
                    self.non_finite += u64::from(!sample.is_finite());
                }
            }
            taken += part;
            self.held += part;
            if self.held == length {
                each(Frame {
                    number: self.number,
                    start: self.timeline.time_of(self.first),
                    end: self.timeline.time_of(self.first + length as i64),
                    filled: self.heard.iter().filter(|heard| !**heard).count(),
                    channels: &self.buffer,
                });
                self.number += 1;
                self.first += hop as i64;
                self.held -= hop;
                self.heard.copy_within(hop.., 0);
                for buffer in &mut self.buffer {
                    buffer.copy_within(hop.., 0);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
