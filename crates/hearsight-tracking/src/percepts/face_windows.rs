//! Raw, ungrouped windows of face cascades: near known faces in every picture, and all over the picture in slices.
//!
//! A search of a large picture at all sizes takes far longer than the picture lasts. It is therefore cut into slices, a
//! tile of the picture in one octave of sizes each, of about equal cost, and spread over [`FaceWindowSettings::full_search_s`].
//! Around known faces windows are sought in every picture. Light is equalized a window: the cascade divides every
//! feature by the window's own contrast, and its features are blind to its mean (section 3.1 of Pnevmatikakis and
//! Talantzis).

use super::faces::{CameraError, FaceCascade};
use hearsight_core::{GrayView, Rectangle, Span, VideoFrame};
use hearsight_vision::VisionError;
use hearsight_vision::cascade::{Cascade, CascadeDetector, DetectOptions};
use serde::{Deserialize, Serialize};

/// How windows are sought.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FaceWindowSettings {
    /// The cascades. Default: OpenCV's `haarcascade_frontalface_alt2.xml` where Debian's `opencv-data` puts it.
    pub cascades: Vec<FaceCascade>,
    /// Smallest face, pixels, at least 8. Default 24. Raising it is much faster.
    pub smallest_px: u32,
    /// Largest face, pixels; 0 is half the picture's height. Default 0.
    pub largest_px: u32,
    /// Time over which the whole picture is searched once, seconds, above 0. Default 5; the first time takes a fifth of it.
    /// Raising it finds new faces later and is faster.
    pub full_search_s: f64,
    /// By how much the mean of 8 x 8 pixels must have changed for a part of the picture to be searched again before its
    /// fifth turn, codes of 0 to 255, 0 or more; 0 searches always. Default 5: where nothing stirs there is nobody new.
    pub change: f32,
    /// How far around a known face windows are sought, face widths. Default 0.6.
    pub margin: f32,
    /// Smallest and largest window around a known face, as shares of its width. Default 0.8 and 1.25.
    pub sizes: (f32, f32),
    /// Ratio of one size to the next, 1.01 to 4. Default 1.1.
    pub scale_step: f64,
}

impl Default for FaceWindowSettings {
    fn default() -> Self {
        Self {
            cascades: vec![FaceCascade {
                file: "/usr/share/opencv4/haarcascades/haarcascade_frontalface_alt2.xml".into(),
                mirror: Default::default(),
            }],
            smallest_px: 24,
            largest_px: 0,
            full_search_s: 5.0,
            change: 5.0,
            margin: 0.6,
            sizes: (0.8, 1.25),
            scale_step: 1.1,
        }
    }
}

/// A window that passed a cascade: a face's box, width and height alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceWindow {
    /// Column of its middle, pixels from the picture's left edge.
    pub x: f32,
    /// Row of its middle, pixels from the picture's top edge.
    pub y: f32,
    /// Its width, pixels.
    pub width: f32,
}

/// What is remembered from picture to picture.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FaceWindowState {
    /// The slice that comes next.
    slice: usize,
    /// Slices that should have been searched by now.
    owed: f64,
    /// What each slice showed when it was searched last; none for those that were not yet.
    shown: Vec<Shown>,
}

/// What a part of the picture showed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Shown {
    /// Means of its blocks, row by row.
    means: Vec<u8>,
    /// How often its turn has passed since, because nothing had changed.
    passed: u8,
}

/// A tile of the picture in an octave of sizes.
#[derive(Clone, Copy, Debug)]
struct Slice {
    tile: Rectangle,
    smallest: u32,
    largest: u32,
}

/// Searches for windows, with the buffers that takes.
pub struct FaceWindowPercepts {
    settings: FaceWindowSettings,
    detectors: Vec<CascadeDetector>,
    slices: Vec<Slice>,
    size: (usize, usize),
    state: FaceWindowState,
    part: Vec<u8>,
    means: Vec<u8>,
    windows: Vec<FaceWindow>,
}

/// Side of a block whose mean is compared, pixels.
const BLOCK: usize = 8;
/// A part of the picture in which nothing changes is searched every so many turns.
const MOST_PASSED: u8 = 4;
/// The first search of the whole picture is this many times as fast.
const FIRST: f64 = 5.0;
/// Tiles are this many times as wide as the smallest face of their octave.
const TILE: u32 = 8;

impl FaceWindowPercepts {
    /// A search that has seen nothing yet.
    ///
    /// # Errors
    /// [`CameraError`] where a setting is out of its range or a cascade cannot be read.
    pub fn new(settings: FaceWindowSettings) -> Result<Self, CameraError> {
        let check = |holds: bool, name: &'static str, value: f64, allowed: &'static str| {
            if holds {
                Ok(())
            } else {
                Err(VisionError::Parameter { name, value, allowed })
            }
        };
        let FaceWindowSettings {
            smallest_px,
            full_search_s,
            change,
            margin,
            sizes,
            ..
        } = settings;
        check(
            (8..=10_000).contains(&smallest_px),
            "smallest_px",
            smallest_px.into(),
            "8 to 10000",
        )?;
        check(
            full_search_s > 0.0 && full_search_s.is_finite(),
            "full_search_s",
            full_search_s,
            "above 0",
        )?;
        check((0.0..=10.0).contains(&margin), "margin", margin.into(), "0 to 10")?;
        check(
            (0.0..=255.0).contains(&change),
            "change",
            change.into(),
            "0 to 255",
        )?;
        let fits = sizes.0 > 0.0 && sizes.0 <= 1.0 && sizes.1 >= 1.0 && sizes.1 <= 10.0;
        check(fits, "sizes", sizes.0.into(), "a share to 1 and one from 1 to 10")?;
        let detectors = settings
            .cascades
            .iter()
            .map(|cascade| {
                let options = DetectOptions {
                    scale_step: settings.scale_step,
                    neighbours: 0,
                    mirror: cascade.mirror,
                    ..DetectOptions::default()
                };
                Ok(CascadeDetector::new(Cascade::load(&cascade.file)?, options)?)
            })
            .collect::<Result<_, CameraError>>()?;
        Ok(Self {
            settings,
            detectors,
            slices: Vec::new(),
            size: (0, 0),
            state: FaceWindowState::default(),
            part: Vec::new(),
            means: Vec::new(),
            windows: Vec::new(),
        })
    }

    /// What is remembered.
    pub fn state(&self) -> &FaceWindowState {
        &self.state
    }

    /// Goes on from what was remembered.
    pub fn set_state(&mut self, state: FaceWindowState) {
        self.state = state;
    }

    /// The windows of the newest picture: those around known faces first.
    pub fn windows(&self) -> &[FaceWindow] {
        &self.windows
    }

    /// Searches a new picture, `elapsed` after the one before, around the `known` faces and in the slices whose turn it
    /// is.
    pub fn search(&mut self, frame: &VideoFrame, elapsed: Span, known: impl Iterator<Item = Rectangle>) {
        let picture = frame.luma_view();
        self.windows.clear();
        if self.size != (picture.width, picture.height) {
            self.size = (picture.width, picture.height);
            self.slices = slices(&self.settings, picture.width, picture.height);
        }
        for face in known {
            let reach = face.width * (1.0 + 2.0 * self.settings.margin);
            let (x, y) = face.centre();
            let around = Rectangle::from_centre(x, y, reach, reach);
            let (least, most) = self.settings.sizes;
            let smallest = (face.width * least).max(8.0) as u32;
            self.scan(picture, around, smallest, (face.width * most).ceil() as u32);
        }
        if self.slices.is_empty() {
            return;
        }
        self.state.shown.resize_with(self.slices.len(), Shown::default);
        let count = self.slices.len() as f64;
        let is_first = self.state.shown.iter().any(|shown| shown.means.is_empty());
        let speed = if is_first { FIRST } else { 1.0 };
        let share = speed * elapsed.seconds().max(0.0) / self.settings.full_search_s;
        // After a gap everything is searched once, and no more.
        self.state.owed = (self.state.owed + share * count).min(count);
        while self.state.owed >= 1.0 {
            self.state.owed -= 1.0;
            self.state.slice %= self.slices.len();
            let Slice {
                tile,
                smallest,
                largest,
            } = self.slices[self.state.slice];
            block_means(picture, tile, &mut self.means);
            let shown = &mut self.state.shown[self.state.slice];
            self.state.slice += 1;
            if shown.passed < MOST_PASSED && !differ(&shown.means, &self.means, self.settings.change) {
                shown.passed += 1;
                continue;
            }
            shown.passed = 0;
            shown.means.clone_from(&self.means);
            self.scan(picture, tile, smallest, largest);
        }
    }

    /// All windows of these sizes in a part of the picture.
    fn scan(&mut self, picture: GrayView<'_>, part: Rectangle, smallest: u32, largest: u32) {
        let [left, top, right, bottom] = clipped(picture, part);
        let (width, height) = (right.saturating_sub(left), bottom.saturating_sub(top));
        if (width.min(height) as u32) < smallest {
            return;
        }
        self.part.clear();
        for row in top..bottom {
            self.part.extend_from_slice(&picture.row(row)[left..right]);
        }
        let Some(part) = GrayView::new(width, height, &self.part) else {
            return;
        };
        for detector in &mut self.detectors {
            detector.limit((smallest, smallest), (largest, largest));
            self.windows
                .extend(detector.windows(part).iter().map(|window| FaceWindow {
                    x: left as f32 + window.left as f32 + 0.5 * window.width as f32,
                    y: top as f32 + window.top as f32 + 0.5 * window.height as f32,
                    width: window.width as f32,
                }));
        }
    }
}

/// The columns and rows of a part that are in the picture: from left and top, to before right and bottom.
fn clipped(picture: GrayView<'_>, part: Rectangle) -> [usize; 4] {
    let clip = |value: f32, most: usize| (value.max(0.0) as usize).min(most);
    [
        clip(part.left, picture.width),
        clip(part.top, picture.height),
        clip(part.right().ceil(), picture.width),
        clip(part.bottom().ceil(), picture.height),
    ]
}

/// Means of the blocks of a part of the picture, row by row; those at its right and lower edge may be smaller.
fn block_means(picture: GrayView<'_>, part: Rectangle, means: &mut Vec<u8>) {
    let [left, top, right, bottom] = clipped(picture, part);
    means.clear();
    for row in (top..bottom).step_by(BLOCK) {
        let high = BLOCK.min(bottom - row);
        for column in (left..right).step_by(BLOCK) {
            let end = (column + BLOCK).min(right);
            let sum: u32 = (row..row + high)
                .map(|row| {
                    picture.row(row)[column..end]
                        .iter()
                        .map(|value| u32::from(*value))
                        .sum::<u32>()
                })
                .sum();
            means.push((sum / ((end - column) * high) as u32) as u8);
        }
    }
}

/// Whether a block has changed by so much; parts of other sizes differ.
fn differ(one: &[u8], other: &[u8], change: f32) -> bool {
    one.len() != other.len()
        || one.is_empty()
        || one
            .iter()
            .zip(other)
            .any(|(one, other)| f32::from(one.abs_diff(*other)) >= change)
}

/// Every tile of every octave, large faces first.
fn slices(settings: &FaceWindowSettings, width: usize, height: usize) -> Vec<Slice> {
    let most = match settings.largest_px {
        0 => height as u32 / 2,
        largest => largest,
    };
    let mut slices = Vec::new();
    let mut smallest = settings.smallest_px;
    while smallest <= most {
        let largest = (2 * smallest).min(most);
        let side = (TILE * smallest).max(2 * largest) as usize;
        let step = side - largest as usize;
        let starts = |whole: usize| (0..whole.saturating_sub(largest as usize).max(1)).step_by(step);
        for top in starts(height) {
            for left in starts(width) {
                slices.push(Slice {
                    tile: Rectangle::new(left as f32, top as f32, side as f32, side as f32),
                    smallest,
                    largest,
                });
            }
        }
        smallest *= 2;
    }
    slices.reverse();
    slices
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_cover_every_place_at_every_size() {
        let settings = FaceWindowSettings::default();
        let (width, height) = (1600, 1200);
        let slices = slices(&settings, width, height);
        println!("{} slices", slices.len());
        for size in [24_u32, 47, 48, 95, 200, 384] {
            for place in 0..400_u32 {
                let x = (place * 7919 % (width as u32 - size)) as f32;
                let y = (place * 104_729 % (height as u32 - size)) as f32;
                let face = Rectangle::new(x, y, size as f32, size as f32);
                let covered = slices.iter().any(|slice| {
                    (slice.smallest..=slice.largest).contains(&size)
                        && slice.tile.intersection(&face).area() == face.area()
                });
                assert!(covered, "{face:?}");
            }
        }
    }

    #[test]
    fn the_whole_picture_is_searched_once_in_its_time() {
        let settings = FaceWindowSettings {
            cascades: Vec::new(),
            full_search_s: 2.0,
            ..FaceWindowSettings::default()
        };
        let mut percepts = FaceWindowPercepts::new(settings).unwrap();
        let frame = VideoFrame {
            width: 360,
            height: 288,
            luma: vec![0; 360 * 288],
            ..VideoFrame::default()
        };
        percepts.search(&frame, Span::ZERO, std::iter::empty());
        let all = percepts.slices.len();
        // The first time is faster.
        for _ in 0..11 {
            percepts.search(&frame, Span::from_seconds(0.04), std::iter::empty());
        }
        assert!(percepts.state.shown.iter().all(|shown| !shown.means.is_empty()));
        let start = percepts.state.slice;
        for _ in 0..50 {
            percepts.search(&frame, Span::from_seconds(0.04), std::iter::empty());
        }
        let searched = percepts.state.slice + all * 2 - start;
        assert!(
            (searched % all).min(all - searched % all) <= 1,
            "{searched} of {all}"
        );
    }

    #[test]
    fn what_does_not_change_is_searched_seldom() {
        let settings = FaceWindowSettings {
            cascades: Vec::new(),
            ..FaceWindowSettings::default()
        };
        let mut percepts = FaceWindowPercepts::new(settings).unwrap();
        let mut frame = VideoFrame {
            width: 360,
            height: 288,
            luma: vec![90; 360 * 288],
            ..VideoFrame::default()
        };
        let whole = Span::from_seconds(5.0);
        percepts.search(&frame, whole, std::iter::empty());
        for turn in 1..=MOST_PASSED {
            percepts.search(&frame, whole, std::iter::empty());
            assert!(percepts.state.shown.iter().all(|shown| shown.passed == turn));
        }
        percepts.search(&frame, whole, std::iter::empty());
        assert!(percepts.state.shown.iter().all(|shown| shown.passed == 0));
        // Somebody comes: only where that is seen.
        for row in 100..120 {
            frame.luma[row * 360 + 100..row * 360 + 120].fill(140);
        }
        percepts.search(&frame, whole, std::iter::empty());
        let searched: Vec<&Slice> = percepts
            .slices
            .iter()
            .zip(&percepts.state.shown)
            .filter(|(_, shown)| shown.passed == 0)
            .map(|(slice, _)| slice)
            .collect();
        let changed = Rectangle::new(100.0, 100.0, 20.0, 20.0);
        assert!(!searched.is_empty() && searched.len() < percepts.slices.len());
        assert!(
            searched
                .iter()
                .all(|slice| slice.tile.intersection(&changed).area() > 0.0)
        );
    }

    #[test]
    fn settings_out_of_range_are_named() {
        let wrong = FaceWindowSettings {
            full_search_s: 0.0,
            ..FaceWindowSettings::default()
        };
        let error = FaceWindowPercepts::new(wrong).err().unwrap().to_string();
        assert!(error.contains("full_search_s"), "{error}");
    }
}
