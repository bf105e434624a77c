//! Pictures that go all round: who walks across the seam stays one track, and whoever speaks is found on both sides of it.

#![expect(clippy::unwrap_used, reason = "a test that cannot make its input should stop")]

#[expect(dead_code, reason = "this test makes pictures and sounds of its own")]
mod drawn_room;

use drawn_room::{BLUE, FRAME, HEIGHT, Person, RATE_HZ, RED, WIDTH, noise, picture};
use hearsight_core::camera::{Camera, CameraModel, Panorama, PanoramaParameters};
use hearsight_core::moment::{Moment, Observed};
use hearsight_core::record::Scene;
use hearsight_core::room::{ArraySensor, CameraSensor, Room};
use hearsight_core::{AudioBlock, DistortedPixel, Instant, Pose, Span, WorldPoint};
use hearsight_systems::build;
use serde_json::json;
use std::f64::consts::TAU;

const TURN: f32 = WIDTH as f32;

fn camera() -> Camera {
    let lens = Panorama::new(PanoramaParameters {
        columns_per_turn: WIDTH as f64,
        focal_px: WIDTH as f64 / TAU,
        centre_px: [159.5, 119.5],
    })
    .unwrap();
    Camera {
        model: CameraModel::Panorama(lens),
        pose: Pose::looking_at(WorldPoint::new(0.0, 0.0, 1.4), WorldPoint::new(1.0, 0.0, 1.4)).unwrap(),
        width: WIDTH,
        height: HEIGHT,
    }
}

fn microphones() -> Vec<WorldPoint> {
    (0..6)
        .map(|k| {
            let (sin, cos) = (TAU * f64::from(k) / 6.0).sin_cos();
            WorldPoint::new(0.15 * cos, 0.15 * sin, 1.2)
        })
        .collect()
}

fn room() -> Room {
    Room {
        cameras: vec![CameraSensor {
            name: "cam".into(),
            width: WIDTH,
            height: HEIGHT,
            interval: FRAME,
            calibration: Some(camera()),
        }],
        arrays: vec![ArraySensor {
            name: "ring".into(),
            rate_hz: RATE_HZ,
            channels: 6,
            microphones: microphones(),
            camera: Some(0),
        }],
        speed_of_sound_m_s: 343.0,
    }
}

/// One walks across the seam and on, the other stands opposite; both come out of nothing after two seconds.
fn columns(tick: usize) -> Vec<f32> {
    let Some(since) = tick.checked_sub(50) else {
        return vec![];
    };
    vec![
        180.0 + (since as f32 * 3.0).min(100.0) + (since.saturating_sub(34) as f32).min(90.0),
        50.0 + (since as f32 * 3.0).min(60.0) + 3.0 * (since as f32 * 0.2).sin(),
    ]
}

fn moment(tick: usize, talker: Option<usize>) -> Moment {
    let columns = columns(tick);
    let mouth = talker.and_then(|talker| columns.get(talker)).copied();
    moment_of(tick, &columns, mouth)
}

/// People at `columns`, and the voice of somebody at `mouth`, seen or not.
fn moment_of(tick: usize, columns: &[f32], mouth: Option<f32>) -> Moment {
    let people: Vec<Person> = columns
        .iter()
        .zip([RED, BLUE])
        .flat_map(|(x, shirt)| [-TURN, 0.0, TURN].map(|turn| Person { x: x + turn, shirt }))
        .collect();
    let frame = picture(tick, &people);
    let mouth = mouth.map(|column| {
        let pixel = DistortedPixel::new(f64::from(column), 100.0);
        camera().ray(pixel).unwrap().at(2.0)
    });
    let count = 640;
    let source = |at: f64| {
        let value = |index: f64| noise((index + 1e6) as usize, 3) as f64 / 128.0 - 1.0;
        value(at.floor()) * (1.0 - at.fract()) + value(at.floor() + 1.0) * at.fract()
    };
    let microphones = microphones();
    let channels = microphones.iter().enumerate().map(|(number, microphone)| {
        let late = mouth.map(|mouth| mouth.distance_m(*microphone) / 343.0 * f64::from(RATE_HZ));
        let sample = |k: usize| {
            let at = tick * count + k;
            let hiss = (noise(at, 11 + number) as f64 / 128.0 - 1.0) * 1e-3;
            let loud = if (at / 3200) % 4 == 3 { 0.0 } else { 0.2 };
            (late.map_or(0.0, |late| loud * source(at as f64 - late)) + hiss) as f32
        };
        (0..count).map(sample).collect()
    });
    Moment {
        tick: tick as u64,
        time: frame.time,
        audio: vec![Observed {
            new: true,
            data: AudioBlock {
                time: Instant::ZERO + Span::of_samples((tick * count) as i64, RATE_HZ) - FRAME,
                rate_hz: RATE_HZ,
                channels: channels.collect(),
            },
        }],
        video: vec![Observed {
            new: true,
            data: frame,
        }],
        faults: vec![],
    }
}

/// Columns from one to another the short way round.
fn apart(a: f32, b: f32) -> f32 {
    let apart = (a - b).rem_euclid(TURN);
    apart.min(TURN - apart)
}

/// Nobody in these pictures has a face.
fn parameters(name: &str) -> serde_json::Value {
    match name {
        "closed-loop" => json!({ "faces": { "cascades": [] } }),
        _ => json!({}),
    }
}

#[test]
fn a_person_who_crosses_the_seam_stays_one_track_and_is_heard() {
    for name in ["closed-loop", "stac"] {
        let mut system = build(name, &parameters(name), &room(), 1).unwrap();
        let mut scene = Scene::default();
        let mut numbers = std::collections::BTreeSet::new();
        let (mut right, mut asked, mut heard) = (0, 0, 0);
        for tick in 0..200 {
            // The walker talks while crossing the seam, then the other.
            let talker = match tick {
                90..=150 => Some(0),
                160..=199 => Some(1),
                _ => None,
            };
            system.step(&moment(tick, talker), &mut scene);
            if tick < 90 {
                continue;
            }
            let people = columns(tick);
            assert_eq!(scene.tracks.len(), 2, "{name}, tick {tick}: {:?}", scene.tracks);
            for track in &scene.tracks {
                let head = track.views[0].head;
                let middle = (head.left + head.width / 2.0) as f32;
                assert!((-0.6..TURN).contains(&middle), "{name}: {middle}");
                let nearest = people.iter().map(|x| apart(*x, middle)).fold(TURN, f32::min);
                assert!(nearest < 10.0, "{name}, tick {tick}: {middle} is {nearest} off");
                if apart(middle, people[0]) < 10.0 {
                    numbers.insert(track.id);
                }
                if (100..150).contains(&tick) || tick >= 175 {
                    let talks = apart(middle, people[talker.unwrap()]) < 10.0;
                    asked += usize::from(talks);
                    right += usize::from(talks && scene.speaker == Some(track.id));
                }
            }
            let sound = scene.sounds.first().and_then(|sound| sound.column_px);
            if let (Some(column), Some(talker)) = (sound, talker) {
                heard += usize::from(apart(column as f32, people[talker]) < 12.0);
            }
        }
        assert_eq!(numbers.len(), 1, "{name}: the walker was {numbers:?}");
        // A third of it is pauses and the beginnings of turns.
        assert!(right * 3 >= asked * 2, "{name}: {right} of {asked}");
        assert!(heard > 20, "{name}: {heard}");
    }
}

#[test]
fn voices_are_heard_where_they_are_all_round_though_nobody_is_seen() {
    for name in ["closed-loop", "stac"] {
        let mut system = build(name, &parameters(name), &room(), 1).unwrap();
        let mut scene = Scene::default();
        let (mut heard, mut right) = (0, 0);
        for tick in 0..400 {
            // One pair alone takes half of these for their mirror images.
            let column = 10.0 + 40.0 * (tick / 50) as f32;
            let talks = tick % 50 >= 10;
            system.step(&moment_of(tick, &[], talks.then_some(column)), &mut scene);
            let sound = scene.sounds.first().and_then(|sound| sound.column_px);
            if let Some(sound) = sound.filter(|_| tick % 50 >= 20) {
                heard += 1;
                right += usize::from(apart(sound as f32, column) < 8.0);
            }
        }
        assert!(heard >= 40, "{name}: {heard}");
        assert!(right * 10 >= heard * 9, "{name}: {right} of {heard}");
    }
}
