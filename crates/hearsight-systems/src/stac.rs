//! The stac system: one camera, perhaps between two microphones; appearance, motion, reverberation-proof audio.
//!
//! Bregonzio, Taj, Cavallaro, "Multi-modal particle filtering tracking using appearance, motion and audio likelihoods".
//! A bootstrap particle filter a person over the head box, the product of the likelihoods of colour, motion and sound.
//! With several cameras it runs on each apart.

mod limits;
mod parameters;

pub use parameters::{Likelihood, Modality, Parameters};

use crate::{SystemError, SystemInfo, parallel};
use hearsight_core::finite::is_finite;
use hearsight_core::record::{
    BoxRecord, SCENE_SCHEMA_VERSION, Scene, SoundRecord, TrackPhase, TrackRecord, ViewRecord,
};
use hearsight_core::room::{ArraySensor, Room};
use hearsight_core::{Instant, Moment, Rectangle, Span};
use hearsight_tracking::body::{HeadBox, Part};
use hearsight_tracking::cues::{ColourCue, Cue, MotionCue, SoundCue};
use hearsight_tracking::fusion::{Calibration, Product, Term};
use hearsight_tracking::percepts::{ArrayPercepts, ArrayState, CameraPercepts, CameraState};
use hearsight_tracking::proposals::{AnywhereProposal, DetectedProposal, RandomWalkProposal};
use hearsight_tracking::sound_map::SoundMap;
use hearsight_tracking::stage::Stage;
use hearsight_tracking::system::{StateError, System};
use hearsight_tracking::tracker::{Composition, MOST_NUMBERED, ViewState, ViewTracker};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::time::{Duration, Instant as Clock};

/// What the registry says of this system.
pub(crate) const INFO: SystemInfo = SystemInfo {
    name: "stac",
    summary: "one camera between two microphones: colour, motion and sound in a particle filter a person",
    source: "Bregonzio, Taj, Cavallaro: Multi-modal particle filtering tracking",
    parameters: || schemars::schema_for!(Parameters).to_value(),
    build,
};

/// One camera with the array paired to it.
struct View {
    camera: usize,
    name: String,
    array: Option<(usize, String)>,
    seen: CameraPercepts,
    heard: Option<ArrayPercepts>,
    tracker: ViewTracker,
    /// The head that is followed by sound alone, but for its column.
    alone: Option<Rectangle>,
    width_px: f32,
    map: Option<SoundMap>,
    strip: Vec<f32>,
    frame: u64,
    looked: Duration,
    listened: Duration,
    tracked: Duration,
}

/// The system.
pub struct Stac {
    views: Vec<View>,
    warnings: Vec<String>,
    next_identity: u64,
    last: Option<Instant>,
}

#[derive(Serialize, Deserialize)]
struct Saved {
    next_identity: u64,
    last: Option<Instant>,
    views: Vec<SavedView>,
}

#[derive(Serialize, Deserialize)]
struct SavedView {
    camera: CameraState,
    array: Option<ArrayState>,
    tracker: ViewState,
    frame: u64,
}

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
    limits::check(&serde_json::to_value(&parameters).map_err(wrong)?)?;
    if room.cameras.is_empty() {
        return Err(SystemError::Room {
            system: INFO.name,
            reason: "there is no camera; add a [[camera]] to the room".into(),
        });
    }
    let views: Result<Vec<View>, SystemError> = (0..room.cameras.len())
        .map(|camera| build_view(&parameters, room, camera, seed))
        .collect();
    Ok(Box::new(Stac {
        views: views?,
        warnings: match parameters.modality {
            Modality::Video => Vec::new(),
            Modality::AudioVisual | Modality::Audio => warnings(room),
        },
        next_identity: 0,
        last: None,
    }))
}

/// Whether the delays of an array can be told: two microphones with known places.
fn is_placed(array: &ArraySensor) -> bool {
    array.microphones.len() >= 2
}

/// What cannot be done with the sensors of a room: everybody is still tracked by what is seen.
fn warnings(room: &Room) -> Vec<String> {
    let mut warnings = Vec::new();
    for array in &room.arrays {
        let Some(camera) = array.camera.and_then(|camera| room.cameras.get(camera)) else {
            continue;
        };
        if !is_placed(array) {
            warnings.push(format!(
                "array `{}` is not listened to, nobody is said to speak: the places of two microphones must be known; \
                 give `microphones = [[x, y, z], ...]` in metres in [[array]]",
                array.name
            ));
        } else if camera.calibration.is_none() {
            warnings.push(format!(
                "who speaks to array `{}` is told by time alone, not by place: camera `{}` has no calibration; give \
                 `calibration` in [[camera]]",
                array.name, camera.name
            ));
        }
    }
    warnings
}

fn build_view(parameters: &Parameters, room: &Room, camera: usize, seed: u64) -> Result<View, SystemError> {
    let sensor = &room.cameras[camera];
    let paired = match parameters.modality {
        Modality::Video => None,
        Modality::AudioVisual | Modality::Audio => room
            .arrays
            .iter()
            .position(|array| array.camera == Some(camera) && is_placed(array)),
    };
    let array = paired.map(|index| (index, room.arrays[index].name.clone()));
    let heard = paired
        .map(|index| ArrayPercepts::new(parameters.audio, &room.arrays[index], room.speed_of_sound_m_s))
        .transpose()
        .map_err(wrong)?;
    let map = match (&heard, &sensor.calibration) {
        (Some(heard), Some(calibration)) => Some(SoundMap::new(calibration, heard)),
        _ => None,
    };
    let body = HeadBox::new(parameters.body, sensor.calibration);
    let alone = match parameters.modality {
        Modality::Audio => Some(head_to_hear(&body, room, camera, heard.is_some())?),
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
    Ok(View {
        camera,
        name: sensor.name.clone(),
        array,
        seen: CameraPercepts::new(parameters.vision.clone()).map_err(wrong)?,
        heard,
        tracker: ViewTracker::new(composition),
        alone,
        width_px: sensor.width as f32,
        map,
        strip: Vec::new(),
        frame: 0,
        looked: Duration::ZERO,
        listened: Duration::ZERO,
        tracked: Duration::ZERO,
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
            cues: vec![Box::new(SoundCue)],
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
        Box::new(SoundCue),
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

impl View {
    /// Checks what was remembered before anything of it is taken over.
    fn check(&self, saved: &SavedView, last_identity: u64) -> Result<(), StateError> {
        let foreign =
            |reason: &dyn std::fmt::Display| StateError::Foreign(format!("camera {}: {reason}", self.name));
        CameraPercepts::check_state(&saved.camera).map_err(|error| foreign(&error))?;
        match (&self.heard, &saved.array) {
            (Some(heard), Some(array)) => heard.check_state(array).map_err(|error| foreign(&error))?,
            (None, None) => {}
            _ => return Err(foreign(&"another array")),
        }
        self.tracker
            .check_state(&saved.tracker, self.seen.histogram_bins(), last_identity)
    }

    /// Takes its part of a moment.
    fn step(&mut self, moment: &Moment, elapsed: Span) -> Result<(), hearsight_filter::FilterError> {
        let start = Clock::now();
        if let (Some(heard), Some((index, _))) = (&mut self.heard, &self.array) {
            heard.hear(moment.audio.get(*index).and_then(|block| block.get()));
        }
        let listened = Clock::now();
        self.listened += listened - start;
        let frame = moment.video.get(self.camera).and_then(|frame| frame.get());
        if let Some(frame) = frame {
            if self.alone.is_none() {
                self.seen.see(frame);
            }
            self.frame = frame.number;
        }
        let looked = Clock::now();
        self.looked += looked - listened;
        if let Some(frame) = frame {
            match (&self.alone, &self.heard) {
                (Some(head), Some(heard)) => {
                    self.tracker
                        .follow_sound(&self.seen, heard, head, self.width_px, frame.time)?;
                }
                _ => self.tracker.see(&self.seen, self.heard.as_ref(), frame.time)?,
            }
        }
        if let Some(heard) = &self.heard {
            self.tracker.hear(heard, elapsed);
            if let Some(map) = &self.map {
                map.strip(heard, &mut self.strip);
            }
        }
        self.tracked += looked.elapsed();
        Ok(())
    }

    fn record(&self, scene: &mut Scene) {
        let speaker = self.tracker.speaking();
        let with_sound = self.heard.is_some();
        for belief in self.tracker.published() {
            let Some(id) = belief.identity else { continue };
            scene.tracks.push(TrackRecord {
                id,
                phase: if belief.occluded {
                    TrackPhase::Occluded
                } else {
                    TrackPhase::Visible
                },
                existence: belief.existence.probability(),
                views: vec![ViewRecord {
                    camera: self.name.clone(),
                    frame: self.frame,
                    head: BoxRecord::from(belief.head),
                    deviation_px: belief.deviation.map(f64::from),
                }],
                position_m: None,
                deviation_m: None,
                speaking: speaker == Some(id),
                speaking_probability: with_sound.then_some(belief.speaking),
                effective_sample_size: belief.effective_sample_size,
            });
        }
        if let (Some(heard), Some((_, array))) = (&self.heard, &self.array) {
            let talker_s = || {
                let sound = heard.direction().sound_s() > 0.0;
                self.tracker.state().speaker.delay_s().filter(|_| sound)
            };
            if let Some(delay_s) = heard.onset_delay_s().or_else(talker_s) {
                scene.sounds.push(SoundRecord {
                    array: array.clone(),
                    delay_s,
                    column_px: self.map.as_ref().and_then(|map| map.column(delay_s)),
                    signal_to_noise_db: heard.signal_to_noise_db().into(),
                    from_onset: heard.has_onset(),
                    position_m: None,
                    deviation_m: None,
                    track: speaker,
                });
            }
            scene.nobody_probability = self.tracker.nobody_probability();
            scene.speaker = scene.speaker.or(speaker);
        }
    }
}

impl System for Stac {
    fn name(&self) -> &'static str {
        INFO.name
    }

    fn step(&mut self, moment: &Moment, scene: &mut Scene) {
        let elapsed = self.last.map_or(Span::ZERO, |last| moment.time - last);
        self.last = Some(moment.time);
        // The composition is this module's own and its dimensions fit: a failure here would be a mistake of ours, and
        // the views are left as they are.
        let _ = parallel::each(&mut self.views, |view| view.step(moment, elapsed));
        for view in &mut self.views {
            if view.alone.is_some() {
                view.tracker.publish_all(&mut self.next_identity);
            } else {
                view.tracker
                    .publish(&view.seen, moment.time, &mut self.next_identity);
            }
        }
        scene.schema.clear();
        scene.schema.push_str(SCENE_SCHEMA_VERSION);
        scene.tick = moment.tick;
        scene.time_s = moment.time.seconds();
        scene.tracks.clear();
        scene.sounds.clear();
        scene.speaker = None;
        scene.nobody_probability = None;
        scene.last_speaker = None;
        scene.faults.clone_from(&moment.faults);
        for view in &self.views {
            view.record(scene);
        }
        scene.tracks.sort_by_key(|track| track.id);
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        let saved = Saved {
            next_identity: self.next_identity,
            last: self.last,
            views: self
                .views
                .iter()
                .map(|view| SavedView {
                    camera: view.seen.state(),
                    array: view.heard.as_ref().map(ArrayPercepts::state),
                    tracker: view.tracker.state().clone(),
                    frame: view.frame,
                })
                .collect(),
        };
        postcard::to_stdvec(&saved).map_err(|error| StateError::Write(error.to_string()))
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), StateError> {
        let foreign = |reason: String| StateError::Foreign(reason);
        let saved: Saved = postcard::from_bytes(state).map_err(|error| foreign(error.to_string()))?;
        if saved.views.len() != self.views.len() {
            return Err(foreign(format!(
                "{} views where the room has {}",
                saved.views.len(),
                self.views.len()
            )));
        }
        if !is_finite(&saved) || saved.next_identity > MOST_NUMBERED {
            return Err(foreign(
                "a number in it is not finite or out of all bounds".to_owned(),
            ));
        }
        let last_identity = saved.next_identity;
        for (view, saved) in self.views.iter().zip(&saved.views) {
            view.check(saved, last_identity)?;
        }
        for (view, saved) in self.views.iter_mut().zip(saved.views) {
            view.seen
                .set_state(saved.camera)
                .map_err(|error| foreign(error.to_string()))?;
            if let (Some(heard), Some(array)) = (&mut view.heard, saved.array) {
                heard
                    .set_state(array)
                    .map_err(|error| foreign(error.to_string()))?;
            }
            view.tracker.set_state(saved.tracker);
            view.frame = saved.frame;
        }
        self.next_identity = saved.next_identity;
        self.last = saved.last;
        Ok(())
    }

    fn timings(&self) -> Vec<(&'static str, Duration)> {
        let sum = |part: fn(&View) -> Duration| self.views.iter().map(part).sum();
        vec![
            ("vision", sum(|view| view.looked)),
            ("audio", sum(|view| view.listened)),
            ("tracking", sum(|view| view.tracked)),
        ]
    }

    fn correlation_strip(&self, camera: usize) -> &[f32] {
        self.views.get(camera).map_or(&[], |view| &view.strip)
    }

    fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn quarantined(&self) -> u64 {
        self.views.iter().map(|view| view.tracker.quarantined()).sum()
    }
}
