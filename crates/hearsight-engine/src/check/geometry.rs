//! Places and lenses: whether numbers that were written down can be those of a room.

use super::CheckReport;
use crate::config::ResolvedRoom;
use hearsight_core::room::{CameraSensor, Room};
use hearsight_core::{Camera, DistortedPixel, WorldPoint};

/// A camera farther than this from the array that it is paired with stands in another room, metres.
const FARTHEST_M: f64 = 15.0;
/// Fields of view of lenses that are sold, degrees.
const FIELD_OF_VIEW_DEG: std::ops::Range<f64> = 10.0..170.0;
/// Pixels to rays and back must come out again within this, pixels.
const ROUND_TRIP_PX: f64 = 0.1;
/// Microphones farther apart than this are usually a slip of the unit, metres.
const WIDEST_ARRAY_M: f64 = 10.0;

pub(super) fn check(room: &Room, configuration: &ResolvedRoom, report: &mut CheckReport) {
    for (place, camera) in room.cameras.iter().enumerate() {
        let paired: Vec<_> = room
            .arrays
            .iter()
            .filter(|array| array.camera == Some(place))
            .collect();
        let Some(lens) = &camera.calibration else {
            let what = "no calibration".to_owned();
            match paired.first() {
                Some(array) => {
                    let what = format!("{what}: where {} points in the picture is a guess", array.name);
                    report.warn(
                        &camera.name,
                        "calibration",
                        what,
                        "give `calibration = \"<file>\"`",
                    );
                }
                None => report.pass(
                    &camera.name,
                    "calibration",
                    format!("{what}, none needed in the picture"),
                ),
            }
            continue;
        };
        check_lens(camera, lens, report);
        let posed = configuration
            .cameras
            .get(place)
            .and_then(|camera| camera.calibration.as_ref()?.pose);
        if posed.is_none() {
            let cure =
                "add `position_m` and `look_at_m` to the calibration, or the pose that calibrating gave";
            report.warn(
                &camera.name,
                "pose",
                "the calibration does not say where the camera is",
                cure,
            );
            continue;
        }
        for array in paired.iter().filter(|array| !array.microphones.is_empty()) {
            let distance = centre(&array.microphones).distance_m(lens.centre());
            if distance > FARTHEST_M {
                let what = format!("{distance:.1} m from {}, with which it is paired", array.name);
                report.warn(
                    &camera.name,
                    "place",
                    what,
                    "check that both are in metres and in the same world",
                );
            } else {
                report.pass(
                    &camera.name,
                    "place",
                    format!("{distance:.2} m from {}", array.name),
                );
            }
        }
    }
    for array in &room.arrays {
        if array.microphones.is_empty() {
            let cure = "give `microphones = [[x, y, z], ...]` in metres, one a channel";
            report.warn(
                &array.name,
                "microphones",
                "no positions: delays say nothing of where",
                cure,
            );
            continue;
        }
        let widest = array.microphones.iter().enumerate().flat_map(|(place, one)| {
            array
                .microphones
                .iter()
                .take(place)
                .map(|other| one.distance_m(*other))
        });
        let widest = widest.fold(0.0, f64::max);
        if widest > WIDEST_ARRAY_M {
            let what = format!("{widest:.1} m from end to end");
            report.warn(&array.name, "microphones", what, "positions are in metres");
        } else {
            let what = format!("{}, {widest:.2} m from end to end", array.microphones.len());
            report.pass(&array.name, "microphones", what);
        }
        if array.camera.is_none() {
            let cure = "give `camera = \"<name>\"`, the camera whose picture this array hears";
            report.warn(&array.name, "pairing", "paired with no camera", cure);
        }
    }
}

fn check_lens(camera: &CameraSensor, lens: &Camera, report: &mut CheckReport) {
    let name = &camera.name;
    let field = lens.horizontal_field_of_view_rad().map(f64::to_degrees);
    match field {
        Some(field) if FIELD_OF_VIEW_DEG.contains(&field) => {
            report.pass(name, "calibration", format!("sees {field:.0} degrees"));
        }
        Some(field) => {
            let what = format!("the focal length gives a picture {field:.0} degrees wide");
            report.warn(
                name,
                "calibration",
                what,
                "check that it is in pixels of this resolution",
            );
        }
        None => {
            let what = "the lens shows nothing at the edge of the picture";
            report.warn(name, "calibration", what, "check focal length and distortion");
        }
    }
    let middle = lens.model.projection().centre();
    if !lens.contains(middle) {
        let what = format!(
            "its centre ({:.0}, {:.0}) is outside the picture",
            middle.u, middle.v
        );
        report.warn(name, "calibration", what, "was it made at another resolution?");
    }
    let mut worst = 0.0_f64;
    for row in 0..=8 {
        for column in 0..=8 {
            let u = column as f64 / 8.0 * (lens.width as f64 - 1.0);
            let v = row as f64 / 8.0 * (lens.height as f64 - 1.0);
            let pixel = DistortedPixel::new(u, v);
            let back = lens.ray(pixel).and_then(|ray| lens.project(ray.at(3.0)));
            worst = worst.max(back.map_or(f64::INFINITY, |back| (back.u - u).hypot(back.v - v)));
        }
    }
    if worst > ROUND_TRIP_PX {
        let what = format!("pixels do not come back from their rays ({worst:.1} pixels off)");
        report.warn(
            name,
            "distortion",
            what,
            "the distortion folds back inside the picture: calibrate again",
        );
    } else {
        report.pass(name, "distortion", "every pixel has a ray and comes back");
    }
}

fn centre(points: &[WorldPoint]) -> WorldPoint {
    let sum = points.iter().fold([0.0; 3], |sum, point| {
        [sum[0] + point.0.x, sum[1] + point.0.y, sum[2] + point.0.z]
    });
    let count = points.len().max(1) as f64;
    WorldPoint::new(sum[0] / count, sum[1] / count, sum[2] / count)
}
