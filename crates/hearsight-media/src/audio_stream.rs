//! Samples from a libav stream, kept in time: gaps are filled with zeros, samples that come twice are left out.

use crate::reader::{Decoded, StreamReader, span_of};
use crate::samples;
use crate::timeline::NEVER_BELIEVED;
use ffmpeg_next::frame;
use hearsight_core::{FaultKind, Span};
use std::time;

/// Zeros that one step appends.
const ZEROS_A_STEP: i64 = 4096;
/// A jump beyond this is set aside until a second block confirms it.
const LONGEST_BELIEVED_S: i64 = 10;

/// What one step brought.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// Samples were appended, or nothing but faults.
    More,
    End,
}

/// A fault and its time since the stream's zero.
pub(crate) type Trouble = (FaultKind, Span, String);

/// Decodes one audio stream.
pub(crate) struct AudioStream {
    reader: StreamReader,
    decoded: frame::Audio,
    pub(crate) rate_hz: u32,
    pub(crate) channels: usize,
    /// Samples that the container promises, where it does.
    pub(crate) promised: Option<u64>,
    /// The stream's time, in its own units, of sample 0.
    zero: Option<i64>,
    /// Number of the next sample.
    next: i64,
    /// Zeros still to be given before the held frame.
    zeros: i64,
    held: bool,
    /// Added to sample positions since the source's clock was set anew.
    correction: i64,
    suspect: Option<i64>,
    damaged: bool,
}

impl AudioStream {
    pub(crate) fn new(reader: StreamReader, declared: bool) -> Self {
        let (rate_hz, channels) = (reader.facts.rate_hz, reader.facts.channels);
        Self {
            promised: promise_of(&reader, rate_hz),
            zero: reader.start_time.filter(|_| declared),
            reader,
            decoded: frame::Audio::empty(),
            rate_hz,
            channels,
            next: 0,
            zeros: 0,
            held: false,
            correction: 0,
            suspect: None,
            damaged: false,
        }
    }

    /// How much later than the container's beginning this stream begins.
    pub(crate) fn lead(&self) -> Span {
        self.reader.lead
    }

    /// Whether it delivers at its own pace.
    pub(crate) fn live(&self) -> bool {
        self.reader.live
    }

    /// When the first data arrived.
    pub(crate) fn arrival(&self) -> time::Instant {
        self.reader.arrival
    }

    /// How long after the arrival of the first data sample 0 lies, once it has come.
    pub(crate) fn since_arrival(&self) -> Option<Span> {
        self.zero.map(|zero| self.reader.since_arrival(zero))
    }

    /// Appends the next samples of the channels `selection` to `planes`. `now`, for sources that are timed by the arrival
    /// of their data, is the present since the stream's zero.
    pub(crate) fn append(
        &mut self,
        now: Option<Span>,
        selection: &[usize],
        planes: &mut [Vec<f32>],
        troubles: &mut Vec<Trouble>,
    ) -> Step {
        if self.zeros > 0 {
            let count = self.zeros.min(ZEROS_A_STEP);
            for plane in planes {
                plane.resize(plane.len() + count as usize, 0.0);
            }
            self.zeros -= count;
            self.next += count;
            return Step::More;
        }
        if std::mem::take(&mut self.held) {
            self.give(0, selection, planes, troubles);
            return Step::More;
        }
        let present = now;
        let now = Span::of_samples(self.next, self.rate_hz);
        match self.reader.next(&mut self.decoded) {
            Decoded::Frame => self.place(present, selection, planes, troubles),
            Decoded::Damaged { reason, .. } => {
                self.damaged = true;
                troubles.push((FaultKind::Corrupt, now, reason));
            }
            Decoded::Lost { reason } => {
                troubles.push((FaultKind::Lost, now, format!("the source was lost: {reason}")));
            }
            Decoded::End => return Step::End,
        }
        Step::More
    }

    fn place(
        &mut self,
        present: Option<Span>,
        selection: &[usize],
        planes: &mut [Vec<f32>],
        troubles: &mut Vec<Trouble>,
    ) {
        let ahead = self.ahead();
        let rate = i64::from(self.rate_hz);
        // Containers round time stamps, some to milliseconds; that is no gap.
        let unit = span_of(2, self.reader.time_base).samples(self.rate_hz);
        let tolerance = (rate / 100).max(unit);
        let now = Span::of_samples(self.next, self.rate_hz);
        if ahead.abs() <= tolerance {
            self.suspect = None;
            return self.give(0, selection, planes, troubles);
        }
        let confirmed = self
            .suspect
            .take()
            .is_some_and(|suspect| (ahead - suspect).abs() <= rate);
        let arrived = present.map(|present| present.samples(self.rate_hz) - self.decoded.samples() as i64);
        let of_the_future = ahead > rate * LONGEST_BELIEVED_S
            && arrived.is_some_and(|arrived| self.next.saturating_add(ahead) > arrived + rate);
        let endless = ahead > NEVER_BELIEVED.samples(self.rate_hz) || of_the_future;
        let set_anew = endless || (ahead < -rate && self.reader.live);
        if (ahead > rate * LONGEST_BELIEVED_S || set_anew) && !confirmed {
            self.suspect = Some(ahead);
            troubles.push((
                FaultKind::Corrupt,
                now,
                "a time stamp far off was not believed".to_owned(),
            ));
            // Where the arrival tells the time it is left out: perhaps everything goes on much later.
            if arrived.is_none() || !set_anew {
                self.give(0, selection, planes, troubles);
            }
        } else if set_anew {
            let zeros = arrived.map_or(0, |arrived| arrived - self.next).max(0);
            self.correction += zeros - ahead;
            let detail = format!("the source's clock was set anew; zeros stand for {zeros} samples");
            troubles.push((FaultKind::Gap, now, detail));
            (self.zeros, self.held) = (zeros, true);
        } else if ahead > 0 {
            if !std::mem::take(&mut self.damaged) {
                troubles.push((
                    FaultKind::Gap,
                    now,
                    format!("{ahead} samples are missing; zeros stand for them"),
                ));
            }
            (self.zeros, self.held) = (ahead, true);
        } else {
            troubles.push((
                FaultKind::Duplicate,
                now,
                format!("{} samples came twice", -ahead),
            ));
            self.give((-ahead) as usize, selection, planes, troubles);
        }
    }

    /// How many samples after the expected place the decoded frame begins.
    fn ahead(&mut self) -> i64 {
        let Some(time) = self.decoded.timestamp().or(self.decoded.pts()) else {
            return 0;
        };
        let zero = *self.zero.get_or_insert(time);
        let position = span_of(time.saturating_sub(zero), self.reader.time_base).samples(self.rate_hz);
        position.saturating_add(self.correction).saturating_sub(self.next)
    }

    /// Appends the decoded frame but its first `skip` samples.
    fn give(
        &mut self,
        skip: usize,
        selection: &[usize],
        planes: &mut [Vec<f32>],
        troubles: &mut Vec<Trouble>,
    ) {
        let before = planes.first().map_or(0, Vec::len);
        if self.decoded.rate() != self.rate_hz || !samples::append(&self.decoded, selection, planes) {
            let now = Span::of_samples(self.next, self.rate_hz);
            troubles.push((
                FaultKind::Corrupt,
                now,
                "the sound changed its rate or channels".to_owned(),
            ));
            return;
        }
        self.damaged = false;
        for plane in planes.iter_mut() {
            let end = (before + skip).min(plane.len());
            plane.drain(before..end);
        }
        self.next += (planes.first().map_or(0, Vec::len) - before) as i64;
    }
}

fn promise_of(reader: &StreamReader, rate_hz: u32) -> Option<u64> {
    let stream = reader.stream().filter(|_| !reader.live)?;
    let samples = span_of(stream.duration(), reader.time_base).samples(rate_hz);
    if stream.duration() > 0 {
        return u64::try_from(samples).ok();
    }
    // AVI counts uncompressed sound in samples and says so nowhere else.
    let counts_samples = reader.time_base == ffmpeg_next::Rational::new(1, rate_hz as i32);
    u64::try_from(stream.frames())
        .ok()
        .filter(|frames| counts_samples && *frames > u64::from(rate_hz) / 10)
}
