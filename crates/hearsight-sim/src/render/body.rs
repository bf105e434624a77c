//! The body below the head: a mesh from a posture, and what its parts are made of.

use super::mesh::{Cloth, Mesh, Surface, across};
use crate::world::{Hair, Limb, Looks, Posture};
use hearsight_core::WorldPoint;
use nalgebra::Vector3;

/// Corners around the torso and around a limb.
const SIDES: usize = 20;
const LIMB_SIDES: usize = 12;

/// Rings of the torso from the neck down: place between pelvis (0) and neck (1), half width and half depth over half
/// the breadth of the shoulders. Proportions of an adult; width at the arm's root leaves room for the arm itself.
const TORSO: [(f32, f32, f32); 14] = [
    (1.10, 0.27, 0.27),
    (1.07, 0.33, 0.32),
    (1.03, 0.47, 0.37),
    (0.99, 0.68, 0.42),
    (0.945, 0.89, 0.45),
    (0.88, 1.02, 0.49),
    (0.78, 1.00, 0.55),
    (0.62, 0.92, 0.60),
    (0.42, 0.82, 0.56),
    (0.24, 0.79, 0.55),
    (0.08, 0.86, 0.60),
    (-0.06, 0.89, 0.64),
    (-0.16, 0.84, 0.60),
    (-0.22, 0.60, 0.42),
];
/// From this ring of the torso on it is trousers or skirt.
const BELT: usize = 10;

/// Adds everything but the head to a mesh.
pub(super) fn build(looks: &Looks, posture: &Posture, mesh: &mut Mesh) {
    let vector = |point: WorldPoint| point.0.coords.map(|coordinate| coordinate as f32);
    let build = if looks.build.is_finite() {
        looks.build.clamp(0.4, 2.5) as f32
    } else {
        1.0
    };
    // What grows with the height of the person.
    let size = if looks.height_m.is_finite() {
        (looks.height_m / 1.75).clamp(0.3, 1.6) as f32
    } else {
        1.0
    };
    let (neck, pelvis, head) = (vector(posture.neck), vector(posture.pelvis), vector(posture.head));
    let yaw = posture.torso_yaw_rad as f32;
    let facing = Vector3::new(yaw.cos(), yaw.sin(), 0.0);
    let up = (neck - pelvis).try_normalize(1e-6).unwrap_or_else(Vector3::z);
    let forward = across(up, facing);
    let left = up.cross(&forward);

    let shoulders = (vector(posture.arms[0].root) - vector(posture.arms[1].root)).norm() / 2.0;
    let breadth = shoulders.clamp(0.08 * size, 0.4 * size);
    let rings = TORSO.map(|(share, width, depth)| {
        let centre = pelvis + (neck - pelvis) * share;
        let depth = breadth * depth * (0.75 + 0.25 * build);
        (centre, forward * depth, left * (breadth * width))
    });
    mesh.tube(&rings, SIDES, |row| {
        Cloth::of(if row < BELT { Surface::Top } else { Surface::Bottom })
    });

    let nape = head + (posture.world_from_head().matrix() * skull_root(looks)).map(|part| part as f32);
    let throat = neck - up * (0.02 * size);
    let down = throat - nape;
    let front = across(down, forward);
    let side = front.cross(&down).try_normalize(1e-9).unwrap_or(left);
    let radius = 0.056 * size * (0.8 + 0.2 * build);
    let neck_rings =
        [(0.0, 0.95), (0.35, 0.95), (0.7, 1.02), (1.0, 1.25)].map(|(share, wide): (f32, f32)| {
            (
                nape + down * share,
                front * (radius * wide),
                side * (radius * wide),
            )
        });
    mesh.tube(&neck_rings, LIMB_SIDES, |_| Cloth::of(Surface::Skin));

    for arm in &posture.arms {
        let radii = [0.056, 0.043, 0.032].map(|radius: f32| radius * size * build.sqrt());
        let sleeve = |row: usize| {
            let bare = !looks.wear.long_sleeves && row >= 4;
            Cloth::of(if bare { Surface::Skin } else { Surface::Top })
        };
        // The arm's root is the top of the shoulder; its round end lies below and further in.
        let inwards = (neck - vector(arm.root)) - up * (neck - vector(arm.root)).dot(&up);
        let inwards = inwards.try_normalize(1e-6).unwrap_or_else(Vector3::zeros);
        let sunk = (inwards * 0.5 - up * 0.6) * radii[0];
        limb(mesh, arm, radii, sunk, forward, sleeve);
        let (joint, end) = (vector(arm.joint), vector(arm.end));
        let along = (end - joint).try_normalize(1e-6).unwrap_or(-up);
        let palm = across(along, left);
        let thickness = along.cross(&palm);
        let axes = [
            along * (0.085 * size),
            palm * (0.022 * size),
            thickness * (0.042 * size),
        ];
        mesh.ellipsoid(
            end + along * (0.06 * size),
            axes,
            LIMB_SIDES,
            Cloth::of(Surface::Skin),
        );
    }
    for leg in &posture.legs {
        let radii = [0.088, 0.058, 0.042].map(|radius: f32| radius * size * build.sqrt());
        limb(mesh, leg, radii, Vector3::zeros(), forward, |_| {
            Cloth::of(Surface::Bottom)
        });
        let end = vector(leg.end);
        let toes = across(Vector3::z(), facing);
        let axes = [
            toes * (0.13 * size),
            toes.cross(&Vector3::z()) * (0.045 * size),
            Vector3::z() * (0.04 * size),
        ];
        let sole = end + toes * (0.06 * size) - Vector3::z() * (0.035 * size);
        mesh.ellipsoid(sole, axes, LIMB_SIDES, Cloth::of(Surface::Shoe));
    }
    if looks.hair_style == Hair::Long {
        curtain(looks, posture, mesh);
    }
}

/// Where the neck enters the head, in the head's frame.
fn skull_root(looks: &Looks) -> Vector3<f64> {
    let [forward, _, up] = looks.head_half_axes_m;
    Vector3::new(-0.12 * forward, 0.0, -0.55 * up)
}

/// A limb of two parts with round ends, the first of which is moved by `sunk`.
fn limb(
    mesh: &mut Mesh,
    limb: &Limb,
    radii: [f32; 3],
    sunk: Vector3<f32>,
    wish: Vector3<f32>,
    cloth: impl Fn(usize) -> Cloth,
) {
    let [root, joint, end] =
        [limb.root, limb.joint, limb.end].map(|point| point.0.coords.map(|coordinate| coordinate as f32));
    let root = root + sunk;
    let direction = |from: Vector3<f32>, to: Vector3<f32>| {
        (to - from).try_normalize(1e-6).unwrap_or_else(|| -Vector3::z())
    };
    let (upper, lower) = (direction(root, joint), direction(joint, end));
    let bend = (upper + lower).try_normalize(1e-3).unwrap_or(upper);
    let [thick, middle, thin] = radii;
    // Centre, direction and radius of each ring.
    let rings = [
        (root - upper * (0.95 * thick), upper, 0.3 * thick),
        (root - upper * (0.6 * thick), upper, 0.8 * thick),
        (root, upper, thick),
        (root.lerp(&joint, 0.4), upper, 0.5 * (thick + middle)),
        (root.lerp(&joint, 0.75), upper, 1.05 * middle),
        (joint, bend, middle),
        (joint.lerp(&end, 0.3), lower, 0.98 * middle),
        (joint.lerp(&end, 0.8), lower, 0.4 * middle + 0.6 * thin),
        (end, lower, thin),
        (end + lower * (0.6 * thin), lower, 0.5 * thin),
    ];
    let rings = rings.map(|(centre, along, radius)| {
        let one = across(along, wish);
        (centre, one * radius, one.cross(&along) * radius)
    });
    mesh.tube(&rings, LIMB_SIDES, cloth);
}

/// Long hair around the back and the sides of the head, down to the shoulders.
fn curtain(looks: &Looks, posture: &Posture, mesh: &mut Mesh) {
    let turn = posture.world_from_head().matrix().map(|part| part as f32);
    let head = posture.head.0.coords.map(|coordinate| coordinate as f32);
    let [forward, side, up] = looks.head_half_axes_m.map(|half| half as f32);
    // Height over half the head's, half width and half depth over those of the head.
    let rows: [(f32, f32, f32); 7] = [
        (0.45, 0.99, 0.99),
        (0.1, 1.1, 1.04),
        (-0.3, 1.14, 1.0),
        (-0.7, 1.16, 0.92),
        (-1.05, 1.18, 0.86),
        (-1.3, 1.16, 0.82),
        (-1.5, 1.08, 0.8),
    ];
    let columns = 19;
    let from = 80.0_f32.to_radians();
    let span = std::f32::consts::TAU - 2.0 * from;
    let cloth = Cloth {
        surface: Surface::Hair,
        head: false,
        thin: true,
    };
    mesh.grid(
        rows.len(),
        columns,
        false,
        |_| cloth,
        |row, column| {
            let (height, wide, deep) = rows[row];
            let angle = from + span * column as f32 / (columns - 1) as f32;
            let local = Vector3::new(
                forward * deep * angle.cos(),
                side * wide * angle.sin(),
                up * height,
            );
            (head + turn * local, [column as f32 * 0.02, row as f32 * 0.03])
        },
    );
}
