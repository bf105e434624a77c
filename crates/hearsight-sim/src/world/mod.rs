//! Who and what is in the room, and where it is at any instant: what the renderer and the acoustics are told.
//!
//! World frame: metres, right-handed, z up, the floor at z = 0. A yaw of 0 looks along x and grows counter-clockwise seen
//! from above; a pitch grows upwards; a roll grows towards the right shoulder.
//!
//! * [`World`] — all of it. People are pure functions of time, devices of time and the commands that they received
//!   ([`Controls`]).
//! * [`Posture`], [`Looks`], [`Setting`] — what a picture is made of.
//! * [`Motion`], [`Look`], [`Gesture`] — what people do; [`scenario`](crate::scenario) makes them from a file.

mod axis;
mod character;
mod controls;
mod device;
mod ease;
mod figure;
mod gaze;
mod gesture;
mod limbs;
mod motion;
mod noise;
mod person;
mod pose;
mod posture;
mod setting;
mod walk;

pub use axis::{Axis, AxisLimits};
pub use character::Character;
pub use controls::{Controls, UnknownDevice};
pub use device::{ArrayDevice, Base, CameraDevice, Exposure, Mount, PanTiltZoom, SensorClock};
pub(crate) use ease::wrap;
pub use figure::Figure;
pub use gaze::{Look, Target};
pub use gesture::{Gesture, GestureKind};
pub use motion::{Gait, LARGEST_JERK_M_S, LARGEST_SPEED_M_S, Motion, Pace, Refusal, Rest, Stance};
pub use noise::{Noise, NoiseKind, NoiseLevel, NoisePlace};
pub use person::{Person, Speech, VoiceSpec};
pub use posture::{Limb, Posture};
pub use setting::{Block, Colour, Hair, Light, Looks, Material, Pattern, Setting, Wear};
pub use walk::{ACCELERATION_M_S2, Walk};

use hearsight_core::WorldPoint;
use hearsight_core::command::DeviceCommand;

/// A lamp that is switched or dimmed: number of the light, and from a time on (seconds) how bright it is.
pub type LampChanges = Vec<Vec<(f64, f64)>>;

/// Everything that a scenario describes.
#[derive(Clone, Debug)]
pub struct World {
    /// Name of the scenario.
    pub name: String,
    /// How long it lasts, seconds.
    pub seconds: f64,
    /// Seed of every random number.
    pub seed: u64,
    /// Metres a second.
    pub speed_of_sound_m_s: f64,
    /// Reverberation time, seconds; 0 for walls that reflect nothing.
    pub t60_s: f64,
    /// The room.
    pub setting: Setting,
    /// How bright each light of the setting is, from times on.
    pub lamp_changes: LampChanges,
    /// The people, by ascending identity.
    pub people: Vec<Person>,
    /// Other sounds.
    pub noises: Vec<Noise>,
    /// What moves and carries sensors.
    pub bases: Vec<Base>,
    /// The cameras.
    pub cameras: Vec<CameraDevice>,
    /// The microphone arrays.
    pub arrays: Vec<ArrayDevice>,
    /// Commands that the scenario itself sends, in order of time.
    pub commands: Vec<DeviceCommand>,
    /// What `room.toml` says of the system that is to track.
    pub system: toml::Table,
}

impl World {
    /// The posture of a person (by number from 0) at a time; `None` while they are not in the room.
    pub fn posture(&self, person: usize, time_s: f64) -> Option<Posture> {
        let who = self.people.get(person)?;
        let stance = who.motion.stance(time_s);
        if !stance.present {
            return None;
        }
        let eyes = WorldPoint(pose::core(&who.figure, &who.character, &stance, time_s).head);
        let gaze_rad = gaze::direction(&who.gaze, time_s, eyes, stance.facing_rad, &|other| {
            self.head_anchor(other, time_s)
        });
        let pose = pose::Pose {
            figure: &who.figure,
            character: &who.character,
            stance,
            gestures: &who.gestures,
            gaze_rad,
            mouth_opening: who.mouth_opening(time_s),
            talking: who.talking(time_s),
            time_s,
        };
        Some(pose.posture())
    }

    /// About where the head of a person is, wherever they look; `None` while they are not in the room.
    pub fn head_anchor(&self, person: usize, time_s: f64) -> Option<WorldPoint> {
        let who = self.people.get(person)?;
        let stance = who.motion.stance(time_s);
        stance
            .present
            .then(|| WorldPoint(pose::core(&who.figure, &who.character, &stance, time_s).head))
    }

    /// How bright each light is at a time, 1 as the setting says.
    pub fn lamps(&self, time_s: f64) -> Vec<f64> {
        let lamps = self.setting.lights.iter().enumerate().map(|(number, _)| {
            let changes = self.lamp_changes.get(number).map_or(&[][..], Vec::as_slice);
            let last = changes.iter().rev().find(|(from, _)| *from <= time_s);
            last.map_or(1.0, |(_, strength)| *strength)
        });
        lamps.collect()
    }

    /// Where a sound that is not speech comes from at a time; `None` for a diffuse one, and while the person who makes
    /// it is not in the room.
    pub fn noise_place(&self, noise: &Noise, controls: &Controls, time_s: f64) -> Option<WorldPoint> {
        match noise.place {
            NoisePlace::Fixed(place) => Some(place),
            NoisePlace::Person(person) => {
                let half_axes = self.people.get(person)?.looks.head_half_axes_m;
                Some(self.posture(person, time_s)?.mouth(half_axes))
            }
            NoisePlace::Base(base, height) => {
                let [x, y, _] = controls.base(&self.bases, base, time_s);
                Some(WorldPoint::new(x, y, height))
            }
            NoisePlace::Diffuse => None,
        }
    }

    /// The devices, having obeyed the scenario's own commands.
    ///
    /// # Errors
    /// Where a command names a device that cannot obey it, which resolved scenarios exclude.
    pub fn controls(&self) -> Result<Controls, UnknownDevice> {
        let mut controls = Controls::new(&self.cameras, &self.bases);
        for command in &self.commands {
            controls.send(&self.cameras, &self.bases, command)?;
        }
        Ok(controls)
    }
}
