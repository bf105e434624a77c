//! Where a person is in the room, as pictures and sounds come.
//!
//! A Gaussian that walks at random. What a face's width says of its distance, and what an array says of its own, is
//! wrong in the same way for a while; both therefore count once in [`PlaceSettings::independent_s`], not once a frame.

use super::lines::{SightLine, weighted};
use crate::sound::PointEstimate;
use hearsight_core::{Span, WorldPoint};
use nalgebra::Matrix3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How places are followed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PlaceSettings {
    /// Standard deviation of a step after one second, metres. Default 0.6. Raising it follows people who walk and
    /// smooths less.
    pub walk_m: f64,
    /// Time over which errors of range persist, seconds. Default 0.6.
    pub independent_s: f64,
}

impl Default for PlaceSettings {
    fn default() -> Self {
        Self {
            walk_m: 0.6,
            independent_s: 0.6,
        }
    }
}

/// Where a person is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// The person's identity.
    pub identity: u64,
    /// Where, and how sure.
    pub estimate: PointEstimate,
}

impl Place {
    /// A person seen for the first time; none where the sight says nothing of the distance.
    pub fn new(identity: u64, sight: &SightLine) -> Option<Self> {
        let estimate = sight.estimate()?;
        Some(Self { identity, estimate })
    }

    /// Lets `elapsed` pass and takes in a sight.
    pub fn see(&mut self, sight: &SightLine, elapsed: Span, settings: &PlaceSettings) {
        let seconds = elapsed.seconds().max(0.0);
        self.estimate.covariance += Matrix3::identity() * (settings.walk_m.powi(2) * seconds);
        let spread = spread(seconds, settings);
        let sight = SightLine {
            range_m: sight
                .range_m
                .map(|(range_m, deviation_m)| (range_m, deviation_m * spread)),
            deviation_rad: sight.deviation_rad * spread.min(ACROSS),
            ..*sight
        };
        if let Some(meeting) = weighted(&sight, &self.estimate) {
            self.take(meeting.point, meeting.covariance);
        }
    }

    /// Takes in the sound of a frame that belongs to this person, `elapsed` after the one before.
    pub fn hear(&mut self, sound: &PointEstimate, elapsed: Span, settings: &PlaceSettings) {
        let spread = spread(elapsed.seconds().max(0.0), settings);
        let by_sound = (sound.covariance * spread.powi(2)).try_inverse();
        let by_now = self.estimate.covariance.try_inverse();
        let (Some(by_sound), Some(by_now)) = (by_sound, by_now) else {
            return;
        };
        let Some(covariance) = (by_sound + by_now).try_inverse() else {
            return;
        };
        let point = covariance * (by_sound * sound.mean.0.coords + by_now * self.estimate.mean.0.coords);
        self.take(WorldPoint(point.into()), Some(covariance));
    }

    fn take(&mut self, mean: WorldPoint, covariance: Option<Matrix3<f64>>) {
        let Some(covariance) = covariance else { return };
        // What is not finite is no place: the old one stays.
        if mean
            .0
            .iter()
            .chain(covariance.iter())
            .all(|value| value.is_finite())
        {
            let covariance = 0.5 * (covariance + covariance.transpose());
            self.estimate = PointEstimate { mean, covariance };
        }
    }
}

/// Pixels err anew at every picture, at the most so many times as much as one alone.
const ACROSS: f64 = 2.0;

/// By how much a deviation grows so that as many frames as pass meanwhile count once.
fn spread(seconds: f64, settings: &PlaceSettings) -> f64 {
    (settings.independent_s / seconds.max(1e-3)).sqrt().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight_core::Ray;
    use nalgebra::{Unit, Vector3};

    const TICK: Span = Span::from_nanoseconds(40_000_000);

    fn sight(range_m: f64) -> SightLine {
        SightLine {
            ray: Ray {
                origin: WorldPoint::new(0.0, 0.0, 1.5),
                direction: Unit::new_normalize(Vector3::new(1.0, 0.0, 0.0)),
            },
            deviation_rad: 0.005,
            width_per_metre: 0.06,
            range_m: Some((range_m, 0.4)),
        }
    }

    #[test]
    fn noise_is_smoothed_and_sound_pulls_along_the_ray() {
        let settings = PlaceSettings::default();
        let mut place = Place::new(1, &sight(2.5)).unwrap();
        for tick in 0..50 {
            place.see(&sight(if tick % 2 == 0 { 2.2 } else { 2.8 }), TICK, &settings);
        }
        assert!(
            (place.estimate.mean.0.x - 2.5).abs() < 0.1,
            "{:?}",
            place.estimate.mean
        );
        let sound = PointEstimate {
            mean: WorldPoint::new(3.0, 0.0, 1.5),
            covariance: Matrix3::identity() * 0.01,
        };
        for _ in 0..50 {
            place.see(&sight(2.5), TICK, &settings);
            place.hear(&sound, TICK, &settings);
        }
        assert!(place.estimate.mean.0.x > 2.85, "{:?}", place.estimate.mean);
        assert!(
            place
                .estimate
                .covariance
                .symmetric_eigenvalues()
                .iter()
                .all(|value| *value > 0.0)
        );
    }
}
