//! Parameters of the closed-loop system: what the paper gives, and proposals where it is silent.

use hearsight_tracking::body::{ASPECT, HeadBoxSettings};
use hearsight_tracking::closed_loop::FuserSettings;
use hearsight_tracking::life_cycle::{
    AssociationSettings, BirthSettings, EncounterSettings, ExclusionSettings, ExistenceSettings,
    ReEntrySettings,
};
use hearsight_tracking::momentum::MomentumSettings;
use hearsight_tracking::percepts::{
    ArraySettings, CameraSettings, FaceCascade, FaceSettings, Mirror, OutlineOptions, Weighting,
};
use hearsight_tracking::speaker::SpeakerSettings;
use hearsight_tracking::tracker::AppearanceSettings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// One verifier (eqs. 20-24).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Verifier {
    /// Whether it takes part.
    pub enabled: bool,
    /// Exponent of its likelihood, 0 or more. Raising it makes it sharper against the others.
    pub exponent: f32,
    /// Smallest log-likelihood before the exponent, not positive: what a hypothesis loses at most.
    pub floor: f32,
}

/// The verifiers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Verifiers {
    /// Edges on the outline (eq. 20). The exponent is the number of lines that count as independent. Default 6 of 24.
    pub contour: Verifier,
    /// Lines of each outline that are read, 4 to 256. Default 16.
    pub contour_lines: usize,
    /// Contrast to the surroundings (eq. 22). Default exponent 6: the printed form is nearly flat.
    pub colour: Verifier,
    /// Height of the correlation curve (eqs. 23-24). Default exponent 2, floor -3.
    pub sound: Verifier,
    /// Likeness of the head's colours to those learnt, -d^2 / (2 0.25^2) of the Bhattacharyya distance d. Default exponent 2,
    /// floor -8. Not in the paper, whose verifiers know no person: shelves and posters have edges and contrast too, and so
    /// have other people.
    pub likeness: Verifier,
}

impl Default for Verifiers {
    fn default() -> Self {
        let on = |exponent, floor| Verifier {
            enabled: true,
            exponent,
            floor,
        };
        Self {
            contour: on(6.0, 0.0),
            contour_lines: 16,
            colour: on(6.0, -2.0),
            sound: on(2.0, -3.0),
            likeness: on(2.0, -8.0),
        }
    }
}

/// How sound and picture belong together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SoundRule {
    /// By the measured places of camera and microphones.
    #[default]
    World,
    /// By spacing and field of view, the camera midway between the microphones: equations 19 and 24, corrected.
    Pair,
    /// The same with equation 24 as printed: everybody on the left is heard on the right.
    Printed,
}

/// The search for faces that people are born from: frontal and both profiles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Faces {
    /// Cascades. Default: frontal (alt2) and profile, which looks both ways, of Debian's `opencv-data`.
    #[schemars(with = "Value")]
    pub cascades: Vec<FaceCascade>,
    /// Time from one search to the next, seconds, above 0. Default 1; the paper's system searched every 10.
    pub period_s: f64,
    /// Smallest face, pixels. Default 20.
    pub smallest_px: u32,
    /// A face needs more windows than this around it. Default 4.
    pub neighbours: u32,
}

impl Default for Faces {
    fn default() -> Self {
        let cascade = |name: &str, mirror| FaceCascade {
            file: format!("/usr/share/opencv4/haarcascades/{name}.xml").into(),
            mirror,
        };
        Self {
            cascades: vec![
                cascade("haarcascade_frontalface_alt2", Mirror::No),
                cascade("haarcascade_profileface", Mirror::Both),
            ],
            period_s: 1.0,
            smallest_px: 20,
            neighbours: 4,
        }
    }
}

/// All parameters, each with its default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Parameters {
    /// Particles a person. Default 100; 200 were no better on 28 simulated heads and a recording.
    pub particles: usize,
    /// Trackers, mixture, weights and feedback.
    pub fuser: FuserSettings,
    /// The verifiers.
    pub verifiers: Verifiers,
    /// How sound and picture belong together. Default `world`.
    pub sound_rule: SoundRule,
    /// The search for faces.
    pub faces: Faces,
    /// Whether people are also born from changed regions and judged by change. Default true: cascades seldom find small
    /// faces, and none that look away. Not in the paper; false is its system, in which faces alone start trackers. Faces
    /// count where nothing changed too (`vision.faces.changed` is 0): people who sit there from the first picture on are
    /// background.
    pub changes: bool,
    /// Log-likelihood of a hypothesis hidden behind somebody nearer, not positive. Default -3.
    pub hidden: f64,
    /// Proportions of a person.
    pub body: HeadBoxSettings,
    /// How pictures are looked at; what is said of faces, changes and outlines there stands above.
    #[schemars(with = "Value")]
    pub vision: CameraSettings,
    /// How sound is listened to. Default: the weighting of maximum likelihood and phase transform together (Rui and
    /// Florêncio 2003), the whole spectrum at once, every frame with sound, the noise of fans taken out.
    #[schemars(with = "Value")]
    pub audio: ArraySettings,
    /// How people move on where nothing else says so. Default off: velocities are part of the state here.
    pub momentum: MomentumSettings,
    /// Which detection belongs to whom.
    pub association: AssociationSettings,
    /// Who becomes a track.
    pub birth: BirthSettings,
    /// Who stays one.
    pub existence: ExistenceSettings,
    /// Who is one with another.
    pub exclusion: ExclusionSettings,
    /// Who is who after a meeting. Not in the paper.
    pub encounter: EncounterSettings,
    /// Who comes back. Not in the paper; `re_entry.enabled = false` is its system.
    pub re_entry: ReEntrySettings,
    /// How colours are learnt at detections.
    pub appearance: AppearanceSettings,
    /// Who speaks.
    pub speaker: SpeakerSettings,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            particles: 100,
            fuser: FuserSettings::default(),
            verifiers: Verifiers::default(),
            sound_rule: SoundRule::default(),
            faces: Faces::default(),
            changes: true,
            hidden: -3.0,
            body: HeadBoxSettings::default(),
            vision: CameraSettings {
                faces: FaceSettings {
                    changed: 0.0,
                    ..FaceSettings::default()
                },
                ..CameraSettings::default()
            },
            audio: ArraySettings {
                weighting: Weighting::MaximumLikelihood { reverberation: 0.3 },
                bands: false,
                onset_filter: false,
                subtract_noise: true,
                ..ArraySettings::default()
            },
            momentum: MomentumSettings {
                enabled: false,
                ..MomentumSettings::default()
            },
            association: AssociationSettings::default(),
            birth: BirthSettings {
                face_suffices: true,
                grown: 1.5,
                most_scouts: 12,
                ..BirthSettings::default()
            },
            // A face is seen once a period, and then it counts at once.
            existence: ExistenceSettings {
                detected: 40.0,
                present: -0.3,
                verified: 2.0,
                refuted: -2.5,
                ..ExistenceSettings::default()
            },
            exclusion: ExclusionSettings::default(),
            encounter: EncounterSettings::default(),
            re_entry: ReEntrySettings::default(),
            appearance: AppearanceSettings::default(),
            speaker: SpeakerSettings::default(),
        }
    }
}

impl Parameters {
    /// How each camera looks.
    pub(super) fn camera(&self) -> CameraSettings {
        CameraSettings {
            faces: FaceSettings {
                cascades: self.faces.cascades.clone(),
                period_s: self.faces.period_s,
                smallest_px: self.faces.smallest_px,
                neighbours: self.faces.neighbours,
                ..self.vision.faces.clone()
            },
            changes: self.changes,
            outlines: true,
            outline: OutlineOptions {
                line: self.fuser.contour.line,
                lines: self.verifiers.contour_lines,
                least_strength: self.fuser.contour.edges.least_strength,
                aspect: ASPECT,
            },
            ..self.vision.clone()
        }
    }
}
