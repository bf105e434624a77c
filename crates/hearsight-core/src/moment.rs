//! A moment: what arrived within one tick on the common clock.
//!
//! For each sensor a moment holds its *new* data or nothing. Buffers are owned by the moment and reused from tick to
//! tick, so a steady run allocates nothing here.

use crate::picture::{GrayView, RgbView};
use crate::time::{Instant, Span};
use serde::{Deserialize, Serialize};

/// One picture of one camera.
#[derive(Clone, Debug, Default)]
pub struct VideoFrame {
    /// When it was taken, on the common clock.
    pub time: Instant,
    /// The camera's own frame number, from 1.
    pub number: u64,
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Interleaved R, G, B, `width * height * 3` bytes.
    pub rgb: Vec<u8>,
    /// Luma in full range (0 black, 255 white), `width * height` bytes.
    pub luma: Vec<u8>,
}

/// A run of consecutive samples of one microphone array.
#[derive(Clone, Debug, Default)]
pub struct AudioBlock {
    /// When the first sample was taken, on the common clock.
    pub time: Instant,
    /// Samples a second.
    pub rate_hz: u32,
    /// One vector a channel, all of the same length; full scale is ±1.
    pub channels: Vec<Vec<f32>>,
}

/// Everything new since the tick before. The index into `video` and `audio` is the sensor's place in the room.
#[derive(Clone, Debug, Default)]
pub struct Moment {
    /// Number of the tick, from 0.
    pub tick: u64,
    /// The tick's time on the common clock; data in the moment are not later than this.
    pub time: Instant,
    /// For each camera its newest frame and whether it is new in this moment.
    pub video: Vec<Observed<VideoFrame>>,
    /// For each array the samples that are new in this moment (possibly none).
    pub audio: Vec<Observed<AudioBlock>>,
    /// What went wrong since the tick before.
    pub faults: Vec<Fault>,
}

/// A reusable buffer and whether it holds new data.
#[derive(Clone, Debug, Default)]
pub struct Observed<T> {
    /// Whether `data` is new in this moment; otherwise it is left over and must not be read.
    pub new: bool,
    /// The buffer.
    pub data: T,
}

/// Something that went wrong with a source without ending the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Fault {
    /// The sensor's name.
    pub sensor: String,
    /// When, in seconds on the common clock.
    pub time_s: f64,
    /// What kind.
    pub kind: FaultKind,
    /// A sentence for people.
    pub detail: String,
}

/// The kinds of fault a source can report.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// Data that should have come between two others did not.
    Gap,
    /// Data came twice, or with a time not after that of the data before; they were left out.
    Duplicate,
    /// A packet or frame could not be decoded; it was left out.
    Corrupt,
    /// The source ended before the others, or before its declared length.
    EndedEarly,
    /// A live source came faster than it was read; the oldest data were left out.
    Dropped,
    /// Samples that are not finite numbers were replaced by zero.
    NonFinite,
    /// The source was lost and could not be read on.
    Lost,
}

impl VideoFrame {
    /// The colour picture.
    pub fn rgb_view(&self) -> RgbView<'_> {
        RgbView {
            width: self.width,
            height: self.height,
            data: &self.rgb,
        }
    }

    /// The luma picture.
    pub fn luma_view(&self) -> GrayView<'_> {
        GrayView {
            width: self.width,
            height: self.height,
            data: &self.luma,
        }
    }
}

impl AudioBlock {
    /// Samples in each channel.
    pub fn len(&self) -> usize {
        self.channels.first().map_or(0, Vec::len)
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The instant just after the last sample.
    pub fn end(&self) -> Instant {
        self.time + Span::of_samples(self.len() as i64, self.rate_hz)
    }

    /// Forgets the samples, keeping the memory.
    pub fn clear(&mut self) {
        for channel in &mut self.channels {
            channel.clear();
        }
    }
}

impl<T> Observed<T> {
    /// The data where they are new.
    pub fn get(&self) -> Option<&T> {
        self.new.then_some(&self.data)
    }
}
