//! Sums, histograms, change, cleaning and regions against OpenCV and numpy on synthetic pictures.

use crate::common::{checksum, picture};
use hearsight_core::{GrayView, Mask, Rectangle, RgbView};
use hearsight_vision::change::{ChangeDetector, ChangeOptions};
use hearsight_vision::histogram::{BinPicture, Histogram, HistogramOptions, HistogramScratch};
use hearsight_vision::integral::Integrals;
use hearsight_vision::mask::{CleanOptions, MaskCleaner};
use hearsight_vision::regions::RegionFinder;
use serde::Deserialize;

const GRAY: (usize, usize) = (157, 83);
const COLOUR: (usize, usize) = (211, 97);
const OFF: CleanOptions = CleanOptions {
    median: 1,
    dilation_width: 1,
    dilation_height: 1,
};

#[derive(Deserialize)]
struct Goldens {
    gray: String,
    first: String,
    second: String,
    sums: String,
    squares: String,
    tilted: String,
    changed: String,
    cleaned: String,
    medians: Vec<(usize, String)>,
    dilations: Vec<(usize, usize, String)>,
    regions: Vec<[f64; 7]>,
    ellipses: Vec<[f64; 5]>,
}

fn goldens() -> Goldens {
    serde_json::from_str(include_str!("../goldens/pictures.json")).unwrap()
}

/// Two colour pictures, the upper halves of which differ by little.
fn pair() -> (Vec<u8>, Vec<u8>) {
    let (width, height) = COLOUR;
    let (first, mut second) = (picture(width, height, 3, 2), picture(width, height, 3, 3));
    for (value, &base) in second.iter_mut().zip(&first).take(height / 2 * width * 3) {
        *value = (i32::from(base) + i32::from(*value % 40) - 10).clamp(0, 255) as u8;
    }
    (first, second)
}

fn sparse() -> Mask {
    let (width, height) = GRAY;
    let on = |value: &u8| if value % 24 < 8 { 255 } else { 0 };
    Mask {
        width,
        height,
        data: picture(width, height, 1, 4).iter().map(on).collect(),
    }
}

#[test]
fn sums_are_those_of_opencv() {
    let goldens = goldens();
    let data = picture(GRAY.0, GRAY.1, 1, 1);
    assert_eq!(
        checksum(data.iter().copied()),
        goldens.gray,
        "the pictures themselves differ"
    );
    let mut tables = Integrals::default();
    tables.compute(GrayView::new(GRAY.0, GRAY.1, &data).unwrap(), true);
    assert_eq!(
        checksum(tables.sums.values().iter().flat_map(|v| v.to_le_bytes())),
        goldens.sums
    );
    assert_eq!(
        checksum(tables.squares.values().iter().flat_map(|v| v.to_le_bytes())),
        goldens.squares
    );
    assert_eq!(
        checksum(tables.tilted.values().iter().flat_map(|v| v.to_le_bytes())),
        goldens.tilted
    );
}

#[test]
fn change_is_that_of_opencv_pixel_for_pixel() {
    let goldens = goldens();
    let (first, second) = pair();
    assert_eq!(
        checksum(first.iter().copied()),
        goldens.first,
        "the pictures themselves differ"
    );
    assert_eq!(
        checksum(second.iter().copied()),
        goldens.second,
        "the pictures themselves differ"
    );
    let view = |data| RgbView::new(COLOUR.0, COLOUR.1, data).unwrap();
    let mut mask = Mask::default();
    for (clean, golden) in [(OFF, goldens.changed), (CleanOptions::default(), goldens.cleaned)] {
        let mut detector = ChangeDetector::new(ChangeOptions {
            clean,
            ..Default::default()
        })
        .unwrap();
        detector.detect(view(&second), view(&first), &mut mask).unwrap();
        assert_eq!((mask.width, mask.height), COLOUR);
        assert_eq!(checksum(mask.data.iter().copied()), golden, "{clean:?}");
    }
}

#[test]
fn cleaning_is_that_of_opencv_pixel_for_pixel() {
    let goldens = goldens();
    let cases = goldens
        .medians
        .into_iter()
        .map(|(median, golden)| (CleanOptions { median, ..OFF }, golden));
    let dilations = goldens
        .dilations
        .into_iter()
        .map(|(dilation_width, dilation_height, golden)| {
            (
                CleanOptions {
                    dilation_width,
                    dilation_height,
                    ..OFF
                },
                golden,
            )
        });
    for (options, golden) in cases.chain(dilations) {
        let mut mask = sparse();
        MaskCleaner::new(options).unwrap().clean(&mut mask);
        assert_eq!(checksum(mask.data.iter().copied()), golden, "{options:?}");
    }
}

#[test]
fn regions_are_those_of_opencv() {
    let sort = |mut rows: Vec<[f64; 7]>| {
        rows.sort_by(|a, b| a.partial_cmp(b).unwrap());
        rows
    };
    let mut finder = RegionFinder::default();
    let found = finder.find(&sparse(), 1).iter().map(|region| {
        let Rectangle {
            left,
            top,
            width,
            height,
        } = region.bounds;
        let (x, y) = region.centroid;
        [left, top, width, height, region.area as f32, x, y].map(f64::from)
    });
    let (found, expected) = (sort(found.collect()), sort(goldens().regions));
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() < 1e-4, "{found:?} where {expected:?} is right");
        }
    }
}

#[test]
fn histograms_are_those_of_the_equation() {
    let (first, _) = pair();
    let mut bins = BinPicture::new(HistogramOptions {
        pixels: 1 << 20,
        ..Default::default()
    })
    .unwrap();
    bins.compute(RgbView::new(COLOUR.0, COLOUR.1, &first).unwrap());
    let cases = goldens().ellipses;
    let ellipses: Vec<Rectangle> = cases
        .iter()
        .map(|&[left, top, width, height, _]| {
            Rectangle::new(left as f32, top as f32, width as f32, height as f32)
        })
        .collect();
    let (mut scratch, mut reference, mut scores) =
        (HistogramScratch::default(), Histogram::default(), Vec::new());
    bins.histogram(&ellipses[0], &mut scratch, &mut reference);
    bins.score_ellipses(&ellipses, &reference, &mut scratch, &mut scores);
    for (case, score) in cases.iter().zip(&scores) {
        let [.., coefficient] = *case;
        assert!(
            (f64::from(score.coefficient) - coefficient).abs() < 1e-4,
            "{score:?} for {case:?}"
        );
        let distance = (1.0 - coefficient).max(0.0).sqrt();
        assert!(
            (f64::from(score.distance) - distance).abs() < 5e-3,
            "{score:?} for {case:?}"
        );
    }
}
