use super::*;
use crate::random::{generator, uniform};
use proptest::prelude::*;

/// The log-likelihood of a path.
fn score(transitions: &Transitions, emissions: &[f64], path: &[usize], closed: bool) -> f64 {
    let states = transitions.states();
    let emitted: f64 = path
        .iter()
        .enumerate()
        .map(|(line, state)| emissions[line * states + state])
        .sum();
    let moved: f64 = path
        .windows(2)
        .map(|pair| transitions.log(pair[0], pair[1]))
        .sum();
    let back = if closed {
        transitions.log(path[path.len() - 1], path[0])
    } else {
        0.0
    };
    emitted + moved + back
}

/// The greatest log-likelihood of all paths.
fn brute_force(transitions: &Transitions, emissions: &[f64], closed: bool) -> f64 {
    let states = transitions.states();
    let lines = emissions.len() / states;
    let mut best = f64::NEG_INFINITY;
    for number in 0..states.pow(lines as u32) {
        let path: Vec<usize> = (0..lines)
            .map(|line| number / states.pow(line as u32) % states)
            .collect();
        best = best.max(score(transitions, emissions, &path, closed));
    }
    best
}

proptest! {
    #[test]
    fn agrees_with_every_path_tried(
        (states, lines, seed) in (1..5_usize, 1..7_usize, 0..1000_u64), spread in 0.1..8.0_f64,
    ) {
        let mut random = generator(seed, "test", 0);
        let probabilities: Vec<f64> = (0..states * states).map(|_| 1e-3 + uniform(&mut random)).collect();
        let general = Transitions::new(states, &probabilities).unwrap();
        let smooth = Transitions::smooth(states, 0.7).unwrap();
        let emissions: Vec<f64> = (0..states * lines).map(|_| -spread * uniform(&mut random)).collect();
        let (mut viterbi, mut path) = (Viterbi::default(), Vec::new());
        for transitions in [general, smooth] {
            for closed in [false, true] {
                let found = if closed {
                    viterbi.closed(&transitions, &emissions, &mut path).unwrap()
                } else {
                    viterbi.open(&transitions, &emissions, &mut path).unwrap()
                };
                prop_assert_eq!(path.len(), lines);
                prop_assert!((found - brute_force(&transitions, &emissions, closed)).abs() < 1e-9);
                prop_assert!((found - score(&transitions, &emissions, &path, closed)).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn rows_are_normalized_each_by_itself() {
    let transitions = Transitions::smooth(7, 2.0).unwrap();
    for from in 0..7 {
        let sum: f64 = (0..7).map(|to| transitions.log(from, to).exp()).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }
    // A state at the end has fewer neighbours: staying there is likelier than in the middle.
    assert!(transitions.log(0, 0) > transitions.log(3, 3));
}

#[test]
fn the_ring_closes_where_the_open_chain_leaves_a_step() {
    // The first line prefers another edge than all others do, by less than the two steps that this takes.
    let (states, lines) = (21, 32);
    let transitions = Transitions::smooth(states, 2.0).unwrap();
    let mut emissions = vec![0.0; states * lines];
    for line in 0..lines {
        emissions[line * states + 10] = 3.0;
    }
    emissions[4] = 30.0;
    let (mut viterbi, mut path) = (Viterbi::default(), Vec::new());
    viterbi.open(&transitions, &emissions, &mut path).unwrap();
    assert_eq!(
        (path[0], path[31]),
        (4, 10),
        "an open chain jumps from the last line to the first"
    );
    viterbi.closed(&transitions, &emissions, &mut path).unwrap();
    assert_eq!((path[0], path[16]), (4, 10));
    assert!(path[31] < 10, "the last line bends towards the first: {path:?}");
    assert!(viterbi.passes() < 21, "{} passes", viterbi.passes());
}

#[test]
fn mistakes_are_errors() {
    assert!(Transitions::smooth(0, 1.0).is_err());
    assert!(Transitions::smooth(3, 0.0).is_err());
    assert!(Transitions::new(2, &[1.0, 0.0, 0.0, 0.0]).is_err());
    assert!(Transitions::new(2, &[1.0, 0.0, 0.0]).is_err());
    let transitions = Transitions::smooth(3, 1.0).unwrap();
    let (mut viterbi, mut path) = (Viterbi::default(), Vec::new());
    assert!(viterbi.closed(&transitions, &[0.0; 4], &mut path).is_err());
    assert!(viterbi.closed(&transitions, &[], &mut path).is_err());
    for bad in [f64::NAN, f64::NEG_INFINITY] {
        assert_eq!(
            viterbi.closed(&transitions, &[bad; 6], &mut path),
            Err(FilterError::NoWeight)
        );
        assert_eq!(
            viterbi.open(&transitions, &[bad; 6], &mut path),
            Err(FilterError::NoWeight)
        );
    }
}
