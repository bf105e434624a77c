//! No text, however damaged, makes a calibration format panic; what is read of it can be used.

#![expect(
    clippy::unwrap_used,
    reason = "a test stops at what it does not expect, also in its helpers"
)]

use hearsight_core::calibration::{Calibration, FORMATS, parse_camera};
use hearsight_core::{DistortedPixel, WorldPoint};
use proptest::prelude::*;
use std::path::Path;

/// Whatever is read must be usable: finite, and a projection that returns.
fn check_usable(calibration: &Calibration) {
    let camera = calibration.resized(360, 288).unwrap();
    let camera = Calibration { size: None, ..camera }.camera(360, 288).unwrap();
    assert!(camera.centre().0.iter().all(|number| !number.is_nan()));
    if let Some(pixel) = camera.project(WorldPoint::new(0.3, 0.2, 0.5)) {
        assert!(pixel.u.is_finite() && pixel.v.is_finite());
    }
    let _ = camera.ray(DistortedPixel::new(10.0, 20.0));
    let _ = camera.horizontal_field_of_view_rad();
}

fn samples() -> Vec<String> {
    let texts = [
        include_str!("goldens/opencv_storage.yaml"),
        include_str!("goldens/opencv_storage.json"),
        include_str!("calibrations/native.toml"),
        include_str!("calibrations/corpus.json"),
        include_str!("calibrations/plain.json"),
        include_str!("calibrations/ros.yaml"),
    ];
    let mut texts: Vec<String> = texts.iter().map(|text| (*text).to_owned()).collect();
    let corpus =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/av16.3-seq30/seq30_calib.json");
    texts.extend(std::fs::read_to_string(corpus));
    texts
}

#[derive(Clone, Debug)]
enum Damage {
    Replace(usize, &'static str),
    Delete(usize, usize),
    Copy(usize, usize, usize),
    Byte(usize, char),
}

fn damage() -> impl Strategy<Value = Damage> {
    let tokens = prop::sample::select(vec![
        "1e308",
        "-1e308",
        "1e-320",
        "0",
        "-1",
        ".nan",
        "nan",
        "inf",
        "NaN",
        "[",
        "]",
        "{",
        "}",
        "[[",
        "- ",
        ": ",
        "\n",
        "\"",
        "'",
        "!!float ",
        "!!opencv-matrix",
        "&a ",
        "*a",
        "|\n",
        ">",
        "%",
        "---\n",
        "...",
        "#",
        "\t",
        "? ",
        "null",
        "true",
        "9999999999999999999",
        "\u{fffd}",
        "\u{0}",
        "é",
        "<<: ",
        ",",
    ]);
    prop_oneof![
        (any::<usize>(), tokens).prop_map(|(at, token)| Damage::Replace(at, token)),
        (any::<usize>(), 0..40_usize).prop_map(|(at, length)| Damage::Delete(at, length)),
        (any::<usize>(), 0..80_usize, any::<usize>())
            .prop_map(|(from, length, to)| Damage::Copy(from, length, to)),
        (any::<usize>(), any::<char>()).prop_map(|(at, character)| Damage::Byte(at, character)),
    ]
}

fn apply(text: &mut Vec<char>, damage: Damage) {
    let length = text.len();
    let place = |at: usize| at % (length + 1);
    match damage {
        Damage::Replace(at, token) => {
            let start = place(at);
            let end = (start + token.chars().count()).min(length);
            text.splice(start..end, token.chars());
        }
        Damage::Delete(at, count) => {
            let start = place(at);
            text.drain(start..(start + count).min(length));
        }
        Damage::Copy(from, count, to) => {
            let start = place(from);
            let piece = text[start..(start + count).min(length)].to_vec();
            let to = place(to);
            text.splice(to..to, piece);
        }
        Damage::Byte(at, character) => {
            let at = place(at);
            text.splice(at..(at + 1).min(length), [character]);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_are_read_or_refused_but_never_panic(
        sample in any::<prop::sample::Index>(),
        damages in prop::collection::vec(damage(), 1..6),
        index in 0..3_usize,
        extension in prop::sample::select(vec!["a.yaml", "a.json", "a.toml", "a"]),
        format in prop::option::of(prop::sample::select(FORMATS.to_vec())),
    ) {
        let samples = samples();
        let mut text: Vec<char> = sample.get(&samples).chars().collect();
        for one in damages {
            apply(&mut text, one);
        }
        let text: String = text.into_iter().collect();
        match parse_camera(&text, Path::new(extension), format, index) {
            Ok(calibration) => check_usable(&calibration),
            Err(error) => prop_assert_eq!(error.file(), Path::new(extension)),
        }
    }

    #[test]
    fn any_text_is_refused_or_read(text in "\\PC{0,200}", extension in prop::sample::select(vec!["a.yaml", "a.toml"])) {
        let _ = parse_camera(&text, Path::new(extension), None, 0);
    }
}

/// 2000 cases in an ordinary run; `PROPTEST_CASES` sets another number.
fn cases() -> u32 {
    std::env::var("PROPTEST_CASES")
        .ok()
        .and_then(|count| count.parse().ok())
        .unwrap_or(2000)
}
