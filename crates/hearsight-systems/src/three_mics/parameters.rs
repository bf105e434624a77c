//! Parameters of the three-mics system: what the paper gives, and proposals where it is silent.

use hearsight_tracking::face::FaceSettings;
use hearsight_tracking::percepts::{FaceWindowSettings, SteeredArraySettings};
use hearsight_tracking::sight_and_sound::{ActivitySettings, AssociationSettings, PlaceSettings};
use hearsight_tracking::sound::SoundSettings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The room as a box in the world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RoomBox {
    /// Least x, y, z, metres; the least z is the floor.
    pub low_m: [f64; 3],
    /// Greatest x, y, z, metres.
    pub high_m: [f64; 3],
}

/// All parameters, each with its default.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Parameters {
    /// Where sounds can come from, `{ low_m = [x, y, z], high_m = [x, y, z] }`; its lower side is the floor, from which
    /// heights are measured. Default: 4 m around all sensors, from 1.5 m below the lowest to 1 m above the highest:
    /// better give it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub room: Option<RoomBox>,
    /// How sound is listened to. `audio.response.combination` is the product of all pairs or their sum (eq. 12).
    #[schemars(with = "Value")]
    pub audio: SteeredArraySettings,
    /// How a sound is followed in the room (section 2).
    pub sound: SoundSettings,
    /// How windows of face cascades are sought.
    #[schemars(with = "Value")]
    pub vision: FaceWindowSettings,
    /// How faces are followed in pictures (section 3).
    pub faces: FaceSettings,
    /// Which face a sound may belong to (section 4).
    pub association: AssociationSettings,
    /// Who speaks.
    pub activity: ActivitySettings,
    /// Where people are; only in the weighted form.
    pub place: PlaceSettings,
    /// What is not in the paper.
    pub beyond: Beyond,
}

/// What is not in the paper, and can be left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Beyond {
    /// Whether frames without voice, as far as their energy tells, are silence. Default true; false lets only faces
    /// decide whether there is speech, as in the paper.
    pub voice_gate: bool,
    /// Whether the width of a face says how far it is, and not only whether it can be one. Default true.
    pub face_range: bool,
    /// Whether frames of sound are asked how well they fit where the faces are, and who speaks is decided by that and by
    /// the energy of voice. Default true; false decides by the association of the followed sound, as in the paper.
    pub at_faces: bool,
}

impl Default for Beyond {
    fn default() -> Self {
        Self {
            voice_gate: true,
            face_range: true,
            at_faces: true,
        }
    }
}
