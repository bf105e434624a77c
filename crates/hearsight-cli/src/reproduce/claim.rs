//! From numbers to verdicts: what a paper claims, what was measured, and whether it holds.
//!
//! A claim of an order is tested over pairs of the same seed and holds where a one-sided sign test gives p below 0.01;
//! a claim of a size holds where the measured value lies in the range that was written down beforehand. Intervals are
//! of 95 %, by bootstrap over seeds.

use hearsight::eval::statistics::{
    Alternative, Bootstrap, Interval, bootstrap_mean, bootstrap_ratio_of_means, sign_test,
};
use serde::Serialize;

/// An order holds below this probability of seeing it by chance.
const SIGNIFICANT: f64 = 0.01;

/// One claim and its verdict.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Claim {
    /// Short name, unique in the experiment.
    pub(crate) id: &'static str,
    /// What is claimed, in a sentence.
    pub(crate) statement: String,
    /// The paper's value, where it has one.
    pub(crate) paper: Option<f64>,
    /// The value measured; none where it could not be measured.
    pub(crate) ours: Option<f64>,
    /// Interval of 95 % around it.
    pub(crate) interval: Option<[f64; 2]>,
    /// Probability of such an order by chance, of a claim of an order.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) p: Option<f64>,
    /// Seeds that it was measured with.
    pub(crate) seeds: usize,
    /// Whether it holds.
    pub(crate) holds: bool,
    /// Where it does not hold: why, as far as it has been found out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) cause: Option<&'static str>,
}

/// Why claims do not hold, as far as it has been found out: names of claims, and the cause that they share.
pub(crate) type Causes = [(&'static [&'static str], &'static str)];

/// Says of the claims that do not hold why.
pub(crate) fn explain(claims: &mut [Claim], causes: &Causes) {
    for claim in claims.iter_mut().filter(|claim| !claim.holds) {
        let known = causes.iter().find(|(names, _)| names.contains(&claim.id));
        claim.cause = known.map(|(_, cause)| *cause);
    }
}

/// What an experiment came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Report {
    /// Tables for people.
    pub(crate) tables: Vec<Table>,
    /// The claims.
    pub(crate) claims: Vec<Claim>,
}

/// A table for people: the paper's beside ours.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Table {
    /// What it shows, with the unit.
    pub(crate) title: String,
    /// The head of each column.
    pub(crate) columns: Vec<String>,
    /// The rows, as wide as the head.
    pub(crate) rows: Vec<Vec<String>>,
}

impl Claim {
    /// A claim of a size, which holds where the measured value lies within `range`.
    fn of_size(statement: Statement, measured: Option<Interval>, seeds: usize, range: [f64; 2]) -> Self {
        Self {
            id: statement.id,
            statement: statement.text,
            paper: statement.paper,
            ours: measured.map(|measured| measured.estimate),
            interval: measured.map(|measured| [measured.low, measured.high]),
            p: None,
            seeds,
            holds: measured.is_some_and(|measured| (range[0]..=range[1]).contains(&measured.estimate)),
            cause: None,
        }
    }
}

/// What is claimed, before it is measured.
#[derive(Clone, Debug)]
pub(crate) struct Statement {
    /// Short name, unique in the experiment.
    pub(crate) id: &'static str,
    /// A sentence.
    pub(crate) text: String,
    /// The paper's value, where it has one.
    pub(crate) paper: Option<f64>,
}

/// The first is smaller than the second in each pair; the value is the reduction of the mean, as a share of the second.
pub(crate) fn smaller(statement: Statement, pairs: &[[f64; 2]]) -> Claim {
    let differences: Vec<f64> = pairs.iter().map(|[less, more]| less - more).collect();
    let p = sign_test(&differences, Alternative::Less).map_or(1.0, |test| test.p);
    Claim {
        p: Some(p),
        holds: p < SIGNIFICANT,
        ..reduction(statement, pairs, [f64::NEG_INFINITY, f64::INFINITY])
    }
}

/// The mean of the first is smaller than that of the second by a share, 0 to 1, within `range`.
pub(crate) fn reduction(statement: Statement, pairs: &[[f64; 2]], range: [f64; 2]) -> Claim {
    let reduced = ratio(pairs).map(|ratio| Interval {
        estimate: 1.0 - ratio.estimate,
        low: 1.0 - ratio.high,
        high: 1.0 - ratio.low,
    });
    Claim::of_size(statement, reduced, pairs.len(), range)
}

/// The ratio of the means, first over second, lies within `range`.
pub(crate) fn ratio_within(statement: Statement, pairs: &[[f64; 2]], range: [f64; 2]) -> Claim {
    Claim::of_size(statement, ratio(pairs), pairs.len(), range)
}

/// The mean lies within `range`.
pub(crate) fn mean_within(statement: Statement, values: &[f64], range: [f64; 2]) -> Claim {
    Claim::of_size(statement, mean(values), values.len(), range)
}

/// A mean with its interval as text, "4.47 (4.10 to 4.83)".
pub(crate) fn cell(values: &[f64], digits: usize) -> String {
    match mean(values) {
        Some(mean) => format!(
            "{:.digits$} ({:.digits$} to {:.digits$})",
            mean.estimate, mean.low, mean.high
        ),
        None => "-".to_owned(),
    }
}

fn mean(values: &[f64]) -> Option<Interval> {
    bootstrap_mean(values, &Bootstrap::default()).ok()
}

fn ratio(pairs: &[[f64; 2]]) -> Option<Interval> {
    let (first, second): (Vec<f64>, Vec<f64>) = pairs.iter().map(|pair| (pair[0], pair[1])).unzip();
    bootstrap_ratio_of_means(&first, &second, &Bootstrap::default()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn statement() -> Statement {
        Statement {
            id: "test",
            text: "it holds".into(),
            paper: Some(0.5),
        }
    }

    #[test]
    fn seven_of_seven_are_enough_and_six_of_seven_are_not() {
        let mut pairs = vec![[1.0, 2.0]; 7];
        let claim = smaller(statement(), &pairs);
        assert!(claim.holds && claim.p == Some(1.0 / 128.0), "{claim:?}");
        assert_eq!((claim.ours, claim.seeds), (Some(0.5), 7));
        pairs[0] = [3.0, 2.0];
        assert!(!smaller(statement(), &pairs).holds);
    }

    #[test]
    fn a_size_holds_within_its_range_only() {
        let pairs = [[1.0, 4.0], [1.2, 4.0], [0.8, 4.0]];
        assert!(reduction(statement(), &pairs, [0.7, 0.8]).holds);
        assert!(!reduction(statement(), &pairs, [0.1, 0.3]).holds);
        let claim = ratio_within(statement(), &pairs, [0.0, 0.3]);
        let [low, high] = claim.interval.unwrap();
        assert!(claim.holds && low < 0.25 && 0.25 < high, "{claim:?}");
        assert!(mean_within(statement(), &[1.0, 3.0], [2.0, 2.0]).holds);
    }

    #[test]
    fn only_what_does_not_hold_has_a_cause() {
        let causes: &Causes = &[(&["test"], "the scene")];
        let mut claims = [
            mean_within(statement(), &[1.0, 3.0], [2.0, 2.0]),
            mean_within(statement(), &[1.0, 3.0], [3.0, 4.0]),
        ];
        explain(&mut claims, causes);
        assert_eq!(claims.map(|claim| claim.cause), [None, Some("the scene")]);
    }

    #[test]
    fn what_was_not_measured_does_not_hold() {
        for claim in [
            smaller(statement(), &[]),
            reduction(statement(), &[], [0.0, 1.0]),
            mean_within(statement(), &[], [f64::NEG_INFINITY, f64::INFINITY]),
        ] {
            assert!(!claim.holds && claim.ours.is_none(), "{claim:?}");
        }
        assert_eq!(cell(&[], 2), "-");
    }
}
