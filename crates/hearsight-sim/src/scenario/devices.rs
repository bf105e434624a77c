//! Bases, cameras and microphone arrays, and the commands that a scenario sends to them.

use super::raw::{
    ArrayShape, LensKind, RawArray, RawBase, RawCamera, RawClock, RawCommand, RawHead, RawScene,
};
use super::resolve::{Resolver, Thing};
use crate::acoustics::random::{between, generator};
use crate::world::{
    ArrayDevice, AxisLimits, Base, CameraDevice, Exposure, Motion, Mount, Pace, PanTiltZoom, Rest,
    SensorClock,
};
use hearsight_core::camera::{
    Fisheye, FisheyeParameters, InvalidParameter, Panorama, PanoramaParameters, Pinhole, PinholeParameters,
};
use hearsight_core::command::{DeviceCommand, DeviceOrder};
use hearsight_core::configuration::{ConfigurationError, Field};
use hearsight_core::{CameraModel, Instant, WorldPoint};
use nalgebra::Point2;
use std::f64::consts::TAU;

/// Samples of all channels of an array a second: beyond it is a slip.
const MOST_MICROPHONES: usize = 256;

impl Resolver {
    pub(super) fn bases(
        &self,
        raw: &RawScene,
    ) -> Result<(Vec<Base>, Vec<DeviceCommand>), ConfigurationError> {
        let (mut bases, mut commands) = (Vec::new(), Vec::new());
        for (number, raw) in raw.base.iter().enumerate() {
            let field = Field::of("base").index(number);
            let base = self.base(&field, raw)?;
            for (place, command) in raw.command.iter().enumerate() {
                let at = field.key("command").index(place);
                commands.push(self.command(&at, command, &base.name, false)?);
            }
            self.in_order(&field.key("command"), &raw.command)?;
            bases.push(base);
        }
        Ok((bases, commands))
    }

    fn base(&self, field: &Field, raw: &RawBase) -> Result<Base, ConfigurationError> {
        let Some([x, y]) = raw.at else {
            return Err(self.missing(field, "at", "give its place on the floor, [x, y]"));
        };
        self.inside(&field.key("at"), [x, y, 0.0])?;
        let facing_rad = match &raw.facing {
            Some(facing) => self.bearing(&field.key("facing"), facing, Point2::new(x, y))?,
            None => 0.0,
        };
        let speed_m_s = self.number(
            &field.key("speed"),
            raw.speed,
            0.8,
            [0.01, 3.5],
            "give metres a second",
        )?;
        let turn = self.number(
            &field.key("turn_speed"),
            raw.turn_speed,
            60.0,
            [1.0, 720.0],
            "give degrees a second",
        )?;
        let rest = Rest {
            place: Point2::new(x, y),
            facing_rad,
            seat_m: None,
            present: true,
        };
        let mut motion = Motion::new(rest, [1.0, 1.0]);
        for (number, action) in raw.action.iter().enumerate() {
            let at = field.key("action").index(number);
            let Some(time) = action.time.filter(|time| time.is_finite() && *time >= 0.0) else {
                return Err(self.missing(&at, "time", "say when it begins, in seconds"));
            };
            let done = if let (Some(direction), true) = (&action.turn, action.walk.is_empty()) {
                let here = motion.end().place;
                let to = self.bearing(&at.key("turn"), direction, here)?;
                let angle = crate::world::wrap(to - motion.end().facing_rad).abs();
                // The middle of a turn is 15/8 as fast as its mean.
                motion.turn(
                    time,
                    to,
                    Some(action.seconds.unwrap_or(1.875 * angle / turn.to_radians() + 0.1)),
                )
            } else if !action.walk.is_empty() && action.turn.is_none() {
                let mut points = Vec::new();
                for (place, [x, y]) in action.walk.iter().enumerate() {
                    self.inside(&at.key("walk").index(place), [*x, *y, 0.0])?;
                    points.push(Point2::new(*x, *y));
                }
                let speed = self.number(
                    &at.key("speed"),
                    action.speed,
                    speed_m_s,
                    [0.01, speed_m_s],
                    "it is not faster",
                )?;
                motion.walk(time, &points, Pace::Speed(speed))
            } else {
                return Err(self.wrong(&at, "is nothing that a base does", "give either `walk` or `turn`"));
            };
            if done.is_err() {
                let what = format!(
                    "{time} s is too early: the action before lasts until {:.2} s",
                    motion.end_s()
                );
                return Err(self.wrong(&at.key("time"), what, "begin later, or drive faster"));
            }
        }
        Ok(Base {
            name: self.name_of(field),
            motion,
            speed_m_s,
            turn_rad_s: turn.to_radians(),
            latency_s: self.number(
                &field.key("latency"),
                raw.latency,
                0.1,
                [0.0, 10.0],
                "give seconds",
            )?,
        })
    }

    fn in_order(&self, field: &Field, commands: &[RawCommand]) -> Result<(), ConfigurationError> {
        for (number, pair) in commands.windows(2).enumerate() {
            if pair[1].time < pair[0].time {
                let what = "is before the command before";
                return Err(self.wrong(
                    &field.index(number + 1).key("time"),
                    what,
                    "write commands in order of time",
                ));
            }
        }
        Ok(())
    }

    fn command(
        &self,
        field: &Field,
        raw: &RawCommand,
        device: &str,
        is_camera: bool,
    ) -> Result<DeviceCommand, ConfigurationError> {
        let Some(time) = raw.time.filter(|time| time.is_finite() && *time >= 0.0) else {
            return Err(self.missing(field, "time", "say when it is sent, in seconds"));
        };
        let aims = raw.pan.is_some() || raw.tilt.is_some() || raw.zoom.is_some();
        let turns = raw.pan_speed.is_some() || raw.tilt_speed.is_some();
        let numbers = [
            raw.pan,
            raw.tilt,
            raw.zoom,
            raw.pan_speed,
            raw.tilt_speed,
            raw.drive,
        ];
        if numbers.iter().flatten().any(|value| !value.is_finite()) {
            return Err(self.wrong(
                field,
                "has a number that is not finite",
                "give degrees, factors or metres a second",
            ));
        }
        let order = match (is_camera, aims, turns, raw.drive) {
            (true, true, false, None) => DeviceOrder::Aim {
                pan_rad: raw.pan.unwrap_or(0.0).to_radians(),
                tilt_rad: raw.tilt.unwrap_or(0.0).to_radians(),
                zoom: raw.zoom.unwrap_or(1.0),
            },
            (true, false, true, None) => DeviceOrder::Turn {
                pan_rad_s: raw.pan_speed.unwrap_or(0.0).to_radians(),
                tilt_rad_s: raw.tilt_speed.unwrap_or(0.0).to_radians(),
                zoom_per_s: 0.0,
            },
            (false, false, _, Some(_)) | (false, false, true, None) => DeviceOrder::Drive {
                forward_m_s: raw.drive.unwrap_or(0.0),
                turn_rad_s: raw.pan_speed.unwrap_or(0.0).to_radians(),
            },
            (_, false, false, None) => DeviceOrder::Stop,
            (true, ..) => {
                let cure = "a camera goes somewhere (pan, tilt, zoom) or on (pan_speed, tilt_speed)";
                return Err(self.wrong(field, "says too much at once", cure));
            }
            (false, ..) => {
                return Err(self.wrong(field, "is for cameras", "a base has `drive` and `pan_speed`"));
            }
        };
        Ok(DeviceCommand {
            time: Instant::from_seconds(time),
            device: device.to_owned(),
            order,
        })
    }

    fn base_number(&self, field: &Field, name: &Option<String>) -> Result<Option<usize>, ConfigurationError> {
        let Some(name) = name else { return Ok(None) };
        let number = self.find(&field.key("base"), name, "base", |thing| match thing {
            Thing::Base(number) => Some(number),
            _ => None,
        })?;
        Ok(Some(number))
    }

    pub(super) fn cameras(
        &self,
        raw: &RawScene,
    ) -> Result<(Vec<CameraDevice>, Vec<DeviceCommand>), ConfigurationError> {
        let (mut cameras, mut commands) = (Vec::new(), Vec::new());
        for (number, raw) in raw.camera.iter().enumerate() {
            let field = Field::of("camera").index(number);
            let camera = self.camera(&field, raw)?;
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

    fn camera(&self, field: &Field, raw: &RawCamera) -> Result<CameraDevice, ConfigurationError> {
        let [width, height] = raw.size.unwrap_or([640, 480]);
        if !(8..=8192).contains(&width) || !(8..=8192).contains(&height) {
            let what = format!("{width} x {height} pixels is no picture");
            return Err(self.wrong(
                &field.key("size"),
                what,
                "give 8 to 8192 pixels each way, such as [640, 480]",
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
            mount: self.mount(field, raw)?,
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

    fn lens(
        &self,
        field: &Field,
        raw: &RawCamera,
        [width, height]: [usize; 2],
    ) -> Result<CameraModel, ConfigurationError> {
        let kind = raw.lens.unwrap_or(LensKind::Pinhole);
        let (usual, widest) = match kind {
            LensKind::Pinhole => (60.0, 150.0),
            LensKind::Fisheye => (180.0, 220.0),
            LensKind::Panorama => (360.0, 360.0),
        };
        if raw.view.is_some() && raw.focal.is_some() {
            return Err(self.wrong(field, "has `view` and `focal` at once", "keep one of them"));
        }
        let view = self.number(
            &field.key("view"),
            raw.view,
            usual,
            [0.5, widest],
            "give degrees from edge to edge",
        )?;
        let view = view.to_radians();
        let half = 0.5 * width as f64;
        let focal = match raw.focal {
            Some(_) => self.number(&field.key("focal"), raw.focal, 1.0, [1.0, 1e6], "give pixels")?,
            None => match kind {
                LensKind::Pinhole => half / (0.5 * view).tan(),
                LensKind::Fisheye => half / (0.5 * view),
                LensKind::Panorama => width as f64 / view,
            },
        };
        let centre_px = [0.5 * width as f64 - 0.5, 0.5 * height as f64 - 0.5];
        let most = match kind {
            LensKind::Pinhole => 5,
            LensKind::Fisheye => 4,
            LensKind::Panorama => 0,
        };
        if raw.distortion.len() > most {
            let what = format!("has {} coefficients", raw.distortion.len());
            return Err(self.wrong(&field.key("distortion"), what, format!("this lens has {most}")));
        }
        let k = |place: usize| raw.distortion.get(place).copied().unwrap_or(0.0);
        let lens = match kind {
            LensKind::Pinhole => Pinhole::new(PinholeParameters {
                focal_px: [focal; 2],
                centre_px,
                radial: [k(0), k(1), k(4)],
                tangential: [k(2), k(3)],
            })
            .map(CameraModel::Pinhole),
            LensKind::Fisheye => Fisheye::new(FisheyeParameters {
                focal_px: [focal; 2],
                centre_px,
                radial: [k(0), k(1), k(2), k(3)],
            })
            .map(CameraModel::Fisheye),
            LensKind::Panorama => Panorama::new(PanoramaParameters {
                columns_per_turn: TAU * focal,
                focal_px: focal,
                centre_px,
            })
            .map(CameraModel::Panorama),
        };
        lens.map_err(|error: InvalidParameter| self.wrong(field, error, "see `hearsight schema scenario`"))
    }

    fn mount(&self, field: &Field, raw: &RawCamera) -> Result<Mount, ConfigurationError> {
        let base = self.base_number(field, &raw.base)?;
        let Some(place) = raw.at else {
            return Err(self.missing(field, "at", "give its place, [x, y, z]"));
        };
        let position = match base {
            Some(_) => self.point(&field.key("at"), place)?,
            None => self.inside(&field.key("at"), place)?,
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

    fn head(&self, field: &Field, raw: &RawHead) -> Result<PanTiltZoom, ConfigurationError> {
        let number = |key: &str, value, usual, range| {
            self.number(
                &field.key(key),
                value,
                usual,
                range,
                "see `hearsight schema scenario`",
            )
        };
        let acceleration = number("acceleration", raw.acceleration, 600.0, [1.0, 1e5])?.to_radians();
        let axis = |speed: f64, [low, high]: [f64; 2]| AxisLimits {
            low: low.to_radians(),
            high: high.to_radians(),
            speed: speed.to_radians(),
            acceleration,
        };
        let pan_range = raw.pan_range.unwrap_or([-170.0, 170.0]);
        let tilt_range = raw.tilt_range.unwrap_or([-30.0, 90.0]);
        for (key, [low, high]) in [("pan_range", pan_range), ("tilt_range", tilt_range)] {
            if !(low <= 0.0 && high >= 0.0 && low >= -360.0 && high <= 360.0) {
                let what = format!("{low} to {high} degrees does not hold 0, where it is mounted");
                return Err(self.wrong(&field.key(key), what, "give [least, most] in degrees"));
            }
        }
        let zoom_speed = number("zoom_speed", raw.zoom_speed, 4.0, [0.01, 1000.0])?;
        Ok(PanTiltZoom {
            pan: axis(
                number("pan_speed", raw.pan_speed, 80.0, [0.1, 3600.0])?,
                pan_range,
            ),
            tilt: axis(
                number("tilt_speed", raw.tilt_speed, 50.0, [0.1, 3600.0])?,
                tilt_range,
            ),
            zoom: AxisLimits {
                low: 1.0,
                high: number("zoom", raw.zoom, 12.0, [1.0, 100.0])?,
                speed: zoom_speed,
                acceleration: 20.0 * zoom_speed,
            },
            latency_s: number("latency", raw.latency, 0.06, [0.0, 10.0])?,
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

    fn clock(&self, field: &Field, raw: &RawClock) -> Result<SensorClock, ConfigurationError> {
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

    pub(super) fn arrays(
        &self,
        raw: &RawScene,
        cameras: &[CameraDevice],
    ) -> Result<Vec<ArrayDevice>, ConfigurationError> {
        let arrays = raw.array.iter().enumerate();
        arrays
            .map(|(number, array)| self.array(&Field::of("array").index(number), array, cameras))
            .collect()
    }

    fn array(
        &self,
        field: &Field,
        raw: &RawArray,
        cameras: &[CameraDevice],
    ) -> Result<ArrayDevice, ConfigurationError> {
        let rate_hz = raw.rate.unwrap_or(16_000);
        if !(8_000..=192_000).contains(&rate_hz) {
            let what = format!("{rate_hz} samples a second is not possible");
            return Err(self.wrong(&field.key("rate"), what, "give 8000 to 192000, such as 16000"));
        }
        let base = self.base_number(field, &raw.base)?;
        let places = self.microphone_places(field, raw)?;
        let mut microphones = Vec::new();
        for (number, place) in places.iter().enumerate() {
            let at = if raw.microphones.is_empty() {
                field.key("at")
            } else {
                field.key("microphones").index(number)
            };
            let point = if base.is_some() {
                self.point(&at, *place)?
            } else {
                self.inside(&at, *place)?
            };
            if microphones
                .iter()
                .any(|other: &WorldPoint| other.distance_m(point) < 1e-3)
            {
                let what = format!("microphone {number} is at {place:?}, where another one is");
                return Err(self.wrong(&at, what, "an array of zero size hears no direction"));
            }
            microphones.push(point);
        }
        let camera = match &raw.camera {
            Some(name) => {
                let found = cameras.iter().position(|camera| &camera.name == name);
                let known: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
                let missing = || {
                    self.wrong(
                        &field.key("camera"),
                        format!("there is no camera `{name}`"),
                        Self::did_you_mean(name, &known),
                    )
                };
                Some(found.ok_or_else(missing)?)
            }
            None => (cameras.len() == 1).then_some(0),
        };
        self.spans(&field.key("lost"), &raw.lost, "a loss")?;
        let number = |key: &str, value, usual, range| {
            self.number(
                &field.key(key),
                value,
                usual,
                range,
                "see `hearsight schema scenario`",
            )
        };
        let share = number("lost_share", raw.lost_share, 0.0, [0.0, 0.9])?;
        let block = number("lost_block", raw.lost_block, 0.02, [0.001, 10.0])?;
        let name = self.name_of(field);
        Ok(ArrayDevice {
            rate_hz,
            base,
            microphones,
            mismatch: [
                number("gain_mismatch", raw.gain_mismatch, 1.0, [0.0, 20.0])?,
                number("delay_mismatch", raw.delay_mismatch, 5e-6, [0.0, 1e-3])?,
                number("corner_mismatch", raw.corner_mismatch, 0.2, [0.0, 0.9])?,
            ],
            noise_db: number("noise", raw.noise, -80.0, [-200.0, 0.0])?,
            camera,
            lost: self.losses(&name, &raw.lost, share, block),
            clock: self.clock(&field.key("clock"), &raw.clock)?,
            name,
        })
    }

    fn microphone_places(&self, field: &Field, raw: &RawArray) -> Result<Vec<[f64; 3]>, ConfigurationError> {
        if !raw.microphones.is_empty() {
            if raw.shape.is_some() || raw.at.is_some() {
                let what = "has `microphones` and a `shape` at a place";
                return Err(self.wrong(field, what, "keep one of them"));
            }
            if raw.microphones.len() > MOST_MICROPHONES {
                return Err(self.wrong(&field.key("microphones"), "are too many", "256 are the most"));
            }
            return Ok(raw.microphones.clone());
        }
        let Some([x, y, z]) = raw.at else {
            return Err(self.missing(field, "at", "give its middle, [x, y, z], or the `microphones`"));
        };
        let shape = raw.shape.unwrap_or(ArrayShape::Circle);
        let count = raw.count.unwrap_or(match shape {
            ArrayShape::Pair => 2,
            ArrayShape::Line => 4,
            ArrayShape::Circle => 8,
        });
        if count == 0 || count > MOST_MICROPHONES || (shape == ArrayShape::Pair && count != 2) {
            let what = format!("{count} microphones do not make this shape");
            return Err(self.wrong(&field.key("count"), what, "a pair has 2, others 1 to 256"));
        }
        let facing = self
            .number(
                &field.key("facing"),
                raw.facing,
                0.0,
                [-3600.0, 3600.0],
                "give degrees",
            )?
            .to_radians();
        let spacing = self.number(
            &field.key("spacing"),
            raw.spacing,
            0.2,
            [0.002, 20.0],
            "give metres",
        )?;
        let radius = self.number(
            &field.key("radius"),
            raw.radius,
            0.1,
            [0.002, 20.0],
            "give metres",
        )?;
        let place = |number: usize| match shape {
            ArrayShape::Pair | ArrayShape::Line => {
                let left = spacing * (0.5 * (count - 1) as f64 - number as f64);
                [x - left * facing.sin(), y + left * facing.cos(), z]
            }
            ArrayShape::Circle => {
                let angle = facing + TAU * number as f64 / count as f64;
                [x + radius * angle.cos(), y + radius * angle.sin(), z]
            }
        };
        Ok((0..count).map(place).collect())
    }

    /// Losses that are written and those that are drawn, in order and joined where they touch.
    fn losses(&self, name: &str, written: &[[f64; 2]], share: f64, block_s: f64) -> Vec<[f64; 2]> {
        let mut all = written.to_vec();
        if share > 0.0 {
            let mut random = generator(self.seed_of("losses", name), "losses", 0);
            let blocks = (self.seconds / block_s).ceil() as usize;
            for block in 0..blocks {
                if between(&mut random, 0.0, 1.0) < share {
                    all.push([block as f64 * block_s, (block + 1) as f64 * block_s]);
                }
            }
            all.sort_by(|one, other| one[0].total_cmp(&other[0]));
        }
        let mut joined: Vec<[f64; 2]> = Vec::new();
        for span in all {
            match joined.last_mut() {
                Some(last) if span[0] <= last[1] + 1e-9 => last[1] = last[1].max(span[1]),
                _ => joined.push(span),
            }
        }
        joined
    }
}
