//! Which detection belongs to whom: the assignment of least cost over place, size and colour.
//!
//! The motion cue of one person must only see the detection associated to them (stac, eq. 12, corrected by E7).

use crate::belief::{Appearance, Belief};
use hearsight_core::Rectangle;
use hearsight_filter::{Assigner, FilterError, Unpaired};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a detection may differ by from the person that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct AssociationSettings {
    /// Standard deviation of the place of a detection around the prediction, head widths, in addition to the spread
    /// of the belief itself. Default 0.6.
    pub position: f32,
    /// Standard deviation of the logarithm of the size. Default 0.3: outlines miss a head's size by a third.
    pub size: f32,
    /// Standard deviation of the colour distance. Default 0.25. Lowering it lets colour decide over place.
    pub colour: f32,
    /// Largest cost (half a sum of squares of the above) at which a detection still belongs to a person. Default 8.
    pub gate: f32,
    /// Cost of a detection for somebody who was hidden in the picture before. Default 2. Raising it keeps people hidden
    /// longer behind others.
    pub hidden: f32,
    /// Weight of the torso's colours against the head's, 0 to 1. Default 0.7.
    pub torso: f32,
}

impl Default for AssociationSettings {
    fn default() -> Self {
        Self {
            position: 0.6,
            size: 0.3,
            colour: 0.25,
            gate: 8.0,
            hidden: 2.0,
            torso: 0.7,
        }
    }
}

/// Assigns detections to beliefs; owns its buffers.
#[derive(Debug, Default)]
pub struct Association {
    costs: Vec<f64>,
    assigner: Assigner,
}

impl Association {
    /// Finds for each belief the detection that belongs to it. `appearances` holds the colours at each detection.
    ///
    /// # Errors
    /// [`FilterError`] where the gate is not a number.
    pub fn solve(
        &mut self,
        beliefs: &[Belief],
        detections: &[Rectangle],
        appearances: &[Appearance],
        settings: &AssociationSettings,
    ) -> Result<(), FilterError> {
        self.costs.clear();
        for belief in beliefs {
            for (detection, appearance) in detections.iter().zip(appearances) {
                self.costs
                    .push(f64::from(cost(belief, detection, appearance, settings)));
            }
        }
        let gate = f64::from(settings.gate);
        self.assigner.assign(
            &self.costs,
            beliefs.len(),
            detections.len(),
            gate,
            Unpaired::Costs(gate),
        )?;
        Ok(())
    }

    /// The detection of a belief.
    pub fn detection_of(&self, belief: usize) -> Option<usize> {
        self.assigner
            .assignment()
            .column_of_row
            .get(belief)
            .copied()
            .flatten()
    }

    /// Whether a detection belongs to a belief.
    pub fn is_taken(&self, detection: usize) -> bool {
        self.assigner
            .assignment()
            .row_of_column
            .get(detection)
            .copied()
            .flatten()
            .is_some()
    }
}

/// Minus the log-likelihood of the detection, up to a constant that is the same for all beliefs.
fn cost(
    belief: &Belief,
    detection: &Rectangle,
    appearance: &Appearance,
    settings: &AssociationSettings,
) -> f32 {
    let ((x, y), (u, v)) = (belief.head.centre(), detection.centre());
    let own = (settings.position * belief.head.width.max(detection.width)).powi(2);
    let variance = belief.deviation.map(|deviation| own + deviation * deviation);
    let place = (x - u).powi(2) / variance[0] + (y - v).powi(2) / variance[1];
    // A belief that is spread out explains every place, and each of them less well.
    let spread = (variance[0] * variance[1] / (own * own)).ln();
    let size = ((detection.width / belief.head.width.max(1.0)).ln() / settings.size).powi(2);
    let colour = belief
        .appearance
        .distance(appearance, settings.torso)
        .map_or(0.0, |distance| (distance / settings.colour).powi(2));
    let hidden = if belief.occluded { settings.hidden } else { 0.0 };
    0.5 * (place + spread + size + colour) + hidden
}
