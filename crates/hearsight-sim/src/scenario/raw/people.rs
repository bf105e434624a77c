//! People and sounds, as people write them.

use super::room::RawMaterial;
use crate::voice::{TalkerKind, TurnSettings};
use crate::world::{GestureKind, Hair, NoiseKind};
use schemars::JsonSchema;
use serde::Deserialize;

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
