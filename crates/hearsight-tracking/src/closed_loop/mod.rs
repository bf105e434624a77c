//! A closed loop of trackers and a fuser (Chen and Rui 2004).
//!
//! Three *trackers* each solve the inverse problem in their own way and propose a Gaussian: the `contour` by edges and an
//! unscented filter, the `colour` by mean shift, the `sound` by a correlation's peak. The `fuser` draws hypotheses
//! from the mixture of what they propose, lets verifiers (cues) judge them, weighs them against all that the last moment
//! predicts, and tells the trackers how reliable each was and where the person is.
//!
//! What is remembered of one person is [`LoopState`], saved with the belief; everything else is buffers.

mod colour;
mod contour;
mod fuser;
mod hypotheses;
mod motion;
mod settings;
mod sound;

pub use colour::{ColourTracker, ColourTrackerSettings};
pub use contour::{ContourTracker, ContourTrackerSettings};
pub use fuser::Fuser;
pub use motion::{HeadMotion, HeadMotionSettings};
pub use settings::{
    FeedbackSettings, FuserSettings, LoopError, ProposalRule, ShareSettings, TrackerSwitches,
    VerdictSettings, WeightRule,
};
pub use sound::{SoundFix, SoundGeometry, SoundTracker, SoundTrackerSettings};

use hearsight_filter::{FilterError, UnscentedKalman};
use serde::{Deserialize, Serialize};

/// The trackers, in the order in which their numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrackerKind {
    /// Edges and an unscented filter, q_1.
    Contour,
    /// Mean shift, q_2.
    Colour,
    /// Peak of a correlation, q_3.
    Sound,
}

impl TrackerKind {
    /// Every tracker.
    pub const ALL: [Self; 3] = [Self::Contour, Self::Colour, Self::Sound];
}

/// What outline and colours say of a person's place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Both agree that the head is there.
    Verified,
    /// They say neither.
    #[default]
    Open,
    /// Neither outline nor colours are those of the head.
    Refuted,
}

/// What the trackers of one person remember.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoopState {
    /// The contour tracker's state (x, y, half height and their velocities; pixels, seconds) and covariance.
    pub contour: UnscentedKalman<6>,
    /// Where the colour tracker is: x, y, half height, pixels.
    pub colour: [f64; 3],
    /// Reliability of each tracker at the last moment (lambda, equation 25 corrected), 0 to 1.
    pub reliabilities: [f64; 3],
    /// For how long each tracker has been unreliable, seconds.
    pub failing_s: [f64; 3],
    /// What the verifiers made of the fused place.
    pub verdict: Verdict,
}

impl LoopState {
    /// Moves every tracker by so many columns.
    ///
    /// # Errors
    /// [`FilterError`] where that is no number.
    pub(crate) fn shift(&mut self, columns_px: f64) -> Result<(), FilterError> {
        self.colour[0] += columns_px;
        let (mut mean, covariance) = (*self.contour.mean(), *self.contour.covariance());
        mean[0] += columns_px;
        self.contour.set(mean, covariance)
    }
}
