//! What does not move by itself: the room, its furniture and lights, and how people look.

use hearsight_core::WorldPoint;
use serde::{Deserialize, Serialize};

/// A colour, red, green, blue, each 0 to 1, as light reflects it (linear, not gamma-compressed).
pub type Colour = [f32; 3];

/// How a surface is painted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Pattern {
    /// One colour.
    Plain,
    /// Stripes of the two colours, upright.
    Stripes,
    /// Squares of the two colours.
    Squares,
    /// Clouds of the two colours.
    Clouds,
    /// Planks or shelves: lines of the second colour, lying.
    Planks,
    /// Small things of many colours, as on a shelf or a pin board.
    Clutter,
}

/// What a surface looks like.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Main colour.
    pub colour: Colour,
    /// Second colour of the pattern.
    pub second: Colour,
    /// The pattern.
    pub pattern: Pattern,
    /// Size of one repetition, metres.
    pub scale_m: f32,
    /// What distinguishes this surface's random details.
    pub seed: u64,
}

/// Furniture or an occluder: a box standing upright.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Block {
    /// Its name.
    pub name: String,
    /// Its middle, metres.
    pub centre: WorldPoint,
    /// Length, width and height, metres.
    pub size_m: [f64; 3],
    /// Turned counter-clockwise seen from above, radians.
    pub yaw_rad: f64,
    /// What it looks like.
    pub material: Material,
}

/// A lamp or a window.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Light {
    /// Where it is, metres.
    pub position: WorldPoint,
    /// Its colour and strength: what a white surface that faces it at one metre reflects.
    pub colour: Colour,
}

/// How the hair is worn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Hair {
    /// None.
    Bald,
    /// Above the ears.
    Short,
    /// To the shoulders.
    Long,
}

/// What someone wears.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wear {
    /// Shirt, pullover or jacket.
    pub top: Material,
    /// Trousers or skirt.
    pub bottom: Material,
    /// Whether sleeves reach the hands.
    pub long_sleeves: bool,
}

/// How one person looks, always.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Looks {
    /// Height when standing upright, metres.
    pub height_m: f64,
    /// Breadth of the body over the usual one, 0.7 to 1.5.
    pub build: f64,
    /// Half axes of the head (forward, left, up), metres.
    pub head_half_axes_m: [f64; 3],
    /// Skin.
    pub skin: Colour,
    /// Hair.
    pub hair: Colour,
    /// How the hair is worn.
    pub hair_style: Hair,
    /// The iris.
    pub eyes: Colour,
    /// Clothing.
    pub wear: Wear,
    /// A photograph of a face to be used instead of a drawn one: row-major R, G, B bytes with width and height.
    #[serde(skip)]
    pub face: Option<std::sync::Arc<(usize, usize, Vec<u8>)>>,
    /// What distinguishes this face's proportions from others.
    pub seed: u64,
}

/// The room and what stands in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// Length, width and height, metres: the room spans from `origin` to `origin` plus this.
    pub size_m: [f64; 3],
    /// The corner with the smallest coordinates; its z is 0.
    pub origin: WorldPoint,
    /// Floor, ceiling and the four walls (at the smallest x, the largest x, the smallest y, the largest y).
    pub surfaces: [Material; 6],
    /// Furniture and occluders.
    pub blocks: Vec<Block>,
    /// Lamps and windows.
    pub lights: Vec<Light>,
    /// Light from everywhere: what a white surface reflects of it.
    pub ambient: Colour,
}
