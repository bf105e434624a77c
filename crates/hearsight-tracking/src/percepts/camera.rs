//! What a camera sees: change against the background and between pictures, heads, faces and colours.

use super::faces::{CameraError, FaceSearch, FaceSettings};
use hearsight_core::{Mask, Rectangle, RgbView, Span, VideoFrame};
use hearsight_vision::VisionError;
use hearsight_vision::background::{BackgroundModel, BackgroundOptions, BackgroundState};
use hearsight_vision::change::{ChangeDetector, ChangeOptions};
use hearsight_vision::contour::{GradientPicture, OutlineMap, OutlineOptions};
use hearsight_vision::contrast::{ContrastOptions, ContrastPicture, ContrastScratch};
use hearsight_vision::histogram::{BinPicture, Histogram, HistogramOptions, HistogramScratch, Similarity};
use hearsight_vision::mask::CleanOptions;
use hearsight_vision::silhouette::{Head, HeadFinder, HeadSearch};
use serde::{Deserialize, Serialize};
use std::cell::RefCell;

/// How a camera's pictures are looked at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CameraSettings {
    /// What differs from the room without people. Unlike the background's own defaults, masks are not dilated, so that
    /// outlines stay where they are, and reflections up to 1.4 times as bright are taken out: light walls change
    /// that much when somebody passes.
    pub background: BackgroundOptions,
    /// Where heads are looked for on the outlines of what differs.
    pub heads: HeadSearch,
    /// How faces are looked for.
    pub faces: FaceSettings,
    /// How colours are binned.
    pub histogram: HistogramOptions,
    /// Whether change is looked for, and heads on its outlines. Default true; without it people are born from faces alone.
    pub changes: bool,
    /// Whether outlines and the contrast of objects are looked at. Default false.
    pub outlines: bool,
    /// How outlines are scored, where they are looked at. Whoever looks at them says so elsewhere among its parameters.
    #[serde(skip)]
    pub outline: OutlineOptions,
    /// How an object is compared with what is around it, where outlines are looked at.
    pub contrast: ContrastOptions,
}

impl Default for CameraSettings {
    fn default() -> Self {
        Self {
            background: BackgroundOptions {
                clean: CleanOptions {
                    median: 5,
                    dilation_width: 1,
                    dilation_height: 1,
                },
                brightest_highlight: 1.4,
                ..BackgroundOptions::default()
            },
            heads: HeadSearch::default(),
            faces: FaceSettings::default(),
            histogram: HistogramOptions::default(),
            changes: true,
            outlines: false,
            outline: OutlineOptions::default(),
            contrast: ContrastOptions::default(),
        }
    }
}

/// What is remembered from picture to picture.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct CameraState {
    background: BackgroundState,
    previous: Vec<u8>,
    size: (usize, usize),
    last: Option<hearsight_core::Instant>,
    last_faces: Option<hearsight_core::Instant>,
}

/// Somebody's head, as a detector saw it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detection {
    /// The head, pixels.
    pub region: Rectangle,
    /// Score of the detector, about 0 to 1.
    pub score: f32,
    /// Whether a face detector saw it (otherwise the outline of a body).
    pub is_face: bool,
}

/// Percepts of one camera.
pub struct CameraPercepts {
    settings: CameraSettings,
    background: BackgroundModel,
    stir: ChangeDetector,
    state: CameraState,
    change: Mask,
    stirred: Mask,
    changed_share: HeadFinder,
    stirred_share: HeadFinder,
    heads: Vec<Head>,
    detections: Vec<Detection>,
    faces: FaceSearch,
    bins: BinPicture,
    gradients: GradientPicture,
    contrast: ContrastPicture,
    scratch: RefCell<Scratch>,
    unreadable: u64,
}

struct Scratch {
    histogram: HistogramScratch,
    scores: Vec<Similarity>,
    outlines: OutlineMap,
    contrast: ContrastScratch,
}

impl CameraPercepts {
    /// Percepts of a camera that has seen nothing yet.
    ///
    /// # Errors
    /// [`CameraError`] where a setting is out of its range or a cascade cannot be read.
    pub fn new(settings: CameraSettings) -> Result<Self, CameraError> {
        let stir = ChangeOptions {
            clean: CleanOptions {
                median: 3,
                dilation_width: 5,
                dilation_height: 5,
            },
            ..ChangeOptions::default()
        };
        settings.heads.validate()?;
        let faces = FaceSearch::new(&settings.faces)?;
        Ok(Self {
            background: BackgroundModel::new(settings.background)?,
            stir: ChangeDetector::new(stir)?,
            bins: BinPicture::new(settings.histogram)?,
            gradients: GradientPicture::default(),
            contrast: ContrastPicture::new(settings.contrast)?,
            scratch: RefCell::new(Scratch {
                histogram: HistogramScratch::default(),
                scores: Vec::new(),
                outlines: OutlineMap::new(settings.outline)?,
                contrast: ContrastScratch::default(),
            }),
            settings,
            state: CameraState::default(),
            change: Mask::default(),
            stirred: Mask::default(),
            changed_share: HeadFinder::default(),
            stirred_share: HeadFinder::default(),
            heads: Vec::new(),
            detections: Vec::new(),
            faces,
            unreadable: 0,
        })
    }

    /// What is remembered.
    pub fn state(&self) -> CameraState {
        CameraState {
            background: self.background.state().clone(),
            ..self.state.clone()
        }
    }

    /// Checks what was remembered: whether it contradicts itself.
    ///
    /// # Errors
    /// [`VisionError`] where it does.
    pub fn check_state(state: &CameraState) -> Result<(), VisionError> {
        state.background.validate()?;
        let (width, height) = state.size;
        let bytes = width.saturating_mul(height).saturating_mul(3);
        let size = state.background.size();
        // Where change is not looked for nothing is kept to compare with.
        let kept = state.previous.is_empty() || state.previous.len() == bytes;
        if kept && (size == state.size || state.background.is_empty()) {
            return Ok(());
        }
        Err(VisionError::Parameter {
            name: "the picture before",
            value: bytes as f64,
            allowed: "as many bytes as there are, and a background of the same size",
        })
    }

    /// Goes on from what was remembered.
    ///
    /// # Errors
    /// As [`CameraPercepts::check_state`]; nothing is changed then.
    pub fn set_state(&mut self, state: CameraState) -> Result<(), VisionError> {
        Self::check_state(&state)?;
        self.background = BackgroundModel::restore(self.settings.background, state.background.clone())?;
        self.state = state;
        Ok(())
    }

    /// Takes in a new picture.
    pub fn see(&mut self, frame: &VideoFrame) {
        let picture = frame.rgb_view();
        let size = (frame.width, frame.height);
        self.heads.clear();
        if self.settings.changes {
            self.look_for_changes(frame);
        }
        self.detections.clear();
        self.detections.extend(self.heads.iter().map(|head| Detection {
            region: head.region,
            score: head.score,
            is_face: false,
        }));
        if self.faces.is_due(frame.time, self.state.last_faces) {
            self.state.last_faces = Some(frame.time);
            self.add_faces(frame);
        }
        self.bins.compute(picture);
        if self.settings.outlines {
            self.gradients.compute(picture);
            self.scratch.get_mut().outlines.begin(&self.gradients);
            self.contrast.compute(picture);
        }
        self.state.size = size;
        self.state.last = Some(frame.time);
    }

    /// Compares with the room without people and with the picture before, and finds heads on what differs.
    fn look_for_changes(&mut self, frame: &VideoFrame) {
        let picture = frame.rgb_view();
        let elapsed = self.state.last.map_or(Span::ZERO, |last| frame.time - last);
        let size = (frame.width, frame.height);
        let seen = self.background.step(picture, elapsed, &mut self.change).is_ok();
        if !seen {
            // A picture of another size than before: the camera was changed. Everything begins anew.
            self.unreadable += 1;
            if let Ok(background) = BackgroundModel::new(self.settings.background) {
                self.background = background;
            }
            self.change.resize(frame.width, frame.height);
            self.change.data.fill(0);
        }
        self.compare_with_previous(picture, size);
        self.changed_share.load(&self.change);
        self.stirred_share.load(&self.stirred);
        self.changed_share
            .find(&self.change, &self.settings.heads, &mut self.heads);
        self.state.previous.clear();
        self.state.previous.extend_from_slice(picture.data);
    }

    /// Adds the heads around faces; one that the outline of a body gave already is marked as a face.
    fn add_faces(&mut self, frame: &VideoFrame) {
        let (changed, detections) = (&self.changed_share, &mut self.detections);
        let least = if self.settings.changes {
            self.settings.faces.changed
        } else {
            0.0
        };
        self.faces.search(frame.luma_view(), |head| {
            if changed.fraction(&head).unwrap_or(0.0) < least {
                return;
            }
            match detections
                .iter_mut()
                .find(|known| known.region.overlap(&head) > 0.25)
            {
                Some(known) => known.is_face = true,
                None => detections.push(Detection {
                    region: head,
                    score: 1.0,
                    is_face: true,
                }),
            }
        });
    }

    fn compare_with_previous(&mut self, picture: RgbView<'_>, size: (usize, usize)) {
        let previous = RgbView::new(size.0, size.1, &self.state.previous);
        let compared =
            previous.is_some_and(|previous| self.stir.detect(picture, previous, &mut self.stirred).is_ok());
        if !compared {
            self.stirred.resize(size.0, size.1);
            self.stirred.data.fill(0);
        }
    }

    /// Bins of every histogram.
    pub fn histogram_bins(&self) -> usize {
        self.settings.histogram.bins()
    }

    /// Size of the pictures, (width, height).
    pub fn size(&self) -> (usize, usize) {
        self.state.size
    }

    /// The heads detected in the newest picture.
    pub fn detections(&self) -> &[Detection] {
        &self.detections
    }

    /// What differs from the background in the newest picture.
    pub fn change(&self) -> &Mask {
        &self.change
    }

    /// Share of a region that differs from the background, 0 to 1; `None` where too little of it is in the picture, and
    /// where change is not looked for.
    pub fn change_share(&self, region: &Rectangle) -> Option<f32> {
        self.changed_share
            .fraction(region)
            .filter(|_| self.settings.changes)
    }

    /// Share of a region that changed since the picture before, 0 to 1; `None` as above.
    pub fn stirred_share(&self, region: &Rectangle) -> Option<f32> {
        self.stirred_share
            .fraction(region)
            .filter(|_| self.settings.changes)
    }

    /// The bins of the newest picture's colours.
    pub fn bins(&self) -> &BinPicture {
        &self.bins
    }

    /// The gradients of the newest picture; none where outlines are not looked at or there was no picture.
    pub fn gradients(&self) -> Option<&GradientPicture> {
        (self.settings.outlines && self.state.size != (0, 0)).then_some(&self.gradients)
    }

    /// Writes how well edges agree with each ellipse (mean over its lines of the logarithm of equation 10) into `scores`;
    /// false, changing nothing, where outlines are not looked at or there was no picture.
    pub fn outline_scores(&self, ellipses: &[Rectangle], scores: &mut [f32]) -> bool {
        if !self.settings.outlines || self.state.size == (0, 0) || ellipses.len() != scores.len() {
            return false;
        }
        let scratch = &mut *self.scratch.borrow_mut();
        scratch.outlines.score(&self.gradients, ellipses, scores);
        true
    }

    /// Writes how like its surroundings each ellipse is (Bhattacharyya coefficient, 0 to 1) into `scores`; false, changing
    /// nothing, where outlines are not looked at or there was no picture.
    pub fn contrasts(&self, ellipses: &[Rectangle], scores: &mut [f32]) -> bool {
        if !self.settings.outlines || self.state.size == (0, 0) || ellipses.len() != scores.len() {
            return false;
        }
        let scratch = &mut *self.scratch.borrow_mut();
        self.contrast.score(ellipses, &mut scratch.contrast, scores);
        true
    }

    /// The colours inside the ellipse of a region; returns the share of it inside the picture, 0 to 1.
    pub fn histogram(&self, region: &Rectangle, histogram: &mut Histogram) -> f32 {
        self.bins
            .histogram(region, &mut self.scratch.borrow_mut().histogram, histogram)
    }

    /// Writes the colour distance of each region to a reference into `scores`; false, changing nothing, before the
    /// first picture.
    pub fn colour_distances(&self, regions: &[Rectangle], reference: &Histogram, scores: &mut [f32]) -> bool {
        if self.state.size == (0, 0) || regions.len() != scores.len() {
            return false;
        }
        let scratch = &mut *self.scratch.borrow_mut();
        self.bins
            .score_ellipses(regions, reference, &mut scratch.histogram, &mut scratch.scores);
        for (score, similarity) in scores.iter_mut().zip(&scratch.scores) {
            *score = similarity.distance;
        }
        true
    }
}
