//! What Hearsight sees with: integral images, histograms, change detection, backgrounds, regions and cascades.
//!
//! Mathematics on borrowed pixels only: no camera, no person, and no file but that of a cascade. Buffers live in the
//! objects that fill them and are reused from picture to picture.
//!
//! * [`integral`] — sums, sums of squares and tilted sums over rectangles.
//! * [`histogram`] — colour histograms inside ellipses and their Bhattacharyya distance.
//! * [`change`] — colour change between two pictures; [`mask`] — the median and dilation that clean it.
//! * [`background`] — the picture without people, learnt as it comes.
//! * [`regions`] — connected components of a mask.
//! * [`mean_shift`] — from where colours were to where they are; [`contrast`] — how an object differs from its ring.
//! * [`contour`] — edges along the normals of ellipses, and how well they agree with one.
//! * [`cascade`] — Haar cascades: searches and single windows.

pub mod background;
pub mod cascade;
pub mod change;
pub mod contour;
pub mod contrast;
pub mod error;
pub mod histogram;
pub mod integral;
pub mod mask;
pub mod mean_shift;
pub mod regions;
pub mod silhouette;

mod bits;
#[cfg(target_arch = "x86_64")]
mod registers;

pub use error::VisionError;
