//! The stac system on a drawn room: people are found, numbered, kept apart, heard and known again; runs are
//! reproducible, and saved runs go on with the same bytes.

#![expect(clippy::unwrap_used, reason = "a test that cannot make its input should stop")]

mod drawn_room;

use drawn_room::{moment, nearest, room, run, two};
use hearsight_core::record::Scene;
use hearsight_core::room::Room;
use hearsight_systems::build;
use serde_json::json;

#[test]
fn two_people_get_one_track_each_and_keep_it() {
    let mut system = build("stac", &json!({}), &room(false), 1).unwrap();
    let scenes = run(system.as_mut(), 0..240, false);
    assert!(
        scenes[..50].iter().all(|scene| scene.tracks.is_empty()),
        "nobody is there yet"
    );
    let settled = &scenes[100..];
    let identities: Vec<u64> = settled[0].tracks.iter().map(|track| track.id).collect();
    assert_eq!(identities.len(), 2, "{:?}", settled[0].tracks);
    for (offset, scene) in settled.iter().enumerate() {
        let now: Vec<u64> = scene.tracks.iter().map(|track| track.id).collect();
        assert_eq!(now, identities, "tick {}", 100 + offset);
        for person in two(100 + offset) {
            let (_, distance) = nearest(scene, person.x).unwrap();
            assert!(
                distance < 10.0,
                "tick {}: {distance} px from {}",
                100 + offset,
                person.x
            );
        }
    }
}

#[test]
fn the_one_who_speaks_is_marked() {
    let mut system = build("stac", &json!({}), &room(true), 1).unwrap();
    let scenes = run(system.as_mut(), 0..300, true);
    let mut right = 0;
    let judged: Vec<usize> = (110..200).chain(225..300).collect();
    for &tick in &judged {
        let talker = &two(tick)[usize::from(tick >= 200)];
        let (identity, _) = nearest(&scenes[tick], talker.x).unwrap();
        right += usize::from(scenes[tick].speaker == Some(identity));
    }
    assert!(right * 10 >= judged.len() * 9, "{right} of {}", judged.len());
}

#[test]
fn by_sound_alone_one_track_follows_the_talker() {
    let mut system = build("stac", &json!({ "modality": "audio" }), &room(true), 1).unwrap();
    let scenes = run(system.as_mut(), 0..300, true);
    assert!(
        scenes[..50].iter().all(|scene| scene.tracks.is_empty()),
        "silence"
    );
    let mut errors: Vec<f64> = (110..200)
        .chain(225..300)
        .map(|tick| {
            let talker = &two(tick)[usize::from(tick >= 200)];
            assert_eq!(scenes[tick].tracks.len(), 1);
            nearest(&scenes[tick], talker.x).unwrap().1
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    let median = errors[errors.len() / 2];
    assert!(median < 10.0, "{median} px");
}

#[test]
fn with_pictures_alone_nobody_is_said_to_speak_and_sound_alone_needs_sound() {
    let video = json!({ "modality": "video" });
    let mut system = build("stac", &video, &room(true), 1).unwrap();
    let scenes = run(system.as_mut(), 0..120, true);
    let last = &scenes[119];
    assert_eq!(last.tracks.len(), 2);
    assert!(last.speaker.is_none() && last.nobody_probability.is_none() && last.sounds.is_empty());
    let error = build("stac", &json!({ "modality": "audio" }), &room(false), 1)
        .err()
        .unwrap();
    assert!(error.to_string().contains("pair an array"), "{error}");
}

#[test]
fn a_saved_run_by_sound_alone_goes_on_with_the_same_bytes() {
    let audio = json!({ "modality": "audio" });
    let mut whole = build("stac", &audio, &room(true), 5).unwrap();
    let expected = run(whole.as_mut(), 0..130, true);
    let mut first = build("stac", &audio, &room(true), 5).unwrap();
    run(first.as_mut(), 0..90, true);
    let mut second = build("stac", &audio, &room(true), 5).unwrap();
    second.restore(&first.save().unwrap()).unwrap();
    let rest = run(second.as_mut(), 90..130, true);
    let bytes = |scenes: &[Scene]| serde_json::to_string(scenes).unwrap();
    assert_eq!(bytes(&rest), bytes(&expected[90..]));
    assert_eq!(expected[129].tracks.len(), 1);
}

#[test]
fn a_saved_run_goes_on_with_the_same_bytes() {
    let mut whole = build("stac", &json!({}), &room(true), 5).unwrap();
    let expected = run(whole.as_mut(), 0..160, true);
    let mut first = build("stac", &json!({}), &room(true), 5).unwrap();
    run(first.as_mut(), 0..110, true);
    let saved = first.save().unwrap();
    let mut second = build("stac", &json!({}), &room(true), 5).unwrap();
    second.restore(&saved).unwrap();
    let rest = run(second.as_mut(), 110..160, true);
    let bytes = |scenes: &[Scene]| serde_json::to_string(scenes).unwrap();
    assert_eq!(bytes(&rest), bytes(&expected[110..]));
    assert!(expected[159].tracks.len() == 2, "the test must cover tracks");
}

#[test]
fn foreign_states_are_refused_and_change_nothing() {
    let mut system = build("stac", &json!({}), &room(true), 5).unwrap();
    run(system.as_mut(), 0..60, true);
    let before = system.save().unwrap();
    assert!(system.restore(&[1, 2, 3]).is_err());
    let other = build("stac", &json!({}), &room(false), 5)
        .unwrap()
        .save()
        .unwrap();
    assert!(system.restore(&other).is_err());
    assert_eq!(system.save().unwrap(), before);
}

#[test]
fn wrong_parameters_are_named() {
    let error = build("stac", &json!({ "partcles": 10 }), &room(false), 0)
        .err()
        .unwrap()
        .to_string();
    assert!(
        error.contains("partcles") && error.contains("particles"),
        "{error}"
    );
    let nested = build(
        "stac",
        &json!({ "re_entry": { "enabld": true } }),
        &room(false),
        0,
    )
    .err()
    .unwrap();
    assert!(nested.to_string().contains("enabld"));
    assert!(
        build("stac", &json!({}), &Room::default(), 0).is_err(),
        "a room without cameras"
    );
}

#[test]
fn bad_numbers_in_sound_do_not_spread() {
    let mut system = build("stac", &json!({}), &room(true), 1).unwrap();
    run(system.as_mut(), 0..110, true);
    let mut scene = Scene::default();
    let mut broken = moment(110, &two(110), None, true);
    broken.audio[0].data.channels[0].fill(f32::NAN);
    broken.audio[0].data.channels[1].fill(f32::INFINITY);
    system.step(&broken, &mut scene);
    for scene in run(system.as_mut(), 111..130, true) {
        assert_eq!(scene.tracks.len(), 2);
        assert!(scene.nobody_probability.is_some_and(f64::is_finite));
        assert!(
            scene
                .tracks
                .iter()
                .all(|track| track.views[0].head.left.is_finite())
        );
    }
}
