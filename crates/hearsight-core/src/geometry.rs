//! Frames of reference: world, camera, and the two kinds of pixel.
//!
//! World: metres, right-handed, z up. Camera: x right, y down, z forward, metres. Pixel (0, 0) is the centre of the
//! top-left pixel. Each is a type of its own, so that a distorted pixel is never taken for an ideal one.

use nalgebra::{Isometry3, Point3, Unit, Vector3};
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
        Self { sensor_from_world: Isometry3::identity() }
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
