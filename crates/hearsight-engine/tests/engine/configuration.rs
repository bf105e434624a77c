//! What configurations mean and what is said of wrong ones, word for word.

use hearsight_engine::config::{Overrides, ResolvedRoom, parse, resolve};
use miette::{GraphicalReportHandler, GraphicalTheme};
use std::path::Path;

const GOOD: &str = r#"
name = "meeting"
speed_of_sound = 345

[[camera]]
name = "left"
file = "left.avi"
start = 11.08
calibration = { model = "pinhole", width = 640, height = 480, focal_px = [500.0, 500.0], centre_px = [319.5, 239.5] }

[[camera]]
stream = "rtsp://camera/2"
options = { rtsp_transport = "tcp" }

[[array]]
name = "table"
file = "table.wav"
start = 11.0
camera = "left"
channels = [1, 0]
rate = 16000
microphones = [[0, 0, 1], [0.2, 0, 1]]

[system.stac]
particles = 400

[output]
directory = "results"
overlay = true
mot = false

[run]
seed = 7
threads = 2
from = 12.5
"#;

fn resolved(text: &str) -> Result<ResolvedRoom, hearsight_engine::config::ConfigurationError> {
    let raw = parse("room.toml", text, &Overrides::new())?;
    resolve(&raw, "room.toml", text, Path::new("dir"), "room")
}

fn message(text: &str) -> String {
    let error = resolved(text).unwrap_err();
    let mut out = String::new();
    GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor())
        .with_width(100)
        .render_report(&mut out, &error)
        .unwrap();
    out
}

#[test]
fn a_room_is_resolved_with_every_default() {
    let mut room = resolved(GOOD).unwrap();
    assert_eq!(room.system.given, serde_json::json!({"particles": 400}));
    assert_eq!(room.system.parameters["particles"], 400);
    // The defaults are the system's own.
    room.system.parameters = room.system.given.clone();
    insta::assert_snapshot!(serde_json::to_string_pretty(&room).unwrap());
}

#[test]
fn a_minimal_room_needs_one_line() {
    let room = resolved("[[camera]]\nfile = \"a.avi\"\n").unwrap();
    assert_eq!(room.cameras[0].name, "cam1");
    assert_eq!(room.system.name, "stac");
    assert_eq!(room.name, "room");
    assert!(room.run.threads >= 1 && room.run.from.is_none());
}

#[test]
fn one_camera_is_the_partner_of_every_array() {
    let text = "[[camera]]\nfile = \"a.avi\"\n[[array]]\nfile = \"a.wav\"\n";
    assert_eq!(resolved(text).unwrap().arrays[0].camera, Some(0));
    let two = format!("{text}[[camera]]\nfile = \"b.avi\"\n");
    assert_eq!(resolved(&two).unwrap().arrays[0].camera, None);
}

#[test]
fn what_is_wrong_is_said_with_place_and_cure() {
    let camera = "[[camera]]\nfile = \"a.avi\"\n";
    let array = "[[array]]\nfile = \"a.wav\"\n";
    let wrong = [
        ("nothing", String::new()),
        ("no toml", "[[camera]\n".to_owned()),
        ("unknown key", format!("{camera}strat = 3\n")),
        ("unknown table", format!("{camera}[outputs]\n")),
        ("wrong type", format!("{camera}start = \"soon\"\n")),
        ("no source", "[[camera]]\nname = \"a\"\n".to_owned()),
        ("two sources", format!("{camera}device = \"/dev/video0\"\n")),
        (
            "same name",
            format!("{camera}name = \"x\"\n{array}name = \"x\"\n"),
        ),
        ("bad name", format!("{camera}name = \"a/b\"\n")),
        ("not a time", format!("{camera}start = inf\n")),
        (
            "paced device",
            "[[camera]]\ndevice = \"/dev/video0\"\npaced = true\n".to_owned(),
        ),
        (
            "zero size",
            format!("{camera}{array}microphones = [[1, 1, 1], [1, 1, 1]]\n"),
        ),
        (
            "two coordinates",
            format!("{camera}{array}microphones = [[1, 1], [1, 2]]\n"),
        ),
        (
            "unknown camera",
            format!("{camera}name = \"front\"\n{array}camera = \"frnt\"\n"),
        ),
        ("no calibration", format!("{camera}calibration = \"none.yaml\"\n")),
        (
            "calibration key",
            format!("{camera}calibration = {{ file = \"a.json\", indx = 1 }}\n"),
        ),
        ("unknown system", format!("{camera}[system]\nname = \"stack\"\n")),
        (
            "unknown parameter",
            format!("{camera}[system.stac]\nparticels = 3\n"),
        ),
        (
            "parameter type",
            format!("{camera}[system.stac]\nparticles = \"many\"\n"),
        ),
        ("unknown output", format!("{camera}[output]\noverlays = true\n")),
        ("output type", format!("{camera}[output]\noverlay = \"yes\"\n")),
        ("empty run", format!("{camera}[run]\nfrom = 3\nuntil = 2\n")),
        ("tick", format!("{camera}[run]\ntick = 0\n")),
        ("speed", format!("speed_of_sound = 0\n{camera}")),
    ];
    let mut text = String::new();
    for (what, room) in wrong {
        text.push_str(&format!("=== {what}\n{}\n", message(&room).trim_end()));
    }
    insta::assert_snapshot!(text);
}

#[test]
fn wrong_parameters_are_found_by_the_schema_of_the_system() {
    let room = |line: &str| message(&format!("[[camera]]\nfile = \"a.avi\"\n[system.stac]\n{line}\n"));
    let unknown = room("particels = 3");
    assert!(
        unknown.contains("room.toml:4:13") && unknown.contains("did you mean `particles`?"),
        "{unknown}"
    );
    let text = room("particles = \"many\"");
    assert!(
        text.contains("system.stac.particles: is \"many\", not a whole number"),
        "{text}"
    );
}

#[test]
fn the_examples_of_the_project_are_good() {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut count = 0;
    for entry in std::fs::read_dir(&directory).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        count += 1;
        let text = std::fs::read_to_string(&path).unwrap();
        let raw = parse("example", &text, &Overrides::new()).unwrap();
        let result = resolve(&raw, "example", &text, &directory, "room");
        if let Err(error) = result {
            // Calibrations of recordings that are not part of the project may be missing.
            assert!(
                error.message.contains("cannot read") || error.message.contains("cannot be read"),
                "{error}"
            );
            eprintln!("skipped: {error}");
        }
    }
    assert!(count >= 3);
}
