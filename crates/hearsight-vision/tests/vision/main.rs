//! Contracts of this crate: what OpenCV and numpy make of the same input, and what outside bytes may do.

#![expect(
    clippy::unwrap_used,
    reason = "a test stops at what it does not expect, also in its helpers"
)]

mod cascade_files;
mod cascades;
mod common;
mod mean_shift;
mod pictures;
