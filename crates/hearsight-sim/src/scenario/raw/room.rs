//! The room, its furniture and lights, as people write them.

use crate::world::Pattern;
use schemars::JsonSchema;
use serde::Deserialize;

/// The room: a box.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawRoom {
    /// Length (x), width (y) and height, metres. Default `[6, 5, 2.7]`.
    pub size: Option<[f64; 3]>,
    /// Time in which sound dies away by 60 dB, seconds; 0 for no reflections. Default 0.4. Longer blurs directions.
    pub t60: Option<f64>,
    /// The walls, in order: at the smallest x, the largest x, the smallest y, the largest y. One is for all of them.
    /// Default: drawn from the seed.
    pub walls: Vec<RawMaterial>,
    /// The floor. Default: drawn from the seed.
    pub floor: Option<RawMaterial>,
    /// The ceiling. Default: white.
    pub ceiling: Option<RawMaterial>,
    /// Pictures, boards and shelves on the walls, drawn from the seed: how many for each ten metres of wall, 0 to 10.
    /// Default 2. More makes it harder to see.
    pub clutter: Option<f64>,
    /// Light from everywhere: what a white surface reflects of it, 0 to 1. Default 0.35.
    pub ambient: Option<f64>,
    /// Doors, by which people come and go.
    pub door: Vec<RawDoor>,
}

/// A door in a wall.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawDoor {
    /// Its name, unique in the scenario. Default `door`, or `door1`, `door2`, ... where there are several.
    pub name: Option<String>,
    /// The place on the floor nearest to its middle: it is in the wall next to that, metres.
    pub at: Option<[f64; 2]>,
    /// Width, metres. Default 0.9.
    pub width: Option<f64>,
    /// Height, metres. Default 2.05.
    pub height: Option<f64>,
    /// What it looks like. Default: drawn from the seed.
    pub material: Option<RawMaterial>,
}

/// What a surface looks like: a colour, or more.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum RawMaterial {
    /// A colour alone, plain.
    Colour(String),
    /// More.
    Full(RawMaterialTable),
}

impl<'de> Deserialize<'de> for RawMaterial {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match toml::Value::deserialize(deserializer)? {
            toml::Value::String(colour) => Ok(Self::Colour(colour)),
            toml::Value::Table(table) => toml::Value::Table(table)
                .try_into()
                .map(Self::Full)
                .map_err(|error| serde::de::Error::custom(error.message())),
            other => Err(serde::de::Error::custom(format!(
                "a material is a colour or a table, not {}",
                other.type_str()
            ))),
        }
    }
}

/// What a surface looks like.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawMaterialTable {
    /// Colour: `#rrggbb`, or a name such as `white`. Default grey.
    pub colour: Option<String>,
    /// Second colour of the pattern. Default: a darker shade.
    pub second: Option<String>,
    /// The pattern. Default plain.
    pub pattern: Option<Pattern>,
    /// Size of one repetition, metres. Default 0.1.
    pub scale: Option<f64>,
}

/// What a piece of furniture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FurnitureKind {
    /// A table: a top on legs, 1.6 x 0.8 x 0.74 m.
    Table,
    /// A chair, 0.45 x 0.45 x 0.9 m; people sit on it.
    Chair,
    /// A sofa, 0.9 x 1.9 x 0.8 m; people sit on it.
    Sofa,
    /// A cabinet, 0.45 x 1.0 x 1.8 m.
    Cabinet,
    /// A shelf full of things, 0.3 x 1.0 x 1.9 m.
    Shelf,
    /// A pillar from floor to ceiling, 0.4 x 0.4 m.
    Pillar,
    /// A screen or partition, 0.05 x 1.2 x 1.8 m.
    Screen,
    /// A board or television on a wall, 0.05 x 1.4 x 0.9 m, a metre above the floor.
    Board,
    /// A box, 0.5 x 0.5 x 0.5 m.
    Box,
}

/// Furniture or an occluder.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawFurniture {
    /// What it is. Default `box`.
    pub kind: Option<FurnitureKind>,
    /// Its name, unique in the scenario. Default: kind and number.
    pub name: Option<String>,
    /// The place of its middle on the floor, metres.
    pub at: Option<[f64; 2]>,
    /// Length, width and height, metres. Default: of its kind.
    pub size: Option<[f64; 3]>,
    /// Where it faces, degrees. Default 0.
    pub turn: Option<f64>,
    /// How high above the floor it begins, metres. Default 0, of a board 1.
    pub above: Option<f64>,
    /// What it looks like. Default: of its kind, drawn from the seed.
    pub material: Option<RawMaterial>,
}

/// A lamp or a window.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawLight {
    /// Its place, metres.
    pub at: Option<[f64; 3]>,
    /// How bright: what a white surface that faces it at one metre reflects. Default 1.5.
    pub strength: Option<f64>,
    /// Its colour. Default white.
    pub colour: Option<String>,
    /// From times on it is so bright, of its strength: `[[seconds, factor], ...]`. Default: always 1.
    pub changes: Vec<[f64; 2]>,
}
