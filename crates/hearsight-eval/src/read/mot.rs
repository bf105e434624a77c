//! MOTChallenge text: `frame,id,left,top,width,height,...` without a header.
//!
//! The seventh column of truth says whether the row counts, that of tracks how sure it is. Rows of nine columns, as the
//! truth from 2016 on and that of `hearsight simulate`, end with class and visible part; those of ten, as in 2015, end
//! with a place in the world, which is not used.

use super::table::Rows;
use super::{FormatInfo, ReadError, Source};
use crate::measure::Place;
use crate::recording::{Names, Observation, Recording, Scope, Side, Stream};
use crate::sequence::Sighting;
use hearsight_core::record::BoxRecord;

pub(super) const FORMAT: FormatInfo = FormatInfo {
    name: "mot",
    meaning: "MOTChallenge text, frame,id,left,top,width,height,...; boxes in one picture.",
    recognize: |name, line| {
        let fields = line.split(',');
        let numbers = fields
            .clone()
            .take(6)
            .all(|field| field.trim().parse::<f64>().is_ok());
        (numbers && fields.count() >= 6) || (line.is_empty() && name.ends_with(".txt"))
    },
    read,
};

const COLUMNS: &[&str] = &[
    "frame",
    "id",
    "left",
    "top",
    "width",
    "height",
    "confidence",
    "class",
    "visibility",
];

fn read(source: &Source<'_>) -> Result<Recording, ReadError> {
    let mut rows = Rows::without_header(source, COLUMNS);
    let mut names = Names::default();
    let mut found: Vec<(u64, u64, Observation)> = Vec::new();
    let mut set_aside = 0;
    while let Some(row) = rows.next() {
        if row.len() < 6 {
            return Err(row.invalid(row.len(), "a row has at least six columns; correct it"));
        }
        let (frame, id) = (row.count(0)?, row.whole(1)?);
        let place = Place::Box(BoxRecord {
            left: row.number(2)?,
            top: row.number(3)?,
            width: row.number(4)?,
            height: row.number(5)?,
        });
        let seventh = row.optional(Some(6))?;
        let visible = if row.len() == 9 {
            row.optional(Some(8))?
        } else {
            None
        };
        if !place.is_finite() {
            set_aside += 1;
            continue;
        }
        let seen = Sighting::new(names.index(id, || id.to_string()), place);
        let truth = source.side == Side::Truth;
        let observation = Observation {
            seen: Sighting {
                existence: seventh.filter(|value| !truth && (0.0..=1.0).contains(value)),
                ..seen
            },
            counts: !(truth && seventh == Some(0.0)),
            visible: visible.filter(|part| (0.0..=1.0).contains(part)).unwrap_or(1.0),
        };
        found.push((frame, row.line, observation));
    }
    if !found.is_sorted_by_key(|(frame, _, _)| *frame) {
        found.sort_by_key(|(frame, _, _)| *frame);
    }
    let mut stream = Stream::new(Scope::Picture(camera(source.name())), false);
    // By person, the place of the newest frame that they are in.
    let mut newest = vec![usize::MAX; names.names.len()];
    for (place, group) in found.chunk_by(|one, other| one.0 == other.0).enumerate() {
        stream.begin(group[0].0, None);
        for (frame, line, observation) in group {
            let who = observation.seen.who as usize;
            if newest[who] == place {
                let cure = format!("it is there twice in frame {frame}; leave out one of the two rows");
                return Err(ReadError::invalid(
                    source.path,
                    *line,
                    "id",
                    &names.names[who],
                    cure,
                ));
            }
            newest[who] = place;
            stream.push(*observation);
        }
    }
    Ok(Recording {
        streams: vec![stream],
        names: names.names,
        set_aside,
        ..Recording::default()
    })
}

/// The camera that a name tells: `front.mot.txt`, `front.gt.txt`.
fn camera(name: &str) -> Option<String> {
    let name = name
        .strip_suffix(".mot.txt")
        .or_else(|| name.strip_suffix(".gt.txt"))?;
    (!name.is_empty()).then(|| name.to_owned())
}
