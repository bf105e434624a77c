//! Cameras: from points of the world to pixels and back.
//!
//! A [`Camera`] is a lens ([`CameraModel`]), a [`Pose`] and the size of its picture. Every model is a file of its own
//! that implements [`Projection`], with one variant and one line in [`CameraModel::projection`]. Nothing here reads
//! files: that is [`crate::calibration`]'s.
//!
//! Projections give a pixel also where it lies outside the picture ([`Camera::contains`] tells), but never one of a
//! point that the lens cannot see: behind it, or where its distortion polynomial would fold back.

mod fisheye;
mod panorama;
mod pinhole;
mod polynomial;
#[cfg(test)]
mod testing;

pub use fisheye::{Fisheye, FisheyeParameters};
pub use panorama::{Panorama, PanoramaParameters};
pub use pinhole::{Pinhole, PinholeParameters};

use crate::geometry::{CameraPoint, DistortedPixel, Pose, Ray, UndistortedPixel, WorldPoint};
use nalgebra::{Matrix2x3, Point3, Unit, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// What every lens can do, in the camera's frame.
pub trait Projection {
    /// The pixel of a point and its derivative by the point (2x3, pixels a metre); `None` for a point that the lens
    /// cannot see or that is not finite.
    fn project_with_jacobian(&self, point: CameraPoint) -> Option<(DistortedPixel, Matrix2x3<f64>)>;
    /// Where the lens delivers what an ideal camera delivers at `pixel`; `None` where it does not.
    fn distort(&self, pixel: UndistortedPixel) -> Option<DistortedPixel>;
    /// Where an ideal camera would deliver what this one delivers at `pixel`, solved to rounding; `None` where
    /// there is no such place.
    fn undistort(&self, pixel: DistortedPixel) -> Option<UndistortedPixel>;
    /// The direction (camera frame, unit length) that is seen at `pixel`; `None` where nothing is.
    fn unproject(&self, pixel: DistortedPixel) -> Option<Unit<Vector3<f64>>>;
    /// The pixel that looks straight ahead.
    fn centre(&self) -> DistortedPixel;
    /// The same lens for a picture resized by these factors (width and height, new over old).
    ///
    /// # Errors
    /// Where a factor is not finite and positive.
    fn scaled(&self, horizontal: f64, vertical: f64) -> Result<CameraModel, InvalidParameter>;

    /// The pixel of a point; `None` for a point that the lens cannot see or that is not finite.
    fn project(&self, point: CameraPoint) -> Option<DistortedPixel> {
        self.project_with_jacobian(point).map(|(pixel, _)| pixel)
    }
}

/// The lenses that are known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "model", rename_all = "snake_case")]
pub enum CameraModel {
    /// Ordinary lens: perspective with Brown-Conrady distortion.
    Pinhole(Pinhole),
    /// Equidistant fisheye with four coefficients.
    Fisheye(Fisheye),
    /// Cylindrical panorama.
    Panorama(Panorama),
}

/// A lens somewhere in the world, with the size of its picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// The lens.
    pub model: CameraModel,
    /// Where the camera stands and how it is turned.
    pub pose: Pose,
    /// Width of the picture, pixels.
    pub width: usize,
    /// Height of the picture, pixels.
    pub height: usize,
}

/// A parameter of a sensor that no sensor can have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{field}` is {value}, but must be {requirement}")]
pub struct InvalidParameter {
    /// Name of the parameter.
    pub field: &'static str,
    /// Its value, as text.
    pub value: String,
    /// What it must be.
    pub requirement: &'static str,
}

impl CameraModel {
    /// The lens behind the enumeration.
    pub fn projection(&self) -> &dyn Projection {
        match self {
            Self::Pinhole(lens) => lens,
            Self::Fisheye(lens) => lens,
            Self::Panorama(lens) => lens,
        }
    }
}

impl Camera {
    /// The pixel of a point of the world, possibly outside the picture; `None` where the lens cannot see it.
    pub fn project(&self, point: WorldPoint) -> Option<DistortedPixel> {
        self.model
            .projection()
            .project(self.pose.camera_from_world(point))
    }

    /// The pixel of a point of the world where it lies in the picture.
    pub fn project_inside(&self, point: WorldPoint) -> Option<DistortedPixel> {
        self.project(point).filter(|pixel| self.contains(*pixel))
    }

    /// The pixel of a point of the world and its derivative by the point (2x3, pixels a metre, world frame); `None` also
    /// where the derivative is not finite.
    pub fn project_with_jacobian(&self, point: WorldPoint) -> Option<(DistortedPixel, Matrix2x3<f64>)> {
        let (pixel, by_camera_point) = self
            .model
            .projection()
            .project_with_jacobian(self.pose.camera_from_world(point))?;
        let rotation = self.pose.sensor_from_world.rotation.to_rotation_matrix();
        let jacobian = by_camera_point * rotation.matrix();
        let real = jacobian.iter().all(|entry| entry.is_finite());
        real.then_some((pixel, jacobian))
    }

    /// What is seen at `pixel`: the half-line from the camera's centre; `None` where the lens shows nothing.
    pub fn ray(&self, pixel: DistortedPixel) -> Option<Ray> {
        let direction = self.model.projection().unproject(pixel)?;
        let rotation = &self.pose.sensor_from_world.rotation;
        let direction = Unit::new_unchecked(rotation.inverse_transform_vector(&direction));
        Some(Ray {
            origin: self.pose.centre(),
            direction,
        })
    }

    /// Depth of a point, metres: along the optical axis (negative behind) or, in a panorama, from the cylinder's axis.
    pub fn depth_m(&self, point: WorldPoint) -> f64 {
        let point = self.pose.camera_from_world(point).0;
        match self.model {
            CameraModel::Pinhole(_) | CameraModel::Fisheye(_) => point.z,
            CameraModel::Panorama(_) => point.x.hypot(point.z),
        }
    }

    /// Pixels that a metre across the line of sight covers at `point`: the geometric mean of the two directions.
    /// A head of diameter d metres is about d times this wide. `None` where the lens cannot see the point.
    pub fn pixels_per_metre(&self, point: WorldPoint) -> Option<f64> {
        let (_, jacobian) = self.project_with_jacobian(point)?;
        let scale = (jacobian * jacobian.transpose())
            .determinant()
            .max(0.0)
            .sqrt()
            .sqrt();
        scale.is_finite().then_some(scale)
    }

    /// Whether a pixel lies in the picture, whose edges are half a pixel outside the outermost pixel centres.
    pub fn contains(&self, pixel: DistortedPixel) -> bool {
        (-0.5..self.width as f64 - 0.5).contains(&pixel.u)
            && (-0.5..self.height as f64 - 0.5).contains(&pixel.v)
    }

    /// Where the camera is.
    pub fn centre(&self) -> WorldPoint {
        self.pose.centre()
    }

    /// Angle from the picture's left edge to its right in the row of the principal point, radians, up to 2π; `None`
    /// where the lens shows nothing at an edge.
    pub fn horizontal_field_of_view_rad(&self) -> Option<f64> {
        if let CameraModel::Panorama(lens) = self.model {
            return Some(TAU * (self.width as f64 / lens.parameters().columns_per_turn).min(1.0));
        }
        let lens = self.model.projection();
        let row = lens.centre().v;
        let azimuth = |column| {
            lens.unproject(DistortedPixel::new(column, row))
                .map(|d| d.x.atan2(d.z))
        };
        Some(azimuth(self.width as f64 - 0.5)? - azimuth(-0.5)?)
    }

    /// Angle from the picture's top edge to its bottom in the column of the principal point, radians; `None` where
    /// the lens shows nothing at an edge.
    pub fn vertical_field_of_view_rad(&self) -> Option<f64> {
        let lens = self.model.projection();
        let column = lens.centre().u;
        let elevation = |row| {
            lens.unproject(DistortedPixel::new(column, row))
                .map(|d| d.y.atan2(d.z))
        };
        Some(elevation(self.height as f64 - 0.5)? - elevation(-0.5)?)
    }
}

fn is_finite(point: Point3<f64>) -> bool {
    point.iter().all(|coordinate| coordinate.is_finite())
}

/// Greatest number of a lens: far beyond any, and products of two are finite.
const GREATEST: f64 = 1e100;

/// Refuses values that are not finite.
fn finite(field: &'static str, values: &[f64]) -> Result<(), InvalidParameter> {
    check(field, values, "finite, at most 1e100", |value| {
        value.abs() <= GREATEST
    })
}

/// Refuses values that are not finite and positive.
fn positive(field: &'static str, values: &[f64]) -> Result<(), InvalidParameter> {
    check(field, values, "finite and positive, at most 1e100", |value| {
        value > 0.0 && value <= GREATEST
    })
}

fn check(
    field: &'static str,
    values: &[f64],
    requirement: &'static str,
    good: impl Fn(f64) -> bool,
) -> Result<(), InvalidParameter> {
    match values.iter().find(|value| !good(**value)) {
        Some(value) => Err(InvalidParameter {
            field,
            value: value.to_string(),
            requirement,
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn camera() -> Camera {
        let lens = Pinhole::new(PinholeParameters {
            focal_px: [500.0, 505.0],
            centre_px: [319.5, 239.5],
            radial: [-0.2, 0.05, 0.0],
            tangential: [0.001, -0.002],
        })
        .unwrap();
        let pose = Pose::looking_at(WorldPoint::new(1.0, -2.0, 1.5), WorldPoint::new(0.3, 1.0, 1.0)).unwrap();
        Camera {
            model: CameraModel::Pinhole(lens),
            pose,
            width: 640,
            height: 480,
        }
    }

    #[test]
    fn a_ray_passes_through_the_point_it_came_from() {
        let camera = camera();
        for point in [WorldPoint::new(0.3, 1.0, 1.0), WorldPoint::new(-0.2, 1.5, 1.3)] {
            let ray = camera.ray(camera.project_inside(point).unwrap()).unwrap();
            assert!(ray.at(camera.centre().distance_m(point)).distance_m(point) < 1e-9);
        }
        assert!(camera.depth_m(WorldPoint::new(1.0, -3.0, 1.5)) < 0.0);
    }

    #[test]
    fn a_derivative_that_is_not_finite_is_none() {
        let lens = |focal_px: f64, k3| {
            Pinhole::new(PinholeParameters {
                focal_px: [focal_px; 2],
                centre_px: [1e99, 5.0],
                radial: [0.0, 0.0, k3],
                tangential: [0.0; 2],
            })
        };
        assert!(lens(1e101, 0.0).is_err() && lens(500.0, f64::MAX).is_err());
        let model = CameraModel::Pinhole(lens(1e100, 1e100).unwrap());
        let camera = Camera { model, ..camera() };
        for point in [[0.3, 0.2, 0.5], [0.0, 0.0, 1e-300], [1e3, -1e3, 2.0]] {
            let point = WorldPoint::new(point[0], point[1], point[2]);
            if let Some((_, jacobian)) = camera.project_with_jacobian(point) {
                assert!(jacobian.iter().all(|entry| entry.is_finite()));
            }
        }
    }

    #[test]
    fn jacobian_by_the_world_agrees_with_finite_differences() {
        let (camera, point) = (camera(), WorldPoint::new(0.1, 1.1, 0.8));
        let (_, jacobian) = camera.project_with_jacobian(point).unwrap();
        for axis in 0..3 {
            let mut offset = Vector3::zeros();
            offset[axis] = 1e-6;
            let ahead = camera.project(WorldPoint(point.0 + offset)).unwrap();
            let behind = camera.project(WorldPoint(point.0 - offset)).unwrap();
            assert_relative_eq!(jacobian[(0, axis)], (ahead.u - behind.u) / 2e-6, epsilon = 1e-5);
            assert_relative_eq!(jacobian[(1, axis)], (ahead.v - behind.v) / 2e-6, epsilon = 1e-5);
        }
        assert_relative_eq!(
            camera.pixels_per_metre(point).unwrap(),
            500.0 / camera.depth_m(point),
            max_relative = 0.05
        );
    }

    #[test]
    fn fields_of_view_are_those_of_the_textbook() {
        let model = CameraModel::Pinhole(Pinhole::ideal([320.0, 240.0], [319.5, 239.5]).unwrap());
        let camera = Camera {
            model,
            pose: Pose::identity(),
            width: 640,
            height: 480,
        };
        assert_relative_eq!(
            camera.horizontal_field_of_view_rad().unwrap(),
            TAU / 4.0,
            epsilon = 1e-12
        );
        assert_relative_eq!(
            camera.vertical_field_of_view_rad().unwrap(),
            TAU / 4.0,
            epsilon = 1e-12
        );
        let parameters = PanoramaParameters {
            columns_per_turn: 1280.0,
            focal_px: 200.0,
            centre_px: [319.5, 239.5],
        };
        let half = Camera {
            model: CameraModel::Panorama(Panorama::new(parameters).unwrap()),
            ..camera
        };
        assert_relative_eq!(half.horizontal_field_of_view_rad().unwrap(), TAU / 2.0);
    }

    #[test]
    fn a_resized_picture_sees_the_same_directions() {
        let camera = camera();
        let half = Camera {
            model: camera.model.projection().scaled(0.5, 0.5).unwrap(),
            width: 320,
            height: 240,
            ..camera
        };
        assert_relative_eq!(
            half.horizontal_field_of_view_rad().unwrap(),
            camera.horizontal_field_of_view_rad().unwrap(),
            epsilon = 1e-12
        );
        assert!(camera.model.projection().scaled(0.0, 1.0).is_err());
    }

    #[test]
    fn a_camera_survives_being_written_and_read() {
        let text = serde_json::to_string(&camera()).unwrap();
        let back: Camera = serde_json::from_str(&text).unwrap();
        assert_eq!(back, camera());
    }
}
