//! Exclusion: two tracks cannot be one person, and whoever is nearer hides whoever is behind.

use crate::belief::Belief;
use hearsight_core::Rectangle;
use hearsight_vision::silhouette::body_zone;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// When two beliefs are one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ExclusionSettings {
    /// Share of the smaller of two heads that lies in the larger from which they are the same place, 0 to 1. Default
    /// 0.5.
    pub overlap: f32,
    /// For how long two published tracks may share a place before the weaker one dies, seconds. Default 1: longer
    /// than people take to pass each other.
    pub patience_s: f64,
    /// For how long a published track may look like a shoulder or an arm of another before it dies, seconds. Default
    /// 0.5. Raising it lets people stand longer right before somebody of their own size.
    pub body_part_s: f64,
    /// The same where it may be somebody hidden behind the other, seconds. Default 2.5.
    pub hidden_s: f64,
    /// By how much later than the other's the part's last detection may be, seconds. Default 1. A person who has not
    /// been seen for longer may have been a wrong one.
    pub fresh_s: f64,
}

impl Default for ExclusionSettings {
    fn default() -> Self {
        Self {
            overlap: 0.5,
            patience_s: 1.0,
            body_part_s: 0.5,
            hidden_s: 2.5,
            fresh_s: 1.0,
        }
    }
}

/// From this ratio of widths on a head right under another is that of somebody in front.
pub(crate) const LARGER: f32 = 1.6;

/// Whether `front` covers the head of `behind`: it is nearer (larger) and overlaps it with head or shoulders.
pub(crate) fn covers(front: &Belief, behind: &Belief) -> bool {
    is_nearer(front, behind)
        && bodies(&front.head_beside(&behind.head))
            .iter()
            .any(|part| part.intersection(&behind.head).area() > 0.4 * behind.head.area())
}

/// Whether `front` is nearer to the camera than `behind`: its head is clearly larger.
pub(crate) fn is_nearer(front: &Belief, behind: &Belief) -> bool {
    front.head.height > 1.15 * behind.head.height
}

/// What a person hides: the head, and the body from the shoulders down.
pub(crate) fn bodies(head: &Rectangle) -> [Rectangle; 2] {
    let (x, _) = head.centre();
    let face = Rectangle::new(
        x - 0.6 * head.width,
        head.top,
        1.2 * head.width,
        1.3 * head.height,
    );
    let trunk = Rectangle::new(
        x - 1.2 * head.width,
        head.top + 1.25 * head.height,
        2.4 * head.width,
        5.0 * head.height,
    );
    [face, trunk]
}

/// How fast the suspicion grows that `part` is a shoulder, an arm or a leg of `whole`, 0 to 1: not at all where it is
/// not under its head, slowly where it may be somebody hidden behind it, quickly where a detection sits on the body or
/// the part is too large to be behind it.
pub(crate) fn body_part_rate(
    part: &Belief,
    part_is_detected: bool,
    whole: &Belief,
    settings: &ExclusionSettings,
) -> f64 {
    let under = whole.identity.is_some()
        && (part.supported - whole.supported).seconds() < settings.fresh_s
        && body_zone(&whole.head_beside(&part.head)).contains(part.head.centre());
    let larger = part.head.width > LARGER * whole.head.width;
    match (under, part_is_detected, larger) {
        // Somebody larger who is detected in front of another's body is a person of their own.
        (false, ..) | (true, true, true) => 0.0,
        (true, true, false) | (true, false, true) => 1.0,
        (true, false, false) => settings.body_part_s / settings.hidden_s.max(settings.body_part_s),
    }
}

/// Whether two beliefs stand at one place: the smaller head lies mostly in the larger.
pub(crate) fn same_place(first: &Belief, second: &Belief, settings: &ExclusionSettings) -> bool {
    let smaller = first.head.area().min(second.head.area());
    first.head.intersection(&second.head_beside(&first.head)).area() >= settings.overlap * smaller
}

/// Which of two beliefs at one place goes: a scout before a track, then the one less supported, then the younger.
pub(crate) fn weaker<'a>(first: &'a Belief, second: &'a Belief) -> &'a Belief {
    let strength = |belief: &Belief| {
        (
            belief.identity.is_some(),
            belief.support,
            std::cmp::Reverse(belief.number),
        )
    };
    if strength(first) < strength(second) {
        first
    } else {
        second
    }
}
