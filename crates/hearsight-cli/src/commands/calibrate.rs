//! `hearsight calibrate`: cameras from boards, microphones from people who talk and are seen.

mod array;
mod camera;

use crate::exit::Code;

const EXAMPLES: &str = "\
Examples:
  hearsight calibrate camera --chessboard 9x7 --square 0.03 board/*.png --out camera.toml
  hearsight calibrate camera --charuco DICT_APRILTAG_36h11 9x7 --square 0.03 --marker 0.022 board.mp4
  hearsight calibrate array room.toml                    clock, turn and place of the room's array";

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(clap::Subcommand)]
enum What {
    /// Lens and place of a camera from pictures or a video of a board.
    Camera(camera::Arguments),
    /// Clock, turn and place of an array from a recording of people who talk and are seen by calibrated cameras.
    Array(array::Arguments),
}

/// Calibrates.
pub(crate) fn run(arguments: &Arguments) -> miette::Result<Code> {
    match &arguments.what {
        What::Camera(arguments) => camera::run(arguments),
        What::Array(arguments) => array::run(arguments),
    }
}
