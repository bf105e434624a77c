//! The published result of a tick, as written to `scenes.jsonl`. Units are in the names; the JSON schema is generated
//! from these types by [`scene_schema`].

use crate::finite::is_finite;
use crate::moment::Fault;
use crate::picture::Rectangle;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Version of the scene record. A reader must refuse a larger major part.
pub const SCENE_SCHEMA_VERSION: &str = "1.1";

/// Everything that is known about the room at one tick.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Scene {
    /// Version of this record, "major.minor".
    pub schema: String,
    /// Number of the tick, from 0.
    pub tick: u64,
    /// Time on the common clock, seconds.
    pub time_s: f64,
    /// Every published track, by ascending identity.
    pub tracks: Vec<TrackRecord>,
    /// Everything heard, whether or not it belongs to a track.
    pub sounds: Vec<SoundRecord>,
    /// The track that speaks, or null for nobody. Null as well where nobody can tell (no sound).
    pub speaker: Option<u64>,
    /// Probability that no published track speaks, 0 to 1; null without sound.
    pub nobody_probability: Option<f64>,
    /// The track that spoke last, whether or not it still speaks or is still there; left out where the system does not
    /// keep it. Since 1.1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last_speaker: Option<u64>,
    /// What went wrong since the tick before.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<Fault>,
}

impl Scene {
    /// Takes out every record that holds a number that is not finite, which JSON could only write as null, and returns
    /// how many there were. A time that is not finite becomes 0, a probability that is not is nothing, and nobody speaks
    /// whose track was taken out.
    ///
    /// ```
    /// use hearsight_core::record::Scene;
    ///
    /// let mut scene = Scene { nobody_probability: Some(f64::NAN), ..Scene::default() };
    /// assert_eq!(scene.set_aside_non_finite(), 1);
    /// assert_eq!(scene.nobody_probability, None);
    /// ```
    pub fn set_aside_non_finite(&mut self) -> u64 {
        if is_finite(self) {
            return 0;
        }
        let records = |scene: &Self| scene.tracks.len() + scene.sounds.len() + scene.faults.len();
        let before = records(self);
        self.tracks.retain(is_finite);
        self.sounds.retain(is_finite);
        self.faults.retain(is_finite);
        let is_there = |id: &u64| self.tracks.iter().any(|track| track.id == *id);
        self.speaker = self.speaker.filter(is_there);
        let mut set_aside = (before - records(self)) as u64;
        if self
            .nobody_probability
            .is_some_and(|probability| !probability.is_finite())
        {
            self.nobody_probability = None;
            set_aside += 1;
        }
        if !self.time_s.is_finite() {
            self.time_s = 0.0;
            set_aside += 1;
        }
        set_aside
    }
}

/// One person.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TrackRecord {
    /// Number of the person, from 1, never given twice in a run.
    pub id: u64,
    /// Where the track is in its life.
    pub phase: TrackPhase,
    /// Probability that the person exists, 0 to 1.
    pub existence: f64,
    /// The person in each camera that looks at them.
    pub views: Vec<ViewRecord>,
    /// Place of the mouth in the world, metres; null where the system knows only pictures.
    pub position_m: Option<[f64; 3]>,
    /// Standard deviations of `position_m`, (x, y, z), metres; left out where the system does not know. Since 1.1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deviation_m: Option<[f64; 3]>,
    /// Whether this track is the one that speaks.
    pub speaking: bool,
    /// Probability of that, 0 to 1; null without sound.
    pub speaking_probability: Option<f64>,
    /// Effective number of particles of the belief, 1 to their number.
    pub effective_sample_size: f64,
}

/// Where a track is in its life.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TrackPhase {
    /// Seen now.
    Visible,
    /// Believed to be there, but hidden.
    Occluded,
}

/// A person in one camera.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ViewRecord {
    /// The camera's name.
    pub camera: String,
    /// The camera's own frame number, from 1.
    pub frame: u64,
    /// The head, pixels: edges, not centres.
    pub head: BoxRecord,
    /// Standard deviation of the head's centre, (x, y), pixels.
    pub deviation_px: [f64; 2],
}

/// A box in a picture, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BoxRecord {
    /// Left edge.
    pub left: f64,
    /// Top edge.
    pub top: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

/// Something heard.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SoundRecord {
    /// The array's name.
    pub array: String,
    /// Delay of the first pair, t_i - t_j, seconds.
    pub delay_s: f64,
    /// Column of the picture that the delay points at, pixels; null where it is outside or unknown.
    pub column_px: Option<f64>,
    /// Signal to noise ratio, decibels.
    pub signal_to_noise_db: f64,
    /// Whether the delay was measured at the onset of a sound, before its reverberation.
    pub from_onset: bool,
    /// Place in the world, metres; left out where the system knows only delays. Since 1.1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_m: Option<[f64; 3]>,
    /// Standard deviations of `position_m`, (x, y, z), metres. Since 1.1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deviation_m: Option<[f64; 3]>,
    /// The track that it belongs to, or null.
    pub track: Option<u64>,
}

impl From<Rectangle> for BoxRecord {
    fn from(r: Rectangle) -> Self {
        Self {
            left: r.left.into(),
            top: r.top.into(),
            width: r.width.into(),
            height: r.height.into(),
        }
    }
}

/// The JSON schema of [`Scene`], generated from the types.
pub fn scene_schema() -> serde_json::Value {
    schemars::schema_for!(Scene).to_value()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_with_a_bad_number_are_set_aside_and_the_others_stay() {
        let track = |id, existence| TrackRecord {
            id,
            phase: TrackPhase::Visible,
            existence,
            views: vec![],
            position_m: None,
            deviation_m: None,
            speaking: false,
            speaking_probability: None,
            effective_sample_size: 1.0,
        };
        let sound = |column_px| SoundRecord {
            array: "pair".into(),
            delay_s: 0.0,
            column_px,
            signal_to_noise_db: 1.0,
            from_onset: false,
            position_m: None,
            deviation_m: None,
            track: None,
        };
        let mut scene = Scene {
            tracks: vec![track(1, 0.9), track(2, f64::NAN), track(3, 0.8)],
            sounds: vec![sound(Some(f64::INFINITY)), sound(Some(3.0)), sound(None)],
            speaker: Some(2),
            ..Scene::default()
        };
        assert_eq!(scene.set_aside_non_finite(), 2);
        let left: Vec<u64> = scene.tracks.iter().map(|track| track.id).collect();
        assert_eq!((left, scene.sounds.len(), scene.speaker), (vec![1, 3], 2, None));
        assert_eq!(scene.set_aside_non_finite(), 0);
        let written = serde_json::to_string(&scene).unwrap();
        assert_eq!(serde_json::from_str::<Scene>(&written).unwrap(), scene);
    }

    #[test]
    fn schema_names_every_field_of_a_scene() {
        let schema = scene_schema();
        let scene = Scene {
            faults: vec![],
            ..Scene::default()
        };
        let written = serde_json::to_value(&scene).unwrap();
        for key in written.as_object().unwrap().keys() {
            assert!(
                schema["properties"].get(key).is_some(),
                "{key} is not in the schema"
            );
        }
    }
}
