use super::*;

fn picture(width: usize, height: usize) -> Vec<u8> {
    (0..width * height * 3).map(|i| (i * 37 % 251) as u8).collect()
}

fn bins_of(width: usize, height: usize) -> BinPicture {
    let data = picture(width, height);
    let mut bins = BinPicture::new(HistogramOptions::default()).unwrap();
    bins.compute(RgbView::new(width, height, &data).unwrap());
    bins
}

#[test]
fn an_ellipse_is_like_itself_and_batches_agree_with_single_histograms() {
    let bins = bins_of(60, 40);
    let ellipses = [
        Rectangle::new(10.0, 5.0, 20.0, 30.0),
        Rectangle::new(-10.0, 5.0, 20.0, 30.0),
        Rectangle::new(100.0, 5.0, 20.0, 30.0),
        Rectangle::new(f32::NAN, 5.0, 20.0, 30.0),
        Rectangle::new(3.0, 5.0, 0.0, 30.0),
        Rectangle::new(-1e30, -1e30, 2e30, 2e30),
    ];
    let mut scratch = HistogramScratch::default();
    let mut reference = Histogram::default();
    let inside = bins.histogram(&ellipses[0], &mut scratch, &mut reference);
    assert_eq!(inside, 1.0);
    assert!((reference.values().iter().sum::<f32>() - 1.0).abs() < 1e-5);
    let mut scores = Vec::new();
    bins.score_ellipses(&ellipses, &reference, &mut scratch, &mut scores);
    assert!(scores[0].coefficient > 0.999_99 && scores[0].distance < 4e-3);
    assert!((scores[1].inside - 0.5).abs() < 0.05, "{scores:?}");
    for score in &scores[2..5] {
        assert_eq!(
            *score,
            Similarity {
                coefficient: 0.0,
                distance: 1.0,
                inside: 0.0
            }
        );
    }
    for (ellipse, score) in ellipses.iter().zip(&scores) {
        let mut histogram = Histogram::default();
        let inside = bins.histogram(ellipse, &mut scratch, &mut histogram);
        assert_eq!(inside, score.inside);
        assert!((histogram.coefficient(&reference) - score.coefficient).abs() < 1e-5);
    }
}

#[test]
fn large_ellipses_are_read_in_steps_with_nearly_the_same_result() {
    let data: Vec<u8> = (0..300 * 200)
        .flat_map(|i| [(i % 300 / 2) as u8, (i / 300) as u8, 7])
        .collect();
    let view = RgbView::new(300, 200, &data).unwrap();
    let bounds = Rectangle::new(20.0, 10.0, 250.0, 180.0);
    let mut histograms = [Histogram::default(), Histogram::default()];
    for (pixels, histogram) in [1 << 30, 2048].into_iter().zip(&mut histograms) {
        let mut bins = BinPicture::new(HistogramOptions {
            pixels,
            ..Default::default()
        })
        .unwrap();
        bins.compute(view);
        bins.histogram(&bounds, &mut HistogramScratch::default(), histogram);
    }
    assert!(histograms[0].coefficient(&histograms[1]) > 0.999);
}

#[test]
fn options_out_of_range_are_refused() {
    for (red, pixels) in [(0, 100), (41, 100), (10, 1)] {
        assert!(
            BinPicture::new(HistogramOptions {
                red,
                pixels,
                ..Default::default()
            })
            .is_err()
        );
    }
    let most = HistogramOptions {
        red: 40,
        green: 40,
        blue: 40,
        pixels: 100,
    };
    let mut bins = BinPicture::new(most).unwrap();
    bins.compute(RgbView::new(1, 1, &[255; 3]).unwrap());
    assert_eq!(bins.bins(), [63_999]);
}
