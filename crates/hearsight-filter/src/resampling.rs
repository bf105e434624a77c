//! Drawing ancestors in proportion to weights.
//!
//! All schemes are unbiased: particle `i` gets `count * weight[i]` offspring on average. They differ in how much the
//! number of offspring varies. All give ancestors in rising order, so that gathering walks memory forwards, and none
//! allocates.

use crate::elementary;
use crate::error::FilterError;
use crate::random::uniform;
use rand::Rng;
use serde::{Deserialize, Serialize};

/// How ancestors are drawn (Douc, Cappé and Moulines 2005 compare the four).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Resampling {
    /// One uniform number for a comb of equal spacing (Carpenter, Clifford and Fearnhead 1999).
    #[default]
    Systematic,
    /// One uniform number for each of as many equal intervals as draws (Kitagawa 1996).
    Stratified,
    /// The whole part of the expected offspring for certain, the rest multinomial (Liu and Chen 1998).
    Residual,
    /// Independent draws (Gordon, Salmond and Smith 1993).
    Multinomial,
}

impl Resampling {
    /// Every scheme, in the order of their documentation.
    pub const ALL: [Self; 4] = [
        Self::Systematic,
        Self::Stratified,
        Self::Residual,
        Self::Multinomial,
    ];

    /// The name in configuration files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Systematic => "systematic",
            Self::Stratified => "stratified",
            Self::Residual => "residual",
            Self::Multinomial => "multinomial",
        }
    }

    /// One sentence on what the scheme does and when to take it.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Systematic => {
                "one random number places an even comb over the weights: fastest, offspring within one of the \
                 expected number; take it unless a paper asks for another"
            }
            Self::Stratified => {
                "one random number for each draw, in its own even interval: offspring within two of the expected \
                 number, variance never above the multinomial scheme's"
            }
            Self::Residual => {
                "the whole part of the expected offspring for certain, the rest by independent draws: never below \
                 the whole part, variance never above the multinomial scheme's"
            }
            Self::Multinomial => {
                "independent draws: the plain bootstrap filter, with the most variance; for comparisons"
            }
        }
    }

    /// Where the scheme was published.
    pub const fn source(self) -> &'static str {
        match self {
            Self::Systematic => "Carpenter, Clifford and Fearnhead 1999, IEE Proceedings F 146(1)",
            Self::Stratified => "Kitagawa 1996, Journal of Computational and Graphical Statistics 5(1)",
            Self::Residual => "Liu and Chen 1998, Journal of the American Statistical Association 93(443)",
            Self::Multinomial => "Gordon, Salmond and Smith 1993, IEE Proceedings F 140(2)",
        }
    }

    /// Fills `ancestors` with indices into `weights`, each drawn in proportion to its weight, in rising order.
    ///
    /// The two lengths may differ. Weights must be finite and not negative; they need not sum to one. A particle of
    /// weight zero is never drawn.
    ///
    /// # Errors
    /// [`FilterError::NoWeight`] if no weight is positive, [`FilterError::NotFinite`] if the weights have no finite
    /// sum, [`FilterError::SizeMismatch`] for more than 2^32 - 1 weights; `ancestors` is then unchanged.
    pub fn draw(
        self,
        weights: &[f64],
        generator: &mut impl Rng,
        ancestors: &mut [u32],
    ) -> Result<(), FilterError> {
        if weights.len() > u32::MAX as usize {
            return Err(FilterError::SizeMismatch {
                what: "weights",
                expected: u32::MAX as usize,
                found: weights.len(),
            });
        }
        let total = elementary::sum_of(weights, |weight| weight);
        if !total.is_finite() {
            return Err(FilterError::NotFinite {
                what: "the sum of the weights",
            });
        }
        let Some(last) = weights
            .iter()
            .rposition(|weight| *weight > 0.0)
            .filter(|_| total > 0.0)
        else {
            return Err(FilterError::NoWeight);
        };
        // Particles after the last one of positive weight are left out, so that rounding cannot draw them.
        let weights = &weights[..=last];
        let scale = ancestors.len() as f64 / total;
        match self {
            Self::Systematic => systematic(weights, scale, uniform(generator), ancestors),
            Self::Stratified => stratified(weights, scale, generator, ancestors),
            Self::Residual => residual(weights, scale, generator, ancestors),
            Self::Multinomial => multinomial(weights, total, generator, ancestors),
        }
        Ok(())
    }
}

/// Tooth `k` of the comb lies at `k + offset`; particle `i` owns `[c(i-1), c(i))` of the scaled cumulative weights.
fn systematic(weights: &[f64], scale: f64, offset: f64, ancestors: &mut [u32]) {
    // Every particle writes its index where its run begins; an empty run is overwritten by the next particle, which
    // begins at the same place. A running maximum then fills the runs. No branch depends on the weights.
    ancestors.fill(0);
    // Rounding to the nearest after adding a half is rounding up, except exactly at a boundary, which has no weight.
    let mut cumulative = 0.5 - offset;
    let mut begin = 0;
    for (index, weight) in weights.iter().enumerate() {
        if let Some(slot) = ancestors.get_mut(begin) {
            *slot = index as u32;
        }
        cumulative += weight * scale;
        begin = elementary::nearest(cumulative) as usize;
    }
    let mut greatest = 0;
    for ancestor in ancestors {
        greatest = greatest.max(*ancestor);
        *ancestor = greatest;
    }
}

fn stratified(weights: &[f64], scale: f64, generator: &mut impl Rng, ancestors: &mut [u32]) {
    let last = weights.len() - 1;
    let mut index = 0;
    let mut cumulative = weights[0] * scale;
    for (draw, ancestor) in ancestors.iter_mut().enumerate() {
        let position = draw as f64 + uniform(generator);
        while position >= cumulative && index < last {
            index += 1;
            cumulative += weights[index] * scale;
        }
        *ancestor = index as u32;
    }
}

fn residual(weights: &[f64], scale: f64, generator: &mut impl Rng, ancestors: &mut [u32]) {
    // An expected number that rounding left just below a whole one counts as whole: equal weights, for which the
    // scheme is meant to draw nothing, would otherwise be drawn altogether. The bias is below 1e-9 offspring.
    let whole = |weight: &f64| (weight * scale + 1e-9) as usize;
    let rest = |weight: &f64| (weight * scale - whole(weight) as f64).max(0.0);
    let certain: usize = weights.iter().map(whole).sum();
    let remaining = ancestors.len().saturating_sub(certain);
    let total_rest: f64 = weights.iter().map(rest).sum();
    let mut draws = DescendingUniforms::new(remaining, generator);
    let mut cumulative = total_rest;
    let mut free = ancestors.len();
    for (index, weight) in weights.iter().enumerate().rev() {
        let mut offspring = whole(weight);
        cumulative -= rest(weight);
        while draws.left > 0 && rest(weight) > 0.0 && draws.current * total_rest >= cumulative {
            offspring += 1;
            draws.advance(generator);
        }
        let begin = free.saturating_sub(offspring);
        ancestors[begin..free].fill(index as u32);
        free = begin;
    }
    // Only rounding leads here: whoever is first among the drawn takes the slots that are left.
    let first = ancestors.get(free).copied().unwrap_or((weights.len() - 1) as u32);
    ancestors[..free].fill(first);
}

fn multinomial(weights: &[f64], total: f64, generator: &mut impl Rng, ancestors: &mut [u32]) {
    let mut draws = DescendingUniforms::new(ancestors.len(), generator);
    let mut index = weights.len() - 1;
    let mut cumulative = total - weights[index];
    for ancestor in ancestors.iter_mut().rev() {
        while draws.current * total < cumulative && index > 0 {
            index -= 1;
            cumulative -= weights[index];
        }
        // Rounding may leave the walk on a particle of weight zero: take the next one up that has weight.
        let chosen = weights[index..]
            .iter()
            .position(|weight| *weight > 0.0)
            .map_or(index, |up| index + up);
        *ancestor = chosen as u32;
        draws.advance(generator);
    }
}

/// Uniform numbers sorted from the greatest to the least without a buffer (Bentley and Saxe 1980).
struct DescendingUniforms {
    left: usize,
    current: f64,
}

impl DescendingUniforms {
    fn new(count: usize, generator: &mut impl Rng) -> Self {
        let mut draws = Self {
            left: count + 1,
            current: 1.0,
        };
        draws.advance(generator);
        draws
    }

    /// Steps to the next smaller number.
    fn advance(&mut self, generator: &mut impl Rng) {
        self.left = self.left.saturating_sub(1);
        if self.left > 0 {
            // The greatest of n uniform numbers is distributed as the n-th root of one.
            let root = elementary::ln(1.0 - uniform(generator)) / self.left as f64;
            self.current *= elementary::exp(root);
        }
    }
}

#[cfg(test)]
#[path = "resampling_tests.rs"]
mod tests;
