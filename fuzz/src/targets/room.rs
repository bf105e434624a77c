//! `room.toml`, both stages, with overrides as of the command line.

use super::{Target, Verdict, texts};
use hearsight_engine::config::{ConfigurationError, Overrides, parse, resolve};
use miette::GraphicalReportHandler;
use std::path::Path;

/// A line that begins so holds an override, as behind `--set`.
const SET: &str = "#--set ";

pub(super) const TARGET: Target = Target {
    name: "room",
    meaning: "A room.toml and overrides, parsed and resolved; errors can be shown with their place in the text.",
    text: true,
    words: &[
        "[[camera]]",
        "[[array]]",
        "[system]",
        "[system.stac]",
        "[output]",
        "[run]",
        "name",
        "file",
        "device",
        "stream",
        "images",
        "rate",
        "start",
        "drift",
        "paced",
        "format",
        "options",
        "calibration",
        "index",
        "channels",
        "microphones",
        "microphones_file",
        "camera",
        "directory",
        "seed",
        "threads",
        "from",
        "until",
        "tick",
        "speed_of_sound",
        "#--set run.seed=7",
        "#--set camera.0.start=1",
        "#--set camera.door.file=a",
        "= {}",
        "[[]]",
        "\"\"\"",
        "'''",
        "true",
        "1979-05-27",
        "\u{e9}",
        "\u{1f600}",
        "door",
        ".",
    ],
    longest: 8 << 10,
    seeds: || {
        texts(&[
            include_str!("../../seeds/room/files.toml"),
            include_str!("../../seeds/room/live.toml"),
            include_str!("../../seeds/room/inline.toml"),
            include_str!("../../seeds/room/overrides.toml"),
        ])
    },
    open: || {
        let directory = tempfile::tempdir();
        if let Ok(directory) = &directory {
            let files = [
                (
                    "door.toml",
                    include_str!("../../seeds/calibration/hearsight.toml"),
                ),
                ("hall.yaml", include_str!("../../seeds/calibration/opencv.yaml")),
                (
                    "microphones.json",
                    include_str!("../../seeds/microphones/named.json"),
                ),
            ];
            for (name, text) in files {
                let written = std::fs::write(directory.path().join(name), text);
                debug_assert!(written.is_ok(), "{written:?}");
            }
        }
        Box::new(move |bytes| {
            let Ok(text) = std::str::from_utf8(bytes) else {
                return Verdict::Refused("not UTF-8".to_owned());
            };
            let overrides: Overrides = text
                .lines()
                .filter_map(|line| line.strip_prefix(SET)?.split_once('='))
                .map(|(key, value)| (key.to_owned(), value.to_owned()))
                .collect();
            let folder = directory
                .as_ref()
                .map_or(Path::new("."), |directory| directory.path());
            let resolved = parse("room.toml", text, &overrides)
                .and_then(|raw| resolve(&raw, "room.toml", text, folder, "room"));
            match resolved {
                Ok(room) => {
                    let sensors = room.cameras.len() + 10 * room.arrays.len();
                    let formats = room.output.formats.len();
                    if room.run.threads == 0 || sensors == 0 {
                        return Verdict::Broken(format!("it makes no sense: {room:?}"));
                    }
                    Verdict::Read(format!(
                        "{sensors} sensors, {formats} formats {}",
                        overrides.len()
                    ))
                }
                Err(error) => show(&error),
            }
        })
    },
};

/// Shows an error as the program does, and checks that its place is in the text that it shows.
pub(super) fn show(error: &ConfigurationError) -> Verdict {
    let length = error.text.inner().len();
    if let Some(span) = error.span
        && span.offset() + span.len() > length
    {
        return Verdict::Broken(format!("{error} points to {span:?} of {length} bytes"));
    }
    let mut shown = String::new();
    match GraphicalReportHandler::new().render_report(&mut shown, error) {
        Ok(()) => Verdict::Refused(format!("{error}; {:?}", error.line_and_column().is_some())),
        Err(_) => Verdict::Broken(format!("the error cannot be shown: {error}")),
    }
}
