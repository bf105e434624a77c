//! The colour verifier: how much a head differs from what is around it (Chen and Rui, equations 21 and 22).
//!
//! It knows no person: light may change as it likes, as long as heads do not look like their surroundings.

use super::{Cue, CueInfo, Evidence, Hypotheses, Subject};
use crate::body::Part;

pub(super) const INFO: CueInfo = CueInfo {
    name: "contrast",
    meaning: "one minus the Bhattacharyya coefficient of the colours in the ellipse and in the ring around it (eq. 22)",
    unit: "1",
    range: (0.0, 1.0),
    larger_is_better: true,
    source: "Chen, Rui, section V.B, eqs. 21-22",
};

/// Scores heads by their contrast.
#[derive(Clone, Debug, Default)]
pub struct ContrastCue;

impl Cue for ContrastCue {
    fn info(&self) -> &'static CueInfo {
        &INFO
    }

    fn subject(&self) -> Subject {
        Subject::Regions(Part::Head)
    }

    fn score(&self, hypotheses: &Hypotheses<'_>, scores: &mut [f32]) -> Evidence {
        if !hypotheses.camera.contrasts(hypotheses.regions, scores) {
            return Evidence::Missing;
        }
        for score in scores {
            *score = 1.0 - *score;
        }
        Evidence::Scored
    }
}
