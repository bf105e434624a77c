//! Calibrations of cameras, every format and syntax.

use super::{Target, Verdict, texts};
use hearsight_core::calibration::{Calibration, FORMATS, parse_camera, to_toml};
use hearsight_core::{DistortedPixel, WorldPoint};
use std::path::Path;

pub(super) const TARGET: Target = Target {
    name: "calibration",
    meaning: "A camera's calibration; what was read projects, and is read again from what is written of it.",
    text: true,
    words: &[
        "[[camera]]",
        "camera_matrix",
        "distortion_coefficients",
        "!!opencv-matrix",
        "%YAML:1.0",
        "---",
        "...",
        "&a",
        "*a",
        "<<:",
        "? ",
        "- ",
        "|",
        ">",
        "!!float",
        "!!binary",
        "fisheye",
        "pinhole",
        "panorama",
        "equidistant",
        "rows",
        "cols",
        "data",
        "R",
        "T",
        "P",
        "K",
        "kc",
        "fc",
        "cc",
        "omc",
        "Tc",
        "align_mat",
        "position_m",
        "look_at_m",
        "rotation",
        "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]",
        "\"\"\"",
        "'''",
        "\u{feff}",
        "null",
        "true",
        "{",
        "}",
        "[",
        "]",
    ],
    longest: 8 << 10,
    seeds: || {
        texts(&[
            include_str!("../../seeds/calibration/hearsight.toml"),
            include_str!("../../seeds/calibration/opencv.yaml"),
            include_str!("../../seeds/calibration/opencv.json"),
            include_str!("../../seeds/calibration/stereo.yaml"),
            include_str!("../../seeds/calibration/ros.yaml"),
            include_str!("../../seeds/calibration/bouguet.json"),
            include_str!("../../seeds/calibration/corpus.json"),
            include_str!("../../seeds/went-wrong/calibration/look-at-infinity.toml"),
        ])
    },
    open: || {
        Box::new(|bytes| {
            let Ok(text) = std::str::from_utf8(bytes) else {
                return Verdict::Refused("not UTF-8".to_owned());
            };
            // By the text alone; then by one of the names, formats and numbers, which one depends on the length.
            let verdict = match parse_camera(text, Path::new("a"), None, 0) {
                Ok(calibration) => check(&calibration),
                Err(error) => Verdict::Refused(error.to_string()),
            };
            let name = ["a.toml", "a.yaml", "a.json", "a"][text.len() % 4];
            let format = FORMATS.get(text.len() / 4 % (FORMATS.len() + 1)).copied();
            let forced = parse_camera(text, Path::new(name), format, text.len() % 3);
            match forced.as_ref().map(check) {
                Ok(Verdict::Broken(promise)) => Verdict::Broken(promise),
                _ => verdict,
            }
        })
    },
};

/// Uses a calibration as systems do.
fn check(calibration: &Calibration) -> Verdict {
    let broken = |what: String| Verdict::Broken(what);
    let usable = match (Calibration {
        size: None,
        ..calibration.clone()
    })
    .camera(360, 288)
    {
        Ok(camera) => camera,
        Err(error) => return broken(format!("no camera of it: {error}")),
    };
    if calibration.resized(360, 288).is_err() {
        return broken("it cannot be resized".to_owned());
    }
    if !usable.centre().0.iter().all(|coordinate| coordinate.is_finite()) {
        return broken(format!("its place is {:?}", usable.centre()));
    }
    for point in [
        [0.3, 0.2, 0.5],
        [0.0, 0.0, 0.0],
        [1e3, -1e3, 2.0],
        [0.0, 0.0, -1.0],
    ] {
        let point = WorldPoint::new(point[0], point[1], point[2]);
        if let Some(pixel) = usable.project(point)
            && !(pixel.u.is_finite() && pixel.v.is_finite())
        {
            return broken(format!("{point:?} projects to {pixel:?}"));
        }
        if let Some((_, jacobian)) = usable.project_with_jacobian(point)
            && jacobian.iter().any(|entry| entry.is_nan())
        {
            return broken(format!("{point:?} has the Jacobian {jacobian:?}"));
        }
        let _ = (
            usable.pixels_per_metre(point),
            usable.depth_m(point),
            usable.project_inside(point),
        );
    }
    for (u, v) in [(180.0, 144.0), (0.0, 0.0), (359.0, 287.0), (-1e6, 1e6)] {
        if let Some(ray) = usable.ray(DistortedPixel::new(u, v))
            && !ray.at(1.0).0.iter().all(|coordinate| coordinate.is_finite())
        {
            return broken(format!("pixel {u}, {v} has the ray {ray:?}"));
        }
    }
    let _ = (
        usable.horizontal_field_of_view_rad(),
        usable.vertical_field_of_view_rad(),
    );
    let written = to_toml(std::slice::from_ref(calibration));
    match parse_camera(&written, Path::new("written.toml"), None, 0) {
        Ok(again) if again.size == calibration.size && again.name == calibration.name => {
            let lens = format!("{:?}", calibration.model);
            let kind: String = lens.chars().take_while(|letter| letter.is_alphabetic()).collect();
            Verdict::Read(format!(
                "{kind} {} {}",
                calibration.pose.is_some(),
                calibration.size.is_some()
            ))
        }
        Ok(_) => broken("what is written is read as another".to_owned()),
        Err(error) => broken(format!("what is written cannot be read: {error}")),
    }
}
