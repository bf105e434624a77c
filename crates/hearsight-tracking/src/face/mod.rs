//! Faces in one picture: a particle filter each, over position and width, in two partitions.
//!
//! Pnevmatikakis and Talantzis, section 3. State (x, y, w): the middle and the width of a face as a cascade boxes it,
//! pixels. First the position moves and the `windows` of cascades weigh it ([`FaceLikelihood`], eqs. 13-14); the
//! survivors' width then changes and the `colours` of four sub-regions weigh the whole (eqs. 15-19). A colour always
//! says something, a detector only now and then: where it says nothing, colours alone remain (erratum 8).

mod belief;
mod colours;
mod tracker;
mod windows;

pub use belief::{FaceBelief, Model};
pub use colours::{Attenuation, ColourSettings, SubRegion};
pub use tracker::{FaceLifeSettings, FaceSettings, FaceState, FaceTracker, FaceWalk};
pub use windows::FaceLikelihood;
