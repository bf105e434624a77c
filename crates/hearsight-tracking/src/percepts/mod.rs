//! Percepts: what is computed once from a moment and shared by every cue and hypothesis, one file a sensor kind.
//!
//! Running percepts (background, noise floor, onsets) step at every moment and are saved; the rest is derived from the
//! newest data into buffers that are reused.

mod array;
mod array_frames;
mod array_settings;
mod azimuth;
mod camera;
mod direction;
mod face_windows;
mod faces;
mod pair_noise;
mod round;
mod steered;
mod voice;

pub use array::{ArrayPercepts, ArrayState};
pub use array_settings::{ArraySettings, Pairs};
pub(crate) use azimuth::wrapped_rad;
pub use camera::{CameraPercepts, CameraSettings, CameraState, Detection};
pub use direction::{DirectionPercept, DirectionSettings, DirectionState};
pub use face_windows::{FaceWindow, FaceWindowPercepts, FaceWindowSettings, FaceWindowState};
pub use faces::{CameraError, FaceCascade, FaceSettings};
pub use hearsight_audio::bearing::PairBearing;
pub use hearsight_audio::weighting::Weighting;
pub use hearsight_vision::cascade::Mirror;
pub use hearsight_vision::contour::OutlineOptions;
pub(crate) use round::beside;
pub use round::{RoundPicture, Turn};
pub use steered::{HeardFrame, SteeredArraySettings, SteeredPercepts, SteeredState};
