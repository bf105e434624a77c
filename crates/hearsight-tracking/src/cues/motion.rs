//! The motion cue: nearness to the heads of the changed regions (stac, eq. 12, corrected by E7 and E9).
//!
//! With several detections a hypothesis scores p_0 + sum_j beta_j N_4(x; det_j, Sigma), where beta_j is the weight
//! that the person gives detection j (association) and N_4 is scaled to 1 at its peak. Without any detection the
//! modality is missing. The printed variances (0.15 for position, 10 for size) cannot both be pixels; here positions
//! and sizes are relative to the size of the detection.

use super::{Cue, CueInfo, Evidence, Hypotheses, Subject};
use crate::body::Part;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub(super) const INFO: CueInfo = CueInfo {
    name: "motion",
    meaning: "nearness to heads of changed regions, mixture over detections",
    unit: "1",
    range: (0.0, 1.0),
    larger_is_better: true,
    source: "Bregonzio, Taj, Cavallaro, section 2.3, eq. 12, corrected",
};

/// Widths of the Gaussian around a detection.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct MotionSettings {
    /// Standard deviation of position, head widths. Default 0.3. Raising it trusts detections less.
    pub position: f32,
    /// Standard deviation of the logarithm of width and height. Default 0.2.
    pub size: f32,
    /// Score far from all detections (p_0), above 0 to 1. Default 0.002. Raising it lets colour hold a person against
    /// detections.
    pub floor: f32,
}

impl Default for MotionSettings {
    fn default() -> Self {
        Self {
            position: 0.3,
            size: 0.2,
            floor: 0.002,
        }
    }
}

/// Scores heads by their nearness to detections.
#[derive(Clone, Debug)]
pub struct MotionCue {
    settings: MotionSettings,
}

impl MotionCue {
    /// A cue with these settings.
    pub fn new(settings: MotionSettings) -> Self {
        Self { settings }
    }
}

impl Cue for MotionCue {
    fn info(&self) -> &'static CueInfo {
        &INFO
    }

    fn subject(&self) -> Subject {
        Subject::Regions(Part::Head)
    }

    fn score(&self, hypotheses: &Hypotheses<'_>, scores: &mut [f32]) -> Evidence {
        if hypotheses.detections.iter().all(|(_, weight)| *weight <= 0.0) {
            return Evidence::Missing;
        }
        let s = &self.settings;
        let per_size = 0.5 / (s.size * s.size);
        scores.fill(s.floor);
        for (head, weight) in hypotheses.detections {
            let (x, y) = head.centre();
            let per_position = 0.5 / (s.position * head.width).powi(2);
            let share = weight * (1.0 - s.floor);
            for (score, region) in scores.iter_mut().zip(hypotheses.regions) {
                let (column, row) = region.centre();
                let near = ((column - x).powi(2) + (row - y).powi(2)) * per_position;
                // Far hypotheses keep the floor; the logarithms of sizes are spared for them.
                if near < 16.0 {
                    let width = (region.width / head.width).ln();
                    let height = (region.height / head.height).ln();
                    *score += share * (-near - (width * width + height * height) * per_size).exp();
                }
            }
        }
        Evidence::Scored
    }
}
