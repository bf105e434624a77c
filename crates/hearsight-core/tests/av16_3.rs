//! The cameras of AV16.3 sequence 30: the three-dimensional truth must project onto the two-dimensional truth.
//!
//! The corpus is not part of the project; the test looks for it beside the project and skips where it is missing.

#![expect(
    clippy::unwrap_used,
    reason = "a test stops at what it does not expect, also in its helpers"
)]

use hearsight_core::calibration::load_camera;
use hearsight_core::{DistortedPixel, WorldPoint};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

const WIDTH: usize = 360;
const HEIGHT: usize = 288;
const LARGEST_MEDIAN_PX: f64 = 2.5;

fn corpus() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/av16.3-seq30");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: the AV16.3 corpus is not at {}", folder.display());
    None
}

/// Rows of a file without quotes, its header left out.
fn rows(file: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(file).unwrap();
    text.lines()
        .skip(1)
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect()
}

fn milliseconds(seconds: &str) -> i64 {
    (seconds.parse::<f64>().unwrap() * 1e3).round() as i64
}

/// Mouths in metres by person (from 1) and time.
fn mouths(folder: &Path) -> HashMap<(usize, i64), WorldPoint> {
    let number = |text: &String| text.parse::<f64>().unwrap();
    rows(&folder.join("seq30_gt3d.csv"))
        .iter()
        .map(|row| {
            let point = WorldPoint::new(number(&row[2]), number(&row[3]), number(&row[4]));
            ((row[0].parse().unwrap(), milliseconds(&row[1])), point)
        })
        .collect()
}

#[test]
fn mouths_project_onto_the_annotated_pixels() {
    let Some(folder) = corpus() else { return };
    let mouths = mouths(&folder);
    for index in 0..3 {
        let camera = load_camera(&folder.join("seq30_calib.json"), None, index)
            .unwrap()
            .camera(WIDTH, HEIGHT)
            .unwrap();
        let mut distances = Vec::new();
        for row in rows(&folder.join(format!("seq30_cam{}_frames.csv", index + 1))) {
            for person in 1..=2 {
                let number = |column: usize| row[column].parse::<f64>().unwrap();
                let annotated = DistortedPixel::new(number(1 + 2 * person), number(2 + 2 * person));
                let Some(mouth) = mouths.get(&(person, milliseconds(&row[1]))) else {
                    continue;
                };
                if row[2] == "0" || !camera.contains(annotated) {
                    continue;
                }
                let pixel = camera.project(*mouth).unwrap();
                distances.push((pixel.u - annotated.u).hypot(pixel.v - annotated.v));
                let ray = camera.ray(pixel).unwrap();
                assert!(ray.at(camera.centre().distance_m(*mouth)).distance_m(*mouth) < 1e-9);
            }
        }
        distances.sort_by(f64::total_cmp);
        let median = distances[distances.len() / 2];
        let field = camera.horizontal_field_of_view_rad().unwrap().to_degrees();
        println!(
            "camera {}: median {median:.3} px of {} mouths; at {:?}, {field:.1} degrees wide",
            index + 1,
            distances.len(),
            camera.centre().0.coords.as_slice()
        );
        assert!(median < LARGEST_MEDIAN_PX, "camera {}: {median}", index + 1);
    }
}
