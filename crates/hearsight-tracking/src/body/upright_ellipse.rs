//! A head as an upright ellipse with velocities: the state of the closed-loop system (Chen and Rui, section IV).
//!
//! State (x, y, alpha, and their velocities): centre and half height in pixels, and pixels a second; the head is 1.2
//! times as high as wide. What a picture cannot tell (range, mouth, clothing) comes from [`HeadBox`].

use super::{Body, HeadBox, HeadBoxSettings, Part};
use hearsight_core::camera::Camera;
use hearsight_core::{Rectangle, WorldPoint};
use hearsight_filter::Particles;

/// Height of a head over its width.
pub const ASPECT: f32 = 1.2;

/// A head as an upright ellipse.
#[derive(Clone, Debug)]
pub struct UprightEllipse {
    head: HeadBox,
}

impl UprightEllipse {
    /// Length of the state: three places and their velocities.
    pub const DIMENSIONS: usize = 6;

    /// A body seen by `camera`; without calibration it has no sound points.
    pub fn new(settings: HeadBoxSettings, camera: Option<Camera>) -> Self {
        Self {
            head: HeadBox::new(settings, camera),
        }
    }

    /// The box around the ellipse.
    pub fn bounds(x: f32, y: f32, half_height: f32) -> Rectangle {
        Rectangle::from_centre(x, y, 2.0 * half_height / ASPECT, 2.0 * half_height)
    }

    fn boxed(state: &[f32]) -> [f32; 4] {
        [state[0], state[1], 2.0 * state[2] / ASPECT, 2.0 * state[2]]
    }
}

impl Body for UprightEllipse {
    fn dimensions(&self) -> usize {
        Self::DIMENSIONS
    }

    fn region(&self, state: &[f32], part: Part) -> Rectangle {
        self.head.region(&Self::boxed(state), part)
    }

    fn regions(&self, particles: &Particles, part: Part, regions: &mut Vec<Rectangle>) {
        regions.clear();
        let [x, y, half] = [0, 1, 2].map(|dimension| particles.column(dimension));
        regions.extend((0..particles.count()).map(|i| self.region(&[x[i], y[i], half[i]], part)));
    }

    fn sound_points(&self, particles: &Particles, points: &mut Vec<Option<WorldPoint>>) -> bool {
        points.clear();
        if !self.head.is_calibrated() {
            return false;
        }
        let [x, y, half] = [0, 1, 2].map(|dimension| particles.column(dimension));
        points.extend((0..particles.count()).map(|i| self.sound_point(&[x[i], y[i], half[i]])));
        true
    }

    fn sound_point(&self, state: &[f32]) -> Option<WorldPoint> {
        self.head.sound_point(&Self::boxed(state))
    }

    /// The ellipse of the same area; velocities are zero. Fills as much of a state as `state` has room for.
    fn state_from_head(&self, head: &Rectangle, state: &mut [f32]) {
        let (x, y) = head.centre();
        let half = 0.5 * (head.area() * ASPECT).sqrt();
        for (value, from) in state.iter_mut().zip([x, y, half, 0.0, 0.0, 0.0]) {
            *value = from;
        }
    }

    fn first_deviations(&self, head: &Rectangle, deviations: &mut [f64]) {
        let share = |share: f64| share * f64::from(head.width);
        let of = [
            share(0.1),
            share(0.1),
            share(0.06),
            share(0.3),
            share(0.3),
            share(0.05),
        ];
        for (deviation, from) in deviations.iter_mut().zip(of) {
            *deviation = from;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_and_states_return() {
        let body = UprightEllipse::new(HeadBoxSettings::default(), None);
        let mut state = [0.0; 6];
        let head = UprightEllipse::bounds(50.0, 40.0, 24.0);
        body.state_from_head(&head, &mut state);
        assert_eq!(state, [50.0, 40.0, 24.0, 0.0, 0.0, 0.0]);
        let back = body.region(&state, Part::Head);
        assert!((back.width - 40.0).abs() < 1e-4 && (back.height - 48.0).abs() < 1e-4);
        let torso = body.region(&state, Part::Torso);
        assert!(torso.top > back.bottom() && torso.width > back.width);
        assert_eq!(body.sound_point(&state), None);
    }
}
