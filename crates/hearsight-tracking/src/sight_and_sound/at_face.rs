//! How well a frame of sound fits a face, asked where the face is, with no filter of the sound between them.
//!
//! A filter of a sound has to find the next speaker first, and is late at every turn. Faces are known: the steered response
//! is looked up on each line of sight, as far along it as the face may be, and compared with the best place in the room.

use super::lines::SightLine;
use super::place::Place;
use hearsight_audio::steered_response::SteeredResponse;

/// Places along a line of sight.
const PLACES: usize = 9;
/// The farthest of them, deviations of the range from its mean.
const DEVIATIONS: f64 = 2.0;
/// Ranges where nothing is known of it, metres.
const RANGES_M: [f64; 2] = [0.6, 5.0];

/// The log-likelihood (as of [`SteeredResponse::log_likelihood`]) of the frame that `response` observed last, for a mouth
/// on a line of sight: of the best range, each less by how improbable it is (half its squared deviations). `place` is what
/// is believed of where this person is.
pub fn log_likelihood_at(sight: &SightLine, place: Option<&Place>, response: &mut SteeredResponse) -> f32 {
    if let Some(place) = place {
        let guesses = place.ranges(sight);
        let each = guesses.iter().filter(|(range, _)| is_known(range));
        return each
            .map(|(range, logarithm)| *logarithm as f32 + best_along(sight, *range, 1.0, response))
            .fold(f32::NEG_INFINITY, f32::max);
    }
    match sight.range_m.filter(is_known) {
        Some(range) => best_along(sight, range, 1.0, response),
        None => {
            let [low_m, high_m] = RANGES_M;
            let middle_m = 0.5 * (low_m + high_m);
            best_along(sight, (middle_m, (high_m - middle_m) / DEVIATIONS), 0.0, response)
        }
    }
}

fn is_known((range_m, deviation_m): &(f64, f64)) -> bool {
    *range_m > 0.0 && deviation_m.is_finite()
}

/// The highest log-likelihood along a sight, each less by `prior` times half the squared deviations.
fn best_along(sight: &SightLine, range: (f64, f64), prior: f64, response: &mut SteeredResponse) -> f32 {
    along::<PLACES>(sight, range, DEVIATIONS, response)
        .iter()
        .map(|(deviations, logarithm)| logarithm - (prior * 0.5 * deviations * deviations) as f32)
        .fold(f32::NEG_INFINITY, f32::max)
}

/// The log-likelihoods of places along a sight, from `reach` deviations before to as many behind the mean of a range
/// (mean and deviation, metres); each with how many deviations it is from the mean.
pub(super) fn along<const COUNT: usize>(
    sight: &SightLine,
    (range_m, deviation_m): (f64, f64),
    reach: f64,
    response: &mut SteeredResponse,
) -> [(f64, f32); COUNT] {
    let deviations: [f64; COUNT] = std::array::from_fn(|number| {
        let share = number as f64 / (COUNT.max(2) - 1) as f64;
        reach * (2.0 * share - 1.0)
    });
    let points = deviations.map(|deviations| sight.ray.at((range_m + deviations * deviation_m).max(0.1)).0);
    let [x, y, z] = [0, 1, 2].map(|axis| points.map(|point| point[axis] as f32));
    let mut scores = [0.0; COUNT];
    response.score_points([&x, &y, &z], &mut scores);
    std::array::from_fn(|number| (deviations[number], response.log_likelihood(scores[number])))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use hearsight_audio::Complex;
    use hearsight_audio::steered_response::SteeredSettings;
    use hearsight_core::microphones::MicrophoneArray;
    use hearsight_core::{Ray, WorldPoint};
    use nalgebra::Unit;
    use std::f64::consts::TAU;

    const LENGTH: usize = 2048;
    const RATE_HZ: u32 = 16_000;

    /// The response of three microphones in a line to a white sound, without walls.
    pub(in super::super) fn response_to(source: WorldPoint) -> SteeredResponse {
        let at = |place: i32| WorldPoint::new(0.2 * f64::from(place), 0.0, 1.0);
        let array = MicrophoneArray::new((-1..=1).map(at).collect()).unwrap();
        let mut response = SteeredResponse::new(&array, LENGTH, RATE_HZ, SteeredSettings::default()).unwrap();
        let channel = |position: &WorldPoint| {
            let lag = source.distance_m(*position) / 343.0 * f64::from(RATE_HZ);
            let mut phase: f64 = 0.37;
            let mut bin = |k: usize| {
                phase = (phase * 997.0 + 0.123).fract();
                Complex::from_polar(1.0, (TAU * (phase - k as f64 * lag / LENGTH as f64)) as f32)
            };
            (0..=LENGTH / 2).map(&mut bin).collect::<Vec<_>>()
        };
        let channels: Vec<Vec<Complex>> = array.positions().iter().map(channel).collect();
        response.observe(&channels).unwrap();
        response
    }

    fn sight(mouth: WorldPoint, range_error_m: f64) -> SightLine {
        let camera = WorldPoint::new(-1.5, 0.2, 1.7);
        let direction = Unit::new_normalize(mouth.0 - camera.0);
        SightLine {
            ray: Ray {
                origin: camera,
                direction,
            },
            deviation_rad: 0.005,
            width_per_metre: 0.06,
            range_m: Some((camera.distance_m(mouth) + range_error_m, 0.3)),
        }
    }

    #[test]
    fn who_speaks_explains_the_frame_and_a_neighbour_does_not() {
        let (speaker, neighbour) = (WorldPoint::new(0.4, 2.2, 1.2), WorldPoint::new(-0.5, 2.3, 1.2));
        let mut response = response_to(speaker);
        let score = response.score(speaker);
        let best = response.log_likelihood(score);
        // The range from a face's width is wrong by more than a hand.
        for range_error_m in [-0.3, 0.0, 0.3] {
            let theirs = log_likelihood_at(&sight(speaker, range_error_m), None, &mut response);
            let other = log_likelihood_at(&sight(neighbour, range_error_m), None, &mut response);
            assert!(
                theirs > best - 1.5 && other < best - 4.0,
                "{theirs} {other} {best}"
            );
        }
        // Nothing is known of the range: the whole line is asked.
        let unknown = SightLine {
            range_m: None,
            ..sight(speaker, 0.0)
        };
        assert!(log_likelihood_at(&unknown, None, &mut response) > best - 4.0);
    }
}
