//! Where everyone goes: from above, or in the picture.

use super::{Figure, MOST_SHOWN, name};
use crate::case::Case;
use crate::measure::Measure;
use crate::report::plot::{Axis, Plot, colour, legend};
use crate::sequence::Sighting;

/// Points of all lines together; more are thinned out.
const POINTS: usize = 20_000;
/// Longest side of the figure.
const SIDE: f64 = 430.0;
/// Most tracks that are drawn.
const MOST_TRACKS: usize = 300;

pub(super) fn figure(case: &Case) -> Option<Figure> {
    let sequence = &case.sequence;
    if sequence.truth().is_empty() && sequence.tracks().is_empty() {
        return None;
    }
    let from_above = sequence.measure() == Measure::Metres;
    let all = || sequence.truth().iter().chain(sequence.tracks());
    let point = |seen: &Sighting| seen.place.coordinates();
    let (label_x, label_y) = if from_above {
        ("x [m]", "y [m]")
    } else {
        ("column [px]", "row [px]")
    };
    let x = Axis::around(all().map(|seen| point(seen)[0]), label_x);
    let mut y = Axis::around(all().map(|seen| point(seen)[1]), label_y);
    // One scale on both axes: a metre is a metre.
    let (span_x, span_y) = (x.high - x.low, y.high - y.low);
    let scale = SIDE / span_x.max(span_y);
    let (width, height) = (
        (span_x * scale).max(120.0) + 76.0,
        (span_y * scale).max(120.0) + 50.0,
    );
    if !from_above {
        // Rows count downwards.
        std::mem::swap(&mut y.low, &mut y.high);
    }
    let title = if from_above {
        "From above"
    } else {
        "In the picture"
    };
    let mut plot = Plot::new(title, width, height, x, y);
    let step = (sequence.truth().len() + sequence.tracks().len())
        .div_ceil(POINTS)
        .max(1);
    let people = sequence.person_count().min(MOST_SHOWN);
    let tracks = sequence.track_count().min(MOST_TRACKS);
    let lines = |of_truth: bool, count: usize| -> Vec<Vec<Option<(f64, f64)>>> {
        let mut lines: Vec<Vec<Option<(f64, f64)>>> = vec![Vec::new(); count];
        let mut latest = vec![usize::MAX; count];
        for (number, frame) in sequence.frames().enumerate().step_by(step) {
            for seen in if of_truth { frame.truth } else { frame.tracks } {
                let who = seen.who as usize;
                if who < count {
                    if latest[who] != usize::MAX && number - latest[who] > 3 * step {
                        lines[who].push(None);
                    }
                    latest[who] = number;
                    let [x, y, _] = point(seen);
                    lines[who].push(Some((x, y)));
                }
            }
        }
        lines
    };
    for (who, line) in lines(true, people).into_iter().enumerate() {
        let title = format!("person {}", name(&case.people, who));
        plot.line(&format!("stroke wide {}", colour(who)), &title, line.into_iter());
    }
    for (who, line) in lines(false, tracks).into_iter().enumerate() {
        let title = format!("track {}", name(&case.tracks, who));
        plot.line("stroke track", &title, line.into_iter());
    }
    let mut entries: Vec<(String, String)> = (0..people)
        .map(|who| (format!("key {}", colour(who)), name(&case.people, who)))
        .collect();
    entries.push(("key track-key".to_owned(), "tracks".to_owned()));
    Some(Figure {
        title,
        caption: "Where people really go (wide, coloured) and where the tracks say they go (thin)."
            .to_owned(),
        body: plot.finish() + &legend(&entries),
        width,
    })
}
