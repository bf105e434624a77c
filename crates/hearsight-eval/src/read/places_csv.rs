//! Places in the world: `tracks.csv` of `hearsight track`, and AV16.3's truth in metres.
//!
//! Columns by name: `t_sec`, `person` or `track`, `x_m`, `y_m`, `z_m`, and perhaps `existence`, `speaking` and
//! `speaking_probability`. Rows without a place are passed over: the system knows only pictures.

use super::table::Rows;
use super::truth::few_enough;
use super::{FormatInfo, ReadError, Source, is_time};
use crate::measure::Place;
use crate::recording::{Names, Observation, Recording, Scope, Stream, TurnMaker};
use crate::sequence::Sighting;

pub(super) const FORMAT: FormatInfo = FormatInfo {
    name: "places-csv",
    meaning: "CSV with t_sec, person or track, x_m, y_m, z_m; places in the world.",
    recognize: |_, line| {
        let has = |name: &str| line.split(',').any(|column| column.trim() == name);
        has("t_sec") && has("x_m") && (has("person") || has("track"))
    },
    read,
};

fn read(source: &Source<'_>) -> Result<Recording, ReadError> {
    let mut rows = Rows::with_header(source);
    let who = match rows.column("person") {
        Some(column) => column,
        None => rows.needed("track")?,
    };
    let (time, x) = (rows.needed("t_sec")?, rows.needed("x_m")?);
    let (y, z) = (rows.needed("y_m")?, rows.needed("z_m")?);
    let existence = rows.column("existence");
    let (speaking, probability) = (rows.column("speaking"), rows.column("speaking_probability"));
    let mut names = Names::default();
    let mut found: Vec<(f64, u64, u32, Option<Place>, Sighting)> = Vec::new();
    let mut set_aside = 0;
    while let Some(row) = rows.next() {
        let time_s = row.number(time)?;
        let place = match [
            row.optional(Some(x))?,
            row.optional(Some(y))?,
            row.optional(Some(z))?,
        ] {
            [Some(x), Some(y), Some(z)] => Some(Place::World([x, y, z])),
            _ => None,
        };
        if !is_time(time_s) || place.is_some_and(|place| !place.is_finite()) {
            set_aside += 1;
            continue;
        }
        let name = String::from_utf8_lossy(row.text(who)).into_owned();
        let index = names.index(name.clone(), || name);
        let seen = Sighting {
            existence: row.optional(existence)?.filter(|p| (0.0..=1.0).contains(p)),
            speaking: row.flag(speaking)?,
            speaking_probability: row.optional(probability)?.filter(|p| (0.0..=1.0).contains(p)),
            ..Sighting::new(index, place.unwrap_or(Place::World([0.0; 3])))
        };
        found.push((time_s, row.line, index, place, seen));
    }
    // Truth may be written person by person: the same instants come again.
    found.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut stream = Stream::new(Scope::World, true);
    let mut turns = TurnMaker::default();
    for (number, group) in found.chunk_by(|one, other| one.0 == other.0).enumerate() {
        stream.begin(number as u64, Some(group[0].0));
        turns.instant(group[0].0);
        few_enough(source, group[0].1, "person or track", group.len())?;
        for (time_s, line, index, place, seen) in group {
            if stream
                .newest_observations()
                .iter()
                .any(|other| other.seen.who == *index)
            {
                let cure = format!("it is there twice at {time_s} s; leave out one of the two rows");
                let name = &names.names[*index as usize];
                return Err(ReadError::invalid(
                    source.path,
                    *line,
                    "person or track",
                    name,
                    cure,
                ));
            }
            if seen.speaking == Some(true) {
                turns.speaks(*index);
            }
            if place.is_some() {
                stream.push(Observation::new(*seen));
            }
        }
    }
    let (turns, span_s) = turns.finish();
    Ok(Recording {
        streams: vec![stream],
        speakers: names.names.clone(),
        names: names.names,
        turns: speaking.is_some().then_some(turns),
        span_s: span_s.filter(|_| speaking.is_some()),
        set_aside,
    })
}
