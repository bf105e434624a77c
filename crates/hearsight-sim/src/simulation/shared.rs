//! What the sources of one simulation share: the world, what devices were told, and what cameras saw.

use crate::render::Sight;
use crate::world::{Controls, UnknownDevice, World};
use hearsight_core::camera::Camera;
use hearsight_core::command::DeviceCommand;
use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError, RwLock};

/// Frames of each camera whose truth is kept until somebody asks for it; beyond them the oldest are forgotten.
const MOST_FRAMES: usize = 4096;

pub(super) struct Shared {
    pub(super) world: World,
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
    pub(super) fn new(world: World) -> Result<Self, UnknownDevice> {
        Ok(Self {
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
