//! Whatever is wrong with the input: one clear error or a reported degradation, never a panic.

use crate::common::{SECONDS, errors, printed, quoted, recording, run};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A room that is to be tried, in a directory of its own.
struct Trial {
    directory: TempDir,
}

impl Trial {
    fn new() -> Self {
        Self {
            directory: TempDir::new().unwrap(),
        }
    }

    fn file(&self, name: &str, content: &[u8]) -> PathBuf {
        let path = self.directory.path().join(name);
        std::fs::write(&path, content).unwrap();
        path
    }

    /// Tracks a room of this text; gives exit code and everything printed, without what differs from run to run.
    fn track(&self, text: &str, more: &[&str]) -> (i32, String) {
        let room = self.file("room.toml", text.as_bytes());
        let out = self.directory.path().join("out");
        let mut arguments = vec!["track", room.to_str().unwrap(), "--out", out.to_str().unwrap()];
        arguments.extend(more);
        let output = run(&arguments);
        let text = format!("{}{}", errors(&output), printed(&output));
        assert!(!text.contains("panicked"), "{text}");
        let code = output.status.code().unwrap();
        // One error, not a chain of consequences.
        assert!(code != 1 || text.matches('×').count() == 1, "{text}");
        (code, text)
    }

    /// The room must be refused, with all of `words` in the message (line breaks do not count).
    fn refused(&self, text: &str, words: &[&str]) {
        let (code, message) = self.track(text, &[]);
        assert_eq!(code, 1, "{message}");
        let flat = flat(&message);
        for word in words {
            assert!(flat.contains(word), "no `{word}` in: {message}");
        }
    }
}

/// The text of a message in one line, without the frame that is drawn around it.
fn flat(message: &str) -> String {
    let words = message
        .split_whitespace()
        .filter(|word| !word.chars().all(|c| "│╭╰─·×┬".contains(c)));
    words.collect::<Vec<_>>().join(" ")
}

fn video() -> PathBuf {
    recording().join("front.mp4")
}

fn sound() -> PathBuf {
    recording().join("pair.wav")
}

fn camera(file: &Path) -> String {
    format!("[[camera]]\nname = \"front\"\nfile = {}\n", quoted(file))
}

fn array(file: &Path, more: &str) -> String {
    format!("[[array]]\nname = \"pair\"\nfile = {}\n{more}\n", quoted(file))
}

const MICROPHONES: &str = "microphones = [[-0.475, 0, 1.4], [0.475, 0, 1.4]]";

#[test]
fn files_that_are_no_media() {
    let trial = Trial::new();
    let missing = trial.directory.path().join("none.avi");
    trial.refused(&camera(&missing), &["front", "none.avi", "check the spelling"]);
    let (_, message) = trial.track(&camera(&missing), &[]);
    assert_eq!(flat(&message).matches("no such file").count(), 1, "{message}");
    trial.refused(&camera(trial.directory.path()), &["front", "directory"]);
    trial.refused(
        &camera(&trial.file("empty.avi", b"")),
        &["front", "empty.avi", "empty"],
    );
    trial.refused(
        &camera(&trial.file("text.avi", b"this is not a video\n")),
        &["front", "text.avi"],
    );
    trial.refused(&camera(&sound()), &["front", "no video"]);
    trial.refused(&array(&video(), ""), &["pair", "no audio"]);
}

#[test]
fn room_files_that_are_none() {
    let trial = Trial::new();
    trial.refused("", &["names no camera"]);
    trial.refused("[[camera]\n", &["room.toml"]);
    trial.refused("[[camera]]\nname = \"a\"\n", &["camera[0]", "exactly one of"]);
    let output = run(&["track", trial.directory.path().to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        flat(&errors(&output)).contains("room.toml inside the directory"),
        "{}",
        errors(&output)
    );
    let output = run(&["track", video().to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        flat(&errors(&output)).contains("not a recording"),
        "{}",
        errors(&output)
    );
    let output = run(&["track"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn unknown_words_have_suggestions() {
    let trial = Trial::new();
    let front = camera(&video());
    trial.refused(
        &format!("{front}strat = 1\n"),
        &["unknown key `strat`", "did you mean `start`"],
    );
    trial.refused(
        &format!("{front}[system]\nname = \"stak\"\n"),
        &["no system `stak`", "did you mean `stac`"],
    );
    trial.refused(
        &format!("{front}[system.stac]\nparticle = 3\n"),
        &["no parameter `particle`", "`particles`"],
    );
    trial.refused(
        &format!("{front}[output]\noverlays = true\n"),
        &["unknown key `overlays`", "`overlay`"],
    );
    trial.refused(&format!("{front}[run]\nseed = \"one\"\n"), &["seed"]);
    let (code, message) = trial.track(&front, &["--set", "run.sed=3"]);
    assert_eq!(code, 1);
    assert!(
        flat(&message).contains("run.sed=3: unknown key `sed`"),
        "{message}"
    );
    trial.refused(
        &format!("{front}[system.stac]\nparticles = \"many\"\n"),
        &["particles"],
    );
}

#[test]
fn channels_that_do_not_fit() {
    let trial = Trial::new();
    let front = camera(&video());
    let three = "microphones = [[-0.4, 0, 1.4], [0, 0, 1.4], [0.4, 0, 1.4]]";
    trial.refused(
        &format!("{front}{}", array(&sound(), three)),
        &["pair", "2 channels", "3"],
    );
    let fourth = format!("{MICROPHONES}\nchannels = [0, 4]");
    trial.refused(
        &format!("{front}{}", array(&sound(), &fourth)),
        &["pair", "channel 4"],
    );
    let twice = format!("{MICROPHONES}\nchannels = [0, 0]");
    trial.refused(
        &format!("{front}{}", array(&sound(), &twice)),
        &["channels", "twice"],
    );
    let one_place = "microphones = [[1, 1, 1], [1, 1, 1]]";
    trial.refused(
        &format!("{front}{}", array(&sound(), one_place)),
        &["at one place", "zero size"],
    );
    let nowhere = "microphones = [[0, 0, 0], [nan, 0, 0]]";
    trial.refused(
        &format!("{front}{}", array(&sound(), nowhere)),
        &["microphone 1", "finite"],
    );
}

#[test]
fn rates_that_cannot_be() {
    let trial = Trial::new();
    let front = camera(&video());
    trial.refused(
        &format!("{front}{}", array(&sound(), "rate = 0")),
        &["rate", "0 samples a second"],
    );
    let mut bytes = std::fs::read(sound()).unwrap();
    bytes[24..28].copy_from_slice(&1_u32.to_le_bytes());
    let slow = trial.file("slow.wav", &bytes);
    trial.refused(
        &format!("{front}{}", array(&slow, MICROPHONES)),
        &["array `pair` of 1 samples a second", "1000", "`rate`"],
    );
    bytes[24..28].fill(0);
    let silent = trial.file("no-rate.wav", &bytes);
    trial.refused(
        &format!("{front}{}", array(&silent, "")),
        &["pair", "no-rate.wav"],
    );
    let (code, message) = trial.track(
        &format!(
            "{front}{}",
            array(&sound(), &format!("{MICROPHONES}\nrate = 12345"))
        ),
        &["--until", "1"],
    );
    assert_eq!(code, 0, "{message}");
}

#[test]
fn times_that_do_not_meet() {
    let trial = Trial::new();
    let late = format!("start = {}", SECONDS + 100.0);
    let apart = format!("{}{}", camera(&video()), array(&sound(), &late));
    // The video does not know its length; that of the sound is known, so that the other order is refused below.
    let (code, message) = trial.track(&format!("{apart}[run]\nuntil = 10\n"), &[]);
    assert_eq!(code, 0, "{message}");
    assert!(
        message.contains("`pair` gave no data") && message.contains("frames: front 1"),
        "{message}"
    );
    let early = format!(
        "{}start = {}\n{}",
        camera(&video()),
        SECONDS + 100.0,
        array(&sound(), "")
    );
    trial.refused(&early, &["front", "pair", "overlaps with no other sensor"]);
    let limits = format!("{}[run]\nfrom = 3\nuntil = 2\n", camera(&video()));
    trial.refused(&limits, &["until", "not after"]);
    let never = format!("{}[run]\nfrom = 500\n", array(&sound(), ""));
    trial.refused(&never, &["no sensor has data"]);
}

#[test]
fn samples_that_are_not_numbers_are_reported() {
    let trial = Trial::new();
    let path = trial.directory.path().join("nan.wav");
    let spec = hound::WavSpec {
        channels: 2,
        sample_rate: 16_000,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(&path, spec).unwrap();
    for number in 0..64_000 {
        let sample = if (20_000..20_010).contains(&number) {
            f32::NAN
        } else {
            0.1 * (number as f32 * 0.3).sin()
        };
        writer.write_sample(sample).unwrap();
    }
    writer.finalize().unwrap();
    let text = format!("{}{}", camera(&video()), array(&path, MICROPHONES));
    let (code, message) = trial.track(&text, &["--until", "2"]);
    assert_eq!(code, 0, "{message}");
    assert!(message.contains("fault: pair"), "{message}");
    let (code, _) = trial.track(&text, &["--until", "2", "--strict"]);
    assert_eq!(code, 3);
}

#[test]
fn a_truncated_recording_is_used_as_far_as_it_goes() {
    let trial = Trial::new();
    let mp4 = std::fs::read(video()).unwrap();
    let (code, message) = trial.track(&camera(&trial.file("cut.mp4", &mp4[..mp4.len() / 2])), &[]);
    assert_eq!(code, 0, "{message}");
    let wav = std::fs::read(sound()).unwrap();
    let cut = trial.file("cut.wav", &wav[..wav.len() / 2]);
    let (code, message) = trial.track(&format!("{}{}", camera(&video()), array(&cut, MICROPHONES)), &[]);
    assert_eq!(code, 0, "{message}");
    assert!(message.contains("fault: pair"), "{message}");
    let Some(shared) = crate::common::shared_data() else {
        return;
    };
    let avi = std::fs::read(shared.join("seq30-2p-1101_cam1_divx_audio.avi")).unwrap();
    let cut = camera(&trial.file("cut.avi", &avi[..avi.len() / 6]));
    let (code, message) = trial.track(&cut, &[]);
    assert_eq!(code, 0, "{message}");
    assert!(message.contains("fault: front"), "{message}");
    assert!(!message.contains("libav: "), "{message}");
}

#[test]
fn a_camera_without_calibration_is_tracked_and_checked() {
    let trial = Trial::new();
    let text = format!("{}{}", camera(&video()), array(&sound(), MICROPHONES));
    let (code, message) = trial.track(&text, &["--until", "2"]);
    assert_eq!(code, 0, "{message}");
    let room = trial.directory.path().join("room.toml");
    let output = run(&["check", room.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    assert!(
        printed(&output).contains("no calibration"),
        "{}",
        printed(&output)
    );
    let wrong = format!("{}calibration = \"none.yaml\"\n", camera(&video()));
    trial.refused(&wrong, &["calibration", "none.yaml"]);
    let size = "calibration = { model = \"pinhole\", width = 640, height = 480, focal_px = [500.0, 500.0], \
                centre_px = [319.5, 239.5] }\n";
    trial.refused(&format!("{}{size}", camera(&video())), &["front", "640", "320"]);
}

#[test]
fn an_array_without_places_is_left_out_with_a_warning() {
    let trial = Trial::new();
    let alone = |text: &str| {
        let (code, message) = trial.track(text, &["--until", "2"]);
        assert_eq!(code, 0, "{message}");
        let tracks = std::fs::read_to_string(trial.directory.path().join("out/tracks.csv")).unwrap();
        let report = std::fs::read_to_string(trial.directory.path().join("out/report.json")).unwrap();
        let report: serde_json::Value = serde_json::from_str(&report).unwrap();
        (flat(&message), tracks, report["warnings"].clone())
    };
    let (message, with, warnings) = alone(&format!("{}{}", camera(&video()), array(&sound(), "")));
    // Once in the log, once at the end.
    let what = "array `pair` is not listened to";
    assert_eq!(message.matches(what).count(), 2, "{message}");
    assert!(message.contains("`microphones = [[x, y, z], ...]`"), "{message}");
    assert!(warnings[0].as_str().unwrap().contains(what), "{warnings}");
    let (message, without, warnings) = alone(&camera(&video()));
    assert_eq!(with, without);
    assert!(
        !message.contains("warning") && warnings.as_array().unwrap().is_empty(),
        "{message}"
    );
    let one = "microphones = [[0, 0, 1.4]]\nchannels = [0]";
    let (message, ..) = alone(&format!("{}{}", camera(&video()), array(&sound(), one)));
    assert!(message.contains(what), "{message}");
}

#[test]
fn microphones_that_are_too_far_apart_are_refused() {
    let trial = Trial::new();
    for (far, words) in [("1e3", "60 m"), ("1e300", "in no room")] {
        let microphones = format!("microphones = [[-0.5, 0, 1.4], [{far}, 0, 1.4]]");
        trial.refused(
            &format!("{}{}", camera(&video()), array(&sound(), &microphones)),
            &["microphones", words],
        );
    }
}

#[test]
fn parameters_out_of_range_are_named_with_the_range() {
    let trial = Trial::new();
    let text = format!("{}{}", camera(&video()), array(&sound(), MICROPHONES));
    for (parameter, range) in [
        ("audio.frame_s=1e308", "0.01 to 1"),
        ("audio.frame_s=65536", "0.01 to 1"),
        ("vision.heads.smallest_px=1e39", "4 to 10000"),
        ("particles=100000000000", "1 to 20000"),
        ("association.gate=nan", "not a number"),
        ("association.gate=1e39", "0 to 10000"),
    ] {
        let (code, message) = trial.track(&text, &["--set", &format!("system.stac.{parameter}")]);
        assert_eq!(code, 1, "{message}");
        let (name, _) = parameter.split_once('=').unwrap();
        let flat = flat(&message);
        assert!(
            flat.contains(&format!("system.stac.{name}")) && flat.contains(range),
            "{message}"
        );
    }
}

#[test]
fn sound_alone_is_heard() {
    let trial = Trial::new();
    let (code, message) = trial.track(&array(&sound(), MICROPHONES), &["--until", "1"]);
    // A system that needs a picture says so; one that does not, runs.
    assert!(
        code == 0 || (code == 1 && flat(&message).contains("camera")),
        "{message}"
    );
}

#[test]
fn check_reports_every_sensor_that_is_wrong() {
    let trial = Trial::new();
    let text = format!(
        "{}{}",
        camera(Path::new("none.avi")),
        array(Path::new("none.wav"), "")
    );
    let room = trial.file("room.toml", text.as_bytes());
    let output = run(&["check", room.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    let printed = printed(&output);
    assert!(
        printed.contains("none.avi") && printed.contains("none.wav"),
        "{printed}"
    );
    assert!(printed.contains("2 failures"), "{printed}");
}

#[test]
fn an_output_that_cannot_be_written_is_an_error() {
    let trial = Trial::new();
    let file = trial.file("taken", b"a file");
    let room = recording().join("room.toml");
    let output = run(&["track", room.to_str().unwrap(), "--out", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        flat(&errors(&output)).contains("cannot be written"),
        "{}",
        errors(&output)
    );
}
