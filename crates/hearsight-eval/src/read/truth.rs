//! `truth.jsonl`: what a simulation knows, an instant a line ([`TruthRecord`]).
//!
//! In pictures a person is their head box, in the world their mouth. How far a head can be seen decides who counts; in the
//! world that is how far it can be seen by the camera that sees most of it.

use super::{FormatInfo, ReadError, Source, is_time};
use crate::measure::Place;
use crate::recording::{Names, Observation, Recording, Scope, Stream, TurnMaker};
use crate::sequence::Sighting;
use hearsight_core::truth::{PersonTruth, TRUTH_SCHEMA_VERSION, TruthRecord};
use serde::de::DeserializeOwned;

pub(super) const FORMAT: FormatInfo = FormatInfo {
    name: "truth",
    meaning: "truth.jsonl of `hearsight simulate`; people in pictures and in the world, who speaks.",
    recognize: |name, line| {
        line.starts_with('{') && line.contains("\"people\"") || line.is_empty() && name.ends_with(".jsonl")
    },
    read,
};

/// Most people or tracks at one instant, and most cameras.
pub(super) const MOST_AT_ONCE: usize = 4096;
const MOST_CAMERAS: usize = 1000;

fn read(source: &Source<'_>) -> Result<Recording, ReadError> {
    let mut names = Names::default();
    let mut recording = Recording {
        streams: vec![Stream::new(Scope::World, true)],
        ..Recording::default()
    };
    let mut turns = TurnMaker::default();
    let mut latest_s = f64::NEG_INFINITY;
    for found in lines::<TruthRecord>(source) {
        let (line, record) = found?;
        schema_fits(source, line, &record.schema, TRUTH_SCHEMA_VERSION)?;
        let time_s = record.time_s;
        if !(is_time(time_s) && time_s > latest_s) {
            let cure = "times must ascend and be within 1e9 s; leave out the line";
            return Err(ReadError::invalid(
                source.path,
                line,
                "time_s",
                &time_s.to_string(),
                cure,
            ));
        }
        latest_s = time_s;
        few_enough(source, line, "people", record.people.len())?;
        recording.streams[0].begin(record.tick, Some(time_s));
        turns.instant(time_s);
        let mut met: Vec<u64> = Vec::with_capacity(record.people.len());
        let newest: Vec<Option<u64>> = recording.streams.iter().map(Stream::newest).collect();
        for person in &record.people {
            if met.contains(&person.id) {
                let cure = "it is there twice at this instant; leave out one of the two";
                return Err(ReadError::invalid(
                    source.path,
                    line,
                    "id",
                    &person.id.to_string(),
                    cure,
                ));
            }
            met.push(person.id);
            let who = names.index(person.id, || person.name.clone());
            if person.speaking {
                turns.speaks(who);
            }
            if !person.present {
                continue;
            }
            if let Some(mouth) = person.mouth_m {
                let visible = person
                    .views
                    .iter()
                    .map(|view| view.head_visible)
                    .fold(0.0, f64::max);
                let place = Place::World(mouth);
                add(
                    &mut recording.streams[0],
                    person,
                    who,
                    place,
                    visible,
                    &mut recording.set_aside,
                );
            }
            for view in &person.views {
                let Some(head) = view.head else { continue };
                let index = stream_of(source, line, &mut recording.streams, &view.camera)?;
                let stream = &mut recording.streams[index];
                match newest.get(index).copied().flatten() {
                    Some(newest) if newest >= view.frame => continue,
                    _ if stream.newest() == Some(view.frame) => {}
                    _ => stream.begin(view.frame, Some(time_s)),
                }
                let place = Place::Box(head);
                add(
                    stream,
                    person,
                    who,
                    place,
                    view.head_visible,
                    &mut recording.set_aside,
                );
            }
        }
    }
    let (turns, span_s) = turns.finish();
    recording.turns = Some(turns);
    recording.span_s = span_s;
    recording.speakers.clone_from(&names.names);
    recording.names = names.names;
    Ok(recording)
}

fn add(stream: &mut Stream, person: &PersonTruth, who: u32, place: Place, visible: f64, set_aside: &mut u64) {
    let twice = stream
        .newest_observations()
        .iter()
        .any(|other| other.seen.who == who);
    if !place.is_finite() || !visible.is_finite() || twice {
        *set_aside += 1;
        return;
    }
    stream.push(Observation {
        seen: Sighting {
            speaking: Some(person.speaking),
            ..Sighting::new(who, place)
        },
        counts: true,
        visible,
    });
}

/// Lines of JSON with their numbers, from 1; empty ones are passed over.
pub(super) fn lines<'a, T: DeserializeOwned>(
    source: &'a Source<'a>,
) -> impl Iterator<Item = Result<(u64, T), ReadError>> + 'a {
    let lines = source.bytes.split(|&byte| byte == b'\n').enumerate();
    let full = lines.filter(|(_, line)| !line.trim_ascii().is_empty());
    full.map(|(index, text)| {
        let line = index as u64 + 1;
        let record = serde_json::from_slice(text).map_err(|error| ReadError::Syntax {
            file: source.path.to_owned(),
            line,
            detail: error.to_string().replace(" at line 1 column ", " at column "),
            cure: "correct or leave out the line".to_owned(),
        })?;
        Ok((line, record))
    })
}

/// Refuses records of a later major version.
pub(super) fn schema_fits(source: &Source<'_>, line: u64, found: &str, known: &str) -> Result<(), ReadError> {
    let major = |version: &str| {
        version
            .split('.')
            .next()
            .and_then(|major| major.parse::<u64>().ok())
    };
    match (major(found), major(known)) {
        (Some(found), Some(known)) if found <= known => Ok(()),
        _ => {
            let cure = format!("this program reads up to {known}; take the one that wrote the file");
            Err(ReadError::invalid(source.path, line, "schema", found, cure))
        }
    }
}

/// Refuses an instant with more people or tracks than can be compared.
pub(super) fn few_enough(source: &Source<'_>, line: u64, field: &str, count: usize) -> Result<(), ReadError> {
    if count <= MOST_AT_ONCE {
        return Ok(());
    }
    let cure = format!("at most {MOST_AT_ONCE} at once can be judged; split the recording");
    Err(ReadError::invalid(
        source.path,
        line,
        field,
        &format!("a list of {count}"),
        cure,
    ))
}

/// The place of a camera's stream, a new one where it was not met. The first stream is the world.
pub(super) fn stream_of(
    source: &Source<'_>,
    line: u64,
    streams: &mut Vec<Stream>,
    camera: &str,
) -> Result<usize, ReadError> {
    if let Some(known) = streams.iter().position(|stream| stream.camera() == Some(camera)) {
        return Ok(known);
    }
    if streams.len() > MOST_CAMERAS {
        let cure = format!("at most {MOST_CAMERAS} cameras can be judged; split the recording");
        return Err(ReadError::invalid(source.path, line, "camera", camera, cure));
    }
    streams.push(Stream::new(Scope::Picture(Some(camera.to_owned())), false));
    Ok(streams.len() - 1)
}
