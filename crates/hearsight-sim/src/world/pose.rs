//! From what a body does to where its parts are.

use super::character::{Character, Sway};
use super::ease::{mix, smooth, wrap};
use super::figure::Figure;
use super::gesture::{Gesture, GestureKind};
use super::limbs::bend;
use super::motion::{Gait, Stance};
use super::posture::{Limb, Posture};
use hearsight_core::WorldPoint;
use nalgebra::{Point3, Rotation3, Vector3};
use std::f64::consts::TAU;

/// How far trunks sway, metres at the neck.
const SWAY_M: f64 = 0.012;
/// How far heads do, radians.
const HEAD_SWAY_RAD: f64 = 0.05;
/// How far somebody who talks nods, radians.
const NOD_RAD: f64 = 0.06;
/// From a seat to the hips of who sits on it, metres.
const HIPS_ABOVE_SEAT_M: f64 = 0.09;
/// Part of a step in which a foot is on the floor.
const DUTY: f64 = 0.6;
/// Share of the head's turn that the chest follows.
const CHEST_FOLLOWS: f64 = 0.25;

/// All that decides on a posture.
pub(crate) struct Pose<'a> {
    pub(crate) figure: &'a Figure,
    pub(crate) character: &'a Character,
    pub(crate) stance: Stance,
    pub(crate) gestures: &'a [Gesture],
    /// Where the head looks against the body (to the left), and up, radians.
    pub(crate) gaze_rad: [f64; 2],
    /// How far the mouth is open, 0 to 1.
    pub(crate) mouth_opening: f64,
    /// How much somebody talks, smoothed over syllables, 0 to 1.
    pub(crate) talking: f64,
    pub(crate) time_s: f64,
}

/// Directions of a body that stands upright.
struct Frame {
    forward: Vector3<f64>,
    left: Vector3<f64>,
}

impl Frame {
    fn facing(yaw_rad: f64) -> Self {
        let (sin, cos) = yaw_rad.sin_cos();
        Self {
            forward: Vector3::new(cos, sin, 0.0),
            left: Vector3::new(-sin, cos, 0.0),
        }
    }

    /// A vector of so much forward, left and up.
    fn vector(&self, forward: f64, left: f64, up: f64) -> Vector3<f64> {
        self.forward * forward + self.left * left + Vector3::z() * up
    }
}

/// Trunk and head without looking anywhere: pelvis, root of the neck, middle of the head.
pub(crate) struct Core {
    pub(crate) pelvis: Point3<f64>,
    pub(crate) neck: Point3<f64>,
    pub(crate) head: Point3<f64>,
}

/// Where trunk and head are, whatever the head looks at.
pub(crate) fn core(figure: &Figure, character: &Character, stance: &Stance, time_s: f64) -> Core {
    let frame = Frame::facing(stance.facing_rad);
    let swing = stance.gait.map_or(0.0, |gait| gait.swing);
    let step = stance.gait.map_or(0.0, |gait| TAU * gait.way_m / gait.stride_m);
    // Lowest with both feet on the floor, highest over the standing leg, twice in two steps.
    let dip = 0.012 + 0.016 * swing * (1.0 + (2.0 * step).cos()) / 2.0;
    let standing = figure.hip_m - dip;
    let height = mix(standing, stance.seat_m + HIPS_ABOVE_SEAT_M, stance.sitting);
    let aside = 0.018 * swing * step.sin();
    let pelvis = Point3::new(stance.place.x, stance.place.y, height) + frame.left * aside;
    let [forward, left] = stance.lean_rad;
    let still = 1.0 - 0.7 * swing;
    let forward = forward + still * SWAY_M / figure.trunk_m * character.sway(Sway::Forward, time_s);
    let left = left + still * SWAY_M / figure.trunk_m * character.sway(Sway::Left, time_s);
    let up = frame
        .vector(forward.sin(), left.sin(), forward.cos() * left.cos())
        .normalize();
    let neck = pelvis + up * figure.trunk_m;
    // A neck straightens up again, half.
    let head = neck + (up + Vector3::z()).normalize() * figure.neck_m + frame.forward * 0.015;
    Core { pelvis, neck, head }
}

impl Pose<'_> {
    /// The whole body.
    pub(crate) fn posture(&self) -> Posture {
        let (figure, stance, time) = (self.figure, &self.stance, self.time_s);
        let core = core(figure, self.character, stance, time);
        let [yaw, pitch, roll] = self.head_angles();
        let chest_yaw = stance.facing_rad + CHEST_FOLLOWS * self.gaze_rad[0];
        // The head turns about its joint with the neck, which is below and behind its middle.
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), -pitch)
            * Rotation3::from_axis_angle(&Vector3::x_axis(), roll);
        let pivot =
            core.head - Vector3::z() * 0.5 * figure.neck_m - Frame::facing(stance.facing_rad).forward * 0.015;
        let head = pivot + turn * Vector3::new(0.015, 0.0, 0.5 * figure.neck_m);
        let chest = Frame::facing(chest_yaw);
        let legs = self.legs(&core);
        let arms = [1.0, -1.0].map(|side| self.arm(side, &core, &chest, head, &turn, &legs));
        Posture {
            head: WorldPoint(head),
            head_yaw_rad: yaw,
            head_pitch_rad: pitch,
            head_roll_rad: roll,
            neck: WorldPoint(core.neck),
            pelvis: WorldPoint(core.pelvis),
            torso_yaw_rad: wrap(chest_yaw),
            arms,
            legs,
            mouth_opening: self.mouth_opening,
            blink: self.character.blink(time),
        }
    }

    /// Yaw, pitch and roll of the head.
    fn head_angles(&self) -> [f64; 3] {
        let (character, time) = (self.character, self.time_s);
        let sway = |which| HEAD_SWAY_RAD * character.sway(which, time);
        let mut yaw = self.stance.facing_rad + self.gaze_rad[0] + sway(Sway::Yaw);
        let mut pitch = self.gaze_rad[1] + 0.6 * sway(Sway::Pitch);
        pitch += NOD_RAD * self.talking * character.sway(Sway::Nod, time);
        for gesture in self.gestures {
            let swing = gesture.weight(time) * gesture.phase_rad(time).sin();
            match gesture.kind {
                GestureKind::Nod => pitch += 0.2 * swing,
                GestureKind::ShakeHead => yaw += 0.35 * swing,
                _ => {}
            }
        }
        [wrap(yaw), pitch, 0.8 * sway(Sway::Roll)]
    }

    fn legs(&self, core: &Core) -> [Limb; 2] {
        let (figure, stance) = (self.figure, &self.stance);
        let frame = Frame::facing(stance.facing_rad);
        let floor = Point3::new(stance.place.x, stance.place.y, figure.ankle_m);
        [1.0, -1.0].map(|side| {
            let root = core.pelvis + frame.left * (side * figure.half_pelvis_m);
            let (ahead, lift) = stance.gait.map_or((0.0, 0.0), |gait| foot(&gait, side));
            let standing = floor + frame.vector(ahead, side * 0.9 * figure.half_pelvis_m, lift);
            let seated = floor + frame.vector(0.93 * figure.thigh_m, side * 1.5 * figure.half_pelvis_m, 0.0);
            let foot = standing + (seated - standing) * stance.sitting;
            let hint =
                root + (foot - root) * 0.5 + frame.forward * 0.5 + Vector3::z() * (0.4 * stance.sitting);
            bend(root, foot, [figure.thigh_m, figure.shin_m], hint)
        })
    }

    fn arm(
        &self,
        side: f64,
        core: &Core,
        chest: &Frame,
        head: Point3<f64>,
        turn: &Rotation3<f64>,
        legs: &[Limb; 2],
    ) -> Limb {
        let (figure, stance) = (self.figure, &self.stance);
        let root = core.neck + chest.vector(0.0, side * figure.shoulder_m, -0.025 * figure.height_m);
        // Arms swing against the legs.
        let (swing, amount) = stance.gait.map_or((0.0, 0.0), |gait| {
            let phase =
                TAU * gait.way_m / gait.stride_m + if side > 0.0 { 0.0 } else { std::f64::consts::PI };
            let strength = gait.swing * (gait.speed_m_s / 1.2).min(1.4);
            (-0.42 * strength * phase.cos(), strength)
        });
        let forearm = swing + 0.22 + 0.25 * amount;
        let elbow =
            root + chest.vector(swing.sin(), side * 0.14, -swing.cos()).normalize() * figure.upper_arm_m;
        let hanging = elbow
            + chest
                .vector(forearm.sin(), side * 0.04, -forearm.cos())
                .normalize()
                * figure.forearm_m;
        let leg = &legs[usize::from(side < 0.0)];
        let thigh = leg.root.0 + (leg.joint.0 - leg.root.0) * 0.75;
        let on_thigh = thigh + chest.vector(0.0, -side * 0.02, 0.10);
        let sitting = smooth(stance.sitting);
        let mut hand = hanging + (on_thigh - hanging) * sitting;
        let out = root + chest.vector(-0.1, side * 0.25, -0.25);
        let mut hint = elbow + (out - elbow) * sitting;
        let talk = self.talking * self.character.liveliness;
        for (target, weight) in self.gestured(side, core, chest, head, turn, talk) {
            hand += (target - hand) * weight;
            hint += (out - hint) * weight;
        }
        bend(root, hand, [figure.upper_arm_m, figure.forearm_m], hint)
    }

    /// Where gestures want the hand of one side, and how much.
    fn gestured(
        &self,
        side: f64,
        core: &Core,
        chest: &Frame,
        head: Point3<f64>,
        turn: &Rotation3<f64>,
        talk: f64,
    ) -> impl Iterator<Item = (Point3<f64>, f64)> {
        let (time, character, scale) = (self.time_s, self.character, self.figure.height_m / 1.75);
        let sway = |axis: usize| {
            let which = if side > 0.0 {
                Sway::LeftHand(axis)
            } else {
                Sway::RightHand(axis)
            };
            character.sway(which, time)
        };
        let talking_hand = core.neck
            + chest.vector(
                scale * (0.3 + 0.08 * sway(0)),
                side * scale * (0.16 + 0.12 * sway(1)),
                scale * (-0.3 + 0.13 * sway(2)),
            );
        let spontaneous = std::iter::once((talking_hand, smooth(talk)));
        let half = self.figure.head_half_axes_m;
        let neck = core.neck;
        let (forward, left) = (chest.forward, chest.left);
        let turn = *turn;
        let gestures = self.gestures.to_vec();
        spontaneous.chain(gestures.into_iter().filter_map(move |gesture| {
            let weight = gesture.weight(time);
            let at = |ahead: f64, aside: f64, up: f64| {
                neck + (forward * ahead + left * aside + Vector3::z() * up) * scale
            };
            let swing = gesture.phase_rad(time).sin();
            let right = side < 0.0;
            let target = match gesture.kind {
                GestureKind::HandBeforeFace if right => {
                    head + turn * Vector3::new(half[0] + 0.08, 0.17 * swing - 0.01, -0.02)
                }
                GestureKind::Wave if right => at(0.22, -0.32 + 0.12 * swing, 0.24),
                GestureKind::RaiseHand if right => at(0.12, -0.24 + 0.02 * swing, 0.48),
                GestureKind::TalkWithHands => talking_hand,
                _ => return None,
            };
            (weight > 0.0).then_some((target, weight))
        }))
    }
}

/// How far a foot is ahead of the hips and above the floor, metres; the left one is on side 1, the right one on -1.
fn foot(gait: &Gait, side: f64) -> (f64, f64) {
    let reach = 0.5 * DUTY * gait.stride_m;
    let steps = gait.way_m / gait.stride_m + if side > 0.0 { 0.0 } else { 0.5 };
    let part = steps - steps.floor();
    let (ahead, lift) = if part < DUTY {
        let ahead = reach - part * gait.stride_m;
        // The heel rises as the leg is left behind.
        (ahead, 0.06 * (-ahead / reach).max(0.0).powi(2))
    } else {
        let swing = (part - DUTY) / (1.0 - DUTY);
        (
            mix(-reach, reach, smooth(swing)),
            mix(0.06, 0.0, swing) + 0.05 * (std::f64::consts::PI * swing).sin(),
        )
    };
    (gait.swing * ahead, gait.swing * lift)
}
