//! Work of cascades, those of Debian's package opencv-data.

use super::Work;
use crate::{Failure, Inputs};
use hearsight_core::Rectangle;
use hearsight_vision::cascade::{Cascade, CascadeDetector, DetectOptions, WindowScorer};
use std::path::PathBuf;

fn cascade(name: &str) -> Result<Cascade, Failure> {
    let file = format!("/usr/share/opencv4/haarcascades/haarcascade_frontalface_{name}.xml");
    Ok(Cascade::load(&PathBuf::from(file))?)
}

pub(super) fn search(inputs: &Inputs, name: &str) -> Result<Work, Failure> {
    let options = DetectOptions {
        scale_step: 1.1,
        smallest: (20, 20),
        ..DetectOptions::default()
    };
    let mut detector = CascadeDetector::new(cascade(name)?, options)?;
    let pictures = inputs.pictures.clone();
    let mut number = 0;
    Ok(Box::new(move || {
        number += 1;
        detector
            .detect(pictures[number % pictures.len()].grey_view())
            .len() as f64
    }))
}

pub(super) fn windows(inputs: &Inputs) -> Result<Work, Failure> {
    let mut scorer = WindowScorer::new(&cascade("alt2")?, false);
    let pictures = inputs.pictures.clone();
    let (width, height) = (pictures[0].width as f32, pictures[0].height as f32);
    let window = |place: &[f32]| {
        let side = 50.0 + 30.0 * place[2];
        Rectangle::from_centre(
            0.5 * width * (1.0 + place[0]),
            0.5 * height * (1.0 + place[1]),
            side,
            side,
        )
    };
    let windows: Vec<Rectangle> = Inputs::noise(5, 3 * 200).chunks_exact(3).map(window).collect();
    let mut scores = Vec::new();
    let mut number = 0;
    Ok(Box::new(move || {
        number += 1;
        scorer.score_windows(
            pictures[number % pictures.len()].grey_view(),
            &windows,
            &mut scores,
        );
        scores.iter().map(|score| score.stages as f64).sum()
    }))
}
