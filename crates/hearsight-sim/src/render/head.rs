//! The shape of a head: horizontal slices of an egg with brow, eye sockets, nose, lips and chin, and hair on it.
//!
//! Heights are over the upper half axis (1 the crown, -1 the chin), breadths over the left half axis, depths over the
//! forward one, so that the whole head without hair fits the ellipsoid that its person was given.

use super::face::Features;
use super::mesh::{Cloth, Mesh, Surface};
use crate::world::{Hair, Looks};
use nalgebra::{Matrix3, Vector3};
use std::f32::consts::PI;

/// Rows from crown to chin and columns around.
const ROWS: usize = 60;
const COLUMNS: usize = 72;

/// Depth of the face below the eyes, by height.
const FACE: [(f32, f32); 10] = [
    (-1.0, 0.50),
    (-0.97, 0.72),
    (-0.90, 0.87),
    (-0.78, 0.93),
    (-0.64, 0.895),
    (-0.52, 0.94),
    (-0.40, 0.93),
    (-0.25, 0.93),
    (-0.10, 0.93),
    (0.0, 0.935),
];
/// Depth of the face above the eyes, as a factor of the egg.
const FOREHEAD: [(f32, f32); 5] = [
    (0.0, 0.935),
    (0.14, 0.985),
    (0.35, 0.985),
    (0.6, 0.99),
    (1.0, 1.0),
];
/// Depth of the back of the head below the eyes.
const NAPE: [(f32, f32); 5] = [
    (-1.0, 0.50),
    (-0.75, 0.60),
    (-0.5, 0.74),
    (-0.2, 0.93),
    (0.0, 1.0),
];
/// Half the breadth below the eyes.
const JAW: [(f32, f32); 8] = [
    (-1.0, 0.18),
    (-0.97, 0.28),
    (-0.9, 0.42),
    (-0.78, 0.585),
    (-0.6, 0.745),
    (-0.4, 0.865),
    (-0.2, 0.95),
    (0.0, 0.985),
];

/// Where on the head a texture's coordinates are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Around the head, radians, 0 in front, positive to the left.
    pub(super) turn: f32,
    /// Height, -1 to 1.
    pub(super) height: f32,
}

impl Place {
    /// From texture coordinates, each 0 to 1: across from the back over the right to the left, down from the crown. The
    /// face takes the middle half.
    pub(super) fn at(across: f32, down: f32) -> Self {
        let t = 2.0 * across - 1.0;
        let polar = down.clamp(0.012, 0.988) * PI;
        Self {
            turn: PI * (0.45 * t + 0.55 * t * t * t),
            height: polar.cos(),
        }
    }

    /// Forward, left and up over the half axes, without the details of the face.
    pub(super) fn on_egg(self, features: &Features) -> [f32; 3] {
        let Self { turn, height } = self;
        let egg = |power: f32| (1.0 - height.abs().powf(power)).max(0.0).powf(1.0 / power);
        let (breadth, front, back) = if height >= 0.0 {
            (0.985 * egg(2.3), egg(2.5) * table(&FOREHEAD, height), egg(2.2))
        } else {
            let narrow = 1.0 + features.jaw * (0.5 - (height + 0.6).abs()).max(0.0);
            (
                table(&JAW, height) * narrow,
                table(&FACE, height),
                table(&NAPE, height),
            )
        };
        let cosine = turn.cos();
        // A face is flatter in front than an ellipse.
        let forward = if cosine > 0.0 {
            front * cosine.powf(0.82)
        } else {
            back * cosine
        };
        [forward, breadth * turn.sin(), height]
    }
}

/// Hair's share of a place, 0 to 1.
pub(super) fn hair(looks: &Looks, features: &Features, place: Place) -> f32 {
    const SHORT: [(f32, f32); 10] = [
        (0.0, 0.62),
        (35.0, 0.60),
        (52.0, 0.42),
        (66.0, 0.22),
        (76.0, 0.02),
        (84.0, -0.14),
        (92.0, 0.06),
        (108.0, -0.05),
        (130.0, -0.5),
        (180.0, -0.62),
    ];
    const LONG: [(f32, f32); 6] = [
        (0.0, 0.62),
        (35.0, 0.56),
        (52.0, 0.36),
        (64.0, 0.0),
        (76.0, -0.75),
        (90.0, -1.2),
    ];
    let degrees = place.turn.abs().to_degrees();
    let border = match looks.hair_style {
        Hair::Bald => return 0.0,
        Hair::Short => table(&SHORT, degrees),
        Hair::Long => table(&LONG, degrees),
    };
    let front = (1.0 - degrees / 70.0).max(0.0);
    smooth_step((place.height - border - features.hairline * front) / 0.05)
}

/// The head's corners in its own frame, and how far each follows the jaw.
pub(super) fn build(looks: &Looks, features: &Features, mesh: &mut Mesh, jaw: &mut Vec<f32>) {
    let half = looks.head_half_axes_m.map(|half| half as f32);
    let cloth = Cloth {
        surface: Surface::Head,
        head: true,
        thin: false,
    };
    let texture =
        |row: usize, column: usize| [column as f32 / COLUMNS as f32, row as f32 / (ROWS - 1) as f32];
    mesh.grid(
        ROWS,
        COLUMNS + 1,
        true,
        |_| cloth,
        |row, column| {
            let at = texture(row, column);
            (place_of(looks, features, half, Place::at(at[0], at[1])), at)
        },
    );
    jaw.clear();
    jaw.extend(mesh.corners.iter().map(|corner| {
        let place = Place::at(corner.at[0], corner.at[1]);
        let low = smooth_step((-0.54 - place.height) / 0.12);
        low * smooth_step((100.0 - place.turn.abs().to_degrees()) / 40.0)
    }));
    if looks.hair_style == Hair::Long {
        return;
    }
    for side in [1.0, -1.0] {
        let centre = Vector3::new(-0.06 * half[0], side * 0.985 * half[1], -0.06 * half[2]);
        let axes = [
            Vector3::new(-0.09 * half[0], side * 0.06 * half[1], 0.25 * half[2]),
            Vector3::new(0.15 * half[0], side * -0.07 * half[1], 0.04 * half[2]),
            Vector3::new(0.03 * half[0], side * 0.07 * half[1], 0.0),
        ];
        mesh.ellipsoid(
            centre,
            axes,
            10,
            Cloth {
                surface: Surface::Skin,
                head: true,
                thin: false,
            },
        );
        jaw.resize(mesh.corners.len(), 0.0);
    }
}

fn place_of(looks: &Looks, features: &Features, half: [f32; 3], place: Place) -> Vector3<f32> {
    let [x, y, z] = place.on_egg(features);
    let mut point = Vector3::new(x * half[0], y * half[1], z * half[2]);
    if x > 0.0 {
        point.x += features.relief_m(y * half[1], z * half[2], half);
    }
    let cover = hair(looks, features, place);
    if cover > 0.0 {
        let outward = Vector3::new(x / half[0], y / half[1], z / half[2]);
        point += outward.try_normalize(1e-6).unwrap_or_else(Vector3::z) * (cover * features.hair_m);
    }
    point
}

/// How far the chin sinks and goes back when the mouth opens as far as it does, metres.
pub(super) fn jaw_drop(half: [f32; 3]) -> Vector3<f32> {
    Vector3::new(-0.05 * half[0], 0.0, -0.09 * half[2])
}

/// A rotation of doubles as floats.
pub(super) fn to_floats(turn: &Matrix3<f64>) -> Matrix3<f32> {
    turn.map(|part| part as f32)
}

/// Between the points of a table with ascending places, smoothly.
pub(super) fn table(points: &[(f32, f32)], place: f32) -> f32 {
    let last = points.len() - 1;
    let Some(next) = points.iter().position(|(at, _)| place < *at) else {
        return points[last].1;
    };
    if next == 0 {
        return points[0].1;
    }
    let value = |index: usize| points[index].1;
    let slope = |index: usize| {
        let (low, high) = (index.saturating_sub(1), (index + 1).min(last));
        (points[high].1 - points[low].1) / (points[high].0 - points[low].0)
    };
    let (from, to) = (next - 1, next);
    let width = points[to].0 - points[from].0;
    let t = (place - points[from].0) / width;
    // Cubic Hermite.
    let (t2, t3) = (t * t, t * t * t);
    (2.0 * t3 - 3.0 * t2 + 1.0) * value(from)
        + (t3 - 2.0 * t2 + t) * width * slope(from)
        + (3.0 * t2 - 2.0 * t3) * value(to)
        + (t3 - t2) * width * slope(to)
}

/// 0 below 0, 1 above 1, smooth between.
#[inline(always)]
pub(super) fn smooth_step(value: f32) -> f32 {
    let value = value.clamp(0.0, 1.0);
    value * value * (3.0 - 2.0 * value)
}
