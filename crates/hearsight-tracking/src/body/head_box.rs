//! The body of image-plane systems: the box of a head in one camera.
//!
//! State (x, y, w, h) in pixels: centre and size (stac, section 2). A person's head has a known real height, so that
//! a calibrated camera tells the range of the mouth from the height of the box (method sheet, notes for several
//! people): the delay of a sound is then computed in near field.

use super::{Body, Part};
use hearsight_core::camera::Camera;
use hearsight_core::{DistortedPixel, Rectangle, WorldPoint};
use hearsight_filter::Particles;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Proportions of a person.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct HeadBoxSettings {
    /// Real height of a head from crown to chin, metres. Default 0.24. Raising it puts people further away.
    pub head_height_m: f64,
    /// Height of the mouth below the crown as a share of the head's height, 0 to 1. Default 0.75.
    pub mouth_share: f64,
    /// Width of the torso over the width of the head. Default 1.6.
    pub torso_width: f32,
    /// Height of the torso region over the height of the head. Default 1.6.
    pub torso_height: f32,
    /// Gap from chin to torso region over the height of the head. Default 0.35.
    pub neck: f32,
}

impl Default for HeadBoxSettings {
    fn default() -> Self {
        Self {
            head_height_m: 0.24,
            mouth_share: 0.75,
            torso_width: 1.6,
            torso_height: 1.6,
            neck: 0.35,
        }
    }
}

/// Height of a head over its width, as in anthropometric tables (0.23 m to 0.18 m and less).
const HEIGHT_OVER_WIDTH: f32 = 1.3;

/// The box of a head in one camera.
#[derive(Clone, Debug)]
pub struct HeadBox {
    settings: HeadBoxSettings,
    camera: Option<Camera>,
}

impl HeadBox {
    /// Length of the state.
    pub const DIMENSIONS: usize = 4;

    /// A body seen by `camera`; without calibration it has no sound points.
    pub fn new(settings: HeadBoxSettings, camera: Option<Camera>) -> Self {
        Self { settings, camera }
    }

    /// A head at a place of the picture and at a range, as the camera would see it; `None` without calibration, or where
    /// the camera does not look. The height is searched for, whatever the lens.
    pub fn at_range(&self, x: f32, y: f32, range_m: f64) -> Option<Rectangle> {
        let camera = self.camera.as_ref()?;
        let (mut low, mut high) = (1.0_f32, camera.height as f32);
        for _ in 0..30 {
            let height = 0.5 * (low + high);
            let seen_m = self
                .mouth(x, y, height)
                .map(|mouth| mouth.distance_m(camera.pose.centre()));
            match seen_m {
                Some(seen_m) if seen_m > range_m => low = height,
                _ => high = height,
            }
        }
        let height = 0.5 * (low + high);
        let known = self.mouth(x, y, height).is_some();
        known.then(|| Rectangle::from_centre(x, y, height / HEIGHT_OVER_WIDTH, height))
    }

    /// Whether it can tell where sound comes from.
    pub(super) fn is_calibrated(&self) -> bool {
        self.camera.is_some()
    }

    fn part(&self, x: f32, y: f32, width: f32, height: f32, part: Part) -> Rectangle {
        match part {
            Part::Head => Rectangle::from_centre(x, y, width, height),
            Part::Torso => {
                let s = &self.settings;
                let torso_height = s.torso_height * height;
                let torso_y = y + (0.5 + s.neck) * height + 0.5 * torso_height;
                Rectangle::from_centre(x, torso_y, s.torso_width * width, torso_height)
            }
        }
    }

    fn mouth(&self, x: f32, y: f32, height: f32) -> Option<WorldPoint> {
        let camera = self.camera.as_ref()?;
        let below_centre = (self.settings.mouth_share - 0.5) * f64::from(height);
        let mouth = DistortedPixel::new(f64::from(x), f64::from(y) + below_centre);
        let half = 0.5 * f64::from(height);
        let crown = camera.ray(DistortedPixel::new(mouth.u, f64::from(y) - half))?;
        let chin = camera.ray(DistortedPixel::new(mouth.u, f64::from(y) + half))?;
        // The angle that the head fills gives its range, whatever the lens.
        let angle = crown.direction.angle(&chin.direction);
        if !(angle > 1e-4 && angle < 1.5) {
            return None;
        }
        let range_m = 0.5 * self.settings.head_height_m / (0.5 * angle).tan();
        Some(camera.ray(mouth)?.at(range_m))
    }
}

impl Body for HeadBox {
    fn dimensions(&self) -> usize {
        Self::DIMENSIONS
    }

    fn region(&self, state: &[f32], part: Part) -> Rectangle {
        self.part(state[0], state[1], state[2], state[3], part)
    }

    fn regions(&self, particles: &Particles, part: Part, regions: &mut Vec<Rectangle>) {
        regions.clear();
        let [x, y, w, h] = [0, 1, 2, 3].map(|d| particles.column(d));
        regions.extend((0..particles.count()).map(|i| self.part(x[i], y[i], w[i], h[i], part)));
    }

    fn sound_points(&self, particles: &Particles, points: &mut Vec<Option<WorldPoint>>) -> bool {
        points.clear();
        if self.camera.is_none() {
            return false;
        }
        let [x, y, h] = [0, 1, 3].map(|d| particles.column(d));
        points.extend((0..particles.count()).map(|i| self.mouth(x[i], y[i], h[i])));
        true
    }

    fn sound_point(&self, state: &[f32]) -> Option<WorldPoint> {
        self.mouth(state[0], state[1], state[3])
    }

    fn state_from_head(&self, head: &Rectangle, state: &mut [f32]) {
        let (x, y) = head.centre();
        state.copy_from_slice(&[x, y, head.width, head.height]);
    }
}
