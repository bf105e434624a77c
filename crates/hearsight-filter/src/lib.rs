//! Mathematics of tracking: particles and their resampling, motion models, Kalman filters, mixtures, likeliest paths,
//! assignment, random numbers.
//!
//! Nothing here knows of cameras, microphones or people. Everything is deterministic: random numbers come from a
//! [`Generator`] that the caller derives and saves, and what decides between particles uses only arithmetic that
//! gives the same bits on every machine. Failures are values of [`FilterError`]; what is not finite is set aside and
//! counted.
//!
//! Start at [`Particles`], [`motion`] and [`Resampling`].

mod assignment;
mod elementary;
mod error;
mod gaussian;
mod kalman;
mod log_sum_exp;
mod marginal;
pub mod motion;
mod particles;
mod random;
mod resampling;
mod unscented;
mod viterbi;

pub use assignment::{Assigner, Assignment, Unpaired, assign};
pub use error::FilterError;
pub use gaussian::{Gaussian, Mixture};
pub use kalman::{Innovation, KalmanFilter};
pub use log_sum_exp::log_sum_exp;
pub use marginal::PredictedCloud;
pub use particles::{Normalization, NormalizationOutcome, Particles};
pub use random::{Generator, fill_standard_normal, generator, standard_normal, uniform};
pub use resampling::Resampling;
pub use unscented::{UnscentedForm, UnscentedKalman, UnscentedScratch};
pub use viterbi::{Transitions, Viterbi};
