//! Turns of speech on both sides, cut to what is evaluated, and how long who speaks together with whom.
//!
//! The rules are those of pyannote.metrics: a collar is cut out around every boundary of the truth, half of it on either
//! side (NIST's md-eval cuts the whole of its collar on either side); with `skip_overlap` so is every time at which the
//! truth has two turns at once.

use std::collections::BTreeMap;
use thiserror::Error;

/// Most steps of the comparison of two sides before it is refused.
const MOST_STEPS: usize = 200_000_000;
/// What is shorter does not exist, seconds.
const SHORTEST_S: f64 = 1e-6;

/// Somebody speaks from a start to an end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Start, seconds.
    pub start_s: f64,
    /// End, seconds.
    pub end_s: f64,
    /// Index of the speaker on their side, from 0.
    pub speaker: u32,
}

/// What both sides say of who speaks when, and what of it is evaluated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Speech {
    /// The truth.
    pub truth: Vec<Turn>,
    /// The result.
    pub result: Vec<Turn>,
    /// Start and end of what is evaluated, seconds; none for all from the first start to the last end of both.
    pub span_s: Option<[f64; 2]>,
    /// Length cut out around each boundary of the truth, half on either side, seconds.
    pub collar_s: f64,
    /// Whether time at which the truth has several turns at once is cut out.
    pub skip_overlap: bool,
}

/// Turns overlap more often than can be compared.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("{turns} turns overlap too much to be compared; merge the turns of each speaker")]
pub struct TooManyTurns {
    /// Turns of both sides.
    pub turns: usize,
}

/// A time between two boundaries.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stretch {
    pub(crate) duration_s: f64,
    /// Speaker and number of their turns that sound at once.
    pub(crate) truth: Vec<(u32, u32)>,
    pub(crate) result: Vec<(u32, u32)>,
}

/// The evaluated time in stretches in which nothing changes, and who is whom.
#[derive(Clone, Debug, Default)]
pub(crate) struct Compared {
    pub(crate) stretches: Vec<Stretch>,
    /// The speaker of the result for each speaker of the truth, so that both speak together as long as possible.
    pub(crate) result_of_truth: BTreeMap<u32, u32>,
}

/// Cuts both sides to what is evaluated and finds who is whom.
pub(crate) fn compare(speech: &Speech) -> Result<Compared, TooManyTurns> {
    let evaluated = evaluated(speech);
    let truth = crop(&speech.truth, &evaluated);
    let result = crop(&speech.result, &evaluated);
    let too_many = TooManyTurns {
        turns: truth.len() + result.len(),
    };
    // (time, +1 or -1, whether of the truth, speaker)
    let mut boundaries: Vec<(f64, bool, bool, u32)> = Vec::with_capacity(2 * (truth.len() + result.len()));
    for (turns, of_truth) in [(&truth, true), (&result, false)] {
        for turn in turns {
            boundaries.push((turn.start_s, true, of_truth, turn.speaker));
            boundaries.push((turn.end_s, false, of_truth, turn.speaker));
        }
    }
    boundaries.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
    let mut compared = Compared::default();
    let mut together: BTreeMap<(u32, u32), f64> = BTreeMap::new();
    let mut active = [BTreeMap::<u32, u32>::new(), BTreeMap::new()];
    let (mut steps, mut before) = (0_usize, f64::NEG_INFINITY);
    for (time_s, starts, of_truth, speaker) in boundaries {
        let duration_s = time_s - before;
        if duration_s > 0.0 && !(active[0].is_empty() && active[1].is_empty()) {
            steps = steps.saturating_add((active[0].len() + 1).saturating_mul(active[1].len() + 1));
            if steps > MOST_STEPS {
                return Err(too_many);
            }
            for (&person, &turns) in &active[0] {
                for (&track, &others) in &active[1] {
                    *together.entry((person, track)).or_default() +=
                        duration_s * f64::from(turns) * f64::from(others);
                }
            }
            let list = |side: &BTreeMap<u32, u32>| side.iter().map(|(&who, &turns)| (who, turns)).collect();
            compared.stretches.push(Stretch {
                duration_s,
                truth: list(&active[0]),
                result: list(&active[1]),
            });
        }
        before = time_s;
        let side = &mut active[usize::from(!of_truth)];
        let turns = side.entry(speaker).or_default();
        if starts {
            *turns += 1;
        } else {
            *turns = turns.saturating_sub(1);
            if *turns == 0 {
                side.remove(&speaker);
            }
        }
    }
    compared.result_of_truth = longest_together(&together).ok_or(too_many)?;
    Ok(compared)
}

/// The pairing in which both speak together as long as possible.
fn longest_together(together: &BTreeMap<(u32, u32), f64>) -> Option<BTreeMap<u32, u32>> {
    use crate::matching::{Aim, Edge, Matcher};
    let number = |of: &dyn Fn(&(u32, u32)) -> u32| {
        let mut found: Vec<u32> = together.keys().map(of).collect();
        found.sort_unstable();
        found.dedup();
        found
    };
    let (rows, columns) = (number(&|key| key.0), number(&|key| key.1));
    let place = |of: &[u32], who: u32| of.partition_point(|&other| other < who) as u32;
    let edges: Vec<Edge> = together
        .iter()
        .map(|(&(person, track), &seconds)| Edge {
            row: place(&rows, person),
            column: place(&columns, track),
            cost: -seconds,
        })
        .collect();
    let mut pairs = Vec::new();
    let mut matcher = Matcher::default();
    matcher
        .pair(rows.len(), columns.len(), &edges, Aim::Least, &mut pairs)
        .ok()?;
    let named = |(row, column): (u32, u32)| (rows[row as usize], columns[column as usize]);
    Some(pairs.into_iter().map(named).collect())
}

/// What is evaluated: intervals apart, ascending.
fn evaluated(speech: &Speech) -> Vec<[f64; 2]> {
    let all = || speech.truth.iter().chain(&speech.result);
    let span = speech.span_s.unwrap_or_else(|| {
        let start = all().map(|turn| turn.start_s).fold(f64::INFINITY, f64::min);
        let end = all().map(|turn| turn.end_s).fold(f64::NEG_INFINITY, f64::max);
        [start, end]
    });
    let mut cut: Vec<[f64; 2]> = Vec::new();
    if speech.collar_s > 0.0 {
        let half = 0.5 * speech.collar_s;
        for turn in &speech.truth {
            cut.push([turn.start_s - half, turn.start_s + half]);
            cut.push([turn.end_s - half, turn.end_s + half]);
        }
    }
    if speech.skip_overlap {
        cut.extend(overlaps(&speech.truth));
    }
    cut.sort_by(|one, other| one[0].total_cmp(&other[0]));
    let mut left = Vec::new();
    let mut start = span[0];
    for [from, to] in cut {
        if from - start > SHORTEST_S {
            left.push([start, from.min(span[1])]);
        }
        start = start.max(to);
    }
    left.push([start, span[1]]);
    left.retain(|[from, to]| to - from > SHORTEST_S);
    left
}

/// Where at least two turns sound at once.
fn overlaps(turns: &[Turn]) -> Vec<[f64; 2]> {
    let mut boundaries: Vec<(f64, bool)> = turns
        .iter()
        .flat_map(|turn| [(turn.start_s, true), (turn.end_s, false)])
        .collect();
    boundaries.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
    let (mut found, mut active, mut since) = (Vec::new(), 0_usize, 0.0);
    for (time_s, starts) in boundaries {
        let before = active;
        active = if starts {
            active + 1
        } else {
            active.saturating_sub(1)
        };
        match (before, active) {
            (1, 2) => since = time_s,
            (2, 1) => found.push([since, time_s]),
            _ => {}
        }
    }
    found
}

/// The parts of turns within intervals that are apart and ascending.
fn crop(turns: &[Turn], intervals: &[[f64; 2]]) -> Vec<Turn> {
    let mut pieces = Vec::with_capacity(turns.len());
    for turn in turns {
        let first = intervals.partition_point(|[_, to]| *to <= turn.start_s);
        for &[from, to] in intervals[first..]
            .iter()
            .take_while(|[from, _]| *from < turn.end_s)
        {
            let piece = Turn {
                start_s: turn.start_s.max(from),
                end_s: turn.end_s.min(to),
                speaker: turn.speaker,
            };
            if piece.end_s - piece.start_s > SHORTEST_S {
                pieces.push(piece);
            }
        }
    }
    pieces
}
