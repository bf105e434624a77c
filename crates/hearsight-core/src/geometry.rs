//! Frames of reference: world, camera, and the two kinds of pixel.
//!
//! World: metres, right-handed, z up. Camera: x right, y down, z forward, metres. Pixel (0, 0) is the centre of the
//! top-left pixel. Each is a type of its own, so that a distorted pixel is never taken for an ideal one.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// A point in the world, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct WorldPoint(pub Point3<f64>);

/// A point in a camera's frame (x right, y down, z forward), metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct CameraPoint(pub Point3<f64>);

/// A pixel as the lens delivers it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DistortedPixel {
    /// Column, pixels, growing to the right.
    pub u: f64,
    /// Row, pixels, growing downwards.
    pub v: f64,
}

/// A pixel as an ideal camera with the same matrix but without distortion would deliver it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct UndistortedPixel {
    /// Column, pixels, growing to the right.
    pub u: f64,
    /// Row, pixels, growing downwards.
    pub v: f64,
}

/// A half-line in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: WorldPoint,
    /// Where it goes, unit length.
    pub direction: Unit<Vector3<f64>>,
}

/// Where a sensor stands and how it is turned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Pose {
    /// Maps points of the world into the sensor's frame.
    pub sensor_from_world: Isometry3<f64>,
}

impl WorldPoint {
    /// A point from its coordinates in metres.
    pub fn new(x_m: f64, y_m: f64, z_m: f64) -> Self {
        Self(Point3::new(x_m, y_m, z_m))
    }

    /// Distance to another point, metres.
    pub fn distance_m(self, other: Self) -> f64 {
        (self.0 - other.0).norm()
    }
}

impl CameraPoint {
    /// A point from its coordinates in metres.
    pub fn new(x_m: f64, y_m: f64, z_m: f64) -> Self {
        Self(Point3::new(x_m, y_m, z_m))
    }
}

impl DistortedPixel {
    /// A pixel from its column and row.
    pub const fn new(u: f64, v: f64) -> Self {
        Self { u, v }
    }
}

impl UndistortedPixel {
    /// A pixel from its column and row.
    pub const fn new(u: f64, v: f64) -> Self {
        Self { u, v }
    }
}

impl Ray {
    /// The point `distance_m` metres along the ray.
    pub fn at(self, distance_m: f64) -> WorldPoint {
        WorldPoint(self.origin.0 + self.direction.into_inner() * distance_m)
    }
}

impl Pose {
    /// A sensor at the world's origin whose axes are the world's.
    pub fn identity() -> Self {
        Self {
            sensor_from_world: Isometry3::identity(),
        }
    }

    /// A sensor at `position` whose z axis points at `target`, upright: its x axis is horizontal and, unless it looks
    /// straight up or down, its y axis points below the horizon. Straight up or down, x is the world's x. `None`
    /// where the two are the same place, not finite, or so far apart that their distance is not finite.
    pub fn looking_at(position: WorldPoint, target: WorldPoint) -> Option<Self> {
        let offset = target.0 - position.0;
        if !offset.norm().is_finite() {
            return None;
        }
        let forward = offset.try_normalize(1e-12)?;
        let right = forward
            .cross(&Vector3::z())
            .try_normalize(1e-9)
            .unwrap_or_else(Vector3::x);
        let down = forward.cross(&right);
        let rotation = Matrix3::from_rows(&[right.transpose(), down.transpose(), forward.transpose()]);
        if !rotation
            .iter()
            .chain(position.0.iter())
            .all(|number| number.is_finite())
        {
            return None;
        }
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
        let translation = Translation3::from(-(rotation * position.0.coords));
        Some(Self {
            sensor_from_world: Isometry3::from_parts(translation, rotation),
        })
    }

    /// A point of the world in the sensor's frame.
    pub fn camera_from_world(&self, point: WorldPoint) -> CameraPoint {
        CameraPoint(self.sensor_from_world * point.0)
    }

    /// A point of the sensor's frame in the world.
    pub fn world_from_camera(&self, point: CameraPoint) -> WorldPoint {
        WorldPoint(self.sensor_from_world.inverse_transform_point(&point.0))
    }

    /// Where the sensor's origin is in the world.
    pub fn centre(&self) -> WorldPoint {
        self.world_from_camera(CameraPoint(Point3::origin()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sensor_that_looks_at_a_point_has_it_straight_ahead() {
        let eye = WorldPoint::new(1.0, -2.0, 1.5);
        for target in [
            [0.0, 0.0, 1.0],
            [1.0, 5.0, 1.5],
            [1.0, -2.0, 0.0],
            [1.0, -2.0, 3.0],
        ] {
            let target = WorldPoint(target.into());
            let pose = Pose::looking_at(eye, target).unwrap();
            let seen = pose.camera_from_world(target).0;
            assert!(
                seen.x.abs() < 1e-12 && seen.y.abs() < 1e-12 && seen.z > 0.0,
                "{seen}"
            );
            assert!(pose.centre().distance_m(eye) < 1e-12);
        }
        let level = Pose::looking_at(eye, WorldPoint::new(0.0, 0.0, 1.5)).unwrap();
        let above = level.camera_from_world(WorldPoint::new(0.0, 0.0, 2.5)).0;
        assert!(above.y < 0.0, "up in the world is up in the picture: {above}");
        assert_eq!(Pose::looking_at(eye, eye), None);
        assert_eq!(Pose::looking_at(eye, WorldPoint::new(f64::NAN, 0.0, 0.0)), None);
        assert_eq!(Pose::looking_at(eye, WorldPoint::new(0.0, 1e308, 1.0)), None);
    }
}
