//! Metrics beside the reference implementations on random sequences (goldens/make_metrics.py).

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at what it does not expect, also in its helpers"
)]

use approx::assert_abs_diff_eq;
use hearsight_core::record::BoxRecord;
use hearsight_eval::metrics::equal_error::EqualErrorCounts;
use hearsight_eval::metrics::{Judge, clear, diarization, gospa, hota, identity, jaccard, ospa};
use hearsight_eval::{Case, Measure, Place, Sequence, Sighting, Speech, Turn};
use serde_json::Value;
use std::collections::BTreeMap;

const TOLERANCE: f64 = 1e-6;

fn goldens() -> Value {
    serde_json::from_str(include_str!("goldens/metrics.json")).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The sequence of a golden.
fn sequence(golden: &Value) -> Sequence {
    let measure = match golden["kind"].as_str().unwrap() {
        "boxes" => Measure::Overlap,
        "pixels" => Measure::Pixels,
        _ => Measure::Metres,
    };
    let mut sequence = Sequence::new(measure, number(&golden["gate"])).unwrap();
    let sighting = |row: &Value| {
        let row: Vec<f64> = row.as_array().unwrap().iter().map(number).collect();
        let place = match (measure, row.as_slice()) {
            (Measure::Overlap, &[_, left, top, width, height]) => Place::Box(BoxRecord {
                left,
                top,
                width,
                height,
            }),
            (Measure::Pixels, &[_, u, v]) => Place::Pixel([u, v]),
            (Measure::Metres, &[_, x, y, z]) => Place::World([x, y, z]),
            other => panic!("{other:?}"),
        };
        Sighting::new(row[0] as u32, place)
    };
    for (index, frame) in golden["frames"].as_array().unwrap().iter().enumerate() {
        let side =
            |side: usize| -> Vec<Sighting> { frame[side].as_array().unwrap().iter().map(sighting).collect() };
        sequence
            .push(index as u64 + 1, Some(index as f64 * 0.04), &side(0), &side(1))
            .unwrap();
    }
    sequence
}

/// Compares the values of a family with those of the same name.
fn compare(family: &dyn Judge, cases: &[Case], overall: bool, golden: &Value) {
    let judged = family.judge(cases).unwrap().unwrap();
    let values = if overall {
        judged.overall
    } else {
        judged.of_each[0].clone().unwrap()
    };
    assert_eq!(values.len(), family.metrics().len());
    for (info, value) in family.metrics().iter().zip(values) {
        match (value, golden[info.name].as_f64()) {
            (Some(ours), Some(theirs)) => {
                assert!(
                    (ours - theirs).abs() <= TOLERANCE,
                    "{}: {ours} {theirs}",
                    info.name
                );
            }
            (None, None) => assert!(golden[info.name].is_null()),
            other => panic!("{}: {other:?}", info.name),
        }
    }
}

fn cases() -> Vec<(Value, Case)> {
    let goldens = goldens();
    let all = goldens["sequences"].as_array().unwrap().iter();
    all.map(|golden| (golden.clone(), Case::new("random", sequence(golden)).unwrap()))
        .collect()
}

#[test]
fn clear_and_identity_agree_with_motmetrics_and_hota_with_trackeval() {
    let cases = cases();
    assert_eq!(cases.len(), 9);
    for (golden, case) in cases {
        let case = [case];
        compare(&clear::Clear, &case, false, &golden["motmetrics"]);
        compare(&identity::Identity, &case, false, &golden["motmetrics"]);
        compare(&hota::Hota, &case, false, &golden["trackeval"]);
    }
}

#[test]
fn sequences_are_merged_by_their_counts() {
    let boxes = cases().into_iter().filter(|(golden, case)| {
        golden["kind"] == "boxes"
            && golden["gate"] == 0.5
            && !case.sequence.truth().is_empty()
            && !case.sequence.tracks().is_empty()
    });
    let boxes: Vec<Case> = boxes.map(|(_, case)| case).collect();
    assert_eq!(boxes.len(), 2);
    let golden = &goldens()["overall"];
    compare(&clear::Clear, &boxes, true, &golden["motmetrics"]);
    compare(&identity::Identity, &boxes, true, &golden["motmetrics"]);
    compare(&hota::Hota, &boxes, true, &golden["trackeval"]);
}

#[test]
fn distances_of_sets_agree_with_stone_soup() {
    let mut compared = 0;
    for (golden, case) in cases() {
        let Some(expected) = golden["sets"].as_array() else {
            continue;
        };
        let gate = case.sequence.gate();
        let first = ospa::ospa(&case.sequence, gate, 1.0).unwrap();
        let second = ospa::ospa(&case.sequence, gate, 2.0).unwrap();
        let parts = gospa::gospa(&case.sequence, gate, 2.0).unwrap();
        assert_eq!(expected.len(), first.len());
        for (index, expected) in expected.iter().enumerate() {
            let Some(expected) = expected.as_array() else {
                assert_eq!((first[index], second[index], parts[index]), (None, None, None));
                continue;
            };
            let part = parts[index].unwrap();
            let ours = [
                first[index].unwrap(),
                second[index].unwrap(),
                part.distance,
                part.localisation,
                part.missed,
                part.false_tracks,
            ];
            for (ours, theirs) in ours.iter().zip(expected) {
                assert_abs_diff_eq!(*ours, number(theirs), epsilon = TOLERANCE);
            }
            compared += 1;
        }
    }
    assert!(compared > 70, "{compared}");
}

fn turns(golden: &Value) -> Vec<Turn> {
    let turn = |row: &Value| Turn {
        start_s: number(&row[0]),
        end_s: number(&row[1]),
        speaker: number(&row[2]) as u32,
    };
    golden.as_array().unwrap().iter().map(turn).collect()
}

#[test]
fn speech_agrees_with_pyannote() {
    use hearsight_eval::metrics::Counts;
    let goldens = goldens();
    let mut sums: BTreeMap<usize, (diarization::DiarizationCounts, jaccard::JaccardCounts)> = BTreeMap::new();
    for golden in goldens["speech"]["cases"].as_array().unwrap() {
        for (option, score) in golden["scores"].as_array().unwrap().iter().enumerate() {
            let speech = Speech {
                truth: turns(&golden["truth"]),
                result: turns(&golden["result"]),
                span_s: golden["span"]
                    .as_array()
                    .map(|span| [number(&span[0]), number(&span[1])]),
                collar_s: number(&score["collar"]),
                skip_overlap: score["skip"].as_bool().unwrap(),
            };
            let counts = diarization::diarization(&speech).unwrap();
            let parts = &score["parts"];
            for (ours, name) in [
                (counts.rate(), "diarization error rate"),
                (counts.total_s, "total"),
                (counts.correct_s, "correct"),
                (counts.missed_s, "missed detection"),
                (counts.false_alarm_s, "false alarm"),
                (counts.confusion_s, "confusion"),
            ] {
                assert_abs_diff_eq!(ours, number(&parts[name]), epsilon = TOLERANCE);
            }
            let speakers = jaccard::jaccard(&speech).unwrap();
            assert_eq!(speakers.speakers as f64, number(&score["speakers"]));
            assert_eq!(speakers.values()[0].is_some(), score["jer"].is_number());
            if let Some(ours) = speakers.values()[0] {
                assert_abs_diff_eq!(ours, number(&score["jer"]), epsilon = TOLERANCE);
            }
            let sum = sums.entry(option).or_default();
            sum.0.add(&counts);
            sum.1.add(&speakers);
        }
    }
    for (option, (counts, speakers)) in sums {
        let golden = &goldens["speech"]["overall"][option];
        assert_abs_diff_eq!(counts.rate(), number(&golden[0]), epsilon = TOLERANCE);
        assert_abs_diff_eq!(
            speakers.values()[0].unwrap(),
            number(&golden[1]),
            epsilon = TOLERANCE
        );
    }
}

#[test]
fn the_equal_error_point_is_where_the_curve_crosses() {
    for golden in goldens()["equal_errors"].as_array().unwrap() {
        let side = |name: &str| -> Vec<f64> { golden[name].as_array().unwrap().iter().map(number).collect() };
        let counts = EqualErrorCounts {
            speaking: side("speaking"),
            silent: side("silent"),
        };
        let point = counts.point().unwrap();
        assert_abs_diff_eq!(point.rate, number(&golden["rate"]), epsilon = TOLERANCE);
        let (above, below) = (point.threshold + 0.11, point.threshold - 0.11);
        let missed =
            |threshold: f64| counts.speaking.iter().filter(|score| **score < threshold).count() as f64;
        let part = |threshold: f64| missed(threshold) / counts.speaking.len() as f64;
        assert!(part(below) <= point.rate && point.rate <= part(above));
    }
}
