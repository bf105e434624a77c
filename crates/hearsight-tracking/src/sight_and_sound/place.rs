//! Where a person is in the room, as pictures and sounds come, and how wide their face is.
//!
//! A Gaussian over the place of the mouth, which walks at random, and over the width of the face as the cascade boxes it,
//! which stays what it is. A picture tells the ray to the mouth, and width over distance; the distance itself only as well
//! as widths of faces are alike. An array elsewhere in the room sees the same mouth from the side: while somebody speaks,
//! where their sound and their ray cross tells their distance, and so the width of their face, which then holds when they
//! are silent and when they walk.
//!
//! Errors of a box and of an array's direction last for a while; both therefore count once in
//! [`PlaceSettings::independent_s`], not once a frame.

use super::at_face::along;
use super::lines::SightLine;
use crate::sound::PointEstimate;
use hearsight_audio::steered_response::SteeredResponse;
use hearsight_core::{Span, WorldPoint};
use nalgebra::{Matrix3, Matrix4, Vector4};
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
    /// How far boxes of one face scatter in width, as a share of it. Default 0.16, for people who
    /// turn before frontal and profile cascades, which box the same head differently.
    pub box_deviation: f64,
    /// Probability of speaking from which a person's sound tells how far they are, 0 to 1; above 1 it never does.
    /// Default 0.5.
    pub sure: f64,
}

impl Default for PlaceSettings {
    fn default() -> Self {
        Self {
            walk_m: 0.6,
            independent_s: 0.6,
            box_deviation: 0.16,
            sure: 0.5,
        }
    }
}

/// Where a person is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// The person's identity.
    pub identity: u64,
    /// Place of the mouth, metres, and the logarithm of the width of the face in metres.
    mean: Vector4<f64>,
    covariance: Matrix4<f64>,
}

/// The row of the width's logarithm.
const WIDTH: usize = 3;

impl Place {
    /// A person seen for the first time, whose face is `face_width_m` wide (mean and standard deviation); none where the
    /// sight says nothing of the distance.
    pub fn new(identity: u64, sight: &SightLine, face_width_m: (f64, f64)) -> Option<Self> {
        let estimate = sight.estimate()?;
        let (width_m, deviation_m) = face_width_m;
        if !(width_m > 0.0 && deviation_m > 0.0) {
            return None;
        }
        let variance = (deviation_m / width_m).powi(2);
        let mut covariance = Matrix4::zeros();
        covariance
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&estimate.covariance);
        // How far they are and how wide their face is are known together, up to what the box errs.
        let (range_m, _) = sight.range_m?;
        let shared = sight.ray.direction.into_inner() * (range_m * variance);
        covariance.fixed_view_mut::<3, 1>(0, WIDTH).copy_from(&shared);
        covariance
            .fixed_view_mut::<1, 3>(WIDTH, 0)
            .copy_from(&shared.transpose());
        covariance[(WIDTH, WIDTH)] = variance;
        let mean = estimate.mean.0.coords.push(width_m.ln());
        Some(Self {
            identity,
            mean,
            covariance,
        })
    }

    /// Where the mouth is.
    pub fn estimate(&self) -> PointEstimate {
        PointEstimate {
            mean: WorldPoint(self.mean.xyz().into()),
            covariance: self.covariance.fixed_view::<3, 3>(0, 0).into_owned(),
        }
    }

    /// Width of the face as the cascade boxes it and its standard deviation, metres.
    pub fn face_width_m(&self) -> (f64, f64) {
        let width_m = self.mean[WIDTH].exp();
        let deviation = self.covariance[(WIDTH, WIDTH)].max(0.0).sqrt();
        (width_m, width_m * deviation)
    }

    /// Lets `elapsed` pass and takes in a sight.
    pub fn see(&mut self, sight: &SightLine, elapsed: Span, settings: &PlaceSettings) {
        let seconds = elapsed.seconds().max(0.0);
        let before = *self;
        let mut step = self.covariance.fixed_view_mut::<3, 3>(0, 0);
        step += Matrix3::identity() * (settings.walk_m.powi(2) * seconds);
        let spread = spread(seconds, settings);
        let direction = sight.ray.direction.into_inner();
        let origin = sight.ray.origin.0.coords;
        let range_m = (self.mean.xyz() - origin).dot(&direction).max(NEAREST_M);
        // The mouth is on the ray.
        let variance = (sight.deviation_rad * range_m * spread.min(ACROSS)).powi(2);
        let first = direction
            .cross(&nalgebra::Vector3::ith(direction.iamin(), 1.0))
            .normalize();
        for across in [first, direction.cross(&first)] {
            self.take(across.push(0.0), across.dot(&origin), variance);
        }
        // Its box is as wide as the face at that distance: width_per_metre (range) = width. In logarithms, or boxes that
        // err would be explained best by a face of no width at the camera.
        if sight.range_m.is_some() {
            let range_m = (self.mean.xyz() - origin).dot(&direction).max(NEAREST_M);
            let row = (-direction / range_m).push(1.0);
            let missing = sight.width_per_metre.ln() - (self.mean[WIDTH] - range_m.ln());
            let deviation = settings.box_deviation * spread;
            self.take(row, row.dot(&self.mean) + missing, deviation.powi(2));
        }
        self.keep_if_finite(before);
    }

    /// Takes in a frame of sound that is this person's, `elapsed` after the one before: how well each distance along the
    /// sight explains it.
    pub fn hear(
        &mut self,
        sight: &SightLine,
        response: &mut SteeredResponse,
        elapsed: Span,
        settings: &PlaceSettings,
    ) {
        let before = *self;
        let (range_m, deviation_m) = self.range(sight);
        if !(range_m > 0.0 && deviation_m > 0.0 && deviation_m.is_finite()) {
            return;
        }
        let share = spread(elapsed.seconds().max(0.0), settings).powi(-2);
        let points = along::<PLACES>(sight, (range_m, deviation_m), DEVIATIONS, response);
        let highest = points.iter().map(|point| point.1).fold(f32::MIN, f32::max);
        let prior = points.map(|(deviations, _)| (deviations, -0.5 * deviations * deviations));
        let told = points.map(|(deviations, logarithm)| {
            let logarithm = share * f64::from(logarithm - highest);
            (deviations, logarithm - 0.5 * deviations * deviations)
        });
        let (mean, variance) = moments(&told);
        // That points reach only so far makes them narrower than a Gaussian, which is no knowledge.
        let variance = variance / moments(&prior).1;
        if !(variance > 0.0 && variance < 0.999) {
            return;
        }
        // The Gaussian sight of the distance that would have led to the same mean and variance.
        let told = 1.0 / (1.0 / variance - 1.0);
        let offset = mean / variance * told;
        let direction = sight.ray.direction.into_inner();
        let wanted = range_m + offset * deviation_m + direction.dot(&sight.ray.origin.0.coords);
        self.take(direction.push(0.0), wanted, told * deviation_m.powi(2));
        self.keep_if_finite(before);
    }

    /// How far along a sight this person is, and the standard deviation, metres.
    pub fn range(&self, sight: &SightLine) -> (f64, f64) {
        let direction = sight.ray.direction.into_inner();
        let estimate = self.estimate();
        let variance = direction.dot(&(estimate.covariance * direction));
        (
            (estimate.mean.0 - sight.ray.origin.0).dot(&direction),
            variance.max(0.0).sqrt(),
        )
    }

    /// Takes in that `row` times the state is `wanted`, with that variance.
    fn take(&mut self, row: Vector4<f64>, wanted: f64, variance: f64) {
        let shared = self.covariance * row;
        let total = row.dot(&shared) + variance;
        if !(total > 0.0 && total.is_finite()) {
            return;
        }
        let gain = shared / total;
        self.mean += gain * (wanted - row.dot(&self.mean));
        // Joseph's form keeps it symmetric and positive.
        let rest = Matrix4::identity() - gain * row.transpose();
        self.covariance = rest * self.covariance * rest.transpose() + gain * gain.transpose() * variance;
    }

    /// What is not finite is no place: the old one stays.
    fn keep_if_finite(&mut self, before: Self) {
        let is_finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        if !(is_finite(self.mean.as_slice()) && is_finite(self.covariance.as_slice())) {
            *self = before;
        }
    }
}

/// Pixels err anew at every picture, at the most so many times as much as one alone.
const ACROSS: f64 = 2.0;
/// Nobody is nearer to a camera, metres.
const NEAREST_M: f64 = 0.2;
/// Points along a sight at which a frame is asked, and how far they reach, deviations.
const PLACES: usize = 25;
const DEVIATIONS: f64 = 2.5;

/// Mean and variance of values with the logarithms of their weights, of which the highest is about 0.
fn moments(values: &[(f64, f64)]) -> (f64, f64) {
    let (mut sum, mut mean, mut square) = (0.0, 0.0, 0.0);
    for (value, logarithm) in values {
        let weight = logarithm.exp();
        sum += weight;
        mean += weight * value;
        square += weight * value * value;
    }
    let mean = mean / sum;
    (mean, square / sum - mean * mean)
}

/// By how much a deviation grows so that as many frames as pass meanwhile count once.
fn spread(seconds: f64, settings: &PlaceSettings) -> f64 {
    (settings.independent_s / seconds.max(1e-3)).sqrt().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sight_and_sound::at_face::tests::response_to;
    use hearsight_core::Ray;
    use nalgebra::Unit;

    const TICK: Span = Span::from_nanoseconds(40_000_000);
    const FACE_WIDTH_M: (f64, f64) = (0.165, 0.02);
    /// Of people who sit and look at the camera.
    const SETTINGS: PlaceSettings = PlaceSettings {
        walk_m: 0.3,
        independent_s: 0.6,
        box_deviation: 0.06,
        sure: 0.5,
    };

    /// The sight of a mouth from the side of the array, whose face is `face_m` wide.
    fn sight(mouth: WorldPoint, face_m: f64) -> SightLine {
        let camera = WorldPoint::new(-2.5, 0.2, 1.6);
        let range_m = camera.distance_m(mouth);
        let width_per_metre = face_m / range_m;
        let guess_m = FACE_WIDTH_M.0 / width_per_metre;
        SightLine {
            ray: Ray {
                origin: camera,
                direction: Unit::new_normalize(mouth.0 - camera.0),
            },
            deviation_rad: 0.005,
            width_per_metre,
            range_m: Some((guess_m, guess_m * FACE_WIDTH_M.1 / FACE_WIDTH_M.0)),
        }
    }

    fn error_m(place: &Place, mouth: WorldPoint) -> f64 {
        place.estimate().mean.distance_m(mouth)
    }

    #[test]
    fn boxes_that_scatter_are_smoothed() {
        let mouth = WorldPoint::new(0.2, 2.2, 1.2);
        let mut place = Place::new(1, &sight(mouth, 0.15), FACE_WIDTH_M).unwrap();
        let mut worst_m: f64 = 0.0;
        for tick in 0..200 {
            let face_m = if tick % 2 == 0 { 0.15 } else { 0.18 };
            place.see(&sight(mouth, face_m), TICK, &SETTINGS);
            if tick > 150 {
                worst_m = worst_m.max(error_m(&place, mouth));
            }
        }
        assert!(worst_m < 0.15, "{worst_m}");
        assert!((place.face_width_m().0 - 0.165).abs() < 0.005);
    }

    #[test]
    fn who_was_heard_is_known_by_the_width_of_their_face_where_they_walk_in_silence() {
        let mut mouth = WorldPoint::new(0.2, 2.2, 1.2);
        // A face much narrower than most looks far.
        let face_m = 0.145;
        let mut place = Place::new(1, &sight(mouth, face_m), FACE_WIDTH_M).unwrap();
        let at_first_m = error_m(&place, mouth);
        let mut response = response_to(mouth);
        for _ in 0..100 {
            place.see(&sight(mouth, face_m), TICK, &SETTINGS);
            place.hear(&sight(mouth, face_m), &mut response, TICK, &SETTINGS);
        }
        assert!(
            at_first_m > 0.4 && error_m(&place, mouth) < 0.1,
            "{at_first_m} {place:?}"
        );
        let (width_m, deviation_m) = place.face_width_m();
        assert!(
            (width_m - face_m).abs() < 0.006 && deviation_m < 0.01,
            "{width_m} {deviation_m}"
        );
        for _ in 0..100 {
            mouth = WorldPoint::new(mouth.0.x + 0.01, mouth.0.y + 0.005, mouth.0.z);
            place.see(&sight(mouth, face_m), TICK, &SETTINGS);
        }
        assert!(
            error_m(&place, mouth) < 0.3,
            "{} {:?}",
            error_m(&place, mouth),
            place.face_width_m()
        );
        assert!(
            place
                .covariance
                .symmetric_eigenvalues()
                .iter()
                .all(|value| *value > 0.0)
        );
    }
}
