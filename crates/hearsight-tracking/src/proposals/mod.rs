//! Proposals: where hypotheses are drawn from. To add one: its own file, its test, one line here.

mod anywhere;
mod detected;
mod random_walk;

pub use anywhere::AnywhereProposal;
pub use detected::{DetectedProposal, DetectedSettings};
pub use random_walk::{RandomWalkProposal, RandomWalkSettings};

use hearsight_core::{Rectangle, Span};
use hearsight_filter::{FilterError, Generator, Particles};

/// Draws the hypotheses of the next moment from those of this one.
pub trait Proposal: Send + Sync {
    /// Name for reports.
    fn name(&self) -> &'static str;

    /// Moves every particle by what may happen in `elapsed`. `detections` are the heads that belong to the person.
    /// Where the density drawn from is not the transition density, the logarithmic weights are corrected by their
    /// ratio.
    ///
    /// # Errors
    /// [`FilterError`] where the particles have not the dimensions that this proposal moves; they are unchanged then.
    fn propose(
        &self,
        particles: &mut Particles,
        elapsed: Span,
        detections: &[(Rectangle, f32)],
        generator: &mut Generator,
    ) -> Result<(), FilterError>;
}
