//! What Hearsight hears with: from samples of an array to delays, onsets and voice activity.
//!
//! This crate knows samples and spectra, not rooms: of microphones it sees spacings and baselines, and places in
//! [`steered_response`] alone; never particles or tracks. Every
//! object owns its buffers and reuses them; a steady run allocates nothing a frame. What must survive a restart
//! (framing, resampling, noise floors, onsets, activity) is serializable and goes on with the same bytes.
//!
//! The usual way of the data:
//!
//! 1. [`resample::Resampler`] brings every channel to 12 kHz, time stamps compensated.
//! 2. [`frames::Framer`] cuts blocks of any length into overlapping frames with their exact instants.
//! 3. [`spectrum::SpectrumAnalyzer`] transforms each channel once; all pairs share the spectra.
//! 4. [`noise::NoiseFloor`] follows the noise, [`onset::OnsetFilter`] picks the frames that reverberation has not
//!    reached yet, [`direct::DirectShare`] the frequencies, [`activity::ActivityDetector`] says whether anybody speaks.
//! 5. [`correlation::Correlator`] gives the generalized cross-correlation of a pair; [`bands::BandBank`] splits it
//!    into bands, and [`agreement::Agreement`] combines them where they agree.
//! 6. [`bearing`] turns the delay of a pair into an angle and a column, [`steered`] the correlations of many pairs into an
//!    azimuth, [`steered_response`] into scores of any points in the room.
//!
//! Convention: the correlation of a pair (i, j) is that of X_i X_j*, and its delay is t_i - t_j in seconds: positive
//! where microphone i hears later than j.

pub mod activity;
pub mod agreement;
pub mod bands;
pub mod bearing;
pub mod coherence;
pub mod correlation;
pub mod curve;
pub mod direct;
mod error;
pub mod frames;
pub mod levels;
pub mod noise;
pub mod onset;
pub mod resample;
pub mod spectrum;
pub mod steered;
pub mod steered_response;
mod timeline;
pub mod weighting;

pub use error::AudioError;
/// A complex number of two `f32`.
pub type Complex = realfft::num_complex::Complex<f32>;
