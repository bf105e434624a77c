//! Momentum: how a belief moves on from one picture to the next, and through the time that it is hidden.
//!
//! The paper's model is of zero order: particles lag behind people who walk, and of two who cross either may go either
//! way. Here the whole cloud, and with it the place at which a detection is awaited, is moved on by the velocity that the
//! detections so far have shown: the fixed-gain (alpha-beta) observer of a constant velocity, whose other half is the
//! filter.

use crate::belief::Belief;
use hearsight_core::{Rectangle, Span};
use hearsight_filter::FilterError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How much of a movement goes on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct MomentumSettings {
    /// Whether beliefs move on. Default true; false is the paper's model.
    pub enabled: bool,
    /// Time in which a velocity is learnt, seconds. Default 0.15, in which a walking person changes pace. Raising it
    /// trusts single detections less and turns later.
    pub settle_s: f64,
    /// Time after which an unseen person has lost all but a third of the velocity, seconds. Default 0.5.
    pub keep_s: f64,
}

impl Default for MomentumSettings {
    fn default() -> Self {
        Self {
            enabled: true,
            settle_s: 0.15,
            keep_s: 0.5,
        }
    }
}

/// Moves a belief on by its velocity.
///
/// # Errors
/// [`FilterError`] where the state has no place.
pub(crate) fn move_on(
    belief: &mut Belief,
    elapsed: Span,
    settings: &MomentumSettings,
) -> Result<(), FilterError> {
    if !settings.enabled {
        return Ok(());
    }
    let elapsed_s = elapsed.seconds().clamp(0.0, 1.0) as f32;
    let [x, y] = belief.velocity_px_s.map(|velocity| velocity * elapsed_s);
    if !(x.is_finite() && y.is_finite()) {
        belief.velocity_px_s = [0.0; 2];
        return Ok(());
    }
    for (column, step) in belief.particles.columns_mut([0, 1])?.into_iter().zip([x, y]) {
        column.iter_mut().for_each(|value| *value += step);
    }
    belief.head.left += x;
    belief.head.top += y;
    Ok(())
}

/// Learns from the detection that belongs to a belief, given the head as it was awaited, or forgets without one.
pub(crate) fn learn(
    velocity_px_s: &mut [f32; 2],
    awaited: &Rectangle,
    detection: Option<&Rectangle>,
    elapsed: Span,
    settings: &MomentumSettings,
) {
    let elapsed_s = elapsed.seconds();
    if !settings.enabled || elapsed_s <= 0.0 {
        return;
    }
    let Some(detection) = detection else {
        let kept = (-elapsed_s / settings.keep_s.max(1e-3)).exp() as f32;
        velocity_px_s.iter_mut().for_each(|velocity| *velocity *= kept);
        return;
    };
    let share = (elapsed_s / settings.settle_s.max(1e-3)).min(1.0);
    let gain = (share * share / elapsed_s) as f32;
    let ((x, y), (u, v)) = (awaited.centre(), detection.centre());
    for (velocity, innovation) in velocity_px_s.iter_mut().zip([u - x, v - y]) {
        *velocity += gain * innovation;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steady_walk_is_learnt_and_forgotten_unseen() {
        let settings = MomentumSettings::default();
        let tick = Span::from_seconds(0.04);
        let mut velocity = [0.0; 2];
        let mut place = 0.0_f32;
        for step in 0..50 {
            let walked = 4.0 * step as f32;
            let detection = Rectangle::new(walked, 50.0, 20.0, 26.0);
            place += velocity[0] * 0.04;
            let awaited = Rectangle::new(place, 50.0, 20.0, 26.0);
            learn(&mut velocity, &awaited, Some(&detection), tick, &settings);
            // What the filter does: it goes a part of the way to the detection.
            place += 0.4 * (walked - place);
        }
        assert!((velocity[0] - 100.0).abs() < 3.0, "{velocity:?}");
        assert!(velocity[1].abs() < 1e-3 && (place - 196.0).abs() < 1.0, "{place}");
        let nowhere = Rectangle::new(0.0, 0.0, 20.0, 26.0);
        for _ in 0..50 {
            learn(&mut velocity, &nowhere, None, tick, &settings);
        }
        assert!(velocity[0] < 3.0);
    }
}
