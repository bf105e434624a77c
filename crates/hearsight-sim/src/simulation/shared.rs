//! What the sources of one simulation share: the world, what devices were told, and what cameras saw.

use super::{SimulationError, hearing, voices};
use crate::acoustics::Shoebox;
use crate::render::Sight;
use crate::voice::Speech;
use crate::world::{Controls, UnknownDevice, World};
use hearsight_core::camera::Camera;
use hearsight_core::command::DeviceCommand;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock};

/// Frames of each camera whose truth is kept until somebody asks for it; beyond them the oldest are forgotten.
const MOST_FRAMES: usize = 4096;
/// Rate of the speech that mouths go by where nobody listens, samples a second.
const RATE_WITHOUT_ARRAY_HZ: u32 = 16_000;

pub(super) struct Shared {
    pub(super) world: World,
    /// What each person says, at the rate of the first array.
    pub(super) speech: Vec<Arc<Speech>>,
    /// The room as sound meets it.
    pub(super) room: Shoebox,
    /// Level of each noise of the world, decibels relative to full scale.
    pub(super) noise_levels_db: Vec<f64>,
    controls: RwLock<Controls>,
    sights: Vec<Mutex<VecDeque<Seen>>>,
}

/// What one frame shows.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    /// Number of the frame, from 0.
    pub(super) frame: u64,
    /// Who, by number from 0, and where in the picture.
    pub(super) people: Vec<(usize, Sight)>,
}

impl Shared {
    pub(super) fn new(mut world: World) -> Result<Self, SimulationError> {
        let rate_hz = world
            .arrays
            .first()
            .map_or(RATE_WITHOUT_ARRAY_HZ, |array| array.rate_hz);
        let mut speech = Vec::new();
        for person in &mut world.people {
            let own = Arc::new(voices::speech(person, rate_hz)?);
            person.speech = Some(Arc::new(voices::Mouth::new(person, Arc::clone(&own))));
            speech.push(own);
        }
        let room = hearing::room(&world)?;
        Ok(Self {
            noise_levels_db: hearing::noise_levels_db(&world, &room)?,
            room,
            speech,
            controls: RwLock::new(world.controls()?),
            sights: world.cameras.iter().map(|_| Mutex::default()).collect(),
            world,
        })
    }

    pub(super) fn send(&self, command: &DeviceCommand) -> Result<(), UnknownDevice> {
        let mut controls = self.controls.write().unwrap_or_else(PoisonError::into_inner);
        controls.send(&self.world.cameras, &self.world.bases, command)
    }

    /// The devices as they are told until now.
    pub(super) fn with_controls<T>(&self, ask: impl FnOnce(&Controls) -> T) -> T {
        ask(&self.controls.read().unwrap_or_else(PoisonError::into_inner))
    }

    /// A camera as it is at two times.
    pub(super) fn camera_at(&self, number: usize, times_s: [f64; 2]) -> [Camera; 2] {
        let device = &self.world.cameras[number];
        self.with_controls(|controls| {
            times_s.map(|time_s| {
                let camera = controls.camera(device, number, &self.world.bases, time_s);
                // A lens that cannot be zoomed stays as it is.
                camera.unwrap_or_else(|_| Camera {
                    model: device.lens,
                    pose: device.mount.pose(),
                    width: device.width,
                    height: device.height,
                })
            })
        })
    }

    pub(super) fn note_sights(&self, camera: usize, frame: u64, people: Vec<(usize, Sight)>) {
        let mut seen = self.seen(camera);
        if seen.len() >= MOST_FRAMES {
            seen.pop_front();
        }
        seen.push_back(Seen { frame, people });
    }

    pub(super) fn seen(&self, camera: usize) -> MutexGuard<'_, VecDeque<Seen>> {
        self.sights[camera].lock().unwrap_or_else(PoisonError::into_inner)
    }
}
