//! Live sources: a reader thread and a bounded queue that drops the oldest data and counts them.
//!
//! The thread takes data as they come, or holds each back until its time, so that a recording behaves as a live
//! camera would. Asking a live source never waits.

use crate::clock::RunClock;
use crate::error::fault;
use crate::queue::{Queue, Taken};
use hearsight_core::source::{AudioFormat, AudioSource, Delivery, VideoFormat, VideoSource};
use hearsight_core::{AudioBlock, Fault, FaultKind, Instant, Span, VideoFrame};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// Zeros that one block stands for where samples were dropped.
const ZEROS_A_BLOCK: i64 = 4096;
/// The thread looks this often whether it should stop while it holds data back.
const LONGEST_NAP: Duration = Duration::from_millis(50);

/// When the thread passes data on.
#[derive(Clone, Copy, Debug)]
pub enum Pace {
    /// As soon as the source delivers them: for sources that are live by themselves.
    AsItComes,
    /// At their times by this clock: a frame at its time, samples once the last of a block is over.
    By(RunClock),
}

/// How a live source is queued.
#[derive(Clone, Debug)]
pub struct QueueOptions {
    /// The sensor's name, which faults carry.
    pub name: String,
    /// Frames or blocks that the queue holds, at least 1; default 8.
    pub capacity: usize,
    /// When data are passed on; default as they come.
    pub pace: Pace,
}

impl Default for QueueOptions {
    fn default() -> Self {
        Self {
            name: String::new(),
            capacity: 8,
            pace: Pace::AsItComes,
        }
    }
}

/// A camera behind a queue. Dropping it tells the thread to stop and does not wait for it; the thread ends when the
/// source next returns.
pub struct LiveVideo {
    queue: Arc<Queue<VideoFrame>>,
    format: VideoFormat,
    name: String,
    last: Option<Instant>,
}

impl LiveVideo {
    /// Starts a thread that reads `source`.
    ///
    /// # Errors
    /// Where the system has no thread to give.
    pub fn spawn(mut source: Box<dyn VideoSource>, options: &QueueOptions) -> std::io::Result<Self> {
        let format = VideoFormat {
            live: true,
            ..source.format().clone()
        };
        let queue = Arc::new(Queue::new(options.capacity));
        let (inner, pace) = (Arc::clone(&queue), options.pace);
        thread::Builder::new().name("camera".to_owned()).spawn(move || {
            run(&inner, pace, |frame: &mut VideoFrame, faults| {
                (source.read(frame, faults), frame.time)
            });
        })?;
        Ok(Self {
            queue,
            format,
            name: options.name.clone(),
            last: None,
        })
    }

    /// Frames that were dropped since they were not read in time.
    pub fn dropped(&self) -> u64 {
        self.queue.dropped()
    }
}

impl VideoSource for LiveVideo {
    fn format(&self) -> &VideoFormat {
        &self.format
    }

    fn read(&mut self, frame: &mut VideoFrame, faults: &mut Vec<Fault>) -> Delivery {
        let Taken { delivery, dropped } = self.queue.take(frame, faults);
        if dropped > 0 {
            let time = if delivery == Delivery::Data {
                frame.time
            } else {
                self.last.unwrap_or(self.format.start)
            };
            let detail = format!("{dropped} frames before this time were not read soon enough and dropped");
            faults.push(fault(&self.name, time, FaultKind::Dropped, detail));
        }
        if delivery == Delivery::Data {
            self.last = Some(frame.time);
        }
        delivery
    }
}

impl Drop for LiveVideo {
    fn drop(&mut self) {
        self.queue.stop();
    }
}

/// An array behind a queue; zeros stand for dropped samples. Dropping it is as for [`LiveVideo`].
pub struct LiveAudio {
    queue: Arc<Queue<AudioBlock>>,
    format: AudioFormat,
    name: String,
    /// The block that waits until the zeros before it are given.
    held: AudioBlock,
    is_held: bool,
    /// Where the next samples belong.
    next: Option<Instant>,
}

impl LiveAudio {
    /// Starts a thread that reads `source`.
    ///
    /// # Errors
    /// Where the system has no thread to give.
    pub fn spawn(mut source: Box<dyn AudioSource>, options: &QueueOptions) -> std::io::Result<Self> {
        let format = AudioFormat {
            live: true,
            ..source.format().clone()
        };
        let queue = Arc::new(Queue::new(options.capacity));
        let (inner, pace) = (Arc::clone(&queue), options.pace);
        thread::Builder::new()
            .name("microphones".to_owned())
            .spawn(move || {
                run(&inner, pace, |block: &mut AudioBlock, faults| {
                    (source.read(block, faults), block.end())
                });
            })?;
        Ok(Self {
            queue,
            format,
            name: options.name.clone(),
            held: AudioBlock::default(),
            is_held: false,
            next: None,
        })
    }

    /// Blocks that were dropped since they were not read in time.
    pub fn dropped(&self) -> u64 {
        self.queue.dropped()
    }

    /// Samples missing between what was given and the held block.
    fn missing(&self) -> i64 {
        let Some(next) = self.next else { return 0 };
        let samples = (self.held.time - next).samples(self.format.rate_hz);
        // A block a sample off is rounding or drift.
        if samples > 1 { samples } else { 0 }
    }
}

impl AudioSource for LiveAudio {
    fn format(&self) -> &AudioFormat {
        &self.format
    }

    fn read(&mut self, block: &mut AudioBlock, faults: &mut Vec<Fault>) -> Delivery {
        if !self.is_held {
            let Taken { delivery, dropped } = self.queue.take(&mut self.held, faults);
            if dropped > 0 {
                let time = self.next.unwrap_or(self.format.start);
                let detail =
                    format!("{dropped} blocks were not read soon enough and dropped; zeros stand for them");
                faults.push(fault(&self.name, time, FaultKind::Dropped, detail));
            }
            if delivery != Delivery::Data {
                return delivery;
            }
            self.is_held = true;
        }
        let missing = self.missing();
        if let (1.., Some(next)) = (missing, self.next) {
            let count = missing.min(ZEROS_A_BLOCK);
            block.channels.resize_with(self.format.channels, Vec::new);
            for channel in &mut block.channels {
                channel.clear();
                channel.resize(count as usize, 0.0);
            }
            (block.time, block.rate_hz) = (next, self.format.rate_hz);
            self.next = Some(next + Span::of_samples(count, self.format.rate_hz));
            return Delivery::Data;
        }
        std::mem::swap(block, &mut self.held);
        self.is_held = false;
        self.next = Some(block.end());
        Delivery::Data
    }
}

impl Drop for LiveAudio {
    fn drop(&mut self) {
        self.queue.stop();
    }
}

/// The thread's work: reads until the source ends or nobody listens.
fn run<T: Default + Send>(
    queue: &Queue<T>,
    pace: Pace,
    mut read: impl FnMut(&mut T, &mut Vec<Fault>) -> (Delivery, Instant),
) {
    let mut faults = Vec::new();
    let mut item = T::default();
    while !queue.is_stopped() {
        let (delivery, due) = read(&mut item, &mut faults);
        if delivery == Delivery::Data
            && let Pace::By(clock) = pace
        {
            while !clock.until(due).is_zero() && !queue.is_stopped() {
                thread::sleep(clock.until(due).min(LONGEST_NAP));
            }
        }
        queue.report(&mut faults);
        match delivery {
            Delivery::Data => queue.put(&mut item),
            Delivery::Pending => thread::sleep(Duration::from_millis(1)),
            Delivery::End => break,
        }
    }
    queue.end();
}
