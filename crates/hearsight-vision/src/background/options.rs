//! The parameters of the background.

use crate::VisionError;
use crate::mask::CleanOptions;
use serde::{Deserialize, Serialize};

/// How a background is learnt and what counts as different from it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BackgroundOptions {
    /// A pixel differs where any channel differs by more than this, grey levels 0 to 255, default 20. Raising it hides
    /// camera noise, and people dressed like the wall.
    pub threshold: u8,
    /// How the mask is cleaned.
    pub clean: CleanOptions,
    /// How fast the background follows the picture where no one is seen, grey levels a second, 0 to 10000, default 10.
    /// Raising it follows daylight faster and lets people sink in before they are noticed.
    pub background_rate: f32,
    /// The same where someone is seen, default 0.2: a person 50 levels off the wall stands 150 seconds before they sink
    /// in at threshold 20. Raising it forgets moved chairs sooner, and people who stand still.
    pub foreground_rate: f32,
    /// For how long the first pictures are gathered, seconds, 0 (only the first) to 600, default 2. Raising it forgets
    /// people who walk about at the start, and makes the first good mask later.
    pub learning_secs: f32,
    /// How many pictures are gathered in that time, 1 to 31, default 9. Raising it costs memory while learning.
    pub learning_pictures: u8,
    /// Largest change of exposure compensated, a ratio, 1 (off) to 8, default 2.
    pub largest_gain: f32,
    /// Darkest shadow as a share of the background's brightness, 0 to 1 (off), default 0.5. Lowering it takes darker
    /// shadows for background, and people in dark clothes of the wall's colour with them.
    pub darkest_shadow: f32,
    /// Brightest highlight as a multiple of the background's brightness, 1 (off) to 4, default 1.15.
    pub brightest_highlight: f32,
    /// How far the colour of a shadow or highlight may be from the background's at its own brightness, grey levels 0 to
    /// 255, default 8. Raising it takes more shadows away, and more of people.
    pub shadow_colour: f32,
    /// For how long a region must not have changed before it may be a ghost, seconds, 0 (no ghosts) to 60, default 1.5.
    pub ghost_secs: f32,
    /// Smallest ghost, pixels, default 60.
    pub ghost_pixels: u32,
    /// How much stronger the edges along a region's contour must be in the background than in the picture to make it a
    /// ghost, a ratio of 1 or more, default 1.5. Raising it keeps more ghosts, and loses fewer people standing still.
    pub ghost_contrast: f32,
}

impl Default for BackgroundOptions {
    fn default() -> Self {
        Self {
            threshold: 20,
            clean: CleanOptions::default(),
            background_rate: 10.0,
            foreground_rate: 0.2,
            learning_secs: 2.0,
            learning_pictures: 9,
            largest_gain: 2.0,
            darkest_shadow: 0.5,
            brightest_highlight: 1.15,
            shadow_colour: 8.0,
            ghost_secs: 1.5,
            ghost_pixels: 60,
            ghost_contrast: 1.5,
        }
    }
}

impl BackgroundOptions {
    /// # Errors
    /// [`VisionError::Parameter`] where a number is outside its range.
    pub fn validate(&self) -> Result<(), VisionError> {
        let checks = [
            (
                "background_rate",
                self.background_rate,
                0.0,
                10_000.0,
                "0 to 10000",
            ),
            (
                "foreground_rate",
                self.foreground_rate,
                0.0,
                10_000.0,
                "0 to 10000",
            ),
            ("learning_secs", self.learning_secs, 0.0, 600.0, "0 to 600"),
            (
                "learning_pictures",
                f32::from(self.learning_pictures),
                1.0,
                31.0,
                "1 to 31",
            ),
            ("largest_gain", self.largest_gain, 1.0, 8.0, "1 to 8"),
            ("darkest_shadow", self.darkest_shadow, 0.0, 1.0, "0 to 1"),
            (
                "brightest_highlight",
                self.brightest_highlight,
                1.0,
                4.0,
                "1 to 4",
            ),
            ("shadow_colour", self.shadow_colour, 0.0, 255.0, "0 to 255"),
            ("ghost_secs", self.ghost_secs, 0.0, 60.0, "0 to 60"),
            ("ghost_contrast", self.ghost_contrast, 1.0, f64::MAX, "1 or more"),
        ];
        for (name, value, low, high, allowed) in checks {
            VisionError::within(name, f64::from(value), low, high, allowed)?;
        }
        Ok(())
    }
}
