//! Lenses, and heads that pan, tilt and zoom.

use super::raw::{LensKind, RawCamera, RawHead};
use super::resolve::Resolver;
use crate::world::{AxisLimits, PanTiltZoom};
use hearsight_core::CameraModel;
use hearsight_core::camera::{
    Fisheye, FisheyeParameters, InvalidParameter, Panorama, PanoramaParameters, Pinhole, PinholeParameters,
};
use hearsight_core::configuration::{ConfigurationError, Field};
use std::f64::consts::TAU;

impl Resolver {
    pub(super) fn lens(
        &self,
        field: &Field,
        raw: &RawCamera,
        [width, height]: [usize; 2],
    ) -> Result<CameraModel, ConfigurationError> {
        let kind = raw.lens.unwrap_or(LensKind::Pinhole);
        let (usual, widest) = match kind {
            LensKind::Pinhole => (60.0, 150.0),
            LensKind::Fisheye => (180.0, 220.0),
            LensKind::Panorama => (360.0, 360.0),
        };
        if raw.view.is_some() && raw.focal.is_some() {
            return Err(self.wrong(field, "has `view` and `focal` at once", "keep one of them"));
        }
        let view = self.number(
            &field.key("view"),
            raw.view,
            usual,
            [0.5, widest],
            "give degrees from edge to edge",
        )?;
        let view = view.to_radians();
        let half = 0.5 * width as f64;
        let focal = match raw.focal {
            Some(_) => self.number(&field.key("focal"), raw.focal, 1.0, [1.0, 1e6], "give pixels")?,
            None => match kind {
                LensKind::Pinhole => half / (0.5 * view).tan(),
                LensKind::Fisheye => half / (0.5 * view),
                LensKind::Panorama => width as f64 / view,
            },
        };
        let centre_px = [0.5 * width as f64 - 0.5, 0.5 * height as f64 - 0.5];
        let most = match kind {
            LensKind::Pinhole => 5,
            LensKind::Fisheye => 4,
            LensKind::Panorama => 0,
        };
        if raw.distortion.len() > most {
            let what = format!("has {} coefficients", raw.distortion.len());
            return Err(self.wrong(&field.key("distortion"), what, format!("this lens has {most}")));
        }
        let k = |place: usize| raw.distortion.get(place).copied().unwrap_or(0.0);
        let lens = match kind {
            LensKind::Pinhole => Pinhole::new(PinholeParameters {
                focal_px: [focal; 2],
                centre_px,
                radial: [k(0), k(1), k(4)],
                tangential: [k(2), k(3)],
            })
            .map(CameraModel::Pinhole),
            LensKind::Fisheye => Fisheye::new(FisheyeParameters {
                focal_px: [focal; 2],
                centre_px,
                radial: [k(0), k(1), k(2), k(3)],
            })
            .map(CameraModel::Fisheye),
            LensKind::Panorama => Panorama::new(PanoramaParameters {
                columns_per_turn: TAU * focal,
                focal_px: focal,
                centre_px,
            })
            .map(CameraModel::Panorama),
        };
        lens.map_err(|error: InvalidParameter| self.wrong(field, error, "see `hearsight schema scenario`"))
    }

    pub(super) fn head(&self, field: &Field, raw: &RawHead) -> Result<PanTiltZoom, ConfigurationError> {
        let number = |key: &str, value, usual, range| {
            self.number(
                &field.key(key),
                value,
                usual,
                range,
                "see `hearsight schema scenario`",
            )
        };
        let acceleration = number("acceleration", raw.acceleration, 600.0, [1.0, 1e5])?.to_radians();
        let axis = |speed: f64, [low, high]: [f64; 2]| AxisLimits {
            low: low.to_radians(),
            high: high.to_radians(),
            speed: speed.to_radians(),
            acceleration,
        };
        let pan_range = raw.pan_range.unwrap_or([-170.0, 170.0]);
        let tilt_range = raw.tilt_range.unwrap_or([-30.0, 90.0]);
        for (key, [low, high]) in [("pan_range", pan_range), ("tilt_range", tilt_range)] {
            if !(low <= 0.0 && high >= 0.0 && low >= -360.0 && high <= 360.0) {
                let what = format!("{low} to {high} degrees does not hold 0, where it is mounted");
                return Err(self.wrong(&field.key(key), what, "give [least, most] in degrees"));
            }
        }
        let zoom_speed = number("zoom_speed", raw.zoom_speed, 4.0, [0.01, 1000.0])?;
        Ok(PanTiltZoom {
            pan: axis(
                number("pan_speed", raw.pan_speed, 80.0, [0.1, 3600.0])?,
                pan_range,
            ),
            tilt: axis(
                number("tilt_speed", raw.tilt_speed, 50.0, [0.1, 3600.0])?,
                tilt_range,
            ),
            zoom: AxisLimits {
                low: 1.0,
                high: number("zoom", raw.zoom, 12.0, [1.0, 100.0])?,
                speed: zoom_speed,
                acceleration: 20.0 * zoom_speed,
            },
            latency_s: number("latency", raw.latency, 0.06, [0.0, 10.0])?,
        })
    }
}
