//! OpenCV's cascades, both formats.

use super::{Target, Verdict, texts};
use hearsight_core::{GrayView, Rectangle};
use hearsight_vision::cascade::{Cascade, CascadeDetector, DetectOptions, Mirror, WindowScorer};

pub(super) const TARGET: Target = Target {
    name: "cascade",
    meaning: "A cascade's XML; what was read can look at pictures.",
    text: true,
    words: &[
        "<_>",
        "</_>",
        "<rects>",
        "</rects>",
        "<tilted>1</tilted>",
        "<left_node>1</left_node>",
        "<left_val>0.5</left_val>",
        "<!--",
        "-->",
        "<![CDATA[",
        "]]>",
        "&#x0;",
        "&amp;",
        "&lt;",
        "<?xml?>",
        "<!DOCTYPE a [<!ENTITY b \"b\">]>",
        "&b;",
        "<features>",
        "<stages>",
        "<width>8</width>",
        "<height>8</height>",
        "<size>8 8</size>",
        "0 -1 0 0.5",
        "1 2 0 0.1 0 -1 0 0.2",
        "<_>0 0 8 8 -1.</_>",
    ],
    longest: 16 << 10,
    seeds: || {
        texts(&[
            include_str!("../../seeds/cascade/new.xml"),
            include_str!("../../seeds/cascade/new_tilted.xml"),
            include_str!("../../seeds/cascade/old.xml"),
        ])
    },
    open: || {
        let (width, height) = (48, 36);
        let picture: Vec<u8> = (0..width * height).map(|at| (at * at / 7 % 251) as u8).collect();
        let mut scores = Vec::new();
        Box::new(move |bytes| {
            let cascade = match Cascade::parse("a.xml", bytes) {
                Ok(cascade) => cascade,
                Err(error) => return Verdict::Refused(error.to_string()),
            };
            let view = GrayView {
                width,
                height,
                data: &picture,
            };
            let windows = [
                (3.0, 4.0, 20.0, 20.0),
                (-5.0, 20.0, 11.0, 30.0),
                (0.0, 0.0, 48.0, 36.0),
                (40.0, 30.0, 1e-3, 1e9),
            ]
            .map(|(left, top, width, height)| Rectangle::new(left, top, width, height));
            for mirrored in [false, true] {
                WindowScorer::new(&cascade, mirrored).score_windows(view, &windows, &mut scores);
                if scores
                    .iter()
                    .any(|score| score.stages > cascade.stages() || !(0.0..=1.0).contains(&score.inside))
                {
                    return Verdict::Broken(format!("a score makes no sense: {scores:?}"));
                }
            }
            let what = format!(
                "{} {:?} {}",
                cascade.is_tilted(),
                cascade.window_size().0.ilog2(),
                cascade.stages()
            );
            let options = DetectOptions {
                scale_step: 1.3,
                mirror: Mirror::Both,
                ..DetectOptions::default()
            };
            match CascadeDetector::new(cascade, options) {
                Ok(mut detector) => {
                    Verdict::Read(format!("{what}, {} faces", detector.detect(view).len().min(3)))
                }
                Err(error) => Verdict::Broken(error.to_string()),
            }
        })
    },
};
