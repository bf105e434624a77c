//! How often cascades find rendered people, over the angle at which they are seen.

use crate::Failure;
use crate::rooms::{Dice, Sitting};
use hearsight_core::{GrayView, Rectangle};
use hearsight_sim::render::{Person, Picture, Range, Renderer, SensorNoise, Shot};
use hearsight_vision::cascade::{Cascade, CascadeDetector, DetectOptions, Mirror};
use rayon::prelude::*;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Where Debian's package opencv-data puts them.
const FOLDER: &str = "/usr/share/opencv4/haarcascades";
type Sought = (&'static str, Mirror, (u32, u32), u32, bool);
/// The cascades that are looked at: name, turned pictures, smallest window, pixels, than how many windows a box must have
/// more, and whether those of a body. Heads are 40 pixels wide or more: faces fill nearly all of that, and an upper body
/// is two heads wide.
const CASCADES: [Sought; 4] = [
    ("frontalface_alt2", Mirror::No, (36, 36), 4, false),
    ("frontalface_default", Mirror::No, (36, 36), 4, false),
    ("profileface", Mirror::Both, (36, 36), 4, false),
    ("upperbody", Mirror::No, (80, 65), 5, true),
];
/// Width of a step of the curves in CSV, degrees.
const STEP_DEGREES: i32 = 10;

/// What every cascade made of everybody.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    looks: Vec<Look>,
}

/// One person and what was found in their picture.
#[derive(Clone, Debug, PartialEq)]
struct Look {
    number: usize,
    yaw_degrees: f64,
    /// All of the head, hidden or not.
    head: Rectangle,
    boxes: Vec<Found>,
}

/// A box that a cascade gave.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Found {
    cascade: usize,
    bounds: Rectangle,
    /// How many windows it is of.
    neighbours: u32,
    /// Whether it is of this person.
    fits: bool,
}

impl Look {
    fn found_by(&self, cascade: usize) -> bool {
        self.boxes
            .iter()
            .any(|found| found.cascade == cascade && found.fits)
    }
}

impl Curves {
    /// Share of people found by the cascade of this name, of those seen at angles (either way) between two, degrees.
    pub fn share(&self, cascade: &str, from_degrees: f64, to_degrees: f64) -> Option<f64> {
        self.share_where(cascade, |yaw| (from_degrees..to_degrees).contains(&yaw.abs()))
    }

    fn share_where(&self, cascade: &str, within: impl Fn(f64) -> bool) -> Option<f64> {
        let number = number_of(cascade)?;
        let looks = self.looks.iter().filter(|look| within(look.yaw_degrees));
        let (found, all) = looks.fold((0, 0), |(found, all), look| {
            (found + u32::from(look.found_by(number)), all + 1)
        });
        (all > 0).then(|| f64::from(found) / f64::from(all))
    }

    /// Boxes of nobody that the cascade of this name gives, a picture.
    pub fn false_boxes(&self, cascade: &str) -> Option<f64> {
        let number = number_of(cascade)?;
        let boxes = self.looks.iter().flat_map(|look| &look.boxes);
        let wrong = boxes
            .filter(|found| found.cascade == number && !found.fits)
            .count();
        Some(wrong as f64 / self.looks.len().max(1) as f64)
    }

    /// The least width of a head, pixels.
    pub fn narrowest_head_px(&self) -> f32 {
        self.looks
            .iter()
            .map(|look| look.head.width)
            .fold(f32::INFINITY, f32::min)
    }

    /// Share found over the angle, positive where the face is turned to its own left, as CSV.
    pub fn shares_csv(&self) -> String {
        let mut text = String::from("from_degrees,to_degrees,people");
        for (name, ..) in CASCADES {
            let _ = write!(text, ",{name}");
        }
        for from in (-90..90).step_by(STEP_DEGREES as usize) {
            let span = f64::from(from)..f64::from(from + STEP_DEGREES);
            let people = self
                .looks
                .iter()
                .filter(|look| span.contains(&look.yaw_degrees))
                .count();
            let _ = write!(text, "\n{from},{},{people}", from + STEP_DEGREES);
            for (name, ..) in CASCADES {
                match self.share_where(name, |yaw| span.contains(&yaw)) {
                    Some(share) => {
                        let _ = write!(text, ",{share:.3}");
                    }
                    None => text.push(','),
                }
            }
        }
        text.push('\n');
        text
    }

    /// Every box of every cascade as CSV, edges in pixels.
    pub fn boxes_csv(&self) -> String {
        let mut text = String::from(
            "person,yaw_degrees,head_left,head_top,head_width,head_height,cascade,left,top,width,height,neighbours,fits\n",
        );
        for look in &self.looks {
            for found in &look.boxes {
                let _ = write!(text, "{},{:.1}", look.number, look.yaw_degrees);
                edges(&mut text, &look.head);
                let _ = write!(text, ",{}", CASCADES[found.cascade].0);
                edges(&mut text, &found.bounds);
                let _ = writeln!(text, ",{},{}", found.neighbours, u8::from(found.fits));
            }
        }
        text
    }
}

fn edges(text: &mut String, of: &Rectangle) {
    let _ = write!(
        text,
        ",{:.0},{:.0},{:.0},{:.0}",
        of.left, of.top, of.width, of.height
    );
}

fn number_of(cascade: &str) -> Option<usize> {
    CASCADES.iter().position(|(name, ..)| *name == cascade)
}

impl std::fmt::Display for Curves {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{:<22}", "degrees")?;
        for from in (0..90).step_by(10) {
            write!(out, "{:>7}", format!("{from}-{}", from + 10))?;
        }
        writeln!(out, "{:>7}{:>7}{:>7}{:>7}", "<25", ">60", "20-50", "false")?;
        for (name, ..) in CASCADES {
            write!(out, "{name:<22}")?;
            let mut cell = |share: Option<f64>| match share {
                Some(share) => write!(out, "{:>6.0}%", 100.0 * share),
                None => write!(out, "{:>7}", "-"),
            };
            for from in (0..90).step_by(10) {
                cell(self.share(name, f64::from(from), f64::from(from + 10)))?;
            }
            cell(self.share(name, 0.0, 25.0))?;
            cell(self.share(name, 60.0, 91.0))?;
            cell(self.share(name, 20.0, 50.0))?;
            writeln!(out, "{:>7.3}", self.false_boxes(name).unwrap_or(0.0))?;
        }
        Ok(())
    }
}

/// Pictures of so many people, turned evenly over -90 to 90 degrees.
pub fn sittings(people: usize, seed: u64) -> Vec<(Sitting, Picture)> {
    (0..people).map(|number| sitting(number, seed)).collect()
}

fn sitting(number: usize, seed: u64) -> (Sitting, Picture) {
    let mut dice = Dice::new(seed.wrapping_mul(1_000_003).wrapping_add(number as u64));
    dice.bits();
    // The golden ratio spreads the angles evenly, however many there are.
    let yaw = 180.0 * (number as f64 * 0.618_033_988_749_895).fract() - 90.0;
    let sitting = dice.sitting(yaw);
    let mut picture = Picture::default();
    let people = [Person {
        looks: &sitting.looks,
        opening: &sitting.posture,
        closing: &sitting.posture,
    }];
    let shot = Shot {
        view: 0,
        frame: 0,
        camera: &sitting.camera,
        closing_pose: None,
        people: &people,
        lamps: &[],
        exposure: sitting.exposure,
        white_balance: [1.0; 3],
        noise: SensorNoise::default(),
        range: Range::Full,
    };
    Renderer::new(&sitting.setting, seed).render(&shot, &mut picture);
    (sitting, picture)
}

/// Measures the cascades on so many people.
///
/// # Errors
/// Where a cascade is missing on this machine.
pub fn curves(people: usize, seed: u64) -> Result<Curves, Failure> {
    let mut detectors = Vec::new();
    for (name, mirror, smallest, neighbours, _) in CASCADES {
        let file = PathBuf::from(format!("{FOLDER}/haarcascade_{name}.xml"));
        let options = DetectOptions {
            smallest,
            neighbours,
            mirror,
            ..DetectOptions::default()
        };
        detectors.push(CascadeDetector::new(Cascade::load(&file)?, options)?);
    }
    let looks: Vec<_> = (0..people)
        .into_par_iter()
        .map_with(detectors, |detectors, number| look(detectors, number, seed))
        .collect();
    Ok(Curves {
        looks: looks.into_iter().flatten().collect(),
    })
}

fn look(detectors: &mut [CascadeDetector], number: usize, seed: u64) -> Option<Look> {
    let (sitting, picture) = sitting(number, seed);
    let view = GrayView::new(picture.width, picture.height, &picture.luma)?;
    let head = picture.sights.first()?.head?.whole;
    let mut boxes = Vec::new();
    for (which, detector) in detectors.iter_mut().enumerate() {
        let fits = if CASCADES[which].4 { holds } else { is_face };
        boxes.extend(detector.detect(view).iter().map(|one| Found {
            cascade: which,
            bounds: one.bounds,
            neighbours: one.neighbours,
            fits: fits(&one.bounds, &head),
        }));
    }
    Some(Look {
        number,
        yaw_degrees: sitting.yaw_degrees,
        head,
        boxes,
    })
}

/// Whether a box is a face of this head: its middle is within the head, and it is neither much larger nor smaller.
fn is_face(bounds: &Rectangle, head: &Rectangle) -> bool {
    let (x, y) = bounds.centre();
    let inside = (head.left..head.right()).contains(&x) && (head.top..head.bottom()).contains(&y);
    inside && (0.5..1.6).contains(&(bounds.width / head.width))
}

/// Whether a box is an upper body with this head: the head's middle is in its upper two thirds, and it is wider
/// than the head and up to six heads wide: the cascade's people take a quarter of their windows.
fn holds(bounds: &Rectangle, head: &Rectangle) -> bool {
    let (x, y) = head.centre();
    let across = (bounds.left..bounds.right()).contains(&x);
    let down = (bounds.top..bounds.top + 0.67 * bounds.height).contains(&y);
    across && down && (1.2..6.0).contains(&(bounds.width / head.width))
}
