//! What people write in a scenario file: syntax only, nothing is drawn, opened or checked here.
//!
//! Every key has a default where one makes sense; an unknown key is an error. Times are seconds from the beginning of
//! the scenario, lengths metres, angles degrees counter-clockwise from the x axis seen from above, levels decibels,
//! paths relative to the file. Places on the floor are `[x, y]`, in the room `[x, y, z]`; the room spans from the origin
//! to its `size`.

mod people;
mod room;
mod sensors;

pub use people::{RawAction, RawConversation, RawDirection, RawNoise, RawPerson, RawVoice};
pub use room::{FurnitureKind, RawDoor, RawFurniture, RawLight, RawMaterial, RawMaterialTable, RawRoom};
pub use sensors::{ArrayShape, LensKind, RawArray, RawBase, RawCamera, RawClock, RawCommand, RawHead};

use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A whole scenario.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawScene {
    /// Name of the scenario. Default: the name of the file.
    pub name: Option<String>,
    /// How long it lasts, seconds. Default 20.
    pub seconds: Option<f64>,
    /// Seed of everything that is drawn: looks, voices, turns, little movements, noise. Default 1.
    pub seed: Option<u64>,
    /// Speed of sound, metres a second. Default 343.
    pub speed_of_sound: Option<f64>,
    /// The room.
    pub room: RawRoom,
    /// Furniture, pillars, screens.
    pub furniture: Vec<RawFurniture>,
    /// Lamps and windows. Default: two lamps and daylight, drawn from the seed.
    pub light: Vec<RawLight>,
    /// The people, in the order of their identities, from 1.
    pub person: Vec<RawPerson>,
    /// Conversations, whose turns are drawn from a model.
    pub conversation: Vec<RawConversation>,
    /// Sounds that are not speech of people.
    pub noise: Vec<RawNoise>,
    /// What moves and carries sensors.
    pub base: Vec<RawBase>,
    /// The cameras.
    pub camera: Vec<RawCamera>,
    /// The microphone arrays.
    pub array: Vec<RawArray>,
    /// What is written as `[system]` into `room.toml`: which system is to track, with its parameters.
    #[schemars(with = "BTreeMap<String, serde_json::Value>")]
    pub system: toml::Table,
}
