//! How fast the closed-loop system is, and what its verifiers cost.
//!
//! ```text
//! closed_loop speed              times real time on one thread, decoding left out, for 1 to 6 people in 320x240 pictures
//!                                at 15 a second with the sound of two microphones, faces searched every 10 s and every 1 s,
//!                                and how linear the time is in people
//! closed_loop steps PEOPLE N     follows so many people through the measured pictures N times: for a profiler
//! closed_loop verifier NAME N    lets a verifier (contour, contrast, curve, likeness, or none) judge 200 hypotheses of each of N
//!                                pictures: for `valgrind --tool=callgrind`; the counts of a verifier and of none with
//!                                the same N, apart from each other, are those of N times 200 hypotheses
//! ```

use hearsight_benches::Failure;
use hearsight_core::camera::{Camera, CameraModel, Pinhole};
use hearsight_core::moment::{Moment, Observed};
use hearsight_core::record::Scene;
use hearsight_core::room::{ArraySensor, CameraSensor, Room};
use hearsight_core::{AudioBlock, Instant, Pose, Rectangle, Span, VideoFrame, WorldPoint};
use hearsight_filter::{generator, standard_normal};
use hearsight_systems::build;
use hearsight_tracking::belief::Appearance;
use hearsight_tracking::body::{Part, UprightEllipse};
use hearsight_tracking::cues::{
    ColourCue, ContourCue, ContrastCue, Cue, CurveCue, CurveGeometry, Hypotheses,
};
use hearsight_tracking::percepts::{ArrayPercepts, ArraySettings, CameraPercepts, CameraSettings, Weighting};
use hearsight_vision::histogram::Histogram;
use rustix::time::{ClockId, clock_gettime};
use serde_json::json;

const WIDTH: usize = 320;
const HEIGHT: usize = 240;
/// Wide enough for twelve people side by side.
const WIDE: usize = 2 * WIDTH;
const RATE_HZ: u32 = 16_000;
const PICTURES_S: usize = 15;
/// Pictures in which people appear and become tracks, and those that are measured.
const FIRST: usize = 300;
const MEASURED: usize = 150;
/// From this picture on there are people, and so many pictures each walks to a place.
const APPEAR: usize = 30;
const WALK: usize = 70;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["speed"] => speed(),
        ["steps", people, count] => steps(people.parse()?, count.parse()?),
        ["verifier", name, count] => verifier(name, count.parse()?),
        _ => Err("give `speed`, `steps PEOPLE N`, or `verifier NAME N`".into()),
    }
}

/// A number from 0 to 255 that depends on nothing but its arguments.
fn noise(a: usize, b: usize) -> u32 {
    let mut x = (a as u32).wrapping_mul(0x9E37_79B9) ^ (b as u32).wrapping_mul(0x85EB_CA6B);
    x ^= x >> 15;
    x = x.wrapping_mul(0x2C1B_3C6D);
    (x >> 16) & 0xFF
}

fn time_of(picture: usize) -> Instant {
    Instant::ZERO + Span::from_seconds(picture as f64 / PICTURES_S as f64)
}

/// The picture in which a person comes in, four at a time: only so many are looked at before they are tracks.
fn appears(person: usize) -> usize {
    APPEAR + WALK * (person / 4)
}

/// Where the middle of a person's head is, pixels: in a row.
fn place(person: usize, picture: usize) -> [f32; 2] {
    let sway = 3.0 * (0.3 * picture as f32 + person as f32).sin();
    // They walk to their places: who only stands there may be a coat.
    let to_go = (appears(person) + WALK).saturating_sub(picture) as f32;
    [32.0 + 52.0 * person as f32 + sway - 0.8 * to_go, 45.0]
}

fn paint(frame: &mut VideoFrame, [left, top, width, height]: [f32; 4], colour: [u8; 3], round: bool) {
    for y in top.max(0.0) as usize..((top + height).max(0.0) as usize).min(frame.height) {
        for x in left.max(0.0) as usize..((left + width).max(0.0) as usize).min(frame.width) {
            let across = (x as f32 - left - 0.5 * width) / width * 2.0;
            let down = (y as f32 - top - 0.5 * height) / height * 2.0;
            if !round || across * across + down * down <= 1.0 {
                let at = 3 * (y * frame.width + x);
                for (value, own) in frame.rgb[at..at + 3].iter_mut().zip(colour) {
                    *value = own.saturating_add((noise(x, y) % 9) as u8);
                }
            }
        }
    }
}

/// A picture that is `width` pixels wide, of so many people.
fn picture(number: usize, people: usize, width: usize) -> VideoFrame {
    let mut frame = VideoFrame {
        time: time_of(number),
        number: number as u64 + 1,
        width,
        height: HEIGHT,
        rgb: (0..width * HEIGHT)
            .flat_map(|i| {
                [200, 185, 155].map(|wall| (wall + noise(i, number) % 7 + noise(i, 7919) % 9) as u8)
            })
            .collect(),
        luma: Vec::new(),
    };
    for person in (0..people).filter(|person| number >= appears(*person)) {
        let [x, y] = place(person, number);
        let shirt = [40 + 90 * (person % 2) as u8, 60, 150 - 10 * person as u8];
        let head = 19.0;
        paint(&mut frame, [x - 19.0, y + 16.0, 38.0, 60.0], shirt, false);
        paint(&mut frame, [x - 6.0, y + 9.0, 12.0, 12.0], [185, 130, 100], false);
        paint(
            &mut frame,
            [x - 0.5 * head, y - 12.0, head, 1.3 * head],
            [185, 130, 100],
            true,
        );
        paint(
            &mut frame,
            [x - 0.5 * head, y - 12.0, head, 0.5 * head],
            [40, 30, 25],
            true,
        );
    }
    frame.luma = frame
        .rgb
        .chunks_exact(3)
        .map(|pixel| {
            ((u32::from(pixel[0]) * 77 + u32::from(pixel[1]) * 150 + u32::from(pixel[2]) * 29) >> 8) as u8
        })
        .collect();
    frame
}

fn camera(width: usize) -> Result<Camera, Failure> {
    Ok(Camera {
        model: CameraModel::Pinhole(Pinhole::ideal(
            [300.0, 300.0],
            [0.5 * (width as f64 - 1.0), 119.5],
        )?),
        pose: Pose::looking_at(WorldPoint::new(0.0, 0.0, 1.4), WorldPoint::new(3.0, 0.0, 1.4))
            .ok_or("no pose")?,
        width,
        height: HEIGHT,
    })
}

fn room(width: usize) -> Result<Room, Failure> {
    Ok(Room {
        cameras: vec![CameraSensor {
            name: "cam".into(),
            width,
            height: HEIGHT,
            interval: Span::from_seconds(1.0 / PICTURES_S as f64),
            calibration: Some(camera(width)?),
        }],
        arrays: vec![ArraySensor {
            name: "pair".into(),
            rate_hz: RATE_HZ,
            channels: 2,
            microphones: [0.475, -0.475].map(|y| WorldPoint::new(0.0, y, 1.4)).into(),
            camera: Some(0),
        }],
        speed_of_sound_m_s: 343.0,
    })
}

/// The sound of one picture: bursts from the left, six samples sooner at the first microphone.
fn sound(number: usize) -> AudioBlock {
    let sample = |picture: usize| picture * RATE_HZ as usize / PICTURES_S;
    let (from, until) = (sample(number), sample(number + 1));
    let channel = |late: usize, microphone: usize| {
        (from..until)
            .map(|k| {
                let loud = if number > APPEAR && (k / 3200) % 4 != 3 {
                    0.2
                } else {
                    0.0
                };
                let value = |at: usize, of: usize| noise(at, of) as f32 / 128.0 - 1.0;
                loud * value(k + 100 - late, 3) + 1e-3 * value(k, 11 + microphone)
            })
            .collect()
    };
    AudioBlock {
        time: Instant::ZERO + Span::of_samples(from as i64, RATE_HZ),
        rate_hz: RATE_HZ,
        channels: vec![channel(0, 0), channel(6, 1)],
    }
}

fn moment(number: usize, people: usize, width: usize) -> Moment {
    Moment {
        tick: number as u64,
        time: time_of(number),
        video: vec![Observed {
            new: true,
            data: picture(number, people, width),
        }],
        audio: vec![Observed {
            new: true,
            data: sound(number),
        }],
        faults: Vec::new(),
    }
}

fn processor_s() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// A system's saved state when so many people have become tracks.
fn born(people: usize, room: &Room) -> Result<Vec<u8>, Failure> {
    // People are born from change, and then followed by the paper's system, which does not look for it.
    let faces = json!({ "cascades": [] });
    let given = json!({ "changes": true, "faces": faces });
    let mut system = build("closed-loop", &given, room, 1)?;
    let mut scene = Scene::default();
    for number in 0..FIRST {
        system.step(&moment(number, people, room.cameras[0].width), &mut scene);
    }
    Ok(system.save()?)
}

fn measured(people: usize, width: usize) -> Vec<Moment> {
    (FIRST..FIRST + MEASURED)
        .map(|number| moment(number, people, width))
        .collect()
}

fn steps(people: usize, count: usize) -> Result<(), Failure> {
    let room = room(WIDTH)?;
    let saved = born(people, &room)?;
    let moments = measured(people, WIDTH);
    let mut scene = Scene::default();
    for _ in 0..count {
        let given = json!({ "changes": false, "faces": { "period_s": 10.0 } });
        let mut system = build("closed-loop", &given, &room, 1)?;
        system.restore(&saved)?;
        let begin = processor_s();
        for moment in &moments {
            system.step(moment, &mut scene);
        }
        let each_ms = 1e3 * (processor_s() - begin) / moments.len() as f64;
        println!("{} tracks, {each_ms:.3} ms a picture", scene.tracks.len());
    }
    Ok(())
}

fn speed() -> Result<(), Failure> {
    println!("people  tracks  seconds/picture (10 s)  times real time  (1 s)     times real time");
    for people in 1..=6 {
        let (tracks, seconds) = timed(people, WIDTH, &[10.0, 1.0])?;
        let factor = |seconds: f64| 1.0 / (PICTURES_S as f64 * seconds);
        println!(
            "{people:>6}  {tracks:>6}  {:>22.6}  {:>15.1}  {:>8.6}  {:>15.1}",
            seconds[0],
            factor(seconds[0]),
            seconds[1],
            factor(seconds[1])
        );
    }
    println!("a row of people in pictures of {WIDE}x{HEIGHT}\npeople  tracks  seconds/picture (10 s)");
    let mut points = Vec::new();
    for people in 1..=12 {
        let (tracks, seconds) = timed(people, WIDE, &[10.0])?;
        println!("{people:>6}  {tracks:>6}  {:>22.6}", seconds[0]);
        points.push([tracks as f64, seconds[0]]);
    }
    println!("linear in tracks: R^2 {:.4}", determination(&points));
    Ok(())
}

/// How many tracks there are at the end, and the seconds a picture with faces searched after each of the periods.
fn timed(people: usize, width: usize, periods_s: &[f64]) -> Result<(usize, Vec<f64>), Failure> {
    let room = room(width)?;
    let saved = born(people, &room)?;
    let moments = measured(people, width);
    let mut scene = Scene::default();
    let mut seconds = Vec::new();
    for period_s in periods_s {
        let given = json!({ "changes": false, "faces": { "period_s": period_s } });
        let mut system = build("closed-loop", &given, &room, 1)?;
        system.restore(&saved)?;
        let begin = processor_s();
        for moment in &moments {
            system.step(moment, &mut scene);
        }
        seconds.push((processor_s() - begin) / MEASURED as f64);
    }
    Ok((scene.tracks.len(), seconds))
}

/// How much of the variance a straight line explains, 0 to 1.
fn determination(points: &[[f64; 2]]) -> f64 {
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / count;
    let (x, y) = (mean(0), mean(1));
    let sum = |a: usize, b: usize| {
        let centred = |point: &[f64; 2], axis: usize| point[axis] - if axis == 0 { x } else { y };
        points
            .iter()
            .map(|point| centred(point, a) * centred(point, b))
            .sum::<f64>()
    };
    sum(0, 1).powi(2) / (sum(0, 0) * sum(1, 1)).max(f64::MIN_POSITIVE)
}

fn verifier(name: &str, count: usize) -> Result<(), Failure> {
    let settings = CameraSettings {
        changes: false,
        outlines: true,
        ..CameraSettings::default()
    };
    let mut seen = CameraPercepts::new(settings)?;
    let listened = ArraySettings {
        weighting: Weighting::MaximumLikelihood { reverberation: 0.3 },
        bands: false,
        onset_filter: false,
        ..ArraySettings::default()
    };
    let room = room(WIDTH)?;
    let mut heard = ArrayPercepts::new(listened, &room.arrays[0], room.speed_of_sound_m_s)?;
    // To the middle of a burst.
    for number in 0..FIRST + 3 {
        heard.hear(Some(&sound(number)));
    }
    if !heard.has_onset() {
        return Err("nothing is heard".into());
    }
    let shown = picture(FIRST, 6, WIDTH);
    let [x, y] = place(1, FIRST);
    // As many as one person has, spread about as widely.
    let mut generator = generator(1, "hypotheses", 0);
    let regions: Vec<Rectangle> = (0..200)
        .map(|_| {
            let [across, down, larger] =
                [3.0, 3.0, 0.8].map(|px| px * standard_normal(&mut generator) as f32);
            let half = 12.0 + larger;
            UprightEllipse::bounds(x + across, y + down, half)
        })
        .collect();
    let sounds: Vec<Option<WorldPoint>> = (0..200)
        .map(|k| Some(WorldPoint::new(3.0, 0.5 - 0.005 * f64::from(k), 1.5)))
        .collect();
    let cue: Option<Box<dyn Cue>> = match name {
        "contour" => Some(Box::new(ContourCue)),
        "contrast" => Some(Box::new(ContrastCue)),
        "likeness" => Some(Box::new(ColourCue::new(Part::Head))),
        "curve" => Some(Box::new(CurveCue::new(CurveGeometry::World))),
        "none" => None,
        other => return Err(format!("there is no verifier {other}").into()),
    };
    let mut appearance = Appearance::default();
    let mut colours = Histogram::default();
    seen.see(&shown);
    seen.histogram(&regions[0], &mut colours);
    appearance.learn(Part::Head, &colours, 1.0);
    let mut scores = vec![0.0; regions.len()];
    let mut sum = 0.0;
    for _ in 0..count {
        // Anew every time: what hypotheses share is made once a picture.
        seen.see(&shown);
        if let Some(cue) = &cue {
            cue.score(
                &Hypotheses {
                    regions: &regions,
                    sounds: &sounds,
                    appearance: &appearance,
                    detections: &[],
                    speaking: 0.5,
                    camera: &seen,
                    array: Some(&heard),
                },
                &mut scores,
            );
        }
        sum += scores.iter().sum::<f32>();
    }
    println!("{name}: {sum}");
    Ok(())
}
