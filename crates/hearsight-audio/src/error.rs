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
