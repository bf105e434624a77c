//! The sensors of a simulation in process: what a system may know of them, as it would from `room.toml`.

use super::Simulation;
use hearsight_core::WorldPoint;
use hearsight_core::room::{ArraySensor, CameraSensor, Room};

impl Simulation {
    /// The room that [`Simulation::room_file`] describes, for systems that are run without files. Calibrations are exact;
    /// devices that move stand where they begin.
    pub fn room(&self) -> Room {
        let world = self.world();
        let cameras = world.cameras.iter().enumerate().map(|(number, camera)| {
            let [at_start, _] = self.shared.camera_at(number, [0.0, 0.0]);
            CameraSensor {
                name: camera.name.clone(),
                width: camera.width,
                height: camera.height,
                interval: camera.interval(),
                calibration: Some(at_start),
            }
        });
        let arrays = world.arrays.iter().map(|array| {
            let mut microphones = vec![WorldPoint::new(0.0, 0.0, 0.0); array.microphones.len()];
            self.shared
                .with_controls(|controls| controls.microphones(array, &world.bases, 0.0, &mut microphones));
            ArraySensor {
                name: array.name.clone(),
                rate_hz: array.rate_hz,
                channels: microphones.len(),
                microphones,
                camera: array.camera,
            }
        });
        Room {
            cameras: cameras.collect(),
            arrays: arrays.collect(),
            speed_of_sound_m_s: world.speed_of_sound_m_s,
        }
    }
}
