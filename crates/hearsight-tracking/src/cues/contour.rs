//! The contour verifier: edges on the hypothesis' own outline (Chen and Rui, equation 20, corrected by E10).
//!
//! The raw score is the mean over the lines of the logarithm of equation 10; fusion multiplies it by how many lines count
//! as independent.

use super::{Cue, CueInfo, Evidence, Hypotheses, Subject};
use crate::body::Part;

pub(super) const INFO: CueInfo = CueInfo {
    name: "contour",
    meaning: "mean over the outline's lines of the logarithm of how much likelier the edges make it (eq. 10)",
    unit: "1",
    range: (0.0, 12.0),
    larger_is_better: true,
    source: "Chen, Rui, section V.A, eqs. 10, 20, corrected",
};

/// Scores outlines of heads.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContourCue;

impl Cue for ContourCue {
    fn info(&self) -> &'static CueInfo {
        &INFO
    }

    fn subject(&self) -> Subject {
        Subject::Regions(Part::Head)
    }

    fn score(&self, hypotheses: &Hypotheses<'_>, scores: &mut [f32]) -> Evidence {
        if hypotheses.camera.outline_scores(hypotheses.regions, scores) {
            Evidence::Scored
        } else {
            Evidence::Missing
        }
    }
}
