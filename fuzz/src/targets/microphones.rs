//! Files of microphone positions, and arrays as records hold them.

use super::{Target, Verdict, texts};
use hearsight_core::microphones::MicrophoneArray;
use hearsight_engine::config::{Overrides, parse, resolve};

const ROOM: &str =
    "[[array]]\nname = 'table'\nfile = 'a.wav'\nmicrophones_file = { file = 'microphones.json' }\n";

pub(super) const TARGET: Target = Target {
    name: "microphones",
    meaning: "A JSON file of microphone positions; those that were read are finite and apart.",
    text: true,
    words: &[
        "arrays_m",
        "table",
        "positions_m",
        "speed_of_sound_m_s",
        "name",
        "[",
        "]",
        "[0, 0, 0]",
        "{",
        "}",
        "null",
        ",",
    ],
    longest: 4 << 10,
    seeds: || {
        texts(&[
            include_str!("../../seeds/microphones/named.json"),
            include_str!("../../seeds/microphones/single.json"),
            include_str!("../../seeds/microphones/record.json"),
        ])
    },
    open: || {
        let directory = tempfile::tempdir();
        Box::new(move |bytes| {
            if let Ok(array) = serde_json::from_slice::<MicrophoneArray>(bytes) {
                let written = serde_json::to_string(&array).unwrap_or_default();
                let again = serde_json::from_str::<MicrophoneArray>(&written);
                return match again {
                    Ok(again) if again == array => {
                        Verdict::Read(format!("record of {}", array.positions().len()))
                    }
                    other => Verdict::Broken(format!("{written} is read as {other:?}")),
                };
            }
            let Ok(directory) = &directory else {
                return Verdict::Refused("no directory".to_owned());
            };
            if std::fs::write(directory.path().join("microphones.json"), bytes).is_err() {
                return Verdict::Refused("not written".to_owned());
            }
            let resolved = parse("room.toml", ROOM, &Overrides::new())
                .and_then(|raw| resolve(&raw, "room.toml", ROOM, directory.path(), "room"));
            match resolved {
                Ok(room) => match room.arrays.first() {
                    Some(array) if MicrophoneArray::new(array.microphones.clone()).is_ok() => {
                        Verdict::Read(format!("file of {}", array.microphones.len()))
                    }
                    array => Verdict::Broken(format!("no array can be made of {array:?}")),
                },
                Err(error) => Verdict::Refused(error.to_string()),
            }
        })
    },
};
