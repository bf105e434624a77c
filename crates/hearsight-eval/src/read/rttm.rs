//! RTTM, NIST's rich transcription time marks: `SPEAKER file channel start duration <NA> <NA> name <NA> <NA>`.
//!
//! Other types of lines, and comments after `;;`, are passed over. All files and channels that a file speaks of are taken
//! as one.

use super::{FormatInfo, ReadError, Source, is_time};
use crate::recording::{Names, Recording};
use crate::speech::Turn;

pub(super) const FORMAT: FormatInfo = FormatInfo {
    name: "rttm",
    meaning: "RTTM, who speaks when.",
    recognize: |name, line| {
        let kind = line.split_ascii_whitespace().next();
        name.ends_with(".rttm") || kind.is_some_and(|kind| KINDS.contains(&kind))
    },
    read,
};

/// The types of lines that there are.
const KINDS: &[&str] = &[
    "SPEAKER",
    "SPKR-INFO",
    "SEGMENT",
    "NOSCORE",
    "NO_RT_METADATA",
    "LEXEME",
    "NON-LEX",
    "NON-SPEECH",
    "FILLER",
    "EDIT",
    "IP",
    "CB",
    "A/P",
    "SU",
];

fn read(source: &Source<'_>) -> Result<Recording, ReadError> {
    let mut names = Names::default();
    let (mut turns, mut set_aside) = (Vec::new(), 0);
    for (index, bytes) in source.bytes.split(|&byte| byte == b'\n').enumerate() {
        let line = index as u64 + 1;
        let text = std::str::from_utf8(bytes).map_err(|_| ReadError::Syntax {
            file: source.path.to_owned(),
            line,
            detail: "the line is not UTF-8".to_owned(),
            cure: "write it in UTF-8".to_owned(),
        })?;
        if text.trim_start().starts_with(";;") {
            continue;
        }
        let fields: Vec<&str> = text.split_ascii_whitespace().collect();
        let Some(kind) = fields.first() else { continue };
        if !KINDS.contains(kind) {
            return Err(ReadError::invalid(
                source.path,
                line,
                "type",
                kind,
                "no type of RTTM; correct the line",
            ));
        }
        if *kind != "SPEAKER" {
            continue;
        }
        let [_, _, _, start, duration, _, _, name, ..] = fields.as_slice() else {
            return Err(ReadError::Syntax {
                file: source.path.to_owned(),
                line,
                detail: format!("SPEAKER has {} fields", fields.len()),
                cure: "it must have at least eight: type, file, channel, start, duration, two of <NA>, name"
                    .to_owned(),
            });
        };
        let number = |field: &'static str, text: &str| {
            let cure = "it must be a number of seconds; correct the line";
            text.parse::<f64>()
                .map_err(|_| ReadError::invalid(source.path, line, field, text, cure))
        };
        let (start_s, duration_s) = (number("start", start)?, number("duration", duration)?);
        let end_s = start_s + duration_s;
        if !(is_time(start_s) && is_time(end_s)) {
            set_aside += 1;
            continue;
        }
        if duration_s < 0.0 {
            let cure = "it must not be negative; correct the line";
            return Err(ReadError::invalid(source.path, line, "duration", duration, cure));
        }
        let speaker = names.index((*name).to_owned(), || (*name).to_owned());
        turns.push(Turn {
            start_s,
            end_s,
            speaker,
        });
    }
    Ok(Recording {
        turns: Some(turns),
        speakers: names.names,
        set_aside,
        ..Recording::default()
    })
}
