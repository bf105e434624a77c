//! A steady closed loop allocates nothing a frame: live tracking must not wait for memory.

#![expect(clippy::unwrap_used, reason = "a test that cannot make its input should stop")]

mod counting;
mod drawn_room;

use counting::allocations;
use drawn_room::{moment, nearest, room, run, two};
use hearsight_core::Moment;
use hearsight_core::record::Scene;
use hearsight_systems::{System, build};
use serde_json::json;
use std::path::Path;

/// Moments of the two, of whom the first talks; sounds come and go, so that every buffer is needed early.
fn moments(ticks: std::ops::Range<usize>) -> Vec<Moment> {
    let look = |tick| {
        let people = two(tick);
        let mut moment = moment(tick, &people, people.first().map(|person| person.x), true);
        let frame = &mut moment.video[0].data;
        for (luma, colours) in frame.luma.iter_mut().zip(frame.rgb.chunks_exact(3)) {
            *luma = colours[1];
        }
        moment
    };
    ticks.map(look).collect()
}

/// What the second half of some moments asks memory for; the two must be followed to the end.
fn asked_for(system: &mut dyn System, ticks: std::ops::Range<usize>) -> usize {
    let last = ticks.end - 1;
    let moments = moments(ticks);
    let (first, second) = moments.split_at(moments.len() / 2);
    let mut scene = Scene::default();
    for moment in first {
        system.step(moment, &mut scene);
    }
    let allocated = allocations(|| {
        for moment in second {
            system.step(moment, &mut scene);
        }
    });
    assert_eq!(scene.tracks.len(), 2, "the test must cover tracks");
    assert!(nearest(&scene, two(last)[0].x).unwrap().1 < 12.0);
    allocated
}

/// The only test of this file, so that no other thread allocates meanwhile.
#[test]
fn a_steady_loop_allocates_nothing() {
    // Heads in this room have no faces: people are born from change, and then followed by a system that does not look for
    // it, as the paper's does between two searches.
    let faces = json!({ "cascades": [] });
    let born = json!({ "changes": true, "faces": faces });
    let mut first = build("closed-loop", &born, &room(true), 1).unwrap();
    run(first.as_mut(), 0..120, true);
    let paper = json!({ "changes": false, "faces": faces });
    let mut system = build("closed-loop", &paper, &room(true), 1).unwrap();
    system.restore(&first.save().unwrap()).unwrap();
    assert_eq!(asked_for(system.as_mut(), 120..200), 0, "as in the paper");

    // The defaults: change is looked for, and faces every second.
    let installed = Path::new("/usr/share/opencv4/haarcascades/haarcascade_frontalface_alt2.xml").exists();
    let given = if installed {
        json!({})
    } else {
        eprintln!("without a search for faces: opencv-data is not installed");
        json!({ "faces": faces })
    };
    let mut system = build("closed-loop", &given, &room(true), 1).unwrap();
    for moment in &moments(0..120) {
        system.step(moment, &mut Scene::default());
    }
    assert_eq!(asked_for(system.as_mut(), 120..280), 0, "with the defaults");
}
