//! A correlation over delays: values at any delay, peaks between the samples, normalization.

use serde::{Deserialize, Serialize};

/// A correlation at evenly spaced delays, symmetric about 0. The delay is t_i - t_j in seconds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CorrelationCurve {
    /// Seconds from one value to the next.
    pub step_s: f64,
    /// An odd number of values; the middle one is at delay 0.
    pub values: Vec<f32>,
}

/// A local maximum of a curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// Where, in seconds, between the samples of the curve.
    pub delay_s: f64,
    /// How high.
    pub value: f32,
    /// Second derivative there, a second squared, negative: the sharper the more negative. `-value / curvature` is a
    /// variance in square seconds if the peak is taken for a Gaussian.
    pub curvature: f64,
}

impl CorrelationCurve {
    /// Makes it `half` values on each side of 0, all zero, keeping the memory.
    pub fn reset(&mut self, step_s: f64, half: usize) {
        self.step_s = step_s;
        self.values.clear();
        self.values.resize(2 * half + 1, 0.0);
    }

    /// The delay of a value.
    pub fn delay_s(&self, index: usize) -> f64 {
        (index as f64 - (self.values.len() / 2) as f64) * self.step_s
    }

    /// The correlation at any delay, by cubic interpolation through four values; beyond the ends that at the end, and
    /// 0 from an empty curve or for a delay that is not a number.
    ///
    /// Delays a little beyond what the spacing of the microphones allows occur at endfire by rounding, hence no error.
    pub fn at(&self, delay_s: f64) -> f32 {
        let Some((index, part)) = self.place(delay_s) else {
            return 0.0;
        };
        let value = |offset: isize| {
            let last = self.values.len() as isize - 1;
            f64::from(self.values[(index as isize + offset).clamp(0, last) as usize])
        };
        let (a, b, c, d) = (value(-1), value(0), value(1), value(2));
        // Catmull and Rom's spline: through the values, with continuous slope.
        let slopes =
            0.5 * (c - a) + part * (a - 2.5 * b + 2.0 * c - 0.5 * d + part * (1.5 * (b - c) + 0.5 * (d - a)));
        (b + part * slopes) as f32
    }

    /// As [`Self::at`], by linear interpolation: a little faster, with kinks.
    pub fn at_linear(&self, delay_s: f64) -> f32 {
        let Some((index, part)) = self.place(delay_s) else {
            return 0.0;
        };
        let value = f64::from(self.values[index]);
        let next = self.values.get(index + 1).map_or(value, |&next| f64::from(next));
        (value + part * (next - value)) as f32
    }

    fn place(&self, delay_s: f64) -> Option<(usize, f64)> {
        let last = self.values.len().checked_sub(1)?;
        let place = (delay_s / self.step_s + (self.values.len() / 2) as f64).clamp(0.0, last as f64);
        if place.is_nan() {
            return None;
        }
        Some((place as usize, place.fract()))
    }

    /// The highest value, wherever it is; 0 for an empty curve.
    pub fn maximum(&self) -> f32 {
        self.values.iter().copied().reduce(f32::max).unwrap_or(0.0)
    }

    /// The highest local maximum, or none on a curve that has none inside its ends.
    pub fn peak(&self) -> Option<Peak> {
        self.highest(|_| true)
    }

    /// The `count` highest local maxima at least `separation_s` apart, highest first, into a reused vector.
    pub fn peaks(&self, count: usize, separation_s: f64, peaks: &mut Vec<Peak>) {
        peaks.clear();
        while peaks.len() < count {
            let apart = |index: usize| {
                let delay_s = self.delay_s(index);
                peaks
                    .iter()
                    .all(|peak| (peak.delay_s - delay_s).abs() >= separation_s.max(self.step_s))
            };
            let Some(peak) = self.highest(apart) else { return };
            peaks.push(peak);
        }
    }

    fn highest(&self, accepts: impl Fn(usize) -> bool) -> Option<Peak> {
        let mut best: Option<(usize, f32)> = None;
        for index in self.maxima() {
            let value = self.values[index];
            if best.is_none_or(|(_, highest)| value > highest) && accepts(index) {
                best = Some((index, value));
            }
        }
        best.map(|(index, _)| self.refine(index))
    }

    /// Indices of the local maxima, in order; the ends are none.
    pub(crate) fn maxima(&self) -> impl Iterator<Item = usize> + '_ {
        let rises = |triple: &[f32]| triple[1] > triple[0] && triple[1] >= triple[2];
        self.values
            .windows(3)
            .enumerate()
            .filter(move |(_, triple)| rises(triple))
            .map(|(index, _)| index + 1)
    }

    /// The top of the parabola through a local maximum and its neighbours.
    pub(crate) fn refine(&self, index: usize) -> Peak {
        let [before, top, after] = [index - 1, index, index + 1].map(|k| f64::from(self.values[k]));
        let bend = before - 2.0 * top + after;
        let shift = if bend < 0.0 {
            (0.5 * (before - after) / bend).clamp(-0.5, 0.5)
        } else {
            0.0
        };
        Peak {
            delay_s: self.delay_s(index) + shift * self.step_s,
            value: (top - 0.25 * (before - after) * shift) as f32,
            curvature: bend / (self.step_s * self.step_s),
        }
    }

    /// Divides by `divisor`; one that is not positive makes the curve zero.
    pub(crate) fn divide(&mut self, divisor: f32) {
        let factor = if divisor > f32::MIN_POSITIVE {
            divisor.recip()
        } else {
            0.0
        };
        for value in &mut self.values {
            *value *= factor;
        }
    }

    /// Divides by the highest value, so that the best delay has 1, and sets what is negative to 0: the R_n of the
    /// corrected equation 8 of Bregonzio, Taj and Cavallaro. A curve without a positive value becomes zero.
    pub fn normalize_to_peak(&mut self) {
        self.divide(self.maximum());
        for value in &mut self.values {
            *value = value.max(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(values: &[f32]) -> CorrelationCurve {
        CorrelationCurve {
            step_s: 0.5,
            values: values.to_vec(),
        }
    }

    #[test]
    fn interpolation_goes_through_the_values_and_is_held_at_the_ends() {
        let curve = curve(&[1.0, 4.0, 2.0, -1.0, 0.0]);
        for (index, &value) in curve.values.iter().enumerate() {
            assert_eq!(curve.at(curve.delay_s(index)), value);
            assert_eq!(curve.at_linear(curve.delay_s(index)), value);
        }
        assert_eq!(
            (curve.at(-9.0), curve.at(9.0), curve.at(f64::NAN)),
            (1.0, 0.0, 0.0)
        );
        assert_eq!(curve.at_linear(0.25), 0.5);
        assert_eq!(CorrelationCurve::default().at(0.0), 0.0);
    }

    #[test]
    fn a_parabola_is_found_exactly() {
        let top = 0.23;
        let values: Vec<f32> = (-4..=4)
            .map(|k| 3.0 - 2.0 * (0.5 * k as f32 - top).powi(2))
            .collect();
        let peak = curve(&values).peak().unwrap();
        approx::assert_relative_eq!(peak.delay_s, f64::from(top), epsilon = 1e-6);
        approx::assert_relative_eq!(peak.value, 3.0, epsilon = 1e-5);
        approx::assert_relative_eq!(peak.curvature, -4.0, epsilon = 1e-5);
    }

    #[test]
    fn peaks_come_highest_first_and_apart() {
        let curve = curve(&[0.0, 2.0, 1.0, 3.0, 0.0, 1.0, 0.5]);
        let mut peaks = Vec::new();
        curve.peaks(5, 0.6, &mut peaks);
        assert_eq!(
            peaks.iter().map(|peak| peak.value.round()).collect::<Vec<_>>(),
            [3.0, 2.0, 1.0]
        );
        curve.peaks(5, 1.6, &mut peaks);
        assert_eq!(peaks.len(), 1);
        curve.peaks(1, 0.0, &mut peaks);
        assert_eq!(peaks.len(), 1);
    }

    #[test]
    fn normalization_to_the_peak_leaves_no_negative_value() {
        let mut positive = curve(&[-1.0, 4.0, 2.0]);
        positive.normalize_to_peak();
        assert_eq!(positive.values, [0.0, 1.0, 0.5]);
        let mut negative = curve(&[-1.0, -4.0, -2.0]);
        negative.normalize_to_peak();
        assert_eq!(negative.values, [0.0, 0.0, 0.0]);
    }
}
