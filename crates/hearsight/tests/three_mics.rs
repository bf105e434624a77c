//! The whole three-mics system in a simulated room, from pictures and samples to the place of the speaker: two people talk
//! in turn before three microphones and a camera in the corner.

#![expect(clippy::unwrap_used, reason = "a test that cannot make its input should stop")]

use hearsight::core::source::{AudioSource, VideoSource};
use hearsight::core::truth::{PersonTruth, TruthRecord};
use hearsight::engine::config::{parse, resolve};
use hearsight::sim::scenario::from_text;
use hearsight::sim::simulation::{Files, Simulation};
use hearsight::{Engine, Scene};
use std::path::Path;

const CASCADE: &str = "/usr/share/opencv4/haarcascades/haarcascade_frontalface_alt2.xml";

const SCENE: &str = r#"
name = "two"
seconds = 8
seed = 7
[room]
size = [4.5, 4, 2.6]
t60 = 0.3
[[person]]
name = "anna"
at = [1.6, 2.4]
facing = [1.2, 0.2]
turns = [[1.6, 3.8]]
[[person]]
name = "ben"
at = [2.9, 2.2]
facing = [1.8, 0.2]
turns = [[5.2, 7.4]]
[[noise]]
kind = "fan"
at = [4.2, 3.7, 2.2]
snr = 20
[[camera]]
name = "corner"
size = [800, 600]
rate = 10
focal = 560
at = [0.3, 0.2, 1.7]
look_at = [2.3, 2.3, 1.5]
[[array]]
name = "set"
rate = 24000
shape = "line"
count = 3
spacing = 0.2
at = [2.6, 0.1, 1.0]
facing = 90
camera = "corner"
[system]
name = "three-mics"
[system.three-mics]
room = { low_m = [0.0, 0.0, 0.0], high_m = [4.5, 4.0, 2.6] }
vision = { smallest_px = 24, largest_px = 80 }
association = { face_width_m = [0.13, 0.2] }
place = { walk_m = 0.3, box_deviation = 0.06 }
"#;

/// What the system says of every tick, beside what was so.
fn followed() -> Vec<(Scene, TruthRecord)> {
    let simulation = Simulation::new(from_text("two.toml", SCENE, &Vec::new()).unwrap()).unwrap();
    let text = simulation.room_file(&Files::default());
    let raw = parse("room.toml", &text, &vec![]).unwrap();
    let room = resolve(&raw, "room.toml", &text, Path::new(""), "room").unwrap();
    let cameras: Vec<Box<dyn VideoSource>> = vec![Box::new(simulation.camera(0))];
    let arrays: Vec<Box<dyn AudioSource>> = vec![Box::new(simulation.array(0).unwrap())];
    let mut engine = Engine::open_with_sources(room, cameras, arrays).unwrap();
    let mut followed = Vec::new();
    while let Some(scene) = engine.step() {
        if scene.tick < simulation.ticks() {
            followed.push((scene.clone(), simulation.truth(scene.tick)));
        }
    }
    followed
}

fn apart_m(place: [f64; 3], person: &PersonTruth) -> f64 {
    let mouth = person.mouth_m.unwrap();
    let squares = place.iter().zip(mouth).map(|(one, other)| (one - other).powi(2));
    squares.sum::<f64>().sqrt()
}

#[test]
fn whoever_speaks_is_marked_where_they_are_and_nobody_in_silence() {
    if !Path::new(CASCADE).exists() {
        eprintln!("skipped: {CASCADE} is missing (Debian's opencv-data has it)");
        return;
    }
    let followed = followed();
    assert!(followed.len() >= 75, "{}", followed.len());
    let within = |from_s: f64, until_s: f64| {
        let during = move |scene: &Scene| (from_s..until_s).contains(&scene.time_s);
        followed.iter().filter(move |(scene, _)| during(scene))
    };
    // Between the turns the last echo has died away half a second after the last word.
    for (from_s, until_s) in [(0.6, 1.5), (4.5, 5.2)] {
        let (mut marked, mut ticks) = (0, 0);
        for (scene, truth) in within(from_s, until_s) {
            assert!(truth.people.iter().all(|person| !person.speaking));
            ticks += 1;
            marked += usize::from(scene.speaker.is_some());
        }
        assert_eq!(marked, 0, "of {ticks} from {from_s} s to {until_s} s");
    }
    // A turn is believed after half a second.
    let mut speakers = Vec::new();
    for (from_s, until_s, name) in [(2.1, 3.7, "anna"), (5.7, 7.3, "ben")] {
        let (mut right, mut ticks, mut errors_m) = (0, 0, Vec::new());
        for (scene, truth) in within(from_s, until_s) {
            ticks += 1;
            let talker = truth.people.iter().find(|person| person.name == name).unwrap();
            let Some(track) = scene.tracks.iter().find(|track| Some(track.id) == scene.speaker) else {
                continue;
            };
            let place = track.position_m.unwrap();
            let nearest = truth
                .people
                .iter()
                .min_by(|one, other| apart_m(place, one).total_cmp(&apart_m(place, other)));
            if nearest.unwrap().name == name {
                right += 1;
                errors_m.push(apart_m(place, talker));
                speakers.push(track.id);
            }
        }
        errors_m.sort_by(f64::total_cmp);
        println!("{name}: {right} of {ticks}, errors {errors_m:.2?} m");
        assert!(right * 10 >= ticks * 8, "{name}: {right} of {ticks}");
        let median_m = errors_m[errors_m.len() / 2];
        assert!(median_m < 0.2, "{name}: {median_m} m");
    }
    speakers.dedup();
    assert_eq!(speakers.len(), 2, "each has one track: {speakers:?}");
}
