//! Directories: what `hearsight track` or `hearsight simulate` wrote, or the corpus AV16.3, or files side by side.

use super::{FORMATS, FormatInfo, ReadError, Source, name_of, parse, recognize};
use crate::measure::Place;
use crate::recording::{Names, Recording, Scope, Side};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Pictures of AV16.3 a second.
const AV16_3_FRAMES_PER_SECOND: f64 = 25.0;
/// Most files that are read of a directory.
const MOST_FILES: usize = 1000;

/// Reads a directory: `truth.jsonl` or `scenes.jsonl`, whichever is the side's; else all files that are known.
pub(super) fn read(
    directory: &Path,
    side: Side,
    format: Option<&FormatInfo>,
) -> Result<Recording, ReadError> {
    let main = directory.join(match side {
        Side::Truth => "truth.jsonl",
        Side::Tracks => "scenes.jsonl",
    });
    if format.is_none() && main.is_file() {
        return super::read(&main, side, None);
    }
    let mut whole = Recording::default();
    let mut any = false;
    for path in files(directory)? {
        let bytes = read_bytes(&path)?;
        let source = Source {
            path: &path,
            bytes: &bytes,
            side,
        };
        let Ok(found) = recognize(&source) else { continue };
        if !belongs(name_of(&path), side) || format.is_some_and(|format| format.name != found.name) {
            continue;
        }
        let mut part = parse(&path, &bytes, side, Some(found))?;
        add_neighbours(&path, &mut part)?;
        any = true;
        whole.join(part);
    }
    if any {
        return Ok(whole);
    }
    let known: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
    Err(ReadError::Format {
        file: directory.to_owned(),
        detail: "the directory holds no file that can be judged".to_owned(),
        cure: format!(
            "name a file, or a directory with {} or files of {}",
            name_of(&main),
            known.join(", ")
        ),
    })
}

/// Whether a file of a directory is of this side: truth and results may lie side by side.
fn belongs(name: &str, side: Side) -> bool {
    let is_result = name.ends_with(".mot.txt") || name == "tracks.csv" || name == "test.txt";
    let is_truth = name.ends_with(".gt.txt")
        || name == "gt.txt"
        || name.ends_with("_frames.csv")
        || name.ends_with("_gt3d.csv");
    match side {
        Side::Truth => !is_result && name != "scenes.jsonl",
        Side::Tracks => !is_truth && name != "truth.jsonl",
    }
}

/// Files of known endings, by name.
fn files(directory: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let failed = |source| ReadError::Read {
        file: directory.to_owned(),
        source,
    };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(directory).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let ending = path.extension().and_then(|ending| ending.to_str());
        if path.is_file() && ending.is_some_and(|ending| ["csv", "txt", "rttm", "jsonl"].contains(&ending)) {
            found.push(path);
        }
    }
    found.sort();
    found.truncate(MOST_FILES);
    Ok(found)
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, ReadError> {
    std::fs::read(path).map_err(|source| ReadError::Read {
        file: path.to_owned(),
        source,
    })
}

/// AV16.3's truth in the world counts where the person is in at least one picture at that time: the files beside it tell.
pub(super) fn add_neighbours(path: &Path, recording: &mut Recording) -> Result<(), ReadError> {
    let Some(stem) = name_of(path).strip_suffix("_gt3d.csv") else {
        return Ok(());
    };
    let Some(directory) = path.parent() else {
        return Ok(());
    };
    let directory = if directory.as_os_str().is_empty() {
        Path::new(".")
    } else {
        directory
    };
    let is_neighbour =
        |file: &PathBuf| name_of(file).starts_with(stem) && name_of(file).ends_with("_frames.csv");
    let neighbours: Vec<PathBuf> = files(directory)?.into_iter().filter(is_neighbour).collect();
    if neighbours.is_empty() {
        return Ok(());
    }
    let tick = |time_s: f64| (time_s * AV16_3_FRAMES_PER_SECOND).round() as i64;
    let mut seen: BTreeSet<(i64, String)> = BTreeSet::new();
    for file in neighbours {
        let picture = parse(&file, &read_bytes(&file)?, Side::Truth, None)?;
        for frame in picture.streams.iter().flat_map(|stream| stream.frames()) {
            for person in frame.observations {
                if let Some(time_s) = frame.time_s {
                    seen.insert((tick(time_s), picture.names[person.seen.who as usize].clone()));
                }
            }
        }
    }
    let names = &recording.names;
    for stream in recording
        .streams
        .iter_mut()
        .filter(|stream| stream.scope == Scope::World)
    {
        for (time_s, person) in stream.observations_mut() {
            let key = time_s.map(|time_s| (tick(time_s), names[person.seen.who as usize].clone()));
            person.counts = key.is_some_and(|key| seen.contains(&key));
        }
    }
    Ok(())
}

/// Adds the names that are new and says the index of each.
fn add_names(known: &mut Vec<String>, names: Vec<String>) -> Vec<u32> {
    let mut all = Names::default();
    for name in known.drain(..) {
        all.index(name.clone(), || name);
    }
    let indices = names
        .into_iter()
        .map(|name| all.index(name.clone(), || name))
        .collect();
    *known = all.names;
    indices
}

impl Recording {
    /// Adds another file of the same recording. People of the same name are the same.
    fn join(&mut self, other: Self) {
        let people = add_names(&mut self.names, other.names);
        for mut stream in other.streams {
            for (_, observation) in stream.observations_mut() {
                observation.seen.who = people[observation.seen.who as usize];
            }
            self.streams.push(stream);
        }
        if let Some(turns) = other.turns {
            let speakers = add_names(&mut self.speakers, other.speakers);
            let named = turns.into_iter().map(|mut turn| {
                turn.speaker = speakers[turn.speaker as usize];
                turn
            });
            self.turns.get_or_insert_default().extend(named);
            self.span_s = self.span_s.or(other.span_s);
        }
        self.set_aside += other.set_aside;
    }

    /// Whether any stream has a place of a kind.
    pub(crate) fn has(&self, wanted: fn(&Place) -> bool) -> bool {
        let streams = self.streams.iter();
        streams
            .flat_map(|stream| stream.observations())
            .any(|observation| wanted(&observation.seen.place))
    }
}
