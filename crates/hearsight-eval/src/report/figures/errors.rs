//! How far off each person's track is over time.

use super::{Figure, MOST_SHOWN, name, time_axis};
use crate::case::Case;
use crate::events::Event;
use crate::measure::Measure;
use crate::report::plot::{Axis, Plot, WIDE, colour, legend};

/// Points along the time axis: more are averaged.
const POINTS: usize = 700;

pub(super) fn figure(case: &Case) -> Option<Figure> {
    let sequence = &case.sequence;
    if sequence.truth().is_empty() {
        return None;
    }
    let (times, label) = time_axis(case);
    let people = sequence.person_count().min(MOST_SHOWN);
    let x = Axis::around(times.iter().copied(), label);
    let bin_of = |time: f64| {
        let part = (time - x.low) / (x.high - x.low);
        ((part * POINTS as f64) as usize).min(POINTS - 1)
    };
    // Sum of the distances, pairs, and frames, of each person and bin.
    let mut bins = vec![[0.0_f64; 3]; people * POINTS];
    for event in &case.events {
        let (truth, distance) = match event {
            Event::Match(pair) | Event::Switch(pair) => (pair.truth, Some(pair.distance)),
            Event::Miss { truth, .. } => (*truth, None),
            Event::FalsePositive { .. } => continue,
        };
        let who = sequence.truth()[truth].who as usize;
        if who < people {
            let bin = &mut bins[who * POINTS + bin_of(times[event.frame()])];
            bin[0] += distance.unwrap_or(0.0);
            bin[1] += f64::from(distance.is_some());
            bin[2] += 1.0;
        }
    }
    let (gate, measure) = (sequence.gate(), sequence.measure());
    let unit = match measure {
        Measure::Overlap => "1 - overlap".to_owned(),
        Measure::Pixels | Measure::Metres => format!("distance [{}]", measure.unit()),
    };
    let step = (x.high - x.low) / POINTS as f64;
    let low = x.low;
    let y = Axis {
        low: 0.0,
        high: gate * 1.12,
        label: unit,
    };
    let mut plot = Plot::new("Error over time", WIDE, 260.0, x, y);
    let (start, end) = (low, low + step * POINTS as f64);
    let limit = [Some((start, gate)), Some((end, gate))];
    plot.line("gate", "gate", limit.into_iter());
    // How many bins may be empty because frames are rarer than bins.
    let sparse = POINTS.div_ceil(times.len().max(1));
    for who in 0..people {
        let of_person = &bins[who * POINTS..(who + 1) * POINTS];
        let title = format!("person {}", name(&case.people, who));
        let mut since = usize::MAX;
        let points = of_person
            .iter()
            .enumerate()
            .flat_map(|(bin, [sum, pairs, frames])| {
                let time = low + (bin as f64 + 0.5) * step;
                let gone = since.saturating_add(1) > sparse;
                since = since.saturating_add(1);
                if *pairs > 0.0 {
                    since = 0;
                    let broken = gone.then_some(None);
                    broken.into_iter().chain(Some(Some((time, sum / pairs))))
                } else if *frames > 0.0 {
                    None.into_iter().chain(Some(None))
                } else {
                    None.into_iter().chain(None)
                }
            });
        plot.line(&format!("stroke {}", colour(who)), &title, points);
        // Misses, as marks above the gate.
        let at = gate * (1.03 + 0.07 * (who as f64 + 0.5) / people as f64);
        // A miss lasts until the next frame, so that those that follow each other make one mark.
        let lasts = step * sparse as f64;
        let missed = of_person
            .iter()
            .enumerate()
            .flat_map(|(bin, [_, pairs, frames])| {
                let time = low + bin as f64 * step;
                let ends = [Some((time, at)), Some(((time + lasts).min(end), at)), None];
                ends.map(|point| point.filter(|_| frames > pairs))
            });
        plot.line(
            &format!("stroke thin {}", colour(who)),
            &format!("{title} missed"),
            missed,
        );
    }
    let mut entries: Vec<(String, String)> = (0..people)
        .map(|who| (format!("key {}", colour(who)), name(&case.people, who)))
        .collect();
    entries.push(("key gate-key".to_owned(), "gate; above it: missed".to_owned()));
    Some(Figure {
        title: "Error over time",
        caption: "Distance of each person's track; a mark above the gate where the person has none."
            .to_owned(),
        body: plot.finish() + &legend(&entries),
        width: WIDE,
    })
}
