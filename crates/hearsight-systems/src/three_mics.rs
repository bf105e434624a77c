//! The three-mics system: a few microphones and a camera find the speaker in the room.
//!
//! Pnevmatikakis, Talantzis, "Person tracking in enhanced cognitive care: a particle filtering approach". Each array
//! follows a sound in the room, each camera the faces in its picture; both are put together in the room, where the sound
//! is a face's or nobody's. Arrays and cameras may be anywhere, and there may be several: every array then decides with
//! all cameras' faces, and a person who is seen by two cameras is two tracks.

mod fusion;
mod limits;
mod parameters;
mod sensors;

pub use parameters::{Beyond, Parameters, RoomBox};

use crate::{SystemError, SystemInfo, parallel};
use fusion::Fusion;
use hearsight_core::finite::is_finite;
use hearsight_core::record::{
    BoxRecord, SCENE_SCHEMA_VERSION, Scene, SoundRecord, TrackPhase, TrackRecord, ViewRecord,
};
use hearsight_core::room::Room;
use hearsight_core::{Instant, Moment};
use hearsight_tracking::face::FaceState;
use hearsight_tracking::percepts::{FaceWindowState, SteeredState};
use hearsight_tracking::sight_and_sound::{Activity, Place};
use hearsight_tracking::sound::{Bounds, PointEstimate, SoundBelief};
use hearsight_tracking::system::{StateError, System};
use hearsight_tracking::tracker::MOST_NUMBERED;
use sensors::{Hearing, Newest, View};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::time::{Duration, Instant as Clock};

/// What the registry says of this system.
pub(crate) const INFO: SystemInfo = SystemInfo {
    name: "three-mics",
    summary: "a few microphones and a camera: faces and one sound, put together in the room in three dimensions",
    source: "Pnevmatikakis, Talantzis: Person tracking in enhanced cognitive care",
    parameters: || schemars::schema_for!(Parameters).to_value(),
    build,
};

/// The system.
pub struct ThreeMics {
    parameters: Parameters,
    views: Vec<View>,
    hearings: Vec<Hearing>,
    fusion: Fusion,
    next_identity: u64,
    last: Option<Instant>,
    fused: Duration,
}

#[derive(Serialize, Deserialize)]
struct Saved {
    next_identity: u64,
    last: Option<Instant>,
    activity: Activity,
    places: Vec<Place>,
    meetings: Vec<(u64, PointEstimate)>,
    views: Vec<SavedView>,
    hearings: Vec<SavedHearing>,
}

#[derive(Serialize, Deserialize)]
struct SavedView {
    windows: FaceWindowState,
    faces: FaceState,
    frame: u64,
    last: Option<Instant>,
}

#[derive(Serialize, Deserialize)]
struct SavedHearing {
    percepts: SteeredState,
    sound: SoundBelief,
    newest: Option<Newest>,
    last: Option<Instant>,
}

fn wrong(reason: impl std::fmt::Display) -> SystemError {
    SystemError::Parameters {
        system: INFO.name,
        reason: reason.to_string(),
    }
}

fn lacks(reason: String) -> SystemError {
    SystemError::Room {
        system: INFO.name,
        reason,
    }
}

fn build(parameters: &Value, room: &Room, seed: u64) -> Result<Box<dyn System>, SystemError> {
    let parameters: Parameters = if parameters.is_null() {
        Parameters::default()
    } else {
        Parameters::deserialize(parameters).map_err(wrong)?
    };
    limits::RANGES.check(&serde_json::to_value(&parameters).map_err(wrong)?)?;
    for (name, [low, high]) in [
        ("association.height_m", parameters.association.height_m),
        ("association.face_width_m", parameters.association.face_width_m),
    ] {
        if low >= high {
            return Err(wrong(format!(
                "{name} is [{low}, {high}]: give the lesser number first"
            )));
        }
    }
    if room.cameras.is_empty() {
        return Err(lacks(
            "there is no camera; add a [[camera]] with a calibration".into(),
        ));
    }
    if room.arrays.is_empty() {
        return Err(lacks(
            "there are no microphones; add an [[array]] with their places".into(),
        ));
    }
    let bounds = match parameters.room {
        Some(RoomBox { low_m, high_m }) => Bounds { low_m, high_m },
        None => around_sensors(room),
    };
    let views: Result<Vec<View>, SystemError> = (0..room.cameras.len())
        .map(|camera| View::new(&parameters, room, camera, seed))
        .collect();
    let hearings: Result<Vec<Hearing>, SystemError> = (0..room.arrays.len())
        .map(|array| Hearing::new(&parameters, room, array, bounds, seed))
        .collect();
    Ok(Box::new(ThreeMics {
        views: views?,
        hearings: hearings?,
        fusion: Fusion::new(bounds.low_m[2]),
        next_identity: 0,
        last: None,
        fused: Duration::ZERO,
        parameters,
    }))
}

/// The box around all sensors, and as much more as rooms usually have.
fn around_sensors(room: &Room) -> Bounds {
    let (mut low_m, mut high_m) = ([f64::MAX; 3], [f64::MIN; 3]);
    let cameras = room
        .cameras
        .iter()
        .filter_map(|camera| camera.calibration.map(|calibration| calibration.centre()));
    let microphones = room
        .arrays
        .iter()
        .flat_map(|array| array.microphones.iter().copied());
    for point in cameras.chain(microphones) {
        for axis in 0..3 {
            low_m[axis] = low_m[axis].min(point.0[axis]);
            high_m[axis] = high_m[axis].max(point.0[axis]);
        }
    }
    for axis in 0..3 {
        let (below, above) = if axis == 2 { (1.5, 1.0) } else { (4.0, 4.0) };
        low_m[axis] -= below;
        high_m[axis] += above;
    }
    Bounds { low_m, high_m }
}

impl ThreeMics {
    /// Takes in the sound of a moment: every frame is a face's or nobody's.
    fn listen(&mut self, moment: &Moment) {
        let arrays = self.hearings.len().max(1) as i64;
        for hearing in &mut self.hearings {
            let start = Clock::now();
            let (fusion, parameters) = (&mut self.fusion, &self.parameters);
            hearing.hear(moment, parameters, |heard| {
                fusion.hear(heard, arrays, parameters);
            });
            hearing.listened += start.elapsed();
        }
    }

    fn record(&self, scene: &mut Scene) {
        let speaker = self.fusion.speaker(&self.parameters);
        for view in &self.views {
            for face in view.faces.published() {
                let Some(id) = face.identity else { continue };
                let speaking = speaker == Some(id);
                let position = self.fusion.position(id, speaking, &self.parameters);
                scene.tracks.push(TrackRecord {
                    id,
                    phase: TrackPhase::Visible,
                    existence: face.existence.probability(),
                    views: vec![ViewRecord {
                        camera: view.name.clone(),
                        frame: view.frame,
                        head: BoxRecord::from(face.head()),
                        deviation_px: [face.deviation[0].into(), face.deviation[1].into()],
                    }],
                    position_m: position.map(|estimate| estimate.mean.0.into()),
                    deviation_m: position.map(deviations),
                    speaking,
                    speaking_probability: Some(self.fusion.activity.probability_of(id)),
                    effective_sample_size: face.effective_sample_size,
                });
            }
        }
        for hearing in &self.hearings {
            let newest = hearing.newest.filter(|newest| newest.active && newest.is_new);
            let (Some(newest), Some(estimate)) = (newest, hearing.sound.estimate()) else {
                continue;
            };
            let column_px = self
                .views
                .first()
                .and_then(|view| view.calibration.project_inside(estimate.mean))
                .map(|pixel| pixel.u);
            scene.sounds.push(SoundRecord {
                array: hearing.name.clone(),
                delay_s: hearing.microphones.delay_s(0, 1, estimate.mean).unwrap_or(0.0),
                column_px,
                signal_to_noise_db: newest.signal_to_noise_db.into(),
                from_onset: false,
                position_m: Some(estimate.mean.0.into()),
                deviation_m: Some(deviations(estimate)),
                track: speaker.filter(|id| self.fusion.suits(*id)),
            });
        }
        scene.speaker = speaker;
        scene.last_speaker = self.fusion.activity.last();
        scene.nobody_probability = Some(self.fusion.activity.nobody());
    }
}

fn deviations(estimate: PointEstimate) -> [f64; 3] {
    [0, 1, 2].map(|axis| estimate.covariance[(axis, axis)].max(0.0).sqrt())
}

impl System for ThreeMics {
    fn name(&self) -> &'static str {
        INFO.name
    }

    fn step(&mut self, moment: &Moment, scene: &mut Scene) {
        self.last = Some(moment.time);
        // The filters are this module's own and their dimensions fit: a failure here would be a mistake of ours, and
        // the views are left as they are.
        let _ = parallel::each(&mut self.views, |view| view.see(moment));
        for view in &mut self.views {
            view.faces.publish(&mut self.next_identity);
        }
        let start = Clock::now();
        self.fusion.gather(&self.views, &self.parameters);
        self.fused += start.elapsed();
        self.listen(moment);
        scene.schema.clear();
        scene.schema.push_str(SCENE_SCHEMA_VERSION);
        scene.tick = moment.tick;
        scene.time_s = moment.time.seconds();
        scene.tracks.clear();
        scene.sounds.clear();
        scene.faults.clone_from(&moment.faults);
        self.record(scene);
        scene.tracks.sort_by_key(|track| track.id);
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        let view = |view: &View| SavedView {
            windows: view.windows.state().clone(),
            faces: view.faces.state().clone(),
            frame: view.frame,
            last: view.last,
        };
        let hearing = |hearing: &Hearing| SavedHearing {
            percepts: hearing.percepts.state().clone(),
            sound: hearing.sound.belief().clone(),
            newest: hearing.newest,
            last: hearing.last,
        };
        let saved = Saved {
            next_identity: self.next_identity,
            last: self.last,
            activity: self.fusion.activity.clone(),
            places: self.fusion.places.clone(),
            meetings: self.fusion.meetings.clone(),
            views: self.views.iter().map(view).collect(),
            hearings: self.hearings.iter().map(hearing).collect(),
        };
        postcard::to_stdvec(&saved).map_err(|error| StateError::Write(error.to_string()))
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), StateError> {
        let foreign = |reason: &str| StateError::Foreign(reason.to_owned());
        let saved: Saved = postcard::from_bytes(state).map_err(|error| foreign(&error.to_string()))?;
        if saved.views.len() != self.views.len() || saved.hearings.len() != self.hearings.len() {
            return Err(foreign("another number of cameras or arrays"));
        }
        if !is_finite(&saved) || saved.next_identity > MOST_NUMBERED {
            return Err(foreign("a number in it is not finite or out of all bounds"));
        }
        let last_identity = saved.next_identity;
        let mut faces = self.views.iter().zip(&saved.views);
        if !faces.all(|(view, saved)| view.faces.accepts(&saved.faces, last_identity)) {
            return Err(foreign("faces of other settings"));
        }
        for (hearing, saved) in self.hearings.iter().zip(&saved.hearings) {
            hearing
                .percepts
                .check_state(&saved.percepts)
                .map_err(|error| foreign(&error.to_string()))?;
            if !hearing.sound.accepts(&saved.sound) {
                return Err(foreign("a sound of other settings"));
            }
        }
        if !saved.activity.is_sound() {
            return Err(foreign("the probabilities of who speaks"));
        }
        for (view, saved) in self.views.iter_mut().zip(saved.views) {
            view.windows.set_state(saved.windows);
            view.faces.set_state(saved.faces);
            (view.frame, view.last) = (saved.frame, saved.last);
        }
        for (hearing, saved) in self.hearings.iter_mut().zip(saved.hearings) {
            hearing.percepts.set_state(saved.percepts);
            hearing.sound.set_belief(saved.sound);
            (hearing.newest, hearing.last) = (saved.newest, saved.last);
        }
        self.fusion.activity = saved.activity;
        self.fusion.places = saved.places;
        self.fusion.meetings = saved.meetings;
        self.next_identity = saved.next_identity;
        self.last = saved.last;
        Ok(())
    }

    fn timings(&self) -> Vec<(&'static str, Duration)> {
        vec![
            ("vision", self.views.iter().map(|view| view.looked).sum()),
            ("faces", self.views.iter().map(|view| view.tracked).sum()),
            (
                "audio",
                self.hearings.iter().map(|hearing| hearing.listened).sum(),
            ),
            ("fusion", self.fused),
        ]
    }

    fn correlation_strip(&self, _camera: usize) -> &[f32] {
        // A sound has a place here, not a curve over columns.
        &[]
    }

    fn quarantined(&self) -> u64 {
        let faces: u64 = self.views.iter().map(|view| view.faces.quarantined()).sum();
        faces
            + self
                .hearings
                .iter()
                .map(|hearing| hearing.sound.quarantined())
                .sum::<u64>()
    }
}
