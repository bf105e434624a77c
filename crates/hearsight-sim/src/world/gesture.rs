//! What hands and heads do besides: waving, covering the face, nodding.

use super::ease::smooth;
use serde::Deserialize;

/// How long hands take to come and to go, seconds.
const RAMP_S: f64 = 0.4;

/// A kind of gesture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GestureKind {
    /// The right hand sweeps to and fro before the face.
    HandBeforeFace,
    /// The right hand waves beside the head.
    Wave,
    /// The right arm is held up.
    RaiseHand,
    /// Both hands move as if talking.
    TalkWithHands,
    /// The head nods.
    Nod,
    /// The head shakes.
    ShakeHead,
}

/// A gesture with its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gesture {
    /// What kind.
    pub kind: GestureKind,
    /// When it begins, seconds.
    pub from_s: f64,
    /// When it is over, seconds.
    pub until_s: f64,
    /// Sweeps, waves or nods a second.
    pub rate_hz: f64,
}

impl GestureKind {
    /// Whether it needs the right hand.
    pub const fn needs_hand(self) -> bool {
        !matches!(self, Self::Nod | Self::ShakeHead)
    }

    /// Sweeps, waves or nods a second, where nothing is said.
    pub const fn usual_rate_hz(self) -> f64 {
        match self {
            Self::HandBeforeFace => 0.9,
            Self::Wave => 1.8,
            Self::RaiseHand => 0.3,
            Self::TalkWithHands => 1.0,
            Self::Nod => 1.5,
            Self::ShakeHead => 1.2,
        }
    }
}

impl Gesture {
    /// How much of it there is: 0 not at all, 1 fully.
    pub(crate) fn weight(&self, time_s: f64) -> f64 {
        let ramp = RAMP_S.min(0.5 * (self.until_s - self.from_s));
        smooth((time_s - self.from_s) / ramp) * smooth((self.until_s - time_s) / ramp)
    }

    /// Where in its sweep it is, radians.
    pub(crate) fn phase_rad(&self, time_s: f64) -> f64 {
        std::f64::consts::TAU * self.rate_hz * (time_s - self.from_s)
    }
}
