//! The lens of a camera and where it is, from pictures of a flat board.
//!
//! Z. Zhang, "A flexible new technique for camera calibration", IEEE Trans. PAMI 22(11), 2000: homographies of the board
//! give a focal length, then all corners of all pictures together give lens, distortion and poses, by least squares of
//! their distances in pixels. The model is OpenCV's with k1, k2, p1, p2 and no k3.

use crate::board::BoardView;
use crate::error::CalibrateError;
use crate::least_squares::{Minimum, Problem, minimize};
use hearsight_core::camera::{Pinhole, PinholeParameters, Projection};
use hearsight_core::{CameraPoint, Pose};
use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3,
};

/// Pictures of a board that are needed.
pub const LEAST_VIEWS: usize = 4;
/// Unknowns of the lens: fx, fy, cx, cy, k1, k2, p1, p2.
const LENS: usize = 8;
/// Unknowns of a pose: an axis times an angle, a place.
const POSE: usize = 6;

/// A camera that was calibrated.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraCalibration {
    /// The lens.
    pub lens: Pinhole,
    /// Width and height of the pictures, pixels.
    pub size: [usize; 2],
    /// Root mean square distance of corners from where the lens puts them, pixels: OpenCV's reprojection error.
    pub rms_px: f64,
    /// The same of each picture.
    pub rms_of_views_px: Vec<f64>,
    /// Standard deviations of the focal lengths, pixels.
    pub focal_deviation_px: [f64; 2],
    /// Standard deviations of the principal point, pixels.
    pub centre_deviation_px: [f64; 2],
    /// Where the camera is in the frame of the board of each picture: x to the right, y down, z into the board.
    pub poses: Vec<Pose>,
}

/// Calibrates from the views of a board in pictures of one size; `pictures` is how many were looked at, with the board or
/// without.
///
/// # Errors
/// [`CalibrateError`] where the board is not seen often enough, or never tilted.
pub fn calibrate(
    views: &[BoardView],
    size: [usize; 2],
    pictures: usize,
) -> Result<CameraCalibration, CalibrateError> {
    if views.is_empty() {
        return Err(CalibrateError::NeverSeen { pictures });
    }
    if views.len() < LEAST_VIEWS {
        return Err(CalibrateError::TooFewViews {
            seen: views.len(),
            pictures,
            needed: LEAST_VIEWS,
        });
    }
    let centre = size.map(|side| (side as f64 - 1.0) / 2.0);
    let homographies: Vec<Matrix3<f64>> = views
        .iter()
        .map(|view| {
            homography(view).ok_or(CalibrateError::Singular("the corners of a picture lie on a line"))
        })
        .collect::<Result<_, _>>()?;
    let focal = focal_from(&homographies, centre).ok_or(CalibrateError::NotTilted)?;
    let mut start = DVector::zeros(LENS + POSE * views.len());
    start
        .rows_mut(0, 4)
        .copy_from_slice(&[focal[0], focal[1], centre[0], centre[1]]);
    for (number, homography) in homographies.iter().enumerate() {
        let pose = pose_from(homography, focal, centre)
            .ok_or(CalibrateError::Singular("a picture of the board has no pose"))?;
        start.rows_mut(LENS + POSE * number, POSE).copy_from_slice(&pose);
    }
    let bundle = Bundle { views };
    let Minimum { unknowns, covariance } =
        minimize(&bundle, start).ok_or(CalibrateError::Singular("the pictures contradict each other"))?;
    let corners: usize = views.iter().map(|view| view.pixels.len()).sum();
    let cost = 2.0 * bundle.cost(&unknowns);
    let freedom = (2 * corners).saturating_sub(unknowns.len()).max(1);
    let deviation = |at: usize| (covariance[(at, at)] * cost / freedom as f64).max(0.0).sqrt();
    let lens = lens_of(unknowns.as_slice()).ok_or(CalibrateError::Singular("the lens is impossible"))?;
    let focal_px = lens.parameters().focal_px;
    if deviation(0) > 0.05 * focal_px[0] || deviation(1) > 0.05 * focal_px[1] {
        return Err(CalibrateError::NotTilted);
    }
    let of_view = |number: usize, view: &BoardView| {
        let squares: f64 = bundle.squares(&lens, number, &unknowns);
        (squares / view.pixels.len().max(1) as f64).sqrt()
    };
    Ok(CameraCalibration {
        lens,
        size,
        rms_px: (cost / corners as f64).sqrt(),
        rms_of_views_px: views
            .iter()
            .enumerate()
            .map(|(number, view)| of_view(number, view))
            .collect(),
        focal_deviation_px: [deviation(0), deviation(1)],
        centre_deviation_px: [deviation(2), deviation(3)],
        poses: (0..views.len())
            .map(|number| Pose {
                sensor_from_world: isometry(pose_at(unknowns.as_slice(), number)),
            })
            .collect(),
    })
}

/// All corners of all pictures.
struct Bundle<'a> {
    views: &'a [BoardView],
}

fn lens_of(unknowns: &[f64]) -> Option<Pinhole> {
    let [fx, fy, cx, cy, k1, k2, p1, p2] = *unknowns.first_chunk()?;
    Pinhole::new(PinholeParameters {
        focal_px: [fx, fy],
        centre_px: [cx, cy],
        radial: [k1, k2, 0.0],
        tangential: [p1, p2],
    })
    .ok()
}

fn pose_at(unknowns: &[f64], view: usize) -> &[f64] {
    &unknowns[LENS + POSE * view..][..POSE]
}

fn isometry(pose: &[f64]) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(pose[0], pose[1], pose[2]));
    Isometry3::from_parts(Translation3::new(pose[3], pose[4], pose[5]), turn)
}

impl Bundle<'_> {
    /// Residuals of a picture, x and y of each corner in turn; none where a corner is not in front of the lens.
    fn residuals(&self, lens: &Pinhole, view: usize, pose: &[f64]) -> Option<Vec<f64>> {
        let camera_from_board = isometry(pose);
        let BoardView { board_m, pixels } = &self.views[view];
        let mut residuals = Vec::with_capacity(2 * pixels.len());
        for ([x, y], pixel) in board_m.iter().zip(pixels) {
            let point = CameraPoint(camera_from_board * Point3::new(*x, *y, 0.0));
            let seen = lens.project(point)?;
            residuals.extend([seen.u - pixel.u, seen.v - pixel.v]);
        }
        Some(residuals)
    }

    fn squares(&self, lens: &Pinhole, view: usize, unknowns: &DVector<f64>) -> f64 {
        self.residuals(lens, view, pose_at(unknowns.as_slice(), view))
            .map_or(f64::INFINITY, |residuals| {
                residuals.iter().map(|value| value * value).sum()
            })
    }

    /// Residuals of a picture and their derivatives by lens and pose, numerically: 2 corners x 14.
    fn linear(&self, unknowns: &DVector<f64>, view: usize) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let mut own: Vec<f64> = unknowns.as_slice()[..LENS].to_vec();
        own.extend_from_slice(pose_at(unknowns.as_slice(), view));
        let at = |own: &[f64]| self.residuals(&lens_of(own)?, view, &own[LENS..]);
        let here = DVector::from_vec(at(&own)?);
        let mut jacobian = DMatrix::zeros(here.len(), own.len());
        for column in 0..own.len() {
            let value = own[column];
            let step = 1e-6 * value.abs().max(1e-2);
            own[column] = value + step;
            let above = at(&own)?;
            own[column] = value - step;
            let below = at(&own)?;
            own[column] = value;
            for (row, (above, below)) in above.iter().zip(&below).enumerate() {
                jacobian[(row, column)] = (above - below) / (2.0 * step);
            }
        }
        Some((here, jacobian))
    }
}

impl Problem for Bundle<'_> {
    fn cost(&self, unknowns: &DVector<f64>) -> f64 {
        let Some(lens) = lens_of(unknowns.as_slice()) else {
            return f64::INFINITY;
        };
        let views = 0..self.views.len();
        0.5 * views.map(|view| self.squares(&lens, view, unknowns)).sum::<f64>()
    }

    fn normal(&self, unknowns: &DVector<f64>, matrix: &mut DMatrix<f64>, side: &mut DVector<f64>) {
        for view in 0..self.views.len() {
            let Some((residuals, jacobian)) = self.linear(unknowns, view) else {
                continue;
            };
            let (square, product) = (jacobian.tr_mul(&jacobian), jacobian.tr_mul(&residuals));
            let place = |own: usize| if own < LENS { own } else { own + POSE * view };
            for row in 0..LENS + POSE {
                side[place(row)] += product[row];
                for column in 0..LENS + POSE {
                    matrix[(place(row), place(column))] += square[(row, column)];
                }
            }
        }
    }
}

/// The homography from the board to the picture, by the direct linear transform of scaled points.
fn homography(view: &BoardView) -> Option<Matrix3<f64>> {
    let board = scaling(view.board_m.iter().copied())?;
    let picture = scaling(view.pixels.iter().map(|pixel| [pixel.u, pixel.v]))?;
    let mut square = DMatrix::<f64>::zeros(9, 9);
    for (place, pixel) in view.board_m.iter().zip(&view.pixels) {
        let p = board * Vector3::new(place[0], place[1], 1.0);
        let q = picture * Vector3::new(pixel.u, pixel.v, 1.0);
        for row in [
            [p.x, p.y, 1.0, 0.0, 0.0, 0.0, -q.x * p.x, -q.x * p.y, -q.x],
            [0.0, 0.0, 0.0, p.x, p.y, 1.0, -q.y * p.x, -q.y * p.y, -q.y],
        ] {
            for (i, one) in row.iter().enumerate() {
                for (j, other) in row.iter().enumerate() {
                    square[(i, j)] += one * other;
                }
            }
        }
    }
    let eigen = square.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    let solution = Matrix3::from_row_slice(eigen.eigenvectors.column(least).as_slice());
    let found = picture.try_inverse()? * solution * board;
    found.iter().all(|value| value.is_finite()).then_some(found)
}

/// Moves points to the origin and scales them to a mean distance of the root of two.
fn scaling(points: impl Iterator<Item = [f64; 2]> + Clone) -> Option<Matrix3<f64>> {
    let count = points.clone().count() as f64;
    let [x, y] = [0, 1].map(|axis| points.clone().map(|point| point[axis]).sum::<f64>() / count);
    let distance = points.map(|[u, v]| (u - x).hypot(v - y)).sum::<f64>() / count;
    let scale = std::f64::consts::SQRT_2 / distance;
    scale
        .is_finite()
        .then(|| Matrix3::new(scale, 0.0, -scale * x, 0.0, scale, -scale * y, 0.0, 0.0, 1.0))
}

/// Focal lengths from homographies, the principal point being in the middle of the picture: the images of the board's axes
/// are at right angles and of one length (Zhang, eqs. 3 and 4).
fn focal_from(homographies: &[Matrix3<f64>], centre: [f64; 2]) -> Option<[f64; 2]> {
    let to_centre = Matrix3::new(1.0, 0.0, -centre[0], 0.0, 1.0, -centre[1], 0.0, 0.0, 1.0);
    let (mut square, mut side) = (nalgebra::Matrix2::zeros(), nalgebra::Vector2::zeros());
    for homography in homographies {
        let h = to_centre * homography;
        let (first, second) = (h.column(0).into_owned(), h.column(1).into_owned());
        let scale = 1.0 / (first.norm() * second.norm());
        for (row, right) in [
            ([first.x * second.x, first.y * second.y], -first.z * second.z),
            (
                [
                    first.x.powi(2) - second.x.powi(2),
                    first.y.powi(2) - second.y.powi(2),
                ],
                second.z.powi(2) - first.z.powi(2),
            ),
        ] {
            let row = nalgebra::Vector2::from(row) * scale;
            square += row * row.transpose();
            side += row * right * scale;
        }
    }
    let solution = square.try_inverse()? * side;
    let focal = [solution.x, solution.y].map(|inverse| (1.0 / inverse).sqrt());
    let usual = 2.0 * (centre[0] + centre[1]);
    // Not a number where an inverse is negative.
    focal
        .iter()
        .all(|value| (0.05 * usual..=50.0 * usual).contains(value))
        .then_some(focal)
}

/// The pose of a board from its homography, as unknowns.
fn pose_from(homography: &Matrix3<f64>, focal: [f64; 2], centre: [f64; 2]) -> Option<[f64; POSE]> {
    let inverse = Matrix3::new(
        1.0 / focal[0],
        0.0,
        -centre[0] / focal[0],
        0.0,
        1.0 / focal[1],
        -centre[1] / focal[1],
        0.0,
        0.0,
        1.0,
    );
    let mut h = inverse * homography;
    h *= 2.0 / (h.column(0).norm() + h.column(1).norm());
    if h[(2, 2)] < 0.0 {
        h = -h;
    }
    let (first, second, place) = (
        h.column(0).into_owned(),
        h.column(1).into_owned(),
        h.column(2).into_owned(),
    );
    let rough = Matrix3::from_columns(&[first, second, first.cross(&second)]);
    let parts = rough.svd(true, true);
    let turn = Rotation3::from_matrix_unchecked(parts.u? * parts.v_t?).scaled_axis();
    let pose = [turn.x, turn.y, turn.z, place.x, place.y, place.z];
    pose.iter().all(|value| value.is_finite()).then_some(pose)
}
