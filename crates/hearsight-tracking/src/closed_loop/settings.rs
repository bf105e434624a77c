//! Settings of the fuser: which tracker and rule is on, and how the loop is closed.

use super::{ColourTrackerSettings, ContourTrackerSettings, HeadMotionSettings, SoundTrackerSettings};
use hearsight_audio::AudioError;
use hearsight_filter::FilterError;
use hearsight_vision::VisionError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which trackers propose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct TrackerSwitches {
    /// Whether the contour tracker proposes. Default true.
    pub contour: bool,
    /// Whether the colour tracker proposes. Default true.
    pub colour: bool,
    /// Whether the sound tracker proposes. Default true.
    pub sound: bool,
}

impl Default for TrackerSwitches {
    fn default() -> Self {
        Self {
            contour: true,
            colour: true,
            sound: true,
        }
    }
}

/// Where hypotheses are drawn from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProposalRule {
    /// The mixture of what the trackers propose, with a share of the prior.
    #[default]
    Trackers,
    /// The transition prior alone: CONDENSATION (Isard and Blake 1998).
    Prior,
}

/// How hypotheses that were drawn from the mixture are weighed against what was predicted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WeightRule {
    /// By the Gaussian that fits all that was predicted, O(N).
    #[default]
    Gaussian,
    /// By all predictions, exactly, O(N^2) (marginal particle filter).
    Marginal,
    /// By the prediction of the i-th ancestor, as equation 8 is printed, to show that particles are wasted.
    Printed,
}

/// How the trackers are told (equations 25 and 26).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FeedbackSettings {
    /// Whether trackers are told at all. Default true; false is the open loop.
    pub enabled: bool,
    /// Reliability below which a tracker fails, 0 to 1. Default 0.2.
    pub failing: f64,
    /// For how long it may fail before it starts anew at the fused place, seconds. Default 0.34: five pictures of the
    /// paper's.
    pub patience_s: f64,
    /// Time after which colours learnt earlier have faded to a third, seconds. Default 8. Raising it keeps to the first
    /// colours, lowering it drifts more easily. Colours are learnt where outline and colours agree.
    pub memory_s: f64,
}

impl Default for FeedbackSettings {
    fn default() -> Self {
        Self {
            enabled: true,
            failing: 0.2,
            patience_s: 0.34,
            memory_s: 8.0,
        }
    }
}

/// Everything of the loop.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FuserSettings {
    /// Which trackers propose. With one alone, and its verifier, the system is that tracker's ablation.
    pub trackers: TrackerSwitches,
    /// Where hypotheses are drawn from. Default `trackers`; `prior` is CONDENSATION.
    pub proposal: ProposalRule,
    /// How they are weighed against what was predicted. Default `gaussian`.
    pub weights: WeightRule,
    /// Share of the hypotheses drawn from the prior, and floor of every tracker's share.
    pub shares: ShareSettings,
    /// How the trackers are told.
    pub feedback: FeedbackSettings,
    /// How heads move.
    pub motion: HeadMotionSettings,
    /// The contour tracker.
    pub contour: ContourTrackerSettings,
    /// The colour tracker.
    pub colour: ColourTrackerSettings,
    /// The sound tracker.
    pub sound: SoundTrackerSettings,
    /// When the verifiers are sure.
    pub verdict: VerdictSettings,
}

/// The mixture's shares.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ShareSettings {
    /// Share of the prior, the defensive component, 0.01 to 1. Default 0.15. Lowering it trusts the trackers more; without
    /// it weights are unbounded where all trackers are wrong.
    pub prior: f64,
    /// Share of the hypotheses drawn around the person's own detection, where there is one, and probability that the person
    /// is there whatever was predicted (Isard and Blake 1998, ICondensation), 0 to 0.9. Default 0.2. Not in the paper; 0 is
    /// its system, in which detections only start trackers.
    pub detected: f64,
    /// Least share of a tracker that is on among the trackers, 0 to 0.3. Default 0.2: whoever is unreliable now is needed when
    /// the head jerks aside. With less too few hypotheses are where only that one looks.
    pub least: f64,
}

impl Default for ShareSettings {
    fn default() -> Self {
        Self {
            prior: 0.15,
            detected: 0.2,
            least: 0.2,
        }
    }
}

/// When outline and colours confirm a person, or deny them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct VerdictSettings {
    /// Share of the outline with an edge from which it confirms, 0 to 1. Default 0.5.
    pub outline: f32,
    /// The same below which it denies. Default 0.25.
    pub no_outline: f32,
    /// Likeness of the colours to those learnt from which they confirm, 0 to 1. Default 0.75.
    pub colour: f32,
    /// The same below which they deny. Default 0.5.
    pub no_colour: f32,
    /// Half height of a head below which it is denied whatever it looks like, pixels, 0 or more. Default 6.
    pub smallest_px: f64,
}

impl Default for VerdictSettings {
    fn default() -> Self {
        Self {
            outline: 0.5,
            no_outline: 0.25,
            colour: 0.75,
            no_colour: 0.5,
            smallest_px: 6.0,
        }
    }
}

impl FuserSettings {
    /// # Errors
    /// [`FilterError::OutOfRange`] where a share, time or threshold is out of its range.
    pub(super) fn check(&self) -> Result<(), FilterError> {
        let within = |what, value: f64, low: f64, high: f64, range| {
            if value >= low && value <= high {
                Ok(())
            } else {
                Err(FilterError::OutOfRange {
                    what,
                    range,
                    found: value,
                })
            }
        };
        within("shares.prior", self.shares.prior, 0.01, 1.0, "0.01 to 1")?;
        within("shares.detected", self.shares.detected, 0.0, 0.9, "0 to 0.9")?;
        within("shares.least", self.shares.least, 0.0, 0.3, "0 to 0.3")?;
        within("feedback.failing", self.feedback.failing, 0.0, 1.0, "0 to 1")?;
        within(
            "feedback.patience_s",
            self.feedback.patience_s,
            0.0,
            1e6,
            "0 or more",
        )?;
        within(
            "feedback.memory_s",
            self.feedback.memory_s,
            1e-3,
            1e9,
            "0.001 or more",
        )
    }
}

/// Why a fuser could not be made.
#[derive(Debug, thiserror::Error)]
pub enum LoopError {
    /// A setting of the mathematics is out of its range.
    #[error(transparent)]
    Filter(#[from] FilterError),
    /// A setting of the contour or colour tracker is out of its range.
    #[error(transparent)]
    Vision(#[from] VisionError),
    /// A setting of the sound tracker is out of its range.
    #[error(transparent)]
    Audio(#[from] AudioError),
}
