//! What devices were told, and how they are because of it: a function of the commands that they received.

use super::axis::Axis;
use super::device::{ArrayDevice, Base, CameraDevice, Mount};
use hearsight_core::camera::InvalidParameter;
use hearsight_core::command::{DeviceCommand, DeviceOrder};
use hearsight_core::{Camera, CameraModel, WorldPoint};
use nalgebra::Point3;

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

pub(super) fn carry(point: WorldPoint, [x, y, yaw]: [f64; 3]) -> WorldPoint {
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
