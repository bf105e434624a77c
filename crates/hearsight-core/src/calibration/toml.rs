//! Our own format, made to be written by hand: one `[[camera]]` table a camera.
//!
//! ```toml
//! [[camera]]
//! name = "door"                     # optional
//! model = "pinhole"                 # pinhole, fisheye or panorama
//! width = 1280                      # pixels, optional with height
//! height = 720
//! focal_px = [905.2, 904.1]         # fx, fy; of a panorama one number, rows for a height equal to the radius
//! centre_px = [641.0, 358.7]        # cx, cy; (0, 0) is the centre of the top-left pixel
//! distortion = [-0.31, 0.12, 0.001, -0.002, 0.0]  # k1 k2 p1 p2 k3; fisheye k1 k2 k3 k4; default none
//! position_m = [1.9, -3.0, 1.4]     # where the camera is; optional, with one of the next two
//! look_at_m = [0.0, 0.0, 1.0]       # a point in the middle of the picture; the camera stands upright
//! # rotation = [[...], [...], [...]]  # 3x3 instead: rows are the camera's right, down and forward in the world
//! # columns_per_turn = 2880         # of a panorama: columns for 360 degrees; default its width
//! ```
//!
//! Unknown fields are errors, so that a misspelt one is never silently ignored.

use super::node::Node;
use super::rotation::{pose, rotation};
use super::{Calibration, CalibrationError, CalibrationFormat, choose};
use crate::camera::{
    CameraModel, Fisheye, FisheyeParameters, Panorama, PanoramaParameters, Pinhole, PinholeParameters,
};
use crate::geometry::{Pose, WorldPoint};
use nalgebra::Point3;

const FIELDS: &[&str] = &[
    "name",
    "model",
    "width",
    "height",
    "focal_px",
    "centre_px",
    "distortion",
    "position_m",
    "look_at_m",
    "rotation",
    "columns_per_turn",
];

/// This format's registration.
pub(super) const FORMAT: CalibrationFormat = CalibrationFormat {
    name: "hearsight",
    meaning: "Our own TOML, made to be written by hand: a [[camera]] table for each camera.",
    fields: &[
        "name: text; default none",
        "model: pinhole, fisheye or panorama",
        "width, height: picture size, pixels; default unknown",
        "focal_px: [fx, fy], pixels; of a panorama one number, rows for a height equal to the radius",
        "centre_px: [cx, cy], pixels, (0, 0) is the centre of the top-left pixel",
        "distortion: k1, k2, p1, p2, k3 of a pinhole, k1 to k4 of a fisheye; default zeros",
        "position_m: where the camera is, metres; default no pose",
        "look_at_m: a point straight ahead, metres",
        "rotation: 3x3, rows are the camera's right, down and forward in the world; instead of look_at_m",
        "columns_per_turn: of a panorama, columns for 360 degrees; default its width",
    ],
    recognizes: |root| {
        let cameras = root.get("camera").and_then(|cameras| cameras.items().ok());
        cameras.is_some_and(|cameras| cameras.first().is_some_and(|camera| camera.get("kc").is_none()))
    },
    read,
};

fn read(root: &Node<'_>, index: usize) -> Result<Calibration, CalibrationError> {
    root.refuse_unknown(&["camera"])?;
    let camera = choose(root, root.require(&["camera"])?.items()?, index)?;
    camera.refuse_unknown(FIELDS)?;
    let size = match (camera.get("width"), camera.get("height")) {
        (None, None) => None,
        _ => Some([
            camera.require(&["width"])?.count()?,
            camera.require(&["height"])?.count()?,
        ]),
    };
    let name = camera
        .get("name")
        .map(|name| name.text().map(str::to_owned))
        .transpose()?;
    Ok(Calibration {
        file: root.file.to_owned(),
        name,
        model: lens(&camera, size)?,
        pose: placement(&camera)?,
        size,
    })
}

fn lens(camera: &Node<'_>, size: Option<[usize; 2]>) -> Result<CameraModel, CalibrationError> {
    let model = camera.require(&["model"])?;
    let focal = camera.require(&["focal_px"])?;
    let centre_px = camera.require(&["centre_px"])?.vector::<2>()?.into();
    let distortion = camera.get("distortion");
    let only = |field: &str| match camera.get(field) {
        Some(node) => Err(node.invalid(format!("a camera of this model has no `{field}`; leave it out"))),
        None => Ok(()),
    };
    match model.text()? {
        "pinhole" => {
            only("columns_per_turn")?;
            let [k1, k2, p1, p2, k3] = match distortion {
                Some(node) => node.vector::<5>()?.into(),
                None => [0.0; 5],
            };
            let focal_px = focal.vector::<2>()?.into();
            Pinhole::new(PinholeParameters {
                focal_px,
                centre_px,
                radial: [k1, k2, k3],
                tangential: [p1, p2],
            })
            .map(CameraModel::Pinhole)
        }
        "fisheye" => {
            only("columns_per_turn")?;
            let radial = match distortion {
                Some(node) => node.vector::<4>()?.into(),
                None => [0.0; 4],
            };
            let focal_px = focal.vector::<2>()?.into();
            Fisheye::new(FisheyeParameters {
                focal_px,
                centre_px,
                radial,
            })
            .map(CameraModel::Fisheye)
        }
        "panorama" => {
            only("distortion")?;
            let columns_per_turn = match (camera.get("columns_per_turn"), size) {
                (None, Some([width, _])) => width as f64,
                _ => camera.require(&["columns_per_turn", "width"])?.number()?,
            };
            Panorama::new(PanoramaParameters {
                columns_per_turn,
                focal_px: focal.number()?,
                centre_px,
            })
            .map(CameraModel::Panorama)
        }
        _ => return Err(model.invalid("known are pinhole, fisheye and panorama")),
    }
    .map_err(|error| CalibrationError::from_parameter(camera.file, &camera.path, error))
}

fn placement(camera: &Node<'_>) -> Result<Option<Pose>, CalibrationError> {
    let point = |node: &Node<'_>| node.vector::<3>().map(|vector| WorldPoint(Point3::from(vector)));
    let (look_at, turn) = (camera.get("look_at_m"), camera.get("rotation"));
    if camera.get("position_m").is_none() && look_at.is_none() && turn.is_none() {
        return Ok(None);
    }
    let position = point(&camera.require(&["position_m"])?)?;
    match (look_at, turn) {
        (Some(_), Some(turn)) => Err(turn.invalid("give either `look_at_m` or `rotation`, not both")),
        (Some(look_at), None) => Pose::looking_at(position, point(&look_at)?)
            .map(Some)
            .ok_or_else(|| {
                look_at.invalid("it must be another place than `position_m`, at a finite distance")
            }),
        (None, Some(node)) => {
            let turn = rotation(node.matrix::<3, 3>()?).map_err(|reason| node.invalid(reason))?;
            Ok(Some(pose(turn, -(turn * position.0.coords))))
        }
        (None, None) => camera.require(&["look_at_m", "rotation"]).map(|_| None),
    }
}

/// Writes calibrations in our own format; reading them back gives the same cameras to rounding.
pub fn to_toml(calibrations: &[Calibration]) -> String {
    calibrations
        .iter()
        .map(camera_table)
        .collect::<Vec<_>>()
        .join("\n")
}

fn camera_table(calibration: &Calibration) -> String {
    let mut text = String::from("[[camera]]\n");
    let mut add = |field: &str, value: String| text.push_str(&format!("{field} = {value}\n"));
    if let Some(name) = &calibration.name {
        add("name", ::toml::Value::String(name.clone()).to_string());
    }
    let (model, focal, centre, distortion) = match calibration.model {
        CameraModel::Pinhole(lens) => {
            let PinholeParameters {
                focal_px,
                centre_px,
                radial: [k1, k2, k3],
                tangential: [p1, p2],
            } = lens.parameters();
            (
                "pinhole",
                format!("{focal_px:?}"),
                centre_px.to_owned(),
                Some(vec![*k1, *k2, *p1, *p2, *k3]),
            )
        }
        CameraModel::Fisheye(lens) => {
            let FisheyeParameters {
                focal_px,
                centre_px,
                radial,
            } = lens.parameters();
            (
                "fisheye",
                format!("{focal_px:?}"),
                centre_px.to_owned(),
                Some(radial.to_vec()),
            )
        }
        CameraModel::Panorama(lens) => {
            let PanoramaParameters {
                columns_per_turn,
                focal_px,
                centre_px,
            } = lens.parameters();
            add("columns_per_turn", format!("{columns_per_turn:?}"));
            ("panorama", format!("{focal_px:?}"), centre_px.to_owned(), None)
        }
    };
    add("model", format!("\"{model}\""));
    if let Some([width, height]) = calibration.size {
        add("width", width.to_string());
        add("height", height.to_string());
    }
    add("focal_px", focal);
    add("centre_px", format!("{centre:?}"));
    if let Some(distortion) = distortion {
        add("distortion", format!("{distortion:?}"));
    }
    if let Some(pose) = calibration.pose {
        add("position_m", format!("{:?}", pose.centre().0.coords.as_slice()));
        let matrix = pose.sensor_from_world.rotation.to_rotation_matrix();
        let rows: Vec<[f64; 3]> = matrix
            .matrix()
            .row_iter()
            .map(|row| [row[0], row[1], row[2]])
            .collect();
        add("rotation", format!("{rows:?}"));
    }
    text
}
