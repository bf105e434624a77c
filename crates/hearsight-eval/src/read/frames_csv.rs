//! AV16.3's truth in a picture: `frame,t_sec,n_visible,p1_u,p1_v,p2_u,p2_v,...`, the mouth of each person in pixels.
//!
//! A person is there in a frame where `n_visible` is above zero and their mouth is within the corpus' picture of 360 x
//! 288; anywhere else the rows are frozen. Every frame of the video has a row.

use super::table::Rows;
use super::{FormatInfo, ReadError, Source, is_time};
use crate::measure::Place;
use crate::recording::{Observation, Recording, Scope, Stream};
use crate::sequence::Sighting;

pub(super) const FORMAT: FormatInfo = FormatInfo {
    name: "frames-csv",
    meaning: "CSV of AV16.3, frame,t_sec,n_visible,p1_u,p1_v,...; mouths in one picture.",
    recognize: |_, line| line.starts_with("frame,") && line.contains("p1_u"),
    read,
};

/// The corpus' picture, pixels.
const SIZE_PX: [f64; 2] = [360.0, 288.0];

fn read(source: &Source<'_>) -> Result<Recording, ReadError> {
    let mut rows = Rows::with_header(source);
    let (frame, time) = (rows.needed("frame")?, rows.needed("t_sec")?);
    let visible = rows.column("n_visible");
    let people: Vec<(String, usize, usize)> = rows
        .columns()
        .iter()
        .enumerate()
        .filter_map(|(place, column)| {
            let name = column.strip_suffix("_u")?.strip_prefix('p')?;
            Some((name.to_owned(), place, rows.column(&format!("p{name}_v"))?))
        })
        .collect();
    let mut stream = Stream::new(Scope::Picture(camera(source.name())), true);
    let mut set_aside = 0;
    while let Some(row) = rows.next() {
        let (number, time_s) = (row.count(frame)?, row.number(time)?);
        if stream.newest().is_some_and(|newest| newest >= number) {
            return Err(row.invalid(frame, "frames must ascend; sort the rows"));
        }
        stream.begin(number, Some(time_s).filter(|time_s| is_time(*time_s)));
        if row.optional(visible)?.is_some_and(|count| count <= 0.0) {
            continue;
        }
        for (who, (_, u, v)) in people.iter().enumerate() {
            let pixel = [row.number(*u)?, row.number(*v)?];
            if !pixel.iter().all(|coordinate| coordinate.is_finite()) {
                set_aside += 1;
            } else if (0.0..SIZE_PX[0]).contains(&pixel[0]) && (0.0..SIZE_PX[1]).contains(&pixel[1]) {
                stream.push(Observation::new(Sighting::new(who as u32, Place::Pixel(pixel))));
            }
        }
    }
    Ok(Recording {
        streams: vec![stream],
        names: people.into_iter().map(|(name, _, _)| name).collect(),
        set_aside,
        ..Recording::default()
    })
}

/// The camera that a name tells: `seq30_cam1_frames.csv`.
fn camera(name: &str) -> Option<String> {
    let stem = name.strip_suffix("_frames.csv")?;
    let camera = stem.rsplit('_').next()?;
    (!camera.is_empty()).then(|| camera.to_owned())
}
