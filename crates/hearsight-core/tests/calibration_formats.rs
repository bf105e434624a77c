//! Each calibration format: what it reads and what it refuses.

use hearsight_core::calibration::{Calibration, CalibrationError, parse_camera, to_toml};
use hearsight_core::{CameraModel, DistortedPixel, WorldPoint};
use nalgebra::{Rotation3, Vector3};
use std::path::Path;

const STORAGE_YAML: &str = include_str!("goldens/opencv_storage.yaml");
const STORAGE_JSON: &str = include_str!("goldens/opencv_storage.json");
const NATIVE: &str = include_str!("calibrations/native.toml");
/// Our own numbers in the shape of the AV16.3 corpus: a scaled alignment and a projection with a factor.
const CORPUS: &str = include_str!("calibrations/corpus.json");
const PLAIN: &str = include_str!("calibrations/plain.json");
const ROS: &str = include_str!("calibrations/ros.yaml");

fn read(text: &str, file: &str, index: usize) -> Result<Calibration, CalibrationError> {
    parse_camera(text, Path::new(file), None, index)
}

#[test]
fn both_of_opencvs_formats_give_the_same_camera() {
    let yaml = read(STORAGE_YAML, "cam.yaml", 0).unwrap();
    let json = read(STORAGE_JSON, "cam.yaml", 0).unwrap();
    assert_eq!(yaml, json);
    let CameraModel::Pinhole(lens) = yaml.model else {
        panic!("{yaml:?}")
    };
    assert_eq!(lens.parameters().focal_px, [612.5, 613.75]);
    assert_eq!(lens.parameters().radial, [-0.31, 0.12, -0.017]);
    assert_eq!(lens.parameters().tangential, [0.0011, -0.0022]);
    assert_eq!(yaml.size, Some([640, 480]));
    let turn = Rotation3::from_scaled_axis(Vector3::new(0.3, -1.2, 0.4));
    let expected = turn * Vector3::new(1.0, 2.0, 3.0) + Vector3::new(0.25, -0.5, 2.0);
    let seen = yaml
        .pose
        .unwrap()
        .camera_from_world(WorldPoint::new(1.0, 2.0, 3.0));
    assert!((seen.0.coords - expected).norm() < 1e-12);
    let camera = yaml.camera(640, 480).unwrap();
    assert!(camera.project(WorldPoint::new(0.0, 0.0, 1.0)).is_some());
}

#[test]
fn other_writers_names_are_understood() {
    let ros = read(ROS, "left.yaml", 0).unwrap();
    assert_eq!((ros.name.as_deref(), ros.pose), (Some("left"), None));
    let python = "mtx:\n- - 500.0\n  - 0.0\n  - 320.0\n- [0.0, 500.0, 240.0]\n- [0.0, 0.0, 1.0]\n\
        dist: [[0.1, 0, 0, 0, 0]]\nrvec: [[0.0], [0.0], [1.5]]\ntvec: [0, 0, 1]\n";
    assert!(read(python, "python.yml", 0).unwrap().pose.is_some());
    let fisheye = r#"{"K": [280, 0, 320, 0, 280, 240, 0, 0, 1], "D": [0.1, 0, 0, 0], "fisheye_model": 1}"#;
    assert!(matches!(
        read(fisheye, "a.json", 0).unwrap().model,
        CameraModel::Fisheye(_)
    ));
    let message = ROS.replace("camera_name: left", "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nP: [1]");
    assert_eq!(read(&message, "info.yaml", 0).unwrap().pose, None);
    let stereo = r#"{"K1": [[500, 0, 320], [0, 500, 240], [0, 0, 1]], "D1": [0, 0, 0, 0, 0],
        "K2": [[510, 0, 321], [0, 510, 241], [0, 0, 1]], "D2": [0, 0, 0, 0, 0],
        "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "T": [[-0.12], [0], [0]]}"#;
    let centre = |index| read(stereo, "a.json", index).unwrap().pose.unwrap().centre();
    assert_eq!(centre(0), WorldPoint::new(0.0, 0.0, 0.0));
    assert_eq!(centre(1), WorldPoint::new(0.12, 0.0, 0.0));
    assert!(matches!(
        read(stereo, "a.json", 2),
        Err(CalibrationError::NoSuchCamera { count: 2, .. })
    ));
}

#[test]
fn the_corpus_form_keeps_the_pixels_of_its_formula() {
    let calibration = read(CORPUS, "calib.json", 0).unwrap();
    let camera = calibration.camera(360, 288).unwrap();
    let point = WorldPoint::new(0.3, 0.2, 0.5);
    // The formula by hand: the inverse of the alignment, then P, then K undone, bent and redone.
    let aligned = Vector3::new(point.0.x - 0.1, point.0.y + 0.2, point.0.z - 0.3) / 0.999;
    let aligned = Vector3::new(aligned.y, -aligned.x, aligned.z);
    let row = |a: f64, b: f64, c: f64, d: f64| a * aligned.x + b * aligned.y + c * aligned.z + d;
    let depth = row(0.0, -2.0, 0.0, 4.0);
    let x = (row(-800.0, -360.0, 0.0, 720.0) / depth - 180.0) / 400.0;
    let y = (row(0.0, -288.0, -840.0, 576.0) / depth - 144.0) / 420.0;
    let r2 = x * x + y * y;
    let u = 400.0 * (x * (1.0 - 0.29 * r2) + 2.0 * 0.005 * x * y - 0.004 * (r2 + 2.0 * x * x)) + 180.0;
    let v = 420.0 * (y * (1.0 - 0.29 * r2) + 0.005 * (r2 + 2.0 * y * y) - 2.0 * 0.004 * x * y) + 144.0;
    let pixel = camera.project(point).unwrap();
    assert!((pixel.u - u).hypot(pixel.v - v) < 1e-9, "{pixel:?} ({u}, {v})");
    assert!(camera.depth_m(point) > 0.0);
    let distance = camera.centre().distance_m(point);
    assert!((camera.ray(pixel).unwrap().at(distance).distance_m(point)) < 1e-9);
}

#[test]
fn the_plain_form_reads_the_toolboxs_own_names() {
    let calibration = read(PLAIN, "calib.json", 0).unwrap();
    assert_eq!(calibration.size, Some([640, 480]));
    let seen = calibration
        .pose
        .unwrap()
        .camera_from_world(WorldPoint::new(0.0, 0.0, 0.0));
    assert_eq!(seen.0.coords, Vector3::new(0.1, 0.2, 2.0));
}

#[test]
fn our_own_format_is_read_and_written() {
    let all: Vec<Calibration> = (0..3)
        .map(|index| read(NATIVE, "room.toml", index).unwrap())
        .collect();
    assert_eq!(all[0].name.as_deref(), Some("door"));
    let aim = all[0]
        .camera(1280, 720)
        .unwrap()
        .project(WorldPoint::new(0.0, 0.0, 1.0))
        .unwrap();
    assert!((aim.u - 641.0).hypot(aim.v - 358.7) < 1e-9);
    let below = all[1]
        .pose
        .unwrap()
        .camera_from_world(WorldPoint::new(0.5, 0.0, 1.0));
    assert!((below.0.coords - Vector3::new(0.5, 0.0, 1.5)).norm() < 1e-12);
    let written = to_toml(&all);
    for (index, calibration) in all.iter().enumerate() {
        let back = read(&written, "room.toml", index).unwrap();
        assert_eq!(
            (&back.name, back.model, back.size),
            (&calibration.name, calibration.model, calibration.size)
        );
        let point = WorldPoint::new(0.4, -0.3, 1.1);
        let project = |c: &Calibration| c.pose.map(|pose| pose.camera_from_world(point).0.coords);
        if let (Some(a), Some(b)) = (project(&back), project(calibration)) {
            assert!((a - b).norm() < 1e-12);
        }
    }
}

#[test]
fn a_calibration_of_another_size_is_refused_or_resized() {
    let calibration = read(NATIVE, "room.toml", 0).unwrap();
    assert!(matches!(
        calibration.camera(640, 360),
        Err(CalibrationError::PictureSize { .. })
    ));
    let half = calibration.resized(640, 360).unwrap().camera(640, 360).unwrap();
    let full = calibration.camera(1280, 720).unwrap();
    let point = WorldPoint::new(0.2, 0.1, 0.9);
    let (small, large) = (half.project(point).unwrap(), full.project(point).unwrap());
    let expected = DistortedPixel::new((large.u + 0.5) / 2.0 - 0.5, (large.v + 0.5) / 2.0 - 0.5);
    assert!((small.u - expected.u).hypot(small.v - expected.v) < 1e-9);
}

#[test]
fn wrong_values_are_refused_by_field_value_and_cure() {
    let cases = [
        (STORAGE_YAML, "612.5", "0.", "camera_matrix", "positive"),
        (STORAGE_YAML, "612.5", ".Nan", "camera_matrix.data[0]", "finite"),
        (STORAGE_YAML, "612.5, 0.", "612.5, 3.", "camera_matrix", "skew"),
        (
            STORAGE_YAML,
            "241.5",
            "241.5, 1.",
            "camera_matrix.data",
            "10 given",
        ),
        (
            STORAGE_YAML,
            "rows: 5",
            "rows: 4",
            "distortion_coefficients.data",
            "4 x 1",
        ),
        (
            STORAGE_YAML,
            "image_width: 640",
            "image_width: 0",
            "image_width",
            "whole number",
        ),
        (
            STORAGE_YAML,
            "image_width: 640",
            "image_w: 640",
            "image_width",
            "add it",
        ),
        (STORAGE_YAML, "camera_matrix:", "lens:", "", "opencv"),
        (
            STORAGE_YAML,
            "distortion_coefficients:",
            "distort:",
            "distortion_coefficients",
            "found were",
        ),
        (STORAGE_YAML, "\nR:", "\nextrinsics:", "extrinsics", "3 x 4"),
        (STORAGE_YAML, "\nT:", "\nT2:", "T", "add it"),
        (
            STORAGE_JSON,
            "-0.31,",
            "\"x\",",
            "distortion_coefficients.data[0]",
            "finite",
        ),
        (CORPUS, "-360.0", "-390.0", "cam[0].P", "orthonormal"),
        (CORPUS, "0.999, 0.3]", "1.1, 0.3]", "align_mat", "orthonormal"),
        (
            CORPUS,
            "0.0, 0.0, 0.0, 1.0]]",
            "0.0, 0.0, 0.1, 1.0]]",
            "align_mat",
            "last row",
        ),
        (CORPUS, ", -0.004]", "]", "cam[0].kc", "k1, k2"),
        (PLAIN, "\"alpha_c\": 0", "\"alpha_c\": 0.1", "alpha_c", "skew"),
        (PLAIN, "\"Tc\"", "\"Td\"", "Tc", "add it"),
        (PLAIN, "[0.1, -0.2, 0.3]", "[1e300, -0.2, 0.3]", "omc", "radians"),
        (
            NATIVE,
            "name = \"door\"",
            "nmae = \"door\"",
            "camera[0].nmae",
            "did you mean `name`",
        ),
        (
            NATIVE,
            "look_at_m",
            "#",
            "camera[0].look_at_m",
            "add it (or rotation)",
        ),
        (
            NATIVE,
            "[905.2, 904.1]",
            "[905.2, nan]",
            "camera[0].focal_px[1]",
            "finite",
        ),
        (
            NATIVE,
            "[905.2, 904.1]",
            "[905.2, -1]",
            "camera[0].focal_px",
            "positive",
        ),
        (
            NATIVE,
            "[0.0, 0.0, 1.0]",
            "[1.9, -3.0, 1.4]",
            "camera[0].look_at_m",
            "another place",
        ),
        (
            NATIVE,
            "\"pinhole\"",
            "\"telescope\"",
            "camera[0].model",
            "known are",
        ),
        (
            NATIVE,
            "-0.002, 0.0]",
            "-0.002]",
            "camera[0].distortion",
            "5 numbers",
        ),
        (
            NATIVE,
            "[1.9, -3.0, 1.4]",
            "[1.7e308, 1.7e308, 1.7e308]",
            "camera[0].look_at_m",
            "at a finite distance",
        ),
    ];
    for (text, from, to, field, cure) in cases {
        assert!(text.contains(from), "{from}");
        let error = read(&text.replacen(from, to, 1), "room/cam1.txt", 0).unwrap_err();
        let message = error.to_string();
        assert_eq!(error.field().unwrap_or(""), field, "{message}");
        assert!(message.contains(cure), "{message} does not say {cure}");
        assert!(message.ends_with("(room/cam1.txt)"), "{message}");
    }
    assert!(matches!(
        read(CORPUS, "a", 1),
        Err(CalibrationError::NoSuchCamera {
            index: 1,
            count: 1,
            ..
        })
    ));
}
