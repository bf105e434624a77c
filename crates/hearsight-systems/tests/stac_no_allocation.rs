//! A step of stac allocates nothing once it is in its stride: live tracking must not wait for memory.

#![expect(clippy::unwrap_used, reason = "a test that cannot make its input should stop")]

mod counting;
#[expect(dead_code, reason = "what tests of two people need")]
mod drawn_room;

use counting::allocations;
use drawn_room::{Person, moment, room};
use hearsight_core::Moment;
use hearsight_core::record::Scene;
use hearsight_systems::build;
use serde_json::json;

/// Three people who came in after two seconds and sway; the first one talks.
fn three(tick: usize) -> (Vec<Person>, Option<f32>) {
    let Some(since) = tick.checked_sub(50) else {
        return (vec![], None);
    };
    let walked = |end: f32| (since as f32 * 3.0).min(end);
    let sway = 4.0 * (since as f32 * 0.2).sin();
    let places = [
        (-30.0 + walked(90.0) + sway, [150, 40, 40]),
        (-90.0 + walked(250.0) - sway, [40, 140, 60]),
        (350.0 - walked(90.0) + sway, [40, 60, 150]),
    ];
    let people = places.map(|(x, shirt)| Person { x, shirt });
    (people.into(), Some(places[0].0))
}

/// The only test of this file, so that no other thread allocates meanwhile.
#[test]
fn a_step_with_three_people_and_a_voice_allocates_nothing() {
    let mut system = build("stac", &json!({}), &room(true), 1).unwrap();
    let mut scene = Scene::default();
    let picture = |tick| {
        let (people, talker) = three(tick);
        moment(tick, &people, talker, true)
    };
    for tick in 0..250 {
        system.step(&picture(tick), &mut scene);
    }
    let moments: Vec<Moment> = (250..350).map(picture).collect();
    let (mut with_sound, mut least) = (0, usize::MAX);
    let mut guilty = Vec::new();
    for moment in &moments {
        let count = allocations(|| system.step(moment, &mut scene));
        if count > 0 {
            guilty.push((moment.tick, count));
        }
        with_sound += scene.sounds.len();
        least = least.min(scene.tracks.len());
    }
    assert_eq!(least, 3, "the three are followed all the while");
    assert!(with_sound > 50, "{with_sound} ticks with sound");
    assert!(scene.tracks.iter().any(|track| track.speaking));
    assert!(guilty.is_empty(), "allocations (tick, count): {guilty:?}");
}
