//! The contour tracker (Chen and Rui, section IV.A): edges along the normals of the predicted ellipse, the likeliest closed
//! contour through them, and an unscented filter that takes it as its measurement.

use super::HeadMotion;
use crate::body::UprightEllipse;
use hearsight_filter::{
    FilterError, Gaussian, Transitions, UnscentedForm, UnscentedKalman, UnscentedScratch, Viterbi,
};
use hearsight_vision::VisionError;
use hearsight_vision::contour::{
    EdgeFinder, EdgeOptions, GradientPicture, LineEdges, LineLikelihood, Normal, signed_distance,
};
use nalgebra::{SMatrix, SVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// How outlines are followed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ContourTrackerSettings {
    /// Lines and what counts as an edge.
    #[schemars(with = "Value")]
    pub edges: EdgeOptions,
    /// The model of one line (equation 10).
    #[schemars(with = "Value")]
    pub line: LineLikelihood,
    /// How much the contour may bend from line to line (sigma_s of equation 11), pixels. Default 2.
    pub smoothness_px: f64,
    /// Deviation of a contour point as a measurement, pixels. Default 4: neighbouring lines see one edge, and heads are no
    /// ellipses.
    pub deviation_px: f64,
    /// How much likelier than without an edge the contour's place on a line must be for the line to count. Default 3.
    pub least_ratio: f64,
    /// Share of the lines that must count, 0 to 1. Default 0.25: less is not this head.
    pub least_lines: f64,
    /// Deviation added to what is proposed, pixels. Default 1.
    pub spread_px: f64,
    /// The unscented transform.
    #[schemars(with = "Value")]
    pub form: UnscentedForm,
}

impl Default for ContourTrackerSettings {
    fn default() -> Self {
        Self {
            edges: EdgeOptions::default(),
            line: LineLikelihood::default(),
            smoothness_px: 2.0,
            deviation_px: 4.0,
            least_ratio: 3.0,
            least_lines: 0.25,
            spread_px: 1.0,
            form: UnscentedForm::default(),
        }
    }
}

/// Follows outlines; owns its buffers.
#[derive(Clone, Debug)]
pub struct ContourTracker {
    settings: ContourTrackerSettings,
    finder: EdgeFinder,
    /// By how far a line reaches to each side.
    transitions: Vec<Transitions>,
    viterbi: Viterbi,
    scratch: UnscentedScratch,
    lines: Vec<(Normal, LineEdges)>,
    emissions: Vec<f64>,
    path: Vec<usize>,
    kept: Vec<Normal>,
    measured: Vec<f64>,
    variances: Vec<f64>,
}

/// Smallest half height that is followed, pixels.
const SMALLEST_PX: f64 = 2.0;

impl ContourTracker {
    /// A tracker.
    ///
    /// # Errors
    /// [`VisionError::Parameter`] where a setting is out of its range.
    pub fn new(settings: ContourTrackerSettings) -> Result<Self, VisionError> {
        settings.line.validate()?;
        let wrong = |name, value, allowed| Err(VisionError::Parameter { name, value, allowed });
        for (name, value) in [
            ("smoothness_px", settings.smoothness_px),
            ("deviation_px", settings.deviation_px),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return wrong(name, value, "above 0");
            }
        }
        if !(settings.spread_px.is_finite() && settings.spread_px >= 0.0) {
            return wrong("spread_px", settings.spread_px, "0 or more");
        }
        if settings.form.check(6).is_err() {
            return wrong(
                "form.alpha",
                settings.form.alpha,
                "above 0 to 1, with beta from 0 and kappa above -6",
            );
        }
        let finder = EdgeFinder::new(settings.edges)?;
        let transitions = (0..=settings.edges.longest_px)
            .map(|reach| Transitions::smooth(2 * reach + 1, settings.smoothness_px))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|_| VisionError::Parameter {
                name: "smoothness_px",
                value: settings.smoothness_px,
                allowed: "above 0",
            })?;
        let lines = settings.edges.lines;
        let mut tracker = Self {
            finder,
            settings,
            viterbi: Viterbi::default(),
            scratch: UnscentedScratch::for_measurements(6, lines),
            lines: Vec::with_capacity(lines),
            emissions: vec![0.0; lines * (2 * settings.edges.longest_px + 1)],
            path: Vec::with_capacity(lines + 1),
            kept: Vec::with_capacity(lines),
            measured: Vec::with_capacity(lines),
            variances: Vec::with_capacity(lines),
            transitions,
        };
        // The longest lines once, so that nothing grows while people are followed; all paths are alike, none can fail.
        if let Some(longest) = tracker.transitions.last() {
            let _ = tracker
                .viterbi
                .closed(longest, &tracker.emissions, &mut tracker.path);
        }
        Ok(tracker)
    }

    /// A state at a place (x, y, half height) that moves at `velocity`, as unsure as a new one is.
    ///
    /// # Errors
    /// [`FilterError`] for numbers that are not finite.
    pub fn start(place: [f64; 3], velocity: [f64; 3]) -> Result<UnscentedKalman<6>, FilterError> {
        let half = place[2].max(SMALLEST_PX);
        let deviation = [
            0.15 * half,
            0.15 * half,
            0.08 * half,
            2.0 * half,
            2.0 * half,
            0.3 * half,
        ];
        UnscentedKalman::new(
            SVector::from([place[0], place[1], half, velocity[0], velocity[1], velocity[2]]),
            SMatrix::from_diagonal(&SVector::from(deviation.map(|deviation| deviation * deviation))),
        )
    }

    /// Moves the state, measures the contour around where it should be, and takes it in. Returns what is proposed (q_1),
    /// or nothing where the state got lost.
    ///
    /// # Errors
    /// [`FilterError`] where the state is none any more; it should be started anew then.
    pub fn track(
        &mut self,
        state: &mut UnscentedKalman<6>,
        motion: &HeadMotion,
        gradients: &GradientPicture,
    ) -> Result<Option<Gaussian<3>>, FilterError> {
        state.predict(&self.settings.form, |state| motion.carry(state), &motion.noise())?;
        let mean = *state.mean();
        let (_, height) = gradients.size();
        let size = mean[2];
        if size < SMALLEST_PX || size > height as f64 {
            return Ok(None);
        }
        let bounds = UprightEllipse::bounds(mean[0] as f32, mean[1] as f32, size as f32);
        let reach = self.finder.find(gradients, &bounds, &mut self.lines);
        self.find_contour(reach)?;
        if self.kept.len() as f64 >= self.settings.least_lines * self.lines.len() as f64 {
            let lines = &self.kept;
            let observe = |state: &SVector<f64, 6>, out: &mut [f64]| {
                let half = state[2].max(0.5);
                let axes = [half / f64::from(crate::body::ASPECT), half];
                for (value, line) in out.iter_mut().zip(lines) {
                    let middle = [f64::from(line.x), f64::from(line.y)];
                    *value =
                        signed_distance([state[0], state[1]], axes, middle, line.direction.map(f64::from));
                }
            };
            state.update(
                &self.settings.form,
                &self.measured,
                &self.variances,
                observe,
                &mut self.scratch,
            )?;
        }
        self.propose(state)
    }

    /// The likeliest closed contour; lines on which it has no edge are dropped.
    fn find_contour(&mut self, reach: usize) -> Result<(), FilterError> {
        self.kept.clear();
        self.measured.clear();
        self.variances.clear();
        if self.lines.is_empty() {
            return Ok(());
        }
        self.emissions.clear();
        for (_, edges) in &self.lines {
            self.settings.line.emit(edges.edges(), reach, &mut self.emissions);
        }
        let Some(transitions) = self.transitions.get(reach) else {
            return Ok(());
        };
        self.viterbi
            .closed(transitions, &self.emissions, &mut self.path)?;
        let variance = self.settings.deviation_px * self.settings.deviation_px;
        for ((normal, edges), place) in self.lines.iter().zip(&self.path) {
            let offset = *place as f32 - reach as f32;
            let ratio = f64::from(self.settings.line.ratio(edges.edges(), offset));
            if ratio < self.settings.least_ratio {
                continue;
            }
            // The states are whole pixels; the edge that explains this one is not.
            let nearest = edges
                .edges()
                .iter()
                .map(|edge| edge.offset_px)
                .min_by(|a, b| (a - offset).abs().total_cmp(&(b - offset).abs()));
            let refined = nearest
                .filter(|edge| (edge - offset).abs() <= 1.0)
                .unwrap_or(offset);
            self.kept.push(*normal);
            self.measured.push(f64::from(refined));
            self.variances.push(variance);
        }
        Ok(())
    }

    fn propose(&self, state: &UnscentedKalman<6>) -> Result<Option<Gaussian<3>>, FilterError> {
        let spread = self.settings.spread_px * self.settings.spread_px;
        let mean = state.mean();
        if mean[2] < SMALLEST_PX {
            return Ok(None);
        }
        let covariance = SMatrix::<f64, 3, 3>::from_fn(|row, column| {
            let extra = if row == column { spread } else { 0.0 };
            state.covariance()[(row, column)] + extra
        });
        // Beyond three heads it proposes the whole picture, which is no proposal.
        if covariance[(0, 0)] > (6.0 * mean[2]).powi(2) {
            return Ok(None);
        }
        Gaussian::new(SVector::from([mean[0], mean[1], mean[2]]), covariance).map(Some)
    }
}
