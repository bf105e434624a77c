//! Raw configuration to resolved objects: defaults, files of geometry, and whether it all makes sense.

use super::panoramas::Cameras;
use super::parameters::Checker;
use super::parse::parse;
use super::raw::{RawRoom, RawRun, RawSystem};
use super::resolved::{ResolvedOutput, ResolvedRoom, ResolvedRun, ResolvedSystem};
use crate::sinks;
use hearsight_core::configuration::ConfigurationError;
use hearsight_core::configuration::{Document, Field, Overrides, suggest};
use hearsight_core::microphones::SPEED_OF_SOUND_M_S;
use hearsight_core::{Instant, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

const DEFAULT_SYSTEM: &str = "stac";
const DEFAULT_SEED: u64 = 1;
/// Times beyond this are slips: the clock counts nanoseconds and ends at 292 years.
const LONGEST_TIME_S: f64 = 1e9;

/// Reads and resolves a `room.toml`.
///
/// # Errors
/// [`ConfigurationError`] where the file or one that it names cannot be read, or something in it is wrong.
pub fn load_room(path: &Path) -> Result<ResolvedRoom, ConfigurationError> {
    load(path, &Overrides::new())
}

/// Reads and resolves a `room.toml`, with `overrides` laid over it.
///
/// # Errors
/// [`ConfigurationError`] where the file or one that it names cannot be read, or something in it is wrong.
pub fn load(path: &Path, overrides: &Overrides) -> Result<ResolvedRoom, ConfigurationError> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|error| {
        let cure = match error.kind() {
            std::io::ErrorKind::NotFound => {
                "check the path; `hearsight track --help` shows what a room file looks like"
            }
            std::io::ErrorKind::IsADirectory => "name the room.toml inside the directory",
            std::io::ErrorKind::InvalidData => {
                "a room file is text (TOML, UTF-8), not a recording: name the recording in it"
            }
            _ => "check that the file may be read",
        };
        Document::new(&name, "").error(&Field::default(), format!("cannot be read: {error}"), cure)
    })?;
    let raw = parse(&name, &text, overrides)?;
    let directory = path.parent().unwrap_or(Path::new("")).to_path_buf();
    let stem = path
        .file_stem()
        .map_or_else(|| "room".into(), |stem| stem.to_string_lossy().into_owned());
    resolve(&raw, &name, &text, &directory, &stem)
}

/// Resolves a raw configuration. `name` and `text` are those of the file, for errors; paths are relative to
/// `directory`; `room_name` is the room's name where it gives none.
///
/// # Errors
/// [`ConfigurationError`] where something in it is wrong or a file that it names cannot be read.
pub fn resolve(
    raw: &RawRoom,
    name: &str,
    text: &str,
    directory: &Path,
    room_name: &str,
) -> Result<ResolvedRoom, ConfigurationError> {
    let resolver = Resolver {
        document: Document::new(name, text),
        directory: directory.to_path_buf(),
    };
    resolver.room(raw, room_name)
}

/// The document and directory that every step needs.
pub(super) struct Resolver {
    pub(super) document: Document,
    directory: PathBuf,
}

impl Resolver {
    pub(super) fn path(&self, path: &str) -> PathBuf {
        self.directory.join(path)
    }

    fn room(&self, raw: &RawRoom, room_name: &str) -> Result<ResolvedRoom, ConfigurationError> {
        if raw.camera.is_empty() && raw.array.is_empty() {
            let cure = "add a camera: [[camera]] with file = \"video.avi\"";
            return Err(self.document.error(
                &Field::default(),
                "names no camera and no microphone array",
                cure,
            ));
        }
        let name = raw.name.clone().unwrap_or_else(|| room_name.to_owned());
        self.good_name(&Field::of("name"), &name)?;
        let speed = raw.speed_of_sound.unwrap_or(SPEED_OF_SOUND_M_S);
        if !(speed.is_finite() && (100.0..=10_000.0).contains(&speed)) {
            let what = format!("{speed} metres a second is no speed of sound");
            return Err(self
                .document
                .error(&Field::of("speed_of_sound"), what, "air at 20 degrees has 343"));
        }
        let mut taken = BTreeMap::new();
        let mut cameras = Vec::new();
        for (place, camera) in raw.camera.iter().enumerate() {
            let field = Field::of("camera").index(place);
            let name = self.sensor_name(
                &field,
                camera.name.as_deref(),
                format!("cam{}", place + 1),
                &mut taken,
            )?;
            cameras.push(self.camera(&field, camera, name)?);
        }
        for (place, panorama) in raw.panorama.iter().enumerate() {
            let field = Field::of("panorama").index(place);
            let name = self.sensor_name(
                &field,
                panorama.name.as_deref(),
                format!("panorama{}", place + 1),
                &mut taken,
            )?;
            self.panorama(&field, panorama, name, &mut cameras)?;
        }
        let camera_names = Cameras(&cameras);
        let mut arrays = Vec::new();
        for (place, array) in raw.array.iter().enumerate() {
            let field = Field::of("array").index(place);
            let name = self.sensor_name(
                &field,
                array.name.as_deref(),
                format!("array{}", place + 1),
                &mut taken,
            )?;
            arrays.push(self.array(&field, array, name, &camera_names)?);
        }
        Ok(ResolvedRoom {
            name,
            cameras,
            arrays,
            speed_of_sound_m_s: speed,
            system: self.system(&raw.system)?,
            output: self.output(raw)?,
            run: self.run(&raw.run)?,
        })
    }

    /// Names become names of files and columns of text formats.
    fn good_name(&self, field: &Field, name: &str) -> Result<(), ConfigurationError> {
        let bad = name
            .chars()
            .find(|&c| c.is_whitespace() || c.is_control() || "/\\,".contains(c));
        let what = match bad {
            None if !name.is_empty() && !name.starts_with('.') => return Ok(()),
            None => format!("`{name}` is no name"),
            Some(bad) => format!("the name `{name}` contains {bad:?}"),
        };
        Err(self.document.error(
            field,
            what,
            "names become names of files: use letters, digits, `-` and `_`",
        ))
    }

    fn sensor_name(
        &self,
        field: &Field,
        given: Option<&str>,
        default: String,
        taken: &mut BTreeMap<String, Field>,
    ) -> Result<String, ConfigurationError> {
        let name = given.map_or(default, str::to_owned);
        let at = field.key("name");
        self.good_name(&at, &name)?;
        if let Some(other) = taken.insert(name.clone(), field.clone()) {
            let what = format!("`{name}` is already the name of {other}");
            return Err(self
                .document
                .error(&at, what, "give every sensor a name of its own"));
        }
        Ok(name)
    }

    pub(super) fn time(
        &self,
        field: &Field,
        seconds: Option<f64>,
    ) -> Result<Option<Instant>, ConfigurationError> {
        match seconds {
            Some(value) if !(value.is_finite() && value.abs() <= LONGEST_TIME_S) => {
                let what = format!("{value} is not a time");
                Err(self
                    .document
                    .error(field, what, "give seconds on the common clock"))
            }
            value => Ok(value.map(Instant::from_seconds)),
        }
    }

    fn system(&self, raw: &RawSystem) -> Result<ResolvedSystem, ConfigurationError> {
        let known: Vec<&str> = hearsight_systems::REGISTRY
            .iter()
            .map(|system| system.name)
            .collect();
        let field = Field::of("system");
        let name = raw.name.clone().unwrap_or_else(|| DEFAULT_SYSTEM.to_owned());
        if !known.contains(&name.as_str()) {
            let what = format!("there is no system `{name}`");
            return Err(self
                .document
                .error(&field.key("name"), what, suggest(&name, &known)));
        }
        for (key, value) in &raw.parameters {
            let at = field.key(key);
            if !known.contains(&key.as_str()) {
                let words: Vec<&str> = std::iter::once("name").chain(known.iter().copied()).collect();
                let what = format!("unknown key `{key}`");
                let cure = format!("{}; parameters stand in [system.{name}]", suggest(key, &words));
                return Err(self.document.error(&at, what, cure));
            }
            if !value.is_table() {
                let what = format!("is {}, not a table", value.type_str());
                return Err(self.document.error(
                    &at,
                    what,
                    format!("write [system.{key}] and the parameters below"),
                ));
            }
        }
        let given = match raw.parameters.get(&name) {
            Some(table) => serde_json::to_value(table).map_err(|error| {
                self.document
                    .error(&field.key(&name), error, "use numbers, text, lists and tables")
            })?,
            None => serde_json::Value::Object(serde_json::Map::new()),
        };
        let mut parameters = given.clone();
        if let Some(system) = hearsight_systems::REGISTRY
            .iter()
            .find(|system| system.name == name)
        {
            let checker = Checker::new(&self.document, (system.parameters)());
            checker.check(&field.key(&name), &given)?;
            parameters = checker.with_defaults(&given);
        }
        Ok(ResolvedSystem {
            name,
            given,
            parameters,
        })
    }

    fn output(&self, raw: &RawRoom) -> Result<ResolvedOutput, ConfigurationError> {
        let field = Field::of("output");
        let mut formats: BTreeSet<&'static str> = sinks::registry()
            .iter()
            .filter(|sink| sink.default)
            .map(|sink| sink.name)
            .collect();
        for (key, value) in &raw.output.formats {
            let Some(sink) = sinks::registry().iter().find(|sink| sink.name == key) else {
                let known: Vec<&str> = std::iter::once("directory")
                    .chain(sinks::registry().iter().map(|sink| sink.name))
                    .collect();
                let what = format!("unknown key `{key}`");
                return Err(self.document.error(&field.key(key), what, suggest(key, &known)));
            };
            match value.as_bool() {
                Some(true) => formats.insert(sink.name),
                Some(false) => formats.remove(sink.name),
                None => {
                    let what = format!("is {value}, neither true nor false");
                    return Err(self.document.error(&field.key(key), what, "write true or false"));
                }
            };
        }
        let directory = self.path(raw.output.directory.as_deref().unwrap_or("out"));
        Ok(ResolvedOutput { directory, formats })
    }

    fn run(&self, raw: &RawRun) -> Result<ResolvedRun, ConfigurationError> {
        let field = Field::of("run");
        let (from, until) = (
            self.time(&field.key("from"), raw.from)?,
            self.time(&field.key("until"), raw.until)?,
        );
        if let (Some(from), Some(until)) = (from, until)
            && until <= from
        {
            let what = format!("{} s is not after `from`, {} s", until.seconds(), from.seconds());
            return Err(self
                .document
                .error(&field.key("until"), what, "end later, or begin earlier"));
        }
        let tick = match raw.tick {
            Some(tick) if !(tick.is_finite() && (1e-4..=60.0).contains(&tick)) => {
                let what = format!("{tick} s is no tick");
                let cure =
                    "give seconds from 0.0001 to 60, or leave it out for the fastest camera's interval";
                return Err(self.document.error(&field.key("tick"), what, cure));
            }
            tick => tick.map(Span::from_seconds),
        };
        let threads = match raw.threads.unwrap_or(0) {
            0 => std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            threads @ 1..=1024 => threads,
            threads => {
                let what = format!("{threads} threads are too many");
                return Err(self
                    .document
                    .error(&field.key("threads"), what, "0 takes one a processor"));
            }
        };
        Ok(ResolvedRun {
            seed: raw.seed.unwrap_or(DEFAULT_SEED),
            threads,
            from,
            until,
            tick,
        })
    }
}
