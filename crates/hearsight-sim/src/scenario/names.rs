//! Names: what they stand for, and directions that name things.

use super::raw::{RawDirection, RawScene};
use super::resolve::Resolver;
use hearsight_core::WorldPoint;
use hearsight_core::configuration::{ConfigurationError, Field, nearest, suggest};

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Thing {
    /// A person by number, and where they are at the beginning.
    Person(usize, Option<[f64; 2]>),
    /// A door by number.
    Door(usize),
    /// A piece of furniture by number, and its middle.
    Furniture(usize, WorldPoint),
    /// A base by number.
    Base(usize),
    /// A camera or array, and its place where it does not move.
    Sensor(Option<WorldPoint>),
    /// A sound, and its place where it has one.
    Noise(Option<WorldPoint>),
}

impl Resolver {
    pub(super) fn name_everything(&mut self, raw: &RawScene) -> Result<(), ConfigurationError> {
        for (number, person) in raw.person.iter().enumerate() {
            let moves = person.action.iter().enumerate().filter_map(|(place, action)| {
                (action.look.is_none() && action.gesture.is_none()).then_some((action.time?, place))
            });
            self.actions.push(moves.collect());
            let field = Field::of("person").index(number);
            let thing = Thing::Person(number, person.at);
            self.take_name(
                &field,
                person.name.clone(),
                format!("person{}", number + 1),
                thing,
            )?;
        }
        let doors = raw.room.door.len();
        for (number, door) in raw.room.door.iter().enumerate() {
            let field = Field::of("room").key("door").index(number);
            let default = if doors == 1 {
                "door".to_owned()
            } else {
                format!("door{}", number + 1)
            };
            self.take_name(&field, door.name.clone(), default, Thing::Door(number))?;
        }
        for (number, furniture) in raw.furniture.iter().enumerate() {
            let field = Field::of("furniture").index(number);
            let [x, y] = furniture.at.unwrap_or_default();
            let place = WorldPoint::new(x, y, 0.8);
            let default = format!("{}{}", super::furniture::kind_name(furniture.kind), number + 1);
            self.take_name(
                &field,
                furniture.name.clone(),
                default,
                Thing::Furniture(number, place),
            )?;
        }
        for (number, base) in raw.base.iter().enumerate() {
            let field = Field::of("base").index(number);
            self.take_name(
                &field,
                base.name.clone(),
                format!("base{}", number + 1),
                Thing::Base(number),
            )?;
        }
        for (number, noise) in raw.noise.iter().enumerate() {
            let field = Field::of("noise").index(number);
            let place = noise.at.map(|[x, y, z]| WorldPoint::new(x, y, z));
            let default = format!("{}{}", super::sounds::kind_name(noise.kind), number + 1);
            self.take_name(&field, noise.name.clone(), default, Thing::Noise(place))?;
        }
        for (number, camera) in raw.camera.iter().enumerate() {
            let field = Field::of("camera").index(number);
            let place = camera.at.filter(|_| camera.base.is_none());
            let thing = Thing::Sensor(place.map(|[x, y, z]| WorldPoint::new(x, y, z)));
            self.take_name(&field, camera.name.clone(), format!("cam{}", number + 1), thing)?;
        }
        for (number, array) in raw.array.iter().enumerate() {
            let field = Field::of("array").index(number);
            let place = array.at.filter(|_| array.base.is_none());
            let thing = Thing::Sensor(place.map(|[x, y, z]| WorldPoint::new(x, y, z)));
            self.take_name(&field, array.name.clone(), format!("array{}", number + 1), thing)?;
        }
        Ok(())
    }

    fn take_name(
        &mut self,
        field: &Field,
        given: Option<String>,
        default: String,
        thing: Thing,
    ) -> Result<(), ConfigurationError> {
        let name = given.unwrap_or(default);
        let at = field.key("name");
        self.good_name(&at, &name)?;
        if let Some((_, other)) = self.names.get(&name) {
            let what = format!("`{name}` is already the name of {other}");
            return Err(self.wrong(&at, what, "give each person and thing a name of its own"));
        }
        self.names.insert(name, (thing, field.clone()));
        Ok(())
    }

    /// The name that was given to the entry of a field.
    pub(super) fn name_of(&self, field: &Field) -> String {
        let found = self.names.iter().find(|(_, (_, other))| other == field);
        found.map_or_else(|| field.to_string(), |(name, _)| name.clone())
    }

    /// What a name stands for, of those that `fits` takes.
    pub(super) fn find<T>(
        &self,
        field: &Field,
        name: &str,
        what: &str,
        fits: impl Fn(Thing) -> Option<T>,
    ) -> Result<T, ConfigurationError> {
        if let Some(found) = self.names.get(name).and_then(|(thing, _)| fits(*thing)) {
            return Ok(found);
        }
        let known = self.names.iter().filter(|(_, (thing, _))| fits(*thing).is_some());
        let known: Vec<&str> = known.map(|(name, _)| name.as_str()).collect();
        let message = match self.names.get(name) {
            Some((_, other)) => format!("`{name}` is {other}, not {what}"),
            None => format!("there is no {what} `{name}`"),
        };
        Err(self.wrong(field, message, suggest(name, &known)))
    }

    /// Where something is that a direction names; `None` for degrees.
    pub(super) fn target(
        &self,
        field: &Field,
        direction: &RawDirection,
    ) -> Result<Option<WorldPoint>, ConfigurationError> {
        Ok(match direction {
            RawDirection::Degrees(degrees) if degrees.is_finite() => None,
            RawDirection::Degrees(_) => return Err(self.wrong(field, "is not finite", "give degrees")),
            RawDirection::Floor([x, y]) => Some(self.point(field, [*x, *y, 1.0])?),
            RawDirection::Place(place) => Some(self.point(field, *place)?),
            RawDirection::Name(name) => {
                Some(
                    self.find(field, name, "person or thing at a place", |thing| match thing {
                        Thing::Person(_, place) => place.map(|[x, y]| WorldPoint::new(x, y, 1.5)),
                        Thing::Furniture(_, place) => Some(place),
                        Thing::Sensor(place) | Thing::Noise(place) => place,
                        Thing::Door(_) | Thing::Base(_) => None,
                    })?,
                )
            }
        })
    }

    pub(super) fn good_name(&self, field: &Field, name: &str) -> Result<(), ConfigurationError> {
        let bad = name
            .chars()
            .find(|&c| c.is_whitespace() || c.is_control() || "/\\,".contains(c));
        let what = match bad {
            None if !name.is_empty() && !name.starts_with('.') => return Ok(()),
            None => format!("`{name}` is no name"),
            Some(bad) => format!("the name `{name}` contains {bad:?}"),
        };
        Err(self.wrong(
            field,
            what,
            "names become names of files: use letters, digits, `-` and `_`",
        ))
    }

    /// The known word nearest to one that is not known, as a cure.
    pub(super) fn did_you_mean(word: &str, known: &[&str]) -> String {
        match nearest(word, known.iter().copied()) {
            Some(candidate) => format!("did you mean `{candidate}`?"),
            None => format!("known are {}", known.join(", ")),
        }
    }
}
