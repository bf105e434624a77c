//! What is remembered of one face in one picture. All of it is saved state.

use crate::belief::Existence;
use hearsight_core::{Instant, Rectangle};
use hearsight_filter::{Generator, Particles};
use hearsight_vision::histogram::Histogram;
use serde::{Deserialize, Serialize};

/// Colours of the four sub-regions, in the order of [`super::SubRegion::ALL`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Model {
    pub(super) parts: [Histogram; 4],
}

/// What is remembered of one face.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FaceBelief {
    /// Number of the belief in its tracker, from 0; never given twice.
    pub number: u64,
    /// Published identity; none while it is a scout.
    pub identity: Option<u64>,
    /// Possible states (x, y, w), pixels.
    pub particles: Particles,
    /// Its own generator.
    pub generator: Generator,
    /// Its colours.
    pub model: Model,
    /// Whether there is a face at all.
    pub existence: Existence,
    /// When it began.
    pub born: Instant,
    /// When windows last supported it.
    pub supported: Instant,
    /// For how long windows have supported it in all, seconds.
    pub support_s: f64,
    /// The face as a cascade boxes it: weighted mean of the particles, pixels.
    pub region: Rectangle,
    /// Standard deviations of x, y and w, pixels.
    pub deviation: [f32; 3],
    /// Effective number of particles before the last resampling.
    pub effective_sample_size: f64,
}

impl FaceBelief {
    /// The middle of the mouth: at 0.82 of the height of a cascade's box.
    pub fn mouth_px(&self) -> (f32, f32) {
        let (x, _) = self.region.centre();
        (x, self.region.top + MOUTH * self.region.height)
    }

    /// The head around the face, from the crown to the chin, the mouth at three quarters of its height.
    pub fn head(&self) -> Rectangle {
        let face = &self.region;
        let (x, _) = face.centre();
        let width = 0.85 * face.width;
        Rectangle::new(x - width / 2.0, face.top - 0.02 * face.height, width, 1.3 * width)
    }
}

/// Height of the mouth below the top of a cascade's box, as a share of its height.
const MOUTH: f32 = 0.81;
