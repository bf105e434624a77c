//! What the program promises of its outputs: the same bytes for any number of threads, a run that goes on as if it had
//! never been put aside, and valid files after Ctrl-C.

use crate::common::{contents, errors, hearsight, printed, recording, run};
use std::path::Path;
use std::process::Command;
use std::time::Duration;
use tempfile::TempDir;

/// `report.json` has timings, which differ from run to run.
fn without_report(directory: &Path) -> Vec<(String, Vec<u8>)> {
    contents(directory)
        .into_iter()
        .filter(|(name, _)| name != "report.json")
        .collect()
}

fn track(room: &Path, out: &Path, more: &[&str]) {
    let mut arguments = vec![
        "track",
        room.to_str().unwrap(),
        "--quiet",
        "--out",
        out.to_str().unwrap(),
    ];
    arguments.extend(more);
    let output = run(&arguments);
    assert!(output.status.success(), "{}", errors(&output));
}

fn lines(path: &Path) -> Vec<String> {
    std::fs::read_to_string(path)
        .unwrap()
        .lines()
        .map(str::to_owned)
        .collect()
}

#[test]
fn one_and_two_threads_write_the_same_bytes() {
    let (room, directory) = (recording().join("room.toml"), TempDir::new().unwrap());
    let (one, two) = (directory.path().join("one"), directory.path().join("two"));
    track(&room, &one, &["--threads", "1", "--overlay"]);
    track(&room, &two, &["--threads", "2", "--overlay"]);
    let (one, two) = (without_report(&one), without_report(&two));
    let names: Vec<&str> = one.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        [
            "front.mot.txt",
            "front.mp4",
            "scenes.jsonl",
            "speech.rttm",
            "tracks.csv"
        ]
    );
    for ((name, one), (_, two)) in one.iter().zip(&two) {
        assert!(one == two, "{name} differs");
        assert!(one.len() > 60, "{name} is almost empty");
    }
}

#[test]
fn a_restored_run_goes_on_with_the_same_bytes() {
    let (room, directory) = (recording().join("room.toml"), TempDir::new().unwrap());
    let at = |name: &str| directory.path().join(name);
    let state = at("state");
    let state = state.to_str().unwrap();
    track(&room, &at("whole"), &[]);
    track(&room, &at("first"), &["--until", "2.5", "--save", state]);
    track(&room, &at("second"), &["--restore", state, "--threads", "1"]);
    for file in ["scenes.jsonl", "front.mot.txt"] {
        let whole = lines(&at("whole").join(file));
        let mut parts = lines(&at("first").join(file));
        assert!(
            !parts.is_empty() && parts.len() < whole.len(),
            "{file}: {} lines",
            parts.len()
        );
        parts.extend(lines(&at("second").join(file)));
        assert_eq!(whole.len(), parts.len(), "{file}");
        for (number, (whole, part)) in whole.iter().zip(&parts).enumerate() {
            assert_eq!(whole, part, "{file}, line {}", number + 1);
        }
    }
}

#[test]
fn a_state_of_another_run_is_refused() {
    let (room, directory) = (recording().join("room.toml"), TempDir::new().unwrap());
    let (room, out) = (room.to_str().unwrap(), directory.path().join("out"));
    let state = directory.path().join("state");
    track(
        Path::new(room),
        &out,
        &["--until", "0.5", "--save", state.to_str().unwrap()],
    );
    let restore = |more: &[&str]| {
        let mut arguments = vec![
            "track",
            room,
            "--quiet",
            "--out",
            out.to_str().unwrap(),
            "--restore",
        ];
        arguments.push(state.to_str().unwrap());
        arguments.extend(more);
        run(&arguments)
    };
    let other_seed = restore(&["--seed", "7"]);
    assert_eq!(other_seed.status.code(), Some(1));
    assert!(errors(&other_seed).contains("seed"), "{}", errors(&other_seed));
    let bytes = std::fs::read(&state).unwrap();
    for damaged in [
        &bytes[..4],
        &bytes[..bytes.len() / 2],
        b"no state at all".as_slice(),
        &[],
    ] {
        std::fs::write(&state, damaged).unwrap();
        let output = restore(&[]);
        assert_eq!(output.status.code(), Some(1), "{}", errors(&output));
        assert!(!errors(&output).contains("panicked"), "{}", errors(&output));
    }
}

#[test]
fn an_interrupted_run_leaves_valid_files() {
    let (room, directory) = (recording().join("room.toml"), TempDir::new().unwrap());
    let out = directory.path().join("out");
    // At its own pace the recording lasts seconds; the interruption comes in the middle.
    let child = hearsight(&[
        "track",
        room.to_str().unwrap(),
        "--overlay",
        "--out",
        out.to_str().unwrap(),
    ])
    .args([
        "--set",
        "camera.front.paced=true",
        "--set",
        "array.pair.paced=true",
    ])
    .stdout(std::process::Stdio::piped())
    .stderr(std::process::Stdio::piped())
    .spawn()
    .unwrap();
    std::thread::sleep(Duration::from_millis(2500));
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
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("report.json")).unwrap()).unwrap();
    assert_eq!(report["outcome"], "interrupted");
    let ticks = report["counts"]["ticks"].as_u64().unwrap();
    let scenes = lines(&out.join("scenes.jsonl"));
    assert_eq!(scenes.len() as u64, ticks);
    assert!(ticks > 5 && ticks < 125, "{ticks} ticks");
    for scene in &scenes {
        let _: serde_json::Value = serde_json::from_str(scene).unwrap();
    }
    // The overlay is a video that can be read: as the camera of another room.
    let again = directory.path().join("again.toml");
    std::fs::write(&again, "[[camera]]\nfile = \"out/front.mp4\"\n").unwrap();
    track(&again, &directory.path().join("again"), &["--until", "0.2"]);
}

#[test]
fn outputs_are_chosen_by_flags_and_by_the_file() {
    let (room, directory) = (recording().join("room.toml"), TempDir::new().unwrap());
    let out = directory.path().join("out");
    track(
        &room,
        &out,
        &[
            "--until",
            "0.2",
            "--no-mot",
            "--no-speech",
            "--set",
            "output.tracks=false",
        ],
    );
    let names: Vec<String> = contents(&out).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["report.json", "scenes.jsonl"]);
}

#[test]
fn formats_begin_as_documented() {
    let (room, directory) = (recording().join("room.toml"), TempDir::new().unwrap());
    let out = directory.path().join("out");
    track(&room, &out, &[]);
    assert!(lines(&out.join("tracks.csv"))[0].starts_with("t_sec,track,x_m,y_m,z_m"));
    for line in lines(&out.join("front.mot.txt")) {
        let fields: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        assert_eq!(fields.len(), 10, "{line}");
        assert!(
            fields[0] >= 1.0 && fields[0] <= 125.0 && fields[1] >= 1.0,
            "{line}"
        );
        assert_eq!(&fields[7..], [-1.0, -1.0, -1.0]);
    }
    for line in lines(&out.join("speech.rttm")) {
        assert!(
            line.starts_with("SPEAKER test 1 ") && line.contains(" <NA> <NA> track"),
            "{line}"
        );
        assert_eq!(line.split(' ').count(), 10, "{line}");
    }
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("report.json")).unwrap()).unwrap();
    assert_eq!(report["outcome"], "finished");
    assert_eq!(report["counts"]["frames"]["front"], 125);
    assert_eq!(report["configuration"]["system"]["name"], "stac");
}

#[test]
fn check_passes_what_is_sane_and_sees_swapped_channels() {
    let room = recording().join("room.toml");
    let room = room.to_str().unwrap();
    let sane = run(&["check", room, "--strict"]);
    assert!(sane.status.success(), "{}{}", printed(&sane), errors(&sane));
    let swapped = run(&["check", room, "--json", "--set", "array.pair.channels=[1, 0]"]);
    assert!(swapped.status.success());
    let report: serde_json::Value = serde_json::from_slice(&swapped.stdout).unwrap();
    let findings = report["findings"].as_array().unwrap();
    let order = findings
        .iter()
        .find(|finding| finding["aspect"] == "order of channels")
        .unwrap();
    assert_eq!(order["verdict"], "warning", "{order}");
}

#[test]
fn the_example_of_av16_3_gives_tracks() {
    if crate::common::shared_data().is_none() {
        return;
    }
    let room = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/av16.3.toml");
    let directory = TempDir::new().unwrap();
    track(&room, directory.path(), &["--from", "17", "--until", "20"]);
    for camera in ["cam1", "cam2", "cam3"] {
        assert!(
            !lines(&directory.path().join(format!("{camera}.mot.txt"))).is_empty(),
            "{camera}"
        );
    }
    let scenes = lines(&directory.path().join("scenes.jsonl"));
    assert!((74..=76).contains(&scenes.len()), "{}", scenes.len());
}

#[test]
fn a_reader_that_goes_away_is_no_accident() {
    let mut child = hearsight(&["schema"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(
        output.status.success() && output.stderr.is_empty(),
        "{}",
        errors(&output)
    );
}
