//! Lenses from rendered boards beside OpenCV's `calibrateCamera` (`goldens/make_boards.py`).
#![expect(clippy::unwrap_used, reason = "tests")]

use hearsight_calibrate::CalibrateError;
use hearsight_calibrate::board::{Board, BoardFinder, BoardView};
use hearsight_calibrate::camera::{CameraCalibration, calibrate};
use hearsight_core::{DistortedPixel, GrayView};
use serde_json::Value;
use std::path::{Path, PathBuf};

fn goldens() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/goldens")
}

fn boards() -> Value {
    serde_json::from_str(&std::fs::read_to_string(goldens().join("boards.json")).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap().iter();
    list.map(|number| number.as_f64().unwrap()).collect()
}

const SIZE: [usize; 2] = [480, 360];
const KINDS: [&str; 2] = ["chessboard", "charuco"];

fn board(kind: &str) -> Board {
    let (squares, square_m) = ([9, 7], 0.03);
    match kind {
        "chessboard" => Board::Chessboard { squares, square_m },
        _ => Board::Charuco {
            squares,
            square_m,
            marker_m: 0.022,
            dictionary: "DICT_APRILTAG_36h11".into(),
        },
    }
}

fn pictures(kind: &str) -> Vec<image::GrayImage> {
    let picture = |number: usize| {
        let file = goldens().join(kind).join(format!("{number:02}.png"));
        image::open(file).unwrap().into_luma8()
    };
    (0..9).map(picture).collect()
}

fn found(kind: &str) -> Vec<BoardView> {
    let finder = BoardFinder::new(board(kind)).unwrap();
    let pictures = pictures(kind);
    let views: Vec<BoardView> = pictures
        .iter()
        .filter_map(|picture| finder.find(GrayView::new(SIZE[0], SIZE[1], picture.as_raw()).unwrap()))
        .collect();
    assert_eq!(views.len(), pictures.len(), "{kind}");
    views
}

/// The corners that OpenCV found.
fn given(golden: &Value) -> Vec<BoardView> {
    let pairs = |value: &Value| -> Vec<[f64; 2]> {
        let list = value.as_array().unwrap().iter();
        list.map(|pair| numbers(pair).try_into().unwrap()).collect()
    };
    let views = golden["grids"].as_array().unwrap().iter();
    views
        .zip(golden["corners"].as_array().unwrap())
        .map(|(grid, corners)| BoardView {
            board_m: pairs(grid),
            pixels: pairs(corners)
                .iter()
                .map(|[u, v]| DistortedPixel::new(*u, *v))
                .collect(),
        })
        .collect()
}

fn show(name: &str, found: &CameraCalibration, golden: &Value) -> [f64; 3] {
    let ours = found.lens.parameters();
    let theirs = numbers(&golden["focal_px"]);
    let rms = golden["rms_px"].as_f64().unwrap();
    println!(
        "{name}: focal {:.3?} +- {:.3?}, OpenCV {theirs:.3?}; centre {:.3?}, OpenCV {:.3?}; error {:.4} px, OpenCV {rms:.4}; \
         k1 {:.4} k2 {:.4}",
        ours.focal_px,
        found.focal_deviation_px,
        ours.centre_px,
        numbers(&golden["centre_px"]),
        found.rms_px,
        ours.radial[0],
        ours.radial[1],
    );
    [
        ours.focal_px[0] / theirs[0] - 1.0,
        ours.focal_px[1] / theirs[1] - 1.0,
        found.rms_px / rms - 1.0,
    ]
}

#[test]
fn from_the_same_corners_the_lens_is_opencvs() {
    let boards = boards();
    for kind in KINDS {
        let golden = &boards[kind];
        let found = calibrate(&given(golden), SIZE, 9).unwrap();
        let [x, y, rms] = show(kind, &found, golden);
        assert!(
            x.abs() < 1e-4 && y.abs() < 1e-4 && rms.abs() < 1e-3,
            "{kind}: {x} {y} {rms}"
        );
        let ours = found.lens.parameters();
        for (ours, theirs) in ours.centre_px.iter().zip(numbers(&golden["centre_px"])) {
            assert!((ours - theirs).abs() < 0.05, "{kind}: {ours} {theirs}");
        }
        let theirs = numbers(&golden["distortion"]);
        for (ours, theirs) in [
            ours.radial[0],
            ours.radial[1],
            ours.tangential[0],
            ours.tangential[1],
        ]
        .iter()
        .zip(theirs)
        {
            assert!((ours - theirs).abs() < 2e-3, "{kind}: {ours} {theirs}");
        }
        for (pose, place) in found.poses.iter().zip(golden["shifts"].as_array().unwrap()) {
            let ours = pose.sensor_from_world.translation.vector;
            for (ours, theirs) in ours.iter().zip(numbers(place)) {
                assert!((ours - theirs).abs() < 1e-4, "{kind}: {ours} {theirs}");
            }
        }
    }
}

#[test]
fn from_the_pictures_the_focal_length_is_opencvs_and_the_error_no_larger() {
    let boards = boards();
    for kind in KINDS {
        let found = calibrate(&found(kind), SIZE, 9).unwrap();
        let [x, y, rms] = show(kind, &found, &boards[kind]);
        assert!(x.abs() < 0.005 && y.abs() < 0.005, "{kind}: {x} {y}");
        assert!(rms < 0.1, "{kind}: {rms}");
        let truth = numbers(&boards["truth"]["focal_px"]);
        for axis in 0..2 {
            let error = found.lens.parameters().focal_px[axis] - truth[axis];
            assert!(error.abs() < 0.005 * truth[axis], "{kind}: {error}");
        }
    }
}

#[test]
fn what_is_missing_is_said() {
    let views = found("chessboard");
    assert_eq!(
        calibrate(&[], SIZE, 12),
        Err(CalibrateError::NeverSeen { pictures: 12 })
    );
    let few = calibrate(&views[..2], SIZE, 12);
    let text = few.err().unwrap().to_string();
    assert!(text.contains("2 of 12") && text.contains("at least 4"), "{text}");
    let flat = vec![views[8].clone(); 5];
    assert_eq!(calibrate(&flat, SIZE, 5), Err(CalibrateError::NotTilted));
    let grey = vec![128; SIZE[0] * SIZE[1]];
    for kind in KINDS {
        let finder = BoardFinder::new(board(kind)).unwrap();
        assert_eq!(finder.find(GrayView::new(SIZE[0], SIZE[1], &grey).unwrap()), None);
    }
    let Err(error) = BoardFinder::new(Board::Charuco {
        squares: [9, 7],
        square_m: 0.03,
        marker_m: 0.04,
        dictionary: "DICT_4X4_50".into(),
    }) else {
        panic!("a marker larger than its square");
    };
    assert!(error.to_string().contains("side of a marker"), "{error}");
}
