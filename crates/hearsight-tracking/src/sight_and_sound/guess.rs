//! Where a person is, given about how wide their face is: one of the Gaussians that [`super::place`] puts together.

use super::at_face::along;
use super::lines::SightLine;
use super::place::PlaceSettings;
use crate::sound::PointEstimate;
use hearsight_audio::steered_response::SteeredResponse;
use hearsight_core::{Span, WorldPoint};
use nalgebra::{Matrix3, Matrix4, Vector4};
use serde::{Deserialize, Serialize};

/// The row of the width's logarithm.
const WIDTH: usize = 3;
/// Pixels err anew at every picture, at the most so many times as much as one alone.
const ACROSS: f64 = 2.0;
/// Nobody is nearer to a camera, metres.
const NEAREST_M: f64 = 0.2;
/// Points along a sight at which a frame is asked, and how far they reach, deviations.
const PLACES: usize = 25;
const DEVIATIONS: f64 = 2.5;

/// Where a person is, if their face is about as wide as one of several guesses.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Guess {
    /// Logarithm of the probability of this guess, up to what all share.
    pub(super) log_weight: f64,
    /// Place of the mouth, metres, and the logarithm of the width of the face in metres.
    mean: Vector4<f64>,
    covariance: Matrix4<f64>,
}

impl Guess {
    /// A person seen for the first time, whose face is `width_m` wide up to a share of `deviation`. `box_deviation`: how
    /// far the box errs, as a share of its width.
    pub(super) fn new(
        log_weight: f64,
        sight: &SightLine,
        (width_m, deviation): (f64, f64),
        box_deviation: f64,
    ) -> Self {
        let range_m = width_m / sight.width_per_metre;
        let estimate = sight.at_range((range_m, range_m * deviation.hypot(box_deviation)));
        let mut covariance = Matrix4::zeros();
        covariance
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&estimate.covariance);
        // How far they are and how wide their face is are known together, up to what the box errs.
        let shared = sight.ray.direction.into_inner() * (range_m * deviation.powi(2));
        covariance.fixed_view_mut::<3, 1>(0, WIDTH).copy_from(&shared);
        covariance
            .fixed_view_mut::<1, 3>(WIDTH, 0)
            .copy_from(&shared.transpose());
        covariance[(WIDTH, WIDTH)] = deviation.powi(2);
        Self {
            log_weight,
            mean: estimate.mean.0.coords.push(width_m.ln()),
            covariance,
        }
    }

    /// Where the mouth is.
    pub(super) fn estimate(&self) -> PointEstimate {
        PointEstimate {
            mean: WorldPoint(self.mean.xyz().into()),
            covariance: self.covariance.fixed_view::<3, 3>(0, 0).into_owned(),
        }
    }

    /// Logarithm of the width of the face in metres, as the cascade boxes it, and its variance.
    pub(super) fn log_width(&self) -> (f64, f64) {
        (self.mean[WIDTH], self.covariance[(WIDTH, WIDTH)].max(0.0))
    }

    /// Lets `elapsed` pass and takes in a sight.
    pub(super) fn see(&mut self, sight: &SightLine, elapsed: Span, settings: &PlaceSettings) {
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

    /// Takes in a frame of sound, `elapsed` after the one before, that is this person's with that probability: how well
    /// each distance along the sight explains it. Gives the logarithm of how well all of them do, none where nothing can be
    /// said.
    pub(super) fn hear(
        &mut self,
        sight: &SightLine,
        response: &mut SteeredResponse,
        probability: f64,
        elapsed: Span,
        settings: &PlaceSettings,
    ) -> Option<f64> {
        let before = *self;
        let (range_m, deviation_m) = self.range(sight);
        if !(range_m > 0.0 && deviation_m > 0.0 && deviation_m.is_finite()) {
            return None;
        }
        let share = spread(elapsed.seconds().max(0.0), settings).powi(-2);
        let points = along::<PLACES>(sight, (range_m, deviation_m), DEVIATIONS, response);
        let highest = points.iter().map(|point| point.1).fold(f32::MIN, f32::max);
        let prior = points.map(|(deviations, _)| (deviations, -0.5 * deviations * deviations));
        let told = |share: f64| {
            moments(&points.map(|(deviations, logarithm)| {
                let logarithm = share * f64::from(logarithm - highest);
                (deviations, logarithm - 0.5 * deviations * deviations)
            }))
        };
        let (prior_sum, _, prior_variance) = moments(&prior);
        let evidence = share * f64::from(highest) + (told(share).0 / prior_sum).ln();
        // What may be somebody else's sound tells the distance only as surely as it is theirs.
        let (_, mean, variance) = told(probability * share);
        // That points reach only so far makes them narrower than a Gaussian, which is no knowledge.
        let variance = variance / prior_variance;
        if !(variance > 0.0 && variance < 0.999) {
            return Some(evidence);
        }
        // The Gaussian sight of the distance that would have led to the same mean and variance.
        let told = 1.0 / (1.0 / variance - 1.0);
        let offset = mean / variance * told;
        let direction = sight.ray.direction.into_inner();
        let wanted = range_m + offset * deviation_m + direction.dot(&sight.ray.origin.0.coords);
        self.take(direction.push(0.0), wanted, told * deviation_m.powi(2));
        self.keep_if_finite(before);
        Some(evidence)
    }

    /// How far along a sight this person is, and the standard deviation, metres.
    pub(super) fn range(&self, sight: &SightLine) -> (f64, f64) {
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

/// Sum, mean and variance of values with the logarithms of their weights, of which the highest is about 0.
fn moments(values: &[(f64, f64)]) -> (f64, f64, f64) {
    let (mut sum, mut mean, mut square) = (0.0, 0.0, 0.0);
    for (value, logarithm) in values {
        let weight = logarithm.exp();
        sum += weight;
        mean += weight * value;
        square += weight * value * value;
    }
    let mean = mean / sum;
    (sum, mean, square / sum - mean * mean)
}

/// By how much a deviation grows so that as many frames as pass meanwhile count once.
fn spread(seconds: f64, settings: &PlaceSettings) -> f64 {
    (settings.independent_s / seconds.max(1e-3)).sqrt().max(1.0)
}
