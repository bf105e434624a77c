//! Sensors and what carries them.

use super::axis::AxisLimits;
use super::controls::carry;
use super::motion::Motion;
use hearsight_core::{CameraModel, Pose, Span, WorldPoint};
use nalgebra::{Isometry3, Rotation3, UnitQuaternion, Vector3};

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

impl Mount {
    /// Where this is in the room, of a mount on a base that is there.
    pub(super) fn carried(&self, base: [f64; 3]) -> Self {
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
