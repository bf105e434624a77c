//! Noise that comes from somewhere, as both ways of the sound take it out: see [`NoiseCoherence`].

use hearsight_audio::AudioError;
use hearsight_audio::coherence::NoiseCoherence;

/// For how long the direction of noise is remembered, seconds of noise.
pub(super) const NOISE_MEMORY_S: f64 = 2.0;

/// The first pair, where there is no fan of pairs.
pub(super) const FIRST_PAIR: [[usize; 2]; 1] = [[0, 1]];

/// Checks a saved coherence of the noise against that of the settings.
pub(super) fn check_coherence(
    own: Option<&NoiseCoherence>,
    saved: Option<&NoiseCoherence>,
) -> Result<(), AudioError> {
    match (own, saved) {
        (Some(own), Some(saved)) => own.check_saved(saved),
        (None, None) => Ok(()),
        _ => Err(AudioError::State {
            what: "whether noise is subtracted",
        }),
    }
}

/// The mean of two spectra of powers.
pub(super) fn mean_into([first, second]: [&[f32]; 2], mean: &mut Vec<f32>) {
    mean.clear();
    mean.extend(
        first
            .iter()
            .zip(second)
            .map(|(first, second)| 0.5 * (first + second)),
    );
}
