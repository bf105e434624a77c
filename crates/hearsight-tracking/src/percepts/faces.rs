//! Faces, found by cascades at a period of their own: people who do not stir are born from them.

use hearsight_core::{GrayView, Instant, Rectangle};
use hearsight_vision::VisionError;
use hearsight_vision::cascade::{Cascade, CascadeDetector, CascadeError, DetectOptions, Mirror};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A cascade of OpenCV.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FaceCascade {
    /// Its file, such as `/usr/share/opencv4/haarcascades/haarcascade_frontalface_alt2.xml` of Debian's `opencv-data`.
    pub file: PathBuf,
    /// Whether faces looking the other way are sought. Default no; `both` for profiles.
    #[serde(default)]
    pub mirror: Mirror,
}

/// How faces are looked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FaceSettings {
    /// The cascades. Default none: faces are not looked for, and people are born from changed regions alone.
    pub cascades: Vec<FaceCascade>,
    /// Time from one search to the next, seconds. Default 0.5. Lowering it finds people sooner and takes more time.
    pub period_s: f64,
    /// Smallest face, pixels. Default 20.
    pub smallest_px: u32,
    /// A face needs more windows than this around it. Default 4. Raising it gives fewer false faces.
    pub neighbours: u32,
    /// Least change against the background in a face, 0 to 1. Default 0.3: a picture on the wall is no person. 0 finds
    /// people who were there from the first picture on.
    pub changed: f32,
}

impl Default for FaceSettings {
    fn default() -> Self {
        Self {
            cascades: Vec::new(),
            period_s: 0.5,
            smallest_px: 20,
            neighbours: 4,
            changed: 0.3,
        }
    }
}

/// Why percepts of a camera could not be made.
#[derive(Debug, thiserror::Error)]
pub enum CameraError {
    /// A setting is out of its range.
    #[error(transparent)]
    Setting(#[from] VisionError),
    /// A cascade could not be read.
    #[error(transparent)]
    Cascade(#[from] CascadeError),
}

/// Looks for faces now and then.
pub(super) struct FaceSearch {
    detectors: Vec<CascadeDetector>,
    period_s: f64,
}

impl FaceSearch {
    pub(super) fn new(settings: &FaceSettings) -> Result<Self, CameraError> {
        let mut detectors = Vec::new();
        for cascade in &settings.cascades {
            let options = DetectOptions {
                smallest: (settings.smallest_px, settings.smallest_px),
                neighbours: settings.neighbours,
                mirror: cascade.mirror,
                ..DetectOptions::default()
            };
            detectors.push(CascadeDetector::new(Cascade::load(&cascade.file)?, options)?);
        }
        Ok(Self {
            detectors,
            period_s: settings.period_s,
        })
    }

    /// Whether it is time for a search, the last one having been at `last`.
    pub(super) fn is_due(&self, now: Instant, last: Option<Instant>) -> bool {
        !self.detectors.is_empty() && last.is_none_or(|last| (now - last).seconds() >= self.period_s - 1e-6)
    }

    /// Calls `found` with the head around every face.
    pub(super) fn search(&mut self, picture: GrayView<'_>, mut found: impl FnMut(Rectangle)) {
        for detector in &mut self.detectors {
            for face in detector.detect(picture) {
                found(head_of_face(&face.bounds));
            }
        }
    }
}

/// The head around a cascade's face: from the crown to the chin, the mouth at three quarters of its height.
fn head_of_face(face: &Rectangle) -> Rectangle {
    let (x, _) = face.centre();
    let width = 0.85 * face.width;
    Rectangle::new(x - width / 2.0, face.top - 0.05 * face.height, width, 1.3 * width)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_cascade_is_named() {
        let cascades = vec![FaceCascade {
            file: "no/such/cascade.xml".into(),
            mirror: Mirror::No,
        }];
        let error = FaceSearch::new(&FaceSettings {
            cascades,
            ..FaceSettings::default()
        });
        assert!(error.err().unwrap().to_string().contains("no/such/cascade.xml"));
    }

    #[test]
    fn searches_keep_their_period_and_need_a_cascade() {
        let search = FaceSearch {
            detectors: Vec::new(),
            period_s: 0.5,
        };
        assert!(!search.is_due(Instant::ZERO, None));
        let head = head_of_face(&Rectangle::new(100.0, 100.0, 40.0, 40.0));
        assert!(
            (head.top + 0.75 * head.height - 131.0).abs() < 1.0,
            "the mouth is at four fifths of a face"
        );
    }
}
