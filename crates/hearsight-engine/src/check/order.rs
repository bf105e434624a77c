//! Does the order of the channels agree with what is seen? Whoever is heard on the left should be seen on the left.
//!
//! For each clear delay the track is taken that fits it best, once with the channels as declared and once swapped. If
//! the swapped order fits clearly better, the channels are likely the wrong way round.

use super::CheckReport;
use super::sound::Heard;
use hearsight_core::DistortedPixel;
use hearsight_core::microphones::MicrophoneArray;
use hearsight_core::record::{BoxRecord, Scene, TrackPhase};
use hearsight_core::room::{ArraySensor, CameraSensor, Room};

/// Height of a head, metres: from its size in the picture follows its distance.
const HEAD_HEIGHT_M: f64 = 0.24;
/// Width of the picture where no calibration says it, radians.
const FIELD_OF_VIEW_RAD: f64 = 1.05;
/// Fewer comparisons than this tell nothing.
const FEWEST: usize = 20;
/// The swapped order must fit by this factor better before anything is said.
const CLEARLY: f64 = 0.6;

/// Compares sound and picture of one array.
#[derive(Default)]
pub(super) struct Order {
    next: usize,
    declared_s: Vec<f64>,
    swapped_s: Vec<f64>,
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
        let half = heard.frame_s / 2.0;
        while let Some(delay) = heard.delays.get(self.next) {
            let offset = delay.time.seconds() - scene.time_s;
            if offset > half {
                break;
            }
            self.next += 1;
            if offset < -half {
                continue;
            }
            let expected = scene
                .tracks
                .iter()
                .filter(|track| track.phase == TrackPhase::Visible)
                .flat_map(|track| track.views.iter().filter(|view| view.camera == camera.name))
                .filter_map(|view| expected_delay_s(room, array, camera, view.head));
            let (mut declared, mut swapped) = (f64::INFINITY, f64::INFINITY);
            for expected in expected {
                declared = declared.min((expected - delay.delay_s).abs());
                swapped = swapped.min((expected + delay.delay_s).abs());
            }
            if declared.is_finite() {
                self.declared_s.push(declared);
                self.swapped_s.push(swapped);
            }
        }
    }

    pub(super) fn report(&self, array: &ArraySensor, report: &mut CheckReport) {
        const ASPECT: &str = "order of channels";
        if array.camera.is_none() || array.channels < 2 {
            return;
        }
        if self.declared_s.len() < FEWEST {
            let what = "nobody was seen and heard for long enough to compare left and right";
            return report.pass(&array.name, ASPECT, what);
        }
        let declared = median(&self.declared_s);
        let swapped = median(&self.swapped_s);
        let (declared_ms, swapped_ms) = (1e3 * declared, 1e3 * swapped);
        let what = format!(
            "delays are {declared_ms:.2} ms off what is seen, {swapped_ms:.2} ms with the first two channels swapped"
        );
        if swapped < CLEARLY * declared {
            let cure =
                "the channels seem the wrong way round: try `channels = [1, 0]`, or correct `microphones`";
            report.warn(&array.name, ASPECT, what, cure);
        } else {
            report.pass(&array.name, ASPECT, what);
        }
    }
}

/// Delay of the first pair for a voice from this head, seconds.
fn expected_delay_s(room: &Room, array: &ArraySensor, camera: &CameraSensor, head: BoxRecord) -> Option<f64> {
    let (u, v) = (head.left + head.width / 2.0, head.top + 0.75 * head.height);
    let lens = camera.calibration.as_ref();
    if let (Some(lens), Ok(microphones)) = (lens, MicrophoneArray::new(array.microphones.clone())) {
        let ray = lens.ray(DistortedPixel::new(u - 0.5, v - 0.5))?;
        // Pixels a metre fall with the distance: one step from three metres is exact but for distortion.
        let reference_m = 3.0;
        let pixels_per_metre = lens.pixels_per_metre(ray.at(reference_m))?;
        let distance_m = reference_m * pixels_per_metre * HEAD_HEIGHT_M / head.height.max(1.0);
        let microphones = microphones.with_speed_of_sound(room.speed_of_sound_m_s).ok()?;
        return microphones.delay_s(0, 1, ray.at(distance_m));
    }
    // Without a calibration: the camera midway between the microphones, the first one on the left.
    let half_width = camera.width as f64 / 2.0;
    let tangent = (u - half_width) / half_width * (FIELD_OF_VIEW_RAD / 2.0).tan();
    let baseline_m = match array.microphones.as_slice() {
        [first, second, ..] => first.distance_m(*second),
        _ => 1.0,
    };
    Some(baseline_m * tangent / tangent.hypot(1.0) / room.speed_of_sound_m_s)
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}
