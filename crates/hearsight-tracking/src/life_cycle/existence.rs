//! Existence: how the evidence of a moment changes the probability that a person is there. Ends in death.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the moment says of a person.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Situation {
    /// A detection belongs to them.
    Detected,
    /// Not detected, but verifiers agree that a head is there.
    Verified,
    /// Not detected, and verifiers agree that no head of theirs is there.
    Refuted,
    /// Not detected, but something changed where they are.
    Present,
    /// Not detected, and somebody nearer covers them.
    Occluded,
    /// Not detected at the edge of the picture.
    Leaving,
    /// Not detected, and nothing changed where they are.
    Absent,
    /// Outside the picture.
    Outside,
}

/// Rates of evidence: change of the logarithm of odds a second.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ExistenceSettings {
    /// While a detection belongs to the person, positive. Default 20.
    pub detected: f64,
    /// While not detected though something is there, not positive. Default -3. Raising it to 0 keeps people who sit
    /// still, and ghosts.
    pub present: f64,
    /// While not detected but verified by outline and colours, where a system does so. Default 3.
    pub verified: f64,
    /// While refuted by them, negative. Default -3.
    pub refuted: f64,
    /// While hidden behind another, not positive. Default -1.2: given up after about five seconds.
    pub occluded: f64,
    /// While not detected at the left or right edge of the picture, negative. Default -20.
    pub leaving: f64,
    /// While nothing is there, negative. Default -15: given up after half a second.
    pub absent: f64,
    /// While outside the picture, negative. Default -40.
    pub outside: f64,
    /// A belief below this probability dies, 0 to 0.5. Default 0.1.
    pub least: f64,
}

impl Default for ExistenceSettings {
    fn default() -> Self {
        Self {
            detected: 20.0,
            present: -3.0,
            verified: 3.0,
            refuted: -3.0,
            occluded: -1.2,
            leaving: -20.0,
            absent: -15.0,
            outside: -40.0,
            least: 0.1,
        }
    }
}

/// Evidence of one situation lasting `seconds`.
pub(crate) fn log_ratio(situation: Situation, seconds: f64, settings: &ExistenceSettings) -> f64 {
    let rate = match situation {
        Situation::Detected => settings.detected,
        Situation::Present => settings.present,
        Situation::Verified => settings.verified,
        Situation::Refuted => settings.refuted,
        Situation::Occluded => settings.occluded,
        Situation::Leaving => settings.leaving,
        Situation::Absent => settings.absent,
        Situation::Outside => settings.outside,
    };
    rate * seconds
}
