//! The text formats, written from made-up scenes by a made-up system on real sound and pictures.

use hearsight_core::Moment;
use hearsight_core::record::{BoxRecord, Scene, TrackPhase, TrackRecord, ViewRecord};
use hearsight_engine::config::{Overrides, ResolvedRoom, parse, resolve};
use hearsight_engine::{Engine, Outcome, run};
use hearsight_systems::{StateError, System};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Believes in two people: one from the third tick on, hidden from the sixth; the other speaks in ticks 2, 3 and 5.
struct Made {
    steps: u64,
    /// Tick at which the first person's box is not a number.
    wrong_at: Option<u64>,
}

impl System for Made {
    fn name(&self) -> &'static str {
        "made"
    }

    fn step(&mut self, moment: &Moment, scene: &mut Scene) {
        self.steps += 1;
        scene.tracks.clear();
        let frame = moment.video.first().map_or(0, |video| video.data.number);
        let track = |id: u64, phase, position_m, speaking| TrackRecord {
            id,
            phase,
            existence: 0.9,
            views: vec![ViewRecord {
                camera: "cam1".to_owned(),
                frame,
                head: BoxRecord {
                    left: 10.0 + frame as f64,
                    top: 5.0,
                    width: 8.0,
                    height: 10.0,
                },
                deviation_px: [1.0, 1.0],
            }],
            position_m,
            deviation_m: None,
            speaking,
            speaking_probability: Some(if speaking { 0.8 } else { 0.1 }),
            effective_sample_size: 10.0,
        };
        let speaking = matches!(moment.tick, 2 | 3 | 5);
        scene.speaker = speaking.then_some(1);
        scene
            .tracks
            .push(track(1, TrackPhase::Visible, Some([1.0, -2.5, 0.25]), speaking));
        if self.wrong_at == Some(moment.tick) {
            scene.tracks[0].views[0].head.left = f64::NAN;
        }
        if moment.tick >= 3 {
            let phase = if moment.tick >= 6 {
                TrackPhase::Occluded
            } else {
                TrackPhase::Visible
            };
            scene.tracks.push(track(2, phase, None, false));
        }
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        Ok(self.steps.to_le_bytes().to_vec())
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), StateError> {
        let bytes = state
            .try_into()
            .map_err(|_| StateError::Foreign("length".to_owned()))?;
        self.steps = u64::from_le_bytes(bytes);
        Ok(())
    }

    fn timings(&self) -> Vec<(&'static str, Duration)> {
        vec![("made", Duration::from_millis(1))]
    }

    fn correlation_strip(&self, _: usize) -> &[f32] {
        &[0.0, 0.5, 1.0, 0.5]
    }

    fn quarantined(&self) -> u64 {
        0
    }
}

/// Eight pictures in a directory, as a room.
fn room(directory: &Path) -> ResolvedRoom {
    for number in 1..=8 {
        let mut picture = image::RgbImage::new(48, 32);
        for (x, y, pixel) in picture.enumerate_pixels_mut() {
            *pixel = image::Rgb([(x * 5) as u8, (y * 7) as u8, number * 20]);
        }
        picture.save(directory.join(format!("{number:03}.png"))).unwrap();
    }
    let text = "[[camera]]\nimages = \"%03d.png\"\nrate = 10\n[output]\noverlay = true\n[run]\nthreads = 1\n";
    let raw = parse("room.toml", text, &Overrides::new()).unwrap();
    resolve(&raw, "room.toml", text, directory, "pictures").unwrap()
}

fn open(room: ResolvedRoom) -> Engine {
    open_wrong(room, None)
}

fn open_wrong(room: ResolvedRoom, wrong_at: Option<u64>) -> Engine {
    Engine::open_with(room, |_| Ok(Box::new(Made { steps: 0, wrong_at }))).unwrap()
}

#[test]
fn a_number_that_is_not_finite_reaches_no_output_and_is_counted() {
    let directory = tempfile::tempdir().unwrap();
    let mut engine = open_wrong(room(directory.path()), Some(5));
    let outputs = engine.open_outputs().unwrap();
    let stop = Arc::new(AtomicBool::new(false));
    let summary = run(&mut engine, outputs, &stop, &mut |_| ()).unwrap();
    assert_eq!((summary.counts.ticks, summary.quarantined), (8, 1));
    let scenes = std::fs::read_to_string(directory.path().join("out/scenes.jsonl")).unwrap();
    let scenes: Vec<Scene> = scenes
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let ids = |tick: usize| {
        scenes[tick]
            .tracks
            .iter()
            .map(|track| track.id)
            .collect::<Vec<_>>()
    };
    assert_eq!((ids(4), ids(5), ids(6)), (vec![1, 2], vec![2], vec![1, 2]));
    assert_eq!((scenes[3].speaker, scenes[5].speaker), (Some(1), None));
}

#[test]
fn every_text_format_is_as_documented() {
    let directory = tempfile::tempdir().unwrap();
    let mut engine = open(room(directory.path()));
    let outputs = engine.open_outputs().unwrap();
    let summary = run(
        &mut engine,
        outputs,
        &Arc::new(AtomicBool::new(false)),
        &mut |_| (),
    )
    .unwrap();
    assert_eq!(summary.outcome, Outcome::Finished);
    assert_eq!(
        (
            summary.counts.ticks,
            summary.counts.tracks,
            summary.counts.ticks_with_speaker
        ),
        (8, 2, 3)
    );
    let read = |name: &str| std::fs::read_to_string(directory.path().join("out").join(name)).unwrap();
    let scenes = read("scenes.jsonl");
    insta::assert_snapshot!("cam1.mot.txt", read("cam1.mot.txt"));
    insta::assert_snapshot!("tracks.csv", read("tracks.csv"));
    insta::assert_snapshot!("speech.rttm", read("speech.rttm"));
    insta::assert_snapshot!(
        "scenes.jsonl",
        scenes.lines().take(4).collect::<Vec<_>>().join("\n")
    );
    for line in scenes.lines() {
        let _: Scene = serde_json::from_str(line).unwrap();
    }
    let report: serde_json::Value = serde_json::from_str(&read("report.json")).unwrap();
    assert_eq!(report["outcome"], "finished");
    let stages: Vec<_> = report["stages"]
        .as_array()
        .unwrap()
        .iter()
        .map(|stage| stage["stage"].clone())
        .collect();
    assert_eq!(stages, ["decode", "made", "write"]);
    assert!(
        std::fs::metadata(directory.path().join("out/cam1.mp4"))
            .unwrap()
            .len()
            > 200
    );
}

#[test]
fn a_run_that_is_asked_to_stop_is_closed() {
    let directory = tempfile::tempdir().unwrap();
    let mut engine = open(room(directory.path()));
    let outputs = engine.open_outputs().unwrap();
    let stop = Arc::new(AtomicBool::new(false));
    let asked = Arc::clone(&stop);
    let summary = run(&mut engine, outputs, &stop, &mut |progress| {
        if progress.ticks == 3 {
            asked.store(true, std::sync::atomic::Ordering::Relaxed);
        }
    });
    assert_eq!(summary.unwrap().outcome, Outcome::Interrupted);
    let scenes = std::fs::read_to_string(directory.path().join("out/scenes.jsonl")).unwrap();
    assert_eq!(scenes.lines().count(), 3);
}

#[test]
fn an_engine_that_was_restored_gives_the_same_scenes() {
    let directory = tempfile::tempdir().unwrap();
    let mut whole = open(room(directory.path()));
    let mut scenes = Vec::new();
    while let Some(scene) = whole.step() {
        scenes.push(scene.clone());
    }
    for at in [0, 1, 4, 8] {
        let mut first = open(room(directory.path()));
        for _ in 0..at {
            assert!(first.step().is_some());
        }
        let saved = first.save().unwrap();
        let mut second = open(room(directory.path()));
        second.restore(&saved).unwrap();
        let mut rest = Vec::new();
        while let Some(scene) = second.step() {
            rest.push(scene.clone());
        }
        assert_eq!(rest, scenes[at..], "restored after {at} ticks");
        assert_eq!(
            second.summary(Outcome::Finished).counts,
            whole.summary(Outcome::Finished).counts
        );
    }
}
