//! The cameras and arrays of the three-mics system: each with its percepts and what follows them.

use super::parameters::Parameters;
use super::{lacks, wrong};
use crate::SystemError;
use hearsight_core::camera::Camera;
use hearsight_core::microphones::MicrophoneArray;
use hearsight_core::room::Room;
use hearsight_core::{Instant, Moment, Span};
use hearsight_tracking::face::{FaceBelief, FaceTracker};
use hearsight_tracking::percepts::{FaceWindowPercepts, HeardFrame, SteeredPercepts};
use hearsight_tracking::sight_and_sound::SightLine;
use hearsight_tracking::sound::{Bounds, SoundTracker, SteeredResponse};
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant as Clock};

/// One camera.
pub(super) struct View {
    pub(super) camera: usize,
    pub(super) name: String,
    pub(super) calibration: Camera,
    pub(super) windows: FaceWindowPercepts,
    pub(super) faces: FaceTracker,
    pub(super) frame: u64,
    pub(super) last: Option<Instant>,
    pub(super) elapsed: Span,
    pub(super) looked: Duration,
    pub(super) tracked: Duration,
}

/// One array.
pub(super) struct Hearing {
    pub(super) array: usize,
    pub(super) name: String,
    pub(super) microphones: MicrophoneArray,
    pub(super) percepts: SteeredPercepts,
    pub(super) sound: SoundTracker,
    /// What the newest frame said, and whether it is of this moment.
    pub(super) newest: Option<Newest>,
    pub(super) last: Option<Instant>,
    pub(super) listened: Duration,
}

/// The newest frame of an array.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Newest {
    pub(super) active: bool,
    pub(super) signal_to_noise_db: f32,
    pub(super) is_new: bool,
}

impl View {
    /// The camera of this number.
    pub(super) fn new(
        parameters: &Parameters,
        room: &Room,
        camera: usize,
        seed: u64,
    ) -> Result<Self, SystemError> {
        let sensor = &room.cameras[camera];
        let calibration = sensor.calibration.ok_or_else(|| {
            lacks(format!(
                "camera {} has no calibration; give it one with its place, for example from `hearsight calibrate camera`",
                sensor.name
            ))
        })?;
        let role = format!("three-mics {}", sensor.name);
        Ok(Self {
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

    /// Takes in a new picture, if there is one.
    pub(super) fn see(&mut self, moment: &Moment) -> Result<(), hearsight_filter::FilterError> {
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

    /// The line of sight of one of its faces.
    pub(super) fn sight(&self, face: &FaceBelief, parameters: &Parameters) -> Option<SightLine> {
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

/// A frame of an array that its sound was told of.
pub(super) struct Listened<'a> {
    pub(super) response: &'a mut SteeredResponse,
    pub(super) sound: &'a SoundTracker,
    pub(super) frame: HeardFrame,
    /// Whether the sound was followed in it.
    pub(super) followed: bool,
    /// Since the frame before.
    pub(super) elapsed: Span,
}

impl Hearing {
    /// The array of this number, whose sounds are within `bounds`.
    pub(super) fn new(
        parameters: &Parameters,
        room: &Room,
        array: usize,
        bounds: Bounds,
        seed: u64,
    ) -> Result<Self, SystemError> {
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
        Ok(Self {
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

    /// Takes in what this array heard, if anything, and calls `each` with every frame that it completes.
    pub(super) fn hear(
        &mut self,
        moment: &Moment,
        parameters: &Parameters,
        mut each: impl FnMut(Listened<'_>),
    ) {
        if let Some(newest) = &mut self.newest {
            newest.is_new = false;
        }
        let block = moment.audio.get(self.array).and_then(|block| block.get());
        let (sound, newest, last) = (&mut self.sound, &mut self.newest, &mut self.last);
        self.percepts.hear(block, |response, frame| {
            let active = frame.active || !parameters.beyond.voice_gate;
            // A response of another array cannot come here; a frame that fails is as if it were not heard.
            let followed = active && sound.listen(response, frame.time).is_ok();
            let elapsed = last.map_or(Span::ZERO, |last| frame.time - last);
            *last = Some(frame.time);
            *newest = Some(Newest {
                active: followed,
                signal_to_noise_db: frame.signal_to_noise_db,
                is_new: true,
            });
            each(Listened {
                response,
                sound,
                frame,
                followed,
                elapsed,
            });
        });
    }
}
