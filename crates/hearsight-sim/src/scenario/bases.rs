//! Moving bases, and the commands that a scenario sends to its devices.

use super::names::Thing;
use super::raw::{RawBase, RawCommand, RawScene};
use super::resolve::Resolver;
use crate::world::{Base, Motion, Pace, Rest};
use hearsight_core::Instant;
use hearsight_core::command::{DeviceCommand, DeviceOrder};
use hearsight_core::configuration::{ConfigurationError, Field};
use nalgebra::Point2;

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

    pub(super) fn in_order(&self, field: &Field, commands: &[RawCommand]) -> Result<(), ConfigurationError> {
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

    pub(super) fn command(
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

    pub(super) fn base_number(
        &self,
        field: &Field,
        name: &Option<String>,
    ) -> Result<Option<usize>, ConfigurationError> {
        let Some(name) = name else { return Ok(None) };
        let number = self.find(&field.key("base"), name, "base", |thing| match thing {
            Thing::Base(number) => Some(number),
            _ => None,
        })?;
        Ok(Some(number))
    }
}
