//! The cylindrical panorama: a ring of cameras stitched, or a mirror unrolled.
//!
//! The cylinder's axis is the camera frame's y axis (down). A column is an azimuth, a row a height over the radius:
//!
//! ```text
//! u = c0 + N atan2(x, z) / 2π   (wrapped into [-0.5, N - 0.5)),   v = r0 + f y / √(x² + z²)
//! ```

use super::{CameraModel, InvalidParameter, Projection, finite, is_finite, positive};
use crate::geometry::{CameraPoint, DistortedPixel, UndistortedPixel};
use nalgebra::{Matrix2x3, Unit, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The numbers of a cylindrical panorama.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PanoramaParameters {
    /// Columns for 360 degrees, N, positive; the picture's width where it goes all the way round.
    pub columns_per_turn: f64,
    /// Rows for a height equal to the radius, f, pixels, positive.
    pub focal_px: f64,
    /// Column that looks along the camera's z axis and row of the horizon, c0 and r0, pixels.
    pub centre_px: [f64; 2],
}

/// A cylindrical panorama with checked parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "PanoramaParameters", into = "PanoramaParameters")]
pub struct Panorama {
    parameters: PanoramaParameters,
}

impl Panorama {
    /// A panorama, or which parameter is not finite or not positive.
    pub fn new(parameters: PanoramaParameters) -> Result<Self, InvalidParameter> {
        positive("columns_per_turn", &[parameters.columns_per_turn])?;
        positive("focal_px", &[parameters.focal_px])?;
        finite("centre_px", &parameters.centre_px)?;
        Ok(Self { parameters })
    }

    /// The numbers it was made of.
    pub const fn parameters(&self) -> &PanoramaParameters {
        &self.parameters
    }

    /// The same direction's column in \[-0.5, `columns_per_turn` - 0.5).
    pub fn wrapped_column(&self, column: f64) -> f64 {
        let turn = self.parameters.columns_per_turn;
        let wrapped = (column + 0.5).rem_euclid(turn) - 0.5;
        // A column a rounding error below -0.5 wraps to the very end of the turn, which is its beginning.
        if wrapped >= turn - 0.5 { -0.5 } else { wrapped }
    }

    /// Signed columns from `from` to `to` the short way round, in \[-N/2, N/2).
    pub fn column_difference(&self, from: f64, to: f64) -> f64 {
        let turn = self.parameters.columns_per_turn;
        (to - from + turn / 2.0).rem_euclid(turn) - turn / 2.0
    }
}

impl Projection for Panorama {
    fn project_with_jacobian(&self, point: CameraPoint) -> Option<(DistortedPixel, Matrix2x3<f64>)> {
        let PanoramaParameters {
            columns_per_turn,
            focal_px,
            centre_px,
        } = self.parameters;
        let (x, y, z) = (point.0.x, point.0.y, point.0.z);
        let radius = x.hypot(z);
        if !is_finite(point.0) || radius == 0.0 {
            return None;
        }
        let columns_per_radian = columns_per_turn / TAU;
        let u = self.wrapped_column(centre_px[0] + columns_per_radian * x.atan2(z));
        let v = centre_px[1] + focal_px * y / radius;
        let around = columns_per_radian / (radius * radius);
        let inwards = -focal_px * y / (radius * radius * radius);
        let jacobian = Matrix2x3::new(
            around * z,
            0.0,
            -around * x,
            inwards * x,
            focal_px / radius,
            inwards * z,
        );
        (u.is_finite() && v.is_finite()).then_some((DistortedPixel { u, v }, jacobian))
    }

    fn distort(&self, pixel: UndistortedPixel) -> Option<DistortedPixel> {
        let u = self.wrapped_column(pixel.u);
        (u.is_finite() && pixel.v.is_finite()).then_some(DistortedPixel { u, v: pixel.v })
    }

    fn undistort(&self, pixel: DistortedPixel) -> Option<UndistortedPixel> {
        let u = self.wrapped_column(pixel.u);
        (u.is_finite() && pixel.v.is_finite()).then_some(UndistortedPixel { u, v: pixel.v })
    }

    fn unproject(&self, pixel: DistortedPixel) -> Option<Unit<Vector3<f64>>> {
        let PanoramaParameters {
            columns_per_turn,
            focal_px,
            centre_px,
        } = self.parameters;
        let azimuth = (pixel.u - centre_px[0]) * TAU / columns_per_turn;
        let height = (pixel.v - centre_px[1]) / focal_px;
        let direction = Vector3::new(azimuth.sin(), height, azimuth.cos());
        let length = direction.norm();
        length
            .is_finite()
            .then(|| Unit::new_unchecked(direction / length))
    }

    fn centre(&self) -> DistortedPixel {
        let [u, v] = self.parameters.centre_px;
        DistortedPixel { u, v }
    }

    fn scaled(&self, horizontal: f64, vertical: f64) -> Result<CameraModel, InvalidParameter> {
        let PanoramaParameters {
            columns_per_turn,
            focal_px,
            centre_px: [column, row],
        } = self.parameters;
        Self::new(PanoramaParameters {
            columns_per_turn: columns_per_turn * horizontal,
            focal_px: focal_px * vertical,
            centre_px: [(column + 0.5) * horizontal - 0.5, (row + 0.5) * vertical - 0.5],
        })
        .map(CameraModel::Panorama)
    }
}

impl TryFrom<PanoramaParameters> for Panorama {
    type Error = InvalidParameter;
    fn try_from(parameters: PanoramaParameters) -> Result<Self, InvalidParameter> {
        Self::new(parameters)
    }
}

impl From<Panorama> for PanoramaParameters {
    fn from(camera: Panorama) -> Self {
        camera.parameters
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::testing;

    fn ring() -> Panorama {
        Panorama::new(PanoramaParameters {
            columns_per_turn: 1440.0,
            focal_px: 230.0,
            centre_px: [719.5, 119.5],
        })
        .unwrap()
    }

    #[test]
    fn jacobian_agrees_with_finite_differences() {
        testing::check_jacobian(&ring(), &[[0.2, -0.3, 2.0], [1.0, 0.1, -0.5], [-1.0, 0.8, 0.3]]);
    }

    #[test]
    fn rays_and_pixels_return() {
        testing::check_round_trip(&ring(), 1440, 240);
    }

    #[test]
    fn columns_wrap_where_the_cylinder_closes() {
        let ring = ring();
        let left = ring.project(CameraPoint::new(-1e-6, 0.0, -1.0)).unwrap();
        let right = ring.project(CameraPoint::new(1e-6, 0.0, -1.0)).unwrap();
        assert!(
            (left.u + 0.5).abs() < 1e-3 && (right.u - 1439.5).abs() < 1e-3,
            "{left:?} {right:?}"
        );
        assert!(ring.column_difference(right.u, left.u) > 0.0);
        assert!(ring.column_difference(right.u, left.u) < 1e-3);
        assert_eq!(ring.wrapped_column(1439.5), -0.5);
        assert_eq!(ring.wrapped_column(-0.5 - 1e-16), -0.5);
        assert_eq!(ring.project(CameraPoint::new(0.0, 1.0, 0.0)), None);
        assert_eq!(ring.project(CameraPoint::new(f64::NAN, 1.0, 0.0)), None);
        assert_eq!(ring.unproject(DistortedPixel::new(f64::INFINITY, 0.0)), None);
    }
}
