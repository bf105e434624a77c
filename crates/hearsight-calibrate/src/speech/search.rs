//! What is searched: the cost of a clock, a turn and a place, where to begin, and the equations of a step.
//!
//! It decides nothing: whether what is found is an answer is for [`super::calibrate`] to say.

use super::{HeardDelays, LEAST_FRAMES, Sighting, SpeechSettings};
use crate::least_squares::Problem;
use hearsight_core::microphones::MicrophoneArray;
use hearsight_core::{Instant, Span, WorldPoint};
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};

/// A mouth is known between two sightings not farther apart than this.
const LONGEST_GAP: Span = Span::from_nanoseconds(300_000_000);
/// A frame fits where its delays weigh so much in the mean.
const FITS: f64 = 0.3;
/// Starts are at least so far apart, seconds and degrees: neighbours would lead to one minimum and hide its rivals.
const STARTS_APART: (f64, f64) = (0.1, 7.5);
/// How many starts there are.
const STARTS: usize = 8;
/// Unknowns: offset in seconds, turn in radians, shift in metres.
pub(super) const UNKNOWNS: usize = 5;

pub(super) struct Search<'a> {
    pub(super) declared: &'a MicrophoneArray,
    pub(super) heard: &'a [HeardDelays],
    pub(super) people: Vec<Vec<Sighting>>,
    pub(super) settings: &'a SpeechSettings,
    /// What a frame costs at whose time nobody is seen: what the others cost in the mean, so that the clock is not drawn
    /// to where most are seen.
    pub(super) neutral: f64,
}

/// The array after a change of turn and place.
pub(super) fn moved(declared: &MicrophoneArray, unknowns: &[f64]) -> Option<MicrophoneArray> {
    let centre = declared.centre().0;
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), unknowns[1]);
    let shift = Vector3::new(unknowns[2], unknowns[3], unknowns[4]);
    let places = declared.positions().iter();
    let places = places.map(|place| WorldPoint(centre + turn * (place.0 - centre) + shift));
    MicrophoneArray::new(places.collect())
        .and_then(|array| array.with_speed_of_sound(declared.speed_of_sound_m_s()))
        .ok()
}

/// Where a mouth is between two sightings.
fn between(person: &[Sighting], time: Instant) -> Option<(WorldPoint, Matrix3<f64>)> {
    let after = person.partition_point(|sighting| sighting.time < time);
    let last = person.get(after)?;
    let Some(first) = after.checked_sub(1).map(|before| &person[before]) else {
        return (last.time == time).then_some((last.mouth, last.covariance));
    };
    let gap = last.time - first.time;
    if gap > LONGEST_GAP {
        return None;
    }
    let part = (time - first.time).seconds() / gap.seconds().max(1e-9);
    let place = first.mouth.0 + (last.mouth.0 - first.mouth.0) * part;
    Some((
        WorldPoint(place),
        first.covariance * (1.0 - part) + last.covariance * part,
    ))
}

impl Search<'_> {
    /// The mouths at the time of a frame.
    fn mouths(&self, frame: &HeardDelays, offset_s: f64) -> impl Iterator<Item = (WorldPoint, Matrix3<f64>)> {
        let time = frame.time + Span::from_seconds(offset_s);
        self.people.iter().filter_map(move |person| between(person, time))
    }

    pub(super) fn frames(&self, offset_s: f64) -> usize {
        let frames = self.heard.iter();
        frames
            .filter(|frame| self.mouths(frame, offset_s).next().is_some())
            .count()
    }

    /// Residuals of a frame for a mouth, in units of their deviations.
    fn residuals<'b>(
        &'b self,
        array: &'b MicrophoneArray,
        frame: &'b HeardDelays,
        mouth: WorldPoint,
        covariance: Matrix3<f64>,
    ) -> impl Iterator<Item = f64> + 'b {
        array
            .pairs()
            .zip(&frame.delays_s)
            .filter_map(move |(pair, delay_s)| {
                let gradient = pair.delay_gradient_s_per_m(mouth);
                let variance = self.settings.delay_s.powi(2) + gradient.dot(&(covariance * gradient));
                let residual = (delay_s - pair.delay_s(mouth)) / variance.sqrt();
                residual.is_finite().then_some(residual)
            })
    }

    /// The mouth that fits a frame best and its cost; a frame without a mouth costs what one that does not fit would.
    fn best(
        &self,
        array: &MicrophoneArray,
        frame: &HeardDelays,
        offset_s: f64,
    ) -> (f64, Option<(WorldPoint, Matrix3<f64>)>) {
        let mut best = (self.neutral, None);
        for (mouth, covariance) in self.mouths(frame, offset_s) {
            let residuals = self.residuals(array, frame, mouth, covariance);
            let cost: f64 = residuals.map(|r| 0.5 * r * r / (1.0 + r * r)).sum();
            if best.1.is_none() || cost < best.0 {
                best = (cost, Some((mouth, covariance)));
            }
        }
        best
    }

    fn declared_cost(&self, unknowns: &[f64]) -> f64 {
        let [level, height] = self.settings.place_m;
        0.5 * ((unknowns[2] / level).powi(2) + (unknowns[3] / level).powi(2) + (unknowns[4] / height).powi(2))
    }

    /// What a frame with somebody seen costs in the mean; none where there are too few.
    pub(super) fn mean_cost(&self, unknowns: &DVector<f64>) -> Option<f64> {
        let array = moved(self.declared, unknowns.as_slice())?;
        let costs = self
            .heard
            .iter()
            .map(|frame| self.best(&array, frame, unknowns[0]));
        let (mut sum, mut count) = (0.0, 0);
        for (cost, _) in costs.filter(|(_, mouth)| mouth.is_some()) {
            sum += cost;
            count += 1;
        }
        (count >= LEAST_FRAMES).then(|| sum / f64::from(count as u32))
    }

    /// The most promising clocks and turns: those with the least cost of a frame. Sets the neutral cost by the best.
    pub(super) fn starts(&mut self) -> Vec<DVector<f64>> {
        let steps = |most: f64, step: f64| {
            let count = (most / step).floor() as i64;
            (-count..=count).map(move |number| number as f64 * step)
        };
        let mut found: Vec<(f64, DVector<f64>)> = Vec::new();
        for turn_deg in steps(self.settings.turn_deg, 2.5) {
            for offset_s in steps(self.settings.offset_s, 0.04) {
                let unknowns = DVector::from_vec(vec![offset_s, turn_deg.to_radians(), 0.0, 0.0, 0.0]);
                if let Some(cost) = self.mean_cost(&unknowns) {
                    found.push((cost, unknowns));
                }
            }
        }
        found.sort_by(|one, other| one.0.total_cmp(&other.0));
        self.neutral = found.first().map_or(0.0, |(cost, _)| *cost);
        let mut starts: Vec<DVector<f64>> = Vec::new();
        for (_, unknowns) in found {
            let near = |start: &DVector<f64>| {
                (start[0] - unknowns[0]).abs() < STARTS_APART.0
                    && (start[1] - unknowns[1]).abs() < STARTS_APART.1.to_radians()
            };
            if starts.len() < STARTS && !starts.iter().any(near) {
                starts.push(unknowns);
            }
        }
        starts
    }

    /// Frames with somebody seen, and those that fit.
    pub(super) fn fitting(&self, unknowns: &DVector<f64>) -> (usize, usize) {
        let Some(array) = moved(self.declared, unknowns.as_slice()) else {
            return (0, 0);
        };
        let (mut all, mut fitting) = (0, 0);
        for frame in self.heard {
            let (_, Some((mouth, covariance))) = self.best(&array, frame, unknowns[0]) else {
                continue;
            };
            all += 1;
            let weights: Vec<f64> = self
                .residuals(&array, frame, mouth, covariance)
                .map(|r| 1.0 / (1.0 + r * r))
                .collect();
            let mean = weights.iter().sum::<f64>() / weights.len().max(1) as f64;
            fitting += usize::from(mean > FITS);
        }
        (all, fitting)
    }
}

impl Problem for Search<'_> {
    fn cost(&self, unknowns: &DVector<f64>) -> f64 {
        let Some(array) = moved(self.declared, unknowns.as_slice()) else {
            return f64::INFINITY;
        };
        // A little beyond what may be: a minimum at the very border is found, one far away is not.
        let turn_rad = 1.2 * self.settings.turn_deg.to_radians();
        if unknowns[0].abs() > 1.2 * self.settings.offset_s || unknowns[1].abs() > turn_rad {
            return f64::INFINITY;
        }
        let frames = self.heard.iter();
        frames
            .map(|frame| self.best(&array, frame, unknowns[0]).0)
            .sum::<f64>()
            + self.declared_cost(unknowns.as_slice())
    }

    fn normal(&self, unknowns: &DVector<f64>, matrix: &mut DMatrix<f64>, side: &mut DVector<f64>) {
        const STEPS: [f64; UNKNOWNS] = [5e-3, 1e-4, 1e-4, 1e-4, 1e-4];
        let Some(here) = moved(self.declared, unknowns.as_slice()) else {
            return;
        };
        let pairs_of = |array: &MicrophoneArray| array.pairs().collect::<Vec<_>>();
        let own = pairs_of(&here);
        let mut around = Vec::new();
        for (column, step) in STEPS.into_iter().enumerate() {
            for sign in [1.0, -1.0] {
                let mut changed = unknowns.clone();
                changed[column] += sign * step;
                let array = moved(self.declared, changed.as_slice());
                around.push((array.as_ref().map(pairs_of), changed[0]));
            }
        }
        for frame in self.heard {
            let Some((mouth, covariance)) = self.best(&here, frame, unknowns[0]).1 else {
                continue;
            };
            // The same person a little earlier or later.
            let near = |offset_s: f64| {
                self.mouths(frame, offset_s)
                    .min_by(|one, other| one.0.distance_m(mouth).total_cmp(&other.0.distance_m(mouth)))
            };
            let ends = [near(around[0].1), near(around[1].1)].map(|end| end.map(|(mouth, _)| mouth));
            for (number, (own, delay_s)) in own.iter().zip(&frame.delays_s).enumerate() {
                let gradient = own.delay_gradient_s_per_m(mouth);
                let deviation =
                    (self.settings.delay_s.powi(2) + gradient.dot(&(covariance * gradient))).sqrt();
                let residual = (delay_s - own.delay_s(mouth)) / deviation;
                let weight = (1.0 + residual * residual).powi(-2);
                let mut row = [0.0; UNKNOWNS];
                for (column, step) in STEPS.into_iter().enumerate() {
                    let value = |side: usize| {
                        let mouth = if column == 0 { ends[side]? } else { mouth };
                        let pairs = around[2 * column + side].0.as_ref()?;
                        Some(pairs.get(number)?.delay_s(mouth))
                    };
                    if let (Some(above), Some(below)) = (value(0), value(1)) {
                        row[column] = -(above - below) / (2.0 * step) / deviation;
                    }
                }
                if !(residual.is_finite() && row.iter().all(|value| value.is_finite())) {
                    continue;
                }
                for (i, one) in row.iter().enumerate() {
                    side[i] += weight * one * residual;
                    for (j, other) in row.iter().enumerate() {
                        matrix[(i, j)] += weight * one * other;
                    }
                }
            }
        }
        let [level, height] = self.settings.place_m;
        for (at, deviation) in [(2, level), (3, level), (4, height)] {
            matrix[(at, at)] += deviation.powi(-2);
            side[at] += unknowns[at] / deviation.powi(2);
        }
    }
}
