//! Higher order tracking accuracy: detection and association in balance, over all overlaps asked for.
//!
//! Luiten, Osep, Dendorfer, Torr, Geiger, Leal-Taixé and Leibe, "HOTA: a higher order metric for evaluating multi-object
//! tracking", 2020. Numbers are those of TrackEval, also where one side is empty: no pair gives HOTA 0 and LocA 1. Where
//! both are empty nothing is defined.

use super::pairs::PairNumbers;
use super::{Better, Counts, Family, JudgeError, MetricInfo, UNIT_RANGE, Unit, metric};
use crate::case::Case;
use crate::matching::{Aim, Edge, Matcher};
use crate::sequence::{Sequence, SequenceError};

/// The similarities asked for: 0.05, 0.1, ... 0.95.
pub const ALPHAS: usize = 19;

/// The similarity asked for at a place, 0.05 to 0.95.
pub fn alpha(place: usize) -> f64 {
    // As numpy.arange(0.05, 0.99, 0.05) rounds.
    0.05 + place as f64 * 0.05
}

/// The family.
pub struct Hota;

/// What is counted, each at every similarity asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HotaCounts {
    /// Pairs.
    pub true_positives: [f64; ALPHAS],
    /// People without a track, summed over frames.
    pub false_negatives: [f64; ALPHAS],
    /// Tracks without a person, summed over frames.
    pub false_positives: [f64; ALPHAS],
    /// Sum of the similarities of pairs.
    pub similarity: [f64; ALPHAS],
    /// Sum over pairs of how much of both lives they are paired, 0 to 1.
    pub association: [f64; ALPHAS],
    /// Sum over pairs of how much of the person's life they are paired, 0 to 1.
    pub association_recall: [f64; ALPHAS],
    /// Sum over pairs of how much of the track's life they are paired, 0 to 1.
    pub association_precision: [f64; ALPHAS],
}

/// HOTA and its parts at one similarity asked for, or their means over all; each 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HotaValues {
    /// Square root of `det_a` times `ass_a`.
    pub hota: f64,
    /// Detection accuracy.
    pub det_a: f64,
    /// Association accuracy.
    pub ass_a: f64,
    /// Detection recall.
    pub det_re: f64,
    /// Detection precision.
    pub det_pr: f64,
    /// Association recall.
    pub ass_re: f64,
    /// Association precision.
    pub ass_pr: f64,
    /// Mean similarity of pairs.
    pub loc_a: f64,
}

/// Counts in a sequence.
///
/// # Errors
/// [`SequenceError::TooLarge`].
pub fn hota(sequence: &Sequence) -> Result<HotaCounts, SequenceError> {
    let mut counts = HotaCounts::default();
    let (people, tracks) = (sequence.truth().len(), sequence.tracks().len());
    if people == 0 || tracks == 0 {
        counts.false_negatives = [people as f64; ALPHAS];
        counts.false_positives = [tracks as f64; ALPHAS];
        return Ok(counts);
    }
    let alignment = Alignment::of(sequence);
    let mut paired = vec![[0_u32; ALPHAS]; alignment.numbers.len()];
    let limits: [f64; ALPHAS] = std::array::from_fn(|place| alpha(place) - f64::EPSILON);
    let (mut edges, mut pairs, mut matcher) = (Vec::new(), Vec::new(), Matcher::default());
    for frame in sequence.frames() {
        edges.clear();
        for (person, track, similarity) in frame.similar() {
            let (seen, other) = (frame.truth[person].who, frame.tracks[track].who);
            if let Some(number) = alignment.numbers.known(seen, other) {
                let cost = -alignment.score[number] * similarity;
                let (row, column) = (person as u32, track as u32);
                edges.push(Edge { row, column, cost });
            }
        }
        matcher.pair(
            frame.truth.len(),
            frame.tracks.len(),
            &edges,
            Aim::Least,
            &mut pairs,
        )?;
        for &(person, track) in &pairs {
            let (person, track) = (person as usize, track as usize);
            let similarity = frame.similarity(person, track);
            let (seen, other) = (frame.truth[person].who, frame.tracks[track].who);
            let Some(number) = alignment.numbers.known(seen, other) else {
                continue;
            };
            for place in 0..limits.iter().take_while(|&&limit| similarity >= limit).count() {
                counts.true_positives[place] += 1.0;
                counts.similarity[place] += similarity;
                paired[number][place] += 1;
            }
        }
    }
    for place in 0..ALPHAS {
        counts.false_negatives[place] = people as f64 - counts.true_positives[place];
        counts.false_positives[place] = tracks as f64 - counts.true_positives[place];
    }
    for (person, track, number) in alignment.numbers.iter() {
        let of_person = alignment.frames_of_person[person as usize];
        let of_track = alignment.frames_of_track[track as usize];
        for place in 0..ALPHAS {
            let together = f64::from(paired[number][place]);
            if together > 0.0 {
                let squared = together * together;
                counts.association[place] += squared / (of_person + of_track - together).max(1.0);
                counts.association_recall[place] += squared / of_person;
                counts.association_precision[place] += squared / of_track;
            }
        }
    }
    Ok(counts)
}

/// How well people and tracks fit over the whole sequence, before anyone is paired.
struct Alignment {
    numbers: PairNumbers,
    /// By the number of the pair, 0 to 1.
    score: Vec<f64>,
    frames_of_person: Vec<f64>,
    frames_of_track: Vec<f64>,
}

impl Alignment {
    fn of(sequence: &Sequence) -> Self {
        let mut numbers = PairNumbers::new(sequence.person_count());
        let mut together: Vec<f64> = Vec::new();
        let mut frames_of_person = vec![0.0_f64; sequence.person_count()];
        let mut frames_of_track = vec![0.0_f64; sequence.track_count()];
        let (mut of_person, mut of_track, mut similar) = (Vec::new(), Vec::new(), Vec::new());
        for frame in sequence.frames() {
            of_person.clear();
            of_person.resize(frame.truth.len(), 0.0);
            of_track.clear();
            of_track.resize(frame.tracks.len(), 0.0);
            for person in frame.truth {
                frames_of_person[person.who as usize] += 1.0;
            }
            for track in frame.tracks {
                frames_of_track[track.who as usize] += 1.0;
            }
            similar.clear();
            similar.extend(frame.similar());
            for &(person, track, similarity) in &similar {
                of_person[person] += similarity;
                of_track[track] += similarity;
            }
            for &(person, track, similarity) in &similar {
                let all = of_track[track] + of_person[person] - similarity;
                if all > f64::EPSILON {
                    let number = numbers.number(frame.truth[person].who, frame.tracks[track].who);
                    together.resize(numbers.len(), 0.0);
                    together[number] += similarity / all;
                }
            }
        }
        let mut score = vec![0.0; numbers.len()];
        for (person, track, number) in numbers.iter() {
            let either =
                frames_of_person[person as usize] + frames_of_track[track as usize] - together[number];
            score[number] = together[number] / either;
        }
        Self {
            numbers,
            score,
            frames_of_person,
            frames_of_track,
        }
    }
}

impl HotaCounts {
    /// The values at a similarity asked for, by its place in [`alpha`].
    pub fn at(&self, place: usize) -> HotaValues {
        let pairs = self.true_positives[place];
        let (missed, wrong) = (self.false_negatives[place], self.false_positives[place]);
        let of_pairs = |sum: f64| sum / pairs.max(1.0);
        let (det_a, ass_a) = (
            pairs / (pairs + missed + wrong).max(1.0),
            of_pairs(self.association[place]),
        );
        HotaValues {
            hota: libm::sqrt(det_a * ass_a),
            det_a,
            ass_a,
            det_re: pairs / (pairs + missed).max(1.0),
            det_pr: pairs / (pairs + wrong).max(1.0),
            ass_re: of_pairs(self.association_recall[place]),
            ass_pr: of_pairs(self.association_precision[place]),
            loc_a: self.similarity[place].max(1e-10) / pairs.max(1e-10),
        }
    }

    /// The means over all similarities asked for; none where nobody is there and no track.
    pub fn mean(&self) -> Option<HotaValues> {
        if self.true_positives[0] + self.false_negatives[0] + self.false_positives[0] == 0.0 {
            return None;
        }
        let all: [HotaValues; ALPHAS] = std::array::from_fn(|place| self.at(place));
        let mean = |of: fn(&HotaValues) -> f64| all.iter().map(of).sum::<f64>() / ALPHAS as f64;
        Some(HotaValues {
            hota: mean(|values| values.hota),
            det_a: mean(|values| values.det_a),
            ass_a: mean(|values| values.ass_a),
            det_re: mean(|values| values.det_re),
            det_pr: mean(|values| values.det_pr),
            ass_re: mean(|values| values.ass_re),
            ass_pr: mean(|values| values.ass_pr),
            loc_a: mean(|values| values.loc_a),
        })
    }
}

impl Counts for HotaCounts {
    fn add(&mut self, other: &Self) {
        let add = |sum: &mut [f64; ALPHAS], part: &[f64; ALPHAS]| {
            sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        };
        add(&mut self.true_positives, &other.true_positives);
        add(&mut self.false_negatives, &other.false_negatives);
        add(&mut self.false_positives, &other.false_positives);
        add(&mut self.similarity, &other.similarity);
        add(&mut self.association, &other.association);
        add(&mut self.association_recall, &other.association_recall);
        add(&mut self.association_precision, &other.association_precision);
    }

    fn values(&self) -> Vec<Option<f64>> {
        let mean = self.mean();
        let least = mean.map(|_| self.at(0));
        vec![
            mean.map(|values| values.hota),
            mean.map(|values| values.det_a),
            mean.map(|values| values.ass_a),
            mean.map(|values| values.loc_a),
            mean.map(|values| values.det_re),
            mean.map(|values| values.det_pr),
            mean.map(|values| values.ass_re),
            mean.map(|values| values.ass_pr),
            least.map(|values| values.hota),
            least.map(|values| values.loc_a),
        ]
    }
}

const fn part(name: &'static str, meaning: &'static str) -> MetricInfo {
    metric(name, Unit::Ratio, UNIT_RANGE, Better::Up, meaning)
}

impl Family for Hota {
    type Counts = HotaCounts;
    const NAME: &'static str = "HOTA";
    const SOURCE: &'static str = "Luiten et al. 2020; numbers as TrackEval";
    const METRICS: &'static [MetricInfo] = &[
        part(
            "HOTA",
            "Detection and association in balance, mean over similarities 0.05 to 0.95.",
        ),
        part("DetA", "Detection accuracy."),
        part("AssA", "Association accuracy."),
        part("LocA", "Mean similarity of pairs; 1 where there are none."),
        part("DetRe", "Part of the people that have a track."),
        part("DetPr", "Part of the tracks that have a person."),
        part("AssRe", "How much of a person's life has the track of the pair."),
        part("AssPr", "How much of a track's life has the person of the pair."),
        part("HOTA(0)", "HOTA at the least similarity asked for, 0.05."),
        part("LocA(0)", "LocA at the least similarity asked for, 0.05."),
    ];

    fn count(case: &Case) -> Result<Option<HotaCounts>, JudgeError> {
        if case.sequence.is_empty() {
            return Ok(None);
        }
        Ok(Some(hota(&case.sequence)?))
    }
}
