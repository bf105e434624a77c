//! Lens and place of a camera from a board.

use crate::exit::Code;
use crate::say;
use hearsight::calibrate::CalibrateError;
use hearsight::calibrate::board::{Board, BoardFinder, BoardView};
use hearsight::calibrate::camera::{CameraCalibration, calibrate};
use hearsight::core::VideoFrame;
use hearsight::core::calibration::{Calibration, to_toml};
use hearsight::core::camera::CameraModel;
use hearsight::core::source::{Delivery, VideoSource};
use hearsight::media::{VideoFile, VideoOptions};
use miette::{Context, IntoDiagnostic, miette};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  hearsight calibrate camera --chessboard 9x7 --square 0.03 board/*.png --out camera.toml
  hearsight calibrate camera --charuco DICT_APRILTAG_36h11 9x7 --square 0.03 --marker 0.022 board.mp4
  hearsight calibrate camera --chessboard 9x7 --square 0.03 board/*.png --place 0   and where the camera is:
                                           the world is the board of the first picture that shows it, x along its rows,
                                           y down its columns, z into it";

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Pictures of the board, or videos.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// A chessboard of so many squares, COLUMNSxROWS.
    #[arg(long, value_name = "SQUARES", value_parser = squares, required_unless_present = "charuco")]
    chessboard: Option<[u32; 2]>,
    /// A ChArUco board: OpenCV's name of its dictionary of ArUco or AprilTag markers, and COLUMNSxROWS squares.
    #[arg(long, num_args = 2, value_names = ["DICTIONARY", "SQUARES"], conflicts_with = "chessboard", requires = "marker")]
    charuco: Option<Vec<String>>,
    /// Side of a square, metres.
    #[arg(long, value_name = "METRES")]
    square: f64,
    /// Side of a marker, metres.
    #[arg(long, value_name = "METRES")]
    marker: Option<f64>,
    /// Of a video every so many-th picture is looked at, and 60 at the most of all files.
    #[arg(long, value_name = "NUMBER", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
    /// Write the place of the camera too, in the frame of the board of this picture of those that show it, from 0.
    #[arg(long, value_name = "NUMBER")]
    place: Option<usize>,
    /// Name of the camera in the file.
    #[arg(long, default_value = "camera")]
    name: String,
    /// Write the calibration here, as `calibration = { file = ... }` of a camera in room.toml names it.
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Pictures with the board that are used at the most.
const MOST_VIEWS: usize = 60;

fn squares(text: &str) -> Result<[u32; 2], String> {
    let (columns, rows) = text.split_once('x').ok_or("write COLUMNSxROWS, such as 9x7")?;
    let number = |part: &str| {
        part.parse::<u32>()
            .map_err(|_| format!("`{part}` is no number of squares"))
    };
    Ok([number(columns)?, number(rows)?])
}

fn board(arguments: &Arguments) -> miette::Result<Board> {
    if let Some(squares) = arguments.chessboard {
        return Ok(Board::Chessboard {
            squares,
            square_m: arguments.square,
        });
    }
    match (arguments.charuco.as_deref(), arguments.marker) {
        (Some([dictionary, text]), Some(marker_m)) => Ok(Board::Charuco {
            squares: squares(text).map_err(|reason| miette!("{reason}"))?,
            square_m: arguments.square,
            marker_m,
            dictionary: dictionary.clone(),
        }),
        _ => Err(miette!("give --chessboard, or --charuco with --marker")),
    }
}

/// Finds the board in all pictures, calibrates, prints and writes.
pub(super) fn run(arguments: &Arguments) -> miette::Result<Code> {
    let finder = BoardFinder::new(board(arguments)?).into_diagnostic()?;
    let (mut views, mut pictures) = (Vec::new(), 0);
    let mut size = None;
    for file in &arguments.files {
        let seen = look(file, &finder, arguments.every, &mut size, &mut pictures)
            .wrap_err_with(|| format!("{}", file.display()))?;
        views.extend(seen);
        if views.len() >= MOST_VIEWS {
            views.truncate(MOST_VIEWS);
            break;
        }
    }
    let size = size.ok_or_else(|| miette!("there is no picture in these files"))?;
    let found = calibrate(&views, size, pictures).into_diagnostic()?;
    let pose = match arguments.place {
        Some(number) => Some(*found.poses.get(number).ok_or_else(|| {
            miette!(
                "--place {number}, but the board is seen in {} pictures, from 0",
                found.poses.len()
            )
        })?),
        None => None,
    };
    print(&found, views.len(), pictures);
    let calibration = Calibration {
        file: PathBuf::new(),
        name: Some(arguments.name.clone()),
        model: CameraModel::Pinhole(found.lens),
        pose,
        size: Some(found.size),
    };
    let text = to_toml(&[calibration]);
    match &arguments.out {
        Some(out) => {
            std::fs::write(out, text)
                .into_diagnostic()
                .wrap_err_with(|| format!("cannot write {}", out.display()))?;
            say::line(format_args!("written to {}", out.display()));
        }
        None => say::line(format_args!("\n{}", text.trim_end())),
    }
    Ok(Code::Done)
}

/// The views of the board in one file.
fn look(
    file: &std::path::Path,
    finder: &BoardFinder,
    every: u64,
    size: &mut Option<[usize; 2]>,
    pictures: &mut usize,
) -> miette::Result<Vec<BoardView>> {
    let mut source = VideoFile::open(file, VideoOptions::default()).into_diagnostic()?;
    let (mut frame, mut faults) = (VideoFrame::default(), Vec::new());
    let mut views = Vec::new();
    let mut number = 0;
    while source.read(&mut frame, &mut faults) == Delivery::Data {
        number += 1;
        if (number - 1) % every != 0 || views.len() >= MOST_VIEWS {
            continue;
        }
        let picture = frame.luma_view();
        let [width, height] = *size.get_or_insert([picture.width, picture.height]);
        if [width, height] != [picture.width, picture.height] {
            return Err(CalibrateError::Size {
                width,
                height,
                found_width: picture.width,
                found_height: picture.height,
            })
            .into_diagnostic();
        }
        *pictures += 1;
        views.extend(finder.find(picture));
    }
    Ok(views)
}

fn print(found: &CameraCalibration, views: usize, pictures: usize) {
    let parameters = found.lens.parameters();
    let [fx, fy] = parameters.focal_px;
    let [cx, cy] = parameters.centre_px;
    let [dfx, dfy] = found.focal_deviation_px;
    let [dcx, dcy] = found.centre_deviation_px;
    say::line(format_args!("board seen in {views} of {pictures} pictures"));
    say::line(format_args!(
        "focal length     {fx:.2} +- {dfx:.2}, {fy:.2} +- {dfy:.2} pixels"
    ));
    say::line(format_args!(
        "principal point  {cx:.2} +- {dcx:.2}, {cy:.2} +- {dcy:.2} pixels"
    ));
    let worst = found
        .rms_of_views_px
        .iter()
        .fold(0.0_f64, |worst, error| worst.max(*error));
    say::line(format_args!(
        "corners are {:.3} pixels off (root mean square), {worst:.3} in the worst picture",
        found.rms_px
    ));
}
