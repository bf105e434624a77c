//! What can go wrong in the mathematics, sorted by what the caller can do about it.

use thiserror::Error;

/// An error of this crate; nothing was changed when one is returned.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FilterError {
    /// A buffer has the wrong length: a mistake of the caller.
    #[error("{what}: expected a length of {expected}, found {found}")]
    SizeMismatch {
        /// What was measured.
        what: &'static str,
        /// The length that fits.
        expected: usize,
        /// The length that came.
        found: usize,
    },
    /// A dimension or particle that does not exist, or the same one twice: a mistake of the caller.
    #[error("{what} {index} does not exist or is named twice; there are {available}")]
    BadIndex {
        /// What was indexed.
        what: &'static str,
        /// The index that does not fit.
        index: usize,
        /// How many there are.
        available: usize,
    },
    /// A parameter outside its range: correct the configuration.
    #[error("{what} must be {range}, found {found}")]
    OutOfRange {
        /// The parameter.
        what: &'static str,
        /// Its range in words.
        range: &'static str,
        /// The value that came.
        found: f64,
    },
    /// A measurement or matrix that is not finite: drop this measurement and go on.
    #[error("{what} is not finite")]
    NotFinite {
        /// What is not finite.
        what: &'static str,
    },
    /// No weight is positive, so nothing can be drawn: reset the weights or the particles.
    #[error("no weight is positive")]
    NoWeight,
    /// A covariance that cannot be inverted: drop this measurement or enlarge its noise.
    #[error("{what} is not positive definite")]
    NotPositiveDefinite {
        /// The matrix.
        what: &'static str,
    },
}

impl FilterError {
    pub(crate) fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), Self> {
        if expected == found {
            Ok(())
        } else {
            Err(Self::SizeMismatch {
                what,
                expected,
                found,
            })
        }
    }

    /// Passes `found` if it is finite and not negative.
    pub(crate) fn check_not_negative(what: &'static str, found: f64) -> Result<(), Self> {
        if found.is_finite() && found >= 0.0 {
            Ok(())
        } else {
            Err(Self::OutOfRange {
                what,
                range: "finite and not negative",
                found,
            })
        }
    }
}
