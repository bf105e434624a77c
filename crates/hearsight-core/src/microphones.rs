//! Microphone arrays: where the microphones are and when a sound reaches them.
//!
//! Delays are exact for near sources: a spherical wave, no far-field approximation. Nothing here touches samples.

use crate::camera::InvalidParameter;
use crate::geometry::WorldPoint;
use nalgebra::{Unit, Vector3};
use serde::{Deserialize, Serialize};

/// Speed of sound in air at 20 degrees Celsius, metres a second.
pub const SPEED_OF_SOUND_M_S: f64 = 343.0;

/// Two microphones at the same place would have a delay of zero for every source.
const SMALLEST_BASELINE_M: f64 = 1e-6;

/// Microphones that are sampled by one clock. At least one, all at different finite places.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ArrayFields", into = "ArrayFields")]
pub struct MicrophoneArray {
    name: Option<String>,
    positions: Vec<WorldPoint>,
    speed_of_sound_m_s: f64,
}

/// Two microphones of an array; the delay of the pair is t_i - t_j.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MicrophonePair {
    /// Channel of the first microphone, i.
    pub first: usize,
    /// Channel of the second microphone, j.
    pub second: usize,
    /// Where the first microphone is.
    pub first_position: WorldPoint,
    /// Where the second microphone is.
    pub second_position: WorldPoint,
    /// Speed of sound, metres a second.
    pub speed_of_sound_m_s: f64,
}

/// The array as it is written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ArrayFields {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    positions_m: Vec<WorldPoint>,
    #[serde(default = "default_speed_of_sound")]
    speed_of_sound_m_s: f64,
}

const fn default_speed_of_sound() -> f64 {
    SPEED_OF_SOUND_M_S
}

impl MicrophoneArray {
    /// An array without a name at [`SPEED_OF_SOUND_M_S`], one position a channel.
    ///
    /// # Errors
    /// Without microphones, where a coordinate is not finite, or where two microphones are at the same place.
    pub fn new(positions: Vec<WorldPoint>) -> Result<Self, InvalidParameter> {
        let invalid = |value: String, requirement| InvalidParameter {
            field: "positions_m",
            value,
            requirement,
        };
        if positions.is_empty() {
            return Err(invalid("empty".into(), "one position a channel"));
        }
        for (channel, position) in positions.iter().enumerate() {
            let text = || format!("{:?} for channel {channel}", position.0.coords.as_slice());
            if !position.0.iter().all(|coordinate| coordinate.is_finite()) {
                return Err(invalid(text(), "finite"));
            }
            if positions[..channel]
                .iter()
                .any(|other| other.distance_m(*position) < SMALLEST_BASELINE_M)
            {
                return Err(invalid(text(), "different from that of every other channel"));
            }
        }
        Ok(Self {
            name: None,
            positions,
            speed_of_sound_m_s: SPEED_OF_SOUND_M_S,
        })
    }

    /// The array under a name.
    #[must_use]
    pub fn named(self, name: impl Into<String>) -> Self {
        Self {
            name: Some(name.into()),
            ..self
        }
    }

    /// The array at another speed of sound, metres a second.
    ///
    /// # Errors
    /// Where the speed is not finite and positive.
    pub fn with_speed_of_sound(self, speed_of_sound_m_s: f64) -> Result<Self, InvalidParameter> {
        if speed_of_sound_m_s.is_finite() && speed_of_sound_m_s > 0.0 {
            return Ok(Self {
                speed_of_sound_m_s,
                ..self
            });
        }
        Err(InvalidParameter {
            field: "speed_of_sound_m_s",
            value: speed_of_sound_m_s.to_string(),
            requirement: "finite and positive",
        })
    }

    /// Its name, where it has one.
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// Where the microphones are, one position a channel.
    pub fn positions(&self) -> &[WorldPoint] {
        &self.positions
    }

    /// Speed of sound, metres a second.
    pub const fn speed_of_sound_m_s(&self) -> f64 {
        self.speed_of_sound_m_s
    }

    /// The mean of the positions.
    pub fn centre(&self) -> WorldPoint {
        let sum: Vector3<f64> = self.positions.iter().map(|position| position.0.coords).sum();
        WorldPoint((sum / self.positions.len() as f64).into())
    }

    /// The pair of channels (i, j), or `None` where one does not exist or both are the same.
    pub fn pair(&self, first: usize, second: usize) -> Option<MicrophonePair> {
        if first == second {
            return None;
        }
        Some(MicrophonePair {
            first,
            second,
            first_position: *self.positions.get(first)?,
            second_position: *self.positions.get(second)?,
            speed_of_sound_m_s: self.speed_of_sound_m_s,
        })
    }

    /// Every pair (i, j) with i < j, by ascending i, then j: n (n - 1) / 2 of them.
    pub fn pairs(&self) -> impl Iterator<Item = MicrophonePair> + '_ {
        let count = self.positions.len();
        (0..count)
            .flat_map(move |first| (first + 1..count).filter_map(move |second| self.pair(first, second)))
    }

    /// Delay t_i - t_j of a sound at `source`, seconds; `None` where [`MicrophoneArray::pair`] gives none.
    pub fn delay_s(&self, first: usize, second: usize, source: WorldPoint) -> Option<f64> {
        self.pair(first, second).map(|pair| pair.delay_s(source))
    }

    /// The longest delay of any pair, seconds; 0 for a single microphone.
    pub fn max_delay_s(&self) -> f64 {
        self.pairs().map(|pair| pair.max_delay_s()).fold(0.0, f64::max)
    }
}

impl MicrophonePair {
    /// Delay t_i - t_j = (|x - m_i| - |x - m_j|) / c of a sound at `source`, seconds: positive where the sound is
    /// nearer to the second microphone.
    pub fn delay_s(&self, source: WorldPoint) -> f64 {
        (source.distance_m(self.first_position) - source.distance_m(self.second_position))
            / self.speed_of_sound_m_s
    }

    /// The delay's derivative by the source's coordinates, seconds a metre. A microphone in the very place of the
    /// source, where its distance has no derivative, counts as zero.
    pub fn delay_gradient_s_per_m(&self, source: WorldPoint) -> Vector3<f64> {
        let away = |microphone: WorldPoint| {
            (source.0 - microphone.0)
                .try_normalize(0.0)
                .unwrap_or_else(Vector3::zeros)
        };
        (away(self.first_position) - away(self.second_position)) / self.speed_of_sound_m_s
    }

    /// Delay of a plane wave from `direction` (from the array towards the source), seconds.
    pub fn far_delay_s(&self, direction: Unit<Vector3<f64>>) -> f64 {
        (self.second_position.0 - self.first_position.0).dot(&direction) / self.speed_of_sound_m_s
    }

    /// Distance of the microphones, metres.
    pub fn baseline_m(&self) -> f64 {
        self.first_position.distance_m(self.second_position)
    }

    /// The largest magnitude that a delay can have, seconds.
    pub fn max_delay_s(&self) -> f64 {
        self.baseline_m() / self.speed_of_sound_m_s
    }
}

impl TryFrom<ArrayFields> for MicrophoneArray {
    type Error = InvalidParameter;
    fn try_from(fields: ArrayFields) -> Result<Self, InvalidParameter> {
        let array = Self::new(fields.positions_m)?.with_speed_of_sound(fields.speed_of_sound_m_s)?;
        Ok(Self {
            name: fields.name,
            ..array
        })
    }
}

impl From<MicrophoneArray> for ArrayFields {
    fn from(array: MicrophoneArray) -> Self {
        Self {
            name: array.name,
            positions_m: array.positions,
            speed_of_sound_m_s: array.speed_of_sound_m_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn circle(count: usize) -> MicrophoneArray {
        let position = |index: usize| {
            let angle = std::f64::consts::TAU * index as f64 / count as f64;
            WorldPoint::new(0.1 * angle.cos(), 0.4 + 0.1 * angle.sin(), 0.0)
        };
        MicrophoneArray::new((0..count).map(position).collect()).unwrap()
    }

    #[test]
    fn the_nearer_microphone_hears_first() {
        let array = MicrophoneArray::new(vec![
            WorldPoint::new(0.0, 0.0, 0.0),
            WorldPoint::new(0.2, 0.0, 0.0),
        ])
        .unwrap();
        let delay = array.delay_s(0, 1, WorldPoint::new(5.0, 0.0, 0.0)).unwrap();
        assert!((delay - 0.2 / 343.0).abs() < 1e-15);
        assert_eq!(array.delay_s(1, 0, WorldPoint::new(5.0, 0.0, 0.0)), Some(-delay));
        assert_eq!(array.delay_s(0, 2, WorldPoint::new(5.0, 0.0, 0.0)), None);
        assert_eq!(array.pair(1, 1), None);
        assert!((array.max_delay_s() - delay).abs() < 1e-15);
        let far = array.pair(0, 1).unwrap().far_delay_s(Vector3::x_axis());
        assert!((far - delay).abs() < 1e-15);
    }

    #[test]
    fn pairs_come_once_and_in_order() {
        let pairs: Vec<_> = circle(4).pairs().map(|pair| (pair.first, pair.second)).collect();
        assert_eq!(pairs, [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]);
        assert!(circle(8).centre().distance_m(WorldPoint::new(0.0, 0.4, 0.0)) < 1e-15);
    }

    #[test]
    fn impossible_arrays_are_refused() {
        let origin = WorldPoint::new(0.0, 0.0, 0.0);
        assert!(MicrophoneArray::new(vec![]).is_err());
        assert!(MicrophoneArray::new(vec![origin, origin]).is_err());
        assert!(MicrophoneArray::new(vec![WorldPoint::new(f64::NAN, 0.0, 0.0)]).is_err());
        assert!(circle(2).with_speed_of_sound(0.0).is_err());
        assert!(
            serde_json::from_str::<MicrophoneArray>(r#"{"positions_m": [[0, 0, 0], [0, 0, 0]]}"#).is_err()
        );
        let array = circle(3).named("table").with_speed_of_sound(340.0).unwrap();
        let text = serde_json::to_string(&array).unwrap();
        assert_eq!(serde_json::from_str::<MicrophoneArray>(&text).unwrap(), array);
    }

    proptest! {
        #[test]
        fn delays_stay_in_bounds_and_their_gradient_is_their_derivative(
            x in -3.0..3.0_f64, y in 1.0..4.0_f64, z in -1.0..2.0_f64,
        ) {
            let source = WorldPoint::new(x, y, z);
            for pair in circle(8).pairs() {
                prop_assert!(pair.delay_s(source).abs() <= pair.max_delay_s() * (1.0 + 1e-12));
                let gradient = pair.delay_gradient_s_per_m(source);
                for axis in 0..3 {
                    let mut step = Vector3::zeros();
                    step[axis] = 1e-5;
                    let ahead = pair.delay_s(WorldPoint(source.0 + step));
                    let behind = pair.delay_s(WorldPoint(source.0 - step));
                    prop_assert!((gradient[axis] - (ahead - behind) / 2e-5).abs() < 1e-9);
                }
            }
        }
    }
}
