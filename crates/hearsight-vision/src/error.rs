//! What can be wrong with pictures and parameters handed to this crate.

use thiserror::Error;

/// A picture or parameter that cannot be used. Nothing was changed when it is returned.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum VisionError {
    /// Two pictures that belong together differ in size; drop the picture or start anew with the new size.
    #[error("a picture of {found_width} x {found_height} pixels where {width} x {height} are expected")]
    Size {
        /// Expected pixels a row.
        width: usize,
        /// Expected rows.
        height: usize,
        /// Found pixels a row.
        found_width: usize,
        /// Found rows.
        found_height: usize,
    },
    /// A parameter outside its range; correct the configuration.
    #[error("{name} is {value}, allowed is {allowed}")]
    Parameter {
        /// The parameter's name.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What is allowed, in words.
        allowed: &'static str,
    },
}

impl VisionError {
    /// `Ok` where both sizes (width, height) are the same.
    pub(crate) fn same_size(expected: (usize, usize), found: (usize, usize)) -> Result<(), Self> {
        if expected == found {
            return Ok(());
        }
        Err(Self::Size {
            width: expected.0,
            height: expected.1,
            found_width: found.0,
            found_height: found.1,
        })
    }

    /// `Ok` where `value` is within `low..=high`; not a number is outside.
    pub(crate) fn within(
        name: &'static str,
        value: f64,
        low: f64,
        high: f64,
        allowed: &'static str,
    ) -> Result<(), Self> {
        if value >= low && value <= high {
            Ok(())
        } else {
            Err(Self::Parameter { name, value, allowed })
        }
    }
}
