//! Does the order of the channels agree with what is seen? Whoever is heard on the left should be seen on the left.
//!
//! Each clear delay votes: for the channels as declared where some track fits it, against them where some track fits
//! the opposite delay. Delays that point outside the picture, as declared or swapped, have no vote: whoever spoke
//! there is not seen, and somebody silent would be taken for the speaker.

use super::CheckReport;
use super::sound::Heard;
use hearsight_core::microphones::MicrophoneArray;
use hearsight_core::record::{BoxRecord, Scene, TrackPhase};
use hearsight_core::room::{ArraySensor, CameraSensor, Room};
use hearsight_core::{Camera, DistortedPixel};

/// Height of a head, metres: from its size in the picture follows its distance.
const HEAD_HEIGHT_M: f64 = 0.24;
/// Width of the picture where no calibration says it, radians.
const FIELD_OF_VIEW_RAD: f64 = 1.05;
/// Distance of people who are heard at the edge of the picture, metres.
const EDGE_DISTANCE_M: f64 = 3.0;
/// A track fits a delay within this part of the longest possible one.
const TOLERANCE: f64 = 0.1;
/// Fewer votes than this tell nothing.
const FEWEST: u32 = 12;
/// So many times more votes are needed before anything is said.
const CLEARLY: u32 = 2;

/// Compares sound and picture of one array.
#[derive(Default)]
pub(super) struct Order {
    next: usize,
    declared: u32,
    swapped: u32,
}

impl Order {
    /// Takes the delays around the time of a scene.
    pub(super) fn see(&mut self, room: &Room, heard: &Heard, scene: &Scene) {
        let Some(array) = room.arrays.get(heard.array) else {
            return;
        };
        let Some(camera) = array.camera.and_then(|camera| room.cameras.get(camera)) else {
            return;
        };
        let Some(geometry) = Geometry::new(room, array, camera) else {
            return;
        };
        let half = heard.frame_s / 2.0;
        while let Some(delay) = heard.delays.get(self.next) {
            let offset = delay.time.seconds() - scene.time_s;
            if offset > half {
                break;
            }
            self.next += 1;
            if offset >= -half && geometry.shows(delay.delay_s) && geometry.shows(-delay.delay_s) {
                self.vote(&geometry, delay.delay_s, scene);
            }
        }
    }

    fn vote(&mut self, geometry: &Geometry<'_>, delay_s: f64, scene: &Scene) {
        let visible = scene
            .tracks
            .iter()
            .filter(|track| track.phase == TrackPhase::Visible);
        let views = visible
            .flat_map(|track| &track.views)
            .filter(|view| view.camera == geometry.camera.name);
        let (mut declared_s, mut swapped_s) = (f64::INFINITY, f64::INFINITY);
        for expected_s in views.filter_map(|view| geometry.delay_of_head_s(view.head)) {
            declared_s = declared_s.min((expected_s - delay_s).abs());
            swapped_s = swapped_s.min((expected_s + delay_s).abs());
        }
        let tolerance_s = TOLERANCE * geometry.longest_s();
        // Both or neither: in the middle, or between two people who stand symmetrically.
        match (declared_s < tolerance_s, swapped_s < tolerance_s) {
            (true, false) => self.declared += 1,
            (false, true) => self.swapped += 1,
            _ => {}
        }
    }

    pub(super) fn report(&self, array: &ArraySensor, report: &mut CheckReport) {
        const ASPECT: &str = "order of channels";
        if array.camera.is_none() || array.channels < 2 {
            return;
        }
        let Self {
            declared, swapped, ..
        } = self;
        if declared + swapped < FEWEST {
            let what = "not compared: too seldom was somebody both seen and heard beside the middle";
            return report.pass(&array.name, ASPECT, what);
        }
        let what =
            format!("{declared} delays agree with what is seen, {swapped} would with the channels swapped");
        if *swapped > CLEARLY * declared {
            let cure = "left and right seem swapped: try `channels = [1, 0]`, or correct `microphones`";
            report.warn(&array.name, ASPECT, what, cure);
        } else {
            report.pass(&array.name, ASPECT, what);
        }
    }
}

/// Where sounds are in one picture.
struct Geometry<'a> {
    camera: &'a CameraSensor,
    speed_m_s: f64,
    baseline_m: f64,
    /// The microphones, where their places and the camera's lens are known.
    microphones: Option<(MicrophoneArray, &'a Camera)>,
}

impl<'a> Geometry<'a> {
    fn new(room: &Room, array: &ArraySensor, camera: &'a CameraSensor) -> Option<Self> {
        let speed_m_s = room.speed_of_sound_m_s;
        let places = MicrophoneArray::new(array.microphones.clone()).ok();
        let places = places
            .map(|places| places.with_speed_of_sound(speed_m_s))
            .transpose()
            .ok()?;
        let baseline_m = places
            .as_ref()
            .and_then(|places| places.pair(0, 1))
            .map_or(1.0, |pair| pair.baseline_m());
        Some(Self {
            camera,
            speed_m_s,
            baseline_m,
            microphones: places.zip(camera.calibration.as_ref()),
        })
    }

    fn longest_s(&self) -> f64 {
        self.baseline_m / self.speed_m_s
    }

    /// Whether a delay belongs to a place inside the picture.
    fn shows(&self, delay_s: f64) -> bool {
        let (width, middle) = (self.camera.width as f64, self.camera.height as f64 / 2.0);
        let edge = |u| self.delay_s(u, middle, EDGE_DISTANCE_M);
        let (Some(left), Some(right)) = (edge(0.0), edge(width)) else {
            return false;
        };
        (left.min(right)..left.max(right)).contains(&delay_s)
    }

    /// Delay of the first pair for a voice from this head, seconds.
    fn delay_of_head_s(&self, head: BoxRecord) -> Option<f64> {
        let (u, v) = (head.left + head.width / 2.0, head.top + 0.75 * head.height);
        let distance_m = match &self.microphones {
            Some((_, lens)) => {
                let ray = lens.ray(DistortedPixel::new(u - 0.5, v - 0.5))?;
                // Pixels a metre fall with the distance: one step is exact but for distortion.
                let pixels_per_metre = lens.pixels_per_metre(ray.at(EDGE_DISTANCE_M))?;
                EDGE_DISTANCE_M * pixels_per_metre * HEAD_HEIGHT_M / head.height.max(1.0)
            }
            None => EDGE_DISTANCE_M,
        };
        self.delay_s(u, v, distance_m)
    }

    /// Delay of the first pair for a sound at an edge-based pixel and a distance, seconds.
    fn delay_s(&self, u: f64, v: f64, distance_m: f64) -> Option<f64> {
        if let Some((microphones, lens)) = &self.microphones {
            let ray = lens.ray(DistortedPixel::new(u - 0.5, v - 0.5))?;
            return microphones.delay_s(0, 1, ray.at(distance_m));
        }
        // Without a calibration: the camera midway between the microphones, the first one on the left.
        let half_width = self.camera.width as f64 / 2.0;
        let tangent = (u - half_width) / half_width * (FIELD_OF_VIEW_RAD / 2.0).tan();
        Some(self.longest_s() * tangent / tangent.hypot(1.0))
    }
}
