//! Mean shift against OpenCV's meanShift on the back-projection (goldens/make_mean_shift.py).

use hearsight_core::{Rectangle, RgbView};
use hearsight_vision::histogram::{BinPicture, Histogram, HistogramOptions, HistogramScratch};
use hearsight_vision::mean_shift::{MeanShift, MeanShiftOptions};
use serde::Deserialize;

#[derive(Deserialize)]
struct Golden {
    start: [f32; 2],
    end: [f32; 2],
}

const SIZE: (usize, usize) = (160, 120);
const HEADS: [(i32, i32, i32); 5] = [
    (60, 50, 15),
    (80, 60, 18),
    (101, 47, 22),
    (45, 75, 14),
    (110, 70, 20),
];

fn frame(number: usize) -> Vec<u8> {
    let (x0, y0, half) = HEADS[number];
    let mut data = Vec::new();
    for y in 0..SIZE.1 as i32 {
        for x in 0..SIZE.0 as i32 {
            let (u, v) = (
                f64::from(x - x0) / (f64::from(half) / 1.2),
                f64::from(y - y0) / f64::from(half),
            );
            let grain = ((x * 7 + y * 13 + number as i32 * 5) % 11) - 5;
            let colour = if u * u + v * v >= 1.0 {
                [120 + (x / 16 + y / 12) % 3 * 12, 130 + (x / 20) % 2 * 10, 150]
            } else if (x + y) / 3 % 3 == 0 {
                [50, 35, 25]
            } else {
                [205, 150, 120]
            };
            data.extend(colour.map(|value| (value + grain).clamp(0, 255) as u8));
        }
    }
    data
}

#[test]
fn it_ends_within_three_pixels_of_opencv() {
    let goldens: Vec<Golden> = serde_json::from_str(include_str!("../goldens/mean_shift.json")).unwrap();
    assert_eq!(goldens.len(), HEADS.len());
    for (number, golden) in goldens.iter().enumerate() {
        let data = frame(number);
        let mut bins = BinPicture::new(HistogramOptions::default()).unwrap();
        bins.compute(RgbView::new(SIZE.0, SIZE.1, &data).unwrap());
        let (x, y, half) = HEADS[number];
        let half = half as f32;
        let at = |x: f32, y: f32| Rectangle::from_centre(x, y, 2.0 * half / 1.2, 2.0 * half);
        let mut model = Histogram::default();
        bins.histogram(
            &at(x as f32 + 0.5, y as f32 + 0.5),
            &mut HistogramScratch::default(),
            &mut model,
        );
        let mut shift = MeanShift::new(MeanShiftOptions {
            size_step: 0.0,
            ..MeanShiftOptions::default()
        })
        .unwrap();
        let found = shift
            .follow(&bins, &model, &at(golden.start[0], golden.start[1]))
            .unwrap();
        let (u, v) = found.bounds.centre();
        let off = (u - golden.end[0]).hypot(v - golden.end[1]);
        assert!(
            off < 3.0,
            "frame {number}: {u}, {v} where OpenCV has {:?}",
            golden.end
        );
        let true_off = (u - x as f32 - 0.5).hypot(v - y as f32 - 0.5);
        assert!(true_off < 1.5, "frame {number}: {true_off} px from the head");
    }
}
