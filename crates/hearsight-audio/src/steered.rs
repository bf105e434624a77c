//! Steered response over the azimuth: from the correlations of many pairs to a direction all around.
//!
//! One pair cannot tell front from back: it needs pairs in at least two directions. Each pair gives its correlation at
//! the delay that a far sound in a direction would have; the mean over the pairs is the response.

use crate::bearing::raised;
use crate::curve::CorrelationCurve;
use crate::error::{AudioError, check_setting, check_shape};

/// The delays of all pairs in directions evenly spread over the full turn.
#[derive(Clone, Debug)]
pub struct SteeredResponse {
    /// Directions x pairs, seconds.
    delays_s: Vec<f64>,
    pairs: usize,
    directions: usize,
}

/// A direction with its variance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AzimuthPeak {
    /// Direction, in turns from the first one, 0 to below 1.
    pub turn: f64,
    /// Response there, of the scale of the correlations.
    pub value: f32,
    /// Variance of the direction, square turns: of the peak's curvature, raised by the highest rival.
    pub variance: f64,
}

/// Rivals nearer than this to the peak are the peak itself, turns.
const SEPARATION: f64 = 1.0 / 18.0;

impl SteeredResponse {
    /// `baselines_m` are the vectors from microphone i to j of each pair, in the plane in which `angle` turns: direction
    /// k of `directions` (8 to 36000) is (sin a, cos a) with a = 2 pi k / directions.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where a number is out of its range or all pairs lie along one line.
    pub fn new(baselines_m: &[[f64; 2]], speed_m_s: f64, directions: usize) -> Result<Self, AudioError> {
        check_setting(
            speed_m_s.is_finite() && speed_m_s > 0.0,
            "speed_m_s",
            "above 0",
            speed_m_s,
        )?;
        let many = (8..=36_000).contains(&directions);
        check_setting(many, "directions", "8 to 36000", directions as f64)?;
        let spread = baselines_m
            .iter()
            .flat_map(|a| baselines_m.iter().map(move |b| (a, b)));
        let widest = spread
            .map(|(a, b)| {
                (a[0] * b[1] - a[1] * b[0]).abs() / (a[0].hypot(a[1]) * b[0].hypot(b[1])).max(1e-12)
            })
            .fold(0.0, f64::max);
        check_setting(
            widest > 0.2,
            "baselines_m",
            "pairs in at least two directions: one line of microphones cannot tell front from back",
            widest,
        )?;
        let delays_s = (0..directions)
            .flat_map(|k| {
                let (sine, cosine) = (std::f64::consts::TAU * k as f64 / directions as f64).sin_cos();
                // t_i - t_j of a plane wave from there: positive where j is nearer.
                baselines_m
                    .iter()
                    .map(move |[x, z]| (x * sine + z * cosine) / speed_m_s)
            })
            .collect();
        Ok(Self {
            delays_s,
            pairs: baselines_m.len(),
            directions,
        })
    }

    /// How many directions there are.
    pub fn directions(&self) -> usize {
        self.directions
    }

    /// Writes the response of every direction, the mean of the pairs' correlations, into `response`.
    ///
    /// # Errors
    /// [`AudioError::Shape`] unless there is one curve a pair.
    pub fn respond(&self, curves: &[CorrelationCurve], response: &mut Vec<f32>) -> Result<(), AudioError> {
        check_shape("curves of pairs", self.pairs, curves.len())?;
        response.clear();
        let share = 1.0 / self.pairs as f32;
        response.extend(self.delays_s.chunks_exact(self.pairs).map(|delays| {
            let sum: f32 = delays
                .iter()
                .zip(curves)
                .map(|(delay, curve)| curve.at_linear(*delay))
                .sum();
            share * sum
        }));
        Ok(())
    }
}

/// The response in a direction between the computed ones, in turns; around the turn. 0 without a response.
pub fn response_at(response: &[f32], turn: f64) -> f32 {
    let count = response.len();
    let place = turn.rem_euclid(1.0) * count as f64;
    if count == 0 || !place.is_finite() {
        return 0.0;
    }
    let first = (place as usize).min(count - 1);
    let part = (place - first as f64) as f32;
    let (a, b) = (response[first], response[(first + 1) % count]);
    a + part * (b - a)
}

/// The strongest direction of a response; none where nothing is above 0.
pub fn azimuth_peak(response: &[f32]) -> Option<AzimuthPeak> {
    let count = response.len();
    let at = |place: isize| f64::from(response[place.rem_euclid(count as isize) as usize]);
    let mut top: Option<usize> = None;
    for place in 0..count {
        if response[place] > top.map_or(0.0, |top| response[top]) {
            top = Some(place);
        }
    }
    let top = top?;
    let place = top as isize;
    let (before, here, after) = (at(place - 1), at(place), at(place + 1));
    let bend = before - 2.0 * here + after;
    let shift = if bend < 0.0 {
        (0.5 * (before - after) / bend).clamp(-0.5, 0.5)
    } else {
        0.0
    };
    let reach = ((SEPARATION * count as f64).ceil() as isize).max(1);
    let rival = (place + reach..=place + count as isize - reach)
        .filter(|other| at(*other) >= at(other - 1) && at(*other) >= at(other + 1))
        .map(|other| at(other) as f32)
        .fold(0.0, f32::max);
    let step = 1.0 / count as f64;
    let variance = if bend < 0.0 {
        here / -bend
    } else {
        1.0 / (step * step)
    } * step
        * step;
    Some(AzimuthPeak {
        turn: ((top as f64 + shift) * step).rem_euclid(1.0),
        value: response[top],
        variance: raised(variance, rival / response[top]).min(1.0 / 12.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sharp correlations of a far sound in a direction, at eight microphones on a ring of 0.1 m.
    fn curves(pairs: &[[f64; 2]], turn: f64) -> Vec<CorrelationCurve> {
        let angle = turn * std::f64::consts::TAU;
        pairs
            .iter()
            .map(|[x, z]| {
                let delay = (x * angle.sin() + z * angle.cos()) / 343.0;
                CorrelationCurve {
                    step_s: 1e-5,
                    values: (-80..=80)
                        .map(|k| (-0.5 * ((f64::from(k) * 1e-5 - delay) / 6e-5).powi(2)).exp() as f32)
                        .collect(),
                }
            })
            .collect()
    }

    fn ring() -> Vec<[f64; 2]> {
        (0..4)
            .map(|k| {
                let angle = std::f64::consts::TAU * f64::from(k) / 8.0;
                [0.2 * angle.sin(), 0.2 * angle.cos()]
            })
            .collect()
    }

    #[test]
    fn every_direction_is_found_front_and_back() {
        let steered = SteeredResponse::new(&ring(), 343.0, 360).unwrap();
        let mut response = Vec::new();
        for turn in [0.0, 0.13, 0.37, 0.5, 0.741, 0.999] {
            steered.respond(&curves(&ring(), turn), &mut response).unwrap();
            let peak = azimuth_peak(&response).unwrap();
            let off = (peak.turn - turn + 0.5).rem_euclid(1.0) - 0.5;
            assert!(off.abs() < 0.003, "{turn}: {peak:?}");
            assert!(peak.variance.sqrt() < 0.05, "{peak:?}");
            assert!(response_at(&response, turn) > 0.95 * peak.value);
            assert!(response_at(&response, turn + 0.5) < 0.5 * peak.value);
        }
        assert!(steered.respond(&[], &mut response).is_err());
    }

    #[test]
    fn one_line_of_microphones_is_refused() {
        let error = SteeredResponse::new(&[[0.2, 0.0], [-0.1, 0.0]], 343.0, 360)
            .err()
            .unwrap();
        assert!(error.to_string().contains("front from back"), "{error}");
        assert!(SteeredResponse::new(&[], 343.0, 360).is_err());
        assert!(SteeredResponse::new(&ring(), 343.0, 3).is_err());
    }

    #[test]
    fn silence_has_no_direction_and_a_rival_makes_it_unsure() {
        assert_eq!(azimuth_peak(&[]), None);
        assert_eq!(azimuth_peak(&[0.0; 36]), None);
        let bump = |rival: f32| -> Vec<f32> {
            (0..360)
                .map(|k| {
                    let at = |centre: i32| (-0.5 * (f64::from(k - centre) / 8.0).powi(2)).exp() as f32;
                    at(100) + rival * at(280)
                })
                .collect()
        };
        let [alone, rivalled] = [0.0, 0.8].map(|rival| azimuth_peak(&bump(rival)).unwrap());
        assert!((alone.variance.sqrt() * 360.0 - 8.0).abs() < 0.2);
        assert!((rivalled.variance / alone.variance - 5.0).abs() < 0.3);
        assert_eq!(response_at(&[1.0, 3.0], 0.75), 2.0);
        assert_eq!(response_at(&[], 0.5), 0.0);
    }
}
