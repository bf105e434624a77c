//! Cascades of boosted Haar features (Viola and Jones 2001; Lienhart and Maydt 2002), as OpenCV stores them.
//!
//! * [`Cascade`] — the model: stages of trees over features, read from OpenCV's XML of both formats.
//! * [`CascadeDetector`] — all windows of a picture at all scales, window for window what OpenCV 4.10 finds.
//! * [`WindowScorer`] — single windows of any size, for hypotheses.
//!
//! A window is accepted where every stage's sum of leaves reaches the stage's threshold. Each feature is a weighted sum
//! over two or three rectangles, divided by the window's contrast (standard deviation times area).

pub mod detect;
pub mod error;
pub mod group;
pub mod resize;
pub mod window;

mod evaluate;
#[cfg(target_arch = "x86_64")]
mod evaluate_avx2;
mod level;
mod parse;
mod parse_new;
mod parse_old;
mod plan;

pub use detect::{CascadeDetector, DetectOptions, Detection, Mirror, Window};
pub use error::CascadeError;
pub use window::{WindowScore, WindowScorer};

use std::path::Path;

/// Subtracted from each stage's threshold, as OpenCV does: room for the rounding of its training.
const THRESHOLD_ROOM: f32 = 1e-5;

/// A cascade: what a file says, checked. Every rectangle lies in the window and every tree ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Cascade {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) stages: Vec<Stage>,
    pub(crate) trees: Vec<Tree>,
    pub(crate) nodes: Vec<Node>,
    pub(crate) leaves: Vec<f32>,
    pub(crate) features: Vec<Feature>,
}

/// Trees in a row and the sum they must reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stage {
    pub(crate) first_tree: usize,
    pub(crate) trees: usize,
    pub(crate) threshold: f32,
}

/// Nodes in a row, the root first, and as many leaves plus one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tree {
    pub(crate) first_node: usize,
    pub(crate) nodes: usize,
    pub(crate) first_leaf: usize,
}

/// A question: is the feature below the threshold?
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node {
    pub(crate) feature: usize,
    pub(crate) threshold: f32,
    /// Where to go if so: a later node of the tree where positive, else the leaf of that number, negated.
    pub(crate) left: i32,
    /// Where to go if not.
    pub(crate) right: i32,
}

/// Weighted rectangles, upright or turned by 45 degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Feature {
    pub(crate) tilted: bool,
    pub(crate) rectangles: [Weighted; 3],
}

/// A rectangle in the window, pixels, and its weight; weight 0 where a feature has only two. A tilted one has its top
/// corner at (x, y), goes `width` down to the right and `height` down to the left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Weighted {
    pub(crate) x: usize,
    pub(crate) y: usize,
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) weight: f32,
}

impl Cascade {
    /// Reads a cascade from a file.
    ///
    /// # Errors
    /// [`CascadeError`] where the file cannot be read or is no Haar cascade.
    pub fn load(path: &Path) -> Result<Self, CascadeError> {
        let file = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|source| CascadeError::Read {
            file: file.clone(),
            source,
        })?;
        Self::parse(&file, &bytes)
    }

    /// Reads a cascade from the bytes of a file; `file` is its name for errors.
    ///
    /// # Errors
    /// [`CascadeError`] where the bytes are no Haar cascade.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, CascadeError> {
        parse::parse(file, bytes)
    }

    /// Size of the window it was trained on, pixels (width, height).
    pub fn window_size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// How many stages it has.
    pub fn stages(&self) -> usize {
        self.stages.len()
    }

    /// Whether any feature is turned by 45 degrees.
    pub fn is_tilted(&self) -> bool {
        self.features.iter().any(|feature| feature.tilted)
    }
}
