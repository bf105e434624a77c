//! The stac system: one camera, perhaps between two microphones; appearance, motion, reverberation-proof audio.
//!
//! Bregonzio, Taj, Cavallaro, "Multi-modal particle filtering tracking using appearance, motion and audio likelihoods".
//! A bootstrap particle filter a person over the head box, the product of the likelihoods of colour, motion and sound.
//! With several cameras it runs on each apart.

mod limits;
mod parameters;

pub use parameters::{Likelihood, Modality, Parameters};

use crate::views::{Ears, Plan, Views, unheard};
use crate::{SystemError, SystemInfo};
use hearsight_core::Rectangle;
use hearsight_core::room::Room;
use hearsight_tracking::body::{HeadBox, Part};
use hearsight_tracking::cues::{ColourCue, Cue, MotionCue, SoundCue};
use hearsight_tracking::fusion::{Calibration, Product, Term};
use hearsight_tracking::percepts::CameraPercepts;
use hearsight_tracking::proposals::{AnywhereProposal, DetectedProposal, RandomWalkProposal};
use hearsight_tracking::sound_map::SoundMap;
use hearsight_tracking::stage::Stage;
use hearsight_tracking::system::System;
use hearsight_tracking::tracker::Composition;
use serde::Deserialize;
use serde_json::Value;

/// What the registry says of this system.
pub(crate) const INFO: SystemInfo = SystemInfo {
    name: "stac",
    summary: "one camera between two microphones: colour, motion and sound in a particle filter a person",
    source: "Bregonzio, Taj, Cavallaro: Multi-modal particle filtering tracking",
    parameters: || schemars::schema_for!(Parameters).to_value(),
    build,
};

fn wrong(reason: impl std::fmt::Display) -> SystemError {
    SystemError::Parameters {
        system: INFO.name,
        reason: reason.to_string(),
    }
}

fn build(parameters: &Value, room: &Room, seed: u64) -> Result<Box<dyn System>, SystemError> {
    let parameters: Parameters = if parameters.is_null() {
        Parameters::default()
    } else {
        Parameters::deserialize(parameters).map_err(wrong)?
    };
    limits::RANGES.check(&serde_json::to_value(&parameters).map_err(wrong)?)?;
    let (audio, warnings) = match parameters.modality {
        Modality::Video => (None, Vec::new()),
        Modality::AudioVisual | Modality::Audio => (Some(parameters.audio), unheard(room)),
    };
    Views::build(INFO.name, room, audio, warnings, |room, camera, ears| {
        plan(&parameters, room, camera, ears, seed)
    })
}

fn plan(
    parameters: &Parameters,
    room: &Room,
    camera: usize,
    ears: &Ears,
    seed: u64,
) -> Result<Plan, SystemError> {
    let sensor = &room.cameras[camera];
    let body = HeadBox::new(parameters.body, sensor.calibration);
    let alone = match parameters.modality {
        Modality::Audio => Some(head_to_hear(&body, room, camera, ears.heard.is_some())?),
        Modality::AudioVisual | Modality::Video => None,
    };
    let composition = Composition {
        body: Box::new(body),
        stages: match parameters.modality {
            Modality::Audio => stages_of_sound(parameters, sensor.width as f64)?,
            Modality::AudioVisual | Modality::Video => stages(parameters)?,
        },
        momentum: parameters.momentum,
        particles: parameters.particles,
        seed,
        role: format!("stac {}", sensor.name),
        association: parameters.association,
        birth: parameters.birth,
        existence: parameters.existence,
        exclusion: parameters.exclusion,
        encounter: parameters.encounter,
        re_entry: parameters.re_entry,
        appearance: parameters.appearance,
        speaker: parameters.speaker,
    };
    Ok(Plan {
        composition,
        seen: CameraPercepts::new(parameters.vision.clone()).map_err(wrong)?,
        alone,
        sound: None,
    })
}

/// The head that is followed by sound alone, in the middle of the picture.
fn head_to_hear(
    body: &HeadBox,
    room: &Room,
    camera: usize,
    has_array: bool,
) -> Result<Rectangle, SystemError> {
    let sensor = &room.cameras[camera];
    let (x, y) = (
        0.5 * sensor.width as f64,
        SoundMap::HEAD_ROW * sensor.height as f64,
    );
    let head = body.at_range(x as f32, y as f32, SoundMap::NOMINAL_RANGE_M);
    head.filter(|_| has_array).ok_or_else(|| SystemError::Room {
        system: INFO.name,
        reason: format!(
            "modality audio follows a column of camera {} by sound; give the camera a calibration and pair an array \
             with it by camera = \"{}\"",
            sensor.name, sensor.name
        ),
    })
}

/// The same filter with the sound's likelihood alone.
fn stages_of_sound(parameters: &Parameters, width_px: f64) -> Result<Vec<Stage>, SystemError> {
    Ok(vec![
        Stage::Propose(Box::new(
            RandomWalkProposal::new(&parameters.transition).map_err(wrong)?,
        )),
        Stage::Propose(Box::new(AnywhereProposal::new(parameters.anywhere, width_px))),
        Stage::Weigh {
            cues: vec![Box::new(SoundCue::default())],
            fusion: Box::new(Product::new(vec![sound_term(parameters)])),
            hidden: parameters.hidden,
        },
        Stage::Resample {
            scheme: parameters.resampling,
            below: 1.0,
        },
    ])
}

fn sound_term(parameters: &Parameters) -> Term {
    let sigma = parameters.sound.sigma;
    Term {
        calibration: if parameters.printed_equation_8 {
            Calibration::PrintedCorrelation { sigma }
        } else {
            Calibration::Correlation { sigma }
        },
        floor: parameters.sound.floor,
        exponent: parameters.sound.exponent,
    }
}

/// Propose, weigh, resample: the bootstrap filter of eqs. 1-6 and 13, resampling at every step.
fn stages(parameters: &Parameters) -> Result<Vec<Stage>, SystemError> {
    let mut cues: Vec<Box<dyn Cue>> = Vec::new();
    let mut terms = Vec::new();
    let mut add = |cue: Box<dyn Cue>, calibration, likelihood: &Likelihood| {
        if likelihood.enabled {
            cues.push(cue);
            terms.push(Term {
                calibration,
                floor: likelihood.floor,
                exponent: likelihood.exponent,
            });
        }
    };
    let colour = |likelihood: &Likelihood| Calibration::Distance {
        sigma: likelihood.sigma,
    };
    add(
        Box::new(ColourCue::new(Part::Head)),
        colour(&parameters.head_colour),
        &parameters.head_colour,
    );
    add(
        Box::new(ColourCue::new(Part::Torso)),
        colour(&parameters.torso_colour),
        &parameters.torso_colour,
    );
    add(
        Box::new(MotionCue::new(parameters.motion_shape)),
        Calibration::Likelihood,
        &parameters.motion,
    );
    add(
        Box::new(SoundCue {
            one_talker: parameters.one_talker,
        }),
        sound_term(parameters).calibration,
        &parameters.sound,
    );
    Ok(vec![
        Stage::Propose(Box::new(
            RandomWalkProposal::new(&parameters.transition).map_err(wrong)?,
        )),
        Stage::Propose(Box::new(DetectedProposal::new(parameters.detected))),
        Stage::Weigh {
            cues,
            fusion: Box::new(Product::new(terms)),
            hidden: parameters.hidden,
        },
        Stage::Resample {
            scheme: parameters.resampling,
            below: 1.0,
        },
    ])
}
