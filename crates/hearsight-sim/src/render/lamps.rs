//! How much light falls on a surface.

use crate::world::{Colour, Setting};
use nalgebra::Vector3;

/// Lamps are no nearer than this, metres: light does not grow without bound beside them.
const NEAREST_M: f32 = 0.3;
/// Of the light from everywhere, so much comes from below when as much as 1 comes from above.
const FROM_BELOW: f32 = 0.45;

/// The light of a room at an instant.
#[derive(Clone, Debug, Default)]
pub(super) struct Lamps {
    ambient: Colour,
    points: Vec<(Vector3<f32>, Colour)>,
}

impl Lamps {
    /// Takes the lamps of a setting, each as bright as `gains` says; lamps that are not finite give no light.
    pub(super) fn set(&mut self, setting: &Setting, gains: &[f64]) {
        self.ambient = setting.ambient.map(bright);
        self.points.clear();
        for (number, light) in setting.lights.iter().enumerate() {
            let gain = gains.get(number).map_or(1.0, |gain| bright(*gain as f32));
            let position = light.position.0.coords.map(|coordinate| coordinate as f32);
            if position.iter().all(|coordinate| coordinate.is_finite()) {
                self.points
                    .push((position, light.colour.map(|channel| gain * bright(channel))));
            }
        }
    }

    /// What a white surface reflects that faces along `normal` (unit length).
    #[inline]
    pub(super) fn on(&self, place: Vector3<f32>, normal: Vector3<f32>) -> Colour {
        self.on_shaded(place, normal, |_| 1.0)
    }

    /// The same where `open` says which share of a lamp at a place is seen from here.
    #[inline]
    pub(super) fn on_shaded(
        &self,
        place: Vector3<f32>,
        normal: Vector3<f32>,
        open: impl Fn(Vector3<f32>) -> f32,
    ) -> Colour {
        let sky = 0.5 * (1.0 + FROM_BELOW) + 0.5 * (1.0 - FROM_BELOW) * normal.z;
        let mut sum = self.ambient.map(|channel| channel * sky);
        for (position, colour) in &self.points {
            let towards = position - place;
            let facing = towards.dot(&normal);
            if facing > 0.0 {
                let square = towards.norm_squared().max(NEAREST_M * NEAREST_M);
                let share = open(*position) * facing / (square * square.sqrt());
                for (sum, channel) in sum.iter_mut().zip(colour) {
                    *sum += share * channel;
                }
            }
        }
        sum
    }

    /// Where the lamps are, and how bright in all.
    pub(super) fn points(&self) -> impl Iterator<Item = (Vector3<f32>, f32)> + '_ {
        self.points
            .iter()
            .map(|(position, colour)| (*position, colour.iter().sum()))
    }
}

fn bright(value: f32) -> f32 {
    if value.is_finite() {
        value.clamp(0.0, 1e6)
    } else {
        0.0
    }
}
