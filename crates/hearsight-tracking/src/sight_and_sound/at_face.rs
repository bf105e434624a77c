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
    let direction = sight.ray.direction.into_inner();
    let believed = place.map(|place| {
        let offset = place.estimate.mean.0 - sight.ray.origin.0;
        let variance = direction.dot(&(place.estimate.covariance * direction));
        (offset.dot(&direction), variance.max(0.0).sqrt())
    });
    let known = believed
        .or(sight.range_m)
        .filter(|(range_m, deviation_m)| *range_m > 0.0 && deviation_m.is_finite());
    let mut points = [[0.0_f32; PLACES]; 3];
    let mut priors = [0.0_f32; PLACES];
    for number in 0..PLACES {
        let share = number as f64 / (PLACES - 1) as f64;
        let range_m = match known {
            Some((range_m, deviation_m)) => {
                let deviations = DEVIATIONS * (2.0 * share - 1.0);
                priors[number] = (-0.5 * deviations * deviations) as f32;
                (range_m + deviations * deviation_m).max(0.1)
            }
            None => RANGES_M[0] + share * (RANGES_M[1] - RANGES_M[0]),
        };
        let point = sight.ray.at(range_m).0;
        for axis in 0..3 {
            points[axis][number] = point[axis] as f32;
        }
    }
    let mut scores = [0.0; PLACES];
    let [x, y, z] = &points;
    response.score_points([x, y, z], &mut scores);
    scores
        .iter()
        .zip(priors)
        .map(|(score, prior)| response.log_likelihood(*score) + prior)
        .fold(f32::NEG_INFINITY, f32::max)
}
