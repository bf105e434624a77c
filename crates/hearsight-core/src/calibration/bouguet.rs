//! Parameters of Bouguet's Camera Calibration Toolbox as JSON (or YAML), in two forms.
//!
//! 1. As the AV16.3 corpus gives them: a list `cam` of `{P, K, kc}` and one `align_mat` for all (identity where it is
//!    missing). A world point X, metres, homogeneous, has the ideal pixel P · align_mat⁻¹ · X; `K` is undone, `kc`
//!    applied, `K` redone. P is K \[R | t\] times a factor and `align_mat` rotates, shifts and scales (by 0.99926 in
//!    AV16.3). The factors cancel in every pixel, so K⁻¹ · P · align_mat⁻¹, divided by its own factor, is a rigid pose
//!    with the very same pixels.
//! 2. Plain, with the toolbox's own names: `fc`, `cc`, `kc`, optional `alpha_c` (0), `nx`, `ny`, and `Rc` or `omc` with
//!    `Tc`; for several cameras a list of such tables under `cam`.
//!
//! Pixels count from 0, as in the toolbox's documentation and here. On sequence 30 of AV16.3, whose two-dimensional
//! truth is independent of Matlab's counting from 1, an offset of 0 fits best: the median distances in the three
//! cameras are 1.54, 1.06 and 1.21 px, with an offset of -1 px 2.31, 1.59 and 1.93, of +1 px 1.74, 1.95 and 1.81.

use super::node::Node;
use super::rotation::{pose, pose_of_similarity, rotation, rotation_of_vector};
use super::{Calibration, CalibrationError, CalibrationFormat, choose, intrinsics};
use crate::camera::{CameraModel, Pinhole, PinholeParameters};
use crate::geometry::Pose;
use nalgebra::{Matrix3, Matrix3x4, Matrix4};

const CAMERAS: &[&str] = &["cam", "cams", "camera", "cameras"];
const FOCAL: &[&str] = &["fc"];

/// This format's registration.
pub(super) const FORMAT: CalibrationFormat = CalibrationFormat {
    name: "bouguet",
    meaning: "Parameters of Bouguet's Camera Calibration Toolbox, also as in the AV16.3 corpus.",
    fields: &[
        "cam: list of cameras; without it the file is one camera",
        "align_mat: 4x4, world from calibration frame, a similarity; default identity",
        "P: 3x4, projection in the calibration frame, any factor",
        "K: 3x3, camera matrix, pixels",
        "fc, cc: focal lengths and principal point, pixels, where there is no K",
        "kc: k1, k2, p1, p2 and optionally k3",
        "alpha_c: skew, must be 0 (default)",
        "nx, ny: width and height of the picture, pixels; default unknown",
        "Rc or omc, Tc: rotation (3x3 or vector) and translation (metres), camera from world, where there is no P",
    ],
    recognizes: |root| {
        let Some(cameras) = root.find(CAMERAS) else {
            return is_camera(root);
        };
        cameras
            .items()
            .is_ok_and(|cameras| cameras.first().is_some_and(is_camera))
    },
    read,
};

fn is_camera(node: &Node<'_>) -> bool {
    node.get("kc").is_some() && (node.get("fc").is_some() || node.get("K").is_some())
}

fn read(root: &Node<'_>, index: usize) -> Result<Calibration, CalibrationError> {
    let cameras = root
        .find(CAMERAS)
        .map_or_else(|| Ok(vec![root.clone()]), |cameras| cameras.items())?;
    let camera = choose(root, cameras, index)?;
    let (focal_px, centre_px) = lens_matrix(&camera)?;
    let distortion = camera.require(&["kc"])?;
    let numbers = distortion.numbers()?;
    let (radial, tangential) = match numbers[..] {
        [k1, k2, p1, p2] => ([k1, k2, 0.0], [p1, p2]),
        [k1, k2, p1, p2, k3] => ([k1, k2, k3], [p1, p2]),
        _ => return Err(distortion.invalid("it must be k1, k2, p1, p2 and optionally k3")),
    };
    let lens = Pinhole::new(PinholeParameters {
        focal_px,
        centre_px,
        radial,
        tangential,
    })
    .map_err(|error| CalibrationError::from_parameter(camera.file, &camera.path, error))?;
    let pose = match camera.get("P") {
        Some(projection) => Some(pose_of_projection(&projection, root, focal_px, centre_px)?),
        None => extrinsics(&camera)?,
    };
    let size = match (camera.find(&["nx", "width"]), camera.find(&["ny", "height"])) {
        (None, None) => None,
        _ => Some([
            camera.require(&["nx", "width"])?.count()?,
            camera.require(&["ny", "height"])?.count()?,
        ]),
    };
    let name = camera
        .get("name")
        .map(|name| name.text().map(str::to_owned))
        .transpose()?;
    Ok(Calibration {
        file: root.file.to_owned(),
        name,
        model: CameraModel::Pinhole(lens),
        pose,
        size,
    })
}

fn lens_matrix(camera: &Node<'_>) -> Result<([f64; 2], [f64; 2]), CalibrationError> {
    if let Some(skew) = camera.get("alpha_c")
        && skew.number()?.abs() > 1e-6
    {
        return Err(skew.invalid("skew is not supported; calibrate with est_alpha = 0"));
    }
    if camera.get("K").is_some() || camera.find(FOCAL).is_none() {
        return intrinsics(&camera.require(&["K", "KK", "fc"])?);
    }
    let focal = camera.require(FOCAL)?;
    let values = focal.vector::<2>()?;
    if values.iter().any(|value| *value <= 0.0) {
        return Err(focal.invalid("focal lengths must be positive; calibrate again"));
    }
    Ok((values.into(), camera.require(&["cc"])?.vector::<2>()?.into()))
}

/// The rigid pose with the pixels of K⁻¹ · P · align⁻¹.
fn pose_of_projection(
    projection: &Node<'_>,
    root: &Node<'_>,
    focal: [f64; 2],
    centre: [f64; 2],
) -> Result<Pose, CalibrationError> {
    let matrix: Matrix3x4<f64> = projection.matrix::<3, 4>()?;
    // K⁻¹, exact for a matrix without skew.
    let undo_k = Matrix3::new(
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
    let undo_alignment = match root.get("align_mat") {
        None => Matrix4::identity(),
        Some(node) => {
            let alignment = node.matrix::<4, 4>()?;
            if alignment.row(3) != Matrix4::identity().row(3) {
                return Err(node.invalid("its last row must be 0, 0, 0, 1"));
            }
            // Checked for itself, so that the error falls on it and not on P.
            let linear = alignment.fixed_view::<3, 3>(0, 0).into_owned();
            pose_of_similarity(linear, alignment.fixed_view::<3, 1>(0, 3).into_owned())
                .map_err(|reason| node.invalid(reason))?;
            alignment
                .try_inverse()
                .ok_or_else(|| node.invalid("it must have an inverse"))?
        }
    };
    let whole = undo_k * matrix * undo_alignment;
    pose_of_similarity(
        whole.fixed_view::<3, 3>(0, 0).into_owned(),
        whole.column(3).into_owned(),
    )
    .map_err(|reason| projection.invalid(reason))
}

fn extrinsics(camera: &Node<'_>) -> Result<Option<Pose>, CalibrationError> {
    let matrix = camera.find(&["Rc", "Rc_ext", "R"]);
    let vector = camera.find(&["omc", "omc_ext", "om"]);
    let names = ["Tc", "Tc_ext", "T"];
    if matrix.is_none() && vector.is_none() && camera.find(&names).is_none() {
        return Ok(None);
    }
    let translation = camera.require(&names)?.vector::<3>()?;
    let turn = match matrix {
        Some(node) => rotation(node.matrix::<3, 3>()?).map_err(|reason| node.invalid(reason))?,
        None => {
            let node = camera.require(&["omc", "omc_ext", "om", "Rc"])?;
            rotation_of_vector(node.vector::<3>()?).map_err(|reason| node.invalid(reason))?
        }
    };
    Ok(Some(pose(turn, translation)))
}
