//! A steady closed loop allocates nothing a frame: live tracking must not wait for memory.

#![expect(clippy::unwrap_used, reason = "a test that cannot make its input should stop")]

mod counting;
mod drawn_room;

use counting::allocations;
use drawn_room::{moment, nearest, room, run, two};
use hearsight_core::Moment;
use hearsight_core::record::Scene;
use hearsight_systems::build;
use serde_json::json;

/// The only test of this file, so that no other thread allocates meanwhile. Heads in this room have no faces: people are
/// born from change, and then followed by a system that does not look for it, as the paper's does between two searches.
#[test]
fn a_steady_loop_allocates_nothing() {
    let faces = json!({ "cascades": [] });
    let born = json!({ "changes": true, "faces": faces });
    let mut first = build("closed-loop", &born, &room(true), 1).unwrap();
    run(first.as_mut(), 0..120, true);
    let mut system = build(
        "closed-loop",
        &json!({ "changes": false, "faces": faces }),
        &room(true),
        1,
    )
    .unwrap();
    system.restore(&first.save().unwrap()).unwrap();
    let mut scene = Scene::default();
    // Sounds come and go, so that every buffer has been needed before.
    let moments: Vec<Moment> = (120..200)
        .map(|tick| moment(tick, &two(tick), Some(two(tick)[0].x), true))
        .collect();
    for moment in &moments[..60] {
        system.step(moment, &mut scene);
    }
    let allocated = allocations(|| {
        for moment in &moments[60..] {
            system.step(moment, &mut scene);
        }
    });
    assert_eq!(scene.tracks.len(), 2, "the test must cover tracks");
    assert!(nearest(&scene, two(199)[0].x).unwrap().1 < 12.0);
    assert_eq!(allocated, 0, "in {} moments", moments.len() - 60);
}
