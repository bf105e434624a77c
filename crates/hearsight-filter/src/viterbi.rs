//! The likeliest path through a hidden Markov model, open or closed to a ring (Rabiner and Juang 1986).
//!
//! On a closed contour the last line is a neighbour of the first. An open chain leaves a step there, and cutting it at
//! one guessed state is wrong where that guess is. Here the ring is solved exactly by branch and bound over the state
//! of the first line (Appleton and Sun 2003, circular shortest paths): one pass over all of them gives the best path
//! whose two ends may differ, which bounds the rest; where they differ, the set of first states is divided between them.
//! On contours a few passes of O(lines * states^2) are enough; the worst case is one pass for each state.

use crate::elementary::ln;
use crate::error::FilterError;
use multiversion::multiversion;

/// States that are looked at side by side.
const LANES: usize = 8;

/// Logarithms of transition probabilities, states x states, each row summing to 1 as probabilities.
#[derive(Clone, Debug, PartialEq)]
pub struct Transitions {
    states: usize,
    /// For each state that is left, those to all that are gone to, in whole groups: what is read together lies together.
    logs: Vec<[f64; LANES]>,
}

impl Transitions {
    /// Smoothness between neighbours, `c exp(-(i - j)^2 / deviation^2)` (Chen and Rui, equation 11; corrected: `c` is a
    /// constant of each row, since a row at the end of the range has fewer states to go to).
    ///
    /// `deviation` is in states, above 0.
    ///
    /// # Errors
    /// [`FilterError::OutOfRange`] without states or for a deviation that is not finite and positive.
    pub fn smooth(states: usize, deviation: f64) -> Result<Self, FilterError> {
        if states == 0 {
            return Err(FilterError::OutOfRange {
                what: "states",
                range: "at least 1",
                found: 0.0,
            });
        }
        if !(deviation.is_finite() && deviation > 0.0) {
            return Err(FilterError::OutOfRange {
                what: "the deviation of a transition",
                range: "finite and positive",
                found: deviation,
            });
        }
        let exponent = |from: usize, to: usize| -(from.abs_diff(to) as f64 / deviation).powi(2);
        let mut transitions = Self::never(states);
        for from in 0..states {
            let sum: f64 = (0..states)
                .map(|to| crate::elementary::exp(exponent(from, to)))
                .sum();
            for to in 0..states {
                transitions.set(from, to, exponent(from, to) - ln(sum));
            }
        }
        Ok(transitions)
    }

    /// From the probabilities themselves, row by row (`from * states + to`); rows are normalized.
    ///
    /// # Errors
    /// [`FilterError::SizeMismatch`] unless there are states x states, [`FilterError::OutOfRange`] for a row without a
    /// positive finite sum or with a negative entry.
    pub fn new(states: usize, probabilities: &[f64]) -> Result<Self, FilterError> {
        FilterError::check_length("transition probabilities", states * states, probabilities.len())?;
        let mut transitions = Self::never(states);
        for (from, row) in probabilities.chunks_exact(states.max(1)).enumerate() {
            let sum: f64 = row.iter().sum();
            if !(sum.is_finite() && sum > 0.0) || row.iter().any(|value| *value < 0.0) {
                return Err(FilterError::OutOfRange {
                    what: "the sum of a row of transition probabilities",
                    range: "finite and positive, without negative entries",
                    found: sum,
                });
            }
            for (to, value) in row.iter().enumerate() {
                transitions.set(from, to, ln(value / sum));
            }
        }
        Ok(transitions)
    }

    /// From no state to any.
    fn never(states: usize) -> Self {
        Self {
            states,
            logs: vec![[f64::NEG_INFINITY; LANES]; states * states.div_ceil(LANES)],
        }
    }

    fn set(&mut self, from: usize, to: usize, log: f64) {
        let groups = self.states.div_ceil(LANES);
        self.logs[from * groups + to / LANES][to % LANES] = log;
    }

    /// How many states there are.
    pub fn states(&self) -> usize {
        self.states
    }

    /// The logarithm of the probability to go from one state to another.
    pub fn log(&self, from: usize, to: usize) -> f64 {
        self.logs[from * self.states.div_ceil(LANES) + to / LANES][to % LANES]
    }
}

/// Finds likeliest paths; owns its buffers.
#[derive(Clone, Debug, Default)]
pub struct Viterbi {
    scores: Vec<f64>,
    next: Vec<f64>,
    /// Best predecessor of every state of every line after the first; for a ring one line more.
    predecessors: Vec<u32>,
    nodes: Vec<Node>,
    passes: usize,
    /// Range of first states of the pass that the predecessors are of.
    tried: [usize; 2],
}

/// A range of first states with the best path that begins and ends within it.
#[derive(Clone, Copy, Debug)]
struct Node {
    low: usize,
    high: usize,
    bound: f64,
    start: usize,
    end: usize,
}

impl Viterbi {
    /// The likeliest path through an open chain. `emissions` holds the log-likelihoods of all states of one line after
    /// another (lines x states); the first states are equally likely. Returns the path's log-likelihood.
    ///
    /// # Errors
    /// [`FilterError::SizeMismatch`] unless `emissions` holds whole lines, at least one; [`FilterError::NoWeight`] where
    /// no path has a likelihood above zero.
    pub fn open(
        &mut self,
        transitions: &Transitions,
        emissions: &[f64],
        path: &mut Vec<usize>,
    ) -> Result<f64, FilterError> {
        let lines = check(transitions, emissions)?;
        let states = transitions.states;
        self.passes = 1;
        self.forward(transitions, emissions, lines, 0, states);
        let end = greatest(&self.scores).ok_or(FilterError::NoWeight)?;
        let score = self.scores[end];
        self.trace(states, lines, end, path);
        Ok(score)
    }

    /// The likeliest path around a ring: the last line is followed by the first. Exact. Otherwise as [`Self::open`].
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn closed(
        &mut self,
        transitions: &Transitions,
        emissions: &[f64],
        path: &mut Vec<usize>,
    ) -> Result<f64, FilterError> {
        let lines = check(transitions, emissions)?;
        let states = transitions.states;
        self.passes = 0;
        self.nodes.clear();
        // Ranges never outnumber the states.
        self.nodes.reserve(states);
        self.add_node(transitions, emissions, lines, 0, states);
        loop {
            // The greatest bound of all; of equal ones the range that begins first.
            let mut chosen: Option<usize> = None;
            for (place, node) in self.nodes.iter().enumerate() {
                let better = chosen.is_none_or(|best| {
                    let best = &self.nodes[best];
                    node.bound > best.bound || (node.bound == best.bound && node.low < best.low)
                });
                if better {
                    chosen = Some(place);
                }
            }
            let Some(place) = chosen else {
                return Err(FilterError::NoWeight);
            };
            let node = self.nodes.swap_remove(place);
            if node.start == node.end {
                if self.tried != [node.low, node.high] {
                    // Its path was overwritten.
                    self.ring_pass(transitions, emissions, lines, node.low, node.high);
                }
                self.trace(states, lines + 1, node.end, path);
                path.pop();
                return Ok(node.bound);
            }
            let middle = node.start.max(node.end);
            self.add_node(transitions, emissions, lines, node.low, middle);
            self.add_node(transitions, emissions, lines, middle, node.high);
        }
    }

    /// How many passes over all lines the last call took to find the path.
    pub fn passes(&self) -> usize {
        self.passes
    }

    fn add_node(
        &mut self,
        transitions: &Transitions,
        emissions: &[f64],
        lines: usize,
        low: usize,
        high: usize,
    ) {
        self.passes += 1;
        self.ring_pass(transitions, emissions, lines, low, high);
        let states = transitions.states;
        let Some(end) = greatest(&self.scores[low..high]).map(|place| low + place) else {
            return;
        };
        let bound = self.scores[end];
        let mut start = end;
        for line in (1..=lines).rev() {
            start = self.predecessors[(line - 1) * states + start] as usize;
        }
        self.nodes.push(Node {
            low,
            high,
            bound,
            start,
            end,
        });
    }

    /// Once around, from the first states in a range back to the first line.
    fn ring_pass(
        &mut self,
        transitions: &Transitions,
        emissions: &[f64],
        lines: usize,
        low: usize,
        high: usize,
    ) {
        self.tried = [low, high];
        self.forward(transitions, emissions, lines, low, high);
        // Nothing is emitted on the way back to the first line, which was counted already.
        self.advance(transitions, None, lines);
    }

    /// Scores of the best paths to each state of the last line.
    fn forward(
        &mut self,
        transitions: &Transitions,
        emissions: &[f64],
        lines: usize,
        low: usize,
        high: usize,
    ) {
        let states = transitions.states;
        self.predecessors.resize(states * (lines + 1), 0);
        self.next.resize(states, 0.0);
        self.scores.clear();
        self.scores.resize(states, f64::NEG_INFINITY);
        self.scores[low..high].copy_from_slice(&emissions[low..high]);
        for line in 1..lines {
            self.advance(
                transitions,
                Some(&emissions[line * states..(line + 1) * states]),
                line,
            );
        }
    }

    fn advance(&mut self, transitions: &Transitions, emissions: Option<&[f64]>, line: usize) {
        let states = transitions.states;
        let predecessors = &mut self.predecessors[(line - 1) * states..line * states];
        step(&transitions.logs, &self.scores, &mut self.next, predecessors);
        for (next, emission) in self.next.iter_mut().zip(emissions.unwrap_or_default()) {
            *next += emission;
        }
        std::mem::swap(&mut self.scores, &mut self.next);
    }

    /// The path that ends in `end` after `lines` lines, from its first line on.
    fn trace(&self, states: usize, lines: usize, end: usize, path: &mut Vec<usize>) {
        path.clear();
        path.resize(lines, end);
        for line in (1..lines).rev() {
            path[line - 1] = self.predecessors[(line - 1) * states + path[line]] as usize;
        }
    }
}

/// Best score with which each state is reached from those of the line before, and from which; of equal ones the first.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn step(logs: &[[f64; LANES]], scores: &[f64], next: &mut [f64], predecessors: &mut [u32]) {
    let groups = next.len().div_ceil(LANES);
    let reached = next.chunks_mut(LANES).zip(predecessors.chunks_mut(LANES));
    for (group, (next, predecessors)) in reached.enumerate() {
        let (mut best, mut from) = ([f64::NEG_INFINITY; LANES], [0_u64; LANES]);
        let logs = logs.iter().skip(group).step_by(groups);
        for (place, (score, logs)) in (0_u64..).zip(scores.iter().zip(logs)) {
            for i in 0..LANES {
                let value = score + logs[i];
                let better = value > best[i];
                best[i] = if better { value } else { best[i] };
                from[i] = if better { place } else { from[i] };
            }
        }
        for (((next, predecessor), best), from) in next.iter_mut().zip(predecessors).zip(best).zip(from) {
            (*next, *predecessor) = (best, from as u32);
        }
    }
}

fn check(transitions: &Transitions, emissions: &[f64]) -> Result<usize, FilterError> {
    let lines = (emissions.len() / transitions.states).max(1);
    FilterError::check_length("emissions", lines * transitions.states, emissions.len())?;
    Ok(lines)
}

/// The first of the greatest values; none where all are negative infinity or not numbers.
fn greatest(values: &[f64]) -> Option<usize> {
    let mut best = None;
    let mut height = f64::NEG_INFINITY;
    for (place, value) in values.iter().enumerate() {
        if *value > height {
            (best, height) = (Some(place), *value);
        }
    }
    best
}

#[cfg(test)]
#[path = "viterbi_tests.rs"]
mod tests;
