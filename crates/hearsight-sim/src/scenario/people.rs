//! People: what they do, where they look, when they speak.

use super::raw::{RawAction, RawDirection, RawPerson, RawScene};
use super::resolve::{Resolver, Thing};
use super::surroundings::{Door, OUTSIDE_M, Surroundings, THRESHOLD_M};
use crate::acoustics::random::{between, derive, generator};
use crate::voice::draw_turns;
use crate::world::{
    Character, Figure, Gesture, LARGEST_JERK_M_S, LARGEST_SPEED_M_S, Look, Looks, Motion, Pace, Person,
    Refusal, Rest, Target,
};
use hearsight_core::WorldPoint;
use hearsight_core::configuration::{ConfigurationError, Field};
use nalgebra::{Point2, Vector2};

const USUAL_SPEED_M_S: f64 = 1.1;
/// Height of what somebody sits on who sits down `here`, metres.
const SEAT_M: f64 = 0.45;
/// How far a seat may be from who sits down on it, metres.
const SEAT_REACH_M: f64 = 1.2;
/// After this long people notice who speaks, seconds: from and to.
const NOTICE_S: [f64; 2] = [0.25, 0.7];
/// Rests of those who walk about, seconds: from and to.
const WANDER_REST_S: [f64; 2] = [0.5, 4.0];

/// What is looked at, before all turns are known.
#[derive(Clone, Copy, Debug)]
enum Wish {
    At(Target),
    Speaker,
}

/// One person on the way to being resolved.
struct Draft {
    looks: Looks,
    motion: Motion,
    gestures: Vec<Gesture>,
    wishes: Vec<(f64, Wish)>,
    turns: Vec<[f64; 2]>,
    seed: u64,
}

impl Resolver {
    pub(super) fn people(
        &self,
        raw: &RawScene,
        surroundings: &Surroundings,
    ) -> Result<Vec<Person>, ConfigurationError> {
        let mut drafts = Vec::new();
        for (number, person) in raw.person.iter().enumerate() {
            drafts.push(self.draft(&Field::of("person").index(number), person, surroundings)?);
        }
        self.conversations(raw, &mut drafts)?;
        let turns: Vec<Vec<[f64; 2]>> = drafts.iter().map(|draft| draft.turns.clone()).collect();
        let mut people = Vec::new();
        for (number, draft) in drafts.into_iter().enumerate() {
            let field = Field::of("person").index(number);
            let figure = Figure::of(&draft.looks);
            people.push(Person {
                id: number as u64 + 1,
                name: self.name_of(&field),
                figure,
                character: Character::new(draft.seed),
                gaze: gaze(number, &draft.wishes, &turns, draft.seed),
                motion: draft.motion,
                gestures: draft.gestures,
                turns: draft.turns,
                voice: self.voice(
                    &field.key("voice"),
                    &raw.person[number].voice,
                    draft.looks.height_m,
                    derive(draft.seed, "voice", 0),
                )?,
                speech: None,
                looks: draft.looks,
            });
        }
        Ok(people)
    }

    fn draft(
        &self,
        field: &Field,
        raw: &RawPerson,
        surroundings: &Surroundings,
    ) -> Result<Draft, ConfigurationError> {
        let seed = raw
            .seed
            .unwrap_or_else(|| self.seed_of("person", &self.name_of(field)));
        let looks = self.looks(field, raw, seed)?;
        let figure = Figure::of(&looks);
        let start = self.start(field, raw, surroundings)?;
        let mut draft = Draft {
            motion: Motion::new(start, [figure.stride_m(0.0), figure.stride_m(1.0)]),
            looks,
            gestures: Vec::new(),
            wishes: Vec::new(),
            turns: Vec::new(),
            seed,
        };
        if let Some(look) = &raw.look {
            let wish = self.wish(&field.key("look"), look)?;
            draft.wishes.push((f64::NEG_INFINITY, wish));
        }
        let mut last = 0.0;
        for (number, action) in raw.action.iter().enumerate() {
            let at = field.key("action").index(number);
            let Some(time) = action.time else {
                return Err(self.missing(&at, "time", "say when it begins, in seconds"));
            };
            if !(time.is_finite() && time >= 0.0) {
                let what = format!("{time} is no time of the scenario");
                return Err(self.wrong(&at.key("time"), what, "give seconds from its beginning"));
            }
            if time < last {
                let what = format!("{time} s is before the action before, at {last} s");
                return Err(self.wrong(&at.key("time"), what, "write actions in order of time"));
            }
            last = time;
            self.act(&at, action, time, surroundings, &mut draft)?;
        }
        let turns = field.key("turns");
        self.spans(&turns, &raw.turns, "a turn")?;
        for (number, [from, until]) in raw.turns.iter().enumerate() {
            if let Some(away) = first_absence(&draft.motion, *from, *until) {
                let what = format!("speaks from {from} to {until} s, but is not in the room at {away:.2} s");
                return Err(self.wrong(
                    &turns.index(number),
                    what,
                    "let them come in before, or speak later",
                ));
            }
        }
        draft.turns.clone_from(&raw.turns);
        Ok(draft)
    }

    /// Where and how somebody is at the beginning.
    fn start(
        &self,
        field: &Field,
        raw: &RawPerson,
        surroundings: &Surroundings,
    ) -> Result<Rest, ConfigurationError> {
        let middle = Point2::new(0.5 * self.size_m[0], 0.5 * self.size_m[1]);
        let seat = match raw.sit.as_deref() {
            None | Some("here") => None,
            Some(name) => Some(self.seat(&field.key("sit"), name, surroundings)?),
        };
        let place = match (raw.at, &seat) {
            (Some([x, y]), _) => {
                self.inside(&field.key("at"), [x, y, 0.0])?;
                Point2::new(x, y)
            }
            (None, Some(seat)) => seat.0,
            (None, None) => {
                if raw.sit.is_some() {
                    return Err(self.missing(field, "at", "say where they sit"));
                }
                let enters = raw.action.iter().any(|action| action.enter.is_some());
                if !enters {
                    let cure = "give the place on the floor, [x, y], or let them `enter`";
                    return Err(self.missing(field, "at", cure));
                }
                return Ok(Rest {
                    place: middle,
                    facing_rad: 0.0,
                    seat_m: None,
                    present: false,
                });
            }
        };
        let towards = |target: Point2<f64>| (target.y - place.y).atan2(target.x - place.x);
        let facing_rad = match (&raw.facing, &seat) {
            (Some(facing), _) => self.bearing(&field.key("facing"), facing, place)?,
            (None, Some(seat)) => seat.1,
            (None, None) => towards(middle),
        };
        Ok(Rest {
            place: seat.map_or(place, |seat| seat.0),
            facing_rad,
            seat_m: seat.map(|seat| seat.2).or(raw.sit.as_ref().map(|_| SEAT_M)),
            present: true,
        })
    }

    /// Place, direction and height of a seat.
    fn seat(
        &self,
        field: &Field,
        name: &str,
        surroundings: &Surroundings,
    ) -> Result<(Point2<f64>, f64, f64), ConfigurationError> {
        let seats = surroundings
            .footprints
            .iter()
            .filter(|piece| piece.seat_m.is_some());
        let seats: Vec<&str> = seats.map(|piece| piece.name.as_str()).collect();
        let piece = surroundings.footprints.iter().find(|piece| piece.name == name);
        match piece.and_then(|piece| Some((piece, piece.seat_m?))) {
            Some((piece, seat_m)) => Ok((piece.centre, piece.yaw_rad, seat_m)),
            None if seats.is_empty() => {
                let cure = "add [[furniture]] with kind = \"chair\", or write \"here\"";
                Err(self.wrong(field, format!("there is no seat `{name}`"), cure))
            }
            None => {
                let cure = format!(
                    "{} \"here\" sits down without one",
                    Self::did_you_mean(name, &seats)
                );
                Err(self.wrong(field, format!("there is no seat `{name}`"), cure))
            }
        }
    }

    /// A direction on the floor from a place, radians.
    pub(super) fn bearing(
        &self,
        field: &Field,
        direction: &RawDirection,
        from: Point2<f64>,
    ) -> Result<f64, ConfigurationError> {
        if let (RawDirection::Degrees(degrees), None) = (direction, self.target(field, direction)?) {
            return Ok(degrees.to_radians());
        }
        let Some(target) = self.target(field, direction)? else {
            return Ok(0.0);
        };
        let way = Vector2::new(target.0.x - from.x, target.0.y - from.y);
        if way.norm() < 1e-6 {
            return Err(self.wrong(
                field,
                "is the very place where they stand",
                "give degrees or another place",
            ));
        }
        Ok(way.y.atan2(way.x))
    }

    fn wish(&self, field: &Field, direction: &RawDirection) -> Result<Wish, ConfigurationError> {
        Ok(match direction {
            RawDirection::Name(name) if name == "speaker" => Wish::Speaker,
            RawDirection::Name(name) if name == "ahead" => Wish::At(Target::Ahead),
            RawDirection::Name(name) => {
                let person = self.find(field, name, "person or thing at a place", |thing| match thing {
                    Thing::Person(number, _) => Some(Some(number)),
                    Thing::Furniture(..) | Thing::Sensor(Some(_)) | Thing::Noise(Some(_)) => Some(None),
                    _ => None,
                })?;
                match person {
                    Some(number) => Wish::At(Target::Person(number)),
                    None => Wish::At(
                        self.target(field, direction)?
                            .map_or(Target::Ahead, Target::Place),
                    ),
                }
            }
            RawDirection::Degrees(degrees) => {
                self.target(field, direction)?;
                Wish::At(Target::Direction(degrees.to_radians()))
            }
            RawDirection::Floor([x, y]) => Wish::At(Target::Place(WorldPoint::new(*x, *y, 1.4))),
            RawDirection::Place(_) => Wish::At(
                self.target(field, direction)?
                    .map_or(Target::Ahead, Target::Place),
            ),
        })
    }

    /// Adds one action.
    fn act(
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

    fn pace(&self, field: &Field, raw: &RawAction, time: f64) -> Result<Pace, ConfigurationError> {
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
    fn refused(&self, field: &Field, time: f64, fastest: f64, refusal: Refusal) -> ConfigurationError {
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

    /// Walks between drawn places with rests until a time.
    fn wander(
        &self,
        field: &Field,
        raw: &RawAction,
        time: f64,
        surroundings: &Surroundings,
        draft: &mut Draft,
    ) -> Result<(), ConfigurationError> {
        let area = raw.wander.unwrap_or_default();
        let at = field.key("wander");
        for (number, [x, y]) in area.iter().enumerate() {
            self.inside(&at.index(number), [*x, *y, 0.0])?;
        }
        let Some(until) = raw.until.filter(|until| until.is_finite() && *until > time) else {
            return Err(self.missing(field, "until", "say when they stop walking about, in seconds"));
        };
        let speed = match self.pace(
            field,
            &RawAction {
                until: None,
                ..raw.clone()
            },
            time,
        )? {
            Pace::Speed(speed) => speed,
            Pace::Arrive(_) => USUAL_SPEED_M_S,
        };
        let radius = Figure::of(&draft.looks).radius_m + 0.1;
        let mut random = generator(draft.seed, "wander", (time * 1000.0) as u64);
        let mut now = time.max(draft.motion.end_s());
        while now < until {
            let here = draft.motion.end().place;
            let found = (0..100).find_map(|_| {
                let x = between(
                    &mut random,
                    area[0][0].min(area[1][0]),
                    area[0][0].max(area[1][0]) + 1e-9,
                );
                let y = between(
                    &mut random,
                    area[0][1].min(area[1][1]),
                    area[0][1].max(area[1][1]) + 1e-9,
                );
                let there = Point2::new(x, y);
                ((there - here).norm() > 0.4 && self.is_free(here, there, radius, surroundings))
                    .then_some(there)
            });
            let Some(there) = found else {
                let what = format!("finds no way from ({:.2}, {:.2})", here.x, here.y);
                return Err(self.wrong(&at, what, "make the area larger, or move furniture out of it"));
            };
            let before = draft.motion.clone();
            let walked = draft.motion.walk(now, &[there], Pace::Speed(speed));
            walked.map_err(|refusal| self.refused(field, time, LARGEST_SPEED_M_S, refusal))?;
            if draft.motion.end_s() > until {
                draft.motion = before;
                break;
            }
            now = draft.motion.end_s() + between(&mut random, WANDER_REST_S[0], WANDER_REST_S[1]);
        }
        Ok(())
    }

    /// Whether a straight way is free of walls and furniture.
    fn is_free(&self, from: Point2<f64>, to: Point2<f64>, radius: f64, surroundings: &Surroundings) -> bool {
        let way = to - from;
        let steps = (way.norm() / 0.1).ceil().max(1.0) as usize;
        (1..=steps).all(|step| {
            let place = from + way * (step as f64 / steps as f64);
            let inside = place.x >= radius
                && place.y >= radius
                && place.x <= self.size_m[0] - radius
                && place.y <= self.size_m[1] - radius;
            inside
                && !surroundings
                    .footprints
                    .iter()
                    .any(|piece| piece.heights_m[0] < 1.9 && piece.touches(place, radius))
        })
    }

    /// Draws the turns of conversations.
    fn conversations(&self, raw: &RawScene, drafts: &mut [Draft]) -> Result<(), ConfigurationError> {
        for (number, conversation) in raw.conversation.iter().enumerate() {
            let field = Field::of("conversation").index(number);
            let mut members = Vec::new();
            for (place, name) in conversation.people.iter().enumerate() {
                let at = field.key("people").index(place);
                let person = self.find(&at, name, "person", |thing| match thing {
                    Thing::Person(number, _) => Some(number),
                    _ => None,
                })?;
                if members.contains(&person) {
                    return Err(self.wrong(&at, format!("`{name}` takes part twice"), "name everybody once"));
                }
                members.push(person);
            }
            if conversation.people.is_empty() {
                members = (0..drafts.len()).collect();
            }
            if members.is_empty() {
                return Err(self.wrong(&field, "has nobody to take part", "add a [[person]]"));
            }
            let from = conversation.from.unwrap_or(0.5);
            let until = conversation.until.unwrap_or(self.seconds - 0.5);
            if !(from.is_finite() && until.is_finite() && from >= 0.0) {
                return Err(self.wrong(
                    &field,
                    "has no span of time",
                    "give `from` and `until` in seconds",
                ));
            }
            let mut settings = conversation.turns;
            if members.len() == 1 {
                settings.overlap = 0.0;
            }
            let seed = derive(self.seed, "conversation", number as u64);
            let turns = draw_turns(&settings, members.len(), from, until.max(from), seed)
                .map_err(|error| self.wrong(&field.key("turns"), error, "see `hearsight schema scenario`"))?;
            for turn in turns {
                let person = members[turn.person];
                let draft = &mut drafts[person];
                let [start, mut end] = [turn.start_s, turn.end_s];
                // Who is away says nothing, and who leaves stops talking.
                match first_absence(&draft.motion, start, end) {
                    Some(away) if away - start < 0.3 => continue,
                    Some(away) => end = away,
                    None => {}
                }
                if let Some(other) = draft
                    .turns
                    .iter()
                    .find(|other| other[0] < end && start < other[1])
                {
                    let name = self.name_of(&Field::of("person").index(person));
                    let what = format!(
                        "`{name}` already speaks from {:.2} to {:.2} s: the turn drawn at {start:.2} s overlaps it",
                        other[0], other[1]
                    );
                    let cure =
                        "write the turns of a person or draw them, or let the conversation have another time";
                    return Err(self.wrong(&field, what, cure));
                }
                draft.turns.push([start, end]);
            }
            for draft in &mut *drafts {
                draft.turns.sort_by(|one, other| one[0].total_cmp(&other[0]));
            }
        }
        Ok(())
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

/// The first time within a span at which somebody is not in the room.
fn first_absence(motion: &Motion, from: f64, until: f64) -> Option<f64> {
    if !motion.stance(from).present {
        return Some(from);
    }
    motion
        .appearances()
        .find(|(time, present)| !present && *time > from && *time < until)
        .map(|(time, _)| time)
}

/// Where somebody looks: what they wish, and who speaks where they look at the speaker.
fn gaze(person: usize, wishes: &[(f64, Wish)], turns: &[Vec<[f64; 2]>], seed: u64) -> Vec<Look> {
    let mut looks = Vec::new();
    let mut random = generator(seed, "gaze", 0);
    for (number, (from, wish)) in wishes.iter().enumerate() {
        let until = wishes.get(number + 1).map_or(f64::INFINITY, |next| next.0);
        match wish {
            Wish::At(target) => looks.push(Look {
                from_s: *from,
                target: *target,
            }),
            Wish::Speaker => {
                let mut begun: Vec<(f64, usize)> = Vec::new();
                for (other, own) in turns.iter().enumerate() {
                    begun.extend(own.iter().map(|turn| (turn[0], other)));
                }
                begun.sort_by(|one, other| one.0.total_cmp(&other.0));
                let mut last = None;
                for (time, speaker) in begun {
                    let noticed = time + between(&mut random, NOTICE_S[0], NOTICE_S[1]);
                    if speaker != person {
                        last = Some(speaker);
                    }
                    // Who speaks keeps looking at who spoke before.
                    let target = last.map_or(Target::Ahead, Target::Person);
                    if noticed < until && speaker != person {
                        looks.push(Look {
                            from_s: noticed.max(*from),
                            target,
                        });
                    }
                }
            }
        }
    }
    looks.sort_by(|one: &Look, other| one.from_s.total_cmp(&other.from_s));
    looks
}
