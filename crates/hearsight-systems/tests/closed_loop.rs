//! The closed-loop system on a drawn room: people are followed and heard, every ablation runs, runs are reproducible, and
//! what is broken (pictures, microphones, numbers) ends neither run nor track for good.

#![expect(clippy::unwrap_used, reason = "a test that cannot make its input should stop")]

mod drawn_room;

use drawn_room::{HEIGHT, RED, TOP, WIDTH, moment, nearest, paint, room, run, two};
use hearsight_core::Moment;
use hearsight_core::record::Scene;
use hearsight_systems::{System, build};
use serde_json::{Value, json};

/// Heads in this room have no faces: people are born from changed regions.
fn parameters(more: Value) -> Value {
    let mut all = json!({ "changes": true, "faces": { "cascades": [] } });
    for (key, value) in more.as_object().unwrap() {
        all[key] = value.clone();
    }
    all
}

fn system(more: Value, with_sound: bool) -> Box<dyn System> {
    build("closed-loop", &parameters(more), &room(with_sound), 1).unwrap()
}

fn assert_finite(scene: &Scene) {
    for track in &scene.tracks {
        let head = track.views[0].head;
        let numbers = [
            head.left,
            head.top,
            head.width,
            head.height,
            track.existence,
            track.effective_sample_size,
        ];
        assert!(numbers.iter().all(|value| value.is_finite()), "{track:?}");
    }
    assert!(scene.nobody_probability.is_none_or(f64::is_finite));
}

/// Greatest distance of a person's head from the nearest track, over ticks; the number of ticks without enough tracks.
fn worst(scenes: &[Scene], first: usize) -> (f64, usize) {
    let (mut worst, mut missing) = (0.0_f64, 0);
    for (offset, scene) in scenes.iter().enumerate() {
        for person in two(first + offset) {
            match nearest(scene, person.x) {
                Some((_, distance)) if distance < 40.0 => worst = worst.max(distance),
                _ => missing += 1,
            }
        }
    }
    (worst, missing)
}

#[test]
fn two_people_are_followed_and_the_one_who_speaks_is_marked() {
    let mut system = system(json!({}), true);
    let scenes = run(system.as_mut(), 0..300, true);
    let (off, missing) = worst(&scenes[110..], 110);
    assert!(off < 10.0 && missing == 0, "{off} px, {missing} missing");
    let judged: Vec<usize> = (120..200).chain(235..300).collect();
    let right = judged
        .iter()
        .filter(|tick| {
            let talker = &two(**tick)[usize::from(**tick >= 200)];
            nearest(&scenes[**tick], talker.x).map(|(identity, _)| identity) == scenes[**tick].speaker
        })
        .count();
    assert!(right * 10 >= judged.len() * 8, "{right} of {}", judged.len());
    let bars = system.bars(0);
    let talker = two(299)[1].x;
    assert!(
        bars.fused.is_some_and(|column| (column - talker).abs() < 10.0),
        "{bars:?}"
    );
}

#[test]
fn every_ablation_runs_and_stays_finite() {
    for more in [
        json!({ "fuser": { "trackers": { "colour": false, "sound": false } }, "verifiers": { "colour": { "enabled": false }, "sound": { "enabled": false } } }),
        json!({ "fuser": { "trackers": { "contour": false, "sound": false } }, "verifiers": { "contour": { "enabled": false }, "sound": { "enabled": false } } }),
        json!({ "fuser": { "trackers": { "contour": false, "colour": false } } }),
        json!({ "fuser": { "proposal": "prior" }, "particles": 200 }),
        json!({ "fuser": { "weights": "marginal" } }),
        json!({ "fuser": { "weights": "printed" } }),
        json!({ "fuser": { "feedback": { "enabled": false } } }),
        json!({ "sound_rule": "pair" }),
        json!({ "sound_rule": "printed" }),
    ] {
        let mut system = system(more.clone(), true);
        let scenes = run(system.as_mut(), 40..150, true);
        scenes.iter().for_each(assert_finite);
        assert!(!scenes[100].tracks.is_empty(), "{more}");
    }
}

#[test]
fn a_saved_run_goes_on_with_the_same_bytes() {
    let mut whole = system(json!({}), true);
    let expected = run(whole.as_mut(), 0..150, true);
    let mut first = system(json!({}), true);
    run(first.as_mut(), 0..110, true);
    let saved = first.save().unwrap();
    let mut second = system(json!({}), true);
    second.restore(&saved).unwrap();
    let rest = run(second.as_mut(), 110..150, true);
    let bytes = |scenes: &[Scene]| serde_json::to_string(scenes).unwrap();
    assert_eq!(bytes(&rest), bytes(&expected[110..]));
    assert_eq!(expected[149].tracks.len(), 2, "the test must cover tracks");
    assert!(second.restore(&saved[..saved.len() / 2]).is_err());
}

/// Runs with something broken during some ticks, then whole again; the tracks must be there in the end.
fn survives(what: &str, broken: std::ops::Range<usize>, mut breaks: impl FnMut(&mut Moment)) {
    let mut system = system(json!({}), true);
    run(system.as_mut(), 0..broken.start, true);
    let mut scene = Scene::default();
    for tick in broken.clone() {
        let people = two(tick);
        let mut moment = moment(tick, &people, Some(people[0].x), true);
        breaks(&mut moment);
        system.step(&moment, &mut scene);
        assert_finite(&scene);
    }
    let scenes = run(system.as_mut(), broken.end..broken.end + 90, true);
    scenes.iter().for_each(assert_finite);
    let (off, missing) = worst(&scenes[70..], broken.end + 70);
    assert!(off < 12.0 && missing == 0, "{what}: {off} px, {missing} missing");
}

#[test]
fn a_picture_of_one_colour_is_survived() {
    survives("grey", 120..126, |moment| {
        moment.video[0].data.rgb.fill(127);
        moment.video[0].data.luma.fill(127);
    });
}

#[test]
fn broken_microphones_are_survived() {
    survives("dead", 120..150, |moment| {
        moment.audio[0].data.channels[1].fill(0.0)
    });
    survives("silent", 120..150, |moment| {
        moment.audio[0]
            .data
            .channels
            .iter_mut()
            .for_each(|channel| channel.fill(0.0));
    });
    survives("inverted", 120..150, |moment| {
        moment.audio[0].data.channels[0]
            .iter_mut()
            .for_each(|sample| *sample = -*sample);
    });
    survives("swapped", 120..150, |moment| {
        moment.audio[0].data.channels.swap(0, 1)
    });
    survives("not numbers", 120..150, |moment| {
        moment.audio[0].data.channels[0].fill(f32::NAN)
    });
}

/// One person whose head is so wide, pixels, before the wall.
fn one_of_width(tick: usize, head: f32, x: f32) -> Moment {
    let mut moment = moment(tick, &[], None, false);
    let frame = &mut moment.video[0].data;
    let top = TOP;
    let mut part = |left: f32, top: f32, width: f32, height: f32, colour, round| {
        paint(frame, left, top, width, height, colour, round);
    };
    part(
        x - 1.05 * head,
        top + 1.45 * head,
        2.1 * head,
        4.0 * head,
        RED,
        false,
    );
    part(
        x - 0.3 * head,
        top + head,
        0.6 * head,
        0.8 * head,
        [190, 130, 100],
        false,
    );
    part(x - 0.5 * head, top, head, 1.3 * head, [190, 130, 100], true);
    part(x - 0.5 * head, top, head, 0.5 * head, [40, 30, 25], true);
    moment
}

/// Follows somebody who goes away until the head is four pixels high, and comes back: the smallest ellipse on the way. The
/// track must be there in the end.
fn shrinks_and_comes_back(more: Value) -> f64 {
    let mut system = system(more, false);
    let mut scene = Scene::default();
    let mut smallest = f64::INFINITY;
    for tick in 0..420_usize {
        let head = match tick {
            0..50 => 0.0,
            50..120 => 28.0,
            120..220 => 28.0 - 0.25 * (tick - 120) as f32,
            220..260 => 3.0,
            260..360 => 3.0 + 0.25 * (tick - 260) as f32,
            _ => 28.0,
        };
        let moment = if tick < 50 {
            moment(tick, &[], None, false)
        } else {
            // Comes in from the left.
            one_of_width(tick, head, (3.0 * (tick - 50) as f32 - 30.0).min(160.0))
        };
        system.step(&moment, &mut scene);
        assert_finite(&scene);
        if tick == 119 {
            assert_eq!(scene.tracks.len(), 1, "{:?}", scene.tracks);
        }
        for track in &scene.tracks {
            smallest = smallest.min(track.views[0].head.height);
        }
    }
    assert_eq!(scene.tracks.len(), 1, "{:?}", scene.tracks);
    let head = scene.tracks[0].views[0].head;
    let middle = head.left + 0.5 * head.width;
    assert!(
        (middle - 160.0).abs() < 5.0 && (28.0..46.0).contains(&head.height),
        "{head:?}"
    );
    smallest
}

#[test]
fn whoever_goes_far_away_has_a_track_again_on_coming_back() {
    let smallest = shrinks_and_comes_back(json!({}));
    // Below twelve pixels a head is denied by default, and its track ends.
    assert!(smallest < 12.0, "{smallest} px");
}

#[test]
fn an_ellipse_that_shrinks_to_a_few_pixels_comes_back() {
    // Sizes that may change as fast as this head's do, so that the ellipse shrinks as far as the head.
    let smallest = shrinks_and_comes_back(json!({ "fuser": { "motion": { "growth_per_s": 0.4 } } }));
    assert!((2.0..6.0).contains(&smallest), "{smallest} px");
}

#[test]
fn a_head_that_leaves_the_picture_takes_its_track_along() {
    let mut system = system(json!({}), false);
    run(system.as_mut(), 0..130, false);
    let mut scene = Scene::default();
    for tick in 130..230 {
        let mut people = two(129);
        // The first one walks out on the left.
        people[0].x -= 3.0 * (tick - 129) as f32;
        system.step(&moment(tick, &people, None, false), &mut scene);
        assert_finite(&scene);
    }
    assert_eq!(scene.tracks.len(), 1, "{:?}", scene.tracks);
    let (_, distance) = nearest(&scene, two(129)[1].x).unwrap();
    assert!(distance < 10.0);
    assert!(scene.tracks[0].views[0].head.width < WIDTH as f64 && HEIGHT > 0);
}

#[test]
fn wrong_parameters_and_rooms_are_named() {
    let error = |parameters: Value| {
        build("closed-loop", &parameters, &room(true), 1)
            .err()
            .map(|error| error.to_string())
            .unwrap_or_default()
    };
    assert!(error(json!({ "fuser": { "wieghts": "marginal" } })).contains("wieghts"));
    assert!(error(json!({ "fuser": { "weights": "guessed" } })).contains("guessed"));
    assert!(error(json!({ "fuser": { "contour": { "edges": { "lines": 1 } } } })).contains("lines"));
    assert!(error(json!({ "fuser": { "shares": { "prior": -1.0 } } })).contains("shares.prior"));
    assert!(error(json!({ "faces": { "cascades": [{ "file": "no/such.xml" }] } })).contains("no/such.xml"));
    let mut uncalibrated = room(true);
    uncalibrated.cameras[0].calibration = None;
    let pair = build(
        "closed-loop",
        &parameters(json!({ "sound_rule": "pair" })),
        &uncalibrated,
        1,
    );
    assert!(pair.err().unwrap().to_string().contains("calibration"));
}
