//! Where each pixel of a panorama comes from, found once: up to two cameras and how much each counts.

use hearsight_core::Rectangle;
use hearsight_core::camera::{Camera, CameraModel, InvalidParameter, Panorama, PanoramaParameters};
use hearsight_core::{DistortedPixel, Pose, WorldPoint};

/// How a panorama is made of calibrated cameras around one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StitchOptions {
    /// Columns of the full turn. Default 1500.
    pub width: usize,
    /// Rows. Default 240.
    pub height: usize,
    /// Distance at which the pictures of neighbouring cameras meet without a step, metres. Default 2.
    pub radius_m: f64,
    /// Width of the seam over which two cameras blend, as a share of the smaller side of a camera's picture, above 0 to 1.
    /// Default 0.1.
    pub seam: f64,
}

impl Default for StitchOptions {
    fn default() -> Self {
        Self {
            width: 1500,
            height: 240,
            radius_m: 2.0,
            seam: 0.1,
        }
    }
}

/// One camera's part in a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Part {
    /// Which camera.
    pub(super) camera: u16,
    /// Left and upper pixel of the four that are mixed.
    pub(super) column: u16,
    pub(super) row: u16,
    /// How far between those, in 1/256.
    pub(super) across: u8,
    pub(super) down: u8,
    /// How much it counts, in 1/256 of all parts; 0 is no part.
    pub(super) share: u16,
}

/// The map of a whole panorama, row by row.
#[derive(Clone, Debug)]
pub(super) struct Map {
    pub(super) parts: Vec<[Part; 2]>,
}

/// The panorama that cameras around one point see together: in the middle of them, level, its first column opposite to the
/// first camera's view, so that this one is in the middle of the picture.
pub(super) fn panorama(cameras: &[Camera], options: &StitchOptions) -> Result<Camera, InvalidParameter> {
    let count = cameras.len().max(1) as f64;
    let mean = |coordinate: fn(WorldPoint) -> f64| {
        cameras
            .iter()
            .map(|camera| coordinate(camera.centre()))
            .sum::<f64>()
            / count
    };
    let centre = [
        mean(|point| point.0.x),
        mean(|point| point.0.y),
        mean(|point| point.0.z),
    ];
    let ahead = cameras
        .first()
        .and_then(|camera| camera.ray(camera.model.projection().centre()))
        .map(|ray| [ray.direction.x, ray.direction.y])
        .filter(|[x, y]| x.hypot(*y) > 1e-6)
        .unwrap_or([1.0, 0.0]);
    let eye = WorldPoint::new(centre[0], centre[1], centre[2]);
    let target = WorldPoint::new(centre[0] + ahead[0], centre[1] + ahead[1], centre[2]);
    let pose = Pose::looking_at(eye, target).unwrap_or_else(Pose::identity);
    // Square pixels on the horizon, and the horizon where the cameras' own pictures are in the mean.
    let focal_px = options.width as f64 / std::f64::consts::TAU;
    let tilt = cameras
        .iter()
        .filter_map(|camera| {
            let middle = DistortedPixel::new(0.5 * camera.width as f64, 0.5 * camera.height as f64);
            let direction = camera.ray(middle)?.direction;
            Some(-direction.z / direction.x.hypot(direction.y).max(1e-6))
        })
        .sum::<f64>()
        / count;
    let lens = Panorama::new(PanoramaParameters {
        columns_per_turn: options.width as f64,
        focal_px,
        centre_px: [
            0.5 * options.width as f64 - 0.5,
            0.5 * options.height as f64 - 0.5 - focal_px * tilt,
        ],
    })?;
    Ok(Camera {
        model: CameraModel::Panorama(lens),
        pose,
        width: options.width,
        height: options.height,
    })
}

impl Map {
    pub(super) fn new(cameras: &[Camera], panorama: &Camera, options: &StitchOptions) -> Self {
        let mut parts = Vec::with_capacity(panorama.width * panorama.height);
        for row in 0..panorama.height {
            for column in 0..panorama.width {
                let point = panorama
                    .ray(DistortedPixel::new(column as f64, row as f64))
                    .map(|ray| ray.at(options.radius_m));
                parts.push(point.map_or([Part::default(); 2], |point| best(cameras, point, options.seam)));
            }
        }
        Self { parts }
    }

    /// Share of the panorama that at least one camera sees, 0 to 1.
    pub(super) fn covered(&self) -> f64 {
        let seen = self.parts.iter().filter(|[first, _]| first.share > 0).count();
        seen as f64 / self.parts.len().max(1) as f64
    }
}

/// The two cameras that see a point furthest from their pictures' edges.
fn best(cameras: &[Camera], point: WorldPoint, seam: f64) -> [Part; 2] {
    let mut found = [(0.0, Part::default()); 2];
    for (number, camera) in cameras.iter().enumerate() {
        let Some(pixel) = camera.project(point) else {
            continue;
        };
        let inner = Rectangle::new(0.0, 0.0, camera.width as f32 - 1.0, camera.height as f32 - 1.0);
        let (u, v) = (pixel.u as f32, pixel.v as f32);
        if !(u >= 0.0 && v >= 0.0 && u < inner.width && v < inner.height) {
            continue;
        }
        let edge = f64::from(u.min(inner.width - u).min(v.min(inner.height - v)));
        let width = seam * camera.width.min(camera.height) as f64;
        // Never quite nothing, so that a pixel on the very edge still has a colour where it is the only one.
        let weight = (edge / width.max(1.0)).clamp(1e-3, 1.0);
        let part = Part {
            camera: number as u16,
            column: u as u16,
            row: v as u16,
            across: (u.fract() * 255.0) as u8,
            down: (v.fract() * 255.0) as u8,
            share: 0,
        };
        if weight > found[0].0 {
            found = [(weight, part), found[0]];
        } else if weight > found[1].0 {
            found[1] = (weight, part);
        }
    }
    let total = found[0].0 + found[1].0;
    if total <= 0.0 {
        return [Part::default(); 2];
    }
    let second = (256.0 * found[1].0 / total).round() as u16;
    let [mut first, mut other] = found.map(|(_, part)| part);
    (first.share, other.share) = (256 - second, second);
    [first, other]
}
