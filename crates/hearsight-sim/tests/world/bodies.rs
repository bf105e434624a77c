//! Bodies look and move like bodies: bones keep their lengths, nothing leaps, and any instant can be asked for.

use crate::common::world;
use hearsight_core::WorldPoint;
use hearsight_sim::world::{Limb, Posture};

const BUSY: &str = r#"
seconds = 40
[room]
size = [6, 5, 2.7]
[[room.door]]
at = [6, 2.5]
[[furniture]]
kind = "chair"
name = "chair"
at = [1.2, 3.5]
turn = -90
[[person]]
name = "anna"
at = [1, 1]
facing = 0
turns = [[1, 4], [15, 20]]
[[person.action]]
time = 0.5
look = "bob"
[[person.action]]
time = 1
walk = [[3, 1], [3, 3], [1.5, 2.5]]
[[person.action]]
time = 9
walk = [[1.2, 2.6]]
[[person.action]]
time = 11
sit = "chair"
[[person.action]]
time = 14
gesture = "hand_before_face"
seconds = 4
[[person.action]]
time = 20
look = "speaker"
[[person.action]]
time = 22
walk = [[4, 3]]
[[person.action]]
time = 28
jerk = [0.3, 0.2]
[[person.action]]
time = 30
leave = "door"
[[person]]
name = "bob"
at = [4, 2.2]
turns = [[5, 9], [21, 26]]
"#;

fn points(posture: &Posture) -> Vec<WorldPoint> {
    let limb = |limb: &Limb| [limb.root, limb.joint, limb.end];
    let limbs = posture.arms.iter().chain(&posture.legs).flat_map(limb);
    limbs
        .chain([posture.head, posture.neck, posture.pelvis])
        .collect()
}

#[test]
fn nothing_leaps_and_bones_keep_their_lengths() {
    let world = world(BUSY);
    for person in 0..2 {
        let figure = world.people[person].figure;
        let lengths = |posture: &Posture| {
            let bones = |limb: &Limb| [limb.root.distance_m(limb.joint), limb.joint.distance_m(limb.end)];
            let arms = posture
                .arms
                .iter()
                .map(bones)
                .map(|found| (found, [figure.upper_arm_m, figure.forearm_m]));
            let legs = posture
                .legs
                .iter()
                .map(bones)
                .map(|found| (found, [figure.thigh_m, figure.shin_m]));
            arms.chain(legs).collect::<Vec<_>>()
        };
        let step = 0.004;
        let mut last: Option<Posture> = None;
        for number in 0..10_000 {
            let time = f64::from(number) * step;
            let Some(now) = world.posture(person, time) else {
                last = None;
                continue;
            };
            for (found, wanted) in lengths(&now) {
                assert!(
                    (found[0] - wanted[0]).abs() < 1e-6 && (found[1] - wanted[1]).abs() < 1e-6,
                    "{time}"
                );
            }
            let all = points(&now);
            assert!(
                all.iter()
                    .all(|point| point.0.iter().all(|value| value.is_finite()))
            );
            assert!(
                all.iter().all(|point| point.0.z > 0.0 && point.0.z < 2.4),
                "{time} {now:?}"
            );
            if let Some(last) = last {
                for (new, old) in all.iter().zip(points(&last)) {
                    let speed = new.distance_m(old) / step;
                    assert!(speed < 7.0, "{speed:.1} m/s at {time:.3} s");
                }
                assert!(
                    (now.head_yaw_rad - last.head_yaw_rad).sin().abs() < 16.0 * step,
                    "{time}"
                );
            }
            last = Some(now);
        }
    }
}

#[test]
fn any_instant_gives_what_it_gives_in_order() {
    let (one, other) = (world(BUSY), world(BUSY));
    let forward: Vec<_> = (0..400)
        .map(|number| one.posture(0, f64::from(number) * 0.1))
        .collect();
    for number in (0..400).rev() {
        assert_eq!(
            other.posture(0, f64::from(number) * 0.1),
            forward[number as usize]
        );
    }
}

#[test]
fn people_do_what_is_written() {
    let world = world(BUSY);
    let anna = |time: f64| world.posture(0, time);
    let standing = anna(0.2).unwrap();
    let height = world.people[0].looks.height_m;
    let crown = standing.head.0.z + world.people[0].looks.head_half_axes_m[2];
    assert!((crown - height).abs() < 0.03, "{crown} of {height}");
    // She sits on the chair and faces as it does.
    let seated = anna(18.0).unwrap();
    assert!(seated.head.0.z < height - 0.3 && (seated.pelvis.0.y - 3.5).abs() < 0.05);
    assert!((seated.torso_yaw_rad + std::f64::consts::FRAC_PI_2).abs() < 0.4);
    // The hand sweeps across the face.
    let hand = anna(16.0).unwrap();
    assert!(hand.arms[1].end.distance_m(hand.head) < 0.35);
    assert!(seated.arms[0].end.distance_m(seated.head) > 0.4);
    // She looks at Bob, and has gone by the door.
    let to_bob = world.head_anchor(1, 18.0).unwrap().0 - seated.head.0;
    let off = (to_bob.y.atan2(to_bob.x) - seated.head_yaw_rad).sin().abs();
    assert!(off < 0.3, "{off}");
    assert!(anna(39.0).is_none());
    // In a walk feet are on the floor one after the other.
    let feet: Vec<[f64; 2]> = (0..60)
        .map(|number| {
            anna(1.5 + f64::from(number) * 0.03)
                .unwrap()
                .legs
                .map(|leg| leg.end.0.z)
        })
        .collect();
    for side in [0, 1] {
        let lifted = feet
            .iter()
            .filter(|both| both[side] > world.people[0].figure.ankle_m + 0.03)
            .count();
        assert!((6..45).contains(&lifted), "{lifted}");
    }
}

#[test]
fn walkers_take_the_time_that_they_are_given() {
    let text = "[[person]]\nat = [1, 1]\n[[person.action]]\ntime = 2\nuntil = 8\nwalk = [[4, 1], [4, 3]]\n";
    let world = world(text);
    let at = |time: f64| world.posture(0, time).unwrap().pelvis.0;
    assert!((at(8.0) - nalgebra::Point3::new(4.0, 3.0, at(8.0).z)).norm() < 0.02);
    assert!((at(7.5) - at(8.0)).norm() > 0.05);
}
