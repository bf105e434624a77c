//! Whether one system is better than another, by signs and sizes: Wilcoxon's signed-rank test.

use super::normal::distribution;
use super::{Alternative, StatisticsError};

/// Most differences whose distribution is counted out; beyond, it is taken as normal.
const MOST_EXACT: usize = 50;

/// Result of a signed-rank test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedRank {
    /// Sum of the ranks of differences above zero.
    pub above: f64,
    /// Sum of the ranks of differences below zero.
    pub below: f64,
    /// Differences that are not zero; the others are left out.
    pub count: usize,
    /// Whether the distribution was counted out.
    pub exact: bool,
    /// Probability of a result at least as extreme where the differences lie evenly about zero, 0 to 1.
    pub p: f64,
}

/// Wilcoxon's signed-rank test: `differences` are ours less theirs. Those of zero are left out, equal sizes share their
/// mean rank; where nothing is left, p is 1.
///
/// Up to 50 differences the distribution of the sum over all signs is counted out, with equal sizes too: as
/// `scipy.stats.wilcoxon` without equal sizes, and with equal sizes as its permutation test, which scipy itself uses for
/// up to 13. Beyond 50 the sum is taken as normal, corrected for equal sizes, without continuity correction.
///
/// # Errors
/// [`StatisticsError::NotFinite`].
pub fn signed_rank(differences: &[f64], alternative: Alternative) -> Result<SignedRank, StatisticsError> {
    StatisticsError::check("the differences", differences, 0)?;
    let mut sorted: Vec<f64> = differences
        .iter()
        .copied()
        .filter(|value| *value != 0.0)
        .collect();
    sorted.sort_by(|one, other| one.abs().total_cmp(&other.abs()));
    let count = sorted.len();
    // Twice the rank is a whole number, also where ranks are shared.
    let mut doubled_ranks = Vec::with_capacity(count);
    let mut ties = 0.0;
    for group in sorted.chunk_by(|one, other| one.abs() == other.abs()) {
        let first = doubled_ranks.len() + 1;
        let doubled = 2 * first + group.len() - 1;
        doubled_ranks.extend(std::iter::repeat_n(doubled, group.len()));
        let size = group.len() as f64;
        ties += size * size * size - size;
    }
    let doubled_above: usize = sorted
        .iter()
        .zip(&doubled_ranks)
        .filter(|(value, _)| **value > 0.0)
        .map(|(_, rank)| rank)
        .sum();
    let doubled_total = count * (count + 1);
    let doubled_below = doubled_total - doubled_above;
    let exact = count <= MOST_EXACT;
    let (at_most, at_least) = if exact {
        (
            counted(&doubled_ranks, doubled_above),
            counted(&doubled_ranks, doubled_below),
        )
    } else {
        let n = count as f64;
        let variance = n * (n + 1.0) * (2.0 * n + 1.0) / 24.0 - ties / 48.0;
        let z = (doubled_above as f64 - doubled_below as f64) / (4.0 * variance.sqrt());
        (distribution(z), distribution(-z))
    };
    let p = match alternative {
        Alternative::Greater => at_least,
        Alternative::Less => at_most,
        Alternative::TwoSided => (2.0 * at_most.min(at_least)).min(1.0),
    };
    Ok(SignedRank {
        above: doubled_above as f64 / 2.0,
        below: doubled_below as f64 / 2.0,
        count,
        exact,
        p,
    })
}

/// Probability that ranks with random signs sum to at most `most` on one side; by symmetry also to at least the rest.
fn counted(doubled_ranks: &[usize], most: usize) -> f64 {
    let total: usize = doubled_ranks.iter().sum();
    let mut probability = vec![0.0_f64; total + 1];
    probability[0] = 1.0;
    let mut reached = 0;
    for &rank in doubled_ranks {
        reached += rank;
        for sum in (0..=reached).rev() {
            let with = if sum >= rank { probability[sum - rank] } else { 0.0 };
            probability[sum] = 0.5 * (probability[sum] + with);
        }
    }
    probability[..=most].iter().sum::<f64>().min(1.0)
}
