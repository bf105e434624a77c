//! Outlines of heads: edges along the normals of an ellipse, and how well they agree with one.
//!
//! Made for hundreds of ellipses on one picture: [`GradientPicture`] finds the gradients of all colour channels once;
//! lines read them between the pixels, in whatever direction. An ellipse is upright and given by the [`Rectangle`] that
//! it touches from inside.
//!
//! * [`gradient`] — gradients of all channels together, and edge strength in any direction.
//! * [`normals`] — the normals of an ellipse, and where another ellipse crosses them.
//! * [`edges`] — several edges a line, between the pixels.
//! * [`likelihood`] — how likely the outline is at a place of a line; scores of whole ellipses, line by line.
//! * [`map`] — the same scores for hundreds of ellipses of one shape, by look-ups.

pub mod edges;
pub mod gradient;
pub mod likelihood;
pub mod map;
pub mod normals;

pub use edges::{Edge, EdgeFinder, EdgeOptions, LineEdges};
pub use gradient::GradientPicture;
pub use likelihood::{ContourScorer, LineLikelihood};
pub use map::{OutlineMap, OutlineOptions};
pub use normals::{Normal, Normals, signed_distance};

#[cfg(doc)]
use hearsight_core::Rectangle;
