//! Work on pixels.

use super::Work;
use crate::{Failure, Inputs, Picture};
use hearsight_core::{Mask, Rectangle, Span};
use hearsight_vision::background::{BackgroundModel, BackgroundOptions};
use hearsight_vision::change::{ChangeDetector, ChangeOptions};
use hearsight_vision::histogram::{BinPicture, Histogram, HistogramOptions, HistogramScratch};
use hearsight_vision::integral::{Integrals, SumTable};
use hearsight_vision::silhouette::{HeadFinder, HeadSearch};

/// Calls `work` with one picture after the other and the one before it, around and around.
fn in_turn(pictures: Vec<Picture>, mut work: impl FnMut(&Picture, &Picture) -> f64 + 'static) -> Work {
    let mut number = 0;
    Box::new(move || {
        let before = &pictures[number % pictures.len()];
        number += 1;
        work(&pictures[number % pictures.len()], before)
    })
}

fn cropped(inputs: &Inputs, width: usize, height: usize) -> Vec<Picture> {
    inputs
        .pictures
        .iter()
        .map(|picture| picture.cropped(width, height))
        .collect()
}

pub(super) fn sums(inputs: &Inputs, width: usize, height: usize) -> Result<Work, Failure> {
    let mut table = SumTable::default();
    Ok(in_turn(cropped(inputs, width, height), move |picture, _| {
        table.compute(picture.grey_view());
        f64::from(table.rectangle(0, 0, picture.width, picture.height))
    }))
}

pub(super) fn squares(inputs: &Inputs, width: usize, height: usize) -> Result<Work, Failure> {
    let mut tables = Integrals::default();
    Ok(in_turn(cropped(inputs, width, height), move |picture, _| {
        tables.compute(picture.grey_view(), false);
        tables.squares.rectangle(0, 0, picture.width, picture.height) as f64
    }))
}

pub(super) fn tilted(inputs: &Inputs) -> Result<Work, Failure> {
    let mut tables = Integrals::default();
    Ok(in_turn(inputs.pictures.clone(), move |picture, _| {
        tables.compute(picture.grey_view(), true);
        f64::from(tables.sums.rectangle(0, 0, picture.width, picture.height))
    }))
}

pub(super) fn bins(inputs: &Inputs) -> Result<Work, Failure> {
    let mut bins = BinPicture::new(HistogramOptions::default())?;
    Ok(in_turn(inputs.pictures.clone(), move |picture, _| {
        bins.compute(picture.rgb_view());
        bins.bins().last().copied().map_or(0.0, f64::from)
    }))
}

/// Heads around two places, as particles are.
fn ellipses(picture: &Picture) -> Vec<Rectangle> {
    let offsets = Inputs::noise(3, 3 * 200);
    let (width, height) = (picture.width as f32, picture.height as f32);
    let head = |offsets: &[f32]| {
        let side = 30.0 + 6.0 * offsets[2];
        Rectangle::from_centre(
            0.5 * width + 40.0 * offsets[0],
            0.4 * height + 20.0 * offsets[1],
            side,
            1.3 * side,
        )
    };
    offsets.chunks_exact(3).map(head).collect()
}

pub(super) fn histograms(inputs: &Inputs) -> Result<Work, Failure> {
    let mut bins = BinPicture::new(HistogramOptions::default())?;
    let picture = &inputs.pictures[0];
    bins.compute(picture.rgb_view());
    let ellipses = ellipses(picture);
    let mut scratch = HistogramScratch::default();
    let mut people = [Histogram::default(), Histogram::default()];
    for (person, bounds) in people.iter_mut().zip(&ellipses) {
        bins.histogram(bounds, &mut scratch, person);
    }
    let mut scores = Vec::new();
    Ok(Box::new(move || {
        let mut sum = 0.0;
        for person in &people {
            bins.score_ellipses(&ellipses, person, &mut scratch, &mut scores);
            sum += scores
                .iter()
                .map(|score| f64::from(score.coefficient))
                .sum::<f64>();
        }
        sum / (people.len() * ellipses.len()) as f64
    }))
}

fn count(mask: &Mask) -> f64 {
    mask.data.iter().filter(|&&pixel| pixel > 0).count() as f64
}

pub(super) fn change(inputs: &Inputs) -> Result<Work, Failure> {
    let mut detector = ChangeDetector::new(ChangeOptions::default())?;
    let mut mask = Mask::default();
    Ok(in_turn(
        inputs.pictures.clone(),
        move |picture, before| match detector.detect(picture.rgb_view(), before.rgb_view(), &mut mask) {
            Ok(()) => count(&mask),
            Err(_) => f64::NAN,
        },
    ))
}

pub(super) fn background(inputs: &Inputs) -> Result<Work, Failure> {
    let mut model = BackgroundModel::new(BackgroundOptions::default())?;
    let mut mask = Mask::default();
    let step = Span::from_seconds(0.04);
    // Past the time of learning, which costs less.
    for picture in inputs.pictures.iter().cycle().take(100) {
        model.step(picture.rgb_view(), step, &mut mask)?;
    }
    Ok(in_turn(inputs.pictures.clone(), move |picture, _| {
        match model.step(picture.rgb_view(), step, &mut mask) {
            Ok(_) => count(&mask),
            Err(_) => f64::NAN,
        }
    }))
}

/// Two people's outlines, as a change mask shows them.
fn outlines(width: usize, height: usize) -> Mask {
    let mut mask = Mask::new(width, height);
    for (x, top, head) in [(120.0, 60.0, 28.0), (250.0, 90.0, 22.0)] {
        let parts = [(0.5, 0.0, 1.4), (1.1, 1.4, 7.0)];
        for y in 0..height {
            for column in 0..width {
                let (dx, dy) = ((column as f32 - x).abs() / head, (y as f32 - top) / head);
                if parts
                    .iter()
                    .any(|&(half, from, to)| dx < half && (from..to).contains(&dy))
                {
                    mask.data[y * width + column] = 255;
                }
            }
        }
    }
    mask
}

pub(super) fn heads(inputs: &Inputs) -> Result<Work, Failure> {
    let mask = outlines(inputs.pictures[0].width, inputs.pictures[0].height);
    let (mut finder, search, mut heads) = (HeadFinder::default(), HeadSearch::default(), Vec::new());
    Ok(Box::new(move || {
        finder.load(&mask);
        finder.find(&mask, &search, &mut heads);
        heads.len() as f64
    }))
}
