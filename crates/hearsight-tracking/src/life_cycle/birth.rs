//! Birth: a detection that belongs to nobody starts a scout; a scout that holds is published.

use super::exclusion::LARGER;
use crate::belief::Belief;
use hearsight_core::{Instant, Rectangle};
use hearsight_vision::silhouette::body_zone;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What it takes to become a track.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct BirthSettings {
    /// For how long detections must have supported a scout, seconds. Default 0.2. Raising it gives fewer false
    /// tracks and later true ones.
    pub support_s: f64,
    /// Probability of existence that a scout must reach, 0 to 1. Default 0.9.
    pub probability: f64,
    /// Share of the body region that must change from picture to picture, in the mean while detections support the
    /// scout, 0 to 1. Default 0.06. People who come move; shadows and shifted chairs do not. A detected face needs no
    /// movement.
    pub stirred: f32,
    /// Ratio by which a head must have grown or shrunk since its scout began to count as movement too, 1 or more; 0 asks for
    /// stirring alone. Default 0. Whoever comes nearer in plain clothes hardly changes from picture to picture, and
    /// neither shadows nor chairs grow.
    pub grown: f32,
    /// Share of the torso that must be inside the picture before a scout is published, so that its clothing is known
    /// first, 0 to 1. Default 0.5. Not waited for longer than `patience_s`.
    pub torso_inside: f32,
    /// Longest wait for the torso, seconds. Default 0.8.
    pub patience_s: f64,
    /// Probability of speaking from which a scout is published at once, as soon as it is likelier than not that there
    /// is a person, and that an unseen talker at the place of a detection must have for it to start a scout in spite of
    /// `score` and `margin`, 0 to 1. Default 0.5. Shadows and shoulders do not talk.
    pub talking: f64,
    /// Least score of a detection that starts a scout. Default 0.45.
    pub score: f32,
    /// Largest share of change in the area above and beside a head (three heads wide, two high) at which it can start
    /// a scout, 0 to 1. Default 0.15. A shoulder, an elbow or a knee has a head above it.
    pub crowded: f32,
    /// Distance of a head from the picture's left and right edge at which it can start a scout, head widths. Default
    /// 0.3. Nearer to the edge an arm or a half of a body looks like a head.
    pub margin: f32,
    /// Whether a face alone makes a person, without movement, further support or a torso. Default false.
    pub face_suffices: bool,
    /// Most scouts at a time. Default 6.
    pub most_scouts: usize,
}

impl Default for BirthSettings {
    fn default() -> Self {
        Self {
            support_s: 0.2,
            probability: 0.9,
            stirred: 0.06,
            grown: 0.0,
            torso_inside: 0.5,
            patience_s: 0.8,
            talking: 0.5,
            score: 0.45,
            crowded: 0.15,
            margin: 0.3,
            face_suffices: false,
            most_scouts: 6,
        }
    }
}

/// The area above and beside a head: empty, unless the head is a part of somebody's body.
pub(crate) fn surroundings(head: &Rectangle) -> Rectangle {
    let (x, _) = head.centre();
    Rectangle::new(
        x - 1.5 * head.width,
        head.top - 2.1 * head.height,
        3.0 * head.width,
        2.0 * head.height,
    )
}

/// Whether a head is far enough from the left and right edge of a picture of this width.
pub(crate) fn is_clear_of_edges(head: &Rectangle, width: usize, settings: &BirthSettings) -> bool {
    let margin = settings.margin * head.width;
    head.left >= margin && head.right() <= width as f32 - margin
}

/// Whether a detection that belongs to nobody may start a scout: not on the body of somebody who is published.
pub(crate) fn may_begin(detection: &Rectangle, beliefs: &[Belief], settings: &BirthSettings) -> bool {
    let scouts = beliefs.iter().filter(|belief| belief.identity.is_none()).count();
    scouts < settings.most_scouts
        && !beliefs.iter().any(|belief| {
            let head = belief.head_beside(detection);
            let smaller = head.area().min(detection.area());
            let same_place = head.intersection(detection).area() > 0.3 * smaller;
            let part_of_body = belief.identity.is_some()
                && !belief.occluded
                && detection.width < LARGER * belief.head.width
                && body_zone(&head).contains(detection.centre());
            same_place || part_of_body
        })
}

/// Whether a scout has earned its publication. `torso_inside` is the share of its torso in the picture.
pub(crate) fn may_publish(
    belief: &Belief,
    now: Instant,
    torso_inside: f32,
    settings: &BirthSettings,
) -> bool {
    let talks = belief.speaking >= settings.talking && belief.existence.probability() > 0.5;
    let likely = belief.existence.probability() >= settings.probability;
    let stirred = belief.stirred_s >= f64::from(settings.stirred) * belief.support.seconds();
    let held = belief.support.seconds() >= settings.support_s
        && likely
        && (stirred || has_grown(belief, settings))
        && (torso_inside >= settings.torso_inside || (now - belief.born).seconds() >= settings.patience_s);
    held || talks || (likely && settings.face_suffices && belief.face_seen)
}

/// Whether the head has become so much larger or smaller since its scout began that somebody came or went.
fn has_grown(belief: &Belief, settings: &BirthSettings) -> bool {
    let (now, then) = (belief.head.height, belief.born_height_px);
    settings.grown >= 1.0 && now.max(then) >= settings.grown * now.min(then)
}
