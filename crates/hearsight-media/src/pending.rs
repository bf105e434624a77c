//! What a source has delivered and no moment has taken yet.

use hearsight_core::moment::Observed;
use hearsight_core::source::{AudioSource, Delivery, VideoSource};
use hearsight_core::{AudioBlock, Fault, Instant, Span, VideoFrame};

/// Blocks further apart than this are not joined in one moment.
const LARGEST_SEAM: Span = Span::from_nanoseconds(1_000_000);

/// Whether a source has to be waited for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wait {
    /// It has data.
    No,
    /// It is live and has nothing yet.
    Yes,
    /// It has ended.
    Over,
}

/// A camera with its next frame and the frame that goes into the moment at hand.
pub(crate) struct PendingVideo {
    pub(crate) name: String,
    source: Box<dyn VideoSource>,
    next: VideoFrame,
    has_next: bool,
    ready: VideoFrame,
    has_ready: bool,
    /// Time of the first frame, whether it was used or not; the camera's phase.
    pub(crate) first: Option<Instant>,
    /// The tick of a frame at `first`.
    first_tick: Option<i64>,
    waiting: bool,
    ended: bool,
    pub(crate) superseded: u64,
}

impl PendingVideo {
    pub(crate) fn new(name: String, source: Box<dyn VideoSource>) -> Self {
        Self {
            name,
            source,
            next: VideoFrame::default(),
            has_next: false,
            ready: VideoFrame::default(),
            has_ready: false,
            first: None,
            first_tick: None,
            waiting: false,
            ended: false,
            superseded: 0,
        }
    }

    /// Reads the next frame of the range, where none is pending.
    pub(crate) fn fill(
        &mut self,
        from: Option<Instant>,
        until: Option<Instant>,
        faults: &mut Vec<Fault>,
    ) -> Wait {
        self.waiting = false;
        while !self.has_next {
            if self.ended {
                return Wait::Over;
            }
            let known = faults.len();
            let delivery = self.source.read(&mut self.next, faults);
            rename(&mut faults[known..], &self.name);
            match delivery {
                Delivery::Data => {
                    let time = self.next.time;
                    self.first.get_or_insert(time);
                    self.ended = until.is_some_and(|until| time >= until);
                    self.has_next = !self.ended && from.is_none_or(|from| time >= from);
                }
                Delivery::Pending => {
                    self.waiting = true;
                    return Wait::Yes;
                }
                Delivery::End => self.ended = true,
            }
        }
        Wait::No
    }

    /// Fixes the camera's place on the grid, once its first frame is known.
    pub(crate) fn align(&mut self, origin: Instant, tick: Span) {
        if let (None, Some(first)) = (self.first_tick, self.first) {
            self.first_tick = Some(ceiling((first - origin).nanoseconds(), tick.nanoseconds()));
        }
    }

    /// The tick to which the pending frame belongs: the nearest, counted from the camera's first frame.
    pub(crate) fn tick(&self, tick: Span) -> Option<i64> {
        let since = (self.time()? - self.first?).nanoseconds();
        let tick = tick.nanoseconds();
        Some(self.first_tick? + (since + tick / 2).div_euclid(tick))
    }

    /// Time of the pending frame.
    pub(crate) fn time(&self) -> Option<Instant> {
        self.has_next.then_some(self.next.time)
    }

    /// Time of the frame for the moment at hand.
    pub(crate) fn ready_time(&self) -> Option<Instant> {
        self.has_ready.then_some(self.ready.time)
    }

    /// The pending frame goes into the moment at hand.
    pub(crate) fn accept(&mut self) {
        self.superseded += u64::from(self.has_ready);
        std::mem::swap(&mut self.next, &mut self.ready);
        (self.has_next, self.has_ready) = (false, true);
    }

    /// The pending frame goes nowhere.
    pub(crate) fn forget(&mut self) {
        self.has_next = false;
    }

    /// Hands the ready frame over.
    pub(crate) fn give(&mut self, slot: &mut Observed<VideoFrame>) {
        slot.new = std::mem::take(&mut self.has_ready);
        if slot.new {
            std::mem::swap(&mut slot.data, &mut self.ready);
        }
    }

    pub(crate) fn is_waiting(&self) -> bool {
        self.waiting && !self.has_next && !self.ended
    }

    pub(crate) fn is_ready(&self) -> bool {
        self.has_ready
    }

    pub(crate) fn is_over(&self) -> bool {
        self.ended && !self.has_next
    }
}

/// An array with its next samples and those that go into the moment at hand.
pub(crate) struct PendingAudio {
    name: String,
    source: Box<dyn AudioSource>,
    next: AudioBlock,
    /// Samples of `next` that were taken.
    taken: usize,
    ready: AudioBlock,
    waiting: bool,
    ended: bool,
}

impl PendingAudio {
    pub(crate) fn new(name: String, source: Box<dyn AudioSource>) -> Self {
        Self {
            name,
            source,
            next: AudioBlock::default(),
            taken: 0,
            ready: AudioBlock::default(),
            waiting: false,
            ended: false,
        }
    }

    /// Reads the next samples of the range, where none are pending.
    pub(crate) fn fill(
        &mut self,
        from: Option<Instant>,
        until: Option<Instant>,
        faults: &mut Vec<Fault>,
    ) -> Wait {
        self.waiting = false;
        while self.taken >= self.next.len() {
            if self.ended {
                return Wait::Over;
            }
            let known = faults.len();
            let delivery = self.source.read(&mut self.next, faults);
            rename(&mut faults[known..], &self.name);
            match delivery {
                Delivery::Data => self.limit(from, until),
                Delivery::Pending => {
                    self.next.clear();
                    self.taken = 0;
                    self.waiting = true;
                    return Wait::Yes;
                }
                Delivery::End => {
                    self.next.clear();
                    self.taken = 0;
                    self.ended = true;
                }
            }
        }
        Wait::No
    }

    /// Leaves samples outside the range out.
    fn limit(&mut self, from: Option<Instant>, until: Option<Instant>) {
        let (time, rate) = (self.next.time, self.next.rate_hz);
        self.taken = from.map_or(0, |from| samples_before(from - time, rate, self.next.len()));
        if let Some(until) = until {
            let kept = samples_before(until - time, rate, self.next.len());
            if kept < self.next.len() {
                self.next
                    .channels
                    .iter_mut()
                    .for_each(|channel| channel.truncate(kept));
                self.ended = true;
            }
        }
    }

    /// Time of the first pending sample.
    pub(crate) fn time(&self) -> Option<Instant> {
        (self.taken < self.next.len())
            .then(|| self.next.time + Span::of_samples(self.taken as i64, self.next.rate_hz))
    }

    /// Takes the pending samples that are complete at `time`; `true` where all were taken and more may be.
    pub(crate) fn take_until(&mut self, time: Instant) -> bool {
        let Some(begin) = self.time() else { return false };
        let rate = self.next.rate_hz;
        if self.ready.is_empty() {
            self.ready.time = begin;
            self.ready.rate_hz = rate;
            self.ready
                .channels
                .resize_with(self.next.channels.len(), Vec::new);
        } else if (begin - self.ready.end()).magnitude() > LARGEST_SEAM || rate != self.ready.rate_hz {
            return false;
        }
        // A sample is complete when the next begins; a nanosecond forgives the rounding of sample times.
        let since = i128::from((time - self.next.time).nanoseconds()) + 1;
        let complete = (since * i128::from(rate)).div_euclid(1_000_000_000);
        let end = usize::try_from(complete).unwrap_or(0).min(self.next.len());
        if end > self.taken {
            for (ready, next) in self.ready.channels.iter_mut().zip(&self.next.channels) {
                ready.extend_from_slice(&next[self.taken..end]);
            }
            self.taken = end;
        }
        self.taken >= self.next.len()
    }

    /// Hands the ready samples over.
    pub(crate) fn give(&mut self, slot: &mut Observed<AudioBlock>) {
        slot.new = !self.ready.is_empty();
        if slot.new {
            std::mem::swap(&mut slot.data, &mut self.ready);
            self.ready.clear();
        }
    }

    pub(crate) fn is_waiting(&self) -> bool {
        self.waiting && !self.ended
    }

    pub(crate) fn is_ready(&self) -> bool {
        !self.ready.is_empty()
    }

    pub(crate) fn is_over(&self) -> bool {
        self.ended && self.taken >= self.next.len()
    }
}

/// Faults carry the sensor's name in the room, whatever the source calls itself.
fn rename(faults: &mut [Fault], name: &str) {
    for fault in faults {
        name.clone_into(&mut fault.sensor);
    }
}

/// How many of `length` samples lie before `span` after the first; sample times are rounded to nanoseconds.
fn samples_before(span: Span, rate_hz: u32, length: usize) -> usize {
    let nanoseconds = i128::from(span.nanoseconds()) - 1;
    if nanoseconds < 0 {
        return 0;
    }
    let count = (nanoseconds * i128::from(rate_hz)).div_euclid(1_000_000_000) + 1;
    usize::try_from(count).unwrap_or(usize::MAX).min(length)
}

/// The quotient rounded up.
pub(crate) fn ceiling(dividend: i64, divisor: i64) -> i64 {
    -(-dividend).div_euclid(divisor)
}
