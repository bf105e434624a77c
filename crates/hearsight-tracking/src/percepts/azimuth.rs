//! From the correlations of all pairs of an array to one curve over the azimuth.
//!
//! One pair cannot tell front from back; pairs in two directions can. Each azimuth has a delay for each pair, and what
//! the pairs say there is added. Curves over azimuths are kept as [`CorrelationCurve`]s whose steps are radians: they go
//! once all round, and their ends are neighbours.

use hearsight_audio::curve::CorrelationCurve;
use hearsight_core::WorldPoint;
use std::f64::consts::{PI, TAU};

/// Azimuths of a curve: a little less than a degree apart, an odd number, the middle one along the x axis.
pub(super) const AZIMUTHS: usize = 361;

/// Radians from one azimuth to the next.
pub(super) const STEP_RAD: f64 = TAU / AZIMUTHS as f64;

/// Distance at which sounds are taken to be, metres: across a table. Arrays are small against it.
const RANGE_M: f64 = 1.8;

/// Most pairs that are listened to, the widest first: more add time and little else.
const MOST_PAIRS: usize = 36;

/// Which pairs an array has, and the delays of every azimuth.
#[derive(Clone, Debug)]
pub(super) struct AzimuthFan {
    centre: WorldPoint,
    pairs: Vec<[usize; 2]>,
    /// Pairs x azimuths.
    delays_s: Vec<f64>,
}

impl AzimuthFan {
    /// The fan of an array; none where all its pairs lie in one direction, or fewer than three microphones are given.
    pub(super) fn new(microphones: &[WorldPoint], speed_of_sound_m_s: f64) -> Option<Self> {
        let count = microphones.len() as f64;
        let mean = |axis: fn(&WorldPoint) -> f64| microphones.iter().map(axis).sum::<f64>() / count.max(1.0);
        let centre = WorldPoint::new(mean(|p| p.0.x), mean(|p| p.0.y), mean(|p| p.0.z));
        let mut pairs: Vec<[usize; 2]> = (0..microphones.len())
            .flat_map(|first| (first + 1..microphones.len()).map(move |second| [first, second]))
            .collect();
        let length = |pair: &[usize; 2]| microphones[pair[0]].distance_m(microphones[pair[1]]);
        pairs.sort_by(|a, b| length(b).total_cmp(&length(a)));
        pairs.truncate(MOST_PAIRS);
        let [first, ..] = pairs.as_slice() else {
            return None;
        };
        let level = |pair: &[usize; 2]| {
            let [from, to] = pair.map(|microphone| microphones[microphone]);
            [to.0.x - from.0.x, to.0.y - from.0.y]
        };
        let along = level(first);
        let across = |pair: &[usize; 2]| {
            let other = level(pair);
            (along[0] * other[1] - along[1] * other[0]).abs()
        };
        let longest = along[0].hypot(along[1]);
        // A sixth of a right angle: less tells front from back by luck.
        if !pairs
            .iter()
            .any(|pair| across(pair) > 0.25 * longest * longest.min(length(pair)))
        {
            return None;
        }
        let delays_s = pairs
            .iter()
            .flat_map(|pair| {
                let [first, second] = pair.map(|microphone| microphones[microphone]);
                (0..AZIMUTHS).map(move |azimuth| {
                    let (sin, cos) = azimuth_of(azimuth).sin_cos();
                    let source = WorldPoint::new(
                        centre.0.x + RANGE_M * cos,
                        centre.0.y + RANGE_M * sin,
                        centre.0.z + 0.2 * RANGE_M,
                    );
                    (source.distance_m(first) - source.distance_m(second)) / speed_of_sound_m_s
                })
            })
            .collect();
        Some(Self {
            centre,
            pairs,
            delays_s,
        })
    }

    /// The microphones of each pair.
    pub(super) fn pairs(&self) -> &[[usize; 2]] {
        &self.pairs
    }

    /// The azimuth of a point around the array, from the x axis towards the y axis, radians, -pi to pi; none straight above
    /// or below.
    pub(super) fn azimuth_rad(&self, point: WorldPoint) -> Option<f64> {
        let (x, y) = (point.0.x - self.centre.0.x, point.0.y - self.centre.0.y);
        (x.hypot(y) > 1e-6).then(|| y.atan2(x))
    }

    /// Adds `share` of what one pair says to every azimuth.
    pub(super) fn add(&self, pair: usize, curve: &CorrelationCurve, share: f32, sum: &mut CorrelationCurve) {
        let delays = self.delays_s.iter().skip(pair * AZIMUTHS);
        for (value, delay_s) in sum.values.iter_mut().zip(delays) {
            *value += share * curve.at_linear(*delay_s);
        }
    }

    /// Delay of an azimuth for one pair, seconds.
    pub(super) fn delay_s(&self, pair: usize, azimuth_rad: f64) -> f64 {
        let index = (azimuth_rad / STEP_RAD).round() as i64 + (AZIMUTHS / 2) as i64;
        let index = index.rem_euclid(AZIMUTHS as i64) as usize;
        self.delays_s.get(pair * AZIMUTHS + index).copied().unwrap_or(0.0)
    }
}

fn azimuth_of(index: usize) -> f64 {
    (index as f64 - (AZIMUTHS / 2) as f64) * STEP_RAD
}

/// The same angle within -pi and pi.
pub(crate) fn wrapped_rad(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(count: usize) -> Vec<WorldPoint> {
        (0..count)
            .map(|k| {
                let (sin, cos) = (TAU * k as f64 / count as f64).sin_cos();
                WorldPoint::new(3.0 + 0.1 * cos, 2.0 + 0.1 * sin, 0.8)
            })
            .collect()
    }

    #[test]
    fn a_sound_is_where_all_pairs_agree_and_nowhere_else() {
        let fan = AzimuthFan::new(&ring(6), 343.0).unwrap();
        let truth = fan.azimuth_rad(WorldPoint::new(1.5, 1.0, 1.2)).unwrap();
        let mut sum = CorrelationCurve::default();
        sum.reset(STEP_RAD, AZIMUTHS / 2);
        for pair in 0..fan.pairs().len() {
            let delay_s = fan.delay_s(pair, truth);
            let curve = CorrelationCurve {
                step_s: 1e-5,
                values: (-80..=80)
                    .map(|k| (-0.5 * ((f64::from(k) * 1e-5 - delay_s) / 4e-5).powi(2)).exp() as f32)
                    .collect(),
            };
            fan.add(pair, &curve, 1.0, &mut sum);
        }
        let peak = sum.peak().unwrap();
        assert!(
            wrapped_rad(peak.delay_s - truth).abs() < 0.5 * STEP_RAD,
            "{peak:?}"
        );
        assert!((f64::from(peak.value) / fan.pairs().len() as f64) > 0.98);
        // The mirror image is heard by a pair alone as loudly; here it is not.
        assert!(sum.at(-peak.delay_s) < 0.8 * peak.value);
    }

    #[test]
    fn a_line_has_no_fan() {
        let line: Vec<WorldPoint> = (0..4)
            .map(|k| WorldPoint::new(0.1 * f64::from(k), 0.0, 1.0))
            .collect();
        assert!(AzimuthFan::new(&line, 343.0).is_none());
        assert!(AzimuthFan::new(&line[..1], 343.0).is_none());
        assert!(AzimuthFan::new(&ring(3), 343.0).is_some());
        assert_eq!(
            AzimuthFan::new(&ring(16), 343.0).unwrap().pairs().len(),
            MOST_PAIRS
        );
    }
}
