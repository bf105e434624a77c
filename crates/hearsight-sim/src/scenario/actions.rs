//! What people do, one action after the other.

use super::names::Thing;
use super::people::{Draft, SEAT_M};
use super::raw::RawAction;
use super::resolve::Resolver;
use super::surroundings::{Door, OUTSIDE_M, Surroundings, THRESHOLD_M};
use crate::world::{Gesture, LARGEST_JERK_M_S, LARGEST_SPEED_M_S, Pace, Refusal};
use hearsight_core::configuration::{ConfigurationError, Field};
use nalgebra::{Point2, Vector2};

pub(super) const USUAL_SPEED_M_S: f64 = 1.1;

/// How far a seat may be from who sits down on it, metres.
const SEAT_REACH_M: f64 = 1.2;

impl Resolver {
    /// Adds one action.
    pub(super) fn act(
        &self,
        field: &Field,
        raw: &RawAction,
        time: f64,
        surroundings: &Surroundings,
        draft: &mut Draft,
    ) -> Result<(), ConfigurationError> {
        let verbs = verbs(raw);
        if verbs.len() != 1 {
            let what = if verbs.is_empty() {
                "says nothing of what is done".to_owned()
            } else {
                format!("has {} at once", verbs.join(" and "))
            };
            let cure =
                "give exactly one of walk, wander, sit, stand, turn, look, jerk, leave, enter, gesture";
            return Err(self.wrong(field, what, cure));
        }
        if let Some(look) = &raw.look {
            let wish = self.wish(&field.key("look"), look)?;
            draft.wishes.push((time, wish));
            return Ok(());
        }
        if let Some(kind) = raw.gesture {
            let seconds = self.number(
                &field.key("seconds"),
                raw.seconds,
                2.0,
                [0.1, 3600.0],
                "give seconds",
            )?;
            let rate_hz = self.number(
                &field.key("rate"),
                raw.rate,
                kind.usual_rate_hz(),
                [0.05, 10.0],
                "give hertz",
            )?;
            let busy = draft
                .gestures
                .iter()
                .find(|other| other.kind.needs_hand() == kind.needs_hand() && other.until_s > time);
            if let Some(other) = busy {
                let what = format!("begins before the gesture before ends, at {} s", other.until_s);
                return Err(self.wrong(
                    &field.key("time"),
                    what,
                    "write gestures of one hand one after the other",
                ));
            }
            draft.gestures.push(Gesture {
                kind,
                from_s: time,
                until_s: time + seconds,
                rate_hz,
            });
            return Ok(());
        }
        self.move_body(field, raw, time, surroundings, draft)
    }

    fn move_body(
        &self,
        field: &Field,
        raw: &RawAction,
        time: f64,
        surroundings: &Surroundings,
        draft: &mut Draft,
    ) -> Result<(), ConfigurationError> {
        let motion = &mut draft.motion;
        let here = motion.end().place;
        let done = if let Some(direction) = &raw.turn {
            let to = self.bearing(&field.key("turn"), direction, here)?;
            let seconds = match raw.seconds {
                Some(_) => Some(self.number(
                    &field.key("seconds"),
                    raw.seconds,
                    1.0,
                    [0.05, 3600.0],
                    "give seconds",
                )?),
                None => None,
            };
            motion.turn(time, to, seconds)
        } else if let Some([x, y]) = raw.jerk {
            let seconds = self.number(
                &field.key("seconds"),
                raw.seconds,
                0.3,
                [0.05, 10.0],
                "give seconds",
            )?;
            motion.jerk(time, Vector2::new(x, y), seconds)
        } else if raw.stand == Some(true) {
            motion.rise(time)
        } else if let Some(name) = &raw.sit {
            let (place, facing, seat_m) = if name == "here" {
                (here, motion.end().facing_rad, SEAT_M)
            } else {
                self.seat(&field.key("sit"), name, surroundings)?
            };
            let distance = (place - here).norm();
            if distance > SEAT_REACH_M {
                let what = format!("`{name}` is {distance:.1} m away");
                return Err(self.wrong(&field.key("sit"), what, "let them walk there first"));
            }
            motion.sit(time, place, facing, seat_m)
        } else if raw.wander.is_some() {
            return self.wander(field, raw, time, surroundings, draft);
        } else {
            let pace = self.pace(field, raw, time)?;
            let points = self.points(field, &raw.walk)?;
            if let Some(name) = &raw.leave {
                let door = self.door(&field.key("leave"), name, surroundings)?;
                let way: Vec<_> = points.into_iter().chain(through(&door)).collect();
                motion.leave(time, &way, pace)
            } else if let Some(name) = &raw.enter {
                let door = self.door(&field.key("enter"), name, surroundings)?;
                let [threshold, outside] = through(&door);
                let way: Vec<_> = std::iter::once(threshold).chain(points).collect();
                motion.enter(time, outside, &way, pace)
            } else {
                motion.walk(time, &points, pace)
            }
        };
        let fastest = if raw.jerk.is_some() {
            LARGEST_JERK_M_S
        } else {
            LARGEST_SPEED_M_S
        };
        done.map_err(|refusal| self.refused(field, time, fastest, refusal))
    }

    fn door(
        &self,
        field: &Field,
        name: &str,
        surroundings: &Surroundings,
    ) -> Result<Door, ConfigurationError> {
        let number = self.find(field, name, "door", |thing| match thing {
            Thing::Door(number) => Some(number),
            _ => None,
        })?;
        Ok(surroundings.doors[number])
    }

    fn points(&self, field: &Field, points: &[[f64; 2]]) -> Result<Vec<Point2<f64>>, ConfigurationError> {
        let mut all = Vec::new();
        for (number, [x, y]) in points.iter().enumerate() {
            self.inside(&field.key("walk").index(number), [*x, *y, 0.0])?;
            all.push(Point2::new(*x, *y));
        }
        Ok(all)
    }

    pub(super) fn pace(&self, field: &Field, raw: &RawAction, time: f64) -> Result<Pace, ConfigurationError> {
        match (raw.speed, raw.until) {
            (Some(_), Some(_)) => {
                let what = "has `speed` and `until` at once";
                Err(self.wrong(field, what, "keep one of them: the other follows"))
            }
            (_, Some(until)) if until.is_finite() && until > time => Ok(Pace::Arrive(until)),
            (_, Some(until)) => {
                let what = format!("{until} s is not after its beginning, {time} s");
                Err(self.wrong(&field.key("until"), what, "arrive later"))
            }
            (speed, None) => Ok(Pace::Speed(self.number(
                &field.key("speed"),
                speed,
                USUAL_SPEED_M_S,
                [0.05, LARGEST_SPEED_M_S],
                "people walk at 0.5 to 1.8 metres a second and run at up to 3.5",
            )?)),
        }
    }

    /// What is wrong with an action that cannot be done.
    pub(super) fn refused(
        &self,
        field: &Field,
        time: f64,
        fastest: f64,
        refusal: Refusal,
    ) -> ConfigurationError {
        let at = field.key("time");
        match refusal {
            Refusal::Busy(until) => {
                let what = format!("{time} s is too early: the action before lasts until {until:.2} s");
                self.wrong(&at, what, "begin later, or let the action before be faster")
            }
            Refusal::TooFast(speed) => {
                let what =
                    format!("would need {speed:.1} metres a second, and time to turn and to gain speed");
                self.wrong(
                    field,
                    what,
                    format!("nobody moves faster than {fastest}: give more time or less way"),
                )
            }
            Refusal::NoTime => self.wrong(
                &field.key("until"),
                "leaves no time at all",
                "arrive later, or begin earlier",
            ),
            Refusal::Away => {
                let what = format!("nobody is in the room to do that at {time} s");
                self.wrong(field, what, "let them `enter` before")
            }
            Refusal::Present => {
                let what = format!("is in the room already at {time} s");
                self.wrong(
                    field,
                    what,
                    "let them `leave` before, or leave out `at` of the person",
                )
            }
        }
    }
}

/// The keys that say what is done.
fn verbs(raw: &RawAction) -> Vec<&'static str> {
    // Who comes or goes may walk on a way of their own.
    let walks = !raw.walk.is_empty() && raw.leave.is_none() && raw.enter.is_none();
    let all = [
        ("walk", walks),
        ("wander", raw.wander.is_some()),
        ("sit", raw.sit.is_some()),
        ("stand", raw.stand == Some(true)),
        ("turn", raw.turn.is_some()),
        ("look", raw.look.is_some()),
        ("jerk", raw.jerk.is_some()),
        ("leave", raw.leave.is_some()),
        ("enter", raw.enter.is_some()),
        ("gesture", raw.gesture.is_some()),
    ];
    all.into_iter()
        .filter(|(_, given)| *given)
        .map(|(name, _)| name)
        .collect()
}

/// The way out through a door: before it, and outside.
fn through(door: &Door) -> [Point2<f64>; 2] {
    [
        door.place + door.inwards * THRESHOLD_M,
        door.place - door.inwards * OUTSIDE_M,
    ]
}
