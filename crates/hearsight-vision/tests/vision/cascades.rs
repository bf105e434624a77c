//! Cascades against OpenCV on frames of AV16.3: windows, groups, scores, and single windows.
//!
//! Neither the recordings nor the cascades nor a decoder are part of the project; where one is missing (or decodes to
//! other pixels than those the goldens are of) the test says so and passes.

use crate::common::{Noise, checksum};
use hearsight_core::{GrayView, Rectangle};
use hearsight_vision::cascade::{Cascade, CascadeDetector, DetectOptions, Mirror, Window, WindowScorer};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

const WIDTH: usize = 360;
const HEIGHT: usize = 288;
const EVERY: usize = 80;
const FRAMES: usize = 6;
const STEP: f64 = 1.1;
const CASCADES: &str = "/usr/share/opencv4/haarcascades";
/// Rejected windows sampled for each frame and cascade.
const REJECTED: usize = 100;

type Golden = [i32; 4];

#[derive(Deserialize)]
struct Frame {
    file: String,
    frame: usize,
    checksum: String,
    found: BTreeMap<String, Found>,
}

#[derive(Deserialize)]
struct Found {
    windows: Vec<Golden>,
    groups: Vec<[i32; 5]>,
    scores: Vec<(i32, i32, i32, i32, f64)>,
}

#[derive(Debug, Default)]
struct Tally {
    right: usize,
    all: usize,
}

impl Tally {
    fn add(&mut self, right: bool) {
        self.right += usize::from(right);
        self.all += 1;
    }

    fn share(&self) -> f64 {
        self.right as f64 / self.all.max(1) as f64
    }
}

/// All frames of a recording that the goldens are of.
fn decode(file: &str) -> Result<Vec<u8>, String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data/av16.3-seq30")
        .join(file);
    if !path.is_file() {
        return Err(format!("{} is missing", path.display()));
    }
    let output = Command::new("ffmpeg")
        .args(["-v", "error", "-i"])
        .arg(&path)
        .args(["-vf", &format!("select=not(mod(n\\,{EVERY}))"), "-vsync", "0"])
        .args([
            "-frames:v",
            &FRAMES.to_string(),
            "-pix_fmt",
            "gray",
            "-f",
            "rawvideo",
            "-",
        ])
        .output()
        .map_err(|error| format!("ffmpeg: {error}"))?;
    if output.status.success() {
        Ok(output.stdout)
    } else {
        Err(format!("ffmpeg: {}", String::from_utf8_lossy(&output.stderr)))
    }
}

/// Frames with their goldens, or why there are none.
fn frames() -> Result<Vec<(Frame, Vec<u8>)>, String> {
    if !Path::new(CASCADES).is_dir() {
        return Err(format!("{CASCADES} is missing (Debian: package opencv-data)"));
    }
    let goldens: Vec<Frame> = serde_json::from_str(include_str!("../goldens/cascades.json")).unwrap();
    let mut decoded = BTreeMap::new();
    let mut frames = Vec::new();
    for golden in goldens {
        if !decoded.contains_key(&golden.file) {
            decoded.insert(golden.file.clone(), decode(&golden.file)?);
        }
        let size = WIDTH * HEIGHT;
        let pixels = decoded[&golden.file].get(golden.frame * size..(golden.frame + 1) * size);
        match pixels {
            Some(pixels) if checksum(pixels.iter().copied()) == golden.checksum => {
                frames.push((golden, pixels.to_vec()));
            }
            _ => return Err(format!("{} decodes to other pixels here", golden.file)),
        }
    }
    Ok(frames)
}

fn load(name: &str) -> Cascade {
    Cascade::load(&Path::new(CASCADES).join(format!("haarcascade_{name}.xml"))).unwrap()
}

/// As OpenCV returns it: clipped to the picture, and in the turned picture's own coordinates.
fn clipped(window: &Window) -> Golden {
    let left = if window.mirrored {
        WIDTH as i32 - window.left - window.width
    } else {
        window.left
    };
    let (right, bottom) = (left + window.width, window.top + window.height);
    let (left, top) = (left.max(0), window.top.max(0));
    [
        left,
        top,
        right.min(WIDTH as i32) - left,
        bottom.min(HEIGHT as i32) - top,
    ]
}

/// The scales of a search, with the window's rounded size at each.
fn scales(cascade: &Cascade) -> Vec<(f32, i32, i32)> {
    let (width, height) = cascade.window_size();
    std::iter::successors(Some(1.0), |scale| Some(scale * STEP))
        .map(|scale: f64| {
            let side = |side: usize| (side as f32 * scale as f32).round_ties_even() as i32;
            (scale as f32, side(width), side(height))
        })
        .take_while(|&(_, width, height)| width <= WIDTH as i32 && height <= HEIGHT as i32)
        .filter(|&(_, width, height)| width >= 20 && height >= 20)
        .collect()
}

/// The window at column `x` and row `y` of the picture shrunk by `scale`, before rounding.
fn exact(cascade: &Cascade, scale: f32, x: usize, y: usize, mirrored: bool) -> Rectangle {
    let (width, height) = cascade.window_size();
    let [left, top, width, height] = [x, y, width, height].map(|side| side as f32 * scale);
    let left = if mirrored {
        WIDTH as f32 - left - width
    } else {
        left
    };
    Rectangle::new(left, top, width, height)
}

#[test]
fn searches_find_the_windows_and_groups_of_opencv() {
    let frames = match frames() {
        Ok(frames) => frames,
        Err(reason) => return println!("skipped: {reason}"),
    };
    let (mut windows, mut groups, mut scores) = (Tally::default(), Tally::default(), Tally::default());
    for name in frames[0].0.found.keys() {
        let (file, mirror) = match name.strip_suffix(" mirrored") {
            Some(file) => (file, Mirror::Only),
            None => (name.as_str(), Mirror::No),
        };
        let options = DetectOptions {
            smallest: (20, 20),
            mirror,
            ..Default::default()
        };
        let mut detector = CascadeDetector::new(load(file), options).unwrap();
        for (golden, pixels) in &frames {
            let picture = GrayView::new(WIDTH, HEIGHT, pixels).unwrap();
            let golden = &golden.found[name];
            let found: Vec<_> = detector
                .windows(picture)
                .iter()
                .map(|w| (clipped(w), w.score))
                .collect();
            let mut rest = golden.windows.clone();
            for (window, score) in &found {
                let at = rest.iter().position(|other| other == window);
                windows.add(at.is_some());
                at.map(|at| rest.swap_remove(at));
                for &(left, top, width, height, sum) in &golden.scores {
                    if *window == [left, top, width, height] {
                        scores.add((f64::from(*score) - sum).abs() < 1e-4);
                    }
                }
            }
            rest.iter().for_each(|_| windows.add(false));
            let found = detector.detect(picture).to_vec();
            groups.add(found.len() == golden.groups.len());
            for &[left, top, width, height, count] in &golden.groups {
                let near = |a: f32, b: i32| (a - b as f32).abs() <= 1.0;
                groups.add(found.iter().any(|group| {
                    let bounds = group.bounds;
                    let own = if group.mirrored {
                        WIDTH as f32 - bounds.right()
                    } else {
                        bounds.left
                    };
                    near(own, left)
                        && near(bounds.top, top)
                        && near(bounds.width, width)
                        && near(bounds.height, height)
                        && group.neighbours == count as u32
                }));
            }
        }
    }
    println!("windows {windows:?}, groups {groups:?}, scores {scores:?}");
    assert!(windows.all > 500 && windows.share() >= 0.999, "{windows:?}");
    assert!(groups.share() >= 1.0, "{groups:?}");
    assert!(scores.all > 100 && scores.share() >= 0.999, "{scores:?}");
}

#[test]
fn single_windows_get_the_decision_of_a_search() {
    let frames = match frames() {
        Ok(frames) => frames,
        Err(reason) => return println!("skipped: {reason}"),
    };
    let (mut accepted, mut rejected) = (Tally::default(), Tally::default());
    let mut noise = Noise::new(9);
    for name in frames[0].0.found.keys() {
        let file = name.strip_suffix(" mirrored").unwrap_or(name);
        let (cascade, mirrored) = (load(file), file != name);
        let scales = scales(&cascade);
        let mut scorer = WindowScorer::new(&cascade, mirrored);
        for (golden, pixels) in &frames {
            let picture = GrayView::new(WIDTH, HEIGHT, pixels).unwrap();
            let found: BTreeSet<Golden> = golden.found[name].windows.iter().copied().collect();
            for &[left, top, width, height] in &found {
                // Clipped windows do not tell their scale.
                let Some(&(scale, ..)) = scales.iter().find(|size| (size.1, size.2) == (width, height))
                else {
                    continue;
                };
                let place = |at: i32| (at as f32 / scale).round() as usize;
                let window = exact(&cascade, scale, place(left), place(top), mirrored);
                accepted.add(scorer.score_window(picture, &window).accepted);
            }
            for _ in 0..REJECTED {
                let mut any = |below: usize| usize::from(noise.byte()) * below / 256;
                let (scale, width, height) = scales[any(scales.len())];
                let step = if scale >= 2.0 { 1 } else { 2 };
                let place = |whole: usize, side: i32| (whole as i32 - side) as f32 / scale / step as f32;
                let x = any(place(WIDTH, width) as usize + 1) * step;
                let y = any(place(HEIGHT, height) as usize + 1) * step;
                let at = |place: usize| (place as f32 * scale).round_ties_even() as i32;
                if !found.contains(&[at(x), at(y), width, height]) {
                    let window = exact(&cascade, scale, x, y, mirrored);
                    rejected.add(!scorer.score_window(picture, &window).accepted);
                }
            }
        }
    }
    println!("accepted {accepted:?}, rejected {rejected:?}");
    assert!(accepted.all > 500 && accepted.share() >= 0.98, "{accepted:?}");
    assert!(rejected.all > 5000 && rejected.share() >= 0.98, "{rejected:?}");
}
