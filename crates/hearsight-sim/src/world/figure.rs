//! The measures of a body: how long its parts are for its height.

use super::setting::Looks;

/// Lengths of the parts of one body, metres. Shares of the height are those of Drillis and Contini, "Body segment
/// parameters", 1966, as tabulated by Winter, "Biomechanics and motor control of human movement".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// Height when standing upright.
    pub height_m: f64,
    /// Half axes of the head (forward, left, up).
    pub head_half_axes_m: [f64; 3],
    /// From the floor to the hips.
    pub hip_m: f64,
    /// From the hips to the root of the neck.
    pub trunk_m: f64,
    /// From the root of the neck to the middle of the head.
    pub neck_m: f64,
    /// From the middle of the body to a shoulder.
    pub shoulder_m: f64,
    /// From the middle of the body to a hip.
    pub half_pelvis_m: f64,
    /// From shoulder to elbow.
    pub upper_arm_m: f64,
    /// From elbow to the middle of the hand.
    pub forearm_m: f64,
    /// From hip to knee.
    pub thigh_m: f64,
    /// From knee to ankle.
    pub shin_m: f64,
    /// From the floor to the ankle.
    pub ankle_m: f64,
    /// Of the body seen from above, about its middle.
    pub radius_m: f64,
}

impl Figure {
    /// The measures of somebody who looks like this.
    pub fn of(looks: &Looks) -> Self {
        let height = looks.height_m;
        let hip = 0.53 * height;
        let neck_root = 0.825 * height;
        Self {
            height_m: height,
            head_half_axes_m: looks.head_half_axes_m,
            hip_m: hip,
            trunk_m: neck_root - hip,
            neck_m: height - looks.head_half_axes_m[2] - neck_root,
            shoulder_m: 0.115 * height * looks.build.sqrt(),
            half_pelvis_m: 0.055 * height * looks.build.sqrt(),
            upper_arm_m: 0.172 * height,
            forearm_m: 0.19 * height,
            thigh_m: 0.245 * height,
            shin_m: 0.246 * height,
            ankle_m: 0.039 * height,
            radius_m: 0.115 * height * looks.build,
        }
    }

    /// Length of two steps when walking at this speed, metres.
    pub fn stride_m(&self, speed_m_s: f64) -> f64 {
        self.height_m * (0.42 + 0.25 * speed_m_s.clamp(0.2, 2.5))
    }
}
