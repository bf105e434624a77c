//! A scenario at work: cameras and arrays that deliver what real ones would, and the truth beside them.
//!
//! [`Simulation`] gives sources ([`SimulatedCamera`], [`SimulatedArray`]) that the engine reads as it reads files, and
//! what it reads is to the last bit what lossless files of the same simulation hold. Devices obey commands that come
//! meanwhile. [`Simulation::truth`] is for judges.

mod camera;
mod room_file;
mod shared;
mod truth;

pub use camera::SimulatedCamera;
pub use room_file::Files;
pub use truth::{Utterance, mot_rows};

use crate::world::{UnknownDevice, World};
use hearsight_core::command::DeviceCommand;
use shared::Shared;
use std::sync::Arc;

/// A world whose devices are at work.
#[derive(Clone)]
pub struct Simulation {
    shared: Arc<Shared>,
}

impl Simulation {
    /// Puts a world to work.
    ///
    /// # Errors
    /// [`UnknownDevice`] where the scenario sends commands to what cannot obey, which resolved scenarios exclude.
    pub fn new(world: World) -> Result<Self, UnknownDevice> {
        Ok(Self {
            shared: Arc::new(Shared::new(world)?),
        })
    }

    /// What is simulated.
    pub fn world(&self) -> &World {
        &self.shared.world
    }

    /// Lets a device obey from the command's time on. What cameras and arrays delivered already stays as it was.
    ///
    /// # Errors
    /// [`UnknownDevice`] where none of this name can do it.
    pub fn send(&self, command: &DeviceCommand) -> Result<(), UnknownDevice> {
        self.shared.send(command)
    }

    /// A camera by number, from its first frame on.
    pub fn camera(&self, number: usize) -> SimulatedCamera {
        SimulatedCamera::new(&self.shared, number)
    }
}
