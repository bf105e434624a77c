//! Panoramas: cameras around one point that become one.

use super::raw::RawPanorama;
use super::resolve::Resolver;
use super::resolved::{Input, ResolvedCamera, ResolvedRing};
use super::sensors::DEFAULT_RECONNECT_S;
use hearsight_core::configuration::{ConfigurationError, Field, suggest};
use hearsight_media::StitchOptions;
use std::collections::BTreeMap;

/// The cameras of a room, by the names that arrays may call them.
pub(super) struct Cameras<'a>(pub(super) &'a [ResolvedCamera]);

impl Cameras<'_> {
    /// The camera of this name, or the panorama that it is part of.
    pub(super) fn place(&self, wanted: &str) -> Option<usize> {
        self.0.iter().position(|camera| {
            let parts = camera.ring.iter().flat_map(|ring| &ring.cameras);
            camera.name == wanted || parts.into_iter().any(|part| part.name == wanted)
        })
    }

    pub(super) fn names(&self) -> Vec<&str> {
        self.0.iter().map(|camera| camera.name.as_str()).collect()
    }

    pub(super) fn count(&self) -> usize {
        self.0.len()
    }
}

impl Resolver {
    /// Puts the cameras of a panorama together: it takes the place of the first.
    pub(super) fn panorama(
        &self,
        field: &Field,
        raw: &RawPanorama,
        name: String,
        cameras: &mut Vec<ResolvedCamera>,
    ) -> Result<(), ConfigurationError> {
        if raw.cameras.len() < 2 {
            let what = format!("names {} cameras", raw.cameras.len());
            let cure = "give `cameras = [\"cam1\", \"cam2\", ...]`: at least two that overlap";
            return Err(self.document.error(&field.key("cameras"), what, cure));
        }
        let mut parts = Vec::new();
        let mut at = cameras.len();
        for wanted in &raw.cameras {
            let names: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
            let Some(place) = names.iter().position(|name| name == wanted) else {
                let what = format!("there is no camera `{wanted}`, or it is named twice");
                return Err(self
                    .document
                    .error(&field.key("cameras"), what, suggest(wanted, &names)));
            };
            let camera = cameras.remove(place);
            if camera.calibration.is_none() {
                let what = format!("camera `{wanted}` has no calibration");
                let cure = "give `calibration` in its [[camera]]: cameras are stitched by where they look";
                return Err(self.document.error(&field.key("cameras"), what, cure));
            }
            at = at.min(place);
            parts.push(camera);
        }
        let usual = StitchOptions::default();
        let ring = ResolvedRing {
            size: raw.size.unwrap_or([usual.width, usual.height]),
            radius_m: raw.radius.unwrap_or(usual.radius_m),
            seam: raw.seam.unwrap_or(usual.seam),
            cameras: parts,
        };
        let camera = ResolvedCamera {
            name,
            input: Input::Panorama,
            start: ring.cameras.first().and_then(|camera| camera.start),
            drift_ppm: 0.0,
            paced: false,
            reconnect_s: DEFAULT_RECONNECT_S,
            rate_hz: 25.0,
            format: None,
            options: BTreeMap::new(),
            calibration: None,
            ring: Some(ring),
        };
        cameras.insert(at.min(cameras.len()), camera);
        Ok(())
    }
}
