//! Pictures: are there any, at the rate that was promised, and is there something on them?

use super::CheckReport;
use hearsight_core::room::CameraSensor;
use hearsight_core::{Instant, VideoFrame};

/// Mean brightness below this is a covered lens, of 255.
const DARK: f64 = 8.0;
/// Deviation of brightness below this is a picture of nothing, of 255.
const FLAT: f64 = 3.0;
/// Every so many frames the pixels are looked at.
const LOOK_EVERY: u64 = 25;
/// A rate off by more than this part is reported.
const RATE_TOLERANCE: f64 = 0.02;

/// Looks at the frames of one camera.
pub(super) struct Looker {
    name: String,
    frames: u64,
    pub(super) first: Option<Instant>,
    last: Option<Instant>,
    looked: u64,
    brightness: f64,
    deviation: f64,
}

impl Looker {
    pub(super) fn new(name: &str) -> Self {
        let name = name.to_owned();
        Self {
            name,
            frames: 0,
            first: None,
            last: None,
            looked: 0,
            brightness: 0.0,
            deviation: 0.0,
        }
    }

    pub(super) fn look(&mut self, frame: &VideoFrame) {
        if self.frames.is_multiple_of(LOOK_EVERY) && !frame.luma.is_empty() {
            let count = frame.luma.len() as f64;
            let mean = frame.luma.iter().map(|&value| f64::from(value)).sum::<f64>() / count;
            let square = frame
                .luma
                .iter()
                .map(|&value| (f64::from(value) - mean).powi(2))
                .sum::<f64>()
                / count;
            self.looked += 1;
            self.brightness += mean;
            self.deviation += square.sqrt();
        }
        self.frames += 1;
        self.first.get_or_insert(frame.time);
        self.last = Some(frame.time);
    }

    pub(super) fn report(&self, camera: &CameraSensor, report: &mut CheckReport) {
        let (Some(first), Some(last)) = (self.first, self.last) else {
            let cure = "check `start`, `from` and `until`, and whether the file can be played".to_owned();
            return report.fail(&self.name, "frames", "no frame came", Some(cure));
        };
        let looked = self.looked.max(1) as f64;
        let (brightness, deviation) = (self.brightness / looked, self.deviation / looked);
        if brightness < DARK || deviation < FLAT {
            let what =
                format!("nothing on the picture: mean {brightness:.0}, deviation {deviation:.1} of 255");
            report.warn(
                &self.name,
                "picture",
                what,
                "check the lens, the light and the exposure",
            );
        } else {
            report.pass(
                &self.name,
                "picture",
                format!("mean {brightness:.0}, deviation {deviation:.0} of 255"),
            );
        }
        let nominal = 1.0 / camera.interval.seconds();
        let rate = (self.frames - 1) as f64 / (last - first).seconds();
        if self.frames > 2 && (rate / nominal - 1.0).abs() > RATE_TOLERANCE {
            let what = format!("{rate:.2} frames a second came, {nominal:.2} were promised");
            report.warn(
                &self.name,
                "rate",
                what,
                "frames are missing or the time stamps are wrong: record again",
            );
        } else {
            let (first, last) = (first.seconds(), last.seconds());
            let what = format!(
                "{} frames from {first:.2} s to {last:.2} s, {nominal:.2} a second",
                self.frames
            );
            report.pass(&self.name, "frames", what);
        }
    }
}
