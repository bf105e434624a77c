//! A sound and the faces that are seen, put together in the room.
//!
//! Pnevmatikakis and Talantzis, section 4. A face is a ray of its camera, a sound a point that the array is unsure of;
//! [`lines`] finds the point that suits both, as printed (eq. 20) or weighted by both uncertainties. [`association`] asks
//! which face a sound may belong to by the residual, the height and the width that the face would have there, and
//! [`place`] follows where each person is, and [`activity`] decides over time who speaks: where no association survives
//! nobody does, which needs no detector of voices. [`at_face`] asks the other way round, not in the paper: how well a
//! frame fits where the faces are.

pub mod activity;
pub mod association;
pub mod at_face;
mod guess;
pub mod lines;
pub mod place;

pub use activity::{Activity, ActivitySettings, Heard};
pub use association::{AssociationSettings, Match, Verdict, associate};
pub use at_face::log_likelihood_at;
pub use lines::{Meeting, SightLine, nearest_to_both, weighted};
pub use place::{Place, PlaceSettings};
