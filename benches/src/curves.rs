//! How often cascades find rendered people, over the angle at which they are seen.

use crate::Failure;
use crate::rooms::{Dice, Sitting};
use hearsight_core::{GrayView, Rectangle};
use hearsight_sim::render::{Person, Picture, Range, Renderer, SensorNoise, Shot};
use hearsight_vision::cascade::{Cascade, CascadeDetector, DetectOptions, Mirror};
use rayon::prelude::*;
use std::path::PathBuf;

/// Where Debian's package opencv-data puts them.
const FOLDER: &str = "/usr/share/opencv4/haarcascades";
/// The cascades that are looked at: name, and whether those of a body.
const CASCADES: [(&str, Mirror, bool); 4] = [
    ("frontalface_alt2", Mirror::No, false),
    ("frontalface_default", Mirror::No, false),
    ("profileface", Mirror::Both, false),
    ("upperbody", Mirror::No, true),
];

/// Results of every cascade.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// For each person the angle, degrees, and whether each cascade found them.
    pub found: Vec<(f64, [bool; CASCADES.len()])>,
    /// Boxes a picture that are of nobody, for each cascade.
    pub false_boxes: [f64; CASCADES.len()],
}

impl Curves {
    /// Share of people found by the cascade of this name, of those seen at angles (either way) between two, degrees.
    pub fn share(&self, cascade: &str, from_degrees: f64, to_degrees: f64) -> Option<f64> {
        let number = CASCADES.iter().position(|(name, ..)| *name == cascade)?;
        let within = self
            .found
            .iter()
            .filter(|(yaw, _)| (from_degrees..to_degrees).contains(&yaw.abs()));
        let (found, all) = within.fold((0, 0), |(found, all), (_, hits)| {
            (found + u32::from(hits[number]), all + 1)
        });
        (all > 0).then(|| f64::from(found) / f64::from(all))
    }

    /// Boxes of nobody that the cascade of this name gives, a picture.
    pub fn false_boxes(&self, cascade: &str) -> Option<f64> {
        let number = CASCADES.iter().position(|(name, ..)| *name == cascade)?;
        Some(self.false_boxes[number])
    }
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
    for (name, mirror, _) in CASCADES {
        let file = PathBuf::from(format!("{FOLDER}/haarcascade_{name}.xml"));
        let options = DetectOptions {
            smallest: (30, 30),
            mirror,
            ..DetectOptions::default()
        };
        detectors.push(CascadeDetector::new(Cascade::load(&file)?, options)?);
    }
    let results: Vec<_> = (0..people)
        .into_par_iter()
        .map_with(detectors, |detectors, number| look(detectors, number, seed))
        .collect();
    let found: Vec<_> = results
        .iter()
        .flatten()
        .map(|(yaw, hits, _)| (*yaw, *hits))
        .collect();
    let wrong = |which: usize| {
        results
            .iter()
            .flatten()
            .map(|(.., wrong)| wrong[which])
            .sum::<u32>()
    };
    let false_boxes = std::array::from_fn(|which| f64::from(wrong(which)) / found.len().max(1) as f64);
    Ok(Curves { found, false_boxes })
}

/// The angle of one person, who of the detectors finds them, and how many boxes of nobody each gives.
type Look = (f64, [bool; CASCADES.len()], [u32; CASCADES.len()]);

fn look(detectors: &mut [CascadeDetector], number: usize, seed: u64) -> Option<Look> {
    let (sitting, picture) = sitting(number, seed);
    let view = GrayView::new(picture.width, picture.height, &picture.luma)?;
    let head = picture.sights.first()?.head?;
    let (mut hits, mut wrong) = ([false; CASCADES.len()], [0; CASCADES.len()]);
    for (which, detector) in detectors.iter_mut().enumerate() {
        let of_body = CASCADES[which].2;
        for detection in detector.detect(view) {
            let fits = if of_body { holds } else { is_face };
            let hit = fits(&detection.bounds, &head.whole);
            hits[which] |= hit;
            wrong[which] += u32::from(!hit);
        }
    }
    Some((sitting.yaw_degrees, hits, wrong))
}

/// Whether a box is a face of this head: its middle is within the head, and it is neither much larger nor smaller.
fn is_face(bounds: &Rectangle, head: &Rectangle) -> bool {
    let (x, y) = bounds.centre();
    let inside = (head.left..head.right()).contains(&x) && (head.top..head.bottom()).contains(&y);
    inside && (0.5..1.6).contains(&(bounds.width / head.width))
}

/// Whether a box is an upper body with this head: the head's middle is in its upper two thirds, and it is two to five
/// heads wide or at least wider than the head.
fn holds(bounds: &Rectangle, head: &Rectangle) -> bool {
    let (x, y) = head.centre();
    let across = (bounds.left..bounds.right()).contains(&x);
    let down = (bounds.top..bounds.top + 0.67 * bounds.height).contains(&y);
    across && down && (1.2..5.0).contains(&(bounds.width / head.width))
}
