//! The equidistant fisheye camera (Kannala-Brandt with four coefficients, OpenCV's `cv::fisheye`).
//!
//! With θ the angle off the optical axis and φ the direction around it:
//!
//! ```text
//! θ' = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸)
//! u = fx θ' cos φ + cx,  v = fy θ' sin φ + cy
//! ```
//!
//! θ comes from the arc tangent of two arguments, so directions more than 90 degrees off the axis project as well.

use super::polynomial::{evaluate, first_sign_change, inverse_of_rising};
use super::{CameraModel, InvalidParameter, Projection, finite, is_finite, positive};
use crate::geometry::{CameraPoint, DistortedPixel, UndistortedPixel};
use nalgebra::{Matrix2x3, Unit, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// The numbers of a fisheye camera, as files give them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FisheyeParameters {
    /// Focal lengths fx, fy, pixels a radian on the axis, positive.
    pub focal_px: [f64; 2],
    /// Principal point cx, cy, pixels; (0, 0) is the centre of the top-left pixel.
    pub centre_px: [f64; 2],
    /// Distortion k1 to k4, without unit; zeros for an exactly equidistant lens.
    pub radial: [f64; 4],
}

/// A fisheye camera with checked parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "FisheyeParameters", into = "FisheyeParameters")]
pub struct Fisheye {
    parameters: FisheyeParameters,
    max_angle_rad: f64,
}

impl Fisheye {
    /// A camera, or which parameter is not finite or, of a focal length, not positive.
    pub fn new(parameters: FisheyeParameters) -> Result<Self, InvalidParameter> {
        positive("focal_px", &parameters.focal_px)?;
        finite("centre_px", &parameters.centre_px)?;
        finite("radial", &parameters.radial)?;
        let [k1, k2, k3, k4] = parameters.radial;
        let slope = [1.0, 3.0 * k1, 5.0 * k2, 7.0 * k3, 9.0 * k4];
        let max_angle_rad = first_sign_change(&slope, PI * PI).map_or(PI, f64::sqrt);
        Ok(Self {
            parameters,
            max_angle_rad,
        })
    }

    /// The numbers it was made of.
    pub const fn parameters(&self) -> &FisheyeParameters {
        &self.parameters
    }

    /// The angle off the axis, radians up to π, from which on nothing projects: where the polynomial folds back.
    pub const fn max_angle_rad(&self) -> f64 {
        self.max_angle_rad
    }

    /// θ' and dθ'/dθ.
    fn bend(&self, angle: f64) -> (f64, f64) {
        let [k1, k2, k3, k4] = self.parameters.radial;
        let square = angle * angle;
        let factor = evaluate(&[1.0, k1, k2, k3, k4], square);
        (
            angle * factor,
            evaluate(&[1.0, 3.0 * k1, 5.0 * k2, 7.0 * k3, 9.0 * k4], square),
        )
    }
}

impl Projection for Fisheye {
    fn project_with_jacobian(&self, point: CameraPoint) -> Option<(DistortedPixel, Matrix2x3<f64>)> {
        let (x, y, z) = (point.0.x, point.0.y, point.0.z);
        let lateral = x.hypot(y);
        let angle = lateral.atan2(z);
        if !is_finite(point.0) || angle >= self.max_angle_rad || lateral.max(z.abs()) == 0.0 {
            return None;
        }
        let (bent, slope) = self.bend(angle);
        let square = lateral * lateral + z * z;
        // θ'/ρ and its derivatives by ρ (divided by ρ) and by z, with their limits on the axis.
        let (ratio, by_lateral) = if lateral > 1e-9 * z.abs() {
            let ratio = bent / lateral;
            (ratio, (slope * z / square - ratio) / (lateral * lateral))
        } else {
            (1.0 / z, 0.0)
        };
        let by_z = -slope / square;
        let FisheyeParameters {
            focal_px: [fx, fy],
            centre_px: [cx, cy],
            ..
        } = self.parameters;
        let (u, v) = (fx * x * ratio + cx, fy * y * ratio + cy);
        let jacobian = Matrix2x3::new(
            fx * (ratio + x * x * by_lateral),
            fx * x * y * by_lateral,
            fx * x * by_z,
            fy * x * y * by_lateral,
            fy * (ratio + y * y * by_lateral),
            fy * y * by_z,
        );
        (u.is_finite() && v.is_finite()).then_some((DistortedPixel { u, v }, jacobian))
    }

    fn distort(&self, pixel: UndistortedPixel) -> Option<DistortedPixel> {
        let FisheyeParameters {
            focal_px: [fx, fy],
            centre_px: [cx, cy],
            ..
        } = self.parameters;
        self.project(CameraPoint::new((pixel.u - cx) / fx, (pixel.v - cy) / fy, 1.0))
    }

    fn undistort(&self, pixel: DistortedPixel) -> Option<UndistortedPixel> {
        let FisheyeParameters {
            focal_px: [fx, fy],
            centre_px: [cx, cy],
            ..
        } = self.parameters;
        let direction = self.unproject(pixel)?;
        if direction.z <= 0.0 {
            return None;
        }
        let (u, v) = (
            fx * direction.x / direction.z + cx,
            fy * direction.y / direction.z + cy,
        );
        (u.is_finite() && v.is_finite()).then_some(UndistortedPixel { u, v })
    }

    fn unproject(&self, pixel: DistortedPixel) -> Option<Unit<Vector3<f64>>> {
        let FisheyeParameters {
            focal_px: [fx, fy],
            centre_px: [cx, cy],
            ..
        } = self.parameters;
        let (x, y) = ((pixel.u - cx) / fx, (pixel.v - cy) / fy);
        let bent = x.hypot(y);
        if bent == 0.0 {
            return Some(Vector3::z_axis());
        }
        let angle = inverse_of_rising(|angle| self.bend(angle), bent, self.max_angle_rad)?;
        let lateral = angle.sin() / bent;
        Some(Unit::new_normalize(Vector3::new(
            x * lateral,
            y * lateral,
            angle.cos(),
        )))
    }

    fn centre(&self) -> DistortedPixel {
        let [u, v] = self.parameters.centre_px;
        DistortedPixel { u, v }
    }

    fn scaled(&self, horizontal: f64, vertical: f64) -> Result<CameraModel, InvalidParameter> {
        let FisheyeParameters {
            focal_px: [fx, fy],
            centre_px: [cx, cy],
            ..
        } = self.parameters;
        Self::new(FisheyeParameters {
            focal_px: [fx * horizontal, fy * vertical],
            centre_px: [(cx + 0.5) * horizontal - 0.5, (cy + 0.5) * vertical - 0.5],
            ..self.parameters
        })
        .map(CameraModel::Fisheye)
    }
}

impl TryFrom<FisheyeParameters> for Fisheye {
    type Error = InvalidParameter;
    fn try_from(parameters: FisheyeParameters) -> Result<Self, InvalidParameter> {
        Self::new(parameters)
    }
}

impl From<Fisheye> for FisheyeParameters {
    fn from(camera: Fisheye) -> Self {
        camera.parameters
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::testing;

    fn lens(radial: [f64; 4]) -> Fisheye {
        Fisheye::new(FisheyeParameters {
            focal_px: [281.0, 283.0],
            centre_px: [317.0, 242.0],
            radial,
        })
        .unwrap()
    }

    #[test]
    fn jacobian_agrees_with_finite_differences() {
        let points = [
            [0.2, -0.3, 2.0],
            [1e-4, 0.0, 1.0],
            [-1.0, 0.8, 0.3],
            [0.5, 0.4, -0.2],
            [1e-7, 2e-7, 1.0],
        ];
        testing::check_jacobian(&lens([-0.01, 0.003, -0.002, 0.0004]), &points);
        let (_, jacobian) = lens([0.1; 4])
            .project_with_jacobian(CameraPoint::new(0.0, 0.0, 2.0))
            .unwrap();
        assert_eq!(jacobian, Matrix2x3::new(140.5, 0.0, 0.0, 0.0, 141.5, 0.0));
    }

    #[test]
    fn rays_and_pixels_return() {
        testing::check_round_trip(&lens([-0.01, 0.003, -0.002, 0.0004]), 640, 480);
    }

    #[test]
    fn looks_behind_itself_only_as_far_as_the_polynomial_rises() {
        let wide = lens([0.0; 4]);
        assert_eq!(wide.max_angle_rad(), PI);
        let behind = wide.project(CameraPoint::new(1.0, 0.0, -0.1)).unwrap();
        assert!(wide.unproject(behind).unwrap().z < 0.0);
        assert_eq!(wide.undistort(behind), None);
        assert_eq!(wide.project(CameraPoint::new(0.0, 0.0, -1.0)), None);
        assert_eq!(wide.project(CameraPoint::new(0.0, 0.0, 0.0)), None);
        assert_eq!(wide.project(CameraPoint::new(0.0, f64::NAN, 1.0)), None);
        let narrow = lens([-0.3, 0.0, 0.0, 0.0]);
        assert!((narrow.max_angle_rad() - (1.0_f64 / 0.9).sqrt()).abs() < 1e-12);
        assert_eq!(narrow.project(CameraPoint::new(2.0, 0.0, 1.0)), None);
        assert_eq!(narrow.unproject(DistortedPixel::new(5e3, 0.0)), None);
    }
}
