//! Whether probabilities mean what they say.

use super::Figure;
use crate::case::Case;
use crate::metrics::Family;
use crate::metrics::calibration::{BINS, ExistenceCalibration, Reliability, SpeakingCalibration};
use crate::report::plot::{Axis, Plot, legend};

/// Width of the figure.
const WIDTH: f64 = 320.0;

pub(super) fn speaking(case: &Case) -> Option<Figure> {
    let reliability = SpeakingCalibration::count(case).ok()??;
    Some(figure("Probability of speaking", "speak", &reliability))
}

pub(super) fn existence(case: &Case) -> Option<Figure> {
    let reliability = ExistenceCalibration::count(case).ok()??;
    Some(figure("Probability of existence", "have a person", &reliability))
}

fn figure(title: &'static str, what: &str, reliability: &Reliability) -> Figure {
    let axis = |label: &str| Axis {
        low: 0.0,
        high: 1.0,
        label: label.to_owned(),
    };
    let mut plot = Plot::new(
        title,
        WIDTH,
        300.0,
        axis("probability given"),
        axis("part that is so"),
    );
    let most = reliability.count.iter().copied().max().unwrap_or(1).max(1) as f64;
    for bin in 0..BINS {
        // How often each was said, as bars along the bottom.
        let count = reliability.count[bin];
        if count > 0 {
            let height = 0.18 * count as f64 / most;
            let (left, right) = (
                plot.u(bin as f64 / BINS as f64),
                plot.u((bin + 1) as f64 / BINS as f64),
            );
            let (top, bottom) = (plot.v(height), plot.v(0.0));
            plot.element(format_args!(
                r#"<rect class="count-bar" x="{:.1}" y="{top:.1}" width="{:.1}" height="{:.1}"><title>{count} times</title></rect>"#,
                left + 1.5,
                right - left - 3.0,
                (bottom - top).max(1.0)
            ));
        }
    }
    plot.line(
        "gate",
        "what is said is so",
        [Some((0.0, 0.0)), Some((1.0, 1.0))].into_iter(),
    );
    let known = reliability.bins();
    let points = known.iter().flatten().map(|(mean, part, _)| Some((*mean, *part)));
    plot.line("stroke c0", "this result", points);
    for (mean, part, count) in known.iter().flatten() {
        let (u, v) = (plot.u(*mean), plot.v(*part));
        plot.element(format_args!(
            r#"<circle class="fill c0" cx="{u:.1}" cy="{v:.1}" r="4"><title>said {mean:.2}, is so {part:.2} of {count}</title></circle>"#
        ));
    }
    let error = reliability.expected_error().unwrap_or(0.0);
    let entries = [
        ("key c0".to_owned(), "this result".to_owned()),
        ("key gate-key".to_owned(), "what is said is so".to_owned()),
        ("key count-bar".to_owned(), "how often it is said".to_owned()),
    ];
    Figure {
        title,
        caption: format!("Of all tracks given a probability, how many {what}. Expected error {error:.3}."),
        body: plot.finish() + &legend(&entries),
        width: WIDTH,
    }
}
