//! Every lens against OpenCV 4.10: `goldens/make_goldens.py` writes the goldens and says how.

#![expect(
    clippy::unwrap_used,
    reason = "a test stops at what it does not expect, also in its helpers"
)]

use hearsight_core::camera::{Fisheye, FisheyeParameters, Pinhole, PinholeParameters};
use hearsight_core::{Camera, CameraModel, DistortedPixel, Pose, UndistortedPixel, WorldPoint};
use nalgebra::{Isometry3, Vector3};
use serde::Deserialize;

const TOLERANCE_PX: f64 = 1e-6;

#[derive(Deserialize)]
struct Case {
    name: String,
    model: String,
    width: usize,
    height: usize,
    focal_px: [f64; 2],
    centre_px: [f64; 2],
    distortion: Vec<f64>,
    rotation_vector: [f64; 3],
    translation_m: [f64; 3],
    world_m: Vec<[f64; 3]>,
    pixels: Vec<[f64; 2]>,
    undistorted: Vec<[f64; 2]>,
    jacobians: Vec<[f64; 6]>,
}

impl Case {
    fn camera(&self) -> Camera {
        let Self {
            focal_px, centre_px, ..
        } = *self;
        let d = &self.distortion;
        let model = match self.model.as_str() {
            "pinhole" => {
                let (radial, tangential) = ([d[0], d[1], d[4]], [d[2], d[3]]);
                let parameters = PinholeParameters {
                    focal_px,
                    centre_px,
                    radial,
                    tangential,
                };
                CameraModel::Pinhole(Pinhole::new(parameters).unwrap())
            }
            _ => {
                assert_eq!(self.model, "fisheye");
                let radial = [d[0], d[1], d[2], d[3]];
                CameraModel::Fisheye(
                    Fisheye::new(FisheyeParameters {
                        focal_px,
                        centre_px,
                        radial,
                    })
                    .unwrap(),
                )
            }
        };
        let sensor_from_world = Isometry3::new(
            Vector3::from(self.translation_m),
            Vector3::from(self.rotation_vector),
        );
        Camera {
            model,
            pose: Pose { sensor_from_world },
            width: self.width,
            height: self.height,
        }
    }
}

fn cases() -> Vec<Case> {
    serde_json::from_str(include_str!("goldens/cameras.json")).unwrap()
}

#[test]
fn points_project_where_opencv_projects_them() {
    for case in cases() {
        let (camera, mut worst) = (case.camera(), 0.0_f64);
        for (point, [u, v]) in case.world_m.iter().zip(&case.pixels) {
            let pixel = camera.project(WorldPoint((*point).into())).unwrap();
            worst = worst.max((pixel.u - u).hypot(pixel.v - v));
        }
        println!(
            "{} {}: projection differs by at most {worst:.1e} px",
            case.model, case.name
        );
        assert!(worst < TOLERANCE_PX, "{}: {worst}", case.name);
    }
}

#[test]
fn pixels_undistort_to_where_opencv_converges() {
    for case in cases() {
        let camera = case.camera();
        let lens = camera.model.projection();
        let (mut worst, mut worst_back) = (0.0_f64, 0.0_f64);
        for ([u, v], [ideal_u, ideal_v]) in case.pixels.iter().zip(&case.undistorted) {
            let ideal = lens.undistort(DistortedPixel::new(*u, *v)).unwrap();
            worst = worst.max((ideal.u - ideal_u).hypot(ideal.v - ideal_v));
            let back = lens.distort(UndistortedPixel::new(*ideal_u, *ideal_v)).unwrap();
            worst_back = worst_back.max((back.u - u).hypot(back.v - v));
        }
        println!(
            "{} {}: undistortion differs by at most {worst:.1e} px, distortion by {worst_back:.1e} px",
            case.model, case.name
        );
        assert!(
            worst < TOLERANCE_PX && worst_back < TOLERANCE_PX,
            "{}: {worst} {worst_back}",
            case.name
        );
    }
}

#[test]
fn jacobians_are_those_of_opencv() {
    for case in cases() {
        let camera = case.camera();
        for (point, expected) in case.world_m.iter().zip(&case.jacobians) {
            let point = camera.pose.camera_from_world(WorldPoint((*point).into()));
            let (_, jacobian) = camera.model.projection().project_with_jacobian(point).unwrap();
            for (index, expected) in expected.iter().enumerate() {
                let difference = (jacobian[(index / 3, index % 3)] - expected).abs();
                assert!(
                    difference < 1e-7 * (1.0 + jacobian.norm()),
                    "{} {index}: {difference}",
                    case.name
                );
            }
        }
    }
}
