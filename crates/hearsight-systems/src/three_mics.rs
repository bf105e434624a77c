//! The three-mics system: a few microphones and a camera find the speaker in the room.
//!
//! Pnevmatikakis, Talantzis, "Person tracking in enhanced cognitive care: a particle filtering approach". Each array
//! follows a sound in the room, each camera the faces in its picture; both are put together in the room, where the sound
//! is a face's or nobody's. Arrays and cameras may be anywhere, and there may be several: every array then decides with
//! all cameras' faces, and a person who is seen by two cameras is two tracks.

mod limits;
mod parameters;

pub use parameters::{Beyond, Parameters, RoomBox};

use crate::{SystemError, SystemInfo, parallel};
use hearsight_core::camera::Camera;
use hearsight_core::finite::is_finite;
use hearsight_core::microphones::MicrophoneArray;
use hearsight_core::record::{
    BoxRecord, SCENE_SCHEMA_VERSION, Scene, SoundRecord, TrackPhase, TrackRecord, ViewRecord,
};
use hearsight_core::room::Room;
use hearsight_core::{Instant, Moment, Span};
use hearsight_tracking::face::{FaceBelief, FaceState, FaceTracker};
use hearsight_tracking::percepts::{
    FaceWindowPercepts, FaceWindowState, HeardFrame, SteeredPercepts, SteeredState,
};
use hearsight_tracking::sight_and_sound::{
    Activity, Heard, Place, SightLine, Verdict, associate, log_likelihood_at,
};
use hearsight_tracking::sound::{Bounds, PointEstimate, SoundBelief, SoundTracker};
use hearsight_tracking::system::{StateError, System};
use hearsight_tracking::tracker::MOST_NUMBERED;
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

/// One camera.
struct View {
    camera: usize,
    name: String,
    calibration: Camera,
    windows: FaceWindowPercepts,
    faces: FaceTracker,
    frame: u64,
    last: Option<Instant>,
    elapsed: Span,
    looked: Duration,
    tracked: Duration,
}

/// One array.
struct Hearing {
    array: usize,
    name: String,
    microphones: MicrophoneArray,
    percepts: SteeredPercepts,
    sound: SoundTracker,
    /// What the newest frame said, and whether it is of this moment.
    newest: Option<Newest>,
    last: Option<Instant>,
    listened: Duration,
}

/// The newest frame of an array.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Newest {
    active: bool,
    signal_to_noise_db: f32,
    is_new: bool,
}

/// A face as the fusion sees it.
#[derive(Clone, Copy)]
struct Sight {
    identity: u64,
    line: SightLine,
}

/// The system.
pub struct ThreeMics {
    parameters: Parameters,
    floor_m: f64,
    views: Vec<View>,
    hearings: Vec<Hearing>,
    activity: Activity,
    places: Vec<Place>,
    next_identity: u64,
    last: Option<Instant>,
    sights: Vec<Sight>,
    matches: Vec<(u64, f64)>,
    /// By how much each face explains the newest frame worse than the best place of the room.
    fits: Vec<(u64, f64)>,
    /// Where the sound of the newest frame and each face that survives with it meet.
    meetings: Vec<(u64, PointEstimate)>,
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
        .map(|camera| build_view(&parameters, room, camera, seed))
        .collect();
    let hearings: Result<Vec<Hearing>, SystemError> = (0..room.arrays.len())
        .map(|array| build_hearing(&parameters, room, array, bounds, seed))
        .collect();
    Ok(Box::new(ThreeMics {
        floor_m: bounds.low_m[2],
        views: views?,
        hearings: hearings?,
        activity: Activity::default(),
        places: Vec::new(),
        next_identity: 0,
        last: None,
        sights: Vec::new(),
        matches: Vec::new(),
        fits: Vec::new(),
        meetings: Vec::new(),
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

fn build_view(parameters: &Parameters, room: &Room, camera: usize, seed: u64) -> Result<View, SystemError> {
    let sensor = &room.cameras[camera];
    let calibration = sensor.calibration.ok_or_else(|| {
        lacks(format!(
            "camera {} has no calibration; give it one with its place, for example from `hearsight calibrate camera`",
            sensor.name
        ))
    })?;
    let role = format!("three-mics {}", sensor.name);
    Ok(View {
        camera,
        name: sensor.name.clone(),
        calibration,
        windows: FaceWindowPercepts::new(parameters.vision.clone()).map_err(wrong)?,
        faces: FaceTracker::new(parameters.faces, seed, role).map_err(wrong)?,
        frame: 0,
        last: None,
        elapsed: Span::ZERO,
        looked: Duration::ZERO,
        tracked: Duration::ZERO,
    })
}

fn build_hearing(
    parameters: &Parameters,
    room: &Room,
    array: usize,
    bounds: Bounds,
    seed: u64,
) -> Result<Hearing, SystemError> {
    let sensor = &room.arrays[array];
    if sensor.microphones.len() < 2 || sensor.microphones.len() != sensor.channels {
        return Err(lacks(format!(
            "array {} has {} channels and the places of {} microphones; give one place a channel, two at the least",
            sensor.name,
            sensor.channels,
            sensor.microphones.len()
        )));
    }
    let mut percepts =
        SteeredPercepts::new(&parameters.audio, sensor, room.speed_of_sound_m_s).map_err(wrong)?;
    let role = format!("three-mics {}", sensor.name);
    let sound =
        SoundTracker::new(parameters.sound, bounds, percepts.response(), seed, &role).map_err(wrong)?;
    Ok(Hearing {
        array,
        name: sensor.name.clone(),
        microphones: MicrophoneArray::new(sensor.microphones.clone())
            .and_then(|array| array.with_speed_of_sound(room.speed_of_sound_m_s))
            .map_err(wrong)?,
        percepts,
        sound,
        newest: None,
        last: None,
        listened: Duration::ZERO,
    })
}

impl View {
    /// Takes in a new picture, if there is one.
    fn see(&mut self, moment: &Moment) -> Result<(), hearsight_filter::FilterError> {
        self.elapsed = Span::ZERO;
        let Some(frame) = moment.video.get(self.camera).and_then(|frame| frame.get()) else {
            return Ok(());
        };
        let start = Clock::now();
        self.frame = frame.number;
        self.elapsed = self.last.map_or(Span::ZERO, |last| frame.time - last);
        self.last = Some(frame.time);
        self.windows.search(frame, self.elapsed, self.faces.known());
        let looked = Clock::now();
        self.looked += looked - start;
        let seen = self
            .faces
            .see(frame.rgb_view(), self.windows.windows(), frame.time, self.elapsed);
        self.tracked += looked.elapsed();
        seen
    }

    fn sight(&self, face: &FaceBelief, parameters: &Parameters) -> Option<SightLine> {
        let deviation = f64::from(face.deviation[0].hypot(face.deviation[1])) / 2.0_f64.sqrt();
        let width_m = parameters
            .beyond
            .face_range
            .then(|| parameters.association.face_width());
        // A tenth of a face: a mouth is not where a box says, however sure the particles are of the box.
        let deviation_px = deviation.hypot(0.1 * f64::from(face.region.width));
        SightLine::new(
            &self.calibration,
            face.mouth_px(),
            deviation_px,
            face.region.width.into(),
            face.deviation[2].into(),
            width_m,
        )
    }
}

impl ThreeMics {
    /// Gathers the published faces of all cameras and follows their places.
    fn gather(&mut self) {
        self.sights.clear();
        let parameters = &self.parameters;
        let (sights, places) = (&mut self.sights, &mut self.places);
        for view in &self.views {
            for face in view.faces.published() {
                let Some(identity) = face.identity else { continue };
                let Some(line) = view.sight(face, parameters) else {
                    continue;
                };
                sights.push(Sight { identity, line });
                match places.iter_mut().find(|place| place.identity == identity) {
                    Some(place) if view.elapsed > Span::ZERO => {
                        place.see(&line, view.elapsed, &parameters.place);
                    }
                    Some(_) => {}
                    None => places.extend(Place::new(identity, &line, parameters.association.face_width())),
                }
            }
        }
        self.places
            .retain(|place| self.sights.iter().any(|sight| sight.identity == place.identity));
        self.activity
            .follow(self.sights.iter().map(|sight| sight.identity));
    }

    /// Takes in the sound of a moment: every frame is a face's or nobody's.
    fn listen(&mut self, moment: &Moment) {
        let arrays = self.hearings.len().max(1) as i64;
        for hearing in &mut self.hearings {
            let start = Clock::now();
            if let Some(newest) = &mut hearing.newest {
                newest.is_new = false;
            }
            let block = moment.audio.get(hearing.array).and_then(|block| block.get());
            let Hearing {
                percepts,
                sound,
                newest,
                last,
                ..
            } = hearing;
            percepts.hear(block, |response, frame: HeardFrame| {
                let active = frame.active || !self.parameters.beyond.voice_gate;
                // A response of another array cannot come here; a frame that fails is as if it were not heard.
                let followed = active && sound.listen(response, frame.time).is_ok();
                let elapsed = last.map_or(Span::ZERO, |last| frame.time - last) / arrays;
                *last = Some(frame.time);
                *newest = Some(Newest {
                    active: followed,
                    signal_to_noise_db: frame.signal_to_noise_db,
                    is_new: true,
                });
                self.matches.clear();
                self.meetings.clear();
                let heard = sound.estimate().filter(|_| followed);
                if let Some(estimate) = heard {
                    for sight in &self.sights {
                        let found =
                            associate(&sight.line, &estimate, self.floor_m, &self.parameters.association);
                        let Some(found) = found.filter(|found| found.verdict == Verdict::Survives) else {
                            continue;
                        };
                        self.matches.push((sight.identity, found.strain));
                        let covariance = found.meeting.covariance.unwrap_or(estimate.covariance);
                        let mean = found.meeting.point;
                        self.meetings
                            .push((sight.identity, PointEstimate { mean, covariance }));
                    }
                }
                let heard_now = if self.parameters.beyond.at_faces {
                    self.fits.clear();
                    if let Some(best) = sound.best(response).filter(|_| followed) {
                        for Sight { identity, line } in &self.sights {
                            let place = self.places.iter().find(|place| place.identity == *identity);
                            // What looks like a face below the floor or above heads says nothing.
                            let height_m = place.map(|place| place.estimate().mean.0.z - self.floor_m);
                            let [low_m, high_m] = self.parameters.association.height_m;
                            if height_m.is_some_and(|height_m| !(low_m..=high_m).contains(&height_m)) {
                                continue;
                            }
                            let below = log_likelihood_at(line, place, response) - best;
                            self.fits.push((*identity, f64::from(below.min(0.0))));
                        }
                    }
                    Heard::Frame(frame.voice.into(), &self.fits)
                } else if heard.is_some() {
                    Heard::Sound(&self.matches)
                } else {
                    Heard::Silence
                };
                self.activity.hear(heard_now, elapsed, &self.parameters.activity);
                let speaker = self.activity.speaking(&self.parameters.activity);
                let is_sure = |identity| self.activity.probability_of(identity) >= self.parameters.place.sure;
                let theirs = speaker.filter(|identity| followed && is_sure(*identity));
                let sight = self.sights.iter().find(|sight| Some(sight.identity) == theirs);
                let place = self
                    .places
                    .iter_mut()
                    .find(|place| Some(place.identity) == theirs);
                if let (Some(sight), Some(place)) = (sight, place) {
                    place.hear(&sight.line, response, elapsed, &self.parameters.place);
                }
            });
            hearing.listened += start.elapsed();
        }
    }

    /// Where a person is: in the weighted form what is believed of the place, in the plain one where the lines meet.
    fn position(&self, identity: u64, speaks: bool) -> Option<PointEstimate> {
        if self.parameters.association.weighted && self.parameters.beyond.face_range {
            let place = self.places.iter().find(|place| place.identity == identity)?;
            return Some(place.estimate());
        }
        let meeting = self.meetings.iter().find(|(met, _)| *met == identity && speaks);
        meeting.map(|(_, estimate)| *estimate)
    }

    fn record(&self, scene: &mut Scene) {
        let speaker = self.activity.speaking(&self.parameters.activity);
        for view in &self.views {
            for face in view.faces.published() {
                let Some(id) = face.identity else { continue };
                let speaking = speaker == Some(id);
                let position = self.position(id, speaking);
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
                    speaking_probability: Some(self.activity.probability_of(id)),
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
                track: speaker.filter(|id| self.matches.iter().any(|(met, _)| met == id)),
            });
        }
        scene.speaker = speaker;
        scene.last_speaker = self.activity.last();
        scene.nobody_probability = Some(self.activity.nobody());
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
        self.gather();
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
            activity: self.activity.clone(),
            places: self.places.clone(),
            meetings: self.meetings.clone(),
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
        self.activity = saved.activity;
        self.places = saved.places;
        self.meetings = saved.meetings;
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
