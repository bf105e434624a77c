//! Where a person is in the room, as pictures and sounds come, and how wide their face is.
//!
//! Gaussians over the place of the mouth, which walks at random, and over the width of the face as the cascade boxes it,
//! which stays what it is. A picture tells the ray to the mouth, and width over distance; the distance itself only as well
//! as widths of faces are alike. An array elsewhere in the room sees the same mouth from the side: while somebody speaks,
//! where their sound and their ray cross tells their distance, and so the width of their face, which then holds when they
//! are silent and when they walk.
//!
//! A person of whom only the width is unsure can be heard from wherever their ray crosses the sound: a neighbour at a wrong
//! distance explains a speaker as well as the speaker does. One Gaussian that once took the sound of somebody else would
//! hold to it. There are therefore several, of narrower guesses at the width, and each is as probable as it explained what
//! was heard (the range-parameterized filter of Peach, "Bearings-only tracking using a set of range-parameterised extended
//! Kalman filters", 1995).
//!
//! Errors of a box and of an array's direction last for a while; both therefore count once in
//! [`PlaceSettings::independent_s`], not once a frame.

use super::guess::Guess;
use super::lines::SightLine;
use crate::sound::PointEstimate;
use hearsight_audio::steered_response::SteeredResponse;
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
    /// How far boxes of one face scatter in width, as a share of it. Default 0.16, for people who
    /// turn before frontal and profile cascades, which box the same head differently.
    pub box_deviation: f64,
    /// Probability of speaking from which a person's sound tells how far they are, as surely as it is theirs, 0 to 1; above
    /// 1 it never does.
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

/// Guesses at the width of a face, how far apart they are, and how unsure each is, in deviations of widths of faces: the
/// squares of the last and of [`OF_GUESSES`] sum to 1.
const GUESSES: usize = 7;
const STEP: f64 = 0.75;
const WITHIN: f64 = 0.5;
const OF_GUESSES: f64 = 0.866;
/// Logarithm of the least probability of a guess beside the best one: it may yet turn out to be right.
const LEAST_LOG_WEIGHT: f64 = -9.0;

/// Where a person is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// The person's identity.
    pub identity: u64,
    guesses: [Guess; GUESSES],
}

impl Place {
    /// A person seen for the first time, whose face is `face_width_m` wide (mean and standard deviation); none where the
    /// sight says nothing of the distance.
    pub fn new(identity: u64, sight: &SightLine, face_width_m: (f64, f64)) -> Option<Self> {
        let (width_m, deviation_m) = face_width_m;
        let (range_m, range_deviation_m) = sight.range_m?;
        if !(width_m > 0.0 && deviation_m > 0.0 && range_m > 0.0) {
            return None;
        }
        let deviation = deviation_m / width_m;
        let box_deviation = ((range_deviation_m / range_m).powi(2) - deviation.powi(2))
            .max(0.0)
            .sqrt();
        let guesses = std::array::from_fn(|number| {
            let steps = STEP * (number as f64 - (GUESSES / 2) as f64);
            let width_m = width_m * (steps * deviation).exp();
            let log_weight = -0.5 * (steps / OF_GUESSES).powi(2);
            Guess::new(log_weight, sight, (width_m, WITHIN * deviation), box_deviation)
        });
        Some(Self { identity, guesses })
    }

    /// Where the mouth is.
    pub fn estimate(&self) -> PointEstimate {
        let weights = self.weights();
        let guesses = self.guesses.each_ref().map(Guess::estimate);
        let mut mean = nalgebra::Vector3::zeros();
        for (weight, guess) in weights.iter().zip(&guesses) {
            mean += *weight * guess.mean.0.coords;
        }
        let mut covariance = Matrix3::zeros();
        for (weight, guess) in weights.iter().zip(&guesses) {
            let apart = guess.mean.0.coords - mean;
            covariance += *weight * (guess.covariance + apart * apart.transpose());
        }
        PointEstimate {
            mean: WorldPoint(mean.into()),
            covariance,
        }
    }

    /// Width of the face as the cascade boxes it and its standard deviation, metres.
    pub fn face_width_m(&self) -> (f64, f64) {
        let (mut mean, mut square) = (0.0, 0.0);
        for (weight, guess) in self.weights().iter().zip(&self.guesses) {
            let (logarithm, variance) = guess.log_width();
            mean += weight * logarithm;
            square += weight * (variance + logarithm * logarithm);
        }
        let width_m = mean.exp();
        (width_m, width_m * (square - mean * mean).max(0.0).sqrt())
    }

    /// Lets `elapsed` pass and takes in a sight.
    pub fn see(&mut self, sight: &SightLine, elapsed: Span, settings: &PlaceSettings) {
        for guess in &mut self.guesses {
            guess.see(sight, elapsed, settings);
        }
    }

    /// Takes in a frame of sound, `elapsed` after the one before, that is this person's with that probability.
    pub fn hear(
        &mut self,
        sight: &SightLine,
        response: &mut SteeredResponse,
        probability: f64,
        elapsed: Span,
        settings: &PlaceSettings,
    ) {
        let weights = self.weights();
        let before = self.guesses;
        let mut evidence = [0.0; GUESSES];
        for (guess, evidence) in self.guesses.iter_mut().zip(&mut evidence) {
            match guess.hear(sight, response, probability, elapsed, settings) {
                Some(found) if found.is_finite() => *evidence = found,
                _ => {
                    self.guesses = before;
                    return;
                }
            }
        }
        let highest = evidence.iter().copied().fold(f64::MIN, f64::max);
        let shares = evidence.map(|evidence| (evidence - highest).exp());
        let mean: f64 = shares
            .iter()
            .zip(&weights)
            .map(|(share, weight)| share * weight)
            .sum();
        for (guess, share) in self.guesses.iter_mut().zip(shares) {
            guess.log_weight += (1.0 - probability + probability * share / mean.max(f64::MIN_POSITIVE)).ln();
        }
        let logarithms = self.log_weights();
        for (guess, logarithm) in self.guesses.iter_mut().zip(logarithms) {
            guess.log_weight = logarithm.max(LEAST_LOG_WEIGHT);
        }
    }

    /// How far along a sight this person is by each guess, and the standard deviation, metres; and the logarithm of the
    /// guess's probability beside that of the best one.
    pub(super) fn ranges(&self, sight: &SightLine) -> [((f64, f64), f64); GUESSES] {
        let logarithms = self.log_weights();
        std::array::from_fn(|number| (self.guesses[number].range(sight), logarithms[number]))
    }

    /// The logarithm of the probability of each guess beside that of the best one.
    fn log_weights(&self) -> [f64; GUESSES] {
        let each = self.guesses.each_ref().map(|guess| guess.log_weight);
        let best = each.iter().copied().fold(f64::MIN, f64::max);
        each.map(|logarithm| logarithm - best)
    }

    /// The probability of each guess.
    fn weights(&self) -> [f64; GUESSES] {
        let weights = self.log_weights().map(f64::exp);
        let sum: f64 = weights.iter().sum();
        weights.map(|weight| weight / sum)
    }
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
    fn a_place_that_took_somebody_elses_sound_is_left_once_its_own_is_heard() {
        let mouth = WorldPoint::new(0.2, 2.2, 1.2);
        let mut place = Place::new(1, &sight(mouth, 0.165), FACE_WIDTH_M).unwrap();
        // A neighbour whose direction from the array meets this ray 0.5 m nearer.
        let ray = sight(mouth, 0.165).ray;
        let nearer = ray.at(ray.origin.distance_m(mouth) - 0.5);
        let hear = |place: &mut Place, from: WorldPoint, probability: f64, ticks: usize| {
            let mut response = response_to(from);
            for _ in 0..ticks {
                place.see(&sight(mouth, 0.165), TICK, &SETTINGS);
                place.hear(&sight(mouth, 0.165), &mut response, probability, TICK, &SETTINGS);
            }
        };
        hear(&mut place, nearer, 0.6, 25);
        let misled_m = error_m(&place, mouth);
        hear(&mut place, mouth, 0.8, 75);
        assert!(
            misled_m > 0.2 && error_m(&place, mouth) < 0.12,
            "{misled_m} {}",
            error_m(&place, mouth)
        );
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
            place.hear(&sight(mouth, face_m), &mut response, 1.0, TICK, &SETTINGS);
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
        let covariance = place.estimate().covariance;
        assert!(
            covariance
                .symmetric_eigenvalues()
                .iter()
                .all(|value| *value > 0.0)
        );
    }
}
