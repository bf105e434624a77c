//! All windows of a picture at all scales.
//!
//! The picture shrinks by a factor from scale to scale and the window stays; sizes, steps, arithmetic and order of
//! evaluation are those of OpenCV 4.10's `detectMultiScale`, so that the same windows are accepted.

use super::Cascade;
use super::evaluate::{Accepted, run_row};
use super::group::Grouping;
use super::level::{LANES, Layout, Level, Shape};
use super::plan::Plan;
use super::resize::Resizer;
use crate::VisionError;
use hearsight_core::{GrayView, Rectangle};
use serde::{Deserialize, Serialize};

/// From this scale on windows are placed at every pixel of the shrunk picture, below at every second.
const FINE_FROM: f32 = 2.0;

/// There is room for so many windows from the start, so that the first face in a picture asks for no memory; where more
/// are found, room is made for them once.
const WINDOWS: usize = 256;

/// Whether faces looking the other way are sought, by a picture turned left to right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mirror {
    /// As the cascade was trained.
    #[default]
    No,
    /// Only turned.
    Only,
    /// Both, each grouped by itself; takes twice the time.
    Both,
}

/// How windows are sought and grouped.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DetectOptions {
    /// Ratio of one scale to the next, 1.01 to 4, default 1.1. Raising it is faster and finds fewer.
    pub scale_step: f64,
    /// Smallest window, pixels (width, height), default 0 x 0: the cascade's own. Raising it is much faster.
    pub smallest: (u32, u32),
    /// Largest window, pixels (width, height), default 0 x 0: the picture.
    pub largest: (u32, u32),
    /// A group must have more windows than this, default 3; 0 leaves windows ungrouped. Raising it gives fewer false
    /// detections and more missed ones.
    pub neighbours: u32,
    /// How far windows of a group may be apart as a share of their size, 0 to 1, default 0.2.
    pub tolerance: f64,
    /// Whether faces looking the other way are sought.
    pub mirror: Mirror,
}

impl Default for DetectOptions {
    fn default() -> Self {
        Self {
            scale_step: 1.1,
            smallest: (0, 0),
            largest: (0, 0),
            neighbours: 3,
            tolerance: 0.2,
            mirror: Mirror::No,
        }
    }
}

impl DetectOptions {
    /// # Errors
    /// [`VisionError::Parameter`] where a number is outside its range.
    pub fn validate(&self) -> Result<(), VisionError> {
        VisionError::within("scale_step", self.scale_step, 1.01, 4.0, "1.01 to 4")?;
        VisionError::within("tolerance", self.tolerance, 0.0, 1.0, "0 to 1")
    }
}

/// A window that passed all stages, pixels of the picture; it can reach a pixel beyond the border by rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Left edge.
    pub left: i32,
    /// Top edge.
    pub top: i32,
    /// Width.
    pub width: i32,
    /// Height.
    pub height: i32,
    /// Sum of the last stage's leaves.
    pub score: f32,
    /// Whether it was found in the turned picture.
    pub mirrored: bool,
}

/// A group of windows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detection {
    /// Their mean, clipped to the picture.
    pub bounds: Rectangle,
    /// How many they are.
    pub neighbours: u32,
    /// The largest of their last stage's sums.
    pub score: f32,
    /// Whether they were found in the turned picture: a profile cascade's faces looking the other way.
    pub mirrored: bool,
}

/// Finds windows and groups them, with the buffers that takes.
#[derive(Clone, Debug)]
pub struct CascadeDetector {
    cascade: Cascade,
    options: DetectOptions,
    plans: Option<[Plan; 2]>,
    resizer: Resizer,
    shrunk: Vec<u8>,
    level: Level,
    results: Vec<[f32; LANES]>,
    accepted: Vec<Accepted>,
    windows: Vec<Window>,
    grouping: Grouping,
    detections: Vec<Detection>,
}

impl CascadeDetector {
    /// A detector.
    ///
    /// # Errors
    /// [`VisionError::Parameter`] where an option is outside its range.
    pub fn new(cascade: Cascade, options: DetectOptions) -> Result<Self, VisionError> {
        options.validate()?;
        Ok(Self {
            cascade,
            options,
            plans: None,
            resizer: Resizer::default(),
            shrunk: Vec::new(),
            level: Level::default(),
            results: Vec::new(),
            accepted: Vec::with_capacity(WINDOWS),
            windows: Vec::with_capacity(WINDOWS),
            grouping: Grouping::with_room_for(WINDOWS),
            detections: Vec::with_capacity(WINDOWS),
        })
    }

    /// The cascade.
    pub fn cascade(&self) -> &Cascade {
        &self.cascade
    }

    /// The options.
    pub fn options(&self) -> &DetectOptions {
        &self.options
    }

    /// Changes the smallest and largest window, pixels (width, height); 0 x 0 as in [`DetectOptions`].
    pub fn limit(&mut self, smallest: (u32, u32), largest: (u32, u32)) {
        self.options.smallest = smallest;
        self.options.largest = largest;
    }

    /// The groups of windows in `picture`, those of the turned picture last.
    pub fn detect(&mut self, picture: GrayView<'_>) -> &[Detection] {
        self.windows(picture);
        self.detections.clear();
        let turned = self.windows.partition_point(|window| !window.mirrored);
        let frame = Rectangle::new(0.0, 0.0, picture.width as f32, picture.height as f32);
        for windows in [&self.windows[..turned], &self.windows[turned..]] {
            let groups = self
                .grouping
                .group(windows, self.options.neighbours, self.options.tolerance);
            self.detections.extend(groups.filter_map(|mut detection| {
                detection.bounds = detection.bounds.intersection(&frame);
                (detection.bounds.area() > 0.0).then_some(detection)
            }));
        }
        &self.detections
    }

    /// All accepted windows in `picture`, ungrouped, those of the turned picture last.
    pub fn windows(&mut self, picture: GrayView<'_>) -> &[Window] {
        self.windows.clear();
        if self.options.mirror != Mirror::Only {
            self.scan(picture, false);
        }
        if self.options.mirror != Mirror::No {
            self.scan(picture, true);
        }
        &self.windows
    }

    /// The scales at which the window is sought in a picture of `width x height`.
    fn scales(&self, width: usize, height: usize) -> impl Iterator<Item = f32> + use<> {
        let side = |side: u32, whole: usize| if side == 0 { whole as f64 } else { f64::from(side) };
        let unlimited = self.options.largest.0 == 0 || self.options.largest.1 == 0;
        let largest = if unlimited { (0, 0) } else { self.options.largest };
        let most_wide = side(largest.0, width).min(width as f64);
        let most_high = side(largest.1, height).min(height as f64);
        let (least_wide, least_high) = (
            f64::from(self.options.smallest.0),
            f64::from(self.options.smallest.1),
        );
        let (own_width, own_height) = (self.cascade.width as f64, self.cascade.height as f64);
        let step = self.options.scale_step;
        let size = move |factor: f64| {
            (
                (own_width * factor).round_ties_even(),
                (own_height * factor).round_ties_even(),
            )
        };
        std::iter::successors(Some(1.0), move |factor| Some(factor * step))
            .take_while(move |&factor| {
                let (wide, high) = size(factor);
                wide <= most_wide && high <= most_high
            })
            .filter(move |&factor| {
                let (wide, high) = size(factor);
                wide >= least_wide && high >= least_high
            })
            .map(|factor| factor as f32)
    }

    fn scan(&mut self, picture: GrayView<'_>, mirrored: bool) {
        let shrink = |side: usize, scale: f32| (side as f32 / scale).round_ties_even() as usize;
        let mut columns_of_first = None;
        for scale in self.scales(picture.width, picture.height) {
            let (width, height) = (shrink(picture.width, scale), shrink(picture.height, scale));
            // One more position than there are, as in OpenCV: the last one is never looked at.
            let columns = (width + 1).saturating_sub(self.cascade.width);
            let rows = (height + 1).saturating_sub(self.cascade.height);
            let step = if scale >= FINE_FROM { 1 } else { 2 };
            let first = *columns_of_first.get_or_insert(columns);
            self.plan(Shape::new(width, height, self.cascade.is_tilted()));
            if columns == 0 || rows == 0 {
                continue;
            }
            self.resizer
                .resize(picture, width, height, mirrored, &mut self.shrunk);
            let layout = if step == 1 { Layout::Every } else { Layout::Second };
            let Some(plans) = &self.plans else { return };
            let plan = &plans[step - 1];
            let shrunk = GrayView {
                width,
                height,
                data: &self.shrunk,
            };
            self.level.compute(shrunk, plan.shape, layout);
            for row in (0..striped(rows, step, first)).step_by(step) {
                self.accepted.clear();
                let base = row * plan.shape.stride;
                let windows = columns.div_ceil(step);
                run_row(
                    plan,
                    &self.level,
                    base,
                    windows,
                    &mut self.results,
                    &mut self.accepted,
                );
                for &(number, score) in &self.accepted {
                    let at = |place: usize| (place as f32 * scale).round_ties_even() as i32;
                    let (left, wide) = (at(number * step), at(self.cascade.width));
                    self.windows.push(Window {
                        left: if mirrored {
                            picture.width as i32 - left - wide
                        } else {
                            left
                        },
                        top: at(row),
                        width: wide,
                        height: at(self.cascade.height),
                        score: score as f32,
                        mirrored,
                    });
                }
            }
        }
    }

    /// Makes the plans for tables of at least `shape`, unless they are there.
    fn plan(&mut self, shape: Shape) {
        let fits = |plans: &[Plan; 2]| {
            let ready = plans[0].shape;
            ready.stride >= shape.stride && ready.rows >= shape.rows
        };
        if !self.plans.as_ref().is_some_and(fits) {
            let plan = |layout| Plan::new(&self.cascade, shape, layout);
            let plans = [plan(Layout::Every), plan(Layout::Second)];
            self.results.resize(plans[0].largest_tree, [0.0; LANES]);
            self.plans = Some(plans);
        }
    }
}

/// How many rows OpenCV looks at: it divides them into stripes, as many as the first scale has groups of 32 columns,
/// and the rounding of a stripe's height can lose the last row.
fn striped(rows: usize, step: usize, columns_of_first: usize) -> usize {
    let stripes = columns_of_first.div_ceil(32).max(1);
    let height = (rows / step).div_ceil(stripes).max(1) * step;
    rows.min(height * stripes)
}
