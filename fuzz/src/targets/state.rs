//! Saved states of systems.

use super::{Target, Verdict};
use hearsight_core::finite::is_finite;
use hearsight_core::moment::Observed;
use hearsight_core::record::Scene;
use hearsight_core::room::{ArraySensor, CameraSensor, Room};
use hearsight_core::{AudioBlock, Instant, Moment, Span, VideoFrame, WorldPoint};
use hearsight_systems::{System, SystemError, build};
use serde_json::{Value, json};

const WIDTH: usize = 40;
const HEIGHT: usize = 32;
const RATE_HZ: u32 = 16_000;
const INTERVAL_S: f64 = 0.04;

pub(super) const TARGET: Target = Target {
    name: "state",
    meaning: "A saved state of the system stac; what is refused changes nothing, what is taken over can go on.",
    text: false,
    words: &[],
    longest: 64 << 10,
    seeds: || {
        let Ok(mut system) = small_system() else {
            return Vec::new();
        };
        let mut states = Vec::new();
        for number in 0..40 {
            if [0, 1, 4, 20].contains(&number) {
                states.extend(system.save());
            }
            system.step(&moment(number), &mut Scene::default());
        }
        states.extend(system.save());
        states
    },
    open: || {
        let Ok(mut system) = small_system() else {
            return Box::new(|_| Verdict::Broken("no system".to_owned()));
        };
        for number in 0..20 {
            system.step(&moment(number), &mut Scene::default());
        }
        let sound = system.save();
        Box::new(move |bytes| {
            let Ok(sound) = &sound else {
                return Verdict::Broken("it cannot be saved".to_owned());
            };
            let verdict = restore(&mut *system, sound, bytes);
            match system.restore(sound) {
                Ok(()) => verdict,
                Err(error) => Verdict::Broken(format!("a sound state is refused: {error}")),
            }
        })
    },
};

fn restore(system: &mut dyn System, before: &[u8], bytes: &[u8]) -> Verdict {
    if let Err(error) = system.restore(bytes) {
        return match system.save() {
            Ok(after) if after == before => Verdict::Refused(error.to_string()),
            _ => Verdict::Broken(format!("a refused state changed the system: {error}")),
        };
    }
    let mut scene = Scene::default();
    for number in 20..22 {
        system.step(&moment(number), &mut scene);
    }
    if !is_finite(&scene) {
        return Verdict::Broken("a number in the scene is not finite".to_owned());
    }
    if system.save().is_err() {
        return Verdict::Broken("it cannot be saved again".to_owned());
    }
    Verdict::Read(format!(
        "{} tracks, {} sounds",
        scene.tracks.len(),
        scene.sounds.len()
    ))
}

/// One small camera between two microphones.
pub(super) fn room() -> Room {
    let interval = Span::from_seconds(INTERVAL_S);
    let camera = CameraSensor {
        name: "front".into(),
        width: WIDTH,
        height: HEIGHT,
        interval,
        calibration: None,
    };
    let array = ArraySensor {
        name: "pair".into(),
        rate_hz: RATE_HZ,
        channels: 2,
        microphones: vec![WorldPoint::new(-0.2, 0.0, 1.4), WorldPoint::new(0.2, 0.0, 1.4)],
        camera: Some(0),
    };
    Room {
        cameras: vec![camera],
        arrays: vec![array],
        speed_of_sound_m_s: 343.0,
    }
}

/// Parameters that keep states small, steps short and people in small pictures visible.
pub(super) fn parameters() -> Value {
    json!({
        "particles": 8,
        "audio": { "frame_s": 0.032 },
        "vision": {
            "background": {
                "learning_secs": 0.0,
                "learning_pictures": 1,
                "clean": { "median": 1, "dilation_width": 1, "dilation_height": 1 },
            },
            "heads": { "smallest_px": 5.0 },
            "histogram": { "red": 2, "green": 2, "blue": 2 },
        },
    })
}

fn small_system() -> Result<Box<dyn System>, SystemError> {
    build("stac", &parameters(), &room(), 1)
}

/// A moment of a small room: from the sixth on somebody walks through the picture, and a noise comes with them.
pub(super) fn moment(number: usize) -> Moment {
    let time = Instant::from_seconds(INTERVAL_S * number as f64);
    let samples = (INTERVAL_S * f64::from(RATE_HZ)) as usize;
    let noise = |at: usize| ((at.wrapping_mul(2_654_435_761) >> 7) % 2001) as f32 / 1000.0 - 1.0;
    let loud = if number % 20 < 10 { 0.3 } else { 0.001 };
    let channel = |lead: usize| {
        (0..samples)
            .map(|at| loud * noise(number * samples + at + lead))
            .collect()
    };
    let video = VideoFrame {
        time,
        number: number as u64 + 1,
        width: WIDTH,
        height: HEIGHT,
        rgb: (0..WIDTH * HEIGHT)
            .flat_map(|at| colour(number, at % WIDTH, at / WIDTH))
            .collect(),
        luma: (0..WIDTH * HEIGHT)
            .map(|at| colour(number, at % WIDTH, at / WIDTH)[0])
            .collect(),
    };
    let audio = AudioBlock {
        time,
        rate_hz: RATE_HZ,
        channels: vec![channel(0), channel(3)],
    };
    Moment {
        tick: number as u64,
        time,
        video: vec![Observed {
            new: true,
            data: video,
        }],
        audio: vec![Observed {
            new: true,
            data: audio,
        }],
        faults: Vec::new(),
    }
}

fn colour(number: usize, x: usize, y: usize) -> [u8; 3] {
    let middle = 12.0 + 0.2 * number as f32;
    let (dx, dy) = ((x as f32 - middle).abs(), y as f32 - 6.0);
    if number < 6 || dy < 0.0 {
        [130, 130, 120]
    } else if dy < 8.0 && dx < 3.5 {
        [220, 60, 40]
    } else if dy >= 8.0 && dx < 7.5 {
        [30, 40, 220]
    } else {
        [130, 130, 120]
    }
}
