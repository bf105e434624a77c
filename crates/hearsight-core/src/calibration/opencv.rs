//! What OpenCV's FileStorage writes (YAML or JSON), what its samples and ROS write, and what people dump from Python.
//!
//! Fields go by several names, of which capitals and `_` do not count. A stereo file numbers its fields from 1 (`K1`,
//! `D2`): camera `index` is number `index` + 1 then. Four coefficients are k1, k2, p1, p2 unless the file says that the
//! lens is a fisheye; more than five are refused unless the rest are zero, because nothing here computes them.
//! `R`, `T` or `rvec`, `tvec` map the world into the camera; in a stereo file they map camera 1 into camera 2.

use super::node::Node;
use super::rotation::{pose, rotation, rotation_of_vector};
use super::{Calibration, CalibrationError, CalibrationFormat, intrinsics};
use crate::camera::{CameraModel, Fisheye, FisheyeParameters, Pinhole, PinholeParameters};
use crate::geometry::Pose;

const MATRIX: &[&str] = &["camera_matrix", "K", "M", "intrinsic_matrix", "intrinsics", "mtx"];
const DISTORTION: &[&str] = &[
    "distortion_coefficients",
    "D",
    "dist_coeffs",
    "distortion_coeffs",
    "dist_coefs",
    "distortion",
    "dist",
];
const ROTATION: &[&str] = &["R", "rotation_matrix", "rotation", "rvec", "rotation_vector"];
const TRANSLATION: &[&str] = &["T", "tvec", "translation", "translation_vector"];
const EXTRINSICS: &[&str] = &["extrinsic_matrix", "extrinsics", "camera_from_world"];
const LENS: &[&str] = &["distortion_model", "camera_model", "model"];

/// This format's registration.
pub(super) const FORMAT: CalibrationFormat = CalibrationFormat {
    name: "opencv",
    meaning: "OpenCV's FileStorage in YAML or JSON, and ROS camera_info files.",
    fields: &[
        "camera_matrix (K, cameraMatrix, M, mtx): 3x3, pixels",
        "distortion_coefficients (D, distCoeffs): k1, k2, p1, p2 and optionally k3; of a fisheye k1 to k4",
        "image_width, image_height, or image_size: pixels; default unknown",
        "distortion_model: plumb_bob (default), or equidistant or fisheye; or fisheye_model: 1",
        "R (rvec) and T (tvec), or extrinsic_matrix (3x4 or 4x4): camera from world, metres; default no pose",
    ],
    recognizes: |root| root.find(MATRIX).is_some() || numbered(root, MATRIX, 0).is_some(),
    read,
};

/// The field of the camera with this index in a stereo file.
fn numbered<'a>(root: &Node<'a>, names: &[&str], index: usize) -> Option<Node<'a>> {
    let names: Vec<String> = names.iter().map(|name| format!("{name}{}", index + 1)).collect();
    root.find(&names.iter().map(String::as_str).collect::<Vec<_>>())
}

fn read(root: &Node<'_>, index: usize) -> Result<Calibration, CalibrationError> {
    let stereo = root.find(MATRIX).is_none() && numbered(root, MATRIX, 0).is_some();
    let count = if stereo {
        1 + usize::from(numbered(root, MATRIX, 1).is_some())
    } else {
        1
    };
    if index >= count {
        return Err(CalibrationError::NoSuchCamera {
            file: root.file.to_owned(),
            index,
            count,
        });
    }
    let field = |names: &[&str]| {
        let found = if stereo {
            numbered(root, names, index)
        } else {
            None
        };
        found.map_or_else(|| root.require(names), Ok)
    };
    let (focal_px, centre_px) = intrinsics(&field(MATRIX)?)?;
    let distortion = field(DISTORTION)?;
    let model = if is_fisheye(root)? {
        let radial = distortion.vector::<4>()?.into();
        Fisheye::new(FisheyeParameters {
            focal_px,
            centre_px,
            radial,
        })
        .map(CameraModel::Fisheye)
    } else {
        let (radial, tangential) = brown_conrady(&distortion)?;
        Pinhole::new(PinholeParameters {
            focal_px,
            centre_px,
            radial,
            tangential,
        })
        .map(CameraModel::Pinhole)
    }
    .map_err(|error| CalibrationError::from_parameter(root.file, &root.path, error))?;
    let pose = if stereo && index == 0 {
        Some(Pose::identity())
    } else {
        extrinsics(root)?
    };
    let name = root
        .get("camera_name")
        .map(|name| name.text().map(str::to_owned))
        .transpose()?;
    Ok(Calibration {
        file: root.file.to_owned(),
        name,
        model,
        pose,
        size: size(root)?,
    })
}

fn is_fisheye(root: &Node<'_>) -> Result<bool, CalibrationError> {
    if let Some(flag) = root.find(&["fisheye_model", "fisheye"]) {
        return match flag
            .value
            .as_bool()
            .or_else(|| flag.value.as_f64().map(|number| number != 0.0))
        {
            Some(fisheye) => Ok(fisheye),
            None => Err(flag.invalid("it must be 0 or 1")),
        };
    }
    let Some(model) = root.find(LENS) else {
        return Ok(false);
    };
    match model.text()?.to_ascii_lowercase().as_str() {
        "plumb_bob" | "rational_polynomial" | "pinhole" | "radtan" | "brown_conrady" => Ok(false),
        "equidistant" | "fisheye" | "kannala_brandt" => Ok(true),
        _ => Err(model.invalid("known are plumb_bob, rational_polynomial, equidistant and fisheye")),
    }
}

fn brown_conrady(node: &Node<'_>) -> Result<([f64; 3], [f64; 2]), CalibrationError> {
    let numbers = node.numbers()?;
    let at = |index: usize| numbers.get(index).copied().unwrap_or(0.0);
    if !matches!(numbers.len(), 4 | 5 | 8 | 12 | 14) {
        return Err(node.invalid(format!(
            "it must be k1, k2, p1, p2 and optionally k3, not {} numbers; for no distortion write zeros",
            numbers.len()
        )));
    }
    if numbers.iter().skip(5).any(|coefficient| *coefficient != 0.0) {
        return Err(node.invalid(
            "only k1, k2, p1, p2, k3 are supported; calibrate without CALIB_RATIONAL_MODEL, _THIN_PRISM and _TILTED",
        ));
    }
    Ok(([at(0), at(1), at(4)], [at(2), at(3)]))
}

fn size(root: &Node<'_>) -> Result<Option<[usize; 2]>, CalibrationError> {
    if let Some(size) = root.find(&["image_size", "img_size", "resolution"]) {
        let both = size.items()?;
        return match &both[..] {
            [width, height] => Ok(Some([width.count()?, height.count()?])),
            _ => Err(size.invalid("it must be [width, height]")),
        };
    }
    let (width, height) = (["image_width", "width"], ["image_height", "height"]);
    if root.find(&width).is_none() && root.find(&height).is_none() {
        return Ok(None);
    }
    Ok(Some([
        root.require(&width)?.count()?,
        root.require(&height)?.count()?,
    ]))
}

fn extrinsics(root: &Node<'_>) -> Result<Option<Pose>, CalibrationError> {
    if let Some(node) = root.find(EXTRINSICS) {
        let matrix = node.matrix::<3, 4>().or_else(|error| {
            let four = node.matrix::<4, 4>().map_err(|_| error)?;
            if four[(3, 0)] == 0.0 && four[(3, 1)] == 0.0 && four[(3, 2)] == 0.0 && four[(3, 3)] == 1.0 {
                return Ok(four.fixed_rows::<3>(0).into_owned());
            }
            Err(node.invalid("its last row must be 0, 0, 0, 1"))
        })?;
        let turn =
            rotation(matrix.fixed_view::<3, 3>(0, 0).into_owned()).map_err(|reason| node.invalid(reason))?;
        return Ok(Some(pose(turn, matrix.column(3).into_owned())));
    }
    // Beside a `P`, a lone `R` is the rectification of a ROS camera_info message, which is no pose.
    let rectification = root.get("P").is_some() && root.find(TRANSLATION).is_none();
    if rectification || (root.find(ROTATION).is_none() && root.find(TRANSLATION).is_none()) {
        return Ok(None);
    }
    let node = root.require(ROTATION)?;
    let translation = root.require(TRANSLATION)?.vector::<3>()?;
    let turn = match node.vector::<3>() {
        Ok(vector) => rotation_of_vector(vector),
        Err(_) => rotation(node.matrix::<3, 3>()?),
    }
    .map_err(|reason| node.invalid(reason))?;
    Ok(Some(pose(turn, translation)))
}
