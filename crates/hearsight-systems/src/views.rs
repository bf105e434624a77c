//! Systems that follow heads in each camera's picture apart, each with the array paired to it: what such systems share.
//!
//! A system fills in a [`Plan`] a camera (stages, body, life cycle, how to look and listen); everything around it, from the
//! moment to the scene, and saving, is here. No algorithm.

use crate::{SystemError, parallel};
use hearsight_core::finite::is_finite;
use hearsight_core::record::{
    BoxRecord, SCENE_SCHEMA_VERSION, Scene, SoundRecord, TrackPhase, TrackRecord, ViewRecord,
};
use hearsight_core::room::{ArraySensor, Room};
use hearsight_core::{Instant, Moment, Rectangle, Span};
use hearsight_filter::FilterError;
use hearsight_tracking::belief::Belief;
use hearsight_tracking::closed_loop::{SoundFix, SoundTracker};
use hearsight_tracking::percepts::{
    ArrayPercepts, ArraySettings, ArrayState, CameraPercepts, CameraState, Pairs, RoundPicture, Turn,
};
use hearsight_tracking::sound_map::SoundMap;
use hearsight_tracking::system::{Bars, StateError, System};
use hearsight_tracking::tracker::{Composition, MOST_NUMBERED, ViewState, ViewTracker};
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant as Clock};

/// What a system decides for one camera.
pub(crate) struct Plan {
    /// Body, stages and life cycle.
    pub(crate) composition: Composition,
    /// How the camera looks.
    pub(crate) seen: CameraPercepts,
    /// The head that is followed by sound alone, but for its column; pictures are not looked at then.
    pub(crate) alone: Option<Rectangle>,
    /// Where sound alone says that somebody speaks, for people to look at.
    pub(crate) sound: Option<SoundTracker>,
}

/// What a camera's array hears, and where delays are in its picture.
pub(crate) struct Ears {
    /// The array's index in the room and its name.
    pub(crate) array: Option<(usize, String)>,
    /// Its percepts.
    pub(crate) heard: Option<ArrayPercepts>,
    /// Its delays over the columns of the picture that is looked at.
    pub(crate) map: Option<SoundMap>,
}

/// One camera with the array paired to it.
struct View {
    camera: usize,
    name: String,
    array: Option<(usize, String)>,
    seen: CameraPercepts,
    /// Where the picture goes all round.
    round: Option<RoundPicture>,
    heard: Option<ArrayPercepts>,
    tracker: ViewTracker,
    alone: Option<Rectangle>,
    width_px: f32,
    map: Option<SoundMap>,
    sound: Option<SoundTracker>,
    fix: Option<SoundFix>,
    strip: Vec<f32>,
    frame: u64,
    looked: Duration,
    listened: Duration,
    tracked: Duration,
}

/// Views side by side: a system.
pub(crate) struct Views {
    name: &'static str,
    views: Vec<View>,
    warnings: Vec<String>,
    next_identity: u64,
    last: Option<Instant>,
    /// Records of sounds that are over, for the next ones.
    spare: Vec<SoundRecord>,
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

/// Whether the delays of an array can be told: two microphones with known places.
fn is_placed(array: &ArraySensor) -> bool {
    array.microphones.len() >= 2
}

/// What cannot be done with the sensors of a room: everybody is still tracked by what is seen.
pub(crate) fn unheard(room: &Room) -> Vec<String> {
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

impl Ears {
    /// The ears of the array that is paired with `camera`, where there is one whose places are known. `all_round` says
    /// whether its picture is of a full turn; the camera itself, widened, no longer tells.
    ///
    /// # Errors
    /// [`SystemError::Parameters`] where a setting is out of its range.
    pub(crate) fn of(
        camera: usize,
        all_round: bool,
        room: &Room,
        settings: Option<ArraySettings>,
        system: &'static str,
    ) -> Result<Self, SystemError> {
        let Some(settings) = settings else {
            return Ok(Self {
                array: None,
                heard: None,
                map: None,
            });
        };
        let paired = room
            .arrays
            .iter()
            .position(|array| array.camera == Some(camera) && is_placed(array));
        let array = paired.map(|index| (index, room.arrays[index].name.clone()));
        // One pair cannot tell front from back: a picture that goes all round is listened to with all.
        let all = |index: usize| all_round && ArrayPercepts::hears_around(&room.arrays[index]);
        let settings = ArraySettings {
            pairs: if paired.is_some_and(all) {
                Pairs::All
            } else {
                settings.pairs
            },
            ..settings
        };
        let heard = paired
            .map(|index| {
                let array = &room.arrays[index];
                ArrayPercepts::new(settings, array, room.speed_of_sound_m_s)
                    .map_err(|error| SystemError::Room {
                        system,
                        reason: format!(
                            "array `{}` of {} samples a second: {error}; `rate` and `microphones` are in [[array]], \
                             the rest is in [system.{system}.audio]",
                            array.name, array.rate_hz
                        ),
                    })
            })
            .transpose()?;
        let map = match (&heard, &room.cameras[camera].calibration) {
            (Some(heard), Some(calibration)) => Some(SoundMap::new(calibration, heard)),
            _ => None,
        };
        Ok(Self { array, heard, map })
    }
}

impl Views {
    /// A system called `name` of one view a camera, each planned by `plan` from the room, the camera's index and its ears. Without
    /// `audio` nothing is listened to. `warnings` are what it cannot do in this room.
    ///
    /// # Errors
    /// What `plan` returns, and [`SystemError`] for a room without a camera.
    pub(crate) fn build(
        name: &'static str,
        room: &Room,
        audio: Option<ArraySettings>,
        warnings: Vec<String>,
        plan: impl Fn(&Room, usize, &Ears) -> Result<Plan, SystemError>,
    ) -> Result<Box<dyn System>, SystemError> {
        if room.cameras.is_empty() {
            return Err(SystemError::Room {
                system: name,
                reason: "there is no camera; add a [[camera]] to the room".into(),
            });
        }
        let mut views = Vec::new();
        let turns: Vec<Option<Turn>> = room
            .cameras
            .iter()
            .map(|camera| camera.calibration.as_ref().and_then(Turn::of))
            .collect();
        let room = &widened(room, &turns);
        for (camera, sensor) in room.cameras.iter().enumerate() {
            let ears = Ears::of(camera, turns[camera].is_some(), room, audio, name)?;
            let Plan {
                composition,
                seen,
                alone,
                sound,
            } = plan(room, camera, &ears)?;
            let Ears { array, heard, map } = ears;
            views.push(View {
                camera,
                name: sensor.name.clone(),
                array,
                seen,
                heard,
                round: turns[camera].map(RoundPicture::new),
                tracker: {
                    let mut tracker = ViewTracker::new(composition);
                    if let Some(turn) = turns[camera] {
                        tracker.go_round(turn);
                    }
                    tracker
                },
                alone,
                width_px: sensor.width as f32,
                map,
                sound,
                fix: None,
                strip: Vec::new(),
                frame: 0,
                looked: Duration::ZERO,
                listened: Duration::ZERO,
                tracked: Duration::ZERO,
            });
        }
        Ok(Box::new(Self {
            name,
            views,
            warnings,
            next_identity: 0,
            last: None,
            spare: Vec::new(),
        }))
    }
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
    fn step(&mut self, moment: &Moment, elapsed: Span) -> Result<(), FilterError> {
        let start = Clock::now();
        if let (Some(heard), Some((index, _))) = (&mut self.heard, &self.array) {
            heard.hear(moment.audio.get(*index).and_then(|block| block.get()));
        }
        let listened = Clock::now();
        self.listened += listened - start;
        let frame = moment.video.get(self.camera).and_then(|frame| frame.get());
        if let Some(frame) = frame {
            if self.alone.is_none() {
                match &mut self.round {
                    Some(round) => self.seen.see(round.widen(frame)),
                    None => self.seen.see(frame),
                }
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
            self.fix = self.sound.as_ref().and_then(|sound| sound.fix(heard));
            if let Some(map) = &self.map {
                map.strip(heard, &mut self.strip);
            }
        }
        self.tracked += looked.elapsed();
        Ok(())
    }

    /// Where sound alone says that somebody speaks, and where all together say so; none without a sound tracker.
    fn bars(&self) -> Bars {
        if self.sound.is_none() {
            return Bars::default();
        }
        let speaker = self.tracker.speaking();
        let head = |belief: &Belief| (belief.identity == speaker).then(|| belief.head.centre().0);
        Bars {
            sound: self.fix.map(|fix| self.narrow(fix.column_px as f32)),
            fused: speaker
                .and_then(|_| self.tracker.published().find_map(head))
                .map(|column| self.narrow(column)),
        }
    }

    /// A column of the picture that is looked at in the picture as it came.
    fn narrow(&self, column: f32) -> f32 {
        let turn = self.round.as_ref().map(RoundPicture::turn);
        turn.map_or(column, |turn| turn.narrow(column))
    }

    /// Adds its tracks and sounds behind the first `tracks` and `sounds` of the scene, which are of other views.
    fn record(&self, scene: &mut Scene, tracks: &mut usize, sounds: &mut usize) {
        let speaker = self.tracker.speaking();
        let with_sound = self.heard.is_some();
        for belief in self.tracker.published() {
            let Some(id) = belief.identity else { continue };
            let record = next_track(&mut scene.tracks, tracks);
            record.id = id;
            record.phase = if belief.occluded {
                TrackPhase::Occluded
            } else {
                TrackPhase::Visible
            };
            record.existence = belief.existence.probability();
            if let Some(view) = record.views.first_mut() {
                view.camera.clone_from(&self.name);
                view.frame = self.frame;
                let turn = self.round.as_ref().map(RoundPicture::turn);
                view.head = BoxRecord::from(turn.map_or(belief.head, |turn| turn.narrow_box(&belief.head)));
                view.deviation_px = belief.deviation.map(f64::from);
            }
            record.speaking = speaker == Some(id);
            record.speaking_probability = with_sound.then_some(belief.speaking);
            record.effective_sample_size = belief.effective_sample_size;
        }
        if let (Some(heard), Some((_, array))) = (&self.heard, &self.array) {
            let talker_s = || {
                let sound = heard.direction().sound_s() > 0.0;
                self.tracker.state().speaker.delay_s().filter(|_| sound)
            };
            // A sound tracker takes every frame, silent or not: only what sounds is a sound.
            let onset = heard.has_onset() && (self.sound.is_none() || heard.has_sound());
            if let Some(delay_s) = heard.onset_delay_s().filter(|_| onset).or_else(talker_s) {
                let record = next_sound(&mut scene.sounds, sounds);
                record.array.clone_from(array);
                record.delay_s = heard.first_delay_s(delay_s);
                let column = self.map.as_ref().and_then(|map| map.column(delay_s));
                record.column_px = column.map(|column| match &self.round {
                    Some(_) => f64::from(self.narrow(column as f32)),
                    None => column,
                });
                record.signal_to_noise_db = heard.signal_to_noise_db().into();
                record.from_onset = onset;
                (record.position_m, record.deviation_m) = (None, None);
                record.track = speaker;
            }
            scene.nobody_probability = self.tracker.nobody_probability();
            scene.speaker = scene.speaker.or(speaker);
        }
    }
}

/// The room as it is looked at: pictures that go all round with margins.
fn widened(room: &Room, turns: &[Option<Turn>]) -> Room {
    let mut room = room.clone();
    for (camera, turn) in room.cameras.iter_mut().zip(turns) {
        let Some(turn) = turn else { continue };
        camera.width = turn.widened();
        camera.calibration = camera.calibration.map(|calibration| turn.widen(&calibration));
    }
    room
}

/// The record behind the first `count`, which is counted; a new one where there is none.
fn next_track<'a>(tracks: &'a mut Vec<TrackRecord>, count: &mut usize) -> &'a mut TrackRecord {
    if *count == tracks.len() {
        tracks.push(TrackRecord {
            id: 0,
            phase: TrackPhase::Visible,
            existence: 0.0,
            views: Vec::new(),
            position_m: None,
            deviation_m: None,
            speaking: false,
            speaking_probability: None,
            effective_sample_size: 0.0,
        });
    }
    let record = &mut tracks[*count];
    *count += 1;
    (record.position_m, record.deviation_m) = (None, None);
    record.views.resize_with(1, || ViewRecord {
        camera: String::new(),
        frame: 0,
        head: BoxRecord::from(Rectangle::default()),
        deviation_px: [0.0; 2],
    });
    record
}

/// The same for sounds.
fn next_sound<'a>(sounds: &'a mut Vec<SoundRecord>, count: &mut usize) -> &'a mut SoundRecord {
    if *count == sounds.len() {
        sounds.push(SoundRecord {
            array: String::new(),
            delay_s: 0.0,
            column_px: None,
            signal_to_noise_db: 0.0,
            from_onset: false,
            position_m: None,
            deviation_m: None,
            track: None,
        });
    }
    *count += 1;
    &mut sounds[*count - 1]
}

impl System for Views {
    fn name(&self) -> &'static str {
        self.name
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
        scene.speaker = None;
        scene.nobody_probability = None;
        scene.last_speaker = None;
        scene.faults.clone_from(&moment.faults);
        // Records of the tick before are written over, so that nothing is allocated for those who stay.
        let (mut tracks, mut sounds) = (0, 0);
        scene.sounds.append(&mut self.spare);
        for view in &self.views {
            view.record(scene, &mut tracks, &mut sounds);
        }
        scene.tracks.truncate(tracks);
        self.spare.extend(scene.sounds.drain(sounds..));
        scene.tracks.sort_unstable_by_key(|track| track.id);
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

    fn bars(&self, camera: usize) -> Bars {
        self.views.get(camera).map_or_else(Bars::default, View::bars)
    }

    fn reliabilities(&self, camera: usize, track: u64) -> Option<[f64; 3]> {
        let mut beliefs = self.views.get(camera)?.tracker.published();
        let belief = beliefs.find(|belief| belief.identity == Some(track))?;
        Some(belief.trackers.as_ref()?.reliabilities)
    }

    fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn quarantined(&self) -> u64 {
        self.views.iter().map(|view| view.tracker.quarantined()).sum()
    }
}
