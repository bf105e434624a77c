//! Files, streams and devices to moments on one clock, and pictures and sound back to files: the senses of Hearsight.
//!
//! This crate turns outside bytes into timed pictures and samples and nothing more: it tracks nobody, and whatever is
//! wrong with the bytes becomes a typed error when opening and a [`Fault`](hearsight_core::Fault) afterwards, never a
//! panic and never a wait without end.
//!
//! * [`VideoFile`] and [`AudioFile`] read anything that libav reads (files, V4L2, RTSP, RTP, MPEG-TS); WAV is read by
//!   an own path that also knows what the header promised. [`ImageSequence`] reads numbered pictures; [`StitchedVideo`]
//!   makes one panorama of several cameras around one point.
//! * [`LiveVideo`] and [`LiveAudio`] put a source behind a bounded queue that drops the oldest, or pace a recording
//!   as if it were live.
//! * [`ReconnectingVideo`] and [`ReconnectingAudio`] open a live source again where it was lost.
//! * [`MomentReader`] aligns any number of sources on one clock and builds [`Moment`](hearsight_core::Moment)s.
//! * [`Canvas`] draws on pictures, [`VideoWriter`] writes them as MP4 or without any loss, [`SoundWriter`] sound as WAV.

mod audio_file;
mod audio_stream;
mod channels;
mod clock;
pub mod draw;
mod encode;
mod error;
mod images;
mod input;
mod libav;
mod live;
mod location;
mod matrix;
mod moments;
mod pending;
mod picture;
mod queue;
mod reader;
mod reconnect;
mod refusal;
mod resample;
mod samples;
mod sound_writer;
mod stitch;
mod timeline;
mod video_file;
mod video_writer;
mod wav;

pub use audio_file::{AudioFile, AudioOptions};
pub use channels::ChannelSelection;
pub use clock::{RunClock, SourceClock, Start};
pub use draw::{Canvas, Color, identity_color};
pub use encode::{Encoder, available_encoders};
pub use error::{EncodeError, MediaError, MomentError};
pub use images::{ImageOptions, ImageSequence};
pub use input::InputOptions;
pub use live::{LiveAudio, LiveVideo, Pace, QueueOptions};
pub use moments::{Camera, Microphones, MomentOptions, MomentReader};
pub use reconnect::{ReconnectingAudio, ReconnectingVideo};
pub use sound_writer::{SampleForm, SoundWriter};
pub use stitch::{StitchError, StitchOptions, StitchedCamera, StitchedVideo};
pub use video_file::{VideoCounts, VideoFile, VideoOptions};
pub use video_writer::{VideoWriter, VideoWriterOptions};
