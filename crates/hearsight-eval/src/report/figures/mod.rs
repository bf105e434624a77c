//! The figures of a case, each a file: what it shows, and its legend.

mod errors;
mod identities;
mod reliability;
mod speech;
mod trajectories;

use crate::case::Case;

/// A figure of a case.
pub(super) struct Figure {
    pub(super) title: &'static str,
    /// What it shows, a sentence or two.
    pub(super) caption: String,
    /// HTML: a plot and its legend.
    pub(super) body: String,
    /// Width, in the units of the plots.
    pub(super) width: f64,
}

/// Every kind of figure, in the order of the page; each gives none where the case lacks what it shows.
const FIGURES: &[fn(&Case) -> Option<Figure>] = &[
    errors::figure,
    identities::figure,
    speech::figure,
    trajectories::figure,
    reliability::speaking,
    reliability::existence,
];

/// The figures of a case.
pub(super) fn figures(case: &Case) -> Vec<Figure> {
    FIGURES.iter().filter_map(|figure| figure(case)).collect()
}

/// Most people or tracks that a figure shows.
const MOST_SHOWN: usize = 40;

/// The place of each frame along the time axis, and the label of that axis: seconds, or frames where times are not known.
fn time_axis(case: &Case) -> (Vec<f64>, &'static str) {
    let timed = case.sequence.frames().all(|frame| frame.time_s.is_some());
    let place = |frame: crate::Frame<'_>| match frame.time_s {
        Some(time_s) if timed => time_s,
        _ => frame.number as f64,
    };
    let places = case.sequence.frames().map(place).collect();
    (places, if timed { "time [s]" } else { "frame" })
}

/// A name for a person or track.
fn name(names: &[String], who: usize) -> String {
    names.get(who).cloned().unwrap_or_else(|| (who + 1).to_string())
}
