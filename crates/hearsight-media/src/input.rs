//! How libav is asked to open a file, device or stream.

use crate::location;
use ffmpeg_next::Dictionary;
use hearsight_core::Span;
use std::time::Duration;

/// How a file, device or stream is opened.
#[derive(Clone, Debug)]
pub struct InputOptions {
    /// The longest wait for a stream or device, to open and for each read; default 5 s. Files have no limit.
    pub timeout: Span,
    /// libav's name of the format, for example `v4l2`, `alsa` or `mpegts`; default is to find out.
    pub format: Option<String>,
    /// Options for libav's demuxer and protocol, for example `("rtsp_transport", "tcp")`.
    pub parameters: Vec<(String, String)>,
    /// Threads of the decoder; default 1, 0 for as many as libav likes. Results do not depend on it.
    pub threads: usize,
    /// Index of the stream in the file, from 0; default is the best of its kind.
    pub stream: Option<usize>,
}

impl Default for InputOptions {
    fn default() -> Self {
        Self {
            timeout: Span::from_seconds(5.0),
            format: None,
            parameters: Vec::new(),
            threads: 1,
            stream: None,
        }
    }
}

impl InputOptions {
    pub(crate) fn timeout(&self) -> Duration {
        Duration::from_nanos(self.timeout.nanoseconds().max(1_000_000) as u64)
    }

    pub(crate) fn dictionary(&self, location: &str) -> Dictionary<'static> {
        let mut dictionary = Dictionary::new();
        if location::is_session_description(location) {
            dictionary.set("protocol_whitelist", "file,crypto,data,rtp,rtcp,udp,tcp");
        }
        if location::is_live(location) {
            // libav listens to a stream for five seconds by default before it gives the first frame.
            dictionary.set("analyzeduration", "1000000");
        }
        if location.starts_with("rtsp:") {
            // UDP loses packets silently where TCP waits; a user's own choice overrides this.
            dictionary.set("rtsp_flags", "prefer_tcp");
        }
        for (key, value) in &self.parameters {
            if !key.contains('\0') && !value.contains('\0') {
                dictionary.set(key, value);
            }
        }
        dictionary
    }
}
