//! Who speaks when: truth and result of each speaker, one below the other.

use super::{Figure, MOST_SHOWN, name};
use crate::case::Case;
use crate::report::plot::{Axis, Plot, WIDE, legend};
use crate::speech::{Turn, compare};

/// Most turns of a side that are drawn.
const MOST_TURNS: usize = 4000;

pub(super) fn figure(case: &Case) -> Option<Figure> {
    let speech = case.speech.as_ref()?;
    let compared = compare(speech).ok()?;
    let mut speakers: Vec<u32> = speech.truth.iter().map(|turn| turn.speaker).collect();
    speakers.sort_unstable();
    speakers.dedup();
    speakers.truncate(MOST_SHOWN);
    let own = |person: u32| compared.result_of_truth.get(&person).copied();
    let mut others: Vec<u32> = speech.result.iter().map(|turn| turn.speaker).collect();
    others.sort_unstable();
    others.dedup();
    others.retain(|track| !speakers.iter().any(|&person| own(person) == Some(*track)));
    let mut rows: Vec<String> = speakers
        .iter()
        .map(|&who| name(&case.people, who as usize))
        .collect();
    if !others.is_empty() {
        rows.push("others".to_owned());
    }
    if rows.is_empty() {
        return None;
    }
    let bounds = speech.truth.iter().chain(&speech.result);
    let ends = bounds
        .flat_map(|turn| [turn.start_s, turn.end_s])
        .chain(speech.span_s.into_iter().flatten());
    let mut plot = Plot::with_rows("Who speaks when", Axis::around(ends, "time [s]"), &rows, 38.0);
    for turn in speech.truth.iter().take(MOST_TURNS) {
        if let Some(row) = speakers.iter().position(|&who| who == turn.speaker) {
            plot.bar(
                "truth-bar",
                &title("truth", turn),
                row as f64,
                turn.start_s,
                turn.end_s,
                [0.12, 0.46],
            );
        }
    }
    for turn in speech.result.iter().take(MOST_TURNS) {
        let row = speakers
            .iter()
            .position(|&person| own(person) == Some(turn.speaker));
        let (row, class) = match row {
            Some(row) => (row, "result-bar"),
            None => (speakers.len(), "other-bar"),
        };
        let text = title(&name(&case.tracks, turn.speaker as usize), turn);
        plot.bar(class, &text, row as f64, turn.start_s, turn.end_s, [0.54, 0.88]);
    }
    let mut entries = vec![
        ("key truth-bar".to_owned(), "truth".to_owned()),
        (
            "key result-bar".to_owned(),
            "result, the speaker who fits best".to_owned(),
        ),
    ];
    if !others.is_empty() {
        entries.push((
            "key other-bar".to_owned(),
            "result, speakers who are nobody".to_owned(),
        ));
    }
    Some(Figure {
        title: "Who speaks when",
        caption: "A row a speaker of the truth: above, when they speak; below, when the result says so."
            .to_owned(),
        body: plot.finish() + &legend(&entries),
        width: WIDE,
    })
}

fn title(who: &str, turn: &Turn) -> String {
    format!("{who}: {:.2} to {:.2} s", turn.start_s, turn.end_s)
}
