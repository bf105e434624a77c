//! Contracts that every lens keeps.

use super::Projection;
use crate::geometry::{CameraPoint, DistortedPixel};
use nalgebra::{Point3, Vector3};

pub(super) fn check_jacobian(lens: &dyn Projection, points: &[[f64; 3]]) {
    for &coordinates in points {
        let point = Point3::from(coordinates);
        let (_, jacobian) = lens.project_with_jacobian(CameraPoint(point)).unwrap();
        for axis in 0..3 {
            let step = 1e-6 * point.coords.norm();
            let mut offset = Vector3::zeros();
            offset[axis] = step;
            let ahead = lens.project(CameraPoint(point + offset)).unwrap();
            let behind = lens.project(CameraPoint(point - offset)).unwrap();
            let numeric = [
                (ahead.u - behind.u) / (2.0 * step),
                (ahead.v - behind.v) / (2.0 * step),
            ];
            for row in 0..2 {
                let difference = (jacobian[(row, axis)] - numeric[row]).abs();
                assert!(
                    difference < 1e-6 * (1.0 + jacobian.norm()),
                    "{coordinates:?} ({row}, {axis}): {} is not {}",
                    jacobian[(row, axis)],
                    numeric[row]
                );
            }
        }
    }
}

/// Pixel -> direction -> pixel and pixel -> ideal -> pixel over the whole picture.
pub(super) fn check_round_trip(lens: &dyn Projection, width: usize, height: usize) {
    for row in (0..height).step_by(24) {
        for column in (0..width).step_by(24) {
            let pixel = DistortedPixel::new(column as f64, row as f64);
            let direction = lens.unproject(pixel).unwrap();
            assert!((direction.norm() - 1.0).abs() < 1e-14);
            let back = lens
                .project(CameraPoint((direction.into_inner() * 3.7).into()))
                .unwrap();
            assert!(
                (back.u - pixel.u).hypot(back.v - pixel.v) < 1e-9,
                "{pixel:?} {back:?}"
            );
            let ideal = lens.undistort(pixel).unwrap();
            let back = lens.distort(ideal).unwrap();
            assert!(
                (back.u - pixel.u).hypot(back.v - pixel.v) < 1e-9,
                "{pixel:?} {back:?}"
            );
        }
    }
}
