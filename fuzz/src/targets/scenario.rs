//! Scenario files, both stages, and the world that comes of them.

use super::{Target, Verdict, room::show, texts};
use hearsight_core::configuration::Overrides;
use hearsight_sim::scenario::from_text;
use hearsight_sim::world::World;

pub(super) const TARGET: Target = Target {
    name: "scenario",
    meaning: "A scenario file, parsed and resolved; people and devices are somewhere at any time.",
    text: true,
    words: &[
        "[room]",
        "[[room.door]]",
        "[[furniture]]",
        "[[light]]",
        "[[person]]",
        "[[person.action]]",
        "[[conversation]]",
        "[[noise]]",
        "[[base]]",
        "[[base.action]]",
        "[[camera]]",
        "[[camera.command]]",
        "[[array]]",
        "seconds",
        "seed",
        "size",
        "t60",
        "at",
        "walk",
        "wander",
        "sit",
        "turn",
        "look",
        "jerk",
        "leave",
        "enter",
        "gesture",
        "speed",
        "until",
        "time",
        "turns",
        "during",
        "snr",
        "level",
        "view",
        "stereo",
        "ring",
        "head = {}",
        "lost_share",
        "base",
        "\"speaker\"",
        "\"here\"",
        "\"door\"",
        "nan",
        "inf",
        "1e300",
        "-1",
        "0",
    ],
    longest: 6 << 10,
    seeds: || {
        texts(&[
            include_str!("../../../scenes/meeting.toml"),
            include_str!("../../../scenes/living-room.toml"),
            include_str!("../../../scenes/stac-vo.toml"),
            include_str!("../../seeds/scenario/robot.toml"),
        ])
    },
    open: || {
        Box::new(|bytes| {
            let Ok(text) = std::str::from_utf8(bytes) else {
                return Verdict::Refused("not UTF-8".to_owned());
            };
            match from_text("scene.toml", text, &Overrides::new()) {
                Ok(world) => judge(&world),
                Err(error) => show(&error),
            }
        })
    },
};

/// Bodies and cameras must be at finite places at any time.
fn judge(world: &World) -> Verdict {
    let Ok(controls) = world.controls() else {
        return Verdict::Broken("its own commands are refused".to_owned());
    };
    let mut seen = 0;
    for part in [0.0, 0.37, 0.81] {
        let time_s = part * world.seconds;
        for person in 0..world.people.len() {
            let Some(posture) = world.posture(person, time_s) else {
                continue;
            };
            seen += 1;
            let ends = posture.arms.iter().chain(&posture.legs).map(|limb| limb.end);
            let mut points = ends.chain([posture.head, posture.pelvis]);
            if points.any(|point| !point.0.iter().all(|value| value.is_finite())) {
                return Verdict::Broken(format!("person {person} is nowhere at {time_s} s"));
            }
        }
        for (number, device) in world.cameras.iter().enumerate() {
            let camera = controls.camera(device, number, &world.bases, time_s);
            let finite = camera.is_ok_and(|camera| camera.centre().0.iter().all(|value| value.is_finite()));
            if !finite {
                return Verdict::Broken(format!("camera {number} is nowhere at {time_s} s"));
            }
        }
    }
    Verdict::Read(format!(
        "{} people, {seen} seen, {} cameras, {} arrays, {} noises",
        world.people.len(),
        world.cameras.len(),
        world.arrays.len(),
        world.noises.len()
    ))
}
