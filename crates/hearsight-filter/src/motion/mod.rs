//! How states move between two moments.
//!
//! Every model steps by the span that really elapsed, and its noise is that of continuous time, so that one step of
//! `t` and two of `t/2` give the same distribution: a dropped frame or another frame rate changes nothing else.

#[cfg(test)]
mod consistency;
mod constant_velocity;
mod gaussian_step;
mod langevin;
mod random_walk;

pub use constant_velocity::{ConstantVelocity, ConstantVelocityAxis};
pub use gaussian_step::GaussianStep;
pub use langevin::{Langevin, LangevinAxis, LangevinIntegration};
pub use random_walk::{Noise, RandomWalk, RandomWalkDimension};

use crate::error::FilterError;
use crate::particles::Particles;
use crate::random::Generator;
use hearsight_core::Span;

/// A model of motion; which dimensions it moves is part of the model, others stay.
pub trait Motion {
    /// Moves every particle by `elapsed`, with independent noise; weights stay. No time changes nothing.
    ///
    /// # Errors
    /// [`FilterError::BadIndex`] for a dimension that the particles lack, [`FilterError::OutOfRange`] for a negative
    /// span. Nothing has moved then.
    fn step(
        &self,
        particles: &mut Particles,
        elapsed: Span,
        generator: &mut Generator,
    ) -> Result<(), FilterError>;
}

/// How many variates are drawn at once: they stay in the first-level cache.
const BLOCK: usize = 256;

fn elapsed_secs(elapsed: Span) -> Result<f64, FilterError> {
    let seconds = elapsed.seconds();
    FilterError::check_not_negative("the elapsed time in seconds", seconds)?;
    Ok(seconds)
}
