//! Raw scenario to a world: defaults, names, and what belongs to no part alone.

use super::raw::{RawDirection, RawScene};
use crate::acoustics::random::derive;
use crate::world::World;
use hearsight_core::WorldPoint;
use hearsight_core::configuration::{
    ConfigurationError, Document, Field, Overrides, nearest, parse, suggest,
};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// Scenarios beyond this are slips, seconds: a day.
const LONGEST_S: f64 = 86_400.0;
const DEFAULT_SECONDS: f64 = 20.0;
const DEFAULT_SEED: u64 = 1;
const DEFAULT_SIZE_M: [f64; 3] = [6.0, 5.0, 2.7];
/// Most of anything in a room, so that a slip does not fill memory.
const MOST_ENTRIES: usize = 1000;

/// Reads and resolves a scenario file, with `overrides` laid over it.
///
/// # Errors
/// [`ConfigurationError`] where the file cannot be read or something in it is wrong.
pub fn load(path: &Path, overrides: &Overrides) -> Result<World, ConfigurationError> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|error| {
        let cure = match error.kind() {
            std::io::ErrorKind::NotFound => "check the path; scenes/ holds examples",
            std::io::ErrorKind::IsADirectory => "name the scenario file inside the directory",
            std::io::ErrorKind::InvalidData => "a scenario is text (TOML, UTF-8)",
            _ => "check that the file may be read",
        };
        Document::new(&name, "").error(&Field::default(), format!("cannot be read: {error}"), cure)
    })?;
    let raw: RawScene = parse(&name, &text, overrides)?;
    let directory = path.parent().unwrap_or(Path::new(""));
    let stem = path
        .file_stem()
        .map_or_else(|| "scene".into(), |stem| stem.to_string_lossy().into_owned());
    resolve(&raw, &name, &text, directory, &stem)
}

/// Resolves a raw scenario. `name` and `text` are those of the file, for errors; paths are relative to `directory`;
/// `scene_name` is the scenario's name where it gives none.
///
/// # Errors
/// [`ConfigurationError`] where something in it is wrong.
pub fn resolve(
    raw: &RawScene,
    name: &str,
    text: &str,
    directory: &Path,
    scene_name: &str,
) -> Result<World, ConfigurationError> {
    let document = Document::new(name, text);
    let seconds = raw.seconds.unwrap_or(DEFAULT_SECONDS);
    if !(seconds.is_finite() && seconds > 0.0 && seconds <= LONGEST_S) {
        let what = format!("{seconds} s is no length");
        return Err(document.error(&Field::of("seconds"), what, "give seconds from 0 to 86400"));
    }
    let size_m = raw.room.size.unwrap_or(DEFAULT_SIZE_M);
    for (axis, length) in size_m.iter().enumerate() {
        if !(1.0..=100.0).contains(length) {
            let what = format!("{length} m is no size of a room");
            let at = Field::of("room").key("size").index(axis);
            return Err(document.error(&at, what, "give 1 to 100 metres"));
        }
    }
    let resolver = Resolver {
        document,
        directory: directory.to_path_buf(),
        seconds,
        seed: raw.seed.unwrap_or(DEFAULT_SEED),
        size_m,
        names: BTreeMap::new(),
        actions: Vec::new(),
    };
    resolver.world(raw, scene_name)
}

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

/// What every step needs.
pub(super) struct Resolver {
    pub(super) document: Document,
    directory: PathBuf,
    pub(super) seconds: f64,
    pub(super) seed: u64,
    pub(super) size_m: [f64; 3],
    names: BTreeMap<String, (Thing, Field)>,
    /// When the actions of each person that move the body begin, with their numbers.
    actions: Vec<Vec<(f64, usize)>>,
}

impl Resolver {
    fn world(mut self, raw: &RawScene, scene_name: &str) -> Result<World, ConfigurationError> {
        let name = raw.name.clone().unwrap_or_else(|| scene_name.to_owned());
        self.good_name(&Field::of("name"), &name)?;
        let speed_of_sound_m_s = self.number(
            &Field::of("speed_of_sound"),
            raw.speed_of_sound,
            343.0,
            [200.0, 2000.0],
            "air at 20 degrees has 343",
        )?;
        for (key, length) in [
            ("furniture", raw.furniture.len()),
            ("light", raw.light.len()),
            ("person", raw.person.len()),
            ("noise", raw.noise.len()),
            ("camera", raw.camera.len()),
            ("array", raw.array.len()),
        ] {
            if length > MOST_ENTRIES {
                return Err(self.wrong(
                    &Field::of(key),
                    format!("has {length} entries"),
                    "1000 are the most",
                ));
            }
        }
        let t60_s = self.number(
            &Field::of("room").key("t60"),
            raw.room.t60,
            0.4,
            [0.0, 10.0],
            "rooms have 0.2 to 2 s; 0 is for no reflections",
        )?;
        // Names first, so that anything may speak of anything.
        self.name_everything(raw)?;
        let surroundings = self.surroundings(raw)?;
        let (bases, base_commands) = self.bases(raw)?;
        let (cameras, mut commands) = self.cameras(raw)?;
        commands.extend(base_commands);
        commands.sort_by_key(|command| command.time);
        let arrays = self.arrays(raw, &cameras)?;
        let people = self.people(raw, &surroundings)?;
        let noises = self.noises(raw)?;
        let world = World {
            name,
            seconds: self.seconds,
            seed: self.seed,
            speed_of_sound_m_s,
            t60_s,
            setting: surroundings.setting.clone(),
            lamp_changes: surroundings.lamp_changes.clone(),
            people,
            noises,
            bases,
            cameras,
            arrays,
            commands,
            system: raw.system.clone(),
        };
        self.check_motion(&world, &surroundings)?;
        Ok(world)
    }

    fn name_everything(&mut self, raw: &RawScene) -> Result<(), ConfigurationError> {
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
            let default = format!("{}{}", super::surroundings::kind_name(furniture.kind), number + 1);
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

    /// The last action of a person that moved the body and began by a time.
    pub(super) fn actions_before(&self, person: usize, time_s: f64) -> Option<usize> {
        let actions = self.actions.get(person)?.iter().rev();
        let mut begun = actions.filter(|(time, _)| *time <= time_s);
        begun.next().map(|(_, number)| *number)
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

    pub(super) fn point(&self, field: &Field, place: [f64; 3]) -> Result<WorldPoint, ConfigurationError> {
        if place
            .iter()
            .all(|value| value.is_finite() && value.abs() < 1000.0)
        {
            return Ok(WorldPoint::new(place[0], place[1], place[2]));
        }
        Err(self.wrong(
            field,
            format!("{place:?} is in no room"),
            "give finite coordinates in metres",
        ))
    }

    /// A place inside the room.
    pub(super) fn inside(&self, field: &Field, place: [f64; 3]) -> Result<WorldPoint, ConfigurationError> {
        let [x, y, z] = self.size_m;
        if place
            .iter()
            .zip(self.size_m)
            .all(|(value, size)| (0.0..=size).contains(value))
        {
            return self.point(field, place);
        }
        let what = format!("{place:?} is outside the room, which spans [0, 0, 0] to [{x}, {y}, {z}] m");
        Err(self.wrong(field, what, "move it inside, or make `room.size` larger"))
    }

    /// A number within a range, or its default.
    pub(super) fn number(
        &self,
        field: &Field,
        given: Option<f64>,
        default: f64,
        [low, high]: [f64; 2],
        cure: &str,
    ) -> Result<f64, ConfigurationError> {
        match given {
            None => Ok(default),
            Some(value) if (low..=high).contains(&value) => Ok(value),
            Some(value) => {
                let what = format!("{value} is not from {low} to {high}");
                Err(self.wrong(field, what, cure))
            }
        }
    }

    /// Spans of time in order and without overlap.
    pub(super) fn spans(
        &self,
        field: &Field,
        spans: &[[f64; 2]],
        what: &str,
    ) -> Result<(), ConfigurationError> {
        for (number, [from, until]) in spans.iter().enumerate() {
            let at = field.index(number);
            if !(from.is_finite() && until.is_finite() && *from >= 0.0 && until > from) {
                let problem = format!("from {from} to {until} s is no span of time");
                return Err(self.wrong(
                    &at,
                    problem,
                    "write [from, until] in seconds, the end after the beginning",
                ));
            }
            if let Some(before) = number.checked_sub(1).map(|before| spans[before])
                && *from < before[1]
            {
                let problem = format!(
                    "{what} from {from} s begins before the one before ends, at {} s",
                    before[1]
                );
                return Err(self.wrong(&at, problem, "write them in order of time and without overlap"));
            }
        }
        Ok(())
    }

    pub(super) fn wrong(
        &self,
        field: &Field,
        what: impl Display,
        cure: impl Into<String>,
    ) -> ConfigurationError {
        self.document.error(field, what, cure)
    }

    pub(super) fn missing(&self, field: &Field, key: &str, cure: &str) -> ConfigurationError {
        self.wrong(field, format!("has no `{key}`"), cure)
    }

    /// A file or folder that must be there.
    pub(super) fn existing(&self, field: &Field, path: &str) -> Result<PathBuf, ConfigurationError> {
        let path = self.directory.join(path);
        if path.exists() {
            return Ok(path);
        }
        let what = format!("{} is not there", path.display());
        Err(self.wrong(field, what, "check the path; it is relative to this file"))
    }

    /// The seed of something of a name: it does not change when others are added.
    pub(super) fn seed_of(&self, role: &str, name: &str) -> u64 {
        derive(derive(self.seed, role, 0), name, 1)
    }

    fn good_name(&self, field: &Field, name: &str) -> Result<(), ConfigurationError> {
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
