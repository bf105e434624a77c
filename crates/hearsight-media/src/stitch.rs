//! Several cameras around one point as one: their pictures stitched on a cylinder.
//!
//! Where every pixel comes from is found once; a picture then costs one pass over the panorama and allocates nothing. Seams
//! are blended. The cameras are read side by side; the first one keeps the time.

mod map;

pub use map::StitchOptions;

use hearsight_core::camera::{Camera, InvalidParameter};
use hearsight_core::source::{Delivery, VideoFormat, VideoSource};
use hearsight_core::{Fault, FaultKind, Span, VideoFrame};
use map::{Map, Part};

/// Why pictures cannot be stitched.
#[derive(Debug, thiserror::Error)]
pub enum StitchError {
    /// There are no cameras.
    #[error("no camera was given; a panorama needs at least two that overlap")]
    NoCameras,
    /// A camera delivers pictures of another size than its calibration is for.
    #[error("camera {number} delivers {found:?} pixels, its calibration is for {calibrated:?}")]
    Size {
        /// Which camera, from 0.
        number: usize,
        /// Width and height of its pictures.
        found: [usize; 2],
        /// Those of the calibration.
        calibrated: [usize; 2],
    },
    /// A picture is too large or an option is out of its range.
    #[error("`{option}` is {value}; {cure}")]
    Option {
        /// Which option.
        option: &'static str,
        /// What it is.
        value: f64,
        /// What to do.
        cure: &'static str,
    },
    /// The cylinder cannot be.
    #[error(transparent)]
    Cylinder(#[from] InvalidParameter),
}

/// One camera of a ring.
pub struct StitchedCamera {
    /// Its name, for faults.
    pub name: String,
    /// Where its pictures come from.
    pub source: Box<dyn VideoSource>,
    /// Its lens and place, for pictures of the source's size.
    pub calibration: Camera,
}

/// The panorama of several cameras.
pub struct StitchedVideo {
    cameras: Vec<Reader>,
    format: VideoFormat,
    panorama: Camera,
    map: Map,
    covered: f64,
}

struct Reader {
    name: String,
    source: Box<dyn VideoSource>,
    frame: VideoFrame,
    /// Whether `frame` holds a picture.
    seen: bool,
    ended: bool,
}

impl StitchedVideo {
    /// Opens a panorama over cameras that look outwards from about one point.
    ///
    /// # Errors
    /// [`StitchError`] where there are no cameras, sizes contradict each other, or an option is out of its range.
    pub fn new(cameras: Vec<StitchedCamera>, options: &StitchOptions) -> Result<Self, StitchError> {
        let option = |option, value, cure| Err(StitchError::Option { option, value, cure });
        for (name, size) in [("width", options.width), ("height", options.height)] {
            if !(16..=16_384).contains(&size) {
                return option(name, size as f64, "give 16 to 16384 pixels");
            }
        }
        if !(options.radius_m.is_finite() && options.radius_m > 0.0) {
            return option("radius_m", options.radius_m, "give metres above 0");
        }
        if !(options.seam > 0.0 && options.seam <= 1.0) {
            return option("seam", options.seam, "give a share above 0, at most 1");
        }
        let Some(first) = cameras.first() else {
            return Err(StitchError::NoCameras);
        };
        let (interval, start) = (first.source.format().interval, first.source.format().start);
        for (number, camera) in cameras.iter().enumerate() {
            let format = camera.source.format();
            let (found, calibrated) = (
                [format.width, format.height],
                [camera.calibration.width, camera.calibration.height],
            );
            if found != calibrated || found.iter().any(|size| *size > usize::from(u16::MAX)) {
                return Err(StitchError::Size {
                    number,
                    found,
                    calibrated,
                });
            }
        }
        let lenses: Vec<Camera> = cameras.iter().map(|camera| camera.calibration).collect();
        let panorama = map::panorama(&lenses, options)?;
        let map = Map::new(&lenses, &panorama, options);
        let format = VideoFormat {
            width: options.width,
            height: options.height,
            interval,
            frames: cameras
                .iter()
                .filter_map(|camera| camera.source.format().frames)
                .min(),
            start,
            live: cameras.iter().any(|camera| camera.source.format().live),
        };
        Ok(Self {
            cameras: cameras
                .into_iter()
                .map(|camera| Reader {
                    name: camera.name,
                    source: camera.source,
                    frame: VideoFrame::default(),
                    seen: false,
                    ended: false,
                })
                .collect(),
            format,
            panorama,
            covered: map.covered(),
            map,
        })
    }

    /// Lens and place of the panorama.
    pub fn calibration(&self) -> &Camera {
        &self.panorama
    }

    /// Share of the panorama that at least one camera sees, 0 to 1; the rest is black.
    pub fn covered(&self) -> f64 {
        self.covered
    }

    fn compose(&self, frame: &mut VideoFrame) {
        let pixels = self.panorama.width * self.panorama.height;
        frame.rgb.resize(3 * pixels, 0);
        frame.luma.resize(pixels, 0);
        let (colours, _) = frame.rgb.as_chunks_mut::<3>();
        for ((parts, colour), luma) in self.map.parts.iter().zip(colours).zip(&mut frame.luma) {
            let mut sums = [0_u32; 4];
            for part in parts.iter().filter(|part| part.share > 0) {
                let Some(reader) = self
                    .cameras
                    .get(usize::from(part.camera))
                    .filter(|reader| reader.seen)
                else {
                    continue;
                };
                let sample = sample(&reader.frame, part);
                for (sum, value) in sums.iter_mut().zip(sample) {
                    *sum += u32::from(part.share) * value;
                }
            }
            let [red, green, blue, grey] = sums.map(|sum| (sum >> 8).min(255) as u8);
            *colour = [red, green, blue];
            *luma = grey;
        }
    }
}

/// Red, green, blue and luma between four pixels, 0 to 255.
fn sample(frame: &VideoFrame, part: &Part) -> [u32; 4] {
    let at = usize::from(part.row) * frame.width + usize::from(part.column);
    let (across, down) = (u32::from(part.across), u32::from(part.down));
    let weights = [
        (at, (256 - across) * (256 - down)),
        (at + 1, across * (256 - down)),
        (at + frame.width, (256 - across) * down),
        (at + frame.width + 1, across * down),
    ];
    let mut sums = [0_u32; 4];
    for (place, weight) in weights {
        let Some(pixel) = frame.rgb.get(3 * place..3 * place + 3) else {
            continue;
        };
        for (sum, value) in sums.iter_mut().zip(pixel) {
            *sum += weight * u32::from(*value);
        }
        sums[3] += weight * u32::from(frame.luma.get(place).copied().unwrap_or(0));
    }
    sums.map(|sum| sum >> 16)
}

impl Reader {
    /// Reads on until the picture is not older than `half` before `time`; a camera that has none yet keeps its old one.
    fn follow(&mut self, time: hearsight_core::Instant, half: Span, faults: &mut Vec<Fault>) {
        let earliest = time - half;
        while !self.ended {
            if self.seen && self.frame.time >= earliest {
                return;
            }
            match self.source.read(&mut self.frame, faults) {
                Delivery::Data => self.seen = true,
                Delivery::Pending => return,
                Delivery::End => {
                    self.ended = true;
                    faults.push(Fault {
                        sensor: self.name.clone(),
                        time_s: time.seconds(),
                        kind: FaultKind::EndedEarly,
                        detail: "ended before the other cameras of its panorama; its part stays as it was"
                            .into(),
                    });
                }
            }
        }
    }
}

impl VideoSource for StitchedVideo {
    fn format(&self) -> &VideoFormat {
        &self.format
    }

    fn read(&mut self, frame: &mut VideoFrame, faults: &mut Vec<Fault>) -> Delivery {
        let Some((first, others)) = self.cameras.split_first_mut() else {
            return Delivery::End;
        };
        let delivery = first.source.read(&mut first.frame, faults);
        if delivery != Delivery::Data {
            return delivery;
        }
        first.seen = true;
        let time = first.frame.time;
        let half = Span::from_nanoseconds(self.format.interval.nanoseconds() / 2);
        for other in others {
            other.follow(time, half, faults);
        }
        frame.time = time;
        frame.number = first.frame.number;
        (frame.width, frame.height) = (self.format.width, self.format.height);
        self.compose(frame);
        Delivery::Data
    }
}

#[cfg(test)]
#[path = "stitch/tests.rs"]
mod tests;
