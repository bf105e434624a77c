//! Bodies: from a hypothesis, whatever its state, to the regions and sound points that cues score.
//!
//! Cues never see states, so the same cue serves systems that think in pictures and systems that think in metres.

mod head_box;
mod upright_ellipse;

pub use head_box::{HeadBox, HeadBoxSettings};
pub use upright_ellipse::{ASPECT, UprightEllipse};

use hearsight_core::{Rectangle, WorldPoint};
use hearsight_filter::Particles;
use serde::{Deserialize, Serialize};

/// A part of a person that a cue may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Crown to chin.
    Head,
    /// Shoulders to waist.
    Torso,
}

impl Part {
    /// Every part, in the order in which appearances are stored.
    pub const ALL: [Self; 2] = [Self::Head, Self::Torso];

    /// Place in [`Part::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// Maps hypotheses of one kind of state into pictures and the room.
pub trait Body: Send + Sync {
    /// Length of a state.
    fn dimensions(&self) -> usize;

    /// The region of one part of one state: an ellipse, given by the box around it.
    fn region(&self, state: &[f32], part: Part) -> Rectangle;

    /// The regions of one part of all hypotheses, `regions` being replaced.
    fn regions(&self, particles: &Particles, part: Part, regions: &mut Vec<Rectangle>);

    /// The mouths of all hypotheses in the world, `points` being replaced. Returns false, leaving `points` empty,
    /// where the body cannot tell (camera without calibration).
    fn sound_points(&self, particles: &Particles, points: &mut Vec<Option<WorldPoint>>) -> bool;

    /// The mouth of one state in the world, where the body can tell.
    fn sound_point(&self, state: &[f32]) -> Option<WorldPoint>;

    /// The state of a person whose head fills this box.
    fn state_from_head(&self, head: &Rectangle, state: &mut [f32]);

    /// How unsure each dimension of a state is that was made from a detected head: standard deviations, as many as there is
    /// room for.
    fn first_deviations(&self, head: &Rectangle, deviations: &mut [f64]) {
        for (deviation, share) in deviations.iter_mut().zip([0.15_f32, 0.15, 0.08, 0.08]) {
            *deviation = f64::from(share * head.width);
        }
    }

    /// The head of a state, as a box in the picture.
    fn head_from_state(&self, state: &[f32]) -> Rectangle {
        self.region(state, Part::Head)
    }
}
