use super::*;
use crate::random::{generator, uniform};
use proptest::prelude::*;

/// The best (unpaired rows, cost) over all pairings, with `alone` added for each unpaired row.
fn brute_force(
    costs: &[f64],
    rows: usize,
    columns: usize,
    gate: f64,
    alone: f64,
    row: usize,
    used: u32,
) -> (usize, f64) {
    if row == rows {
        return (0, 0.0);
    }
    let better = |a: (usize, f64), b: (usize, f64)| {
        if alone.is_nan() {
            if b < a { b } else { a }
        } else if b.1 < a.1 {
            b
        } else {
            a
        }
    };
    let rest = brute_force(costs, rows, columns, gate, alone, row + 1, used);
    let mut best = (rest.0 + 1, rest.1 + if alone.is_nan() { 0.0 } else { alone });
    for column in 0..columns {
        let cost = costs[row * columns + column];
        if used & (1 << column) == 0 && cost <= gate && cost < f64::INFINITY {
            let rest = brute_force(costs, rows, columns, gate, alone, row + 1, used | (1 << column));
            best = better(best, (rest.0, rest.1 + cost));
        }
    }
    best
}

fn check_valid(assignment: &Assignment, costs: &[f64], columns: usize, gate: f64) {
    for (row, column) in assignment.pairs() {
        assert_eq!(assignment.row_of_column[column], Some(row));
        assert!(costs[row * columns + column] <= gate);
    }
    let paired = assignment.row_of_column.iter().flatten().count();
    assert_eq!(paired, assignment.pairs().count());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn agrees_with_brute_force(
        rows in 0..6_usize, columns in 0..6_usize, seed: u64, gate in prop_oneof![Just(f64::INFINITY), -0.5..1.2_f64],
        whole: bool, alone in -0.5..1.5_f64,
    ) {
        let mut random = generator(seed, "test", 0);
        let costs: Vec<f64> = (0..rows * columns)
            .map(|_| {
                let cost = 2.0 * uniform(&mut random) - 0.7;
                // Whole costs make many ties.
                let cost = if whole { (cost * 3.0).round() } else { cost };
                if uniform(&mut random) < 0.2 { [f64::NAN, f64::INFINITY][usize::from(whole)] } else { cost }
            })
            .collect();
        let assignment = assign(&costs, rows, columns, gate, Unpaired::AsFewAsPossible).unwrap();
        check_valid(&assignment, &costs, columns, gate);
        let (unpaired, cost) = brute_force(&costs, rows, columns, gate, f64::NAN, 0, 0);
        prop_assert_eq!(rows - assignment.pairs().count(), unpaired);
        prop_assert!((assignment.cost - cost).abs() < 1e-12, "{} {}", assignment.cost, cost);

        let assignment = assign(&costs, rows, columns, gate, Unpaired::Costs(alone)).unwrap();
        check_valid(&assignment, &costs, columns, gate);
        let (_, cost) = brute_force(&costs, rows, columns, gate, alone, 0, 0);
        let total = assignment.cost + alone * (rows - assignment.pairs().count()) as f64;
        prop_assert!((total - cost).abs() < 1e-12, "{} {}", total, cost);
    }

    #[test]
    fn large_problems_do_not_depend_on_orientation(rows in 1..40_usize, columns in 1..40_usize, seed: u64, gate in 0.02..1.0_f64) {
        let mut random = generator(seed, "test", 0);
        let costs: Vec<f64> = (0..rows * columns).map(|_| uniform(&mut random)).collect();
        let transposed: Vec<f64> = (0..rows * columns).map(|index| costs[(index % rows) * columns + index / rows]).collect();
        let direct = assign(&costs, rows, columns, gate, Unpaired::AsFewAsPossible).unwrap();
        let turned = assign(&transposed, columns, rows, gate, Unpaired::AsFewAsPossible).unwrap();
        prop_assert_eq!(direct.pairs().count(), turned.pairs().count());
        prop_assert!((direct.cost - turned.cost).abs() < 1e-10);
    }
}

#[test]
fn a_far_pair_is_worse_than_none_if_being_alone_is_cheap() {
    let costs = [1.0, 8.0, 0.9, 7.0];
    let many = assign(&costs, 2, 2, 10.0, Unpaired::AsFewAsPossible).unwrap();
    assert_eq!(many.column_of_row, [Some(0), Some(1)]);
    let near = assign(&costs, 2, 2, 10.0, Unpaired::Costs(3.0)).unwrap();
    assert_eq!(near.column_of_row, [None, Some(0)]);
    assert_eq!(near.row_of_column, [Some(1), None]);
    assert_eq!(near.cost, 0.9);
}

#[test]
fn digits_survive_beside_forbidden_pairs() {
    // One large cost in place of forbidden pairs would drown these differences.
    let none = f64::INFINITY;
    let costs = [1e-9, 2e-9, none, 3e-9, 1e-9, none, none, none, none];
    let assignment = assign(&costs, 3, 3, none, Unpaired::AsFewAsPossible).unwrap();
    assert_eq!(assignment.column_of_row, [Some(0), Some(1), None]);
}

#[test]
fn mistakes_are_errors() {
    let assign = |costs: &[f64], gate, unpaired| assign(costs, 1, 2, gate, unpaired);
    assert!(assign(&[1.0], 1.0, Unpaired::AsFewAsPossible).is_err());
    assert!(assign(&[1.0, 2.0], f64::NAN, Unpaired::AsFewAsPossible).is_err());
    assert!(assign(&[1.0, f64::NEG_INFINITY], 1.0, Unpaired::AsFewAsPossible).is_err());
    assert!(assign(&[1.0, 2.0], 1.0, Unpaired::Costs(f64::NAN)).is_err());
}
