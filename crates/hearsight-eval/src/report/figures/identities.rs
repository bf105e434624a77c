//! Which track each person has over time: a change of colour is a switch, a gap a miss.

use super::{Figure, MOST_SHOWN, name, time_axis};
use crate::case::Case;
use crate::events::Event;
use crate::recording::median_interval_s;
use crate::report::plot::{Axis, Plot, WIDE, colour};

/// Most bars of the figure.
const MOST_BARS: usize = 4000;

pub(super) fn figure(case: &Case) -> Option<Figure> {
    let sequence = &case.sequence;
    if sequence.truth().is_empty() {
        return None;
    }
    let (times, label) = time_axis(case);
    let interval = median_interval_s(&times);
    let people = sequence.person_count().min(MOST_SHOWN);
    let rows: Vec<String> = (0..people).map(|who| name(&case.people, who)).collect();
    let mut plot = Plot::with_rows(
        "Tracks of people over time",
        Axis::around(times.iter().copied(), label),
        &rows,
        26.0,
    );
    // Of each person: the track in hand (none for missed), its start and latest frame.
    let mut open: Vec<Option<(Option<u32>, f64, f64)>> = vec![None; people];
    let mut bars: Vec<(usize, Option<u32>, f64, f64)> = Vec::new();
    for event in &case.events {
        let (truth, track) = match event {
            Event::Match(pair) | Event::Switch(pair) => (pair.truth, Some(sequence.tracks()[pair.track].who)),
            Event::Miss { truth, .. } => (*truth, None),
            Event::FalsePositive { .. } => continue,
        };
        let who = sequence.truth()[truth].who as usize;
        let now = times[event.frame()];
        let Some(bar) = open.get_mut(who) else { continue };
        match bar {
            Some((same, _, latest)) if *same == track && now <= *latest + 1.5 * interval => *latest = now,
            other => {
                if let Some((track, start, latest)) = other.replace((track, now, now)) {
                    bars.push((who, track, start, latest));
                }
            }
        }
    }
    let last = open.iter().enumerate();
    bars.extend(last.filter_map(|(who, bar)| bar.map(|(track, start, latest)| (who, track, start, latest))));
    let shortened = bars.len() > MOST_BARS;
    bars.sort_by(|one, other| (other.3 - other.2).total_cmp(&(one.3 - one.2)));
    bars.truncate(MOST_BARS);
    for (who, track, start, latest) in bars {
        let row = who as f64;
        let end = latest + interval;
        match track {
            Some(track) => {
                let title = format!("{} has track {}", rows[who], name(&case.tracks, track as usize));
                plot.bar(
                    &format!("fill {}", colour(track as usize)),
                    &title,
                    row,
                    start,
                    end,
                    [0.12, 0.88],
                );
                let (left, right) = (plot.u(start), plot.u(end));
                let text = name(&case.tracks, track as usize);
                if right - left > 8.0 * text.chars().count() as f64 + 6.0 {
                    let (u, v) = (left + 4.0, plot.v(row + 0.5) + 4.0);
                    plot.element(format_args!(
                        r#"<text class="onbar" x="{u:.1}" y="{v:.1}">{}</text>"#,
                        crate::report::plot::escape(&text)
                    ));
                }
            }
            None => plot.bar(
                "missed",
                &format!("{} missed", rows[who]),
                row,
                start,
                end,
                [0.42, 0.58],
            ),
        }
    }
    let mut caption =
        "Which track each person has: a row a person, the number and colour are the track's; grey where missed.".to_owned();
    if shortened {
        caption.push_str(" Only the longest stretches are drawn.");
    }
    Some(Figure {
        title: "Who has which track",
        caption,
        body: plot.finish(),
        width: WIDE,
    })
}
