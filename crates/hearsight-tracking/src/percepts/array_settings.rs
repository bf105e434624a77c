//! How a microphone array is listened to.

use super::direction::DirectionSettings;
use hearsight_audio::AudioError;
use hearsight_audio::activity::ActivitySettings;
use hearsight_audio::agreement::AgreementSettings;
use hearsight_audio::noise::NoiseSettings;
use hearsight_audio::onset::OnsetSettings;
use hearsight_audio::weighting::Weighting;
use serde::{Deserialize, Serialize};

/// Which pairs of an array are listened to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pairs {
    /// The first two microphones: curves over their delay, seconds.
    #[default]
    First,
    /// All pairs together: curves over the azimuth around the array, radians, once all round. Needs three microphones that
    /// do not lie in one line. Correlations are of the whole spectrum.
    All,
}

/// How an array's sound is listened to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ArraySettings {
    /// Length of a frame, seconds, 0.01 to 1. Default 0.128: many times the greatest delay, short against walking.
    /// Raising it makes peaks surer and more of it reverberation. The paper does not say.
    pub frame_s: f64,
    /// Time from one frame to the next, seconds, 0.001 to `frame_s`. Default 0.02.
    pub hop_s: f64,
    /// How much each frequency counts. Default: noise-regularized with gamma 0.3 (stac, eq. 7 corrected).
    pub weighting: Weighting,
    /// Whether the correlation is taken in three bands whose peaks must agree. Default true.
    pub bands: bool,
    /// Whether frames that reverberation has caught up with are left out. Default true; false takes every frame.
    pub onset_filter: bool,
    /// What the agreement of bands is.
    pub agreement: AgreementSettings,
    /// How the noise floor is followed.
    pub noise: NoiseSettings,
    /// What an onset is.
    pub onset: OnsetSettings,
    /// When sound counts as voice.
    pub activity: ActivitySettings,
    /// From where the sound comes that decides who speaks.
    pub direction: DirectionSettings,
    /// Which pairs are listened to. Default `first`.
    pub pairs: Pairs,
    /// Whether noise that comes from somewhere, such as that of a fan, is taken out of the cross-spectra. Default false. With
    /// it such noise is not heard between the sounds of speech; where microphones move it does harm.
    pub subtract_noise: bool,
}

impl Default for ArraySettings {
    fn default() -> Self {
        Self {
            frame_s: 0.128,
            hop_s: 0.02,
            weighting: Weighting::NoiseRegularized { gamma: 0.3 },
            bands: true,
            onset_filter: true,
            agreement: AgreementSettings::default(),
            noise: NoiseSettings::default(),
            onset: OnsetSettings::default(),
            activity: ActivitySettings::default(),
            direction: DirectionSettings::default(),
            pairs: Pairs::First,
            subtract_noise: false,
        }
    }
}

impl ArraySettings {
    /// Checks the lengths that memory and time are spent by; the parts check their own settings.
    pub(super) fn check(&self) -> Result<(), AudioError> {
        let lengths = [
            ("frame_s", self.frame_s, 0.01..=1.0, "within 0.01 and 1"),
            ("hop_s", self.hop_s, 0.001..=1.0, "within 0.001 and 1"),
        ];
        for (name, value, range, rule) in lengths {
            if !range.contains(&value) {
                return Err(AudioError::Setting { name, rule, value });
            }
        }
        Ok(())
    }
}
