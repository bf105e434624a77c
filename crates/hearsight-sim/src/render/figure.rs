//! One person's surface: shaped by looks and posture, lit, and brought into the picture.

use super::face::{self, Features, Mien};
use super::lamps::Lamps;
use super::mesh::{Facet, Mesh, SURFACES, Surface};
use super::shadow::Shadow;
use super::texture::Texture;
use super::view::between;
use super::{Person, Shot, body, head};
use crate::world::{Looks, Posture};
use hearsight_core::{CameraModel, CameraPoint, WorldPoint};
use nalgebra::Vector3;

/// Nothing nearer to the camera is drawn, metres.
const NEAREST_M: f64 = 0.03;
/// Metres around a head that its texture spans, as the face sees it.
const HEAD_TEXTURE_M: f32 = 0.25;

/// A corner in the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// Pixel in the middle of the shutter's time; not a number where the lens does not see it.
    pub(super) u: f32,
    pub(super) v: f32,
    /// How far it moves while the shutter is open, pixels.
    pub(super) du: f32,
    pub(super) dv: f32,
    /// One over its distance, 1/m.
    pub(super) near: f32,
    /// What a white surface reflects here.
    pub(super) light: [f32; 3],
    /// Where in the texture.
    pub(super) at: [f32; 2],
}

/// A person and the memory that drawing them takes.
#[derive(Clone, Debug)]
pub(super) struct Figure {
    /// As asked for, and with senseless numbers replaced.
    asked: Looks,
    looks: Looks,
    features: Features,
    head: Mesh,
    jaw: Vec<f32>,
    mien: Mien,
    opening: Mesh,
    closing: Mesh,
    pub(super) textures: [Texture; SURFACES],
    pub(super) levels: [usize; SURFACES],
    pub(super) seen: Vec<Seen>,
    /// Whether there is anything to draw.
    pub(super) drawn: bool,
    pub(super) shadow: Shadow,
}

impl Figure {
    pub(super) fn new(looks: &Looks) -> Self {
        let asked = looks.clone();
        let mut looks = asked.clone();
        for half in &mut looks.head_half_axes_m {
            *half = if half.is_finite() {
                half.clamp(0.02, 1.0)
            } else {
                0.1
            };
        }
        let features = Features::of(&looks);
        let (mut head, mut jaw) = (Mesh::default(), Vec::new());
        head::build(&looks, &features, &mut head, &mut jaw);
        let skin = Texture::plain(face::plain_skin(&looks));
        let textures = [
            face::texture(&looks, &features),
            skin,
            Texture::plain(looks.hair),
            Texture::cloth(&looks.wear.top),
            Texture::cloth(&looks.wear.bottom),
            Texture::plain(face::shoe(&looks)),
        ];
        Self {
            asked,
            looks,
            features,
            head,
            jaw,
            mien: Mien::default(),
            opening: Mesh::default(),
            closing: Mesh::default(),
            textures,
            levels: [0; SURFACES],
            seen: Vec::new(),
            drawn: false,
            shadow: Shadow::default(),
        }
    }

    /// Whether it shows somebody who looks like this.
    pub(super) fn is_of(&self, looks: &Looks) -> bool {
        self.asked == *looks
    }

    /// The farthest that anything of it moves in the picture while the shutter is open, pixels.
    pub(super) fn fastest_px(&self) -> f32 {
        self.seen
            .iter()
            .map(|seen| seen.du.abs().max(seen.dv.abs()))
            .fold(0.0, f32::max)
    }

    pub(super) fn facets(&self) -> &[Facet] {
        &self.opening.facets
    }

    /// Brings the person into the picture.
    pub(super) fn pose(&mut self, person: &Person<'_>, shot: &Shot<'_>, lamps: &Lamps) {
        self.drawn = is_finite(person.opening) && is_finite(person.closing);
        if !self.drawn {
            return;
        }
        let mean = |part: fn(&Posture) -> f64| 0.5 * (part(person.opening) + part(person.closing));
        let mien = Mien::of(
            mean(|posture| posture.mouth_opening),
            mean(|posture| posture.blink),
        );
        if mien != self.mien {
            face::enliven(
                &mut self.textures[Surface::Head as usize],
                &self.looks,
                &self.features,
                mien,
            );
            self.mien = mien;
        }
        self.shape(person.opening, true);
        self.shape(person.closing, false);
        let middle = |of: fn(&Posture) -> WorldPoint| {
            let (from, to) = (of(person.opening).0.coords, of(person.closing).0.coords);
            ((from + to) / 2.0).map(|coordinate| coordinate as f32)
        };
        let head = middle(|posture| posture.head);
        let flat = |of: fn(&Posture) -> WorldPoint| [middle(of).x, middle(of).y];
        let feet = [
            flat(|posture| posture.legs[0].end),
            flat(|posture| posture.legs[1].end),
        ];
        let crown_m = head.z + self.looks.head_half_axes_m[2] as f32;
        self.shadow
            .set(feet, flat(|posture| posture.pelvis), crown_m, lamps);
        self.project(shot, head, lamps);
    }

    fn shape(&mut self, posture: &Posture, opening: bool) {
        let mesh = if opening {
            &mut self.opening
        } else {
            &mut self.closing
        };
        mesh.clear();
        let turn = head::to_floats(posture.world_from_head().matrix());
        let middle = posture.head.0.coords.map(|coordinate| coordinate as f32);
        let half = self.looks.head_half_axes_m.map(|half| half as f32);
        let drop = head::jaw_drop(half) * self.mien.mouth();
        mesh.corners
            .extend(self.head.corners.iter().zip(&self.jaw).map(|(corner, jaw)| {
                let mut corner = *corner;
                corner.place = middle + turn * (corner.place + drop * *jaw);
                corner.normal = turn * corner.normal;
                corner
            }));
        mesh.facets.extend_from_slice(&self.head.facets);
        body::build(&self.looks, posture, mesh);
    }

    fn project(&mut self, shot: &Shot<'_>, head: Vector3<f32>, lamps: &Lamps) {
        let camera = shot.camera;
        let lens = camera.model.projection();
        let poses =
            [-0.5, 0.0, 0.5].map(|time| between(&camera.pose, shot.closing_pose, time).sensor_from_world);
        let radius = self.looks.head_half_axes_m[2] as f32;
        self.seen.clear();
        let skull = self.head.corners.len();
        let pairs = self.opening.corners.iter().zip(&self.closing.corners);
        self.seen.extend(pairs.enumerate().map(|(number, (from, to))| {
            let place = (from.place + to.place) / 2.0;
            let normal = from.normal;
            let world = |place: Vector3<f32>| nalgebra::Point3::from(place.map(f64::from));
            let middle = poses[1] * world(place);
            let moved = poses[2] * world(to.place) - poses[0] * world(from.place);
            let distance = middle.coords.norm();
            let visible = if distance > NEAREST_M {
                lens.project_with_jacobian(CameraPoint(middle))
            } else {
                None
            };
            let Some((pixel, jacobian)) = visible else {
                return Seen::nowhere();
            };
            let step = jacobian * moved;
            let mut light = lamps.on(place, normal);
            if number >= skull {
                // The head keeps light from the neck and the shoulders.
                let towards = head - place;
                let square = towards.norm_squared().max(radius * radius);
                let facing = (towards.dot(&normal) / square.sqrt()).max(0.0);
                let open = 1.0 - (0.75 * facing + 0.25) * (radius * radius / square);
                light = light.map(|channel| channel * open.max(0.25));
            }
            let seen = Seen {
                u: pixel.u as f32,
                v: pixel.v as f32,
                du: step.x as f32,
                dv: step.y as f32,
                near: (1.0 / distance) as f32,
                light,
                at: from.at,
            };
            let sound = [seen.u, seen.v, seen.du, seen.dv]
                .iter()
                .all(|number| number.abs() < 1e6);
            if sound { seen } else { Seen::nowhere() }
        }));
        if let CameraModel::Panorama(panorama) = camera.model {
            // The person stays in one piece: every corner goes to the side where the head is.
            if let Some(middle) = camera.project(WorldPoint(head.map(f64::from).into())) {
                for seen in &mut self.seen {
                    let offset = panorama.column_difference(middle.u, f64::from(seen.u));
                    seen.u = if offset.is_finite() {
                        (middle.u + offset) as f32
                    } else {
                        f32::NAN
                    };
                }
            }
        }
        let scale = camera
            .pixels_per_metre(WorldPoint(head.map(f64::from).into()))
            .unwrap_or(100.0);
        let sample_m = (0.5 / scale.max(1e-3)) as f32;
        self.levels = std::array::from_fn(|surface| {
            let units = if surface == Surface::Head as usize {
                sample_m / HEAD_TEXTURE_M
            } else {
                sample_m
            };
            self.textures[surface].level(units)
        });
    }
}

impl Seen {
    fn nowhere() -> Self {
        Self {
            u: f32::NAN,
            v: f32::NAN,
            du: 0.0,
            dv: 0.0,
            near: 0.0,
            light: [0.0; 3],
            at: [0.0; 2],
        }
    }
}

/// Whether every number of a posture is one and no larger than a world is.
fn is_finite(posture: &Posture) -> bool {
    let limbs = posture.arms.iter().chain(&posture.legs);
    let points = limbs.flat_map(|limb| [limb.root, limb.joint, limb.end]);
    let points = points.chain([posture.head, posture.neck, posture.pelvis]);
    let coordinates = points.flat_map(|point| [point.0.x, point.0.y, point.0.z]);
    let angles = [
        posture.head_yaw_rad,
        posture.head_pitch_rad,
        posture.head_roll_rad,
        posture.torso_yaw_rad,
    ];
    coordinates.chain(angles).all(|number| number.abs() < 1e5)
}
