//! Files of every format: what is read of them, what is said of bad ones, and that no bytes make anything panic.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at what it does not expect, also in its helpers"
)]

use hearsight_core::record::{BoxRecord, SCENE_SCHEMA_VERSION, Scene, TrackPhase, TrackRecord, ViewRecord};
use hearsight_core::truth::{PersonTruth, TRUTH_SCHEMA_VERSION, TruthRecord, ViewTruth};
use hearsight_eval::read::{FORMATS, parse, read};
use hearsight_eval::{Measure, Options, PairError, Recording, Report, Side, pair};
use proptest::prelude::*;
use std::path::Path;

const MOT: &str = "1,7,10,20,30,40,1,-1,-1,-1\n1,8,110,20,30,40,0.5,-1,-1,-1\n3,7,12,20,30,40,1,-1,-1,-1\n";
const MOT_TRUTH: &str =
    "1,1,10,20,30,40,1,1,0.9\n1,2,110,20,30,40,1,1,0.1\n2,1,11,20,30,40,1,1,1\n2,2,11,90,30,40,0,1,1\n";
const RTTM: &str = ";; a comment\nSPEAKER a 1 0.5 1.5 <NA> <NA> anna <NA> <NA>\nSPKR-INFO a 1 <NA> <NA> <NA> unknown anna <NA>\nSPEAKER a 1 2 1 <NA> <NA> bert <NA> <NA>\n";
const FRAMES: &str = "frame,t_sec,n_visible,p1_u,p1_v,p2_u,p2_v,doa_deg(space separated)\n1,11.08,0,100,90,120,90,\n2,11.12,2,100,90,400,90,3 4\n3,11.16,1,101,90,121,90,\n";
const PLACES: &str = "t_sec,track,x_m,y_m,z_m,phase,existence,speaking,speaking_probability\n0.0,1,1,2,1.5,visible,0.9,1,0.8\n0.0,2,,,,visible,0.9,0,\n0.04,1,1.1,2,1.5,visible,0.9,0,0.2\n";

fn head(left: f64) -> BoxRecord {
    BoxRecord {
        left,
        top: 20.0,
        width: 30.0,
        height: 40.0,
    }
}

/// Two cameras, the second at half the rate of the first; track 2 is hidden.
fn scenes() -> String {
    let view = |camera: &str, frame, left| ViewRecord {
        camera: camera.into(),
        frame,
        head: head(left),
        deviation_px: [1.0, 1.0],
    };
    let scene = |tick: u64| {
        let track = |id, phase| TrackRecord {
            id,
            phase,
            existence: 0.9,
            views: vec![view("a", tick + 1, 10.0), view("b", tick / 2 + 1, 200.0)],
            position_m: (id == 1).then_some([1.0, 2.0, 1.5]),
            deviation_m: None,
            speaking: id == 1 && tick < 4,
            speaking_probability: Some(0.75),
            effective_sample_size: 10.0,
        };
        Scene {
            schema: SCENE_SCHEMA_VERSION.into(),
            tick,
            time_s: tick as f64 * 0.1,
            tracks: vec![track(1, TrackPhase::Visible), track(2, TrackPhase::Occluded)],
            speaker: (tick < 4).then_some(1),
            nobody_probability: Some(0.1),
            ..Scene::default()
        }
    };
    lines((0..8).map(scene))
}

fn truth() -> String {
    let record = |tick: u64| {
        let person = |id: u64| PersonTruth {
            id,
            name: ["anna", "bert"][id as usize - 1].into(),
            present: id == 1 || tick > 2,
            head_m: Some([id as f64, 2.0, 1.6]),
            mouth_m: Some([id as f64, 2.0, 1.5]),
            head_yaw_rad: Some(0.0),
            speaking: id == 1 && tick < 5,
            views: vec![ViewTruth {
                camera: "a".into(),
                frame: tick + 1,
                head: Some(head(if id == 1 { 10.0 } else { 120.0 })),
                body: None,
                head_visible: if id == 1 { 1.0 } else { 0.2 },
                body_visible: 1.0,
            }],
        };
        TruthRecord {
            schema: TRUTH_SCHEMA_VERSION.into(),
            tick,
            time_s: tick as f64 * 0.1,
            people: vec![person(1), person(2)],
            sounds: vec![],
        }
    };
    lines((0..8).map(record))
}

fn lines<T: serde::Serialize>(records: impl Iterator<Item = T>) -> String {
    records
        .map(|record| serde_json::to_string(&record).unwrap() + "\n")
        .collect()
}

fn of(name: &str, text: &str, side: Side) -> Recording {
    parse(Path::new(name), text.as_bytes(), side, None).unwrap_or_else(|error| panic!("{error}"))
}

fn judge(truth: &Recording, tracks: &Recording, options: &Options) -> Report {
    let paired = pair("", truth, tracks, options).unwrap_or_else(|error| panic!("{error}"));
    Report::new(
        ["truth".into(), "tracks".into()],
        paired.cases,
        paired.notes,
        options.clone(),
    )
    .unwrap()
}

#[test]
fn our_own_lines_are_judged_in_the_picture_and_in_the_world() {
    let (truth, tracks) = (
        of("truth.jsonl", &truth(), Side::Truth),
        of("scenes.jsonl", &scenes(), Side::Tracks),
    );
    assert_eq!(truth.names, ["anna", "bert"]);
    let report = judge(&truth, &tracks, &Options::default());
    let value = |name: &str| report.value(name).unwrap_or_else(|| panic!("{name}"));
    assert_eq!(report.measure(), Measure::Overlap);
    assert_eq!(value("num_frames"), 8.0);
    assert_eq!(
        (value("num_objects"), value("num_misses"), value("motp")),
        (13.0, 5.0, 0.0)
    );
    assert_eq!(value("speaking_recall"), 0.8);
    assert!((value("total") - 0.5).abs() < 1e-9 && (value("missed detection") - 0.1).abs() < 1e-9);
    // Bert is hardly to be seen.
    let clear_sight = Options {
        least_visibility: 0.5,
        ..Options::default()
    };
    let report = judge(&truth, &tracks, &clear_sight);
    assert_eq!(report.value("mota"), Some(1.0));
    let world = Options {
        measure: Some(Measure::Metres),
        azimuth_from_m: Some([0.0, 0.0]),
        ..Options::default()
    };
    let report = judge(&truth, &tracks, &world);
    assert_eq!(
        (report.value("motp"), report.value("azimuth_mae")),
        (Some(0.0), Some(0.0))
    );
    assert_eq!(report.value("num_misses"), Some(5.0));
    // The other picture has no truth.
    let other = Options {
        camera: Some("b".into()),
        ..Options::default()
    };
    assert!(matches!(
        pair("", &truth, &tracks, &other),
        Err(PairError::NoSuchCamera { .. })
    ));
}

#[test]
fn a_slow_camera_is_taken_once_a_frame() {
    let tracks = of("scenes.jsonl", &scenes(), Side::Tracks);
    let frames = |camera: &str| {
        let stream = tracks
            .streams
            .iter()
            .find(|stream| stream.camera() == Some(camera))
            .unwrap();
        stream
            .frames()
            .map(|frame| (frame.number, frame.observations.len()))
            .collect::<Vec<_>>()
    };
    assert_eq!(frames("a"), (1..9).map(|number| (number, 1)).collect::<Vec<_>>());
    assert_eq!(frames("b"), (1..5).map(|number| (number, 1)).collect::<Vec<_>>());
}

#[test]
fn motchallenge_text_heeds_what_counts_and_what_is_seen() {
    let (truth, tracks) = (
        of("gt.txt", MOT_TRUTH, Side::Truth),
        of("front.mot.txt", MOT, Side::Tracks),
    );
    let report = judge(&truth, &tracks, &Options::default());
    assert_eq!(report.value("num_objects"), Some(3.0));
    assert_eq!(report.value("num_frames"), Some(3.0));
    assert_eq!(report.value("num_misses"), Some(1.0));
    let seen = Options {
        least_visibility: 0.5,
        ..Options::default()
    };
    let report = judge(&truth, &tracks, &seen);
    assert_eq!(
        (report.value("num_objects"), report.value("num_predictions")),
        (Some(2.0), Some(2.0))
    );
}

#[test]
fn rttm_is_judged_alone() {
    let truth = of("a.rttm", RTTM, Side::Truth);
    assert_eq!(truth.speakers, ["anna", "bert"]);
    let tracks = of(
        "b.rttm",
        "SPEAKER a 1 0.5 1.5 <NA> <NA> track1 <NA> <NA>\n",
        Side::Tracks,
    );
    let report = judge(&truth, &tracks, &Options::default());
    assert_eq!(report.value("diarization error rate"), Some(0.4));
    assert_eq!(report.value("jaccard error rate"), Some(0.5));
    assert_eq!(report.value("mota"), None);
}

#[test]
fn turns_ages_away_are_set_aside() {
    let far = of(
        "far.rttm",
        "SPEAKER a 1 2.3e16 1.5 <NA> <NA> anna <NA> <NA>\nSPEAKER a 1 0 1 <NA> <NA> bert <NA> <NA>\n",
        Side::Truth,
    );
    assert_eq!((far.set_aside, far.turns.as_ref().map(Vec::len)), (1, Some(1)));
}

#[test]
fn csv_is_read_by_its_columns() {
    let truth = of("x_cam1_frames.csv", FRAMES, Side::Truth);
    let counts: Vec<usize> = truth.streams[0]
        .frames()
        .map(|frame| frame.observations.len())
        .collect();
    assert_eq!((truth.streams[0].camera(), counts), (Some("cam1"), vec![0, 1, 2]));
    let tracks = of("tracks.csv", PLACES, Side::Tracks);
    assert_eq!(tracks.turns.as_ref().unwrap().len(), 1);
    assert!(matches!(
        pair("", &truth, &tracks, &Options::default()),
        Err(PairError::NothingInCommon { .. })
    ));
    let report = judge(&tracks, &tracks, &Options::default());
    assert_eq!(report.value("mota"), Some(1.0));
    assert_eq!(report.value("speaking_f1"), Some(1.0));
}

#[test]
fn a_directory_is_read_by_what_lies_in_it() {
    let directory = tempfile::TempDir::new().unwrap();
    let write = |name: &str, text: &str| std::fs::write(directory.path().join(name), text).unwrap();
    let error = read(directory.path(), Side::Truth, None).unwrap_err().to_string();
    assert!(
        error.contains("holds no file") && error.contains("truth.jsonl"),
        "{error}"
    );
    write("a.gt.txt", MOT_TRUTH);
    write("a.mot.txt", MOT);
    write("speech.rttm", RTTM);
    write("notes.txt", "not for us");
    let truth = read(directory.path(), Side::Truth, None).unwrap();
    assert_eq!((truth.streams.len(), truth.turns.as_ref().unwrap().len()), (1, 2));
    write("truth.jsonl", &self::truth());
    write("scenes.jsonl", &scenes());
    let both = |side| read(directory.path(), side, None).unwrap();
    let report = judge(&both(Side::Truth), &both(Side::Tracks), &Options::default());
    assert_eq!(report.value("num_objects"), Some(13.0));
    let missing = read(&directory.path().join("none"), Side::Truth, None).unwrap_err();
    assert!(missing.to_string().contains("none"), "{missing}");
}

#[test]
fn an_empty_file_is_an_empty_side() {
    for (name, text) in [("gt.txt", MOT_TRUTH), ("truth.jsonl", &truth())] {
        let full = of(name, text, Side::Truth);
        let empty = of(
            if name == "gt.txt" {
                "test.txt"
            } else {
                "scenes.jsonl"
            },
            "",
            Side::Tracks,
        );
        let report = judge(&full, &empty, &Options::default());
        assert!(
            report.notes[0].contains("the tracks are empty"),
            "{:?}",
            report.notes
        );
        let refused = pair("", &empty, &empty, &Options::default());
        assert!(matches!(refused, Err(PairError::Empty)), "{name}");
        assert_eq!(report.value("mota"), Some(0.0), "{name}");
        assert_eq!(report.value("HOTA"), Some(0.0), "{name}");
    }
}

#[test]
fn tracks_without_places_are_not_held_against_a_truth_in_the_world() {
    let truth = of("truth.jsonl", &truth(), Side::Truth);
    let text = "t_sec,track,x_m,y_m,z_m,speaking\n0.0,1,,,,1\n0.1,1,,,,0\n";
    let tracks = of("tracks.csv", text, Side::Tracks);
    let report = judge(&truth, &tracks, &Options::default());
    assert_eq!(report.value("mota"), None);
    assert!(report.value("diarization error rate").is_some());
    let metres = Options {
        measure: Some(Measure::Metres),
        ..Options::default()
    };
    let report = judge(&truth, &tracks, &metres);
    assert_eq!(report.value("mota"), Some(0.0));
    assert!(report.notes[0].contains("nobody of the tracks has a place that can be compared by metres"));
}

#[test]
fn errors_name_file_line_field_value_and_cure() {
    let future = truth().replace(r#""schema":"1.0""#, r#""schema":"2.0""#);
    let backwards: String = truth().lines().rev().map(|line| format!("{line}\n")).collect();
    for (name, text, expected) in [
        (
            "a.mot.txt",
            "1,2,3,4,5,6\n1,x,3,4,5,6\n",
            "line 2: `id` is x: it must be a number; correct the row (a.mot.txt)",
        ),
        (
            "a.mot.txt",
            "1,2,3,4,5,6\n1.5,2,3,4,5,6\n",
            "line 2: `frame` is 1.5: it must be a whole number",
        ),
        (
            "a.mot.txt",
            "1,2,3,4,5,6\n1,3,3\n",
            "line 2: `top` is empty: a row has at least six columns",
        ),
        (
            "a.mot.txt",
            "1,2,3,4,5,6\n1,2,3,4,5,6\n",
            "line 2: `id` is 2: it is there twice in frame 1; leave out one",
        ),
        (
            "a.rttm",
            "SPEAKER a 1 0 -1 <NA> <NA> anna\n",
            "line 1: `duration` is -1: it must not be negative",
        ),
        (
            "a.rttm",
            "SPEAKER a 1 0 1\n",
            "line 1: SPEAKER has 5 fields; it must have at least eight",
        ),
        ("a.rttm", "\nHELLO\n", "line 2: `type` is HELLO: no type of RTTM"),
        (
            "a.csv",
            "frame,t_sec,p1_u,p1_v\n1,0,1,?\n",
            "line 2: `p1_v` is ?: it must be a number",
        ),
        (
            "a.csv",
            "t_sec,track,x_m,y_m\n",
            "line 1: there is no column `z_m`; name the columns",
        ),
        (
            "a.csv",
            "t_sec,track,x_m,y_m,z_m,speaking\n0,1,1,1,1,maybe\n",
            "line 2: `speaking` is maybe: it must be 0 or 1",
        ),
        (
            "truth.jsonl",
            &future,
            "line 1: `schema` is 2.0: this program reads up to 1.0",
        ),
        (
            "truth.jsonl",
            &backwards,
            "line 2: `time_s` is 0.6000000000000001: times must ascend",
        ),
        (
            "scenes.jsonl",
            "{\"tracks\":[]}\n",
            "line 1: missing field `schema` at column 13; correct or leave out the line",
        ),
        (
            "a.bin",
            " \n",
            "it is empty, and its name does not tell what it is; name its format: truth, scenes, mot",
        ),
        (
            "a.bin",
            "\u{1}\u{2}",
            "neither its name nor its first line tells what it is; name its format: truth, scenes, mot",
        ),
    ] {
        let error = parse(Path::new(name), text.as_bytes(), Side::Truth, None).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
        assert_eq!(error.file(), Path::new(name));
    }
}

#[test]
fn numbers_that_are_not_finite_are_set_aside_and_counted() {
    let tracks = of(
        "a.txt",
        "1,1,nan,0,5,5\n1,2,0,0,5,5\n2,1,0,inf,5,5\n",
        Side::Tracks,
    );
    assert_eq!(tracks.set_aside, 2);
    let report = judge(
        &of("gt.txt", MOT_TRUTH, Side::Truth),
        &tracks,
        &Options::default(),
    );
    assert!(
        report.notes[0].contains("2 rows of the tracks were set aside"),
        "{:?}",
        report.notes
    );
    assert!(report.table().contains("mota"));
}

#[test]
fn options_outside_their_range_are_refused() {
    let recording = of("gt.txt", MOT_TRUTH, Side::Truth);
    let good = Options::default();
    for bad in [
        Options {
            gate: Some(0.0),
            ..good.clone()
        },
        Options {
            gate: Some(f64::NAN),
            ..good.clone()
        },
        Options {
            least_visibility: 1.5,
            ..good.clone()
        },
        Options {
            collar_s: -1.0,
            ..good.clone()
        },
        Options {
            azimuth_from_m: Some([f64::INFINITY, 0.0]),
            ..good.clone()
        },
    ] {
        let refused = pair("", &recording, &recording, &bad);
        assert!(matches!(refused, Err(PairError::OutOfRange { .. })), "{bad:?}");
    }
}

#[test]
fn the_report_is_for_people_and_programs() {
    let (truth, tracks) = (
        of("truth.jsonl", &truth(), Side::Truth),
        of("scenes.jsonl", &scenes(), Side::Tracks),
    );
    let paired = pair("<b>&", &truth, &tracks, &Options::default()).unwrap();
    let report = Report::new(
        ["<i>".into(), "t".into()],
        paired.cases,
        paired.notes,
        Options::default(),
    )
    .unwrap();
    let json = report.json();
    assert_eq!(json["overall"]["num_objects"], 13.0);
    assert_eq!(json["cases"][0]["values"]["num_objects"], 13.0);
    assert_eq!(json["options"]["distance"], "iou");
    assert!(json["metrics"].as_array().unwrap().len() > 40);
    let html = report.html();
    for part in [
        "Who speaks when",
        "Error over time",
        "In the picture",
        "Probability of speaking",
        "</html>",
    ] {
        assert!(html.contains(part), "{part}");
    }
    assert!(!html.contains("<i>") && !html.contains("<b>&") && html.contains("&lt;i&gt;"));
    assert!(!html.contains("http") && !html.contains("<script") && !html.contains("NaN"));
    assert_eq!(html.matches("<svg").count(), html.matches("</svg>").count());
}

#[derive(Clone, Debug)]
enum Damage {
    Replace(usize, &'static str),
    Delete(usize, usize),
    Copy(usize, usize, usize),
    Byte(usize, u8),
}

fn damage() -> impl Strategy<Value = Damage> {
    let tokens = prop::sample::select(vec![
        "1e308",
        "-1e308",
        "1e-320",
        "0",
        "-1",
        "nan",
        "inf",
        "1e999",
        "9007199254740993",
        "99999999999999999999",
        ",",
        ",,",
        "\n",
        "\r",
        "\"",
        "null",
        "true",
        "{",
        "}",
        "[",
        "]",
        " ",
        "\u{0}",
        "\u{feff}",
        "SPEAKER",
        "0.5",
        "1.5",
    ]);
    prop_oneof![
        (any::<usize>(), tokens).prop_map(|(at, token)| Damage::Replace(at, token)),
        (any::<usize>(), 0..60_usize).prop_map(|(at, length)| Damage::Delete(at, length)),
        (any::<usize>(), 0..200_usize, any::<usize>())
            .prop_map(|(from, length, to)| Damage::Copy(from, length, to)),
        (any::<usize>(), any::<u8>()).prop_map(|(at, byte)| Damage::Byte(at, byte)),
    ]
}

fn apply(bytes: &mut Vec<u8>, damage: Damage) {
    let length = bytes.len();
    let place = |at: usize| at % (length + 1);
    match damage {
        Damage::Replace(at, token) => {
            let start = place(at);
            let end = (start + token.len()).min(length);
            bytes.splice(start..end, token.bytes());
        }
        Damage::Delete(at, count) => {
            let start = place(at);
            bytes.drain(start..(start + count).min(length));
        }
        Damage::Copy(from, count, to) => {
            let start = place(from);
            let piece = bytes[start..(start + count).min(length)].to_vec();
            let to = place(to);
            bytes.splice(to..to, piece);
        }
        Damage::Byte(at, byte) => {
            let at = place(at);
            bytes.splice(at..(at + 1).min(length), [byte]);
        }
    }
}

/// 600 cases in an ordinary run; `PROPTEST_CASES` sets another number.
fn cases() -> u32 {
    let wanted = std::env::var("PROPTEST_CASES").ok();
    wanted.and_then(|count| count.parse().ok()).unwrap_or(600)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_are_judged_or_refused_but_never_panic(
        sample in 0..6_usize,
        damages in prop::collection::vec(damage(), 1..6),
        forced in prop::option::of(0..6_usize),
        least_visibility in 0.0..1.0_f64,
        metres in any::<bool>(),
    ) {
        let samples = [
            ("gt.txt", MOT_TRUTH.to_owned()),
            ("a.rttm", RTTM.to_owned()),
            ("x_cam1_frames.csv", FRAMES.to_owned()),
            ("tracks.csv", PLACES.to_owned()),
            ("scenes.jsonl", scenes()),
            ("truth.jsonl", truth()),
        ];
        let (name, text) = &samples[sample];
        let mut bytes = text.clone().into_bytes();
        for one in damages {
            apply(&mut bytes, one);
        }
        let format = forced.filter(|place| place % 3 == 0).map(|place| &FORMATS[place]);
        let damaged = match parse(Path::new(name), &bytes, Side::Truth, format) {
            Ok(damaged) => damaged,
            Err(error) => {
                prop_assert_eq!(error.file(), Path::new(name));
                return Ok(());
            }
        };
        let sound = of(name, text, Side::Tracks);
        let options = Options {
            measure: metres.then_some(Measure::Metres),
            least_visibility,
            collar_s: 0.1,
            skip_overlap: true,
            azimuth_from_m: Some([0.0, 0.0]),
            ..Options::default()
        };
        for (truth, tracks) in [(&damaged, &sound), (&sound, &damaged)] {
            if let Ok(paired) = pair("", truth, tracks, &options) {
                let report = Report::new(["a".into(), "b".into()], paired.cases, paired.notes, options.clone()).unwrap();
                let html = report.html();
                prop_assert!(!html.contains("NaN") && !html.contains("inf\""), "{html}");
                prop_assert!(report.table().lines().count() > 1);
                prop_assert!(report.json()["overall"].is_object());
            }
        }
    }
}
