//! Instants and spans in whole nanoseconds on the common clock.
//!
//! Nanoseconds as integers add and subtract exactly, so aligning sensors never accumulates rounding. An instant
//! and a span are different types: adding two instants does not compile.

use serde::{Deserialize, Serialize};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

const NANOSECONDS_PER_SECOND: f64 = 1e9;

/// A point in time: nanoseconds since the zero of the common clock (negative before it).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Instant(i64);

/// A signed difference of two instants, in nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Span(i64);

impl Instant {
    /// The zero of the common clock.
    pub const ZERO: Self = Self(0);
    /// Later than any instant that occurs.
    pub const FAR_FUTURE: Self = Self(i64::MAX / 4);

    /// An instant from whole nanoseconds.
    pub const fn from_nanoseconds(nanoseconds: i64) -> Self {
        Self(nanoseconds)
    }

    /// An instant from seconds, rounded to the nearest nanosecond; non-finite input gives zero.
    pub fn from_seconds(seconds: f64) -> Self {
        Self((seconds * NANOSECONDS_PER_SECOND).round() as i64)
    }

    /// Nanoseconds since the zero of the clock.
    pub const fn nanoseconds(self) -> i64 {
        self.0
    }

    /// Seconds since the zero of the clock.
    pub fn seconds(self) -> f64 {
        self.0 as f64 / NANOSECONDS_PER_SECOND
    }
}

impl Span {
    /// No time at all.
    pub const ZERO: Self = Self(0);

    /// A span from whole nanoseconds.
    pub const fn from_nanoseconds(nanoseconds: i64) -> Self {
        Self(nanoseconds)
    }

    /// A span from seconds, rounded to the nearest nanosecond; non-finite input gives zero.
    pub fn from_seconds(seconds: f64) -> Self {
        Self((seconds * NANOSECONDS_PER_SECOND).round() as i64)
    }

    /// The span of `count` samples at `rate_hz`, rounded to the nearest nanosecond without overflow for hours of
    /// sound. A rate of zero gives [`Span::ZERO`].
    pub fn of_samples(count: i64, rate_hz: u32) -> Self {
        if rate_hz == 0 {
            return Self::ZERO;
        }
        let rate = i128::from(rate_hz);
        let scaled = i128::from(count) * 1_000_000_000;
        Self((scaled + rate / 2).div_euclid(rate) as i64)
    }

    /// Nanoseconds, negative for a span backwards.
    pub const fn nanoseconds(self) -> i64 {
        self.0
    }

    /// Seconds.
    pub fn seconds(self) -> f64 {
        self.0 as f64 / NANOSECONDS_PER_SECOND
    }

    /// The nearest whole number of samples at `rate_hz`.
    pub fn samples(self, rate_hz: u32) -> i64 {
        let scaled = i128::from(self.0) * i128::from(rate_hz);
        (scaled + 500_000_000).div_euclid(1_000_000_000) as i64
    }

    /// The span without its sign; the longest span for the longest one backwards, which is a nanosecond longer.
    pub const fn magnitude(self) -> Self {
        Self(self.0.saturating_abs())
    }
}

impl Add<Span> for Instant {
    type Output = Self;
    fn add(self, span: Span) -> Self {
        Self(self.0.saturating_add(span.0))
    }
}

impl AddAssign<Span> for Instant {
    fn add_assign(&mut self, span: Span) {
        *self = *self + span;
    }
}

impl Sub<Span> for Instant {
    type Output = Self;
    fn sub(self, span: Span) -> Self {
        Self(self.0.saturating_sub(span.0))
    }
}

impl SubAssign<Span> for Instant {
    fn sub_assign(&mut self, span: Span) {
        *self = *self - span;
    }
}

impl Sub for Instant {
    type Output = Span;
    fn sub(self, other: Self) -> Span {
        Span(self.0.saturating_sub(other.0))
    }
}

impl Add for Span {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

impl Sub for Span {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

impl Neg for Span {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.saturating_neg())
    }
}

impl Mul<i64> for Span {
    type Output = Self;
    fn mul(self, factor: i64) -> Self {
        Self(self.0.saturating_mul(factor))
    }
}

impl Div<i64> for Span {
    type Output = Self;
    fn div(self, divisor: i64) -> Self {
        Self(self.0 / divisor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_and_spans_agree_over_hours() {
        for rate in [8_000, 16_000, 44_100, 48_000] {
            for count in [0, 1, 44_100, 1 << 40] {
                assert_eq!(Span::of_samples(count, rate).samples(rate), count);
            }
        }
        assert_eq!(Span::of_samples(1, 0), Span::ZERO);
    }

    #[test]
    fn seconds_round_to_the_nearest_nanosecond() {
        assert_eq!(Instant::from_seconds(13.12).nanoseconds(), 13_120_000_000);
        assert_eq!(Instant::from_seconds(f64::NAN), Instant::ZERO);
        assert_eq!(
            Instant::from_seconds(1.5) - Instant::from_seconds(2.0),
            Span::from_seconds(-0.5)
        );
    }
}
