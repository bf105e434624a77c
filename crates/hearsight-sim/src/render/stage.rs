//! The room and its furniture: what a ray hits first.

use super::lamps::Lamps;
use super::pattern::paint;
use crate::world::{Colour, Material, Setting};
use nalgebra::Vector3;

/// A surface is no nearer than this, metres: a camera on a wall looks into the room.
const NEAREST_M: f32 = 0.02;
/// How far corners darken, metres.
const CORNER_M: f32 = 0.25;

/// A box standing upright, with its axes.
#[derive(Clone, Debug)]
struct Solid {
    centre: Vector3<f32>,
    half: Vector3<f32>,
    /// Cosine and sine of its turn.
    turn: (f32, f32),
    /// Radius of a ball around the centre that holds all of it, metres.
    radius: f32,
    material: Material,
}

/// What a ray hits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit<'a> {
    /// Metres along the ray, whose direction has unit length.
    pub(super) distance: f32,
    pub(super) place: Vector3<f32>,
    pub(super) normal: Vector3<f32>,
    material: &'a Material,
    /// Metres across and up on the surface.
    across: f32,
    up: f32,
    /// 1, less near corners of the room.
    open: f32,
}

/// What does not move.
#[derive(Clone, Debug)]
pub(super) struct Stage {
    low: Vector3<f32>,
    high: Vector3<f32>,
    surfaces: [Material; 6],
    solids: Vec<Solid>,
}

impl Stage {
    pub(super) fn new(setting: &Setting) -> Self {
        let low = setting.origin.0.coords.map(|coordinate| finite(coordinate, 0.0));
        let size = Vector3::from(setting.size_m).map(|side| finite(side, 1.0).max(0.1));
        let solids = setting.blocks.iter().filter_map(|block| {
            let centre = block.centre.0.coords.map(|coordinate| coordinate as f32);
            let half = Vector3::from(block.size_m).map(|side| side as f32 / 2.0);
            let sound = centre.iter().chain(half.iter()).all(|number| number.is_finite());
            (sound && block.yaw_rad.is_finite() && half.min() > 0.0).then(|| Solid {
                centre,
                half,
                turn: (block.yaw_rad.cos() as f32, block.yaw_rad.sin() as f32),
                // More than the half diagonal by what rounding may lose.
                radius: 1.001 * half.norm() + 0.005,
                material: block.material,
            })
        });
        Self {
            low,
            high: low + size,
            surfaces: setting.surfaces,
            solids: solids.collect(),
        }
    }

    /// What a ray hits first; nothing where a ray from outside misses the room.
    pub(super) fn hit(&self, origin: Vector3<f32>, direction: Vector3<f32>) -> Option<Hit<'_>> {
        let room = self.hit_room(origin, direction);
        let mut nearest = room.map_or(f32::INFINITY, |hit| hit.distance);
        let mut found = room;
        for solid in &self.solids {
            if let Some(hit) = solid.hit(origin, direction, nearest) {
                nearest = hit.distance;
                found = Some(hit);
            }
        }
        found
    }

    /// Whether furniture stands between two places.
    pub(super) fn blocked(&self, from: Vector3<f32>, to: Vector3<f32>) -> bool {
        let offset = to - from;
        let length = offset.norm();
        let direction = offset / length.max(1e-6);
        self.solids
            .iter()
            .any(|solid| solid.hit(from, direction, length).is_some())
    }

    /// The room from inside: where the ray leaves it.
    fn hit_room(&self, origin: Vector3<f32>, direction: Vector3<f32>) -> Option<Hit<'_>> {
        let (mut enter, mut leave, mut axis) = (NEAREST_M, f32::INFINITY, 0);
        for side in 0..3 {
            let inverse = 1.0 / direction[side];
            let (one, other) = (
                (self.low[side] - origin[side]) * inverse,
                (self.high[side] - origin[side]) * inverse,
            );
            // A ray along a wall gives no number, which neither comparison takes.
            if one.min(other) > enter {
                enter = one.min(other);
            }
            if one.max(other) < leave {
                (leave, axis) = (one.max(other), side);
            }
        }
        if leave.is_infinite() || leave <= enter {
            return None;
        }
        let place = origin + direction * leave;
        let outward = direction[axis] > 0.0;
        let mut normal = Vector3::zeros();
        normal[axis] = if outward { -1.0 } else { 1.0 };
        let inside = place - self.low;
        let (surface, across, up) = match (axis, outward) {
            (0, false) => (2, inside.y, inside.z),
            (0, true) => (3, inside.y, inside.z),
            (1, false) => (4, inside.x, inside.z),
            (1, true) => (5, inside.x, inside.z),
            (_, false) => (0, inside.x, inside.y),
            (_, true) => (1, inside.x, inside.y),
        };
        let mut open = 1.0;
        for side in (0..3).filter(|side| *side != axis) {
            let gap = (place[side] - self.low[side]).min(self.high[side] - place[side]);
            open *= 1.0 - 0.35 * (-gap.max(0.0) / CORNER_M).exp();
        }
        let material = &self.surfaces[surface];
        Some(Hit {
            distance: leave,
            place,
            normal,
            material,
            across,
            up,
            open,
        })
    }
}

impl Solid {
    /// Where a ray of unit direction enters, before a distance.
    fn hit(&self, origin: Vector3<f32>, direction: Vector3<f32>, before: f32) -> Option<Hit<'_>> {
        let offset = self.centre - origin;
        let along = offset.dot(&direction);
        // Most rays pass far from most furniture.
        if along < -self.radius
            || along - self.radius > before
            || offset.norm_squared() - along * along > self.radius * self.radius
        {
            return None;
        }
        let (cosine, sine) = self.turn;
        let inwards =
            |v: Vector3<f32>| Vector3::new(cosine * v.x + sine * v.y, cosine * v.y - sine * v.x, v.z);
        let (start, ray) = (inwards(origin - self.centre), inwards(direction));
        let (mut enter, mut leave, mut axis) = (NEAREST_M, before, usize::MAX);
        for side in 0..3 {
            let inverse = 1.0 / ray[side];
            let (one, other) = (
                (-self.half[side] - start[side]) * inverse,
                (self.half[side] - start[side]) * inverse,
            );
            if one.is_nan() || other.is_nan() {
                continue;
            }
            if one.min(other) > enter {
                (enter, axis) = (one.min(other), side);
            }
            leave = leave.min(one.max(other));
        }
        // A camera within furniture sees through it.
        if axis > 2 || leave <= enter {
            return None;
        }
        let inside = start + ray * enter;
        let mut normal = Vector3::zeros();
        normal[axis] = -ray[axis].signum();
        let normal = Vector3::new(
            cosine * normal.x - sine * normal.y,
            sine * normal.x + cosine * normal.y,
            normal.z,
        );
        let (across, up) = match axis {
            0 => (inside.y, inside.z),
            1 => (inside.x, inside.z),
            _ => (inside.x, inside.y),
        };
        Some(Hit {
            distance: enter,
            place: origin + direction * enter,
            normal,
            material: &self.material,
            across,
            up,
            open: 1.0,
        })
    }
}

impl Hit<'_> {
    /// The light that goes back along the ray, where a pixel covers `pixel_rad` radians.
    pub(super) fn radiance(&self, stage: &Stage, lamps: &Lamps, pixel_rad: f32) -> Colour {
        let paint = paint(self.material, self.across, self.up, pixel_rad * self.distance);
        let start = self.place + self.normal * 0.01;
        let light = lamps.on_shaded(self.place, self.normal, |lamp| {
            if stage.blocked(start, lamp) { 0.0 } else { 1.0 }
        });
        [0, 1, 2].map(|channel| paint[channel] * light[channel] * self.open)
    }
}

fn finite(value: f64, otherwise: f32) -> f32 {
    let value = value as f32;
    if value.is_finite() { value } else { otherwise }
}
