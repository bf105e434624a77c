//! Cameras: where they are, how bright they are, their clocks, and several of a kind.

use super::raw::{RawCamera, RawClock, RawScene};
use super::resolve::Resolver;
use super::surroundings::Surroundings;
use crate::world::{CameraDevice, Exposure, Mount, SensorClock};
use hearsight_core::WorldPoint;
use hearsight_core::command::DeviceCommand;
use hearsight_core::configuration::{ConfigurationError, Field};
use std::f64::consts::TAU;

/// Pixels of a picture; the lossless codec takes no more.
const MOST_PIXELS: usize = 1 << 24;

impl Resolver {
    pub(super) fn cameras(
        &self,
        raw: &RawScene,
        surroundings: &Surroundings,
    ) -> Result<(Vec<CameraDevice>, Vec<DeviceCommand>), ConfigurationError> {
        let (mut cameras, mut commands) = (Vec::new(), Vec::new());
        for (number, raw) in raw.camera.iter().enumerate() {
            let field = Field::of("camera").index(number);
            let camera = self.camera(&field, raw, surroundings)?;
            for (place, command) in raw.command.iter().enumerate() {
                let at = field.key("command").index(place);
                if camera.head.is_none() {
                    let cure = "give the camera a `head = {}`";
                    return Err(self.wrong(&at, "is for a camera that cannot move", cure));
                }
                commands.push(self.command(&at, command, &camera.name, true)?);
            }
            self.in_order(&field.key("command"), &raw.command)?;
            cameras.extend(self.copies(&field, raw, camera)?);
        }
        Ok((cameras, commands))
    }

    fn camera(
        &self,
        field: &Field,
        raw: &RawCamera,
        surroundings: &Surroundings,
    ) -> Result<CameraDevice, ConfigurationError> {
        let [width, height] = raw.size.unwrap_or([640, 480]);
        let sides = [width, height];
        if !sides.iter().all(|side| (8..=8192).contains(side)) || width * height > MOST_PIXELS {
            let what = format!("{width} x {height} pixels is no picture");
            return Err(self.wrong(
                &field.key("size"),
                what,
                "give 8 to 8192 pixels each way, and 16 million in all at most, such as [640, 480]",
            ));
        }
        let rate_hz = self.number(
            &field.key("rate"),
            raw.rate,
            15.0,
            [0.1, 500.0],
            "give frames a second, such as 15",
        )?;
        let shutter = raw.shutter.unwrap_or(0.012f64.min(0.9 / rate_hz));
        Ok(CameraDevice {
            name: self.name_of(field),
            width,
            height,
            rate_hz,
            lens: self.lens(field, raw, [width, height])?,
            mount: self.mount(field, raw, surroundings)?,
            head: match &raw.head {
                Some(head) => Some(self.head(&field.key("head"), head)?),
                None => None,
            },
            exposure: self.exposure(field, raw)?,
            shutter_s: self.number(
                &field.key("shutter"),
                Some(shutter),
                0.0,
                [0.0, 1.0 / rate_hz],
                "a shutter is not open for longer than a frame lasts",
            )?,
            noise: [
                self.number(
                    &field.key("noise"),
                    raw.noise,
                    0.002,
                    [0.0, 0.5],
                    "give a share of full scale",
                )?,
                self.number(
                    &field.key("shot_noise"),
                    raw.shot_noise,
                    1e-4,
                    [0.0, 0.1],
                    "give a share of full scale",
                )?,
            ],
            clock: self.clock(&field.key("clock"), &raw.clock)?,
        })
    }

    fn mount(
        &self,
        field: &Field,
        raw: &RawCamera,
        surroundings: &Surroundings,
    ) -> Result<Mount, ConfigurationError> {
        let base = self.base_number(field, &raw.base)?;
        let Some(place) = raw.at else {
            return Err(self.missing(field, "at", "give its place, [x, y, z]"));
        };
        let position = match base {
            Some(_) => self.point(&field.key("at"), place)?,
            None => {
                let position = self.inside(&field.key("at"), place)?;
                let around = surroundings
                    .footprints
                    .iter()
                    .find(|piece| piece.swallows(position));
                if let Some(piece) = around {
                    let what = format!("{place:?} is inside `{}`", piece.name);
                    return Err(self.wrong(&field.key("at"), what, "put it on top or in front of that"));
                }
                position
            }
        };
        let (pan_rad, tilt_rad) = match raw.look_at {
            Some(_) if raw.pan.is_some() || raw.tilt.is_some() => {
                return Err(self.wrong(field, "has `look_at` beside `pan` or `tilt`", "keep one of them"));
            }
            Some(target) => {
                let way = self.point(&field.key("look_at"), target)?.0 - position.0;
                let across = way.x.hypot(way.y);
                if way.norm() < 1e-6 {
                    return Err(self.wrong(
                        &field.key("look_at"),
                        "is the very place of the camera",
                        "look elsewhere",
                    ));
                }
                (way.y.atan2(way.x), way.z.atan2(across))
            }
            None => {
                let angle = |key: &str, value| {
                    self.number(&field.key(key), value, 0.0, [-3600.0, 3600.0], "give degrees")
                };
                (
                    angle("pan", raw.pan)?.to_radians(),
                    angle("tilt", raw.tilt)?.to_radians(),
                )
            }
        };
        let roll = self.number(&field.key("roll"), raw.roll, 0.0, [-180.0, 180.0], "give degrees")?;
        Ok(Mount {
            base,
            position,
            pan_rad,
            tilt_rad,
            roll_rad: roll.to_radians(),
        })
    }

    fn exposure(&self, field: &Field, raw: &RawCamera) -> Result<Exposure, ConfigurationError> {
        let white = raw.white_balance.unwrap_or([1.0; 3]);
        let gains = raw
            .white_balance_changes
            .iter()
            .map(|[_, red, green, blue]| [*red, *green, *blue]);
        for gain in gains.chain([white]).flatten() {
            if !(0.05..=20.0).contains(&gain) {
                let what = format!("{gain} is no gain of a colour");
                return Err(self.wrong(&field.key("white_balance"), what, "give 0.05 to 20, 1 for none"));
            }
        }
        let times: Vec<(f64, f64)> = raw
            .white_balance_changes
            .iter()
            .map(|change| (change[0], 1.0))
            .collect();
        self.steps(&field.key("white_balance_changes"), &times)?;
        let jumps: Vec<(f64, f64)> = raw
            .exposure_changes
            .iter()
            .map(|[time, factor]| (*time, *factor))
            .collect();
        Ok(Exposure {
            gain: self.number(
                &field.key("exposure"),
                raw.exposure,
                1.0,
                [0.01, 100.0],
                "1 is usual",
            )?,
            drift: self.number(
                &field.key("drift"),
                raw.drift,
                0.01,
                [0.0, 0.5],
                "give a share, such as 0.05",
            )?,
            drift_s: self.number(
                &field.key("drift_period"),
                raw.drift_period,
                40.0,
                [0.5, 1e5],
                "give seconds",
            )?,
            gain_changes: self.steps(&field.key("exposure_changes"), &jumps)?,
            white_balance_changes: raw
                .white_balance_changes
                .iter()
                .map(|[time, red, green, blue]| (*time, [*red, *green, *blue]))
                .collect(),
            white_balance: white,
        })
    }

    pub(super) fn clock(&self, field: &Field, raw: &RawClock) -> Result<SensorClock, ConfigurationError> {
        Ok(SensorClock {
            offset_s: self.number(
                &field.key("offset"),
                raw.offset,
                0.0,
                [0.0, 3600.0],
                "give seconds from 0",
            )?,
            drift_ppm: self.number(
                &field.key("drift"),
                raw.drift,
                0.0,
                [-1000.0, 1000.0],
                "crystals are within ±100",
            )?,
            declared: raw.declared.unwrap_or(false),
        })
    }

    /// One camera, a stereo pair, or a ring.
    fn copies(
        &self,
        field: &Field,
        raw: &RawCamera,
        camera: CameraDevice,
    ) -> Result<Vec<CameraDevice>, ConfigurationError> {
        let moved = |name: String, aside_m: f64, ahead_m: f64, turn_rad: f64| {
            let mut copy = camera.clone();
            let pan = camera.mount.pan_rad + turn_rad;
            let (sin, cos) = pan.sin_cos();
            copy.name = name;
            copy.mount.pan_rad = pan;
            let place = camera.mount.position.0;
            copy.mount.position = WorldPoint::new(
                place.x + ahead_m * cos - aside_m * sin,
                place.y + ahead_m * sin + aside_m * cos,
                place.z,
            );
            copy
        };
        let name = &camera.name;
        match (raw.stereo, raw.ring) {
            (Some(_), Some(_)) => {
                Err(self.wrong(field, "has `stereo` and `ring` at once", "keep one of them"))
            }
            (Some(_), None) => {
                let apart = self.number(
                    &field.key("stereo"),
                    raw.stereo,
                    0.1,
                    [0.005, 5.0],
                    "give metres, such as 0.09",
                )?;
                Ok(vec![
                    moved(format!("{name}-left"), 0.5 * apart, 0.0, 0.0),
                    moved(format!("{name}-right"), -0.5 * apart, 0.0, 0.0),
                ])
            }
            (None, Some(count)) => {
                if !(2..=64).contains(&count) {
                    let what = format!("{count} cameras are no ring");
                    return Err(self.wrong(&field.key("ring"), what, "give 2 to 64"));
                }
                let radius = self.number(
                    &field.key("ring_radius"),
                    raw.ring_radius,
                    0.05,
                    [0.0, 5.0],
                    "give metres",
                )?;
                let one = |number: usize| {
                    let turn = TAU * number as f64 / count as f64;
                    moved(format!("{name}-{}", number + 1), 0.0, radius, turn)
                };
                Ok((0..count).map(one).collect())
            }
            (None, None) => Ok(vec![camera]),
        }
    }
}
