//! Clock, turn and place of a microphone array, from people who talk and are seen by calibrated cameras.
//!
//! Unknown are how late the array's clock is, its turn about the vertical axis through its middle, and where its middle is.
//! Every loud frame gives the delay of each pair ([`Listener`]); it should be that of one of the mouths seen at its time
//! ([`Sighting`]). Residuals are in units of their deviations, which grow with the uncertainty of the mouth; they weigh less
//! the larger they are (Geman and McClure), so that reflections, noise and people who are not seen do little harm. A search
//! over clock and turn finds where to begin; damped least squares do the rest. What is declared of the place counts as one
//! more measurement, since arrays that are small or level hardly tell their distance and height.
//!
//! Mouths come from lines of sight ([`FaceSight`]): from where those of several cameras meet or, of one camera, from how wide
//! a face is ([`sightings`]). Trackers lag behind whom they follow, which no sound tells from a late clock: the lag is
//! measured by faces that are found anew ([`measure_lag`]) and taken out. Only frames count during which the same people are
//! seen whatever the clock; of several people the one counts whose mouth fits a frame best.
//!
//! The speaker must be seen: mouths of people who are silent, alone in view, make clock and turn wrong together. So an
//! answer is refused that reaches beyond the search by its deviation, or that has a rival far away.

mod listening;
mod meeting;
mod search;
mod sights;

pub use listening::{HeardDelays, Listener};
pub use meeting::sightings;
pub use sights::{FaceSight, Lag, measure_lag};

use crate::error::CalibrateError;
use crate::least_squares::{Minimum, Problem, minimize};
use hearsight_core::microphones::MicrophoneArray;
use hearsight_core::{Instant, WorldPoint};
use listening::HOP_S;
use nalgebra::{Matrix3, Vector3};
use search::{Search, moved};

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
/// Faces and reflections err alike for so long, seconds: frames within count once.
const INDEPENDENT_S: f64 = 0.5;
/// A minimum is a rival where it costs less than so much more, as independent frames count: two standard deviations.
const RIVAL_COST: f64 = 2.0;
/// And where its clock or turn is apart by more than this, seconds and degrees,
const RIVAL_APART: (f64, f64) = (0.1, 5.0);
/// and by more than so many standard deviations, which tell of what is nearer.
const RIVAL_DEVIATIONS: f64 = 2.0;
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
    let search = Search::new(declared, heard, people, settings);
    let frames = search.frames();
    if frames < LEAST_FRAMES {
        return Err(CalibrateError::TooLittleSpeech {
            frames,
            needed: LEAST_FRAMES,
        });
    }
    let starts = search.starts().into_iter();
    let mut minima: Vec<(f64, Minimum)> = starts
        .filter_map(|start| minimize(&search, start))
        .map(|minimum| (search.cost(&minimum.unknowns), minimum))
        .collect();
    minima.sort_by(|one, other| one.0.total_cmp(&other.0));
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

#[cfg(test)]
mod tests;
