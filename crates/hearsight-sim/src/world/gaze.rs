//! Where people look: ahead, at somebody, at a place, at whoever speaks.

use super::ease::{mix, mix_angles, smooth, wrap};
use hearsight_core::WorldPoint;

/// How far a head turns against the chest, radians.
const LARGEST_YAW_RAD: f64 = 1.25;
/// How far it looks up or down, radians.
const LARGEST_PITCH_RAD: f64 = 0.6;
/// Turning the head takes this long, seconds.
const TURN_S: f64 = 0.45;

/// What is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// Straight ahead.
    Ahead,
    /// A direction in the world, radians.
    Direction(f64),
    /// A place, metres.
    Place(WorldPoint),
    /// A person, by number from 0.
    Person(usize),
}

/// From a time on somebody looks at something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// When the head begins to turn, seconds.
    pub from_s: f64,
    /// At what.
    pub target: Target,
}

/// The direction of a head against the chest (to the left) and up, radians.
///
/// `looks` are in order of time. `eyes` is where the head is, `facing_rad` where the chest faces; `head_of` gives the
/// head of another person, where they are in the room.
pub(crate) fn direction(
    looks: &[Look],
    time_s: f64,
    eyes: WorldPoint,
    facing_rad: f64,
    head_of: &dyn Fn(usize) -> Option<WorldPoint>,
) -> [f64; 2] {
    let begun = looks.partition_point(|look| look.from_s <= time_s);
    // What came before the last few has no part any more.
    let first = (0..begun)
        .rev()
        .find(|number| time_s - looks[*number].from_s >= TURN_S)
        .unwrap_or(0);
    let mut now = [0.0; 2];
    for (number, look) in looks[..begun].iter().enumerate().skip(first) {
        let wanted = wanted(look.target, eyes, facing_rad, head_of);
        let whole = number == first && time_s - look.from_s >= TURN_S;
        let part = if whole {
            1.0
        } else {
            smooth((time_s - look.from_s) / TURN_S)
        };
        now = [mix_angles(now[0], wanted[0], part), mix(now[1], wanted[1], part)];
    }
    now
}

fn wanted(
    target: Target,
    eyes: WorldPoint,
    facing_rad: f64,
    head_of: &dyn Fn(usize) -> Option<WorldPoint>,
) -> [f64; 2] {
    let at = |place: WorldPoint| {
        let way = place.0 - eyes.0;
        let across = way.x.hypot(way.y);
        if across < 1e-6 {
            return [0.0; 2];
        }
        limited(wrap(way.y.atan2(way.x) - facing_rad), way.z.atan2(across))
    };
    match target {
        Target::Ahead => [0.0; 2],
        Target::Direction(direction) => limited(wrap(direction - facing_rad), 0.0),
        Target::Place(place) => at(place),
        Target::Person(number) => head_of(number).map_or([0.0; 2], at),
    }
}

fn limited(yaw_rad: f64, pitch_rad: f64) -> [f64; 2] {
    [
        // What is behind is not looked at over one shoulder and then over the other.
        LARGEST_YAW_RAD * (yaw_rad / LARGEST_YAW_RAD).clamp(-1.0, 1.0) * behind(yaw_rad),
        pitch_rad.clamp(-LARGEST_PITCH_RAD, LARGEST_PITCH_RAD),
    ]
}

/// 1 to the front and the sides, falling to 0 straight behind.
fn behind(yaw_rad: f64) -> f64 {
    smooth((std::f64::consts::PI - yaw_rad.abs()) / 1.2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_4;

    #[test]
    fn heads_turn_smoothly_from_one_to_the_next() {
        let looks = [
            Look {
                from_s: 1.0,
                target: Target::Direction(FRAC_PI_4),
            },
            Look {
                from_s: 1.2,
                target: Target::Person(0),
            },
            Look {
                from_s: 5.0,
                target: Target::Ahead,
            },
        ];
        let eyes = WorldPoint::new(0.0, 0.0, 1.6);
        let head_of = |_| Some(WorldPoint::new(2.0, -2.0, 1.2));
        let at = |time: f64| direction(&looks, time, eyes, 0.0, &head_of);
        assert_eq!(at(0.5), [0.0; 2]);
        assert!((at(3.0)[0] + FRAC_PI_4).abs() < 1e-9 && at(3.0)[1] < -0.1);
        assert!(at(7.0)[0].abs() < 1e-9);
        let mut last = at(0.0);
        for number in 1..8000 {
            let now = at(f64::from(number) * 1e-3);
            assert!((now[0] - last[0]).abs() < 0.01, "{number}");
            last = now;
        }
    }

    #[test]
    fn nobody_looks_through_their_own_back() {
        let eyes = WorldPoint::new(0.0, 0.0, 1.6);
        for target in [3.1, -3.1, 1.5] {
            let looks = [Look {
                from_s: 0.0,
                target: Target::Direction(target),
            }];
            let [yaw, _] = direction(&looks, 9.0, eyes, 0.0, &|_| None);
            assert!(yaw.abs() <= LARGEST_YAW_RAD);
        }
    }
}
