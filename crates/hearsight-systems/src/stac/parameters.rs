//! Parameters of the stac system: what the paper gives, and proposals where it is silent.

use hearsight_filter::Resampling;
use hearsight_tracking::body::HeadBoxSettings;
use hearsight_tracking::cues::MotionSettings;
use hearsight_tracking::life_cycle::{
    AssociationSettings, BirthSettings, EncounterSettings, ExclusionSettings, ExistenceSettings,
    ReEntrySettings,
};
use hearsight_tracking::momentum::MomentumSettings;
use hearsight_tracking::percepts::{ArraySettings, CameraSettings};
use hearsight_tracking::proposals::{DetectedSettings, RandomWalkSettings};
use hearsight_tracking::speaker::SpeakerSettings;
use hearsight_tracking::tracker::AppearanceSettings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// One factor of the product of likelihoods (eq. 13).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Likelihood {
    /// Whether the cue takes part. Default true.
    #[serde(default = "yes")]
    pub enabled: bool,
    /// Width of the likelihood in the unit of the raw score; unused by motion.
    pub sigma: f32,
    /// Smallest log-likelihood, not positive. Raising it lets the other cues overrule this one.
    pub floor: f32,
    /// Exponent of the factor, 0 or more; 1 is the paper's product.
    pub exponent: f32,
}

fn yes() -> bool {
    true
}

/// What the system works with: the paper's experiments with one modality left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Modality {
    /// Pictures, and sound where there is an array.
    #[default]
    AudioVisual,
    /// Pictures alone: the array is not listened to, and nobody is said to speak.
    Video,
    /// Sound alone: pictures are not looked at. One belief is born from the first sound; only its column is estimated,
    /// the rest of its head is a prior. Needs an array and a calibrated camera.
    Audio,
}

/// All parameters, each with its default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Parameters {
    /// What it works with. Default audio_visual. With `audio.onset_filter`, `audio.bands` and `audio.weighting` it makes
    /// the rows of the paper's table 1.
    pub modality: Modality,
    /// Share of the particles that start anew at any column in a step, with modality audio, 0 to 1. Default 0.05.
    pub anywhere: f32,
    /// Particles a person (N_p). Default 200. Raising it follows more surely and takes more time.
    pub particles: usize,
    /// How survivors are drawn. Default systematic.
    #[schemars(with = "String")]
    pub resampling: Resampling,
    /// Random walk of the head box (zero-order motion model).
    pub transition: RandomWalkSettings,
    /// Hypotheses drawn afresh around detections. Not in the paper; `detected.share = 0` is its system.
    pub detected: DetectedSettings,
    /// Log-likelihood of a hypothesis hidden behind somebody nearer, not positive. Default -5: worse than the right
    /// colours in sight, better than the wrong ones.
    pub hidden: f64,
    /// Proportions of a person.
    pub body: HeadBoxSettings,
    /// Likelihood of the head's colours (eq. 9). Default sigma 0.25, floor -8.
    pub head_colour: Likelihood,
    /// Likelihood of the torso's colours (eq. 9). Default sigma 0.35, floor -6: clothing tells people apart, its place
    /// says less about the head.
    pub torso_colour: Likelihood,
    /// Likelihood of nearness to changed regions (eq. 12). Its widths are in `motion_shape`.
    pub motion: Likelihood,
    /// Widths of the motion likelihood.
    pub motion_shape: MotionSettings,
    /// Likelihood of the sound's delay (eq. 8, corrected). Default sigma 0.3, floor -3: echoes must not
    /// outweigh what is seen.
    pub sound: Likelihood,
    /// Use eq. 8 as printed, whose likelihood is lowest at the peak. Default false; to show that it fails.
    pub printed_equation_8: bool,
    /// Every sound draws everyone who is tracked, not only whoever speaks. Default false; the paper follows one person,
    /// whose voice is all there is to hear.
    pub one_talker: bool,
    /// How pictures are looked at.
    #[schemars(with = "Value")]
    pub vision: CameraSettings,
    /// How sound is listened to.
    #[schemars(with = "Value")]
    pub audio: ArraySettings,
    /// How people move on. Not in the paper; `momentum.enabled = false` is its system.
    pub momentum: MomentumSettings,
    /// Which detection belongs to whom.
    pub association: AssociationSettings,
    /// Who becomes a track.
    pub birth: BirthSettings,
    /// Who stays one.
    pub existence: ExistenceSettings,
    /// Who is one with another.
    pub exclusion: ExclusionSettings,
    /// Who is who after a meeting. Not in the paper; a margin of 9 is its system.
    pub encounter: EncounterSettings,
    /// Who comes back. Not in the paper; `re_entry.enabled = false` is its system.
    pub re_entry: ReEntrySettings,
    /// How colours are learnt.
    pub appearance: AppearanceSettings,
    /// Who speaks.
    pub speaker: SpeakerSettings,
}

impl Default for Parameters {
    fn default() -> Self {
        let likelihood = |sigma, floor| Likelihood {
            enabled: true,
            sigma,
            floor,
            exponent: 1.0,
        };
        Self {
            modality: Modality::default(),
            anywhere: 0.05,
            particles: 200,
            resampling: Resampling::Systematic,
            transition: RandomWalkSettings::default(),
            detected: DetectedSettings::default(),
            hidden: -5.0,
            body: HeadBoxSettings::default(),
            head_colour: likelihood(0.25, -8.0),
            torso_colour: likelihood(0.35, -6.0),
            motion: likelihood(1.0, -10.0),
            motion_shape: MotionSettings::default(),
            sound: likelihood(0.3, -3.0),
            printed_equation_8: false,
            one_talker: false,
            vision: CameraSettings::default(),
            audio: ArraySettings::default(),
            momentum: MomentumSettings::default(),
            association: AssociationSettings::default(),
            birth: BirthSettings::default(),
            existence: ExistenceSettings::default(),
            exclusion: ExclusionSettings::default(),
            encounter: EncounterSettings::default(),
            re_entry: ReEntrySettings::default(),
            appearance: AppearanceSettings::default(),
            speaker: SpeakerSettings::default(),
        }
    }
}
