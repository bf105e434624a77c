//! One stream of a file, device or network stream: packets in, decoded libav frames out, with what went wrong.
//!
//! Shared by video and audio. It knows deadlines, damaged packets and the end, but neither times nor pictures.

use crate::error::MediaError;
use crate::input::InputOptions;
use crate::libav::{self, Deadline};
use crate::location;
use crate::refusal::{contents, no_stream, refusal};
use ffmpeg_next::codec::{self, threading};
use ffmpeg_next::format::context::Input;
use ffmpeg_next::{Error, Packet, Rational, decoder, frame, media};
use hearsight_core::Span;
use std::path::Path;
use std::thread;
use std::time::{self, Duration};

/// `EAGAIN`, which libav returns for "not yet"; the same number on every Linux and macOS architecture but a few.
const TRY_AGAIN: Error = Error::Other {
    errno: ffmpeg_next::error::EAGAIN,
};
/// Errors in a row after which a source counts as lost: a demuxer that never recovers must not loop for ever.
const MOST_ERRORS_IN_A_ROW: u32 = 200;

/// What one step of decoding brought.
#[derive(Debug)]
pub(crate) enum Decoded {
    /// The frame was filled.
    Frame,
    /// Something could not be decoded; `time` is its presentation time in the stream's units where known.
    Damaged { time: Option<i64>, reason: String },
    /// The source was lost: the deadline passed or it failed for good. Frames still inside the decoder may follow.
    Lost { reason: String },
    /// Nothing follows.
    End,
}

/// What the decoder knows of the stream before it decodes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Facts {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) rate_hz: u32,
    pub(crate) channels: usize,
}

/// Decodes one stream of an input.
pub(crate) struct StreamReader {
    // The decoder goes before the input, in the order in which libav wants them closed.
    decoder: decoder::Opened,
    input: Input,
    pub(crate) location: String,
    pub(crate) time_base: Rational,
    /// When the stream begins, in its own units, where the container says so.
    pub(crate) start_time: Option<i64>,
    /// How much later than the earliest audio or video stream of the container this one begins.
    pub(crate) lead: Span,
    pub(crate) live: bool,
    /// When the first data arrived.
    pub(crate) arrival: time::Instant,
    pub(crate) facts: Facts,
    stream: usize,
    deadline: Option<(Deadline, Duration)>,
    errors_in_a_row: u32,
    draining: bool,
    ended: bool,
}

impl StreamReader {
    /// Opens `location` and its stream of the given kind.
    pub(crate) fn open(
        location: &str,
        kind: media::Type,
        options: &InputOptions,
    ) -> Result<Self, MediaError> {
        libav::initialize();
        location::check_as(location, options.format.as_deref())?;
        let live = location::is_live(location) || (options.format.is_some() && !Path::new(location).exists());
        let waits = live || !location::is_path(location);
        let deadline = Deadline::new();
        if waits {
            deadline.set(options.timeout());
        }
        let format = options.format.as_deref().unwrap_or_default();
        let (input, arrival) = libav::open_input(location, format, options.dictionary(location), &deadline)
            .map_err(|error| {
            // Some protocols answer a time that ran out with an error of their own.
            let error = if deadline.passed() { Error::Exit } else { error };
            refusal(location, waits, options, error)
        })?;
        let stream = choose_stream(location, &input, kind, options.stream)?;
        let (time_base, start_time, parameters) = {
            let stream = input
                .stream(stream)
                .ok_or_else(|| no_stream(location, &input, kind))?;
            (
                stream.time_base(),
                known_time(stream.start_time()),
                stream.parameters(),
            )
        };
        let lead = lead_of(&input, start_time, time_base);
        let (decoder, facts) = open_decoder(location, parameters, time_base, options.threads)?;
        Ok(Self {
            decoder,
            input,
            location: location.to_owned(),
            time_base,
            start_time,
            lead,
            live,
            arrival,
            facts,
            stream,
            deadline: waits.then(|| (deadline, options.timeout())),
            errors_in_a_row: 0,
            draining: false,
            ended: false,
        })
    }

    /// The stream's facts as libav tells them.
    pub(crate) fn stream(&self) -> Option<ffmpeg_next::Stream<'_>> {
        self.input.stream(self.stream)
    }

    /// How long after the first data a time of the stream lies, for streams without a declared start.
    pub(crate) fn since_arrival(&self, time: i64) -> Span {
        let since = self.start_time.map_or(Span::ZERO, |start| {
            span_of(time.saturating_sub(start), self.time_base)
        });
        // A stream that contradicts its own start says nothing.
        if (Span::ZERO..Span::from_seconds(10.0)).contains(&since) {
            since
        } else {
            Span::ZERO
        }
    }

    /// Decodes on until there is a frame, a fault or the end.
    pub(crate) fn next(&mut self, frame: &mut frame::Frame) -> Decoded {
        if self.ended {
            return Decoded::End;
        }
        if let Some((deadline, timeout)) = &self.deadline {
            deadline.set(*timeout);
        }
        loop {
            match self.decoder.receive_frame(frame) {
                Ok(()) => {
                    self.errors_in_a_row = 0;
                    return Decoded::Frame;
                }
                Err(error) if error == TRY_AGAIN && !self.draining => {}
                Err(Error::Eof) => return self.end(),
                Err(error) if error == TRY_AGAIN => return self.end(),
                Err(error) => return self.damage(None, &error),
            }
            if let Some(fault) = self.feed() {
                return fault;
            }
        }
    }

    /// Gives the decoder one packet of the stream, or the end.
    fn feed(&mut self) -> Option<Decoded> {
        let mut packet = Packet::empty();
        match packet.read(&mut self.input) {
            Ok(()) => {}
            Err(Error::Eof) => return self.drain(),
            Err(error) if error == TRY_AGAIN && !self.deadline_passed() => {
                thread::sleep(Duration::from_millis(1));
                return None;
            }
            Err(Error::Exit) => return self.lose("no data in time".to_owned()),
            Err(error) if error == TRY_AGAIN => return self.lose("no data in time".to_owned()),
            Err(error) if self.errors_in_a_row >= MOST_ERRORS_IN_A_ROW => {
                return self.lose(error.to_string());
            }
            // What is not damaged data (a closed connection, a failing disk) does not pass by itself.
            Err(error @ Error::Other { .. }) => return self.lose(error.to_string()),
            Err(error) => return Some(self.damage(None, &error)),
        }
        if packet.stream() != self.stream {
            return None;
        }
        let time = packet.pts().or(packet.dts());
        if packet.is_corrupt() {
            return Some(Decoded::Damaged {
                time,
                reason: "the packet is incomplete".to_owned(),
            });
        }
        match self.decoder.send_packet(&packet) {
            Ok(()) => None,
            Err(error) if self.errors_in_a_row >= MOST_ERRORS_IN_A_ROW * 10 => self.lose(error.to_string()),
            Err(error) => Some(self.damage(time, &error)),
        }
    }

    fn deadline_passed(&self) -> bool {
        self.deadline
            .as_ref()
            .is_some_and(|(deadline, _)| deadline.passed())
    }

    fn damage(&mut self, time: Option<i64>, error: &Error) -> Decoded {
        self.errors_in_a_row += 1;
        if self.errors_in_a_row > MOST_ERRORS_IN_A_ROW && self.draining {
            return self.end();
        }
        Decoded::Damaged {
            time,
            reason: error.to_string(),
        }
    }

    /// No more packets: the decoder gives out what it still holds.
    fn drain(&mut self) -> Option<Decoded> {
        self.draining = true;
        self.decoder.send_eof().is_err().then(|| self.end())
    }

    fn lose(&mut self, reason: String) -> Option<Decoded> {
        if self.drain().is_some() {
            self.ended = true;
        }
        Some(Decoded::Lost { reason })
    }

    fn end(&mut self) -> Decoded {
        self.ended = true;
        Decoded::End
    }
}

impl Drop for StreamReader {
    fn drop(&mut self) {
        // Saying goodbye to a server that is gone must not take the whole timeout.
        if let Some((deadline, _)) = &self.deadline {
            deadline.set(Duration::from_millis(300));
        }
    }
}

/// Span of `time` in units of `base`, rounded to the nearest nanosecond.
pub(crate) fn span_of(time: i64, base: Rational) -> Span {
    let denominator = i128::from(base.denominator().max(1));
    let scaled = i128::from(time) * i128::from(base.numerator()) * 1_000_000_000;
    let rounded = (scaled + denominator / 2).div_euclid(denominator);
    Span::from_nanoseconds(rounded.clamp(i128::from(i64::MIN / 4), i128::from(i64::MAX / 4)) as i64)
}

/// `time` where libav knows one.
pub(crate) fn known_time(time: i64) -> Option<i64> {
    (time != ffmpeg_next::ffi::AV_NOPTS_VALUE).then_some(time)
}

fn lead_of(input: &Input, start: Option<i64>, base: Rational) -> Span {
    let Some(start) = start else { return Span::ZERO };
    let own = span_of(start, base);
    input
        .streams()
        .filter(|stream| {
            matches!(
                stream.parameters().medium(),
                media::Type::Video | media::Type::Audio
            )
        })
        .filter_map(|stream| Some(span_of(known_time(stream.start_time())?, stream.time_base())))
        .min()
        .map_or(Span::ZERO, |first| own - first.min(own))
}

fn open_decoder(
    location: &str,
    parameters: codec::Parameters,
    time_base: Rational,
    threads: usize,
) -> Result<(decoder::Opened, Facts), MediaError> {
    let id = parameters.id();
    let undecodable = |error: Error| MediaError::Undecodable {
        location: location.to_owned(),
        codec: id.name().to_owned(),
        reason: error.to_string(),
    };
    let mut context = codec::Context::from_parameters(parameters).map_err(undecodable)?;
    context.set_threading(threading::Config {
        count: threads,
        ..threading::Config::kind(threading::Type::Frame)
    });
    let mut decoder = context.decoder();
    decoder.set_packet_time_base(time_base);
    let opened = decoder.open_as(id).map_err(undecodable)?;
    let mut facts = Facts::default();
    // The bindings show sizes and rates only on decoders of a kind; taking them apart again loses nothing.
    let opened = if opened.medium() == media::Type::Video {
        let video = opened.video().map_err(undecodable)?;
        (facts.width, facts.height) = (video.width() as usize, video.height() as usize);
        video.0
    } else {
        let audio = opened.audio().map_err(undecodable)?;
        (facts.rate_hz, facts.channels) = (audio.rate(), usize::from(audio.channels()));
        audio.0
    };
    Ok((opened, facts))
}

fn choose_stream(
    location: &str,
    input: &Input,
    kind: media::Type,
    wanted: Option<usize>,
) -> Result<usize, MediaError> {
    match wanted {
        Some(index) => match input.stream(index) {
            Some(stream) if stream.parameters().medium() == kind => Ok(index),
            _ => Err(MediaError::WrongStream {
                location: location.to_owned(),
                wanted: index,
                kind: if kind == media::Type::Video {
                    "video"
                } else {
                    "audio"
                },
                found: contents(input),
            }),
        },
        None => input
            .streams()
            .best(kind)
            // A cover picture in a sound file is no camera.
            .filter(|stream| {
                !stream
                    .disposition()
                    .contains(ffmpeg_next::format::stream::Disposition::ATTACHED_PIC)
            })
            .map(|stream| stream.index())
            .ok_or_else(|| no_stream(location, input, kind)),
    }
}
