//! Files, streams and devices to moments on one clock, and overlay video back to files: the senses of Hearsight.
//!
//! This crate turns outside bytes into timed pictures and samples and nothing more: it tracks nobody, and whatever is
//! wrong with the bytes becomes a typed error when opening and a [`Fault`](hearsight_core::Fault) afterwards, never a
//! panic and never a wait without end.
//!
//! * [`VideoFile`] and [`AudioFile`] read anything that libav reads (files, V4L2, RTSP, RTP, MPEG-TS); WAV is read by
//!   an own path that also knows what the header promised. [`ImageSequence`] reads numbered pictures.
//! * [`LiveVideo`] and [`LiveAudio`] put a source behind a bounded queue that drops the oldest, or pace a recording
//!   as if it were live.
//! * [`MomentReader`] aligns any number of sources on one clock and builds [`Moment`](hearsight_core::Moment)s.
//! * [`Canvas`] draws on pictures, [`OverlayWriter`] writes them as MP4.

mod audio_file;
mod audio_stream;
pub mod channels;
pub mod clock;
pub mod error;
mod libav;
mod location;
mod moments;
mod pending;
mod picture;
mod reader;
mod resample;
mod samples;
mod timeline;
mod video_file;
mod wav;

pub use audio_file::{AudioFile, AudioOptions};
pub use channels::ChannelSelection;
pub use clock::{RunClock, SourceClock, Start};
pub use error::{EncodeError, MediaError, MomentError};
pub use moments::{Camera, Microphones, MomentOptions, MomentReader};
pub use reader::InputOptions;
pub use video_file::{VideoCounts, VideoFile, VideoOptions};
