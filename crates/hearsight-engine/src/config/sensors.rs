//! Cameras and arrays: one source each, starts, rates, channels and geometry.

use super::geometry;
use super::panoramas::Cameras;
use super::raw::{RawArray, RawCamera};
use super::resolve::Resolver;
use super::resolved::{Input, ResolvedArray, ResolvedCamera};
use hearsight_core::Instant;
use hearsight_core::configuration::ConfigurationError;
use hearsight_core::configuration::{Field, suggest};
use std::collections::BTreeSet;

const DEFAULT_IMAGE_RATE_HZ: f64 = 25.0;
pub(super) const DEFAULT_RECONNECT_S: f64 = 300.0;

impl Resolver {
    pub(super) fn camera(
        &self,
        field: &Field,
        raw: &RawCamera,
        name: String,
    ) -> Result<ResolvedCamera, ConfigurationError> {
        let input = self.input(field, &raw.file, &raw.device, &raw.stream, Some(&raw.images))?;
        let rate_hz = raw.rate.unwrap_or(DEFAULT_IMAGE_RATE_HZ);
        if raw.rate.is_some() && !matches!(input, Input::Images(_)) {
            let cure = "leave it out: files, devices and streams know their rate";
            return Err(self
                .document
                .error(&field.key("rate"), "is for `images` only", cure));
        }
        if !(rate_hz.is_finite() && rate_hz > 0.0 && rate_hz <= 10_000.0) {
            let what = format!("{rate_hz} frames a second is not possible");
            return Err(self
                .document
                .error(&field.key("rate"), what, "give a positive number, such as 25"));
        }
        let calibration = match &raw.calibration {
            Some(calibration) => Some(geometry::calibration(
                self,
                &field.key("calibration"),
                calibration,
            )?),
            None => None,
        };
        Ok(ResolvedCamera {
            name,
            start: self.start(field, raw.start, &input, raw.paced)?,
            drift_ppm: self.drift(field, raw.drift)?,
            paced: raw.paced.unwrap_or(false),
            reconnect_s: self.reconnect(field, raw.reconnect)?,
            rate_hz,
            format: raw.format.clone(),
            options: raw.options.clone(),
            calibration,
            ring: None,
            input,
        })
    }

    pub(super) fn array(
        &self,
        field: &Field,
        raw: &RawArray,
        name: String,
        cameras: &Cameras<'_>,
    ) -> Result<ResolvedArray, ConfigurationError> {
        let input = self.input(field, &raw.file, &raw.device, &raw.stream, None)?;
        if let Some(rate @ (0..1_000 | 1_000_001..)) = raw.rate {
            let what = format!("{rate} samples a second is not possible");
            return Err(self.document.error(
                &field.key("rate"),
                what,
                "give samples a second, such as 16000",
            ));
        }
        let microphones = geometry::microphones(self, field, raw, &name)?;
        if let Some(channels) = &raw.channels {
            self.channels(&field.key("channels"), channels, microphones.len())?;
        }
        let camera = match &raw.camera {
            Some(wanted) => Some(cameras.place(wanted).ok_or_else(|| {
                let what = format!("there is no camera `{wanted}`");
                self.document
                    .error(&field.key("camera"), what, suggest(wanted, &cameras.names()))
            })?),
            None => (cameras.count() == 1).then_some(0),
        };
        Ok(ResolvedArray {
            name,
            start: self.start(field, raw.start, &input, raw.paced)?,
            drift_ppm: self.drift(field, raw.drift)?,
            paced: raw.paced.unwrap_or(false),
            reconnect_s: self.reconnect(field, raw.reconnect)?,
            format: raw.format.clone(),
            options: raw.options.clone(),
            rate_hz: raw.rate,
            channels: raw.channels.clone(),
            microphones,
            camera,
            input,
        })
    }

    fn channels(
        &self,
        field: &Field,
        channels: &[usize],
        microphones: usize,
    ) -> Result<(), ConfigurationError> {
        if channels.is_empty() {
            return Err(self.document.error(
                field,
                "is empty",
                "list channels from 0, or leave it out for all",
            ));
        }
        let unique: BTreeSet<_> = channels.iter().collect();
        if unique.len() < channels.len() {
            let what = format!("{channels:?} names a channel twice");
            return Err(self
                .document
                .error(field, what, "give every microphone a channel of its own"));
        }
        if microphones > 0 && microphones != channels.len() {
            let what = format!("{} channels for {microphones} microphones", channels.len());
            return Err(self
                .document
                .error(field, what, "list one channel a microphone, in the same order"));
        }
        Ok(())
    }

    fn input(
        &self,
        field: &Field,
        file: &Option<String>,
        device: &Option<String>,
        stream: &Option<String>,
        images: Option<&Option<String>>,
    ) -> Result<Input, ConfigurationError> {
        let mut given = Vec::new();
        given.extend(
            file.as_ref()
                .map(|file| ("file", file, Input::File(self.path(file)))),
        );
        given.extend(
            device
                .as_ref()
                .map(|device| ("device", device, Input::Device(device.clone()))),
        );
        given.extend(
            stream
                .as_ref()
                .map(|stream| ("stream", stream, Input::Stream(stream.clone()))),
        );
        given.extend(
            images
                .and_then(Option::as_ref)
                .map(|images| ("images", images, Input::Images(self.path(images)))),
        );
        let kinds = if images.is_some() {
            "`file`, `device`, `stream` or `images`"
        } else {
            "`file`, `device` or `stream`"
        };
        let cure = format!("give exactly one of {kinds}");
        if given.len() > 1 {
            let names: Vec<_> = given.iter().map(|(name, ..)| format!("`{name}`")).collect();
            return Err(self
                .document
                .error(field, format!("has {} at once", names.join(" and ")), cure));
        }
        match given.pop() {
            None => Err(self
                .document
                .error(field, "says nothing of where its data come from", cure)),
            Some((name, value, _)) if value.trim().is_empty() => {
                Err(self.document.error(&field.key(name), "is empty", cure))
            }
            Some((.., input)) => Ok(input),
        }
    }

    fn start(
        &self,
        field: &Field,
        start: Option<f64>,
        input: &Input,
        paced: Option<bool>,
    ) -> Result<Option<Instant>, ConfigurationError> {
        let live = matches!(input, Input::Device(_) | Input::Stream(_));
        if live && paced.is_some() {
            let cure = "leave it out: devices and streams have their own pace";
            return Err(self
                .document
                .error(&field.key("paced"), "is for files and pictures only", cure));
        }
        let start = self.time(&field.key("start"), start)?;
        Ok(if live {
            start
        } else {
            Some(start.unwrap_or(Instant::ZERO))
        })
    }

    fn reconnect(&self, field: &Field, seconds: Option<f64>) -> Result<f64, ConfigurationError> {
        let seconds = seconds.unwrap_or(DEFAULT_RECONNECT_S);
        if (0.0..=1e9).contains(&seconds) {
            return Ok(seconds);
        }
        let what = format!("{seconds} s is no time to wait for a source");
        Err(self.document.error(
            &field.key("reconnect"),
            what,
            "give seconds, 0 to 1e9; 0 ends a live source at once when it is lost",
        ))
    }

    fn drift(&self, field: &Field, drift: Option<f64>) -> Result<f64, ConfigurationError> {
        let drift = drift.unwrap_or(0.0);
        if drift.is_finite() && drift.abs() <= 10_000.0 {
            return Ok(drift);
        }
        let what = format!("{drift} parts per million is no drift of a clock");
        Err(self.document.error(
            &field.key("drift"),
            what,
            "crystals are within ±100; leave it out for 0",
        ))
    }
}
