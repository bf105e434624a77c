//! The posture of one person at an instant: all that a renderer and a microphone must know of a body.

use hearsight_core::WorldPoint;
use nalgebra::{Rotation3, Vector3};
use serde::{Deserialize, Serialize};

/// An arm (shoulder, elbow, hand) or a leg (hip, knee, foot).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limb {
    /// Shoulder or hip, metres.
    pub root: WorldPoint,
    /// Elbow or knee, metres.
    pub joint: WorldPoint,
    /// Hand or ankle, metres.
    pub end: WorldPoint,
}

/// Where a body is and what it does, at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Posture {
    /// Middle of the head's ellipsoid, metres.
    pub head: WorldPoint,
    /// Where the face looks, counter-clockwise from x seen from above, radians.
    pub head_yaw_rad: f64,
    /// How far the face looks up, radians.
    pub head_pitch_rad: f64,
    /// How far the head leans towards the right shoulder, radians.
    pub head_roll_rad: f64,
    /// Root of the neck between the shoulders, metres.
    pub neck: WorldPoint,
    /// Middle between the hips, metres.
    pub pelvis: WorldPoint,
    /// Where the chest looks, counter-clockwise from x seen from above, radians.
    pub torso_yaw_rad: f64,
    /// Left and right arm.
    pub arms: [Limb; 2],
    /// Left and right leg.
    pub legs: [Limb; 2],
    /// How far the mouth is open: 0 closed, 1 as far as speech opens it.
    pub mouth_opening: f64,
    /// How far the eyes are closed: 0 open, 1 closed.
    pub blink: f64,
}

impl Posture {
    /// Turns vectors of the head's own frame (x forward through the nose, y to the left ear, z up) into the world.
    pub fn world_from_head(&self) -> Rotation3<f64> {
        Rotation3::from_axis_angle(&Vector3::z_axis(), self.head_yaw_rad)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), -self.head_pitch_rad)
            * Rotation3::from_axis_angle(&Vector3::x_axis(), self.head_roll_rad)
    }

    /// Where the mouth is, metres, in a head with these half axes (forward, left, up; metres).
    pub fn mouth(&self, half_axes_m: [f64; 3]) -> WorldPoint {
        let [forward, _, up] = half_axes_m;
        // On the ellipsoid, half of its lower half down: a quarter of the head's height above the chin.
        let in_head = Vector3::new(forward * 0.75_f64.sqrt(), 0.0, -0.5 * up);
        WorldPoint(self.head.0 + self.world_from_head() * in_head)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn looking(yaw: f64, pitch: f64, roll: f64) -> Posture {
        let point = WorldPoint::new(0.0, 0.0, 1.0);
        let limb = Limb {
            root: point,
            joint: point,
            end: point,
        };
        Posture {
            head: WorldPoint::new(1.0, 2.0, 1.6),
            head_yaw_rad: yaw,
            head_pitch_rad: pitch,
            head_roll_rad: roll,
            neck: point,
            pelvis: point,
            torso_yaw_rad: 0.0,
            arms: [limb; 2],
            legs: [limb; 2],
            mouth_opening: 0.0,
            blink: 0.0,
        }
    }

    #[test]
    fn angles_turn_the_way_that_is_said() {
        let nose = |posture: Posture| posture.world_from_head() * Vector3::x();
        assert!((nose(looking(FRAC_PI_2, 0.0, 0.0)) - Vector3::y()).norm() < 1e-12);
        assert!(nose(looking(0.0, 0.3, 0.0)).z > 0.2);
        // Leaning towards the right shoulder brings the crown to the right, which is -y.
        assert!((looking(0.0, 0.0, 0.3).world_from_head() * Vector3::z()).y < -0.2);
    }

    #[test]
    fn the_mouth_is_in_front_and_a_quarter_above_the_chin() {
        let half = [0.1, 0.08, 0.12];
        let mouth = looking(0.0, 0.0, 0.0).mouth(half).0;
        assert!((mouth.z - (1.6 - 0.12 + 0.25 * 0.24)).abs() < 1e-12);
        assert!(mouth.x > 1.05 && (mouth.y - 2.0).abs() < 1e-12);
    }
}
