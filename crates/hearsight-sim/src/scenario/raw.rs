//! What people write in a scenario file: syntax only, nothing is drawn, opened or checked here.
//!
//! Every key has a default where one makes sense; an unknown key is an error. Times are seconds from the beginning of
//! the scenario, lengths metres, angles degrees counter-clockwise from the x axis seen from above, levels decibels,
//! paths relative to the file. Places on the floor are `[x, y]`, in the room `[x, y, z]`; the room spans from the origin
//! to its `size`.

use crate::voice::{TalkerKind, TurnSettings};
use crate::world::{GestureKind, Hair, NoiseKind, Pattern};
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
    /// Lamps and windows. Default: two lamps at the ceiling and a window, drawn from the seed.
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

/// A direction: degrees, the name of a person or of a thing in the room, or a place.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "a direction is degrees, a name, a place on the floor [x, y] or a place [x, y, z]"
)]
pub enum RawDirection {
    /// Degrees counter-clockwise from the x axis.
    Degrees(f64),
    /// Towards a person, camera, door or piece of furniture; of looks also `speaker` and `ahead`.
    Name(String),
    /// Towards a place on the floor, metres.
    Floor([f64; 2]),
    /// Towards a place, metres.
    Place([f64; 3]),
}

/// One person. Whatever is not said of looks and voice is drawn from the seed.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawPerson {
    /// Name, unique in the scenario. Default `person1`, `person2`, ...
    pub name: Option<String>,
    /// Where they are at the beginning, metres. Without it they are away until they enter.
    pub at: Option<[f64; 2]>,
    /// Where they face at the beginning. Default: the middle of the room.
    pub facing: Option<RawDirection>,
    /// Name of the furniture that they sit on at the beginning, or `here`. Default: they stand.
    pub sit: Option<String>,
    /// Where they look at the beginning. Default `ahead`.
    pub look: Option<RawDirection>,
    /// Height, metres, 0.8 to 2.2. Default: drawn, 1.55 to 1.92.
    pub height: Option<f64>,
    /// Breadth of the body over the usual one, 0.7 to 1.5. Default: drawn.
    pub build: Option<f64>,
    /// Colour of the skin.
    pub skin: Option<String>,
    /// Colour of the hair.
    pub hair: Option<String>,
    /// How the hair is worn.
    pub hair_style: Option<Hair>,
    /// Colour of the eyes.
    pub eyes: Option<String>,
    /// Shirt, pullover or jacket.
    pub top: Option<RawMaterial>,
    /// Trousers or skirt.
    pub bottom: Option<RawMaterial>,
    /// Whether sleeves reach the hands.
    pub long_sleeves: Option<bool>,
    /// A photograph of a face, upright and cropped to it, to be used instead of a drawn one.
    pub face: Option<String>,
    /// What distinguishes what is drawn of this person. Default: from the scenario's seed and the name.
    pub seed: Option<u64>,
    /// The voice.
    pub voice: RawVoice,
    /// When they speak: `[[from, until], ...]`, seconds, in order.
    pub turns: Vec<[f64; 2]>,
    /// What they do, in order of time.
    pub action: Vec<RawAction>,
}

/// A voice.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawVoice {
    /// Level one metre before the mouth, decibels relative to full scale. Default -30.
    pub level: Option<f64>,
    /// Whose voice the built-in talker has. Default: drawn; a child's of who is lower than 1.45 m.
    pub kind: Option<TalkerKind>,
    /// A folder of recorded speech (WAV, FLAC) to be spoken instead.
    pub recording: Option<String>,
}

/// Something that a person does: a time and exactly one of the keys from `walk` to `gesture`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawAction {
    /// When it begins, seconds.
    pub time: Option<f64>,
    /// Walks through places on the floor: `[[x, y], ...]`, metres. Who sits stands up before.
    pub walk: Vec<[f64; 2]>,
    /// Walks about in a part of the room, resting now and then: two opposite corners, metres. Needs `until`.
    pub wander: Option<[[f64; 2]; 2]>,
    /// Sits down: the name of a chair or sofa no further than 1.2 m away, or `here`.
    pub sit: Option<String>,
    /// Stands up.
    pub stand: Option<bool>,
    /// Turns the body.
    pub turn: Option<RawDirection>,
    /// Looks somewhere from then on: a direction, a name, `speaker` (whoever speaks) or `ahead`.
    pub look: Option<RawDirection>,
    /// Jerks aside by so much, `[x, y]`, metres.
    pub jerk: Option<[f64; 2]>,
    /// Leaves by the door of this name.
    pub leave: Option<String>,
    /// Comes in by the door of this name, and walks on through the places of `walk`, if any.
    pub enter: Option<String>,
    /// Makes a gesture.
    pub gesture: Option<GestureKind>,
    /// Speed of a walk, metres a second. Default 1.1.
    pub speed: Option<f64>,
    /// When a walk arrives, seconds, instead of a speed; when wandering ends.
    pub until: Option<f64>,
    /// How long a gesture (default 2), a turn (default: as people do) or a jerk (default 0.3) takes, seconds.
    pub seconds: Option<f64>,
    /// Sweeps, waves or nods a second of a gesture. Default: of its kind.
    pub rate: Option<f64>,
}

/// A conversation, whose turns are drawn.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawConversation {
    /// Names of those who take part. Default: everybody.
    pub people: Vec<String>,
    /// When it begins, seconds. Default 0.5.
    pub from: Option<f64>,
    /// When it ends, seconds. Default: half a second before the scenario does.
    pub until: Option<f64>,
    /// How it goes.
    pub turns: TurnSettings,
}

/// A sound that is not speech of people.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawNoise {
    /// What it is.
    pub kind: Option<NoiseKind>,
    /// Its name, unique in the scenario. Default: kind and number.
    pub name: Option<String>,
    /// Its place, metres; without place, person and base it comes from everywhere.
    pub at: Option<[f64; 3]>,
    /// Name of the person from whose mouth it comes.
    pub person: Option<String>,
    /// Name of the base that it is on; of a `motor` the faster the base moves, the louder.
    pub base: Option<String>,
    /// Level at one metre while it sounds (of a diffuse sound: at the microphones), decibels relative to full scale.
    /// Default -45.
    pub level: Option<f64>,
    /// Instead of a level: how many decibels it is below the speech of people at the microphones, on average.
    pub snr: Option<f64>,
    /// When it sounds: `[[from, until], ...]`, seconds. Default: always. Of coughs, laughs and claps only the beginnings
    /// count.
    pub during: Vec<[f64; 2]>,
    /// Middle and width of a `band`, hertz. Default `[1000, 200]`.
    pub band: Option<[f64; 2]>,
    /// A folder of recordings (WAV, FLAC) to be played instead of what is built in.
    pub recording: Option<String>,
}

/// Something that moves and carries sensors.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawBase {
    /// Name, unique in the scenario. Default `base1`, ...
    pub name: Option<String>,
    /// Where it is at the beginning, metres.
    pub at: Option<[f64; 2]>,
    /// Where it looks at the beginning. Default 0.
    pub facing: Option<RawDirection>,
    /// The fastest that it drives, metres a second. Default 0.8.
    pub speed: Option<f64>,
    /// The fastest that it turns, degrees a second. Default 60.
    pub turn_speed: Option<f64>,
    /// From a command to its obedience, seconds. Default 0.1.
    pub latency: Option<f64>,
    /// What it does by itself: `walk` (drives) and `turn`.
    pub action: Vec<RawAction>,
    /// Commands to it, which end what it does by itself.
    pub command: Vec<RawCommand>,
}

/// A command of the scenario to one of its devices: a time, and where to go or how fast to go on.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawCommand {
    /// When it is sent, seconds.
    pub time: Option<f64>,
    /// A camera pans to here, degrees to the left of where it is mounted. Default 0 where `tilt` or `zoom` is given.
    pub pan: Option<f64>,
    /// A camera tilts to here, degrees up.
    pub tilt: Option<f64>,
    /// A camera zooms to this factor.
    pub zoom: Option<f64>,
    /// A camera pans, or a base turns, on at this speed, degrees a second to the left.
    pub pan_speed: Option<f64>,
    /// A camera tilts on at this speed, degrees a second up.
    pub tilt_speed: Option<f64>,
    /// A base drives on at this speed, metres a second.
    pub drive: Option<f64>,
}

/// A kind of lens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LensKind {
    /// An ordinary lens.
    Pinhole,
    /// A fisheye.
    Fisheye,
    /// A cylindrical panorama.
    Panorama,
}

/// A camera, or several of a kind.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawCamera {
    /// Name, unique among all sensors; files are called by it. Default `cam1`, `cam2`, ...
    pub name: Option<String>,
    /// Width and height, pixels. Default `[640, 480]`.
    pub size: Option<[usize; 2]>,
    /// Frames a second. Default 15.
    pub rate: Option<f64>,
    /// The lens. Default `pinhole`.
    pub lens: Option<LensKind>,
    /// Angle from the left edge to the right, degrees. Default 60, of a fisheye 180, of a panorama 360.
    pub view: Option<f64>,
    /// Focal length, pixels, instead of `view`.
    pub focal: Option<f64>,
    /// Distortion of the lens: k1, k2, p1, p2, k3 of a pinhole, k1 to k4 of a fisheye. Default none.
    pub distortion: Vec<f64>,
    /// Its place, metres; on a base: forward, left and up from its middle on the floor.
    pub at: Option<[f64; 3]>,
    /// A place in the middle of its picture, metres; on a base, from the base. Instead of `pan` and `tilt`.
    pub look_at: Option<[f64; 3]>,
    /// Where it looks, degrees; on a base, to the left of where the base looks. Default 0.
    pub pan: Option<f64>,
    /// How far up it looks, degrees. Default 0.
    pub tilt: Option<f64>,
    /// How far its right side is lower, degrees. Default 0.
    pub roll: Option<f64>,
    /// Name of the base that carries it.
    pub base: Option<String>,
    /// Makes two cameras of it, `<name>-left` and `<name>-right`, so far apart, metres.
    pub stereo: Option<f64>,
    /// Makes so many cameras of it around one point, `<name>-1`, ..., each turned on by an equal part of 360 degrees.
    pub ring: Option<usize>,
    /// How far the cameras of a ring are from the point, metres. Default 0.05.
    pub ring_radius: Option<f64>,
    /// Makes it a camera that pans, tilts and zooms by commands.
    pub head: Option<RawHead>,
    /// Commands that the scenario itself sends to it.
    pub command: Vec<RawCommand>,
    /// Brightness: what is as bright as one over this is full scale. Default 1.
    pub exposure: Option<f64>,
    /// Gains of red, green and blue. Default `[1, 1, 1]`.
    pub white_balance: Option<[f64; 3]>,
    /// How far brightness and colours drift to and fro, a share of them, 0 to 0.5. Default 0.01.
    pub drift: Option<f64>,
    /// How long a drift there and back takes, seconds. Default 40.
    pub drift_period: Option<f64>,
    /// Jumps of the brightness: from times on a factor, `[[seconds, factor], ...]`.
    pub exposure_changes: Vec<[f64; 2]>,
    /// Jumps of the white balance: from times on gains, `[[seconds, red, green, blue], ...]`.
    pub white_balance_changes: Vec<[f64; 4]>,
    /// How long the shutter is open, seconds; longer blurs what moves. Default 0.012.
    pub shutter: Option<f64>,
    /// Noise in the dark, a share of full scale. Default 0.002.
    pub noise: Option<f64>,
    /// Variance that light adds, a share of full scale. Default 0.0001.
    pub shot_noise: Option<f64>,
    /// Its clock.
    pub clock: RawClock,
}

/// A head that pans, tilts and zooms.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawHead {
    /// The fastest that it pans, degrees a second. Default 80.
    pub pan_speed: Option<f64>,
    /// The fastest that it tilts, degrees a second. Default 50.
    pub tilt_speed: Option<f64>,
    /// The fastest that it zooms, factors a second. Default 4.
    pub zoom_speed: Option<f64>,
    /// How fast it gains speed, degrees a second squared. Default 600.
    pub acceleration: Option<f64>,
    /// How far it pans right and left, degrees. Default `[-170, 170]`.
    pub pan_range: Option<[f64; 2]>,
    /// How far it tilts down and up, degrees. Default `[-30, 90]`.
    pub tilt_range: Option<[f64; 2]>,
    /// The longest focal length over the shortest. Default 12.
    pub zoom: Option<f64>,
    /// From a command to its obedience, seconds. Default 0.06.
    pub latency: Option<f64>,
}

/// The clock of a sensor.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawClock {
    /// When it takes its first frame or sample, seconds, 0 or more. Default 0.
    pub offset: Option<f64>,
    /// How much too fast it runs, parts per million. Default 0.
    pub drift: Option<f64>,
    /// Whether `room.toml` tells both; otherwise it is for others to find out. Default false.
    pub declared: Option<bool>,
}

/// The shape of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ArrayShape {
    /// Two microphones, `spacing` apart.
    Pair,
    /// `count` microphones in a line, `spacing` from one to the next.
    Line,
    /// `count` microphones on a level circle of `radius`.
    Circle,
}

/// A microphone array: `microphones`, or a `shape` at a place.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RawArray {
    /// Name, unique among all sensors; files are called by it. Default `array1`, ...
    pub name: Option<String>,
    /// Samples a second. Default 16000.
    pub rate: Option<u32>,
    /// Place of each microphone, metres; on a base: forward, left and up from its middle on the floor.
    pub microphones: Vec<[f64; 3]>,
    /// The shape, where no microphones are given. Default `circle`.
    pub shape: Option<ArrayShape>,
    /// Its middle, metres.
    pub at: Option<[f64; 3]>,
    /// Where it looks, degrees: pairs and lines lie across, the first microphone to the left; the first microphone of a
    /// circle is there. Default 0.
    pub facing: Option<f64>,
    /// Number of microphones of a line (default 4) or a circle (default 8).
    pub count: Option<usize>,
    /// From one microphone to the next, metres. Default 0.2.
    pub spacing: Option<f64>,
    /// Radius of a circle, metres. Default 0.1.
    pub radius: Option<f64>,
    /// Name of the base that carries it.
    pub base: Option<String>,
    /// Name of the camera that it is paired with in `room.toml`. Default: the camera, where there is exactly one.
    pub camera: Option<String>,
    /// How far gains of microphones differ, decibels. Default 1.
    pub gain_mismatch: Option<f64>,
    /// How far microphones are late, seconds. Default 0.000005.
    pub delay_mismatch: Option<f64>,
    /// How far the lower ends of their responses differ, a share. Default 0.2.
    pub corner_mismatch: Option<f64>,
    /// Noise of each microphone itself, decibels relative to full scale. Default -80.
    pub noise: Option<f64>,
    /// Samples that never arrive: `[[from, until], ...]`, seconds.
    pub lost: Vec<[f64; 2]>,
    /// Share of the sound that never arrives, in blocks of `lost_block`, drawn from the seed, 0 to 0.9. Default 0.
    pub lost_share: Option<f64>,
    /// Length of a lost block, seconds. Default 0.02.
    pub lost_block: Option<f64>,
    /// Its clock.
    pub clock: RawClock,
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
