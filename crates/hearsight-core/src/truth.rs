//! What is really so, as a simulation knows it: one line of `truth.jsonl` a tick. Only judges read it; nothing that tracks
//! may. Units are in the names; the JSON schema is generated from these types by [`truth_schema`].
//!
//! A directory of truth holds, beside `truth.jsonl`, the same for other tools: `<camera>.gt.txt`, rows of MOTChallenge's
//! ground truth `frame,id,left,top,width,height,consider,class,visibility` with head boxes, and `speech.rttm`, whose
//! speakers bear the names of the people.

use crate::record::BoxRecord;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Version of the truth record. A reader must refuse a larger major part.
pub const TRUTH_SCHEMA_VERSION: &str = "1.0";

/// Everything that is so in the room at one instant.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TruthRecord {
    /// Version of this record, "major.minor".
    pub schema: String,
    /// Number of the tick, from 0.
    pub tick: u64,
    /// Time on the common clock, seconds.
    pub time_s: f64,
    /// Every person of the scenario, also who is not in the room, by ascending identity.
    pub people: Vec<PersonTruth>,
    /// Every source of sound that is not a person, in the order of the scenario.
    #[serde(default)]
    pub sounds: Vec<SoundTruth>,
}

/// One person at one instant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PersonTruth {
    /// Number of the person, from 1, the same in the whole scenario.
    pub id: u64,
    /// Name of the person, unique in the scenario.
    pub name: String,
    /// Whether the person is in the room. Who is not has no place, no views, and does not speak.
    pub present: bool,
    /// Centre of the head in the world, metres; null where the person is not in the room.
    pub head_m: Option<[f64; 3]>,
    /// Place of the mouth in the world, metres; null where the person is not in the room.
    pub mouth_m: Option<[f64; 3]>,
    /// Where the face looks, the angle about the vertical axis from the x axis of the world towards its y axis, radians,
    /// -pi to pi; null where the person is not in the room.
    pub head_yaw_rad: Option<f64>,
    /// Whether the person's voice sounds now: pauses within a turn are silence.
    pub speaking: bool,
    /// The person in each camera that looks at them: whose head or body is in the picture, hidden or not. Only cameras
    /// that have a new frame at this tick.
    pub views: Vec<ViewTruth>,
}

/// A person in one picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ViewTruth {
    /// The camera's name.
    pub camera: String,
    /// The camera's own frame number, from 1.
    pub frame: u64,
    /// The whole head with its hair as if nothing hid it, pixels: edges, which may reach out of the picture; null where
    /// no part of it is within the picture or it is behind the camera.
    pub head: Option<BoxRecord>,
    /// The whole person as if nothing hid them, pixels: edges, as with the head; null where no part is within the picture.
    pub body: Option<BoxRecord>,
    /// Fraction of the head's silhouette that is within the picture and hidden by nothing, 0 to 1.
    pub head_visible: f64,
    /// Fraction of the person's silhouette that is within the picture and hidden by nothing, 0 to 1.
    pub body_visible: f64,
}

/// A source of sound that is not a person: a fan, a loudspeaker, a telephone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SoundTruth {
    /// Its name, unique in the scenario.
    pub name: String,
    /// Where it is in the world, metres.
    pub position_m: [f64; 3],
    /// Whether it sounds now.
    pub sounding: bool,
}

/// The JSON schema of [`TruthRecord`], generated from the types.
pub fn truth_schema() -> serde_json::Value {
    schemars::schema_for!(TruthRecord).to_value()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record() -> TruthRecord {
        let head = BoxRecord {
            left: -3.5,
            top: 10.0,
            width: 30.0,
            height: 1.0 / 3.0,
        };
        let person = |id: u64, present: bool| PersonTruth {
            id,
            name: format!("person {id}"),
            present,
            head_m: present.then_some([1.0, -2.0, 1.5]),
            mouth_m: present.then_some([1.1, -2.0, 1.4]),
            head_yaw_rad: present.then_some(-3.0),
            speaking: present,
            views: if present {
                vec![ViewTruth {
                    camera: "front".into(),
                    frame: 8,
                    head: Some(head),
                    body: None,
                    head_visible: 0.25,
                    body_visible: 0.0,
                }]
            } else {
                vec![]
            },
        };
        TruthRecord {
            schema: TRUTH_SCHEMA_VERSION.into(),
            tick: 7,
            time_s: 0.28,
            people: vec![person(1, true), person(2, false)],
            sounds: vec![SoundTruth {
                name: "fan".into(),
                position_m: [0.0, 1.0, 2.0],
                sounding: true,
            }],
        }
    }

    #[test]
    fn a_record_comes_back_unchanged_from_its_line() {
        let line = serde_json::to_string(&record()).unwrap();
        assert!(!line.contains('\n'), "a record is one line");
        assert_eq!(serde_json::from_str::<TruthRecord>(&line).unwrap(), record());
    }

    #[test]
    fn the_schema_names_and_describes_every_field() {
        let schema = truth_schema();
        let written = serde_json::to_value(record()).unwrap();
        for (place, value) in [
            ("/properties", &written),
            ("/$defs/PersonTruth/properties", &written["people"][0]),
            ("/$defs/ViewTruth/properties", &written["people"][0]["views"][0]),
            ("/$defs/SoundTruth/properties", &written["sounds"][0]),
        ] {
            for key in value.as_object().unwrap().keys() {
                let field = &schema.pointer(place).unwrap()[key];
                assert!(field["description"].is_string(), "{place}/{key}: {field}");
            }
        }
    }
}
