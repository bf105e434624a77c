//! The traits of what delivers frames and samples: a file, a stream, a device or a simulated room.

use crate::moment::{AudioBlock, Fault, VideoFrame};
use crate::time::{Instant, Span};

/// What a read brought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delivery {
    /// The buffer was filled.
    Data,
    /// A live source has nothing yet; ask again.
    Pending,
    /// There will be no more.
    End,
}

/// Facts of a camera's source.
#[derive(Clone, Debug, PartialEq)]
pub struct VideoFormat {
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Nominal interval between frames.
    pub interval: Span,
    /// Frames in all, where known.
    pub frames: Option<u64>,
    /// Time of the first frame on the common clock.
    pub start: Instant,
    /// Whether data come at their own pace and cannot wait.
    pub live: bool,
}

/// Facts of an array's source.
#[derive(Clone, Debug, PartialEq)]
pub struct AudioFormat {
    /// Samples a second, as delivered.
    pub rate_hz: u32,
    /// Channels, as delivered.
    pub channels: usize,
    /// Samples a channel in all, where known.
    pub samples: Option<u64>,
    /// Time of the first sample on the common clock.
    pub start: Instant,
    /// Whether data come at their own pace and cannot wait.
    pub live: bool,
}

/// Delivers the frames of one camera in order of time.
pub trait VideoSource: Send {
    /// Facts known before the first frame.
    fn format(&self) -> &VideoFormat;
    /// Fills `frame` with the next picture, reusing its memory. What went wrong on the way is added to `faults`; a
    /// fault never ends the source by itself.
    fn read(&mut self, frame: &mut VideoFrame, faults: &mut Vec<Fault>) -> Delivery;
}

/// Delivers the samples of one array in order of time.
pub trait AudioSource: Send {
    /// Facts known before the first sample.
    fn format(&self) -> &AudioFormat;
    /// Replaces `block` by the next samples, as many as the source likes, reusing its memory. What went wrong on the
    /// way is added to `faults`; a gap is filled with zeros so that samples keep their time.
    fn read(&mut self, block: &mut AudioBlock, faults: &mut Vec<Fault>) -> Delivery;
}
