//! A scenario at work: cameras and arrays that deliver what real ones would, and the truth beside them.
//!
//! [`Simulation`] gives sources ([`SimulatedCamera`], [`SimulatedArray`]) that the engine reads as it reads files, and
//! what it reads is to the last bit what lossless files of the same simulation hold. Devices obey commands that come
//! meanwhile. [`Simulation::truth`] is for judges.

mod array;
mod camera;
mod hearing;
mod room;
mod room_file;
mod shared;
mod truth;
mod voices;

pub use array::SimulatedArray;
pub use camera::SimulatedCamera;
pub use room_file::Files;
pub use truth::{Utterance, mot_rows};

use crate::acoustics::AcousticsError;
use crate::world::{UnknownDevice, World};
use hearsight_core::command::DeviceCommand;
use shared::Shared;
use std::sync::Arc;

/// Why a world cannot be put to work.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// The room, a source or a recording cannot be used: correct the scenario.
    #[error(transparent)]
    Acoustics(#[from] AcousticsError),
    /// A command is for what cannot obey: correct the scenario.
    #[error(transparent)]
    Device(#[from] UnknownDevice),
}

/// A world whose devices are at work.
#[derive(Clone)]
pub struct Simulation {
    shared: Arc<Shared>,
}

impl Simulation {
    /// Puts a world to work.
    ///
    /// # Errors
    /// [`SimulationError`] where the room cannot sound as asked for, a recording cannot be read, or a command is for
    /// what cannot obey.
    pub fn new(world: World) -> Result<Self, SimulationError> {
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

    /// An array by number, from its first sample on.
    ///
    /// # Errors
    /// A setting that acoustics cannot take, or a recording that cannot be read.
    pub fn array(&self, number: usize) -> Result<SimulatedArray, AcousticsError> {
        let renderer = hearing::renderer(&self.shared, number)?;
        Ok(SimulatedArray::new(&self.shared, number, renderer))
    }

    /// A camera by number, from its first frame on.
    pub fn camera(&self, number: usize) -> SimulatedCamera {
        SimulatedCamera::new(&self.shared, number)
    }
}
