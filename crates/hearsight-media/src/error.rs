//! What can be wrong when a source or a sink is opened: each variant names the place, the trouble and the cure.

use hearsight_core::{Fault, FaultKind, Instant};

/// A fault of the sensor `name` at `time`: what is wrong after opening, which ends nothing.
pub(crate) fn fault(name: &str, time: Instant, kind: FaultKind, detail: String) -> Fault {
    Fault {
        sensor: name.to_owned(),
        time_s: time.seconds(),
        kind,
        detail,
    }
}

/// Why a source could not be opened.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MediaError {
    /// There is nothing at the path.
    #[error("{location}: no such file; check the spelling, relative paths start at the working directory")]
    Missing {
        /// Path or address.
        location: String,
    },
    /// The path is a directory.
    #[error(
        "{location}: is a directory, not a media file; name a file in it, or open it as an image sequence"
    )]
    Directory {
        /// Path or address.
        location: String,
    },
    /// The file has no bytes.
    #[error("{location}: the file is empty; copy or record it again")]
    Empty {
        /// Path or address.
        location: String,
    },
    /// The system refused to read.
    #[error(
        "{location}: cannot be read ({reason}); check its permissions and whether another program holds it"
    )]
    Unreadable {
        /// Path or address.
        location: String,
        /// What the system said.
        reason: String,
    },
    /// The bytes are of no media format.
    #[error(
        "{location}: not a media file that can be read ({reason}); check that it is complete and play it elsewhere"
    )]
    NotMedia {
        /// Path or address.
        location: String,
        /// What the demuxer said.
        reason: String,
    },
    /// A stream or device did not answer in time.
    #[error(
        "{location}: no data within {timeout_s} s ({reason}); check that the sender runs and the address is right, or allow more time"
    )]
    Unreachable {
        /// Path or address.
        location: String,
        /// The time allowed, seconds.
        timeout_s: f64,
        /// What the system said.
        reason: String,
    },
    /// No video inside.
    #[error(
        "{location}: has no video stream (it holds {found}); use it as a microphone array or name another file"
    )]
    NoVideo {
        /// Path or address.
        location: String,
        /// The streams that are there.
        found: String,
    },
    /// No audio inside.
    #[error("{location}: has no audio stream (it holds {found}); use it as a camera or name another file")]
    NoAudio {
        /// Path or address.
        location: String,
        /// The streams that are there.
        found: String,
    },
    /// The stream with the wished index is missing or of another kind.
    #[error(
        "{location}: stream {wanted} is not {kind} (the file holds {found}); choose another index or leave it out"
    )]
    WrongStream {
        /// Path or address.
        location: String,
        /// The index that was asked for.
        wanted: usize,
        /// `video` or `audio`.
        kind: &'static str,
        /// The streams that are there.
        found: String,
    },
    /// The decoder is missing or refuses the stream.
    #[error("{location}: {codec} cannot be decoded ({reason}); convert the file, for example with ffmpeg")]
    Undecodable {
        /// Path or address.
        location: String,
        /// The codec.
        codec: String,
        /// What the decoder said.
        reason: String,
    },
    /// Another number of channels than declared.
    #[error(
        "{location}: has {found} channels where {expected} were declared; correct the number of microphones or select channels"
    )]
    WrongChannels {
        /// Path or address.
        location: String,
        /// Declared.
        expected: usize,
        /// Present.
        found: usize,
    },
    /// A selected channel does not exist.
    #[error(
        "{location}: channel {channel} was selected but there are only channels 0 to {last}; correct the selection"
    )]
    NoSuchChannel {
        /// Path or address.
        location: String,
        /// The channel that was asked for, from 0.
        channel: usize,
        /// The last channel that is there.
        last: usize,
    },
    /// Pictures of a sequence that do not fit the pattern or each other.
    #[error(
        "{location}: no pictures found ({reason}); name a directory of PNG or JPEG files or a pattern such as frame_%06d.png"
    )]
    NoPictures {
        /// Path or pattern.
        location: String,
        /// What was looked for.
        reason: String,
    },
    /// An option that makes no sense.
    #[error("{location}: {option} is {value}; {cure}")]
    BadOption {
        /// Path or address.
        location: String,
        /// The option's name.
        option: &'static str,
        /// Its value.
        value: String,
        /// What to do.
        cure: &'static str,
    },
}

/// Why a [`MomentReader`](crate::MomentReader) could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MomentError {
    /// Nothing to read.
    #[error("no source was given; name at least one camera or microphone array")]
    NoSources,
    /// Ticks must go forward.
    #[error("the tick is {tick_s} s; it must be positive, or left out for the fastest camera's interval")]
    BadTick {
        /// The tick, seconds.
        tick_s: f64,
    },
    /// The interval of time is empty.
    #[error(
        "the run is limited to {from_s} s until {until_s} s, which is empty; the end must be after the beginning"
    )]
    EmptyRange {
        /// Beginning, seconds.
        from_s: f64,
        /// End, seconds.
        until_s: f64,
    },
}

/// Why a video could not be written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EncodeError {
    /// The encoder is not in the installed libav.
    #[error("the encoder {name} is not in the installed libav; available here: {available}")]
    NoEncoder {
        /// The encoder asked for.
        name: String,
        /// Those that could be used.
        available: String,
    },
    /// The encoder refuses these settings.
    #[error(
        "{path}: {encoder} refuses {width}x{height} pixels ({reason}); H.264 needs even sizes, VP9 takes any"
    )]
    Refused {
        /// The file.
        path: String,
        /// The encoder.
        encoder: String,
        /// Pixels a row.
        width: usize,
        /// Rows.
        height: usize,
        /// What the encoder said.
        reason: String,
    },
    /// The file cannot be created or written.
    #[error("{path}: cannot be written ({reason}); check that the folder exists, is writable and has space")]
    Unwritable {
        /// The file.
        path: String,
        /// What the system said.
        reason: String,
    },
    /// A picture of another size than the video.
    #[error(
        "{path}: a picture of {found} bytes does not fill {width}x{height} pixels in RGB; give every picture the size of the video"
    )]
    WrongSize {
        /// The file.
        path: String,
        /// Bytes given.
        found: usize,
        /// Pixels a row of the video.
        width: usize,
        /// Rows of the video.
        height: usize,
    },
    /// A picture not later than the one before.
    #[error(
        "{path}: a picture at {time_s} s is not later than the one before at {last_s} s; give pictures in order of time"
    )]
    NotLater {
        /// The file.
        path: String,
        /// The picture's time, seconds.
        time_s: f64,
        /// The time before, seconds.
        last_s: f64,
    },
    /// The video was already finished.
    #[error("{path}: was already finished; open a new one")]
    Finished {
        /// The file.
        path: String,
    },
}
