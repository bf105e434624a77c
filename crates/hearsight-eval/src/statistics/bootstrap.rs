//! How sure a mean is: the bootstrap with bias correction and acceleration.

use super::normal::{distribution, quantile};
use super::{Alternative, StatisticsError};
use hearsight_filter::{Generator, generator, uniform};

/// How a bootstrap is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bootstrap {
    /// Resamples drawn, 100 to 1,000,000; default 9999, as scipy.
    pub resamples: usize,
    /// Probability that the interval holds the true value, above 0 and below 1; default 0.95.
    pub level: f64,
    /// Seed of the resamples: the same seed and values give the same interval.
    pub seed: u64,
}

impl Default for Bootstrap {
    fn default() -> Self {
        Self {
            resamples: 9999,
            level: 0.95,
            seed: 0,
        }
    }
}

/// An estimate and the interval that holds the true value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// What the values themselves give.
    pub estimate: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// Whether all of the interval lies on the side of `value` that the alternative names; outside of it for
    /// [`Alternative::TwoSided`].
    pub fn excludes(&self, value: f64, alternative: Alternative) -> bool {
        match alternative {
            Alternative::Greater => self.low > value,
            Alternative::Less => self.high < value,
            Alternative::TwoSided => self.low > value || self.high < value,
        }
    }
}

/// Interval of the mean of `values`, in their unit.
///
/// Bias-corrected and accelerated (Efron 1987, as `scipy.stats.bootstrap` by default), which for the few and skewed
/// values of an experiment keeps its level better than plain percentiles. Values that are all the same, or a single
/// one, give an interval of no length.
///
/// ```
/// use hearsight_eval::statistics::{Bootstrap, bootstrap_mean};
/// let interval = bootstrap_mean(&[0.61, 0.72, 0.58, 0.66, 0.70, 0.64], &Bootstrap::default())?;
/// assert!(interval.low < interval.estimate && interval.estimate < interval.high);
/// # Ok::<(), hearsight_eval::statistics::StatisticsError>(())
/// ```
///
/// # Errors
/// [`StatisticsError::TooFew`] without values, [`StatisticsError::NotFinite`], and [`StatisticsError::OutOfRange`] for
/// the options.
pub fn bootstrap_mean(values: &[f64], options: &Bootstrap) -> Result<Interval, StatisticsError> {
    StatisticsError::check("the mean", values, 1)?;
    interval(values.len(), options, |chosen| {
        chosen.iter().map(|&index| values[index]).sum::<f64>() / chosen.len() as f64
    })
}

/// Interval of mean(`numerators`) / mean(`denominators`), where the two of one run are drawn together.
///
/// # Errors
/// As [`bootstrap_mean`]; [`StatisticsError::NotPaired`] where there are not as many of one as of the other;
/// [`StatisticsError::OutOfRange`] for denominators that are not all of one sign, whose ratio has no interval.
pub fn bootstrap_ratio_of_means(
    numerators: &[f64],
    denominators: &[f64],
    options: &Bootstrap,
) -> Result<Interval, StatisticsError> {
    if numerators.len() != denominators.len() {
        return Err(StatisticsError::NotPaired {
            first: numerators.len(),
            second: denominators.len(),
        });
    }
    StatisticsError::check("the ratio of means", numerators, 1)?;
    StatisticsError::check("the ratio of means", denominators, 1)?;
    let sign = denominators[0].signum();
    if let Some(&found) = denominators.iter().find(|&&value| value * sign <= 0.0) {
        return Err(StatisticsError::OutOfRange {
            what: "a denominator",
            range: "of the same sign as the others and not zero",
            found,
        });
    }
    interval(numerators.len(), options, |chosen| {
        let sum = |values: &[f64]| chosen.iter().map(|&index| values[index]).sum::<f64>();
        sum(numerators) / sum(denominators)
    })
}

/// The interval of a statistic of chosen values. `statistic` gets the indices of the values to use.
fn interval(
    count: usize,
    options: &Bootstrap,
    statistic: impl Fn(&[usize]) -> f64,
) -> Result<Interval, StatisticsError> {
    let Bootstrap {
        resamples,
        level,
        seed,
    } = *options;
    if !(level > 0.0 && level < 1.0) {
        return Err(StatisticsError::OutOfRange {
            what: "the level of an interval",
            range: "above 0 and below 1",
            found: level,
        });
    }
    if !(100..=1_000_000).contains(&resamples) {
        return Err(StatisticsError::OutOfRange {
            what: "the number of resamples",
            range: "100 to 1,000,000",
            found: resamples as f64,
        });
    }
    let mut chosen: Vec<usize> = (0..count).collect();
    let estimate = statistic(&chosen);
    let acceleration = acceleration(count, &statistic);
    let mut random: Generator = generator(seed, "bootstrap", 0);
    let mut drawn: Vec<f64> = (0..resamples)
        .map(|_| {
            for index in &mut chosen {
                *index = ((uniform(&mut random) * count as f64) as usize).min(count - 1);
            }
            statistic(&chosen)
        })
        .collect();
    drawn.sort_by(f64::total_cmp);
    if drawn[0] == drawn[resamples - 1] {
        let (low, high) = (drawn[0].min(estimate), drawn[0].max(estimate));
        return Ok(Interval { estimate, low, high });
    }
    // Half of those that are equal count as below, so that few distinct values do not shift the interval.
    let below = drawn.partition_point(|&value| value < estimate);
    let not_above = drawn.partition_point(|&value| value <= estimate);
    let bias = quantile((below + not_above) as f64 / (2 * resamples) as f64);
    let end = |probability: f64| {
        let shifted = bias + quantile(probability);
        let corrected = distribution(bias + shifted / (1.0 - acceleration * shifted));
        let fallback = if corrected.is_finite() {
            corrected
        } else {
            probability
        };
        at_rank(&drawn, fallback)
    };
    Ok(Interval {
        estimate,
        low: end((1.0 - level) / 2.0),
        high: end((1.0 + level) / 2.0),
    })
}

/// The acceleration by leaving out one value at a time (Efron and Tibshirani 1993, equation 14.15).
fn acceleration(count: usize, statistic: &impl Fn(&[usize]) -> f64) -> f64 {
    if count < 2 {
        return 0.0;
    }
    let mut rest: Vec<usize> = (1..count).collect();
    let left_out: Vec<f64> = (0..count)
        .map(|out| {
            if out > 0 {
                rest[out - 1] = out - 1;
            }
            statistic(&rest)
        })
        .collect();
    let mean = left_out.iter().sum::<f64>() / count as f64;
    let power = |exponent: i32| {
        left_out
            .iter()
            .map(|value| (mean - value).powi(exponent))
            .sum::<f64>()
    };
    let (squares, cubes) = (power(2), power(3));
    if squares > 0.0 {
        cubes / (6.0 * squares.powf(1.5))
    } else {
        0.0
    }
}

/// The quantile of sorted values, linear between them.
fn at_rank(sorted: &[f64], probability: f64) -> f64 {
    let place = probability.clamp(0.0, 1.0) * (sorted.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}
