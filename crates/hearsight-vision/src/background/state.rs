//! What a background remembers, and how it learns.

use super::BackgroundOptions;
use crate::VisionError;
use hearsight_core::{Mask, RgbView};
use serde::{Deserialize, Serialize};

/// The saved state of a background.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BackgroundState {
    width: usize,
    height: usize,
    /// Estimates in 1/256 grey levels, three a pixel.
    estimates: Vec<u16>,
    /// The picture since which a foreground pixel has not changed, three bytes a pixel.
    pub(super) settled: Vec<u8>,
    /// For how long it has not changed, milliseconds; 0 for background.
    pub(super) still_ms: Vec<u16>,
    /// Time since the first picture, seconds; counted while learning.
    seconds: f32,
    /// Pictures gathered while learning.
    gathered: Vec<Vec<u8>>,
    /// Fractions of steps not yet taken, 1/256 grey levels: background, foreground.
    remainders: [f32; 2],
    /// Time since ghosts were last looked for, seconds.
    pub(super) since_ghosts: f32,
}

impl BackgroundState {
    /// Size of the pictures, (width, height); (0, 0) before the first.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Whether no picture has been seen.
    pub fn is_empty(&self) -> bool {
        self.estimates.is_empty()
    }

    /// Whether the first pictures are still being gathered.
    pub fn is_learning(&self, options: &BackgroundOptions) -> bool {
        self.seconds < options.learning_secs && options.learning_pictures > 1
    }

    pub(super) fn estimates(&self) -> &[u16] {
        &self.estimates
    }

    /// Checks a state that was saved: lengths that contradict each other would end in a panic later.
    ///
    /// # Errors
    /// [`VisionError::Parameter`] where it contradicts itself.
    pub fn validate(&self) -> Result<(), VisionError> {
        let pixels = self.width.saturating_mul(self.height);
        let bytes = pixels.saturating_mul(3);
        let right = self.estimates.len() == bytes
            && self.settled.len() == bytes
            && self.still_ms.len() == pixels
            && self.gathered.iter().all(|picture| picture.len() == bytes)
            && self.gathered.len() <= 31
            && self.seconds >= 0.0
            && self.seconds.is_finite()
            && self.since_ghosts >= 0.0
            && self.since_ghosts.is_finite()
            && self.remainders.iter().all(|value| (0.0..=1.0).contains(value));
        if right {
            return Ok(());
        }
        Err(VisionError::Parameter {
            name: "background state",
            value: pixels as f64,
            allowed: "lengths that fit its width and height",
        })
    }

    pub(super) fn begin(&mut self, picture: RgbView<'_>) {
        *self = Self {
            width: picture.width,
            height: picture.height,
            estimates: picture.data.iter().map(|&value| u16::from(value) << 8).collect(),
            settled: picture.data.to_vec(),
            still_ms: vec![0; picture.width * picture.height],
            gathered: vec![picture.data.to_vec()],
            ..Self::default()
        };
    }

    /// While learning, takes pictures at equal intervals, whose median the background is.
    pub(super) fn gather(&mut self, picture: RgbView<'_>, seconds: f32, options: &BackgroundOptions) {
        if !self.is_learning(options) {
            self.gathered = Vec::new();
            return;
        }
        self.seconds += seconds;
        let wanted = usize::from(options.learning_pictures);
        let interval = options.learning_secs / (wanted - 1) as f32;
        // A little early is no harm; a rounding error late would lose the last picture.
        if self.gathered.len() < wanted && self.seconds >= interval * self.gathered.len() as f32 - 1e-4 {
            self.gathered.push(picture.data.to_vec());
            let mut values = [0_u8; 31];
            let values = &mut values[..self.gathered.len()];
            for (at, estimate) in self.estimates.iter_mut().enumerate() {
                for (value, picture) in values.iter_mut().zip(&self.gathered) {
                    *value = picture[at];
                }
                values.sort_unstable();
                let (low, high) = (values[(values.len() - 1) / 2], values[values.len() / 2]);
                *estimate = (u16::from(low) + u16::from(high)) << 7;
            }
        }
    }

    /// The background under the present light.
    pub(super) fn expect(&self, gain: [f32; 3], expected: &mut Vec<u8>) {
        expected.resize(self.estimates.len(), 0);
        let gain = gain.map(|gain| (gain * 256.0).round() as u32);
        let (estimates, _) = self.estimates.as_chunks::<3>();
        let (out, _) = expected.as_chunks_mut::<3>();
        for (out, estimates) in out.iter_mut().zip(estimates) {
            for channel in 0..3 {
                let value = (u32::from(estimates[channel]) * gain[channel] + (1 << 15)) >> 16;
                out[channel] = value.min(255) as u8;
            }
        }
    }

    /// Moves the estimates towards the picture, slowly under `mask`.
    pub(super) fn follow(
        &mut self,
        picture: RgbView<'_>,
        mask: &Mask,
        gain: [f32; 3],
        seconds: f32,
        options: &BackgroundOptions,
    ) {
        let mut steps = [0_i32; 2];
        let rates = [options.background_rate, options.foreground_rate];
        for ((step, remainder), rate) in steps.iter_mut().zip(&mut self.remainders).zip(rates) {
            let wanted = *remainder + rate * seconds * 256.0;
            *step = wanted as i32;
            *remainder = wanted.fract();
        }
        let inverse = gain.map(|gain| (65_536.0 / gain) as u32);
        let (estimates, _) = self.estimates.as_chunks_mut::<3>();
        let (pixels, _) = picture.data.as_chunks::<3>();
        for ((estimates, pixel), &mask) in estimates.iter_mut().zip(pixels).zip(&mask.data) {
            let step = if mask == 0 { steps[0] } else { steps[1] };
            for channel in 0..3 {
                let target = target(pixel[channel], inverse[channel]);
                let estimate = i32::from(estimates[channel]);
                estimates[channel] = (estimate + (target - estimate).clamp(-step, step)) as u16;
            }
        }
    }

    /// Takes what has settled at pixel `at` for the background.
    pub(super) fn adopt(&mut self, at: usize, gain: [f32; 3]) {
        for channel in 0..3 {
            let inverse = (65_536.0 / gain[channel]) as u32;
            self.estimates[3 * at + channel] = target(self.settled[3 * at + channel], inverse) as u16;
        }
        self.still_ms[at] = 0;
    }
}

/// A grey value under the background's own light, 1/256 grey levels; `inverse` is 65536 / gain, gain at least 1/8.
fn target(value: u8, inverse: u32) -> i32 {
    ((u32::from(value) * inverse) >> 8).min(255 << 8) as i32
}
