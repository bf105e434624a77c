//! Measured impulse responses instead of simulated ones.

use super::error::{AcousticsError, check};
use std::path::Path;

/// Longest measured response, seconds.
const LONGEST_S: f64 = 20.0;

/// What a microphone hears of an impulse at a source, measured: as if neither moved, whatever the scenario says.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredResponse {
    /// Name of the source.
    pub source: String,
    /// Number of the microphone in its array, from 0.
    pub microphone: usize,
    /// Samples a second: those of the array.
    pub rate_hz: u32,
    /// The response; its first sample belongs to the instant of emission.
    pub samples: Vec<f32>,
}

impl MeasuredResponse {
    /// Reads the responses from one source to all microphones: a WAV file with a channel for each of them.
    ///
    /// # Errors
    /// [`AcousticsError::File`] where the file cannot be read, is empty or longer than 20 s, or has samples that are
    /// not finite.
    pub fn read(path: &Path, source: &str) -> Result<Vec<Self>, AcousticsError> {
        let sound = crate::voice::read_sound(path)?;
        let fail = |reason: String| AcousticsError::File {
            path: path.to_owned(),
            reason,
        };
        let length = sound.channels.first().map_or(0, Vec::len);
        let seconds = length as f64 / f64::from(sound.rate_hz);
        if length == 0 || seconds > LONGEST_S {
            return Err(fail(format!(
                "a response of {seconds:.2} s; it must have samples, and up to 20 s"
            )));
        }
        let response = |(microphone, samples): (usize, Vec<f32>)| Self {
            source: source.to_owned(),
            microphone,
            rate_hz: sound.rate_hz,
            samples,
        };
        Ok(sound.channels.into_iter().enumerate().map(response).collect())
    }

    pub(crate) fn check(&self, rate_hz: u32) -> Result<(), AcousticsError> {
        let entry = || {
            format!(
                "the measured response of source {:?} at microphone {}",
                self.source, self.microphone
            )
        };
        if self.rate_hz != rate_hz {
            return Err(AcousticsError::Rate {
                entry: entry(),
                expected_hz: rate_hz,
                found_hz: self.rate_hz,
            });
        }
        let odd = self.samples.iter().filter(|sample| !sample.is_finite()).count();
        check(
            odd == 0,
            format!("samples that are not finite in {}", entry()),
            "none",
            odd as f64,
        )?;
        let seconds = self.samples.len() as f64 / f64::from(rate_hz);
        check(
            (0.0..=LONGEST_S).contains(&seconds) && !self.samples.is_empty(),
            format!("the length of {}", entry()),
            "above 0 and up to 20 s",
            seconds,
        )
    }

    pub(crate) fn unknown(&self) -> AcousticsError {
        AcousticsError::Setting {
            entry: format!("a measured response of source {:?} at a microphone", self.source),
            rule: "of a source and a microphone that exist",
            value: self.microphone as f64,
        }
    }
}
