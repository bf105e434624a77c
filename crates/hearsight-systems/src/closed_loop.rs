//! The closed-loop system: a contour, a colour and a sound tracker a person, fused by a particle filter that tells them
//! how they did.
//!
//! Chen, Rui, "Real-time speaker tracking using particle filter sensor fusion". Trackers propose, verifiers judge, the
//! fuser mixes and adapts; faces start trackers. Every part can be switched off, so that contour alone, colour alone, sound
//! alone, CONDENSATION and the open loop are parameters of one program. With several cameras it runs on each apart.

mod limits;
mod parameters;

pub use parameters::{Faces, Parameters, SoundRule, Verifier, Verifiers};

use crate::views::{Ears, Plan, Views, unheard};
use crate::{SystemError, SystemInfo};
use hearsight_core::camera::Camera;
use hearsight_core::room::{ArraySensor, Room};
use hearsight_tracking::body::{Part, UprightEllipse};
use hearsight_tracking::closed_loop::{Fuser, SoundGeometry, SoundTracker};
use hearsight_tracking::cues::{ColourCue, ContourCue, ContrastCue, Cue, CurveCue, CurveGeometry};
use hearsight_tracking::fusion::{Calibration, Product, Term};
use hearsight_tracking::percepts::{CameraPercepts, PairBearing};
use hearsight_tracking::stage::Stage;
use hearsight_tracking::system::System;
use hearsight_tracking::tracker::Composition;
use serde::Deserialize;
use serde_json::Value;

/// What the registry says of this system.
pub(crate) const INFO: SystemInfo = SystemInfo {
    name: "closed-loop",
    summary: "contour, colour and sound trackers a person, fused by a particle filter that tells them how they did",
    source: "Chen, Rui: Real-time speaker tracking using particle filter sensor fusion",
    parameters: || schemars::schema_for!(Parameters).to_value(),
    build,
};

fn wrong(reason: impl std::fmt::Display) -> SystemError {
    SystemError::Parameters {
        system: INFO.name,
        reason: reason.to_string(),
    }
}

/// Lays what was given over the defaults of this system, which are not those of its parts. A table with a key that the
/// default has not (another variant, or a slip) replaces it, and is judged when it is read.
fn lay_over(under: &mut Value, over: &Value) {
    match (under, over) {
        (Value::Object(under), Value::Object(over)) if over.keys().all(|key| under.contains_key(key)) => {
            for (key, value) in over {
                if let Some(under) = under.get_mut(key) {
                    lay_over(under, value);
                }
            }
        }
        (under, over) => *under = over.clone(),
    }
}

fn read(given: &Value) -> Result<Parameters, SystemError> {
    let mut all = serde_json::to_value(Parameters::default()).map_err(wrong)?;
    if !given.is_null() {
        lay_over(&mut all, given);
    }
    Parameters::deserialize(&all).map_err(wrong)
}

fn build(given: &Value, room: &Room, seed: u64) -> Result<Box<dyn System>, SystemError> {
    let parameters = read(given)?;
    limits::RANGES.check(&serde_json::to_value(&parameters).map_err(wrong)?)?;
    Views::build(
        INFO.name,
        room,
        Some(parameters.audio),
        unheard(room),
        |room, camera, ears| plan(&parameters, room, camera, ears, seed),
    )
}

fn plan(
    parameters: &Parameters,
    room: &Room,
    camera: usize,
    ears: &Ears,
    seed: u64,
) -> Result<Plan, SystemError> {
    let sensor = &room.cameras[camera];
    let pair = match (&ears.array, parameters.sound_rule) {
        (Some((index, _)), SoundRule::Pair | SoundRule::Printed) => Some(pair_bearing(
            &room.arrays[*index],
            sensor.calibration.as_ref(),
            room.speed_of_sound_m_s,
        )?),
        _ => None,
    };
    let geometry = match pair {
        Some(pair) => Some(SoundGeometry::Pair(pair)),
        None => ears.map.clone().map(SoundGeometry::World),
    };
    let tracker = |geometry| SoundTracker::new(parameters.fuser.sound, geometry, sensor.width as f64);
    let composition = Composition {
        body: Box::new(UprightEllipse::new(parameters.body, sensor.calibration)),
        stages: vec![stage(parameters, geometry.clone().map(tracker), pair)?],
        momentum: parameters.momentum,
        particles: parameters.particles,
        seed,
        role: format!("closed-loop {}", sensor.name),
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
        seen: CameraPercepts::new(parameters.camera()).map_err(wrong)?,
        alone: None,
        sound: geometry.map(tracker),
    })
}

/// The paper's geometry: spacing and field of view.
fn pair_bearing(
    array: &ArraySensor,
    camera: Option<&Camera>,
    speed_m_s: f64,
) -> Result<PairBearing, SystemError> {
    let room = |reason: &str| SystemError::Room {
        system: INFO.name,
        reason: reason.into(),
    };
    let [first, second, ..] = array.microphones.as_slice() else {
        return Err(room("the array has fewer than two microphones with known places"));
    };
    let camera =
        camera.ok_or_else(|| room("`sound_rule` needs the camera's calibration for its field of view"))?;
    let view_rad = camera
        .horizontal_field_of_view_rad()
        .ok_or_else(|| room("the camera's lens has no field of view"))?;
    PairBearing::new(
        first.distance_m(*second),
        speed_m_s,
        camera.width as f64,
        view_rad,
    )
    .map_err(wrong)
}

/// The loop: trackers and mixture, verifiers and their product (eq. 9), feedback.
fn stage(
    parameters: &Parameters,
    sound: Option<SoundTracker>,
    pair: Option<PairBearing>,
) -> Result<Stage, SystemError> {
    let mut verifiers: Vec<Box<dyn Cue>> = Vec::new();
    let mut terms = Vec::new();
    let mut add = |cue: Box<dyn Cue>, calibration, verifier: &Verifier| {
        if verifier.enabled {
            verifiers.push(cue);
            terms.push(Term {
                calibration,
                floor: verifier.floor,
                exponent: verifier.exponent,
            });
        }
    };
    let fuser = &parameters.fuser;
    add(
        Box::new(ContourCue),
        Calibration::Logarithm,
        &parameters.verifiers.contour,
    );
    add(
        Box::new(ContrastCue),
        Calibration::Likelihood,
        &parameters.verifiers.colour,
    );
    let geometry = match (parameters.sound_rule, pair) {
        (SoundRule::Pair, Some(pair)) => CurveGeometry::Pair(pair),
        (SoundRule::Printed, Some(pair)) => CurveGeometry::Printed(pair),
        _ => CurveGeometry::World,
    };
    add(
        Box::new(CurveCue::new(geometry)),
        Calibration::Likelihood,
        &parameters.verifiers.sound,
    );
    add(
        Box::new(ColourCue::new(Part::Head)),
        Calibration::Distance { sigma: 0.25 },
        &parameters.verifiers.likeness,
    );
    Ok(Stage::Loop {
        fuser: Box::new(Fuser::new(fuser.clone(), sound).map_err(wrong)?),
        verifiers,
        fusion: Box::new(Product::new(terms)),
        hidden: parameters.hidden,
    })
}
