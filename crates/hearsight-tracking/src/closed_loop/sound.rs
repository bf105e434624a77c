//! The sound tracker (Chen and Rui, section IV.C): the highest peak of the correlation as a column of the picture.
//!
//! It knows who speaks but coarsely, and nothing of rows and sizes: what it proposes is a Gaussian on the column alone.

use crate::percepts::ArrayPercepts;
use crate::sound_map::SoundMap;
use hearsight_audio::bearing::{PairBearing, peak_variance};
use hearsight_audio::curve::Peak;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::cell::RefCell;

/// How sound becomes a column.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SoundTrackerSettings {
    /// Peaks nearer than this are one, seconds. Default 1.5e-4.
    pub separation_s: f64,
    /// Least deviation of the column, pixels. Default 4.
    pub least_deviation_px: f64,
    /// Largest deviation at which it still proposes, as a share of the picture's width. Default 0.25.
    pub largest: f64,
}

impl Default for SoundTrackerSettings {
    fn default() -> Self {
        Self {
            separation_s: 1.5e-4,
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
    peaks: RefCell<Vec<Peak>>,
}

impl SoundTracker {
    /// A tracker for pictures of `width_px` columns.
    pub fn new(settings: SoundTrackerSettings, geometry: SoundGeometry, width_px: f64) -> Self {
        Self {
            settings,
            geometry,
            width_px,
            peaks: RefCell::default(),
        }
    }

    /// What is heard in this moment, as a column; none in silence, outside the picture, or where the peak tells nothing.
    pub fn fix(&self, array: &ArrayPercepts) -> Option<SoundFix> {
        if !array.has_sound() || !array.has_onset() {
            return None;
        }
        let mut peaks = self.peaks.borrow_mut();
        let (peak, variance_s2) = peak_variance(array.onset_curve(), self.settings.separation_s, &mut peaks)?;
        let column_px = self.geometry.column(peak.delay_s)?;
        let deviation = (self.geometry.slope(peak.delay_s)?.abs() * variance_s2.sqrt())
            .max(self.settings.least_deviation_px);
        let outside = column_px < 0.0 || column_px > self.width_px;
        (!outside && deviation <= self.settings.largest * self.width_px).then_some(SoundFix {
            column_px,
            variance_px2: deviation * deviation,
        })
    }
}
