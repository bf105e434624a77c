//! Single windows of any size and place, for hypotheses: no search, no grouping.
//!
//! The window is brought to the size the cascade was trained on and the cascade runs on that patch. Features scaled on
//! the integral image of the whole picture would be the older way; but they see other pixels than a search does, and
//! of the windows that a search accepts they accepted only a third to a half when it was tried. The patch costs no
//! more and takes the search's decision.

use super::Cascade;
use super::evaluate::{contrast, stage_sum};
use super::level::{Layout, Level, Shape};
use super::plan::Plan;
use super::resize::{Range, Resizer};
use hearsight_core::{GrayView, Rectangle};

/// How far a window came.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WindowScore {
    /// Whether it passed all stages.
    pub accepted: bool,
    /// Stages passed, 0 to [`Cascade::stages`]. A face that is a pixel off often fails one of the last stages, so for a
    /// hypothesis this says more than `accepted`.
    pub stages: usize,
    /// Sum of the leaves of the last stage run: the one that rejected the window, or the last of all. 0 where the
    /// window has too little contrast or lies outside the picture.
    pub score: f32,
    /// Threshold of that stage: `score - threshold` is the margin, negative where rejected. 0 where none was run.
    pub threshold: f32,
    /// Share of the window's area inside the picture, 0 to 1. Outside, the border's pixels are repeated; what to make
    /// of windows that are mostly outside is the caller's matter.
    pub inside: f32,
}

/// Scores single windows, with the buffers that takes; one for each thread.
#[derive(Clone, Debug)]
pub struct WindowScorer {
    plan: Plan,
    width: usize,
    height: usize,
    mirrored: bool,
    resizer: Resizer,
    patch: Vec<u8>,
    level: Level,
}

impl WindowScorer {
    /// A scorer for windows as trained, or, `mirrored`, turned left to right: for faces looking the other way.
    pub fn new(cascade: &Cascade, mirrored: bool) -> Self {
        let (width, height) = cascade.window_size();
        let shape = Shape::new(width, height, cascade.is_tilted());
        Self {
            plan: Plan::new(cascade, shape, Layout::Every),
            width,
            height,
            mirrored,
            resizer: Resizer::default(),
            patch: Vec::new(),
            level: Level::default(),
        }
    }

    /// Scores every window of `picture`; `scores` is overwritten with one entry for each.
    pub fn score_windows(
        &mut self,
        picture: GrayView<'_>,
        windows: &[Rectangle],
        scores: &mut Vec<WindowScore>,
    ) {
        scores.clear();
        scores.extend(windows.iter().map(|window| self.score_window(picture, window)));
    }

    /// Scores one window of `picture`.
    ///
    /// The picture counts as shrunk by the window's size over the training size, to whole pixels as in a search, each
    /// side by itself; so a window of a search gets the search's decision. A window that is empty, not finite or
    /// outside of the picture is rejected with `inside` 0.
    pub fn score_window(&mut self, picture: GrayView<'_>, window: &Rectangle) -> WindowScore {
        let area = window.area();
        let frame = Rectangle::new(0.0, 0.0, picture.width as f32, picture.height as f32);
        let inside = window.intersection(&frame).area() / area;
        // Not a number where the area is zero; zero where it is infinite.
        if !window.is_finite() || inside.is_nan() || inside <= 0.0 {
            return WindowScore::default();
        }
        let range = |start: f32, size: f32, trained: usize, whole: usize, turned: bool| {
            let scale = f64::from(size) / trained as f64;
            let shrunk = (whole as f64 / scale).round_ties_even().max(1.0);
            Range {
                whole: shrunk as usize,
                start: f64::from(start) / scale,
                count: trained,
                turned,
            }
        };
        // Turned, the search's grid starts at the right.
        let left = if self.mirrored {
            frame.width - window.right()
        } else {
            window.left
        };
        let across = range(left, window.width, self.width, picture.width, self.mirrored);
        let down = range(window.top, window.height, self.height, picture.height, false);
        self.resizer.resize_part(picture, across, down, &mut self.patch);
        self.run(WindowScore {
            inside: inside.min(1.0),
            ..WindowScore::default()
        })
    }

    /// Runs the cascade on the patch.
    fn run(&mut self, mut score: WindowScore) -> WindowScore {
        let patch = GrayView {
            width: self.width,
            height: self.height,
            data: &self.patch,
        };
        self.level.compute(patch, self.plan.shape, Layout::Every);
        let Some(scale) = contrast(&self.plan, &self.level) else {
            return score;
        };
        for stage in &self.plan.stages {
            let sum = stage_sum(&self.plan, stage, &self.level.sums, 0, scale);
            (score.score, score.threshold) = (sum as f32, stage.threshold);
            if sum < f64::from(stage.threshold) {
                return score;
            }
            score.stages += 1;
        }
        score.accepted = true;
        score
    }
}
