//! Where the sensors of a room are and how they see and hear: learnt, not measured by hand.
//!
//! * [`board`] — a chessboard, or a ChArUco board with ArUco or AprilTag markers, found in a picture;
//! * [`camera`] — the lens of a camera, and where it is, from pictures of a board;
//! * [`speech`] — the clock, the turn and the place of a microphone array from people who talk and are seen.
//!
//! It finds no people and reads no files: whoever calls it brings pictures, places of mouths and samples. What cannot be
//! known from what was brought is refused with what is missing, and what is known comes with its uncertainty.

pub mod board;
pub mod camera;
mod error;
mod least_squares;
pub mod speech;

pub use error::CalibrateError;
