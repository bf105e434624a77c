//! Boards to calibrate with, and where their corners are in a picture.
//!
//! Detection is that of the crates `calib-targets-*`, on top of ChESS corners; this module says what a board is, finds the
//! corners that were detected to a few hundredths of a pixel, and gives them in metres on the board and pixels of the picture.

use crate::error::CalibrateError;
use calib_targets_aruco::resolve_dictionary;
use calib_targets_charuco::{CharucoBoardSpec, CharucoDetector, CharucoParams};
use calib_targets_chessboard::{ChessboardDetector, ChessboardParams, detect_corner_frame};
use calib_targets_core::GrayImageView;
use hearsight_core::{DistortedPixel, GrayView};
use nalgebra::{Matrix2, Point2, Vector2};

/// A flat board.
#[derive(Clone, Debug, PartialEq)]
pub enum Board {
    /// Black and white squares. What is seen of it may be a part: corners are then counted from the part's own.
    Chessboard {
        /// Squares in a row and rows, 3 to 100 each.
        squares: [u32; 2],
        /// Side of a square, metres.
        square_m: f64,
    },
    /// A chessboard whose white squares bear markers, which tell its corners apart (OpenCV's layout since 4.6).
    Charuco {
        /// Squares in a row and rows, 3 to 100 each.
        squares: [u32; 2],
        /// Side of a square, metres.
        square_m: f64,
        /// Side of a marker, metres.
        marker_m: f64,
        /// Name of the markers' dictionary as OpenCV has it, such as `DICT_4X4_50` or `DICT_APRILTAG_36h11`.
        dictionary: String,
    },
}

/// One picture of a board: corners on the board and in the picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoardView {
    /// Place of each corner on the board, metres, x to the right and y down as printed.
    pub board_m: Vec<[f64; 2]>,
    /// Where it is in the picture, pixels; (0, 0) is the centre of the top-left pixel.
    pub pixels: Vec<DistortedPixel>,
}

/// Corners below which a picture says too little.
const LEAST_CORNERS: usize = 8;

/// Finds a board in pictures.
pub struct BoardFinder {
    board: Board,
    kind: Kind,
}

enum Kind {
    Chessboard(ChessboardDetector),
    Charuco(Box<CharucoDetector>),
}

fn wrong(name: &'static str, value: impl ToString, rule: &'static str) -> CalibrateError {
    CalibrateError::Board {
        name,
        value: value.to_string(),
        rule,
    }
}

impl Board {
    /// Squares in a row and rows.
    pub fn squares(&self) -> [u32; 2] {
        match self {
            Self::Chessboard { squares, .. } | Self::Charuco { squares, .. } => *squares,
        }
    }

    fn square_m(&self) -> f64 {
        match self {
            Self::Chessboard { square_m, .. } | Self::Charuco { square_m, .. } => *square_m,
        }
    }
}

impl BoardFinder {
    /// A finder of this board.
    ///
    /// # Errors
    /// [`CalibrateError::Board`] where there is no such board.
    pub fn new(board: Board) -> Result<Self, CalibrateError> {
        if !board.squares().iter().all(|count| (3..=100).contains(count)) {
            let [columns, rows] = board.squares();
            return Err(wrong(
                "the number of squares",
                format!("{columns} x {rows}"),
                "3 to 100 each are allowed; squares are counted, not inner corners",
            ));
        }
        let square_m = board.square_m();
        if !(square_m > 0.0 && square_m <= 10.0) {
            return Err(wrong("the side of a square", square_m, "metres above 0 to 10"));
        }
        let kind = match &board {
            Board::Chessboard { .. } => Kind::Chessboard(
                ChessboardDetector::new(ChessboardParams::default())
                    .map_err(|error| wrong("the chessboard", error, "this version cannot look for it"))?,
            ),
            Board::Charuco {
                squares: [columns, rows],
                marker_m,
                dictionary,
                ..
            } => {
                if !(*marker_m > 0.0 && *marker_m < square_m) {
                    return Err(wrong(
                        "the side of a marker",
                        marker_m,
                        "metres above 0, below the side of a square",
                    ));
                }
                let known = resolve_dictionary(dictionary).ok_or_else(|| {
                    wrong(
                        "the dictionary",
                        dictionary,
                        "names are OpenCV's: DICT_4X4_50 to DICT_7X7_1000, DICT_ARUCO_ORIGINAL, DICT_APRILTAG_16h5, \
                         DICT_APRILTAG_25h9, DICT_APRILTAG_36h10, DICT_APRILTAG_36h11",
                    )
                })?;
                let relative = (marker_m / square_m) as f32;
                let specification = CharucoBoardSpec::new(*rows, *columns, square_m as f32, relative, known);
                let detector = CharucoDetector::new(CharucoParams::for_board(specification));
                Kind::Charuco(Box::new(detector.map_err(|error| {
                    wrong("the ChArUco board", error, "give a board that OpenCV can print")
                })?))
            }
        };
        Ok(Self { board, kind })
    }

    /// The corners in a picture; none where the board is not seen, or so little of it that it does not count.
    pub fn find(&self, picture: GrayView<'_>) -> Option<BoardView> {
        let image = GrayImageView {
            width: picture.width,
            height: picture.height,
            data: picture.data,
        };
        // Places in grids of 32-bit integers; a corner outside of the board is something else.
        let [columns, rows] = self.board.squares().map(|count| count as i32 - 1);
        let mut corners: Vec<(i32, i32, Point2<f32>)> = Vec::new();
        match &self.kind {
            Kind::Chessboard(detector) => {
                let frame = detect_corner_frame(&image, &calib_targets_chessboard::default_chess_config());
                let found = detector.detect(&frame.corners)?;
                let all = found.corners.iter();
                corners.extend(all.map(|corner| (corner.grid.u, corner.grid.v, corner.position)));
                let most =
                    |axis: fn(&(i32, i32, Point2<f32>)) -> i32| corners.iter().map(axis).max().unwrap_or(0);
                let [width, height] = [most(|corner| corner.0) + 1, most(|corner| corner.1) + 1];
                // Seen turned by a quarter its rows are columns; a larger grid is another board.
                let fits = |across: i32, down: i32| width <= across && height <= down;
                if !(fits(columns, rows) || fits(rows, columns)) {
                    return None;
                }
            }
            Kind::Charuco(detector) => {
                let found = detector.detect(&image).ok()?;
                let all = found.corners.iter();
                corners.extend(all.map(|corner| (corner.grid.u, corner.grid.v, corner.position)));
            }
        }
        if corners.len() < LEAST_CORNERS {
            return None;
        }
        let square_m = self.board.square_m();
        let spacing_px = spacing(&corners);
        let reach = match &self.board {
            Board::Chessboard { .. } => 0.35,
            // The nearest markers begin half of what a square is larger than a marker away.
            Board::Charuco { marker_m, .. } => 0.5 * (1.0 - marker_m / square_m),
        };
        let half = ((reach * spacing_px).round() as i32).clamp(2, 5);
        let mut view = BoardView::default();
        for (column, row, position) in corners {
            view.board_m
                .push([f64::from(column) * square_m, f64::from(row) * square_m]);
            let rough = DistortedPixel::new(position.x.into(), position.y.into());
            view.pixels.push(refine(picture, rough, half));
        }
        Some(view)
    }
}

/// The least distance of neighbours on the board, pixels.
fn spacing(corners: &[(i32, i32, Point2<f32>)]) -> f64 {
    let mut least = f64::INFINITY;
    for (place, one) in corners.iter().enumerate() {
        for other in &corners[place + 1..] {
            if (one.0 - other.0).abs() + (one.1 - other.1).abs() == 1 {
                least = least.min((one.2 - other.2).norm().into());
            }
        }
    }
    if least.is_finite() { least } else { 0.0 }
}

/// Steps of the refinement, and the change in pixels at which it is good enough.
const STEPS: usize = 40;
const ENOUGH_PX: f64 = 1e-3;

/// Where a corner is to a few hundredths of a pixel: the point to which all gradients around it are at right angles (as
/// OpenCV's `cornerSubPix`), in a window of `half` pixels to each side. Where that leads away the corner stays.
fn refine(picture: GrayView<'_>, rough: DistortedPixel, half: i32) -> DistortedPixel {
    let mut at = Vector2::new(rough.u, rough.v);
    let grey = |u: f64, v: f64| -> Option<f64> {
        let (column, row) = (u.floor(), v.floor());
        let inside = column >= 0.0
            && row >= 0.0
            && column + 1.0 < picture.width as f64
            && row + 1.0 < picture.height as f64;
        if !inside {
            return None;
        }
        let (x, y) = (u - column, v - row);
        let place = row as usize * picture.width + column as usize;
        let value = |offset: usize| f64::from(picture.data[place + offset]);
        let above = value(0) * (1.0 - x) + value(1) * x;
        let below = value(picture.width) * (1.0 - x) + value(picture.width + 1) * x;
        Some(above * (1.0 - y) + below * y)
    };
    for _ in 0..STEPS {
        let (mut square, mut side) = (Matrix2::zeros(), Vector2::zeros());
        for row in -half..=half {
            for column in -half..=half {
                let offset = Vector2::new(f64::from(column), f64::from(row));
                let (u, v) = (at.x + offset.x, at.y + offset.y);
                let ends = (
                    grey(u + 1.0, v),
                    grey(u - 1.0, v),
                    grey(u, v + 1.0),
                    grey(u, v - 1.0),
                );
                let (Some(right), Some(left), Some(down), Some(up)) = ends else {
                    return rough;
                };
                let weight = (-(offset / f64::from(half)).norm_squared()).exp();
                let gradient = Vector2::new(right - left, down - up);
                let product = gradient * gradient.transpose() * weight;
                square += product;
                side += product * offset;
            }
        }
        let Some(step) = square.try_inverse().map(|inverse| inverse * side) else {
            return rough;
        };
        at += step;
        let away = (at - Vector2::new(rough.u, rough.v)).norm();
        // Not a number is no corner either.
        if away.is_nan() || away > f64::from(half) {
            return rough;
        }
        if step.norm() < ENOUGH_PX {
            break;
        }
    }
    DistortedPixel::new(at.x, at.y)
}
