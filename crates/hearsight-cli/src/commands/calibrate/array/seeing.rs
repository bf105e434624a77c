//! What the cameras of a room see while it is calibrated: heads that are followed, and faces found anew near them.

use hearsight::calibrate::speech::FaceSight;
use hearsight::core::camera::Camera;
use hearsight::core::record::{BoxRecord, Scene};
use hearsight::core::room::Room;
use hearsight::core::{GrayView, Instant, Moment, VideoFrame};
use hearsight::tracking::percepts::FaceWindowSettings;
use hearsight::tracking::sight_and_sound::{AssociationSettings, SightLine};
use hearsight::vision::cascade::resize::{Range, Resizer};
use hearsight::vision::cascade::{Cascade, CascadeDetector, DetectOptions};

/// The height of a mouth in the box of a head.
const MOUTH: f64 = 0.75;
/// Width of a cascade's box over that of the head in it.
const FACE: f64 = 1.0 / 0.85;
/// The mouth in a cascade's box, from its top.
const MOUTH_IN_FACE: f64 = 0.78;
/// How far around a head a face is looked for, widths of the head: a tracker that lags is a head behind.
const AROUND: f64 = 1.6;
/// Pictures of smaller heads are made larger until a head is so wide, pixels: cascades know faces of 20 and more.
const WIDE_PX: f64 = 40.0;
/// Sizes of faces, as shares of the width of the head.
const SIZES: (f64, f64) = (0.8, 1.6);

/// Collects lines of sight.
pub(super) struct Seeing {
    detector: Option<CascadeDetector>,
    resizer: Resizer,
    enlarged: Vec<u8>,
    /// Heads, as they are followed.
    pub(super) followed: Vec<FaceSight>,
    /// Faces, found anew in single pictures.
    pub(super) found: Vec<FaceSight>,
}

impl Seeing {
    /// Sees nothing yet. Without the cascade of faces nothing is found anew.
    pub(super) fn new() -> Self {
        let cascade = FaceWindowSettings::default().cascades.into_iter().next();
        let cascade = cascade.and_then(|cascade| Cascade::load(&cascade.file).ok());
        let detector =
            cascade.and_then(|cascade| CascadeDetector::new(cascade, DetectOptions::default()).ok());
        Self {
            detector,
            resizer: Resizer::default(),
            enlarged: Vec::new(),
            followed: Vec::new(),
            found: Vec::new(),
        }
    }

    /// Takes in the heads in the new pictures of a moment.
    pub(super) fn see(&mut self, room: &Room, scene: &Scene, moment: &Moment) {
        for (track, view) in scene
            .tracks
            .iter()
            .flat_map(|track| track.views.iter().map(move |view| (track, view)))
        {
            let Some(number) = room.cameras.iter().position(|camera| camera.name == view.camera) else {
                continue;
            };
            let frame = moment.video.get(number).and_then(|frame| frame.get());
            let (Some(frame), Some(calibration)) = (frame, room.cameras[number].calibration) else {
                continue;
            };
            let line = Line {
                calibration: &calibration,
                camera: number,
                track: track.id,
                time: frame.time,
            };
            let [x, y] = view.deviation_px;
            self.followed.extend(line.of_head(&view.head, x.max(y)));
            let face = self.face_near(frame, &view.head);
            self.found.extend(face.and_then(|face| line.of_face(&face)));
        }
    }

    /// The face that a cascade finds near a head, if it finds one.
    fn face_near(&mut self, frame: &VideoFrame, head: &BoxRecord) -> Option<BoxRecord> {
        let detector = self.detector.as_mut()?;
        let reach = AROUND * head.width;
        let (width, height) = (frame.width as f64, frame.height as f64);
        let left = (head.left + head.width / 2.0 - reach).max(0.0).floor();
        let right = (head.left + head.width / 2.0 + reach).min(width).floor();
        let top = (head.top + head.height / 2.0 - reach).max(0.0).floor();
        let bottom = (head.top + head.height / 2.0 + reach).min(height).floor();
        if !(head.width > 4.0 && right - left > head.width && bottom - top > head.width) {
            return None;
        }
        let times = (WIDE_PX / head.width).max(1.0);
        let size = [right - left, bottom - top].map(|length| (length * times) as usize);
        let side = |whole: f64, start: f64, count: usize| Range {
            whole: (whole * times).round() as usize,
            start: start * times,
            count,
            turned: false,
        };
        let (across, down) = (side(width, left, size[0]), side(height, top, size[1]));
        self.resizer
            .resize_part(frame.luma_view(), across, down, &mut self.enlarged);
        let limit = |share: f64| {
            let side = (share * head.width * times).round() as u32;
            (side, side)
        };
        detector.limit(limit(SIZES.0), limit(SIZES.1));
        let faces = detector.detect(GrayView::new(size[0], size[1], &self.enlarged)?);
        let face = faces.iter().max_by_key(|face| face.neighbours)?.bounds;
        let scaled = |pixels: f32| f64::from(pixels) / times;
        Some(BoxRecord {
            left: left + scaled(face.left),
            top: top + scaled(face.top),
            width: scaled(face.width),
            height: scaled(face.height),
        })
    }
}

/// Whose line of sight it is.
struct Line<'a> {
    calibration: &'a Camera,
    camera: usize,
    track: u64,
    time: Instant,
}

impl Line<'_> {
    fn of_head(&self, head: &BoxRecord, deviation_px: f64) -> Option<FaceSight> {
        let pixel = (head.left + head.width / 2.0, head.top + MOUTH * head.height);
        self.through(pixel, deviation_px, FACE * head.width)
    }

    fn of_face(&self, face: &BoxRecord) -> Option<FaceSight> {
        let pixel = (
            face.left + face.width / 2.0,
            face.top + MOUTH_IN_FACE * face.height,
        );
        self.through(pixel, 0.0, face.width)
    }

    /// Through a mouth; a tenth of a face is added to the deviation: a mouth is not where a box says.
    fn through(&self, pixel: (f64, f64), deviation_px: f64, width_px: f64) -> Option<FaceSight> {
        let line = SightLine::new(
            self.calibration,
            (pixel.0 as f32, pixel.1 as f32),
            (0.1 * width_px).hypot(deviation_px),
            width_px,
            0.05 * width_px,
            Some(AssociationSettings::default().face_width()),
        )?;
        Some(FaceSight {
            camera: self.camera,
            track: self.track,
            time: self.time,
            ray: line.ray,
            deviation_rad: line.deviation_rad,
            range_m: line.range_m,
        })
    }
}
