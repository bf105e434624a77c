//! The sound tracker (Chen and Rui, section IV.C): the highest peak of the correlation as a column of the picture.
//!
//! It knows who speaks but coarsely, and nothing of rows and sizes: what it proposes is a Gaussian on the column alone.

use crate::percepts::{ArrayPercepts, wrapped_rad};
use crate::sound_map::SoundMap;
use hearsight_audio::bearing::{PairBearing, peak_variance};
use hearsight_audio::curve::{CorrelationCurve, Peak};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::cell::RefCell;

/// How sound becomes a column.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SoundTrackerSettings {
    /// Peaks nearer than this are one, seconds. Default 1.5e-4.
    pub separation_s: f64,
    /// The same of azimuths, where a whole array is listened to, radians. Default 0.3.
    pub separation_rad: f64,
    /// Least deviation of the column, pixels. Default 4.
    pub least_deviation_px: f64,
    /// Largest deviation at which it still proposes, as a share of the picture's width. Default 0.25.
    pub largest: f64,
}

impl Default for SoundTrackerSettings {
    fn default() -> Self {
        Self {
            separation_s: 1.5e-4,
            separation_rad: 0.3,
            least_deviation_px: 4.0,
            largest: 0.25,
        }
    }
}

/// From delays to columns and back.
#[derive(Clone, Debug)]
pub enum SoundGeometry {
    /// By the measured places of camera and microphones.
    World(SoundMap),
    /// By the spacing of the microphones and the camera's field of view alone.
    Pair(PairBearing),
}

impl SoundGeometry {
    /// The column that a delay points at, pixels; none where it points outside the picture's map.
    pub fn column(&self, delay_s: f64) -> Option<f64> {
        match self {
            Self::World(map) => map.column(delay_s),
            Self::Pair(pair) => pair.column_px(delay_s),
        }
    }

    /// Columns a second of delay.
    fn slope(&self, delay_s: f64) -> Option<f64> {
        match self {
            Self::Pair(pair) => Some(pair.columns_per_second(delay_s)),
            Self::World(map) => {
                const STEP_S: f64 = 1e-5;
                let here = map.column(delay_s)?;
                let (before, after) = (map.column(delay_s - STEP_S), map.column(delay_s + STEP_S));
                // At the picture's edge one of both is outside.
                let change = match (before, after) {
                    (Some(before), Some(after)) => 0.5 * (after - before),
                    (Some(before), None) => here - before,
                    (None, Some(after)) => after - here,
                    (None, None) => return None,
                };
                Some(change / STEP_S)
            }
        }
    }
}

/// Where sound alone says that somebody speaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoundFix {
    /// The column, pixels.
    pub column_px: f64,
    /// Its variance, square pixels: of the peak's curvature, raised by the height of the highest rival.
    pub variance_px2: f64,
}

/// Finds the column of what is heard.
#[derive(Debug)]
pub struct SoundTracker {
    settings: SoundTrackerSettings,
    geometry: SoundGeometry,
    width_px: f64,
    work: RefCell<Work>,
}

#[derive(Debug, Default)]
struct Work {
    peaks: Vec<Peak>,
    turned: CorrelationCurve,
}

impl SoundTracker {
    /// A tracker for pictures of `width_px` columns.
    pub fn new(settings: SoundTrackerSettings, geometry: SoundGeometry, width_px: f64) -> Self {
        Self {
            settings,
            geometry,
            width_px,
            work: RefCell::default(),
        }
    }

    /// What is heard in this moment, as a column; none in silence, outside the picture, or where the peak tells nothing.
    pub fn fix(&self, array: &ArrayPercepts) -> Option<SoundFix> {
        if !array.has_sound() || !array.has_onset() {
            return None;
        }
        let work = &mut *self.work.borrow_mut();
        let (delay_s, variance_s2) = if array.is_circular() {
            let turned_by = turn_to_peak(array.onset_curve(), &mut work.turned);
            let (peak, variance) =
                peak_variance(&work.turned, self.settings.separation_rad, &mut work.peaks)?;
            (wrapped_rad(peak.delay_s + turned_by), variance)
        } else {
            let curve = array.onset_curve();
            let (peak, variance) = peak_variance(curve, self.settings.separation_s, &mut work.peaks)?;
            (peak.delay_s, variance)
        };
        let column_px = self.geometry.column(delay_s)?;
        let deviation =
            (self.geometry.slope(delay_s)?.abs() * variance_s2.sqrt()).max(self.settings.least_deviation_px);
        let outside = column_px < 0.0 || column_px > self.width_px;
        (!outside && deviation <= self.settings.largest * self.width_px).then_some(SoundFix {
            column_px,
            variance_px2: deviation * deviation,
        })
    }
}

/// Turns a curve that goes all round so that its highest value is in the middle, away from its ends; returns by how much.
fn turn_to_peak(curve: &CorrelationCurve, turned: &mut CorrelationCurve) -> f64 {
    let values = &curve.values;
    let highest = values
        .iter()
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(b.1))
        .map_or(0, |(index, _)| index);
    turned.step_s = curve.step_s;
    turned.values.clear();
    let first = (highest + values.len() - values.len() / 2) % values.len().max(1);
    turned.values.extend_from_slice(&values[first..]);
    turned.values.extend_from_slice(&values[..first]);
    curve.delay_s(highest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_at_the_seam_is_found_in_the_middle() {
        let count = 361;
        let step = std::f64::consts::TAU / 361.0;
        for top in [0, 1, 90, 180, 359, 360] {
            let mut curve = CorrelationCurve::default();
            curve.reset(step, count / 2);
            for (index, value) in curve.values.iter_mut().enumerate() {
                let apart = (index as i64 - top)
                    .rem_euclid(361)
                    .min((top - index as i64).rem_euclid(361));
                *value = (-0.5 * (apart as f32 / 5.0).powi(2)).exp();
            }
            let mut turned = CorrelationCurve::default();
            let by = turn_to_peak(&curve, &mut turned);
            let (peak, variance) = peak_variance(&turned, 0.3, &mut Vec::new()).unwrap();
            let found = wrapped_rad(peak.delay_s + by - curve.delay_s(top as usize));
            assert!(found.abs() < 1e-6, "{top}: {found}");
            assert!((variance.sqrt() / (5.0 * step) - 1.0).abs() < 0.05);
        }
    }
}
