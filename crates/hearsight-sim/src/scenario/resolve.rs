//! Raw scenario to a world: defaults, and what belongs to no part alone.

use super::names::Thing;
use super::raw::RawScene;
use crate::acoustics::random::derive;
use crate::world::World;
use hearsight_core::WorldPoint;
use hearsight_core::configuration::{ConfigurationError, Document, Field, Overrides, parse};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// The longest scenario, seconds: two hours. All that is said in it is held in memory.
const LONGEST_S: f64 = 7200.0;

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
        return Err(document.error(&Field::of("seconds"), what, "give seconds from 0 to 7200"));
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

/// What every step needs.
pub(super) struct Resolver {
    pub(super) document: Document,
    directory: PathBuf,
    pub(super) seconds: f64,
    pub(super) seed: u64,
    pub(super) size_m: [f64; 3],
    pub(super) names: BTreeMap<String, (Thing, Field)>,
    /// When the actions of each person that move the body begin, with their numbers.
    pub(super) actions: Vec<Vec<(f64, usize)>>,
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
        let (cameras, mut commands) = self.cameras(raw, &surroundings)?;
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

    /// The last action of a person that moved the body and began by a time.
    pub(super) fn actions_before(&self, person: usize, time_s: f64) -> Option<usize> {
        let actions = self.actions.get(person)?.iter().rev();
        let mut begun = actions.filter(|(time, _)| *time <= time_s);
        begun.next().map(|(_, number)| *number)
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
}
