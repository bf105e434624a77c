//! What can go wrong in this crate, by what the caller can do about it.

use thiserror::Error;

/// An error of the audio crate. None of them leaves an object half changed: the call had no effect.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum AudioError {
    /// A setting is out of its range: correct the configuration.
    #[error("{name} must be {rule}, but is {value}")]
    Setting {
        /// Which setting.
        name: &'static str,
        /// What it must be.
        rule: &'static str,
        /// What it is.
        value: f64,
    },
    /// Data do not have the shape agreed on at construction: leave them out, or build anew for the new shape.
    #[error("{what}: expected {expected}, found {found}")]
    Shape {
        /// What is counted.
        what: &'static str,
        /// How many there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A saved state is not one that this configuration could have left: start without it.
    #[error("the saved state does not fit: {what}")]
    State {
        /// What does not fit.
        what: &'static str,
    },
    /// The weighting needs the noise power of both channels and was given none: pass it, or choose another.
    #[error("this weighting needs the noise power of both channels")]
    NoiseMissing,
    /// The Fourier transform refused its buffers.
    #[error("Fourier transform: {0}")]
    Transform(String),
}

impl From<realfft::FftError> for AudioError {
    fn from(error: realfft::FftError) -> Self {
        Self::Transform(error.to_string())
    }
}

/// An error where `found` differs from `expected`.
pub(crate) fn check_shape(what: &'static str, expected: usize, found: usize) -> Result<(), AudioError> {
    if expected == found {
        Ok(())
    } else {
        Err(AudioError::Shape {
            what,
            expected,
            found,
        })
    }
}

/// Most samples, frames or losses that a saved state may have counted: centuries, and far from what integers hold.
pub(crate) const MOST_COUNTED: u64 = 1 << 48;

/// An error where something does not hold that holds of every state this configuration leaves.
pub(crate) fn check_state(holds: bool, what: &'static str) -> Result<(), AudioError> {
    if holds {
        Ok(())
    } else {
        Err(AudioError::State { what })
    }
}

/// An error where a setting breaks its rule; a value that is not a number breaks every rule.
pub(crate) fn check_setting(
    holds: bool,
    name: &'static str,
    rule: &'static str,
    value: f64,
) -> Result<(), AudioError> {
    if holds {
        Ok(())
    } else {
        Err(AudioError::Setting { name, rule, value })
    }
}
