//! The pinhole camera with Brown-Conrady distortion: ordinary lenses, up to about 120 degrees.
//!
//! With (x, y) = (X/Z, Y/Z) and r² = x² + y² (Brown, "Decentering distortion of lenses", 1966; the order and signs
//! of OpenCV and of Bouguet's toolbox):
//!
//! ```text
//! x' = x (1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p1 x y + p2 (r² + 2 x²)
//! y' = y (1 + k1 r² + k2 r⁴ + k3 r⁶) + p1 (r² + 2 y²) + 2 p2 x y
//! u = fx x' + cx,  v = fy y' + cy
//! ```

use super::polynomial::{evaluate, first_sign_change, inverse_of_rising};
use super::{CameraModel, InvalidParameter, Projection, finite, is_finite, positive};
use crate::geometry::{CameraPoint, DistortedPixel, UndistortedPixel};
use nalgebra::{Matrix2, Matrix2x3, Unit, Vector2, Vector3};
use serde::{Deserialize, Serialize};

/// Largest r² looked at: 1e4 is a direction 89.4 degrees off the axis, beyond any picture.
const RADIUS_SQUARED_LIMIT: f64 = 1e4;
/// Steps of Newton's method in the plane; it needs 3 to 6.
const ITERATIONS: usize = 50;
/// Residual in the plane z = 1 that counts as solved: a billionth of a pixel at a focal length of 1000.
const TOLERANCE: f64 = 1e-12;

/// The numbers of a pinhole camera, as files give them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PinholeParameters {
    /// Focal lengths fx, fy, pixels, positive.
    pub focal_px: [f64; 2],
    /// Principal point cx, cy, pixels; (0, 0) is the centre of the top-left pixel.
    pub centre_px: [f64; 2],
    /// Radial distortion k1, k2, k3, without unit; zeros for an ideal lens.
    pub radial: [f64; 3],
    /// Tangential distortion p1, p2, without unit; zeros for an ideal lens.
    pub tangential: [f64; 2],
}

/// A pinhole camera with checked parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "PinholeParameters", into = "PinholeParameters")]
pub struct Pinhole {
    parameters: PinholeParameters,
    /// Where the radial polynomial stops rising, r²; points from there on do not project.
    max_radius_squared: f64,
}

impl Pinhole {
    /// A camera, or which parameter is not finite or, of a focal length, not positive.
    pub fn new(parameters: PinholeParameters) -> Result<Self, InvalidParameter> {
        positive("focal_px", &parameters.focal_px)?;
        finite("centre_px", &parameters.centre_px)?;
        finite("radial", &parameters.radial)?;
        finite("tangential", &parameters.tangential)?;
        let [k1, k2, k3] = parameters.radial;
        let slope = [1.0, 3.0 * k1, 5.0 * k2, 7.0 * k3];
        let max_radius_squared =
            first_sign_change(&slope, RADIUS_SQUARED_LIMIT).unwrap_or(RADIUS_SQUARED_LIMIT);
        Ok(Self {
            parameters,
            max_radius_squared,
        })
    }

    /// An ideal camera without distortion; refuses like [`Pinhole::new`].
    pub fn ideal(focal_px: [f64; 2], centre_px: [f64; 2]) -> Result<Self, InvalidParameter> {
        Self::new(PinholeParameters {
            focal_px,
            centre_px,
            radial: [0.0; 3],
            tangential: [0.0; 2],
        })
    }

    /// The numbers it was made of.
    pub const fn parameters(&self) -> &PinholeParameters {
        &self.parameters
    }

    /// The largest distance from the axis in the plane z = 1 (the tangent of the angle off the axis) that projects:
    /// where the distortion polynomial would fold back, or 100.
    pub fn max_radius(&self) -> f64 {
        self.max_radius_squared.sqrt()
    }

    /// Where the lens moves a point of the plane z = 1, and the derivative of that; `None` beyond the fold.
    fn bend(&self, point: Vector2<f64>) -> Option<(Vector2<f64>, Matrix2<f64>)> {
        let [k1, k2, k3] = self.parameters.radial;
        let [p1, p2] = self.parameters.tangential;
        let (x, y) = (point.x, point.y);
        let r2 = x * x + y * y;
        if r2.is_nan() || r2 >= self.max_radius_squared {
            return None;
        }
        let factor = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        let growth = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);
        let bent = Vector2::new(
            x * factor + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * factor + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        );
        let mixed = 2.0 * (x * y * growth + p1 * x + p2 * y);
        let jacobian = Matrix2::new(
            factor + 2.0 * x * x * growth + 2.0 * p1 * y + 6.0 * p2 * x,
            mixed,
            mixed,
            factor + 2.0 * y * y * growth + 6.0 * p1 * y + 2.0 * p2 * x,
        );
        // Tangential terms can fold the picture a little before the radial ones do.
        (jacobian.determinant() > 0.0).then_some((bent, jacobian))
    }

    /// The point of the plane z = 1 that the lens moves to `bent`; `None` where there is none.
    fn straighten(&self, bent: Vector2<f64>) -> Option<Vector2<f64>> {
        let mut point = self.straighten_radially(bent)?;
        let (mut image, mut jacobian) = self.bend(point)?;
        let mut error = (image - bent).norm();
        for _ in 0..ITERATIONS {
            if error <= f64::EPSILON * (1.0 + bent.norm()) {
                break;
            }
            let mut step = jacobian.try_inverse()? * (image - bent);
            let better = (0..ITERATIONS).find_map(|_| {
                let candidate = point - step;
                step /= 2.0;
                let (image, jacobian) = self.bend(candidate)?;
                ((image - bent).norm() < error).then_some((candidate, image, jacobian))
            });
            let Some(found) = better else { break };
            (point, image, jacobian) = found;
            error = (image - bent).norm();
        }
        (error <= TOLERANCE * (1.0 + bent.norm())).then_some(point)
    }

    /// The exact answer of a lens without tangential distortion: where Newton's method starts.
    fn straighten_radially(&self, bent: Vector2<f64>) -> Option<Vector2<f64>> {
        let [k1, k2, k3] = self.parameters.radial;
        let radius = bent.norm();
        if radius == 0.0 || !radius.is_finite() {
            return radius.is_finite().then_some(bent);
        }
        let factor = [1.0, k1, k2, k3];
        let slope = [1.0, 3.0 * k1, 5.0 * k2, 7.0 * k3];
        let bent_radius = |r: f64| (r * evaluate(&factor, r * r), evaluate(&slope, r * r));
        // At the fold itself the derivative vanishes; a start just inside it leaves the decision to Newton's method.
        let limit = 0.999 * self.max_radius();
        Some(bent * (inverse_of_rising(bent_radius, radius, limit).unwrap_or(limit) / radius))
    }

    fn pixel(&self, plane: Vector2<f64>) -> Option<(f64, f64)> {
        let PinholeParameters {
            focal_px, centre_px, ..
        } = &self.parameters;
        let (u, v) = (
            focal_px[0] * plane.x + centre_px[0],
            focal_px[1] * plane.y + centre_px[1],
        );
        (u.is_finite() && v.is_finite()).then_some((u, v))
    }

    fn plane(&self, u: f64, v: f64) -> Vector2<f64> {
        let PinholeParameters {
            focal_px, centre_px, ..
        } = &self.parameters;
        Vector2::new((u - centre_px[0]) / focal_px[0], (v - centre_px[1]) / focal_px[1])
    }
}

impl Projection for Pinhole {
    fn project_with_jacobian(&self, point: CameraPoint) -> Option<(DistortedPixel, Matrix2x3<f64>)> {
        let point = point.0;
        if !is_finite(point) || point.z <= 0.0 {
            return None;
        }
        let plane = Vector2::new(point.x / point.z, point.y / point.z);
        let (bent, bend) = self.bend(plane)?;
        let (u, v) = self.pixel(bent)?;
        let flatten = Matrix2x3::new(1.0, 0.0, -plane.x, 0.0, 1.0, -plane.y) / point.z;
        let [fx, fy] = self.parameters.focal_px;
        let jacobian = Matrix2::new(fx, 0.0, 0.0, fy) * bend * flatten;
        Some((DistortedPixel { u, v }, jacobian))
    }

    fn distort(&self, pixel: UndistortedPixel) -> Option<DistortedPixel> {
        let (bent, _) = self.bend(self.plane(pixel.u, pixel.v))?;
        self.pixel(bent).map(|(u, v)| DistortedPixel { u, v })
    }

    fn undistort(&self, pixel: DistortedPixel) -> Option<UndistortedPixel> {
        let plane = self.straighten(self.plane(pixel.u, pixel.v))?;
        self.pixel(plane).map(|(u, v)| UndistortedPixel { u, v })
    }

    fn unproject(&self, pixel: DistortedPixel) -> Option<Unit<Vector3<f64>>> {
        let plane = self.straighten(self.plane(pixel.u, pixel.v))?;
        Some(Unit::new_normalize(Vector3::new(plane.x, plane.y, 1.0)))
    }

    fn centre(&self) -> DistortedPixel {
        let [u, v] = self.parameters.centre_px;
        DistortedPixel { u, v }
    }

    fn scaled(&self, horizontal: f64, vertical: f64) -> Result<CameraModel, InvalidParameter> {
        let PinholeParameters {
            focal_px: [fx, fy],
            centre_px: [cx, cy],
            ..
        } = self.parameters;
        Self::new(PinholeParameters {
            focal_px: [fx * horizontal, fy * vertical],
            centre_px: [(cx + 0.5) * horizontal - 0.5, (cy + 0.5) * vertical - 0.5],
            ..self.parameters
        })
        .map(CameraModel::Pinhole)
    }
}

impl TryFrom<PinholeParameters> for Pinhole {
    type Error = InvalidParameter;
    fn try_from(parameters: PinholeParameters) -> Result<Self, InvalidParameter> {
        Self::new(parameters)
    }
}

impl From<Pinhole> for PinholeParameters {
    fn from(camera: Pinhole) -> Self {
        camera.parameters
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::testing;

    fn barrel() -> Pinhole {
        Pinhole::new(PinholeParameters {
            focal_px: [387.0, 424.7],
            centre_px: [178.2, 141.9],
            radial: [-0.2931, 0.01, 0.0],
            tangential: [0.0052, -0.0046],
        })
        .unwrap()
    }

    #[test]
    fn jacobian_agrees_with_finite_differences() {
        testing::check_jacobian(
            &barrel(),
            &[
                [0.2, -0.3, 2.0],
                [0.0, 0.0, 1.0],
                [-1.0, 0.8, 3.0],
                [0.5, 0.1, 0.9],
            ],
        );
    }

    #[test]
    fn rays_and_pixels_return() {
        testing::check_round_trip(&barrel(), 360, 288);
    }

    #[test]
    fn what_lies_beyond_the_fold_or_behind_does_not_project() {
        let camera = barrel();
        assert!(camera.max_radius() < 1.2, "{}", camera.max_radius());
        // Without the limit this point, 72 degrees off the axis, would fold back into the picture.
        assert_eq!(camera.project(CameraPoint::new(3.0, 0.0, 1.0)), None);
        assert_eq!(camera.project(CameraPoint::new(0.1, 0.1, -1.0)), None);
        assert_eq!(camera.project(CameraPoint::new(0.1, 0.1, 0.0)), None);
        assert_eq!(camera.project(CameraPoint::new(f64::NAN, 0.1, 1.0)), None);
        assert_eq!(camera.project(CameraPoint::new(0.1, 0.1, f64::INFINITY)), None);
        assert_eq!(camera.undistort(DistortedPixel::new(1e5, 0.0)), None);
        assert_eq!(camera.undistort(DistortedPixel::new(f64::NAN, 0.0)), None);
        assert_eq!(camera.distort(UndistortedPixel::new(f64::INFINITY, 0.0)), None);
    }

    #[test]
    fn zero_or_non_finite_parameters_are_refused() {
        assert_eq!(
            Pinhole::ideal([0.0, 1.0], [0.0, 0.0]).unwrap_err().field,
            "focal_px"
        );
        assert_eq!(
            Pinhole::ideal([1.0, 1.0], [f64::NAN, 0.0]).unwrap_err().field,
            "centre_px"
        );
        let text = serde_json::to_string(&barrel()).unwrap();
        assert_eq!(serde_json::from_str::<Pinhole>(&text).unwrap(), barrel());
        assert!(serde_json::from_str::<Pinhole>(&text.replace("387.0", "0.0")).is_err());
    }
}
