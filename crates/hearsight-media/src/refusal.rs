//! Why libav did not open something, in words for people.

use crate::error::MediaError;
use crate::input::InputOptions;
use ffmpeg_next::format::context::Input;
use ffmpeg_next::{Error, media};

/// There is no stream of the kind.
pub(crate) fn no_stream(location: &str, input: &Input, kind: media::Type) -> MediaError {
    let (location, found) = (location.to_owned(), contents(input));
    if kind == media::Type::Video {
        MediaError::NoVideo { location, found }
    } else {
        MediaError::NoAudio { location, found }
    }
}

/// The streams of an input.
pub(crate) fn contents(input: &Input) -> String {
    let kinds: Vec<String> = input
        .streams()
        .map(|stream| {
            let parameters = stream.parameters();
            let kind = match parameters.medium() {
                media::Type::Video => "video",
                media::Type::Audio => "audio",
                media::Type::Subtitle => "subtitles",
                _ => "data",
            };
            format!(
                "{kind} in {} as stream {}",
                parameters.id().name(),
                stream.index()
            )
        })
        .collect();
    if kinds.is_empty() {
        "nothing".to_owned()
    } else {
        kinds.join(", ")
    }
}

/// libav's error; `waits` for what is no file.
pub(crate) fn refusal(location: &str, waits: bool, options: &InputOptions, error: Error) -> MediaError {
    let (location, reason) = (location.to_owned(), error.to_string());
    match error {
        Error::Exit => MediaError::Unreachable {
            location,
            timeout_s: options.timeout.seconds(),
            reason: "the time ran out".to_owned(),
        },
        Error::DemuxerNotFound => MediaError::BadOption {
            location,
            option: "format",
            value: options.format.clone().unwrap_or_default(),
            cure: "name a format that `ffmpeg -formats` lists, or leave it out",
        },
        Error::Other { .. } if waits => MediaError::Unreachable {
            location,
            timeout_s: options.timeout.seconds(),
            reason,
        },
        Error::Other { .. } => MediaError::Unreadable { location, reason },
        _ => MediaError::NotMedia { location, reason },
    }
}
