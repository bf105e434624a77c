//! `hearsight simulate`: what files hold is to the last bit what the engine gets without them, the truth lies beside
//! them, and an interruption leaves valid files.

use crate::common::{contents, errors, hearsight, printed, run};
use hearsight::core::source::{AudioSource, Delivery, VideoSource};
use hearsight::engine::Engine;
use hearsight::engine::config::{parse, resolve};
use hearsight::media::{Camera, Microphones, MomentOptions, MomentReader};
use hearsight::sim::scenario::from_text;
use hearsight::sim::simulation::{Files, Simulation};
use hearsight::{Moment, Scene};
use std::path::Path;
use std::process::Command;
use std::time::Duration;
use tempfile::TempDir;

/// Everything that could differ between a file and the source itself: odd sizes, several rates, clocks that are told and
/// such that are not, samples that are lost.
const SCENE: &str = r#"
name = "both"
seconds = 2.5
[room]
size = [4, 4, 2.5]
t60 = 0.2
[[person]]
name = "anna"
at = [1.5, 2.5]
turns = [[0.3, 2.2]]
[[person.action]]
time = 0.2
walk = [[2.6, 2.6]]
[[camera]]
name = "front"
size = [162, 121]
rate = 15
at = [2, 0.3, 1.4]
look_at = [2, 3, 1.4]
[[camera]]
name = "side"
size = [96, 80]
rate = 10
at = [3.8, 3.6, 1.9]
look_at = [2, 2, 1.3]
clock = { offset = 0.07, drift = 50, declared = true }
[[array]]
name = "pair"
shape = "pair"
at = [2, 0.3, 1.4]
facing = 90
camera = "front"
lost = [[1.0, 1.1]]
[[array]]
name = "circle"
rate = 12000
at = [2, 2, 0.8]
count = 3
clock = { offset = 0.02, drift = -80 }
"#;

fn simulation() -> Simulation {
    Simulation::new(from_text("scene.toml", SCENE, &vec![]).unwrap()).unwrap()
}

/// Simulates to files; gives the directory.
fn recorded(more: &[&str]) -> TempDir {
    let directory = TempDir::new().unwrap();
    let scene = directory.path().join("scene.toml");
    std::fs::write(&scene, SCENE).unwrap();
    let out = directory.path().join("out");
    let mut arguments = vec![
        "simulate",
        scene.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ];
    arguments.extend(more);
    let output = run(&arguments);
    assert!(output.status.success(), "{}", errors(&output));
    directory
}

fn moments(cameras: Vec<Box<dyn VideoSource>>, arrays: Vec<Box<dyn AudioSource>>) -> Vec<Moment> {
    let cameras = cameras.into_iter().zip(["front", "side"]);
    let arrays = arrays.into_iter().zip(["pair", "circle"]);
    let mut reader = MomentReader::new(
        cameras
            .map(|(source, name)| Camera {
                name: name.to_owned(),
                source,
            })
            .collect(),
        arrays
            .map(|(source, name)| Microphones {
                name: name.to_owned(),
                source,
            })
            .collect(),
        MomentOptions::default(),
    )
    .unwrap();
    let mut all = Vec::new();
    let mut moment = Moment::default();
    while reader.read(&mut moment) == Delivery::Data {
        all.push(moment.clone());
    }
    all
}

#[test]
fn the_engine_gets_the_same_bits_with_files_and_without() {
    let directory = recorded(&[]);
    let out = directory.path().join("out");
    let simulation = simulation();
    let text = std::fs::read_to_string(out.join("room.toml")).unwrap();
    assert_eq!(text, simulation.room_file(&Files::default()));
    let raw = parse("room.toml", &text, &vec![]).unwrap();
    let room = resolve(&raw, "room.toml", &text, &out, "room").unwrap();
    let sources = || {
        let cameras = (0..2).map(|number| Box::new(simulation.camera(number)) as Box<dyn VideoSource>);
        let arrays = (0..2).map(|number| Box::new(simulation.array(number).unwrap()) as Box<dyn AudioSource>);
        (cameras.collect::<Vec<_>>(), arrays.collect::<Vec<_>>())
    };
    let (cameras, arrays) = sources();
    let direct = moments(cameras, arrays);
    let files_of = |name: &str| out.join(name);
    let cameras = room.cameras.iter().map(|camera| {
        let options = hearsight::media::VideoOptions {
            name: camera.name.clone(),
            clock: hearsight::media::SourceClock {
                drift_ppm: camera.drift_ppm,
                ..hearsight::media::SourceClock::at(camera.start.unwrap())
            },
            ..hearsight::media::VideoOptions::default()
        };
        let file = files_of(&format!("{}.mov", camera.name));
        Box::new(hearsight::media::VideoFile::open(file, options).unwrap()) as Box<dyn VideoSource>
    });
    let arrays = room.arrays.iter().map(|array| {
        let options = hearsight::media::AudioOptions {
            name: array.name.clone(),
            clock: hearsight::media::SourceClock {
                drift_ppm: array.drift_ppm,
                ..hearsight::media::SourceClock::at(array.start.unwrap())
            },
            ..hearsight::media::AudioOptions::default()
        };
        let file = files_of(&format!("{}.wav", array.name));
        Box::new(hearsight::media::AudioFile::open(file, options).unwrap()) as Box<dyn AudioSource>
    });
    let read = moments(cameras.collect(), arrays.collect());
    assert_eq!(direct.len(), read.len());
    assert!(direct.len() >= 37, "{}", direct.len());
    let mut frames = 0;
    for (one, other) in direct.iter().zip(&read) {
        assert_eq!((one.tick, one.time), (other.tick, other.time));
        assert_eq!(one.faults, other.faults);
        for (one, other) in one.video.iter().zip(&other.video) {
            assert_eq!(one.new, other.new);
            if let (Some(one), Some(other)) = (one.get(), other.get()) {
                assert_eq!((one.time, one.number), (other.time, other.number));
                assert_eq!((one.width, one.height), (other.width, other.height));
                assert!(
                    one.rgb == other.rgb && one.luma == other.luma,
                    "frame {}",
                    one.number
                );
                frames += 1;
            }
        }
        for (one, other) in one.audio.iter().zip(&other.audio) {
            assert_eq!(one.new, other.new);
            if let (Some(one), Some(other)) = (one.get(), other.get()) {
                assert_eq!((one.time, one.rate_hz), (other.time, other.rate_hz));
                assert!(one.channels == other.channels, "samples at {:?}", one.time);
            }
        }
    }
    assert!(frames > 55, "{frames}");
    let lost = direct[16].audio[0].get().unwrap();
    assert!(lost.channels[0].iter().all(|sample| *sample == 0.0));
    assert!(
        direct[20].audio[0].get().unwrap().channels[0]
            .iter()
            .any(|sample| *sample != 0.0)
    );
    // And so the engine finds the same.
    let track = |mut engine: Engine| -> Vec<Scene> {
        let mut scenes = Vec::new();
        while let Some(scene) = engine.step() {
            scenes.push(scene.clone());
        }
        scenes
    };
    let (cameras, arrays) = sources();
    let without_files = track(Engine::open_with_sources(room.clone(), cameras, arrays).unwrap());
    let with_files = track(Engine::open(room).unwrap());
    assert!(!with_files.is_empty());
    assert_eq!(without_files, with_files);
}

#[test]
fn sources_must_be_as_many_as_sensors() {
    let simulation = simulation();
    let text = simulation.room_file(&Files::default());
    let raw = parse("room.toml", &text, &vec![]).unwrap();
    let room = resolve(&raw, "room.toml", &text, Path::new(""), "room").unwrap();
    let error = Engine::open_with_sources(room, vec![Box::new(simulation.camera(0))], Vec::new())
        .err()
        .unwrap();
    assert!(
        error.to_string().contains("2 cameras and 2 arrays, but 1 and 0"),
        "{error}"
    );
}

#[test]
fn one_and_two_threads_simulate_the_same_bytes() {
    let (one, two) = (recorded(&["--threads", "1"]), recorded(&["--threads", "2"]));
    let (one, two) = (
        contents(&one.path().join("out")),
        contents(&two.path().join("out")),
    );
    let names: Vec<&str> = one.iter().map(|(name, _)| name.as_str()).collect();
    let wanted = [
        "circle.wav",
        "front.gt.txt",
        "front.mov",
        "pair.wav",
        "room.toml",
        "side.gt.txt",
        "side.mov",
        "speech.rttm",
        "truth.jsonl",
    ];
    assert_eq!(names, wanted);
    for ((name, one), (_, two)) in one.iter().zip(&two) {
        assert!(one == two, "{name} differs");
        assert!(one.len() > 40, "{name} is almost empty");
    }
}

#[test]
fn parts_can_be_left_out_and_other_formats_chosen() {
    let directory = recorded(&["--no-video", "--seconds", "1"]);
    let names: Vec<String> = contents(&directory.path().join("out"))
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    assert!(!names.iter().any(|name| name.ends_with(".mov")), "{names:?}");
    let directory = recorded(&["--no-audio", "--format", "mp4", "--seconds", "1", "--seed", "4"]);
    let room = directory.path().join("out/room.toml");
    let text = std::fs::read_to_string(&room).unwrap();
    assert!(
        text.contains("front.mp4") && !text.contains("[[array]]"),
        "{text}"
    );
    let tracked = run(&["track", room.to_str().unwrap(), "--quiet", "--strict"]);
    assert!(tracked.status.success(), "{}", errors(&tracked));
    let truth = std::fs::read_to_string(directory.path().join("out/truth.jsonl")).unwrap();
    assert_eq!(truth.lines().count(), 15);
    for line in truth.lines() {
        let record: hearsight::core::truth::TruthRecord = serde_json::from_str(line).unwrap();
        assert_eq!(record.people[0].name, "anna");
    }
}

#[test]
fn bad_scenarios_and_commands_are_refused() {
    let directory = TempDir::new().unwrap();
    let scene = directory.path().join("scene.toml");
    let out = directory.path().join("out");
    let simulate = |text: &str, more: &[&str]| {
        std::fs::write(&scene, text).unwrap();
        let mut arguments = vec![
            "simulate",
            scene.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
        ];
        arguments.extend(more);
        run(&arguments)
    };
    let output = simulate("[[person]]\nname = \"eve\"\nat = [99, 1]\n", &[]);
    assert_eq!(output.status.code(), Some(1));
    assert!(errors(&output).contains("person[0].at"), "{}", errors(&output));
    let output = simulate(SCENE, &["--set", "room.t6=1"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(errors(&output).contains("t60"), "{}", errors(&output));
    let output = simulate(SCENE, &["--set", "room.t60=0.01"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        errors(&output).contains("t60") && !errors(&output).contains("panicked"),
        "{}",
        errors(&output)
    );
    assert_eq!(
        simulate(SCENE, &["--no-video", "--no-audio"]).status.code(),
        Some(2)
    );
    assert!(!out.join("room.toml").exists());
}

#[test]
fn an_interrupted_simulation_leaves_files_that_can_be_tracked() {
    let directory = TempDir::new().unwrap();
    let scene = directory.path().join("scene.toml");
    std::fs::write(&scene, SCENE).unwrap();
    let out = directory.path().join("out");
    let child = hearsight(&["simulate", scene.to_str().unwrap(), "--seconds", "600", "--out"])
        .arg(&out)
        .stderr(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // It has begun once some truth is there.
    let truth = out.join("truth.jsonl");
    for _ in 0..600 {
        if std::fs::metadata(&truth).is_ok_and(|file| file.len() > 0) {
            break;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    let killed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(killed.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(
        output.status.code(),
        Some(130),
        "{}{}",
        printed(&output),
        errors(&output)
    );
    let lines = std::fs::read_to_string(&truth).unwrap();
    assert!(
        lines.ends_with('\n')
            && lines
                .lines()
                .all(|line| serde_json::from_str::<serde_json::Value>(line).is_ok())
    );
    let room = out.join("room.toml");
    let tracked = run(&[
        "track",
        room.to_str().unwrap(),
        "--until",
        "0.5",
        "--quiet",
        "--strict",
    ]);
    assert!(tracked.status.success(), "{}", errors(&tracked));
}

#[test]
fn the_demo_simulates_tracks_and_judges() {
    let directory = TempDir::new().unwrap();
    let out = directory.path().join("demo");
    let shown = run(&[
        "demo",
        "--seconds",
        "3",
        "--room",
        "living-room",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert!(shown.status.success(), "{}", errors(&shown));
    let text = printed(&shown);
    for word in ["beside the truth", "mota", "cam.mp4", "report.html"] {
        assert!(text.contains(word), "no `{word}` in: {text}");
    }
    for file in [
        "room.toml",
        "truth.jsonl",
        "cam.mov",
        "pair.wav",
        "report.html",
        "tracks/cam.mp4",
        "tracks/scenes.jsonl",
    ] {
        assert!(
            std::fs::metadata(out.join(file)).is_ok_and(|file| file.len() > 100),
            "{file}"
        );
    }
}

/// A ring of cameras is one picture where `room.toml` says so, and what is wrong with it is named.
#[test]
fn a_ring_of_cameras_is_tracked_as_a_panorama() {
    let directory = TempDir::new().unwrap();
    let scene = directory.path().join("ring.toml");
    let text = r#"
seconds = 2
[room]
size = [4, 4, 2.5]
t60 = 0.2
[[person]]
at = [3.2, 2.0]
turns = [[0.3, 1.8]]
[[camera]]
name = "ring"
size = [120, 90]
ring = 4
view = 100
at = [2, 2, 1.4]
[[array]]
name = "table"
count = 4
at = [2, 2, 0.8]
camera = "ring-2"
"#;
    std::fs::write(&scene, text).unwrap();
    let out = directory.path().join("room");
    let made = run(&[
        "simulate",
        scene.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
        "--quiet",
    ]);
    assert!(made.status.success(), "{}", errors(&made));
    let room = out.join("room.toml");
    let plain = std::fs::read_to_string(&room).unwrap();
    let with = |panorama: &str| std::fs::write(&room, format!("{plain}\n{panorama}")).unwrap();
    let track = || {
        run(&[
            "track",
            room.to_str().unwrap(),
            "--quiet",
            "--system",
            "closed-loop",
        ])
    };
    with(
        "[[panorama]]\nname = \"all\"\ncameras = [\"ring-1\", \"ring-2\", \"ring-3\", \"ring-4\"]\nsize = [400, 80]\n",
    );
    let tracked = track();
    assert!(tracked.status.success(), "{}", errors(&tracked));
    let report = std::fs::read(out.join("out/report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
    assert_eq!(
        report["counts"]["frames"],
        serde_json::json!({ "all": 30 }),
        "{report}"
    );
    // Heard with all microphones: somebody is heard where the person is, in the middle of the first camera's picture.
    let scenes = std::fs::read_to_string(out.join("out/scenes.jsonl")).unwrap();
    let columns: Vec<f64> = scenes
        .lines()
        .filter_map(|line| {
            serde_json::from_str::<Scene>(line)
                .ok()?
                .sounds
                .first()?
                .column_px
        })
        .collect();
    let near = columns
        .iter()
        .filter(|column| (*column - 200.0).abs() < 15.0)
        .count();
    assert!(near * 2 > columns.len() && near > 5, "{columns:?}");
    for (panorama, named) in [
        ("[[panorama]]\ncameras = [\"ring-1\"]\n", "at least two"),
        ("[[panorama]]\ncameras = [\"ring-1\", \"ring-9\"]\n", "ring-9"),
        (
            "[[panorama]]\ncameras = [\"ring-1\", \"ring-2\"]\nseam = 2.0\n",
            "seam",
        ),
    ] {
        with(panorama);
        let refused = track();
        assert!(!refused.status.success());
        assert!(errors(&refused).contains(named), "{}", errors(&refused));
    }
}
