//! The colour cue: Bhattacharyya distance of a region's histogram to the person's (stac, eqs. 9-11).

use super::{Cue, CueInfo, Evidence, Hypotheses, Subject};
use crate::body::Part;

pub(super) const INFO: CueInfo = CueInfo {
    name: "colour",
    meaning: "Bhattacharyya distance of a part's colour histogram to the one learnt (d, eq. 10)",
    unit: "1",
    range: (0.0, 1.0),
    larger_is_better: false,
    source: "Bregonzio, Taj, Cavallaro, section 2.3, eqs. 10-11",
};

/// Compares the colours of one part of the body.
#[derive(Clone, Debug)]
pub struct ColourCue {
    part: Part,
}

impl ColourCue {
    /// A cue on this part.
    pub fn new(part: Part) -> Self {
        Self { part }
    }
}

impl Cue for ColourCue {
    fn info(&self) -> &'static CueInfo {
        &INFO
    }

    fn subject(&self) -> Subject {
        Subject::Regions(self.part)
    }

    fn score(&self, hypotheses: &Hypotheses<'_>, scores: &mut [f32]) -> Evidence {
        let Some(reference) = hypotheses.appearance.part(self.part) else {
            return Evidence::Missing;
        };
        if hypotheses
            .camera
            .colour_distances(hypotheses.regions, reference, scores)
        {
            Evidence::Scored
        } else {
            Evidence::Missing
        }
    }
}
