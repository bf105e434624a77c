//! The colour tracker (Chen and Rui, section IV.B): mean shift from where the head was.

use crate::body::{ASPECT, UprightEllipse};
use hearsight_filter::{FilterError, Gaussian};
use hearsight_vision::VisionError;
use hearsight_vision::histogram::{BinPicture, Histogram};
use hearsight_vision::mean_shift::{MeanShift, MeanShiftOptions};
use nalgebra::{SMatrix, SVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// How colours are followed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ColourTrackerSettings {
    /// The search.
    #[schemars(with = "Value")]
    pub search: MeanShiftOptions,
    /// How much likeness counts in the covariance of what is proposed, above 0. Default 20. Raising it proposes more
    /// narrowly.
    pub sharpness: f64,
    /// Least likeness to the colours learnt at which it proposes, 0 to 1. Default 0.3: less is not this head.
    pub least: f32,
}

impl Default for ColourTrackerSettings {
    fn default() -> Self {
        Self {
            search: MeanShiftOptions::default(),
            sharpness: 20.0,
            least: 0.3,
        }
    }
}

/// Follows colours; owns its buffers.
#[derive(Clone, Debug)]
pub struct ColourTracker {
    settings: ColourTrackerSettings,
    shift: MeanShift,
}

/// Smallest half height that is followed, pixels.
const SMALLEST_PX: f64 = 2.0;

impl ColourTracker {
    /// A tracker.
    ///
    /// # Errors
    /// [`VisionError::Parameter`] where a setting is out of its range.
    pub fn new(settings: ColourTrackerSettings) -> Result<Self, VisionError> {
        if !(settings.sharpness.is_finite() && settings.sharpness > 0.0) {
            return Err(VisionError::Parameter {
                name: "sharpness",
                value: settings.sharpness,
                allowed: "above 0",
            });
        }
        Ok(Self {
            shift: MeanShift::new(settings.search)?,
            settings,
        })
    }

    /// Follows `model` from `place` (x, y, half height, pixels), which is replaced, and returns what is proposed (q_2);
    /// nothing, and the place stays, where nothing there has these colours.
    ///
    /// # Errors
    /// [`FilterError`] where a number is not finite.
    pub fn track(
        &mut self,
        place: &mut [f64; 3],
        picture: &BinPicture,
        model: &Histogram,
    ) -> Result<Option<Gaussian<3>>, FilterError> {
        let start =
            UprightEllipse::bounds(place[0] as f32, place[1] as f32, place[2].max(SMALLEST_PX) as f32);
        let Some(found) = self.shift.follow(picture, model, &start) else {
            return Ok(None);
        };
        if found.coefficient < self.settings.least {
            return Ok(None);
        }
        let (x, y) = found.bounds.centre();
        let half = f64::from(0.5 * found.bounds.width * ASPECT).max(SMALLEST_PX);
        *place = [f64::from(x), f64::from(y), half];
        let covariance = self
            .shift
            .covariance(picture, model, &found.bounds, self.settings.sharpness);
        let covariance = SMatrix::<f64, 3, 3>::from_fn(|row, column| covariance[row][column]);
        Gaussian::new(SVector::from(*place), covariance).map(Some)
    }

    /// Likeness of the colours at a place to a model, 0 to 1; none where nothing of it is in the picture.
    pub fn likeness(&mut self, place: [f64; 3], picture: &BinPicture, model: &Histogram) -> Option<f32> {
        let bounds = UprightEllipse::bounds(place[0] as f32, place[1] as f32, place[2] as f32);
        self.shift.coefficient(picture, model, &bounds)
    }
}
