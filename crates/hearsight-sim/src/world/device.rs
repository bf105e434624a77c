//! Sensors and what carries them: where cameras look and microphones are, as a function of time and of the commands
//! that devices received.

use super::axis::{Axis, AxisLimits};
use super::motion::Motion;
use hearsight_core::camera::InvalidParameter;
use hearsight_core::command::{DeviceCommand, DeviceOrder};
use hearsight_core::{Camera, CameraModel, Pose, Span, WorldPoint};
use nalgebra::{Isometry3, Point3, Rotation3, UnitQuaternion, Vector3};

/// Where a sensor is fixed: in the room, or on a moving base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mount {
    /// Number of the base that carries it, from 0.
    pub base: Option<usize>,
    /// Place, metres: in the room, or from the middle of the base on the floor (forward, left, up).
    pub position: WorldPoint,
    /// To the left of the x axis or of where the base looks, radians.
    pub pan_rad: f64,
    /// Up, radians.
    pub tilt_rad: f64,
    /// About the direction in which it looks: how far the right side is lower, radians.
    pub roll_rad: f64,
}

/// What a pan-tilt-zoom head can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanTiltZoom {
    /// Turning to the left, radians.
    pub pan: AxisLimits,
    /// Turning up, radians.
    pub tilt: AxisLimits,
    /// Focal length over the shortest one.
    pub zoom: AxisLimits,
    /// From the time of a command to the beginning of the movement, seconds.
    pub latency_s: f64,
}

/// The clock of a sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorClock {
    /// When it took its first datum, seconds.
    pub offset_s: f64,
    /// How much too fast it runs, parts per million.
    pub drift_ppm: f64,
    /// Whether `room.toml` tells.
    pub declared: bool,
}

/// How a camera's brightness and colours change, beside its noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Exposure {
    /// Gain.
    pub gain: f64,
    /// How far gain and white balance drift to and fro, a share of them.
    pub drift: f64,
    /// How long a drift there and back takes, seconds.
    pub drift_s: f64,
    /// From a time on (seconds) a factor of the gain.
    pub gain_changes: Vec<(f64, f64)>,
    /// From a time on (seconds) gains of red, green and blue.
    pub white_balance_changes: Vec<(f64, [f64; 3])>,
    /// From the beginning on.
    pub white_balance: [f64; 3],
}

/// A camera.
#[derive(Clone, Debug)]
pub struct CameraDevice {
    /// Its name, unique in the room.
    pub name: String,
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Frames a second.
    pub rate_hz: f64,
    /// The lens, with the shortest focal length where it zooms.
    pub lens: CameraModel,
    /// Where it is.
    pub mount: Mount,
    /// What its head can do, where it has one.
    pub head: Option<PanTiltZoom>,
    /// Brightness and colours.
    pub exposure: Exposure,
    /// How long the shutter is open, seconds.
    pub shutter_s: f64,
    /// Noise in the dark, a share of full scale; and the variance that light adds.
    pub noise: [f64; 2],
    /// Its clock.
    pub clock: SensorClock,
}

/// A microphone array.
#[derive(Clone, Debug)]
pub struct ArrayDevice {
    /// Its name, unique in the room.
    pub name: String,
    /// Samples a second.
    pub rate_hz: u32,
    /// Number of the base that carries it, from 0.
    pub base: Option<usize>,
    /// Places of its microphones, metres: in the room, or from the middle of the base (forward, left, up).
    pub microphones: Vec<WorldPoint>,
    /// How far microphones differ: gain, decibels; delay, seconds; corner of the high-pass, a share of it.
    pub mismatch: [f64; 3],
    /// Noise of each microphone, decibels relative to full scale.
    pub noise_db: f64,
    /// Number of the camera that it is paired with, from 0.
    pub camera: Option<usize>,
    /// Samples that never arrive (zeros stand for them): from and until, seconds.
    pub lost: Vec<[f64; 2]>,
    /// Its clock.
    pub clock: SensorClock,
}

/// Something that moves and carries sensors.
#[derive(Clone, Debug)]
pub struct Base {
    /// Its name, unique in the room.
    pub name: String,
    /// How it moves as long as no command comes.
    pub motion: Motion,
    /// The fastest that it drives, metres a second.
    pub speed_m_s: f64,
    /// The fastest that it turns, radians a second.
    pub turn_rad_s: f64,
    /// From the time of a command to the beginning of the movement, seconds.
    pub latency_s: f64,
}

/// A command names a device that is not there or that cannot do it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no device `{device}` can {order}; commands are for pan-tilt-zoom cameras and moving bases")]
pub struct UnknownDevice {
    /// The name.
    pub device: String,
    /// What it was to do.
    pub order: &'static str,
}

/// The states of all devices that obey commands: functions of what they received.
#[derive(Clone, Debug)]
pub struct Controls {
    /// Pan, tilt and zoom of each camera with a head.
    heads: Vec<Option<[Axis; 3]>>,
    /// What bases were told, in order of time.
    drives: Vec<Vec<Leg>>,
}

/// From a time on a base drives on an arc.
#[derive(Clone, Copy, Debug)]
struct Leg {
    from_s: f64,
    place: [f64; 3],
    forward_m_s: f64,
    turn_rad_s: f64,
}

impl Controls {
    /// Devices at rest.
    pub fn new(cameras: &[CameraDevice], bases: &[Base]) -> Self {
        let heads = cameras.iter().map(|camera| {
            let head = camera.head.as_ref()?;
            Some([
                Axis::new(head.pan, 0.0),
                Axis::new(head.tilt, 0.0),
                Axis::new(head.zoom, 1.0),
            ])
        });
        Self {
            heads: heads.collect(),
            drives: vec![Vec::new(); bases.len()],
        }
    }

    /// Lets a device obey. Commands must come in order of time for each device; one that comes late counts as of the
    /// time of the one before.
    ///
    /// # Errors
    /// [`UnknownDevice`] where none of this name can do it.
    pub fn send(
        &mut self,
        cameras: &[CameraDevice],
        bases: &[Base],
        command: &DeviceCommand,
    ) -> Result<(), UnknownDevice> {
        let time_s = command.time.seconds();
        let unknown = |order| UnknownDevice {
            device: command.device.clone(),
            order,
        };
        let camera = cameras.iter().position(|camera| camera.name == command.device);
        let base = bases.iter().position(|base| base.name == command.device);
        match command.order {
            DeviceOrder::Drive {
                forward_m_s,
                turn_rad_s,
            } => {
                let base = base.ok_or_else(|| unknown("drive"))?;
                self.drive(bases, base, time_s, forward_m_s, turn_rad_s);
                return Ok(());
            }
            DeviceOrder::Stop => {
                if let Some(base) = base {
                    self.drive(bases, base, time_s, 0.0, 0.0);
                    return Ok(());
                }
            }
            DeviceOrder::Aim { .. } | DeviceOrder::Turn { .. } => {}
        }
        let found = camera.and_then(|camera| Some((cameras[camera].head?, self.heads[camera].as_mut()?)));
        let (head, [pan, tilt, zoom]) = found.ok_or_else(|| unknown("pan, tilt and zoom"))?;
        let from_s = time_s + head.latency_s;
        match command.order {
            DeviceOrder::Aim {
                pan_rad,
                tilt_rad,
                zoom: factor,
            } => {
                pan.go(from_s, pan_rad, f64::INFINITY);
                tilt.go(from_s, tilt_rad, f64::INFINITY);
                zoom.go(from_s, factor, f64::INFINITY);
            }
            DeviceOrder::Turn {
                pan_rad_s,
                tilt_rad_s,
                zoom_per_s,
            } => {
                pan.turn(from_s, pan_rad_s);
                tilt.turn(from_s, tilt_rad_s);
                zoom.turn(from_s, zoom_per_s);
            }
            DeviceOrder::Stop | DeviceOrder::Drive { .. } => {
                [pan, tilt, zoom]
                    .into_iter()
                    .for_each(|axis| axis.turn(from_s, 0.0));
            }
        }
        Ok(())
    }

    fn drive(&mut self, bases: &[Base], base: usize, time_s: f64, forward_m_s: f64, turn_rad_s: f64) {
        let device = &bases[base];
        let last = self.drives[base]
            .last()
            .map_or(f64::NEG_INFINITY, |leg| leg.from_s);
        let from_s = (time_s + device.latency_s).max(last);
        let place = self.base(bases, base, from_s);
        let limited = |value: f64, limit: f64| {
            if value.is_finite() {
                value.clamp(-limit, limit)
            } else {
                0.0
            }
        };
        self.drives[base].push(Leg {
            from_s,
            place,
            forward_m_s: limited(forward_m_s, device.speed_m_s),
            turn_rad_s: limited(turn_rad_s, device.turn_rad_s),
        });
    }

    /// Place (metres) and direction (radians) of a base: x, y, yaw.
    pub fn base(&self, bases: &[Base], base: usize, time_s: f64) -> [f64; 3] {
        let legs = &self.drives[base];
        let next = legs.partition_point(|leg| leg.from_s <= time_s);
        let Some(leg) = next.checked_sub(1).and_then(|last| legs.get(last)) else {
            let stance = bases[base].motion.stance(time_s);
            return [stance.place.x, stance.place.y, stance.facing_rad];
        };
        let [x, y, yaw] = leg.place;
        let elapsed = time_s - leg.from_s;
        let turned = leg.turn_rad_s * elapsed;
        let way = leg.forward_m_s * elapsed;
        // An arc; the middle direction and the chord's length.
        let chord = if turned.abs() < 1e-9 {
            way
        } else {
            way * (turned / 2.0).sin() / (turned / 2.0)
        };
        let (sin, cos) = (yaw + turned / 2.0).sin_cos();
        [x + chord * cos, y + chord * sin, yaw + turned]
    }

    /// Pan and tilt (radians) and zoom of a camera: zeros and 1 of one without a head.
    pub fn head(&self, camera: usize, time_s: f64) -> [f64; 3] {
        match &self.heads[camera] {
            Some(axes) => [0, 1, 2].map(|axis| axes[axis].at(time_s)[0]),
            None => [0.0, 0.0, 1.0],
        }
    }

    /// A camera as it is at a time.
    ///
    /// # Errors
    /// Where the lens cannot be zoomed to that, which resolved scenarios exclude.
    pub fn camera(
        &self,
        device: &CameraDevice,
        number: usize,
        bases: &[Base],
        time_s: f64,
    ) -> Result<Camera, InvalidParameter> {
        let [pan, tilt, zoom] = self.head(number, time_s);
        let mount = &device.mount;
        let turned = Mount {
            pan_rad: mount.pan_rad + pan,
            tilt_rad: mount.tilt_rad + tilt,
            ..*mount
        };
        let carried = match mount.base {
            Some(base) => turned.carried(self.base(bases, base, time_s)),
            None => turned,
        };
        let model = if zoom == 1.0 {
            device.lens
        } else {
            zoomed(&device.lens, zoom)?
        };
        Ok(Camera {
            model,
            pose: carried.pose(),
            width: device.width,
            height: device.height,
        })
    }

    /// Places of the microphones of an array at a time, metres.
    pub fn microphones(&self, device: &ArrayDevice, bases: &[Base], time_s: f64, places: &mut [WorldPoint]) {
        let carrier = device.base.map(|base| self.base(bases, base, time_s));
        for (place, microphone) in places.iter_mut().zip(&device.microphones) {
            *place = match carrier {
                Some(carrier) => carry(*microphone, carrier),
                None => *microphone,
            };
        }
    }

    /// Whether a camera never moves.
    pub fn is_fixed(&self, device: &CameraDevice) -> bool {
        device.mount.base.is_none() && device.head.is_none()
    }
}

fn carry(point: WorldPoint, [x, y, yaw]: [f64; 3]) -> WorldPoint {
    let (sin, cos) = yaw.sin_cos();
    let p = point.0;
    WorldPoint(Point3::new(
        x + cos * p.x - sin * p.y,
        y + sin * p.x + cos * p.y,
        p.z,
    ))
}

/// The same lens with a longer focal length, for a picture of the same size.
fn zoomed(lens: &CameraModel, zoom: f64) -> Result<CameraModel, InvalidParameter> {
    use hearsight_core::camera::{Fisheye, Panorama, Pinhole};
    Ok(match lens {
        CameraModel::Pinhole(lens) => {
            let mut parameters = *lens.parameters();
            parameters.focal_px = parameters.focal_px.map(|focal| focal * zoom);
            CameraModel::Pinhole(Pinhole::new(parameters)?)
        }
        CameraModel::Fisheye(lens) => {
            let mut parameters = *lens.parameters();
            parameters.focal_px = parameters.focal_px.map(|focal| focal * zoom);
            CameraModel::Fisheye(Fisheye::new(parameters)?)
        }
        CameraModel::Panorama(lens) => CameraModel::Panorama(Panorama::new(*lens.parameters())?),
    })
}

impl Mount {
    /// Where this is in the room, of a mount on a base that is there.
    fn carried(&self, base: [f64; 3]) -> Self {
        Self {
            position: carry(self.position, base),
            pan_rad: self.pan_rad + base[2],
            ..*self
        }
    }

    /// The pose of a camera that is mounted so.
    pub fn pose(&self) -> Pose {
        // The camera's axes (right, down, forward) for a camera that looks along x.
        let level = Rotation3::from_matrix_unchecked(nalgebra::Matrix3::new(
            0.0, 0.0, 1.0, //
            -1.0, 0.0, 0.0, //
            0.0, -1.0, 0.0,
        ));
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), self.pan_rad)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), -self.tilt_rad)
            * Rotation3::from_axis_angle(&Vector3::x_axis(), self.roll_rad);
        let world_from_camera = UnitQuaternion::from_rotation_matrix(&(turn * level));
        let rotation = world_from_camera.inverse();
        let translation = -(rotation * self.position.0.coords);
        Pose {
            sensor_from_world: Isometry3::from_parts(translation.into(), rotation),
        }
    }
}

impl SensorClock {
    /// The time of the scenario at which a datum is taken that the sensor counts as `own_s` seconds after its first.
    pub fn time_s(&self, own_s: f64) -> f64 {
        self.offset_s + own_s / (1.0 + self.drift_ppm * 1e-6)
    }

    /// When it counts, seconds after its first datum, what happens at a time of the scenario.
    pub fn own_s(&self, time_s: f64) -> f64 {
        (time_s - self.offset_s) * (1.0 + self.drift_ppm * 1e-6)
    }

    /// The time that whoever reads `room.toml` gives to it, as nanoseconds exactly as the reader of files computes it.
    pub fn declared(&self, own: Span) -> hearsight_core::Instant {
        if !self.declared {
            return hearsight_core::Instant::ZERO + own;
        }
        let ratio = self.drift_ppm * 1e-6;
        let lost = (own.nanoseconds() as f64 * ratio / (1.0 + ratio)).round() as i64;
        hearsight_core::Instant::from_seconds(self.offset_s) + (own - Span::from_nanoseconds(lost))
    }
}

impl CameraDevice {
    /// When the frame of this number, from 0, is taken by the camera's own clock, after its first: rounded to the
    /// nanosecond, as a file gives it.
    pub fn own_time(&self, frame: u64) -> Span {
        frame_time(self.rate_hz, frame)
    }

    /// Nominal interval between frames.
    pub fn interval(&self) -> Span {
        frame_time(self.rate_hz, 1)
    }
}

/// Units of time of video files a second.
const UNITS_PER_SECOND: f64 = 90_000.0;

fn frame_time(rate_hz: f64, frame: u64) -> Span {
    // Files count in units of 1/90000 s, and so do cameras here.
    let units = (frame as f64 * UNITS_PER_SECOND / rate_hz).round() as i64;
    Span::of_samples(units, UNITS_PER_SECOND as u32)
}

impl Exposure {
    /// Gain, and further gains of red, green and blue at a time.
    pub fn at(&self, time_s: f64) -> (f64, [f64; 3]) {
        let phase = std::f64::consts::TAU * time_s / self.drift_s;
        let mut gain = self.gain * (1.0 + self.drift * phase.sin());
        for (_, factor) in self.gain_changes.iter().filter(|(from, _)| *from <= time_s) {
            gain = self.gain * factor * (1.0 + self.drift * phase.sin());
        }
        let changed = self
            .white_balance_changes
            .iter()
            .rev()
            .find(|(from, _)| *from <= time_s);
        let [red, green, blue] = changed.map_or(self.white_balance, |(_, gains)| *gains);
        let warm = 0.5 * self.drift * (0.7 * phase + 1.0).sin();
        (gain, [red * (1.0 + warm), green, blue * (1.0 - warm)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mount_looks_where_it_points() {
        let mount = Mount {
            base: None,
            position: WorldPoint::new(1.0, 2.0, 1.5),
            pan_rad: 0.7,
            tilt_rad: -0.2,
            roll_rad: 0.0,
        };
        let (sin, cos) = 0.7_f64.sin_cos();
        let ahead = WorldPoint(
            mount.position.0 + Vector3::new(cos * 0.2_f64.cos(), sin * 0.2_f64.cos(), -0.2_f64.sin()) * 3.0,
        );
        let looking = Pose::looking_at(mount.position, ahead).unwrap();
        let difference = looking
            .sensor_from_world
            .rotation
            .angle_to(&mount.pose().sensor_from_world.rotation);
        assert!(difference < 1e-9, "{difference}");
        let seen = mount.pose().camera_from_world(ahead).0;
        assert!(seen.x.abs() < 1e-9 && seen.y.abs() < 1e-9 && (seen.z - 3.0).abs() < 1e-9);
    }

    #[test]
    fn frames_are_timed_as_files_time_them() {
        for rate in [10.0, 15.0, 25.0, 29.97, 30.0] {
            assert_eq!(frame_time(rate, 0), Span::ZERO);
            let late = frame_time(rate, 10_000).seconds() - 10_000.0 / rate;
            assert!(late.abs() < 6e-6, "{late}");
        }
        assert_eq!(frame_time(15.0, 1), Span::of_samples(1, 15));
    }
}
