//! People: where they begin, where they look, and what becomes of their actions and turns.

use super::names::Thing;
use super::raw::{RawDirection, RawPerson, RawScene};
use super::resolve::Resolver;
use super::surroundings::Surroundings;
use crate::acoustics::random::{between, derive, generator};
use crate::world::{Character, Figure, Gesture, Look, Looks, Motion, Person, Rest, Target};
use hearsight_core::WorldPoint;
use hearsight_core::configuration::{ConfigurationError, Field};
use nalgebra::{Point2, Vector2};

/// Height of what somebody sits on who sits down `here`, metres.
pub(super) const SEAT_M: f64 = 0.45;

/// After this long people notice who speaks, seconds: from and to.
const NOTICE_S: [f64; 2] = [0.25, 0.7];

/// The longest turn, seconds: voices take no longer ones.
const LONGEST_TURN_S: f64 = 3600.0;

/// What is looked at, before all turns are known.
#[derive(Clone, Copy, Debug)]
pub(super) enum Wish {
    At(Target),
    Speaker,
}

/// One person on the way to being resolved.
pub(super) struct Draft {
    pub(super) looks: Looks,
    pub(super) motion: Motion,
    pub(super) gestures: Vec<Gesture>,
    pub(super) wishes: Vec<(f64, Wish)>,
    pub(super) turns: Vec<[f64; 2]>,
    pub(super) seed: u64,
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
            if until - from > LONGEST_TURN_S {
                let what = format!("speaks for {} s", until - from);
                let cure = "a turn lasts up to 3600 s: write several";
                return Err(self.wrong(&turns.index(number), what, cure));
            }
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
    pub(super) fn seat(
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

    pub(super) fn wish(&self, field: &Field, direction: &RawDirection) -> Result<Wish, ConfigurationError> {
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
}

/// The first time within a span at which somebody is not in the room.
pub(super) fn first_absence(motion: &Motion, from: f64, until: f64) -> Option<f64> {
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
