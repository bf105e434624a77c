//! Cues: each scores regions or sound points against percepts, one sensor at a time, and returns raw scores.
//!
//! A cue knows nothing of states, weights or other cues; fusion gives its raw scores a meaning. To add one: its own
//! file, its test, and one line in [`REGISTRY`].

mod colour;
mod contour;
mod contrast;
mod curve;
mod motion;
mod sound;

pub use colour::ColourCue;
pub use contour::ContourCue;
pub use contrast::ContrastCue;
pub use curve::{CurveCue, CurveGeometry};
pub use motion::{MotionCue, MotionSettings};
pub use sound::SoundCue;

use crate::belief::Appearance;
use crate::body::Part;
use crate::percepts::{ArrayPercepts, CameraPercepts};
use hearsight_core::{Rectangle, WorldPoint};

/// What a cue says of itself; help and reference documentation are made from this.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CueInfo {
    /// Name as in parameters and reports.
    pub name: &'static str,
    /// What a raw score means.
    pub meaning: &'static str,
    /// Unit of a raw score.
    pub unit: &'static str,
    /// Smallest and largest raw score.
    pub range: (f32, f32),
    /// Whether a larger raw score is better.
    pub larger_is_better: bool,
    /// Where it was published.
    pub source: &'static str,
}

/// Every cue there is.
pub const REGISTRY: &[&CueInfo] = &[
    &colour::INFO,
    &contour::INFO,
    &contrast::INFO,
    &curve::INFO,
    &motion::INFO,
    &sound::INFO,
];

/// What a cue scores hypotheses by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Regions of one part of the body in a picture.
    Regions(Part),
    /// Points in the room from which sound comes.
    Sounds,
}

/// Whether there was anything to score against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evidence {
    /// Every hypothesis has a score.
    Scored,
    /// The modality is missing now: its likelihood is 1 for every hypothesis (stac, section 2.4).
    Missing,
}

/// Hypotheses of one person, as a cue sees them, with the percepts of the sensors of one view.
pub struct Hypotheses<'a> {
    /// Regions, empty where the cue asked for sounds.
    pub regions: &'a [Rectangle],
    /// Sound points, empty where the cue asked for regions.
    pub sounds: &'a [Option<WorldPoint>],
    /// The person's appearance as learnt so far.
    pub appearance: &'a Appearance,
    /// Heads detected now, each with the weight that this person gives it, 0 to 1.
    pub detections: &'a [(Rectangle, f32)],
    /// Probability that the person speaks, 0 to 1.
    pub speaking: f32,
    /// What the camera sees now.
    pub camera: &'a CameraPercepts,
    /// What the array hears now.
    pub array: Option<&'a ArrayPercepts>,
}

/// Scores hypotheses in batches.
pub trait Cue: Send + Sync {
    /// What this cue is.
    fn info(&self) -> &'static CueInfo;

    /// What it wants to be given.
    fn subject(&self) -> Subject;

    /// Whether it has anything to score against now. Where not, its evidence is missing, and nobody need map hypotheses for
    /// it. Default true: [`Cue::score`] says.
    fn has_evidence(&self, _camera: &CameraPercepts, _array: Option<&ArrayPercepts>) -> bool {
        true
    }

    /// Writes one raw score a hypothesis into `scores`.
    fn score(&self, hypotheses: &Hypotheses<'_>, scores: &mut [f32]) -> Evidence;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registered_cues_describe_themselves_and_have_their_own_names() {
        for (place, info) in REGISTRY.iter().enumerate() {
            assert!(!info.meaning.is_empty() && !info.unit.is_empty() && !info.source.is_empty());
            assert!(info.range.0 < info.range.1);
            assert!(REGISTRY[..place].iter().all(|other| other.name != info.name));
        }
    }
}
