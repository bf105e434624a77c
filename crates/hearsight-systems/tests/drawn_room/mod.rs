//! A room that is drawn and sounded by a formula: two people with coloured shirts before a wall, heard by a pair.

use hearsight_core::camera::{Camera, CameraModel, Pinhole};
use hearsight_core::moment::{Moment, Observed};
use hearsight_core::record::Scene;
use hearsight_core::room::{ArraySensor, CameraSensor, Room};
use hearsight_core::{AudioBlock, Instant, Pose, Span, VideoFrame, WorldPoint};
use hearsight_systems::System;

pub(crate) const WIDTH: usize = 320;
pub(crate) const HEIGHT: usize = 240;
pub(crate) const FRAME: Span = Span::from_nanoseconds(40_000_000);
pub(crate) const RATE_HZ: u32 = 16_000;

/// A number from 0 to 255 that depends on nothing but its arguments.
pub(crate) fn noise(a: usize, b: usize) -> u32 {
    let mut x = (a as u32).wrapping_mul(0x9E37_79B9) ^ (b as u32).wrapping_mul(0x85EB_CA6B);
    x ^= x >> 15;
    x = x.wrapping_mul(0x2C1B_3C6D);
    (x >> 16) & 0xFF
}

pub(crate) struct Person {
    pub(crate) x: f32,
    pub(crate) shirt: [u8; 3],
}

pub(crate) const TOP: f32 = 70.0;
pub(crate) const HEAD: f32 = 26.0;

pub(crate) fn paint(
    frame: &mut VideoFrame,
    left: f32,
    top: f32,
    width: f32,
    height: f32,
    colour: [u8; 3],
    round: bool,
) {
    let (cx, cy) = (left + width / 2.0, top + height / 2.0);
    for y in top.max(0.0) as usize..((top + height).max(0.0) as usize).min(HEIGHT) {
        for x in left.max(0.0) as usize..((left + width).max(0.0) as usize).min(WIDTH) {
            let [dx, dy] = [(x as f32 - cx) / width * 2.0, (y as f32 - cy) / height * 2.0];
            if !round || dx * dx + dy * dy <= 1.0 {
                let grain = (noise(x, y) % 11) as i32 - 5;
                for (c, value) in colour.iter().enumerate() {
                    frame.rgb[(y * WIDTH + x) * 3 + c] = (i32::from(*value) + grain).clamp(0, 255) as u8;
                }
            }
        }
    }
}

pub(crate) fn picture(tick: usize, people: &[Person]) -> VideoFrame {
    let mut frame = VideoFrame {
        time: Instant::ZERO + FRAME * tick as i64,
        number: tick as u64 + 1,
        width: WIDTH,
        height: HEIGHT,
        rgb: (0..WIDTH * HEIGHT)
            .flat_map(|i| [205, 190, 160].map(|wall| (wall + noise(i, tick) % 7 + noise(i, 7919) % 9) as u8))
            .collect(),
        luma: vec![0; WIDTH * HEIGHT],
    };
    for person in people {
        paint(
            &mut frame,
            person.x - 1.05 * HEAD,
            TOP + 1.45 * HEAD,
            2.1 * HEAD,
            110.0,
            person.shirt,
            false,
        );
        paint(
            &mut frame,
            person.x - 0.3 * HEAD,
            TOP + HEAD,
            0.6 * HEAD,
            20.0,
            [190, 130, 100],
            false,
        );
        paint(
            &mut frame,
            person.x - HEAD / 2.0,
            TOP,
            HEAD,
            1.3 * HEAD,
            [190, 130, 100],
            true,
        );
        paint(
            &mut frame,
            person.x - HEAD / 2.0,
            TOP,
            HEAD,
            0.5 * HEAD,
            [40, 30, 25],
            true,
        );
    }
    frame
}

pub(crate) fn camera() -> Camera {
    let lens = Pinhole::ideal([300.0, 300.0], [159.5, 119.5]).unwrap();
    let pose = Pose::looking_at(WorldPoint::new(0.0, 0.0, 1.4), WorldPoint::new(3.0, 0.0, 1.4)).unwrap();
    Camera {
        model: CameraModel::Pinhole(lens),
        pose,
        width: WIDTH,
        height: HEIGHT,
    }
}

pub(crate) fn room(with_sound: bool) -> Room {
    let microphones = vec![
        WorldPoint::new(0.0, 0.475, 1.4),
        WorldPoint::new(0.0, -0.475, 1.4),
    ];
    let array = ArraySensor {
        name: "pair".into(),
        rate_hz: RATE_HZ,
        channels: 2,
        microphones,
        camera: Some(0),
    };
    Room {
        cameras: vec![CameraSensor {
            name: "cam".into(),
            width: WIDTH,
            height: HEIGHT,
            interval: FRAME,
            calibration: Some(camera()),
        }],
        arrays: if with_sound { vec![array] } else { vec![] },
        speed_of_sound_m_s: 343.0,
    }
}

/// Noise in bursts like syllables from the mouth of a head at column `x`, or silence.
pub(crate) fn sound(tick: usize, x: Option<f32>) -> AudioBlock {
    let count = 640;
    let delay = x.map_or(0.0, |x| {
        let range_m = 0.12 / (0.5 * f64::from(1.3 * HEAD) / 300.0);
        let mouth = camera()
            .ray(hearsight_core::DistortedPixel::new(
                f64::from(x),
                f64::from(TOP + 0.98 * HEAD),
            ))
            .unwrap()
            .at(range_m);
        let [first, second] = [0.475, -0.475].map(|y| mouth.distance_m(WorldPoint::new(0.0, y, 1.4)));
        (first - second) / 343.0 * f64::from(RATE_HZ)
    });
    let source = |at: f64| {
        let (index, part) = (at.floor(), at - at.floor());
        let value = |index: f64| noise((index + 1e6) as usize, 3) as f64 / 128.0 - 1.0;
        value(index) * (1.0 - part) + value(index + 1.0) * part
    };
    let loud = |sample: usize| {
        if x.is_some() && (sample / 3200) % 4 != 3 {
            0.2
        } else {
            0.0
        }
    };
    let channel = |shift: f64, number: usize| {
        (0..count)
            .map(|k| {
                let sample = tick * count + k;
                let hiss = (noise(sample, 11 + number) as f64 / 128.0 - 1.0) * 1e-3;
                (loud(sample) * source(sample as f64 - shift) + hiss) as f32
            })
            .collect()
    };
    AudioBlock {
        time: Instant::ZERO + Span::of_samples((tick * count) as i64, RATE_HZ) - FRAME,
        rate_hz: RATE_HZ,
        channels: vec![channel(delay / 2.0, 0), channel(-delay / 2.0, 1)],
    }
}

pub(crate) fn moment(tick: usize, people: &[Person], speaker: Option<f32>, with_sound: bool) -> Moment {
    let frame = picture(tick, people);
    let audio = if with_sound {
        vec![Observed {
            new: true,
            data: sound(tick, speaker),
        }]
    } else {
        vec![]
    };
    Moment {
        tick: tick as u64,
        time: frame.time,
        video: vec![Observed {
            new: true,
            data: frame,
        }],
        audio,
        faults: vec![],
    }
}

pub(crate) const RED: [u8; 3] = [150, 40, 40];
pub(crate) const BLUE: [u8; 3] = [40, 60, 150];

/// Two people come in after two seconds, from both sides, and stay apart.
pub(crate) fn two(tick: usize) -> Vec<Person> {
    let Some(since) = tick.checked_sub(50) else {
        return vec![];
    };
    let walked = (since as f32 * 3.0).min(110.0);
    let sway = 4.0 * (since as f32 * 0.2).sin();
    vec![
        Person {
            x: -30.0 + walked + sway,
            shirt: RED,
        },
        Person {
            x: 350.0 - walked + sway,
            shirt: BLUE,
        },
    ]
}

pub(crate) fn run(system: &mut dyn System, ticks: std::ops::Range<usize>, with_sound: bool) -> Vec<Scene> {
    ticks
        .map(|tick| {
            let people = two(tick);
            // The red one speaks up to tick 200, then the blue one.
            let speaker = people.get(usize::from(tick >= 200)).map(|person| person.x);
            let mut scene = Scene::default();
            system.step(&moment(tick, &people, speaker, with_sound), &mut scene);
            scene
        })
        .collect()
}

pub(crate) fn nearest(scene: &Scene, x: f32) -> Option<(u64, f64)> {
    scene
        .tracks
        .iter()
        .map(|track| {
            let head = track.views[0].head;
            (track.id, (head.left + head.width / 2.0 - f64::from(x)).abs())
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
}
