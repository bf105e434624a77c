//! Opens the cameras of a panorama and stitches them.

use super::open_camera;
use crate::config::{ResolvedCamera, ResolvedRing};
use crate::error::EngineError;
use hearsight_core::camera::Camera;
use hearsight_core::source::VideoSource;
use hearsight_media::{RunClock, StitchOptions, StitchedCamera, StitchedVideo};

/// The panorama as one source, and its lens and place.
pub(super) fn open(
    panorama: &ResolvedCamera,
    ring: &ResolvedRing,
    clock: RunClock,
) -> Result<(Box<dyn VideoSource>, Camera), EngineError> {
    let mut cameras = Vec::new();
    for camera in &ring.cameras {
        let source = open_camera(camera, clock)?;
        let format = source.format();
        let lens = camera.calibration.as_ref();
        let calibration = lens
            .map(|lens| lens.camera(format.width, format.height))
            .transpose()
            .map_err(|error| EngineError::Calibration {
                camera: camera.name.clone(),
                error,
            })?;
        // Asked for where the configuration is resolved; one that was made otherwise may lack it.
        let calibration = calibration.ok_or_else(|| EngineError::Room {
            what: format!(
                "camera {} of panorama {} has no calibration",
                camera.name, panorama.name
            ),
            cure: "give each camera of a panorama a calibration".into(),
        })?;
        cameras.push(StitchedCamera {
            name: camera.name.clone(),
            source,
            calibration,
        });
    }
    let options = StitchOptions {
        width: ring.size[0],
        height: ring.size[1],
        radius_m: ring.radius_m,
        seam: ring.seam,
    };
    let stitched = StitchedVideo::new(cameras, &options).map_err(|error| EngineError::Room {
        what: format!("panorama {}: {error}", panorama.name),
        cure: "correct its [[panorama]] or the calibrations of its cameras".into(),
    })?;
    let camera = *stitched.calibration();
    Ok((Box::new(stitched), camera))
}
