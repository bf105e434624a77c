//! What is searched: the cost of a clock, a turn and a place, where to begin, and the equations of a step.
//!
//! It decides nothing: whether what is found is an answer is for [`super::calibrate`] to say.

use super::sights::{LONGEST_GAP, around};
use super::{HeardDelays, Sighting, SpeechSettings};
use crate::least_squares::Problem;
use hearsight_core::microphones::MicrophoneArray;
use hearsight_core::{Instant, Span, WorldPoint};
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};

/// A frame fits where its delays weigh so much in the mean.
const FITS: f64 = 0.3;
/// Starts are at least so far apart, seconds and degrees: neighbours would lead to one minimum and hide its rivals.
const STARTS_APART: (f64, f64) = (0.1, 7.5);
/// How many starts there are.
const STARTS: usize = 8;
/// Unknowns: offset in seconds, turn in radians, shift in metres.
pub(super) const UNKNOWNS: usize = 5;
/// Steps of the differences.
const STEPS: [f64; UNKNOWNS] = [5e-3, 1e-4, 1e-4, 1e-4, 1e-4];
/// Clocks and turns are tried up to so many times of what may be: a minimum at the very border is found, one far away is
/// not.
const BEYOND: f64 = 1.2;

pub(super) struct Search<'a> {
    declared: &'a MicrophoneArray,
    frames: Vec<Frame<'a>>,
    people: Vec<Vec<Sighting>>,
    settings: &'a SpeechSettings,
}

/// A frame and who is in view around its time.
struct Frame<'a> {
    heard: &'a HeardDelays,
    /// Who is seen whatever the clock: numbers of people. If frames came and went with the clock, it would be drawn to
    /// where the fewest are that do not fit.
    people: Vec<usize>,
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
    let (first, last, part) = around(person, time, |sighting| sighting.time)?;
    let place = first.mouth.0 + (last.mouth.0 - first.mouth.0) * part;
    Some((
        WorldPoint(place),
        first.covariance * (1.0 - part) + last.covariance * part,
    ))
}

/// When somebody is seen without a gap: first and last instants.
fn spells(person: &[Sighting]) -> Vec<(Instant, Instant)> {
    person
        .chunk_by(|one, next| next.time - one.time <= LONGEST_GAP)
        .filter_map(|spell| Some((spell.first()?.time, spell.last()?.time)))
        .collect()
}

impl<'a> Search<'a> {
    /// A search over the frames during which somebody is seen. `people`: the sightings of each, in order of time.
    pub(super) fn new(
        declared: &'a MicrophoneArray,
        heard: &'a [HeardDelays],
        people: Vec<Vec<Sighting>>,
        settings: &'a SpeechSettings,
    ) -> Self {
        let reach = Span::from_seconds(BEYOND * settings.offset_s + STEPS[0]);
        let spells: Vec<_> = people.iter().map(|person| spells(person)).collect();
        let frames = heard.iter().filter_map(|heard| {
            let (first, last) = (heard.time - reach, heard.time + reach);
            let seen = |spells: &Vec<(Instant, Instant)>| {
                let within = |(from, to): &(Instant, Instant)| *from <= first && last <= *to;
                spells.iter().any(within)
            };
            let people: Vec<usize> = (0..spells.len())
                .filter(|&person| seen(&spells[person]))
                .collect();
            (!people.is_empty()).then_some(Frame { heard, people })
        });
        let frames = frames.collect();
        Self {
            declared,
            frames,
            people,
            settings,
        }
    }

    /// Frames with somebody seen.
    pub(super) fn frames(&self) -> usize {
        self.frames.len()
    }
}

impl Search<'_> {
    /// The mouths at the time of a frame.
    fn mouths(&self, frame: &Frame<'_>, offset_s: f64) -> impl Iterator<Item = (WorldPoint, Matrix3<f64>)> {
        let time = frame.heard.time + Span::from_seconds(offset_s);
        let people = frame.people.iter();
        people.filter_map(move |&person| between(&self.people[person], time))
    }

    /// Residuals of a frame for a mouth, in units of their deviations.
    fn residuals<'b>(
        &'b self,
        array: &'b MicrophoneArray,
        frame: &'b Frame<'_>,
        mouth: WorldPoint,
        covariance: Matrix3<f64>,
    ) -> impl Iterator<Item = f64> + 'b {
        array
            .pairs()
            .zip(&frame.heard.delays_s)
            .filter_map(move |(pair, delay_s)| {
                let gradient = pair.delay_gradient_s_per_m(mouth);
                let variance = self.settings.delay_s.powi(2) + gradient.dot(&(covariance * gradient));
                let residual = (delay_s - pair.delay_s(mouth)) / variance.sqrt();
                residual.is_finite().then_some(residual)
            })
    }

    /// The mouth that fits a frame best and its cost.
    fn best(
        &self,
        array: &MicrophoneArray,
        frame: &Frame<'_>,
        offset_s: f64,
    ) -> Option<(f64, WorldPoint, Matrix3<f64>)> {
        self.mouths(frame, offset_s)
            .map(|(mouth, covariance)| {
                let residuals = self.residuals(array, frame, mouth, covariance);
                let cost: f64 = residuals.map(|r| 0.5 * r * r / (1.0 + r * r)).sum();
                (cost, mouth, covariance)
            })
            .min_by(|one, other| one.0.total_cmp(&other.0))
    }

    fn declared_cost(&self, unknowns: &[f64]) -> f64 {
        let [level, height] = self.settings.place_m;
        0.5 * ((unknowns[2] / level).powi(2) + (unknowns[3] / level).powi(2) + (unknowns[4] / height).powi(2))
    }

    /// The most promising clocks and turns: those with the least cost.
    pub(super) fn starts(&self) -> Vec<DVector<f64>> {
        let steps = |most: f64, step: f64| {
            let count = (most / step).floor() as i64;
            (-count..=count).map(move |number| number as f64 * step)
        };
        let mut found: Vec<(f64, DVector<f64>)> = Vec::new();
        for turn_deg in steps(self.settings.turn_deg, 2.5) {
            for offset_s in steps(self.settings.offset_s, 0.04) {
                let unknowns = DVector::from_vec(vec![offset_s, turn_deg.to_radians(), 0.0, 0.0, 0.0]);
                let cost = self.cost(&unknowns);
                if cost.is_finite() {
                    found.push((cost, unknowns));
                }
            }
        }
        found.sort_by(|one, other| one.0.total_cmp(&other.0));
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
        for frame in &self.frames {
            let Some((_, mouth, covariance)) = self.best(&array, frame, unknowns[0]) else {
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
        let turn_rad = BEYOND * self.settings.turn_deg.to_radians();
        if unknowns[0].abs() > BEYOND * self.settings.offset_s || unknowns[1].abs() > turn_rad {
            return f64::INFINITY;
        }
        let frames = self.frames.iter();
        frames
            .filter_map(|frame| Some(self.best(&array, frame, unknowns[0])?.0))
            .sum::<f64>()
            + self.declared_cost(unknowns.as_slice())
    }

    fn normal(&self, unknowns: &DVector<f64>, matrix: &mut DMatrix<f64>, side: &mut DVector<f64>) {
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
        for frame in &self.frames {
            let Some((_, mouth, covariance)) = self.best(&here, frame, unknowns[0]) else {
                continue;
            };
            // The same person a little earlier or later.
            let near = |offset_s: f64| {
                self.mouths(frame, offset_s)
                    .min_by(|one, other| one.0.distance_m(mouth).total_cmp(&other.0.distance_m(mouth)))
            };
            let ends = [near(around[0].1), near(around[1].1)].map(|end| end.map(|(mouth, _)| mouth));
            for (number, (own, delay_s)) in own.iter().zip(&frame.heard.delays_s).enumerate() {
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
