//! Places and lenses: calibration files and positions of microphones.

use super::raw::{RawArray, RawCalibration, RawCalibrationFile, RawMicrophonesFile};
use super::resolve::Resolver;
use hearsight_core::WorldPoint;
use hearsight_core::calibration::{
    Calibration, CalibrationError, CalibrationFormat, FORMATS, load_camera, parse_camera,
};
use hearsight_core::configuration::ConfigurationError;
use hearsight_core::configuration::{Field, suggest};
use std::collections::BTreeMap;
use std::path::Path;

/// Microphones nearer to each other than this are at one place, metres.
const SMALLEST_BASELINE_M: f64 = 1e-3;
/// Coordinates beyond this are slips, such as millimetres, metres.
const LARGEST_COORDINATE_M: f64 = 1000.0;

/// The calibration of a camera.
pub(super) fn calibration(
    resolver: &Resolver,
    field: &Field,
    raw: &RawCalibration,
) -> Result<Calibration, ConfigurationError> {
    let failed = |error: CalibrationError| {
        let cure = "paths are relative to this file; without a calibration many systems work as well, but less exactly";
        resolver.document.error(field, error, cure)
    };
    match raw {
        RawCalibration::Path(file) => load_camera(&resolver.path(file), None, 0).map_err(failed),
        RawCalibration::File(RawCalibrationFile { file, index, format }) => {
            let format = match format {
                Some(name) => Some(CalibrationFormat::named(name).ok_or_else(|| {
                    let known: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
                    let what = format!("there is no calibration format `{name}`");
                    resolver
                        .document
                        .error(&field.key("format"), what, suggest(name, &known))
                })?),
                None => None,
            };
            load_camera(&resolver.path(file), format, index.unwrap_or(0)).map_err(failed)
        }
        RawCalibration::Inline(table) => {
            let cameras = toml::Value::Array(vec![toml::Value::Table(table.clone())]);
            let file = toml::Table::from_iter([("camera".to_owned(), cameras)]);
            let name = Path::new(resolver.document.name());
            parse_camera(&file.to_string(), name, CalibrationFormat::named("hearsight"), 0).map_err(failed)
        }
    }
}

/// The microphones of an array; empty where nothing is said of them.
pub(super) fn microphones(
    resolver: &Resolver,
    field: &Field,
    raw: &RawArray,
    name: &str,
) -> Result<Vec<WorldPoint>, ConfigurationError> {
    let (at, positions) = match (&raw.microphones, &raw.microphones_file) {
        (Some(_), Some(_)) => {
            let what = "has `microphones` and `microphones_file` at once";
            return Err(resolver.document.error(field, what, "keep one of them"));
        }
        (Some(positions), None) => (field.key("microphones"), positions.clone()),
        (None, Some(file)) => {
            let at = field.key("microphones_file");
            (at.clone(), microphones_file(resolver, &at, file, name)?)
        }
        (None, None) => return Ok(Vec::new()),
    };
    let points = positions.iter().enumerate().map(|(place, position)| {
        let at = at.index(place);
        let &[x, y, z] = position.as_slice() else {
            let what = format!("microphone {place} has {} coordinates", position.len());
            return Err(resolver
                .document
                .error(&at, what, "give three, [x, y, z], in metres"));
        };
        if !position
            .iter()
            .all(|value| value.is_finite() && value.abs() <= LARGEST_COORDINATE_M)
        {
            let what = format!("microphone {place} is at {position:?}, which is in no room");
            return Err(resolver
                .document
                .error(&at, what, "give finite coordinates in metres"));
        }
        Ok(WorldPoint::new(x, y, z))
    });
    let points = points.collect::<Result<Vec<_>, _>>()?;
    if points.is_empty() {
        return Err(resolver
            .document
            .error(&at, "is empty", "list one position a channel, or leave it out"));
    }
    for (place, point) in points.iter().enumerate() {
        for (other, earlier) in points.iter().take(place).enumerate() {
            if point.distance_m(*earlier) < SMALLEST_BASELINE_M {
                let what = format!(
                    "microphones {other} and {place} are at one place, {:?}",
                    positions[place]
                );
                let cure = "measure the positions in metres: an array of zero size hears no direction";
                return Err(resolver.document.error(&at, what, cure));
            }
        }
    }
    Ok(points)
}

#[derive(serde::Deserialize)]
#[serde(untagged)]
enum MicrophonesFile {
    Named {
        arrays_m: BTreeMap<String, Vec<Vec<f64>>>,
    },
    Single(Vec<Vec<f64>>),
}

fn microphones_file(
    resolver: &Resolver,
    field: &Field,
    raw: &RawMicrophonesFile,
    name: &str,
) -> Result<Vec<Vec<f64>>, ConfigurationError> {
    let path = resolver.path(&raw.file);
    let shown = path.display();
    let text = std::fs::read_to_string(&path).map_err(|error| {
        let what = format!("{shown} cannot be read: {error}");
        resolver.document.error(
            &field.key("file"),
            what,
            "check the path; it is relative to this file",
        )
    })?;
    let content: MicrophonesFile = serde_json::from_str(&text).map_err(|_| {
        let what = format!("{shown} holds no positions of microphones");
        let cure = "it must be JSON such as {\"arrays_m\": {\"table\": [[0, 0, 0], [0.2, 0, 0]]}} or [[0, 0, 0], [0.2, 0, 0]]";
        resolver.document.error(&field.key("file"), what, cure)
    })?;
    match content {
        MicrophonesFile::Single(positions) => Ok(positions),
        MicrophonesFile::Named { mut arrays_m } => {
            let wanted = raw.array.as_deref().unwrap_or(name);
            arrays_m.remove(wanted).ok_or_else(|| {
                let known: Vec<&str> = arrays_m.keys().map(String::as_str).collect();
                let what = format!("{shown} has no array `{wanted}`");
                resolver
                    .document
                    .error(&field.key("array"), what, suggest(wanted, &known))
            })
        }
    }
}
