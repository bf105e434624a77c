//! Damaged configurations: an error or a room, never a panic.

use hearsight_engine::config::{Overrides, parse, resolve};
use proptest::prelude::*;
use std::path::Path;

const SEEDS: [&str; 4] = [
    include_str!("../../../../examples/av16.3.toml"),
    include_str!("../../../../examples/minimal.toml"),
    include_str!("../../../../examples/stereo.toml"),
    include_str!("../../../../examples/live.toml"),
];

/// Pieces that are likely to matter.
const PIECES: [&str; 22] = [
    "[[camera]]",
    "[[array]]",
    "[system]",
    "[system.stac]",
    "[output]",
    "[run]",
    "name = ",
    "file = ",
    "start = ",
    "microphones = ",
    "channels = [",
    "calibration = {",
    "nan",
    "inf",
    "-1e308",
    "99999999999999999999",
    "\"",
    "]",
    "}",
    "\n",
    "\u{1f600}",
    "\0",
];

#[derive(Clone, Debug)]
enum Damage {
    Remove { at: usize, length: usize },
    Insert { at: usize, piece: usize },
    Repeat { at: usize, length: usize },
    Change { at: usize, to: char },
}

fn damage() -> impl Strategy<Value = Damage> {
    let at = 0..2000_usize;
    prop_oneof![
        (at.clone(), 1..40_usize).prop_map(|(at, length)| Damage::Remove { at, length }),
        (at.clone(), 0..PIECES.len()).prop_map(|(at, piece)| Damage::Insert { at, piece }),
        (at.clone(), 1..80_usize).prop_map(|(at, length)| Damage::Repeat { at, length }),
        (at, any::<char>()).prop_map(|(at, to)| Damage::Change { at, to }),
    ]
}

fn apply(text: &str, damage: &Damage) -> String {
    let mut characters: Vec<char> = text.chars().collect();
    let end = characters.len();
    match *damage {
        Damage::Remove { at, length } => {
            let at = at.min(end);
            characters.drain(at..(at + length).min(end));
        }
        Damage::Insert { at, piece } => {
            let at = at.min(end);
            characters.splice(at..at, PIECES[piece].chars());
        }
        Damage::Repeat { at, length } => {
            let at = at.min(end);
            let part: Vec<char> = characters[at..(at + length).min(end)].to_vec();
            characters.splice(at..at, part);
        }
        Damage::Change { at, to } => {
            if let Some(character) = characters.get_mut(at) {
                *character = to;
            }
        }
    }
    characters.into_iter().collect()
}

/// A configuration that is tried must say what is wrong in words, at a place inside the text.
fn try_room(text: &str, overrides: &Overrides) {
    let result = parse("room.toml", text, overrides)
        .and_then(|raw| resolve(&raw, "room.toml", text, Path::new("/nonexistent"), "room"));
    if let Err(error) = result {
        assert!(!error.message.is_empty());
        let _ = error.line_and_column();
        let _ = format!("{:?}", miette::Report::new(error));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(), ..ProptestConfig::default() })]

    #[test]
    fn damaged_rooms_never_panic(seed in 0..SEEDS.len(), damages in prop::collection::vec(damage(), 1..8)) {
        let text = damages.iter().fold(SEEDS[seed].to_owned(), |text, damage| apply(&text, damage));
        try_room(&text, &Overrides::new());
    }

    #[test]
    fn overrides_never_panic(key in "[a-z_.0-9\\[\\]]{0,30}", value in "\\PC{0,20}") {
        try_room(SEEDS[0], &vec![(key, value)]);
    }
}

/// `HEARSIGHT_FUZZ_CASES` makes a longer search of it.
fn cases() -> u32 {
    std::env::var("HEARSIGHT_FUZZ_CASES")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(256)
}
