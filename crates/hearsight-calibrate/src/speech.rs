//! Clock, turn and place of a microphone array, from people who talk and are seen by calibrated cameras.
//!
//! Unknown are how late the array's clock is, its turn about the vertical axis through its middle, and where its middle is.
//! Every loud frame gives the delay of each pair ([`Listener`]); it should be that of one of the mouths seen at its time
//! ([`Sighting`]). Residuals are in units of their deviations, which grow with the uncertainty of the mouth; they weigh less
//! the larger they are (Geman and McClure), so that reflections, noise and people who are not seen do little harm. A search
//! over clock and turn finds where to begin; damped least squares do the rest. What is declared of the place counts as one
//! more measurement, since arrays that are small or level hardly tell their distance and height.
//!
//! The speaker must be seen: mouths of people who are silent, alone in view, make clock and turn wrong together. So an
//! answer is refused that reaches beyond the search by its deviation, or that has a rival far away.

mod listening;

pub use listening::{HeardDelays, Listener};

use crate::error::CalibrateError;
use crate::least_squares::{Minimum, Problem, minimize};
use hearsight_core::microphones::MicrophoneArray;
use hearsight_core::{Instant, Span, WorldPoint};
use listening::HOP_S;
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};

/// A mouth that is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// When.
    pub time: Instant,
    /// Whose, as far as can be told: mouths of one number are followed from one sighting to the next.
    pub person: u64,
    /// Where.
    pub mouth: WorldPoint,
    /// How sure, square metres.
    pub covariance: Matrix3<f64>,
}

/// What may be, and what is declared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeechSettings {
    /// Largest offset of the clock, seconds. Default 0.4.
    pub offset_s: f64,
    /// Largest turn, degrees. Default 30.
    pub turn_deg: f64,
    /// How far the array may be from where it is declared, a standard deviation level and one of height, metres. Default
    /// 0.3 and 0.1.
    pub place_m: [f64; 2],
    /// Standard deviation of a delay that is heard well, seconds. Default 0.00005.
    pub delay_s: f64,
}

impl Default for SpeechSettings {
    fn default() -> Self {
        Self {
            offset_s: 0.4,
            turn_deg: 30.0,
            place_m: [0.3, 0.1],
            delay_s: 5e-5,
        }
    }
}

/// How an array differs from what is declared, with standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArrayCalibration {
    /// What must be added to the declared start of the array, seconds.
    pub offset_s: f64,
    /// Its standard deviation.
    pub offset_deviation_s: f64,
    /// By how much the array is turned counter-clockwise, seen from above, radians.
    pub turn_rad: f64,
    /// Its standard deviation.
    pub turn_deviation_rad: f64,
    /// How far its middle is from the declared one, metres.
    pub shift_m: Vector3<f64>,
    /// Its standard deviations.
    pub shift_deviation_m: Vector3<f64>,
    /// Loud frames during which somebody is seen.
    pub frames: usize,
    /// Share of them that fit, 0 to 1.
    pub share: f64,
}

/// Frames needed.
const LEAST_FRAMES: usize = 40;
/// Share of the frames that must fit.
const LEAST_SHARE: f64 = 0.15;
/// A mouth is known between two sightings not farther apart than this.
const LONGEST_GAP: Span = Span::from_nanoseconds(300_000_000);
/// Faces and reflections err alike for so long, seconds: frames within count once.
const INDEPENDENT_S: f64 = 0.5;
/// A frame fits where its delays weigh so much in the mean.
const FITS: f64 = 0.3;
/// Times that the least mean cost is looked for, each from the one before (Dinkelbach 1967).
const ROUNDS: usize = 4;
/// Starts are at least so far apart, seconds and degrees: neighbours would lead to one minimum and hide its rivals.
const STARTS_APART: (f64, f64) = (0.1, 7.5);
/// How many starts there are.
const STARTS: usize = 8;
/// A minimum is a rival where it costs less than so much more, as independent frames count: two standard deviations.
const RIVAL_COST: f64 = 2.0;
/// And where its clock or turn is apart by more than this, seconds and degrees,
const RIVAL_APART: (f64, f64) = (0.1, 5.0);
/// and by more than so many standard deviations, which tell of what is nearer.
const RIVAL_DEVIATIONS: f64 = 2.0;
/// Unknowns: offset in seconds, turn in radians, shift in metres.
const UNKNOWNS: usize = 5;

impl ArrayCalibration {
    /// The microphones where they are, from where they are declared.
    ///
    /// # Errors
    /// [`CalibrateError::Singular`] where they would be nowhere.
    pub fn apply(&self, declared: &MicrophoneArray) -> Result<MicrophoneArray, CalibrateError> {
        let shift = self.shift_m;
        moved(
            declared,
            &[self.offset_s, self.turn_rad, shift.x, shift.y, shift.z],
        )
        .ok_or(CalibrateError::Singular(
            "the microphones would not be at finite places",
        ))
    }
}

/// Finds clock, turn and place.
///
/// # Errors
/// [`CalibrateError`] where nobody is seen, nothing is heard, or what is heard does not come from who is seen.
pub fn calibrate(
    declared: &MicrophoneArray,
    heard: &[HeardDelays],
    seen: &[Sighting],
    settings: &SpeechSettings,
) -> Result<ArrayCalibration, CalibrateError> {
    let mut seen: Vec<Sighting> = seen
        .iter()
        .filter(|sighting| {
            sighting
                .mouth
                .0
                .iter()
                .chain(sighting.covariance.iter())
                .all(|value| value.is_finite())
        })
        .copied()
        .collect();
    if seen.is_empty() {
        return Err(CalibrateError::SpeakerNeverSeen);
    }
    if heard.is_empty() {
        return Err(CalibrateError::SpeakerNeverHeard);
    }
    seen.sort_by_key(|sighting| (sighting.person, sighting.time));
    let mut people: Vec<Vec<Sighting>> = Vec::new();
    for sighting in seen {
        match people.last_mut() {
            Some(last) if last[0].person == sighting.person => last.push(sighting),
            _ => people.push(vec![sighting]),
        }
    }
    let mut search = Search {
        declared,
        heard,
        people,
        settings,
        neutral: 0.0,
    };
    let frames = search.frames(0.0);
    if frames < LEAST_FRAMES {
        return Err(CalibrateError::TooLittleSpeech {
            frames,
            needed: LEAST_FRAMES,
        });
    }
    let mut starts = search.starts();
    let mut minima: Vec<(f64, Minimum)> = Vec::new();
    for _ in 0..ROUNDS {
        minima = starts
            .into_iter()
            .filter_map(|start| minimize(&search, start))
            .map(|minimum| (search.cost(&minimum.unknowns), minimum))
            .collect();
        minima.sort_by(|one, other| one.0.total_cmp(&other.0));
        let Some((_, minimum)) = minima.first() else { break };
        search.neutral = search.mean_cost(&minimum.unknowns).unwrap_or(search.neutral);
        starts = minima
            .iter()
            .map(|(_, minimum)| minimum.unknowns.clone())
            .collect();
    }
    let ((least, minimum), rivals) = minima.split_first().ok_or(CalibrateError::Singular(
        "nothing heard changes with clock, turn or place",
    ))?;
    let unknowns = &minimum.unknowns;
    let (frames, fitting) = search.fitting(unknowns);
    let share = fitting as f64 / frames.max(1) as f64;
    if share < LEAST_SHARE {
        return Err(CalibrateError::DoesNotFit {
            share: 100.0 * share,
            offset_s: settings.offset_s,
            turn_deg: settings.turn_deg,
        });
    }
    // Pairs share microphones and frames overlap: so many residuals count once.
    let microphones = declared.positions().len() as f64;
    let inflation = (microphones / 2.0 * INDEPENDENT_S / HOP_S).max(1.0);
    let deviation = |at: usize| (minimum.covariance[(at, at)] * inflation).max(0.0).sqrt();
    let (offset_s, turn) = (unknowns[0], unknowns[1].to_degrees());
    let (offset_deviation_s, turn_deviation) = (deviation(0), deviation(1).to_degrees());
    // One that may as well lie beyond the border is not told from those that were not searched.
    if offset_s.abs() + offset_deviation_s > settings.offset_s
        || turn.abs() + turn_deviation > settings.turn_deg
    {
        return Err(CalibrateError::Outside {
            offset_s,
            offset_deviation_s,
            turn,
            turn_deviation,
            most_s: settings.offset_s,
            most_deg: settings.turn_deg,
        });
    }
    let rival = rivals.iter().find(|(cost, rival)| {
        let apart = |at: usize, least: f64| {
            (rival.unknowns[at] - unknowns[at]).abs() > least.max(RIVAL_DEVIATIONS * deviation(at))
        };
        (cost - least) / inflation < RIVAL_COST
            && (apart(0, RIVAL_APART.0) || apart(1, RIVAL_APART.1.to_radians()))
    });
    if let Some((_, rival)) = rival {
        return Err(CalibrateError::Ambiguous {
            offset_s,
            turn,
            other_offset_s: rival.unknowns[0],
            other_turn: rival.unknowns[1].to_degrees(),
        });
    }
    // A declared place is not made less sure by frames that repeat themselves.
    let [level, height] = settings.place_m;
    Ok(ArrayCalibration {
        offset_s: unknowns[0],
        offset_deviation_s,
        turn_rad: unknowns[1],
        turn_deviation_rad: deviation(1),
        shift_m: Vector3::new(unknowns[2], unknowns[3], unknowns[4]),
        shift_deviation_m: Vector3::new(
            deviation(2).min(level),
            deviation(3).min(level),
            deviation(4).min(height),
        ),
        frames,
        share,
    })
}

struct Search<'a> {
    declared: &'a MicrophoneArray,
    heard: &'a [HeardDelays],
    people: Vec<Vec<Sighting>>,
    settings: &'a SpeechSettings,
    /// What a frame costs at whose time nobody is seen: what the others cost in the mean, so that the clock is not drawn
    /// to where most are seen.
    neutral: f64,
}

/// The array after a change of turn and place.
fn moved(declared: &MicrophoneArray, unknowns: &[f64]) -> Option<MicrophoneArray> {
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

    fn frames(&self, offset_s: f64) -> usize {
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
    fn mean_cost(&self, unknowns: &DVector<f64>) -> Option<f64> {
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
    fn starts(&mut self) -> Vec<DVector<f64>> {
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
    fn fitting(&self, unknowns: &DVector<f64>) -> (usize, usize) {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn ring() -> MicrophoneArray {
        let place = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / 6.0;
            WorldPoint::new(0.15 * angle.cos(), 0.15 * angle.sin(), 0.9)
        };
        MicrophoneArray::new((0..6).map(place).collect()).unwrap()
    }

    /// Somebody who walks a figure before the array.
    fn mouth(seconds: f64) -> WorldPoint {
        WorldPoint::new(
            1.6 + 0.7 * (0.5 * seconds).sin(),
            1.2 * (0.9 * seconds).sin(),
            1.5,
        )
    }

    fn sightings(error_m: f64) -> Vec<Sighting> {
        let at = |tick: u32| {
            let seconds = f64::from(tick) * 0.1;
            let wrong = error_m * (1.7 * seconds).sin();
            let place = mouth(seconds).0 + Vector3::new(wrong, 0.3 * wrong, 0.0);
            Sighting {
                time: Instant::ZERO + Span::from_seconds(seconds),
                person: 1,
                mouth: WorldPoint(place),
                covariance: Matrix3::identity() * error_m.max(0.02).powi(2),
            }
        };
        (0..300).map(at).collect()
    }

    /// What a wrongly declared array hears; every third frame is a reflection.
    fn heard(truth: &MicrophoneArray, late_s: f64) -> Vec<HeardDelays> {
        let at = |tick: u32| {
            let seconds = 1.0 + f64::from(tick) * 0.064;
            let from = if tick.is_multiple_of(3) {
                WorldPoint::new(-2.0, 1.0 + f64::from(tick % 7), 2.0)
            } else {
                mouth(seconds)
            };
            let delays_s = truth.pairs().map(|pair| pair.delay_s(from)).collect();
            let declared = Instant::ZERO + Span::from_seconds(seconds - late_s);
            HeardDelays::new(declared, delays_s)
        };
        (0..400).map(at).collect()
    }

    fn truth() -> (MicrophoneArray, [f64; UNKNOWNS]) {
        let wrong = [0.08, 10.0_f64.to_radians(), 0.15, -0.12, 0.0];
        (moved(&ring(), &wrong).unwrap(), wrong)
    }

    #[test]
    fn an_array_that_is_turned_moved_and_late_is_put_right() {
        let (truth, wrong) = truth();
        let found = calibrate(
            &ring(),
            &heard(&truth, wrong[0]),
            &sightings(0.1),
            &SpeechSettings::default(),
        )
        .unwrap();
        println!("{found:?}");
        assert!((found.offset_s - wrong[0]).abs() < 0.02, "{found:?}");
        assert!((found.turn_rad - wrong[1]).abs() < 0.02, "{found:?}");
        assert!(
            (found.shift_m - Vector3::new(wrong[2], wrong[3], 0.0)).norm() < 0.06,
            "{found:?}"
        );
        assert!(
            found.offset_deviation_s < 0.05 && found.turn_deviation_rad < 0.05,
            "{found:?}"
        );
        assert!(found.share > 0.5 && found.share < 0.8, "{found:?}");
        let applied = found.apply(&ring()).unwrap();
        for (ours, theirs) in applied.positions().iter().zip(truth.positions()) {
            assert!(ours.distance_m(*theirs) < 0.06);
        }
    }

    #[test]
    fn an_answer_outside_of_the_search_is_none() {
        let (array, wrong) = truth();
        let (heard, seen) = (heard(&array, wrong[0]), sightings(0.05));
        let narrow = SpeechSettings {
            offset_s: 0.06,
            ..SpeechSettings::default()
        };
        let found = calibrate(&ring(), &heard, &seen, &narrow).err();
        assert!(
            matches!(found, Some(CalibrateError::Outside { offset_s, .. }) if offset_s > 0.06),
            "{found:?}"
        );
    }

    #[test]
    fn an_answer_that_reaches_beyond_the_search_is_none() {
        let (array, wrong) = truth();
        let (heard, seen) = (heard(&array, wrong[0]), sightings(0.05));
        let free = calibrate(&ring(), &heard, &seen, &SpeechSettings::default()).unwrap();
        let border = |deviations: f64| SpeechSettings {
            offset_s: free.offset_s + deviations * free.offset_deviation_s,
            ..SpeechSettings::default()
        };
        let found = calibrate(&ring(), &heard, &seen, &border(0.5)).err();
        assert!(
            matches!(found, Some(CalibrateError::Outside { offset_s, .. }) if offset_s < border(0.5).offset_s),
            "{found:?}"
        );
        let found = calibrate(&ring(), &heard, &seen, &border(1.5));
        assert!(found.is_ok(), "{found:?}");
    }

    #[test]
    fn who_walks_around_the_array_one_way_looks_the_same_late_as_turned() {
        let place = |seconds: f64| {
            let angle = 0.7 * seconds;
            WorldPoint::new(1.6 * angle.cos(), 1.6 * angle.sin(), 1.5)
        };
        let seen: Vec<Sighting> = (0..150_i32)
            .map(|tick| Sighting {
                time: Instant::ZERO + Span::from_seconds(f64::from(tick) * 0.1),
                person: 1,
                mouth: place(f64::from(tick) * 0.1),
                covariance: Matrix3::identity() * 0.02_f64.powi(2),
            })
            .collect();
        let heard: Vec<HeardDelays> = (0..200_i32)
            .map(|tick| {
                let seconds = 1.0 + f64::from(tick) * 0.064;
                let delays_s = ring().pairs().map(|pair| pair.delay_s(place(seconds))).collect();
                HeardDelays::new(Instant::ZERO + Span::from_seconds(seconds), delays_s)
            })
            .collect();
        let found = calibrate(&ring(), &heard, &seen, &SpeechSettings::default()).err();
        println!("{found:?}");
        assert!(
            matches!(
                found,
                Some(
                    CalibrateError::Ambiguous { .. }
                        | CalibrateError::Outside { .. }
                        | CalibrateError::Singular(_)
                )
            ),
            "{found:?}"
        );
    }

    #[test]
    fn what_is_missing_is_said() {
        let (array, wrong) = truth();
        let (heard, seen) = (heard(&array, wrong[0]), sightings(0.05));
        let settings = SpeechSettings::default();
        let error =
            |heard: &[HeardDelays], seen: &[Sighting]| calibrate(&ring(), heard, seen, &settings).err();
        assert_eq!(error(&heard, &[]), Some(CalibrateError::SpeakerNeverSeen));
        assert_eq!(error(&[], &seen), Some(CalibrateError::SpeakerNeverHeard));
        assert!(matches!(
            error(&heard[..20], &seen),
            Some(CalibrateError::TooLittleSpeech { frames: 20, .. })
        ));
        let elsewhere: Vec<HeardDelays> = heard
            .iter()
            .enumerate()
            .map(|(tick, frame)| {
                let from = WorldPoint::new(-3.0, (tick % 11) as f64 - 5.0, 0.2);
                HeardDelays::new(frame.time, array.pairs().map(|pair| pair.delay_s(from)).collect())
            })
            .collect();
        let found = error(&elsewhere, &seen);
        assert!(
            matches!(found, Some(CalibrateError::DoesNotFit { .. })),
            "{found:?}"
        );
    }
}
