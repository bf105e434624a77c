//! The `room.toml` of a simulation: what whoever tracks may know.

use super::Simulation;
use crate::world::SensorClock;
use hearsight_core::WorldPoint;
use hearsight_core::calibration::{Calibration, to_toml};
use std::fmt::Write;
use std::path::PathBuf;

/// What the files of sensors are called: their names with these extensions; nothing where there are none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Files {
    /// Of cameras.
    pub video: Option<&'static str>,
    /// Of microphone arrays.
    pub sound: Option<&'static str>,
}

impl Default for Files {
    /// What `hearsight simulate` writes unless told otherwise.
    fn default() -> Self {
        Self {
            video: Some("mov"),
            sound: Some("wav"),
        }
    }
}

impl Simulation {
    /// The text of a `room.toml` for the files of this simulation. Calibrations are exact; clocks are told where the
    /// scenario declares them; devices that move stand where they begin.
    pub fn room_file(&self, files: &Files) -> String {
        let world = self.world();
        let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
        let mut text = format!("# Simulated from the scenario {}.\n", quoted(&world.name));
        let mut add = |line: String| {
            text.push_str(&line);
            text.push('\n');
        };
        add(format!("name = {}", quoted(&world.name)));
        if world.speed_of_sound_m_s != hearsight_core::microphones::SPEED_OF_SOUND_M_S {
            add(format!("speed_of_sound = {:?}", world.speed_of_sound_m_s));
        }
        for (number, camera) in world.cameras.iter().enumerate() {
            let Some(extension) = files.video else { break };
            let [at_start, _] = self.shared.camera_at(number, [0.0, 0.0]);
            add(format!("\n[[camera]]\nname = {}", quoted(&camera.name)));
            add(format!(
                "file = {}{}",
                quoted(&format!("{}.{extension}", camera.name)),
                clock(&camera.clock)
            ));
            let calibration = Calibration {
                file: PathBuf::new(),
                name: None,
                model: at_start.model,
                pose: Some(at_start.pose),
                size: Some([camera.width, camera.height]),
            };
            let table = to_toml(&[calibration]);
            let table = table.strip_prefix("[[camera]]\n").unwrap_or(&table);
            add(format!("[camera.calibration]\n{}", table.trim_end()));
        }
        for array in &world.arrays {
            let Some(extension) = files.sound else { break };
            add(format!("\n[[array]]\nname = {}", quoted(&array.name)));
            add(format!(
                "file = {}{}",
                quoted(&format!("{}.{extension}", array.name)),
                clock(&array.clock)
            ));
            let paired = array.camera.filter(|_| files.video.is_some());
            if let Some(camera) = paired.and_then(|camera| world.cameras.get(camera)) {
                add(format!("camera = {}", quoted(&camera.name)));
            }
            let mut places = vec![WorldPoint::new(0.0, 0.0, 0.0); array.microphones.len()];
            self.shared
                .with_controls(|controls| controls.microphones(array, &world.bases, 0.0, &mut places));
            let mut list = String::from("microphones = [\n");
            for place in places {
                let _ = writeln!(list, "    [{:?}, {:?}, {:?}],", place.0.x, place.0.y, place.0.z);
            }
            add(format!("{list}]"));
        }
        if !world.system.is_empty() {
            let system =
                toml::Table::from_iter([("system".to_owned(), toml::Value::Table(world.system.clone()))]);
            add(format!("\n{}", system.to_string().trim_end()));
        }
        text
    }
}

fn clock(clock: &SensorClock) -> String {
    if !clock.declared {
        return String::new();
    }
    format!("\nstart = {:?}\ndrift = {:?}", clock.offset_s, clock.drift_ppm)
}
