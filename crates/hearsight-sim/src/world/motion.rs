//! What a body does in the course of a scenario: stands, turns, walks, sits down, jerks aside, is away.
//!
//! A motion is made once, piece after piece in order of time, and then answers for any instant; nothing is remembered
//! between answers.

use super::ease::{mix, mix_angles, reach, smooth, wrap};
use super::walk::Walk;
use nalgebra::{Point2, Vector2};

/// Turning on the spot, radians a second on average, after a moment to begin.
const TURN_RAD_S: f64 = 2.6;
const TURN_BEGIN_S: f64 = 0.25;
/// Sitting down and standing up, seconds.
const SIT_S: f64 = 1.3;
/// A walk that begins in a direction further off than this begins with a turn on the spot, radians.
const TURN_FIRST_RAD: f64 = 0.9;
/// At corners sharper than this people stop and turn, radians.
const SHARP_CORNER_RAD: f64 = 1.8;
/// The fastest speed of a walk that is believed, metres a second: a run.
pub const LARGEST_SPEED_M_S: f64 = 3.5;
/// The fastest jerk that is believed, metres a second.
pub const LARGEST_JERK_M_S: f64 = 6.0;

/// Where somebody is and how, while nothing happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Middle of the body on the floor, metres.
    pub place: Point2<f64>,
    /// Where the body faces, radians.
    pub facing_rad: f64,
    /// Height of the seat, metres, where somebody sits.
    pub seat_m: Option<f64>,
    /// Whether they are in the room.
    pub present: bool,
}

/// What the body does at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stance {
    /// Middle of the body on the floor, metres.
    pub place: Point2<f64>,
    /// Where the body faces, radians.
    pub facing_rad: f64,
    /// From 0, standing, to 1, sitting.
    pub sitting: f64,
    /// Height of the seat, metres.
    pub seat_m: f64,
    /// How far the trunk leans (forward, left), radians.
    pub lean_rad: [f64; 2],
    /// The walk, where one is going on.
    pub gait: Option<Gait>,
    /// Whether they are in the room.
    pub present: bool,
}

/// How legs move at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gait {
    /// How far the walker has come, metres.
    pub way_m: f64,
    /// Length of two steps, metres.
    pub stride_m: f64,
    /// How far limbs swing, of their whole swing, 0 to 1.
    pub swing: f64,
    /// Speed, metres a second.
    pub speed_m_s: f64,
}

/// How fast a walk is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// Metres a second, between the ramps.
    Speed(f64),
    /// As fast as it takes to arrive at this time, seconds.
    Arrive(f64),
}

/// Why something cannot be done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// Something else goes on until this time, seconds.
    Busy(f64),
    /// It would have to be this fast, metres a second.
    TooFast(f64),
    /// There is no time for it at all.
    NoTime,
    /// Who is away can only come in.
    Away,
    /// Who is in the room cannot come in.
    Present,
}

#[derive(Clone, Debug)]
enum Piece {
    Turn,
    Walk(Walk, f64),
    Sit,
    Rise,
    Jerk,
    /// Comes into the room or goes out of it, in no time.
    Appear,
}

#[derive(Clone, Debug)]
struct Timed {
    from_s: f64,
    until_s: f64,
    before: Rest,
    after: Rest,
    piece: Piece,
}

/// All that one body does.
#[derive(Clone, Debug)]
pub struct Motion {
    start: Rest,
    pieces: Vec<Timed>,
    /// Metres of two steps for a speed, of this body.
    stride_m: [f64; 2],
}

impl Motion {
    /// A body that rests for ever. `stride_m` is the length of two steps at 0 and at 1 metre a second.
    pub fn new(start: Rest, stride_m: [f64; 2]) -> Self {
        Self {
            start,
            pieces: Vec::new(),
            stride_m,
        }
    }

    /// How the body rests after all that it does so far.
    pub fn end(&self) -> Rest {
        self.pieces.last().map_or(self.start, |last| last.after)
    }

    /// When that is over, seconds.
    pub fn end_s(&self) -> f64 {
        self.pieces.last().map_or(f64::NEG_INFINITY, |last| last.until_s)
    }

    /// Turns on the spot to a direction, in `seconds` or as people do.
    ///
    /// # Errors
    /// [`Refusal::Busy`] or [`Refusal::Away`].
    pub fn turn(&mut self, at_s: f64, to_rad: f64, seconds: Option<f64>) -> Result<(), Refusal> {
        let rest = self.ready(at_s)?;
        let angle = wrap(to_rad - rest.facing_rad);
        let seconds = seconds.unwrap_or_else(|| turn_seconds(angle));
        let after = Rest {
            facing_rad: rest.facing_rad + angle,
            ..rest
        };
        self.push(at_s, seconds, after, Piece::Turn);
        Ok(())
    }

    /// Walks through points; who sits stands up before.
    ///
    /// # Errors
    /// [`Refusal::Busy`], [`Refusal::Away`], and where the pace cannot be kept [`Refusal::TooFast`] or
    /// [`Refusal::NoTime`].
    pub fn walk(&mut self, at_s: f64, points: &[Point2<f64>], pace: Pace) -> Result<(), Refusal> {
        self.ready(at_s)?;
        let speed = match pace {
            Pace::Speed(speed) => speed,
            Pace::Arrive(by_s) => self.speed_to_arrive(at_s, points, by_s)?,
        };
        if speed > LARGEST_SPEED_M_S {
            return Err(Refusal::TooFast(speed));
        }
        self.plan(at_s, points, speed);
        Ok(())
    }

    /// Sits down at a place, facing a direction.
    ///
    /// # Errors
    /// [`Refusal::Busy`] or [`Refusal::Away`].
    pub fn sit(
        &mut self,
        at_s: f64,
        place: Point2<f64>,
        facing_rad: f64,
        seat_m: f64,
    ) -> Result<(), Refusal> {
        let rest = self.ready(at_s)?;
        let mut at_s = at_s;
        let angle = wrap(facing_rad - rest.facing_rad);
        if rest.seat_m.is_none() && angle.abs() > 0.1 {
            self.turn(at_s, facing_rad, None)?;
            at_s = self.end_s();
        }
        let after = Rest {
            place,
            facing_rad: self.end().facing_rad + wrap(facing_rad - self.end().facing_rad),
            seat_m: Some(seat_m),
            present: true,
        };
        self.push(at_s, SIT_S, after, Piece::Sit);
        Ok(())
    }

    /// Stands up.
    ///
    /// # Errors
    /// [`Refusal::Busy`] or [`Refusal::Away`].
    pub fn rise(&mut self, at_s: f64) -> Result<(), Refusal> {
        let rest = self.ready(at_s)?;
        if rest.seat_m.is_some() {
            let after = Rest { seat_m: None, ..rest };
            self.push(at_s, SIT_S, after, Piece::Rise);
        }
        Ok(())
    }

    /// Moves aside suddenly and stays there.
    ///
    /// # Errors
    /// [`Refusal::Busy`], [`Refusal::Away`] or [`Refusal::TooFast`].
    pub fn jerk(&mut self, at_s: f64, by: Vector2<f64>, seconds: f64) -> Result<(), Refusal> {
        let rest = self.ready(at_s)?;
        // The middle of such a movement is 15/8 as fast as its mean.
        let speed = by.norm() / seconds * 1.875;
        if speed.is_nan() || speed > LARGEST_JERK_M_S {
            return Err(Refusal::TooFast(speed));
        }
        let after = Rest {
            place: rest.place + by,
            ..rest
        };
        self.push(at_s, seconds, after, Piece::Jerk);
        Ok(())
    }

    /// Walks through points, the last of which is outside, and is away from then on.
    ///
    /// # Errors
    /// As [`Motion::walk`].
    pub fn leave(&mut self, at_s: f64, points: &[Point2<f64>], pace: Pace) -> Result<(), Refusal> {
        self.walk(at_s, points, pace)?;
        let after = Rest {
            present: false,
            ..self.end()
        };
        self.push(self.end_s(), 0.0, after, Piece::Appear);
        Ok(())
    }

    /// Comes in by a place, and walks through points.
    ///
    /// # Errors
    /// [`Refusal::Present`] where somebody is in already; as [`Motion::walk`].
    pub fn enter(
        &mut self,
        at_s: f64,
        from: Point2<f64>,
        points: &[Point2<f64>],
        pace: Pace,
    ) -> Result<(), Refusal> {
        if at_s < self.end_s() {
            return Err(Refusal::Busy(self.end_s()));
        }
        if self.end().present {
            return Err(Refusal::Present);
        }
        let ahead = points.first().map_or(Vector2::x(), |first| first - from);
        let after = Rest {
            place: from,
            facing_rad: ahead.y.atan2(ahead.x),
            seat_m: None,
            present: true,
        };
        self.push(at_s, 0.0, after, Piece::Appear);
        self.walk(at_s, points, pace)
    }

    /// What the body does at a time.
    pub fn stance(&self, time_s: f64) -> Stance {
        let next = self.pieces.partition_point(|piece| piece.from_s <= time_s);
        let Some(timed) = next.checked_sub(1).and_then(|last| self.pieces.get(last)) else {
            return resting(&self.start);
        };
        if time_s >= timed.until_s {
            return resting(&timed.after);
        }
        let part = (time_s - timed.from_s) / (timed.until_s - timed.from_s);
        timed.stance(part, time_s - timed.from_s)
    }

    /// When somebody who does nothing else for a while is next in the room or away: times of coming and going.
    pub fn appearances(&self) -> impl Iterator<Item = (f64, bool)> + '_ {
        let changes = self
            .pieces
            .iter()
            .filter(|timed| matches!(timed.piece, Piece::Appear));
        changes.map(|timed| (timed.from_s, timed.after.present))
    }

    fn ready(&self, at_s: f64) -> Result<Rest, Refusal> {
        // Times are written to the millisecond or so; a piece that ends a hair later does not count.
        if at_s + 1e-6 < self.end_s() {
            return Err(Refusal::Busy(self.end_s()));
        }
        let rest = self.end();
        if rest.present {
            Ok(rest)
        } else {
            Err(Refusal::Away)
        }
    }

    fn push(&mut self, from_s: f64, seconds: f64, after: Rest, piece: Piece) {
        self.pieces.push(Timed {
            from_s: from_s.max(self.end_s()),
            until_s: from_s.max(self.end_s()) + seconds,
            before: self.end(),
            after,
            piece,
        });
    }

    /// Adds the pieces of a walk: standing up, and for each part between sharp corners a turn and a walk.
    fn plan(&mut self, at_s: f64, points: &[Point2<f64>], speed_m_s: f64) {
        let mut at_s = at_s;
        if self.end().seat_m.is_some() {
            let after = Rest {
                seat_m: None,
                ..self.end()
            };
            self.push(at_s, SIT_S, after, Piece::Rise);
            at_s = self.end_s();
        }
        for leg in legs(self.end().place, points) {
            let rest = self.end();
            let ahead = leg[1] - leg[0];
            let heading = ahead.y.atan2(ahead.x);
            let angle = wrap(heading - rest.facing_rad);
            if angle.abs() > TURN_FIRST_RAD {
                let after = Rest {
                    facing_rad: rest.facing_rad + angle,
                    ..rest
                };
                self.push(at_s, turn_seconds(angle), after, Piece::Turn);
                at_s = self.end_s();
            }
            let walk = Walk::new(&leg, self.end().facing_rad, speed_m_s);
            let length = walk.length_m();
            let after = Rest {
                place: walk.place(length),
                facing_rad: walk.facing(length),
                ..self.end()
            };
            let stride = mix(self.stride_m[0], self.stride_m[1], walk.top_speed_m_s());
            let seconds = walk.seconds();
            self.push(at_s, seconds, after, Piece::Walk(walk, stride));
            at_s = self.end_s();
        }
    }

    /// The speed of a walk that ends at a time, metres a second: within a millimetre a second.
    fn speed_to_arrive(&self, at_s: f64, points: &[Point2<f64>], by_s: f64) -> Result<f64, Refusal> {
        let end_s = |speed: f64| {
            let mut trial = self.clone();
            trial.pieces.drain(..trial.pieces.len().saturating_sub(1));
            trial.plan(at_s, points, speed);
            trial.end_s()
        };
        if by_s <= at_s {
            return Err(Refusal::NoTime);
        }
        let (mut slow, mut fast) = (1e-3, LARGEST_SPEED_M_S);
        if end_s(fast) > by_s {
            let way = std::iter::once(self.end().place).chain(points.iter().copied());
            let length: f64 = way.zip(points).map(|(from, to)| (to - from).norm()).sum();
            return Err(Refusal::TooFast(length / (by_s - at_s)));
        }
        for _ in 0..50 {
            let middle = 0.5 * (slow + fast);
            if end_s(middle) > by_s {
                slow = middle;
            } else {
                fast = middle;
            }
        }
        Ok(fast)
    }
}

impl Timed {
    fn stance(&self, part: f64, elapsed_s: f64) -> Stance {
        let (before, after) = (&self.before, &self.after);
        let at_rest = resting(before);
        match &self.piece {
            Piece::Turn => Stance {
                facing_rad: mix_angles(before.facing_rad, after.facing_rad, reach(part)),
                ..at_rest
            },
            Piece::Walk(walk, stride_m) => {
                let (way, speed) = walk.progress(elapsed_s);
                let from_end = way.min(walk.length_m() - way);
                Stance {
                    place: walk.place(way),
                    facing_rad: walk.facing(way),
                    lean_rad: [0.03 * speed, 0.0],
                    gait: Some(Gait {
                        way_m: way,
                        stride_m: *stride_m,
                        swing: smooth(from_end / (0.4 * stride_m)),
                        speed_m_s: speed,
                    }),
                    ..at_rest
                }
            }
            Piece::Sit | Piece::Rise => {
                let down = smooth(part);
                let (sitting, seat) = match self.piece {
                    Piece::Sit => (mix(at_rest.sitting, 1.0, down), after.seat_m),
                    _ => (1.0 - down, before.seat_m),
                };
                Stance {
                    place: before.place + (after.place - before.place) * down,
                    facing_rad: mix_angles(before.facing_rad, after.facing_rad, down),
                    sitting,
                    seat_m: seat.unwrap_or(0.0),
                    lean_rad: [0.6 * (4.0 * down * (1.0 - down)), 0.0],
                    ..at_rest
                }
            }
            Piece::Jerk => {
                let by = after.place - before.place;
                let (along, left) = {
                    let (sin, cos) = before.facing_rad.sin_cos();
                    (by.x * cos + by.y * sin, by.y * cos - by.x * sin)
                };
                // The head goes first and is caught up with.
                let ahead = (std::f64::consts::TAU * part).sin() * 0.35;
                Stance {
                    place: before.place + by * reach(part),
                    lean_rad: [ahead * along, ahead * left],
                    ..at_rest
                }
            }
            Piece::Appear => resting(after),
        }
    }
}

fn resting(rest: &Rest) -> Stance {
    Stance {
        place: rest.place,
        facing_rad: rest.facing_rad,
        sitting: f64::from(u8::from(rest.seat_m.is_some())),
        seat_m: rest.seat_m.unwrap_or(0.0),
        lean_rad: [0.0; 2],
        gait: None,
        present: rest.present,
    }
}

fn turn_seconds(angle_rad: f64) -> f64 {
    TURN_BEGIN_S + angle_rad.abs() / TURN_RAD_S
}

/// The way from a place through points, cut where corners are sharp. Each leg has two points or more.
fn legs(from: Point2<f64>, points: &[Point2<f64>]) -> Vec<Vec<Point2<f64>>> {
    let mut all: Vec<Vec<Point2<f64>>> = Vec::new();
    let mut leg = vec![from];
    for point in points {
        let last = leg[leg.len() - 1];
        let step = point - last;
        if step.norm() < 1e-9 {
            continue;
        }
        if let Some(before) = leg.len().checked_sub(2).map(|at| last - leg[at])
            && wrap(step.y.atan2(step.x) - before.y.atan2(before.x)).abs() > SHARP_CORNER_RAD
        {
            all.push(std::mem::replace(&mut leg, vec![last]));
        }
        leg.push(*point);
    }
    if leg.len() > 1 {
        all.push(leg);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion() -> Motion {
        let start = Rest {
            place: Point2::new(1.0, 1.0),
            facing_rad: 0.0,
            seat_m: Some(0.45),
            present: true,
        };
        Motion::new(start, [0.7, 1.2])
    }

    fn points(list: &[[f64; 2]]) -> Vec<Point2<f64>> {
        list.iter().copied().map(Point2::from).collect()
    }

    #[test]
    fn bodies_never_leap() {
        let mut motion = motion();
        let way = points(&[[3.0, 1.0], [1.0, 1.1], [1.0, 3.0]]);
        motion.walk(1.0, &way, Pace::Speed(1.0)).unwrap();
        let arrived = motion.end_s();
        motion.turn(arrived, 0.0, None).unwrap();
        motion.jerk(arrived + 2.0, Vector2::new(0.3, 0.1), 0.3).unwrap();
        motion
            .sit(arrived + 3.0, Point2::new(1.3, 3.0), 1.0, 0.45)
            .unwrap();
        let step = 0.001;
        let mut last = motion.stance(0.0);
        for number in 1..((arrived + 6.0) / step) as usize {
            let now = motion.stance(number as f64 * step);
            assert!((now.place - last.place).norm() < 3.0 * step, "{now:?}");
            assert!(
                wrap(now.facing_rad - last.facing_rad).abs() < 6.0 * step,
                "{now:?}"
            );
            assert!((now.sitting - last.sitting).abs() < 2.0 * step);
            assert!((now.lean_rad[0] - last.lean_rad[0]).abs() < 10.0 * step);
            last = now;
        }
        assert_eq!(last.sitting, 1.0);
    }

    #[test]
    fn who_is_to_arrive_at_a_time_does() {
        let mut motion = motion();
        let way = points(&[[4.0, 1.0], [4.0, 3.0]]);
        motion.walk(2.0, &way, Pace::Arrive(12.0)).unwrap();
        assert!((motion.end_s() - 12.0).abs() < 1e-6);
        assert!(matches!(
            motion.walk(12.0, &points(&[[0.0, 0.0]]), Pace::Arrive(13.0)),
            Err(Refusal::TooFast(_) | Refusal::NoTime)
        ));
        assert_eq!(motion.turn(11.0, 0.0, None), Err(Refusal::Busy(motion.end_s())));
    }

    #[test]
    fn who_leaves_is_away_until_they_come_in() {
        let mut motion = motion();
        motion
            .leave(0.0, &points(&[[0.0, 1.0], [-0.5, 1.0]]), Pace::Speed(1.2))
            .unwrap();
        let gone = motion.end_s();
        assert!(motion.stance(gone - 0.01).present && !motion.stance(gone).present);
        assert_eq!(motion.turn(gone + 1.0, 0.0, None), Err(Refusal::Away));
        let door = Point2::new(-0.5, 1.0);
        motion
            .enter(gone + 2.0, door, &points(&[[1.0, 1.0]]), Pace::Speed(1.0))
            .unwrap();
        assert!(motion.stance(gone + 2.1).present);
        assert_eq!(
            motion.enter(60.0, door, &points(&[[1.0, 1.0]]), Pace::Speed(1.0)),
            Err(Refusal::Present)
        );
        assert_eq!(motion.appearances().count(), 2);
    }
}
