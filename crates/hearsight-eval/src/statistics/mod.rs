//! Statistics of experiments: how sure a mean is, and whether one system is better than another on the same scenes.
//!
//! All of it is deterministic. Differences are always ours less theirs, paired by scene or seed.

mod bootstrap;
mod normal;
mod sign_test;
mod wilcoxon;

pub use bootstrap::{Bootstrap, Interval, bootstrap_mean, bootstrap_ratio_of_means};
pub use sign_test::{SignTest, sign_test};
pub use wilcoxon::{SignedRank, signed_rank};

use thiserror::Error;

/// Which differences the alternative hypothesis expects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alternative {
    /// Other than zero.
    TwoSided,
    /// Above zero.
    Greater,
    /// Below zero.
    Less,
}

/// Why a statistic cannot be computed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum StatisticsError {
    /// Nothing to compute from: run more seeds.
    #[error("{what} needs at least {least} values, found {found}; run more seeds")]
    TooFew {
        /// The statistic.
        what: &'static str,
        /// Values that it needs.
        least: usize,
        /// Values that came.
        found: usize,
    },
    /// A value that is not a finite number: leave out the run that it is of.
    #[error("value {index} of {what} is {found}; leave out that run")]
    NotFinite {
        /// Which values.
        what: &'static str,
        /// Place in them, from 0.
        index: usize,
        /// The value.
        found: f64,
    },
    /// Values that belong together in pairs do not: a mistake of the caller.
    #[error("{first} values are paired with {second}; give as many of one as of the other")]
    NotPaired {
        /// Values of the first kind.
        first: usize,
        /// Values of the second kind.
        second: usize,
    },
    /// An option outside its range.
    #[error("{what} must be {range}, found {found}")]
    OutOfRange {
        /// The option.
        what: &'static str,
        /// Its range in words.
        range: &'static str,
        /// The value that came.
        found: f64,
    },
}

impl StatisticsError {
    fn check(what: &'static str, values: &[f64], least: usize) -> Result<(), Self> {
        if values.len() < least {
            return Err(Self::TooFew {
                what,
                least,
                found: values.len(),
            });
        }
        match values.iter().position(|value| !value.is_finite()) {
            Some(index) => Err(Self::NotFinite {
                what,
                index,
                found: values[index],
            }),
            None => Ok(()),
        }
    }
}
