//! A camera from a file, device or network stream.

use crate::clock::{SourceClock, Start};
use crate::error::{MediaError, fault};
use crate::input::InputOptions;
use crate::location;
use crate::picture::PictureConverter;
use crate::reader::{Decoded, StreamReader, span_of};
use crate::timeline::{Place, Timeline};
use ffmpeg_next::{Rational, frame, media};
use hearsight_core::source::{Delivery, VideoFormat, VideoSource};
use hearsight_core::{Fault, FaultKind, Instant, Span, VideoFrame};
use std::path::Path;

/// How a camera's file, device or stream is read.
#[derive(Clone, Debug, Default)]
pub struct VideoOptions {
    /// The sensor's name, which faults carry; default is the location.
    pub name: String,
    /// When it began on the common clock: the beginning of the whole file, sound included. Default 0 s, no drift.
    pub clock: SourceClock,
    /// Interval between frames; default is what the container says.
    pub interval: Option<Span>,
    /// How it is opened.
    pub input: InputOptions,
}

/// What a camera delivered so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VideoCounts {
    /// Frames delivered.
    pub frames: u64,
    /// Packets or frames left out since they could not be decoded whole.
    pub corrupt: u64,
    /// Frames that never came, by the time stamps around them.
    pub missing: u64,
    /// Frames left out since their time was not after the frame before.
    pub duplicates: u64,
}

/// Reads one video stream of anything that libav opens.
pub struct VideoFile {
    reader: StreamReader,
    name: String,
    format: VideoFormat,
    clock: SourceClock,
    decoded: frame::Video,
    converter: PictureConverter,
    timeline: Timeline,
    /// The stream's time, in its own units, that counts as zero.
    zero: Option<i64>,
    promised_end: Option<Span>,
    counts: VideoCounts,
    /// Damage since the last frame, which explains that many missing frames.
    damaged: u64,
    ended: bool,
}

impl VideoFile {
    /// Opens a file.
    ///
    /// # Errors
    /// As [`VideoFile::open_location`].
    pub fn open(path: impl AsRef<Path>, options: VideoOptions) -> Result<Self, MediaError> {
        Self::open_location(&location::text(path.as_ref())?, options)
    }

    /// Opens a path, an address such as `rtsp://camera/1`, or a device such as `/dev/video0`.
    ///
    /// # Errors
    /// Says what is wrong with the place and what to do: missing, a directory, empty, no media, no video stream, no
    /// decoder, or not answering in time.
    pub fn open_location(location: &str, options: VideoOptions) -> Result<Self, MediaError> {
        let reader = StreamReader::open(location, media::Type::Video, &options.input)?;
        let (width, height) = size_of(&reader)?;
        let interval = match options.interval {
            Some(interval) if interval > Span::ZERO => interval,
            Some(interval) => {
                return Err(MediaError::BadOption {
                    location: location.to_owned(),
                    option: "interval",
                    value: format!("{} s", interval.seconds()),
                    cure: "give the positive time between two frames, or leave it out",
                });
            }
            None => interval_of(&reader),
        };
        let (frames, promised_end) = promise_of(&reader, interval);
        let declared = options.clock.is_declared();
        let lead = if declared {
            options.clock.common_from_own(reader.lead)
        } else {
            Span::ZERO
        };
        let format = VideoFormat {
            width,
            height,
            interval,
            frames,
            start: options.clock.start_on_arrival(reader.arrival) + lead,
            live: reader.live,
        };
        let name = if options.name.is_empty() {
            location.to_owned()
        } else {
            options.name
        };
        Ok(Self {
            zero: reader.start_time.filter(|_| declared),
            timeline: Timeline::new(interval, reader.live),
            converter: PictureConverter::new(width, height),
            decoded: frame::Video::empty(),
            name,
            format,
            clock: options.clock,
            promised_end,
            counts: VideoCounts::default(),
            damaged: 0,
            ended: false,
            reader,
        })
    }

    /// What has been delivered and left out so far.
    pub fn counts(&self) -> VideoCounts {
        self.counts
    }

    /// The time on the common clock of a time since the stream's zero.
    fn common(&self, own: Span) -> Instant {
        self.format.start + self.clock.common_from_own(own)
    }

    /// The present since the stream's zero, where the arrival of data is what tells their time.
    fn now(&self) -> Option<Span> {
        match self.clock.start {
            Start::OnArrival(clock) if self.reader.live => Some(clock.now() - self.format.start),
            _ => None,
        }
    }

    fn fault(&self, kind: FaultKind, own: Span, detail: String) -> Fault {
        fault(&self.name, self.common(own), kind, detail)
    }

    /// The decoded frame's time since the stream's zero; the first frame sets the zero where the container does not.
    fn time_of_decoded(&mut self) -> Span {
        let base = self.reader.time_base;
        let Some(time) = self.decoded.timestamp().or(self.decoded.pts()) else {
            return self.timeline.expected() - self.timeline.correction();
        };
        if self.zero.is_none() {
            self.zero = Some(time);
            if !self.clock.is_declared() {
                self.format.start =
                    self.clock.start_on_arrival(self.reader.arrival) + self.reader.since_arrival(time);
            }
        }
        span_of(time.saturating_sub(self.zero.unwrap_or(time)), base)
    }

    /// Places the decoded frame; `true` where it is to be delivered.
    fn place(&mut self, frame: &mut VideoFrame, faults: &mut Vec<Fault>) -> bool {
        let own = self.time_of_decoded();
        if self.decoded.is_corrupt() || self.decoded.has_decode_errors() {
            self.note_damage(
                own + self.timeline.correction(),
                "the picture is incomplete",
                faults,
            );
            return false;
        }
        let (number, time) = match self.timeline.place(own, self.now()) {
            Place::Next {
                number,
                missing,
                time,
            } => {
                self.note_missing(missing, time, faults);
                (number, time)
            }
            Place::Reset {
                number,
                missing,
                time,
            } => {
                self.counts.missing += missing;
                let detail =
                    format!("the source's clock was set anew; {missing} frames are missing before this time");
                faults.push(self.fault(FaultKind::Gap, time, detail));
                (number, time)
            }
            Place::Repeated => {
                self.counts.duplicates += 1;
                let detail = "a frame not later than the one before was left out";
                faults.push(self.fault(FaultKind::Duplicate, own, detail.to_owned()));
                return false;
            }
            Place::Incredible => {
                let detail = format!("a frame claims to be of {:.3} s and was left out", own.seconds());
                self.note_damage(self.timeline.expected(), &detail, faults);
                return false;
            }
        };
        self.damaged = 0;
        frame.time = self.common(time);
        frame.number = number;
        true
    }

    fn note_missing(&mut self, missing: u64, time: Span, faults: &mut Vec<Fault>) {
        self.counts.missing += missing;
        // Frames that were reported as corrupt are not reported again.
        if missing > self.damaged {
            let count = missing - self.damaged;
            let detail = format!("{count} frames are missing before this time");
            faults.push(self.fault(FaultKind::Gap, time, detail));
        }
    }

    fn note_damage(&mut self, own: Span, reason: &str, faults: &mut Vec<Fault>) {
        self.counts.corrupt += 1;
        self.damaged += 1;
        faults.push(self.fault(FaultKind::Corrupt, own, reason.to_owned()));
    }

    fn finish(&mut self, faults: &mut Vec<Fault>) -> Delivery {
        if !std::mem::replace(&mut self.ended, true) {
            let (last, end) = (self.timeline.last_number(), self.timeline.expected());
            if let Some(promised) = self.format.frames.filter(|promised| last < *promised) {
                let detail = format!("ended after frame {last} of the {promised} that the file promises");
                faults.push(self.fault(FaultKind::EndedEarly, end, detail));
            } else if let Some(promised) = self.promised_end
                && end + self.format.interval + self.format.interval / 2 < promised
            {
                let (end_s, promised_s) = (end.seconds(), promised.seconds());
                let detail =
                    format!("ended after {end_s:.2} s of the {promised_s:.2} s that the file promises");
                faults.push(self.fault(FaultKind::EndedEarly, end, detail));
            }
        }
        Delivery::End
    }
}

impl VideoSource for VideoFile {
    fn format(&self) -> &VideoFormat {
        &self.format
    }

    fn read(&mut self, frame: &mut VideoFrame, faults: &mut Vec<Fault>) -> Delivery {
        loop {
            match self.reader.next(&mut self.decoded) {
                Decoded::Frame => {
                    if !self.place(frame, faults) {
                        continue;
                    }
                    match self.converter.convert(&self.decoded, frame) {
                        Ok(()) => {
                            self.counts.frames += 1;
                            return Delivery::Data;
                        }
                        Err(error) => {
                            let time = self.timeline.expected() - self.format.interval;
                            self.note_damage(time, &error.to_string(), faults);
                        }
                    }
                }
                Decoded::Damaged { time, reason } => {
                    let own = match (time, self.zero) {
                        (Some(time), Some(zero)) => {
                            span_of(time.saturating_sub(zero), self.reader.time_base)
                                + self.timeline.correction()
                        }
                        _ => self.timeline.expected(),
                    };
                    self.note_damage(own, &reason, faults);
                }
                Decoded::Lost { reason } => {
                    let time = self.timeline.expected();
                    faults.push(self.fault(FaultKind::Lost, time, format!("the source was lost: {reason}")));
                }
                Decoded::End => return self.finish(faults),
            }
        }
    }
}

fn size_of(reader: &StreamReader) -> Result<(usize, usize), MediaError> {
    let (width, height) = (reader.facts.width, reader.facts.height);
    if width == 0 || height == 0 {
        return Err(MediaError::NotMedia {
            location: reader.location.clone(),
            reason: "its pictures have no size; no whole picture came".to_owned(),
        });
    }
    Ok((width, height))
}

/// The interval between frames: the base rate where the average confirms it, since the average of a file with gaps
/// is off; otherwise the average; 40 ms where neither is known.
fn interval_of(reader: &StreamReader) -> Span {
    let Some(stream) = reader.stream() else {
        return Span::from_nanoseconds(40_000_000);
    };
    let valid = |rate: Rational| {
        let hertz = f64::from(rate.numerator()) / f64::from(rate.denominator().max(1));
        (rate.denominator() > 0 && (0.001..=10_000.0).contains(&hertz)).then_some((rate, hertz))
    };
    let chosen = match (valid(stream.rate()), valid(stream.avg_frame_rate())) {
        (Some(base), Some(average)) if (base.1 / average.1 - 1.0).abs() > 0.1 => average.0,
        (Some(base), _) => base.0,
        (None, Some(average)) => average.0,
        (None, None) => {
            tracing::warn!(
                location = reader.location,
                "the frame rate is unknown; 25 frames a second are assumed"
            );
            Rational::new(25, 1)
        }
    };
    span_of(1, Rational::new(chosen.denominator(), chosen.numerator()))
}

/// Frames and duration that the container promises, where it does.
fn promise_of(reader: &StreamReader, interval: Span) -> (Option<u64>, Option<Span>) {
    let Some(stream) = reader.stream().filter(|_| !reader.live) else {
        return (None, None);
    };
    let frames = u64::try_from(stream.frames()).ok().filter(|frames| *frames > 0);
    let duration = Some(span_of(stream.duration(), reader.time_base)).filter(|span| *span > interval);
    (frames, duration)
}
