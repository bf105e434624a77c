//! The list of metrics describes itself, and metrics of our own are what they say they are.

#![expect(
    clippy::unwrap_used,
    reason = "a test stops at what it does not expect, also in its helpers"
)]

use approx::assert_abs_diff_eq;
use hearsight_eval::metrics::calibration::Reliability;
use hearsight_eval::metrics::{FAMILIES, Judged, Unit};
use hearsight_eval::{Case, Measure, Place, Sequence, SequenceError, Sighting, Speech, Turn};
use proptest::prelude::*;
use std::collections::BTreeSet;

/// The value of a metric of one case.
fn value(case: &Case, name: &str) -> Option<f64> {
    let (family, place) = FAMILIES
        .iter()
        .find_map(|family| {
            let place = family.metrics().iter().position(|metric| metric.name == name)?;
            Some((family, place))
        })
        .unwrap();
    let judged = family.judge(std::slice::from_ref(case)).unwrap();
    judged.and_then(|judged| judged.overall[place])
}

fn point(who: u32, x: f64, y: f64) -> Sighting {
    Sighting::new(who, Place::World([x, y, 1.0]))
}

#[test]
fn every_metric_describes_itself() {
    let mut names = BTreeSet::new();
    for family in FAMILIES {
        assert!(!family.name().is_empty() && !family.source().is_empty());
        assert!(!family.metrics().is_empty(), "{}", family.name());
        for metric in family.metrics() {
            assert!(names.insert(metric.name), "{} is there twice", metric.name);
            assert!(
                metric.meaning.ends_with('.'),
                "{}: {}",
                metric.name,
                metric.meaning
            );
            assert!(metric.range[0] < metric.range[1], "{}", metric.name);
        }
    }
    assert!(names.len() > 60, "{}", names.len());
}

/// A track: near which person, how far off, whether marked, and its probabilities.
type Found = (u32, f64, bool, Option<f64>);

/// A case in which every family applies.
fn full_case(frames: &[Vec<Found>]) -> Case {
    let mut sequence = Sequence::new(Measure::Metres, 0.5).unwrap();
    for (index, frame) in frames.iter().enumerate() {
        let truth: Vec<Sighting> = (0..3)
            .map(|who| Sighting {
                speaking: Some(who == index as u32 % 3),
                ..point(who, f64::from(who), 1.0)
            })
            .collect();
        let tracks: Vec<Sighting> = frame
            .iter()
            .enumerate()
            .map(|(who, &(person, shift, speaking, probability))| Sighting {
                speaking: Some(speaking),
                speaking_probability: probability,
                existence: probability,
                ..point(who as u32, f64::from(person % 4) + shift, 1.0)
            })
            .collect();
        sequence
            .push(index as u64, Some(index as f64 * 0.1), &truth, &tracks)
            .unwrap();
    }
    let mut case = Case::new("full", sequence).unwrap();
    case.azimuth_from_m = Some([0.0, 0.0]);
    case.speech = Some(Speech {
        truth: vec![Turn {
            start_s: 0.0,
            end_s: 1.0,
            speaker: 0,
        }],
        result: vec![Turn {
            start_s: 0.5,
            end_s: 1.5,
            speaker: 4,
        }],
        ..Speech::default()
    });
    case
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn values_stay_in_their_range_and_add_up(
        frames in prop::collection::vec(
            prop::collection::vec((any::<u32>(), -0.8..0.8_f64, any::<bool>(), prop::option::of(0.0..=1.0_f64)), 0..6),
            0..12,
        ),
        cut in 0..12_usize,
    ) {
        let whole = full_case(&frames);
        let parts = [full_case(&frames[..cut.min(frames.len())]), full_case(&frames[cut.min(frames.len())..])];
        for family in FAMILIES {
            let judged = family.judge(std::slice::from_ref(&whole)).unwrap();
            let Some(Judged { of_each, overall }) = judged else { continue };
            prop_assert_eq!(of_each[0].as_ref().unwrap(), &overall);
            prop_assert_eq!(overall.len(), family.metrics().len());
            for (metric, value) in family.metrics().iter().zip(&overall) {
                if let Some(value) = value {
                    let [low, high] = metric.range;
                    prop_assert!((low - 1e-12..=high + 1e-12).contains(value), "{}: {value}", metric.name);
                }
            }
            let merged = family.judge(&parts).unwrap().unwrap();
            prop_assert_eq!(merged.of_each.len(), 2);
            for (place, metric) in family.metrics().iter().enumerate() {
                let part = |case: usize| merged.of_each[case].as_ref().and_then(|values| values[place]);
                if metric.unit == Unit::Count {
                    let sum = part(0).unwrap_or(0.0) + part(1).unwrap_or(0.0);
                    prop_assert_eq!(merged.overall[place], Some(sum), "{}", metric.name);
                }
            }
        }
    }
}

#[test]
fn nothing_at_all_has_no_value_and_one_empty_side_has() {
    let mut nothing = Sequence::new(Measure::Metres, 0.5).unwrap();
    nothing.push(1, None, &[], &[]).unwrap();
    let nothing = Case::new("nothing", nothing).unwrap();
    for name in [
        "mota",
        "idf1",
        "HOTA",
        "ospa_distance",
        "gospa_distance",
        "rmse",
        "identification_error",
    ] {
        assert_eq!(value(&nothing, name), None, "{name}");
    }
    assert_eq!(value(&nothing, "num_frames"), Some(1.0));
    let side = |truth: &[Sighting], tracks: &[Sighting]| {
        let mut sequence = Sequence::new(Measure::Metres, 0.5).unwrap();
        sequence.push(1, None, truth, tracks).unwrap();
        Case::new("side", sequence).unwrap()
    };
    let (missed, ghost) = (side(&[point(0, 0.0, 0.0)], &[]), side(&[], &[point(0, 0.0, 0.0)]));
    assert_eq!(value(&missed, "mota"), Some(0.0));
    assert_eq!(value(&ghost, "mota"), None);
    assert_eq!(value(&missed, "HOTA"), Some(0.0));
    assert_eq!(value(&ghost, "LocA"), Some(1.0));
    assert_eq!(value(&missed, "ospa_distance"), Some(0.5));
    assert_eq!(value(&ghost, "gospa_false"), Some(0.125));
}

#[test]
fn errors_of_place_and_direction_are_those_of_pairs() {
    let mut sequence = Sequence::new(Measure::Metres, 0.5).unwrap();
    // Across the half turn: the short way round is taken.
    sequence
        .push(1, None, &[point(0, -1.0, 0.1)], &[point(3, -1.0, -0.1)])
        .unwrap();
    sequence
        .push(
            2,
            None,
            &[point(0, 1.0, 0.0)],
            &[point(3, 1.4, 0.0), point(1, 9.0, 9.0)],
        )
        .unwrap();
    let mut case = Case::new("two", sequence).unwrap();
    assert_eq!(value(&case, "azimuth_mae"), None);
    case.azimuth_from_m = Some([0.0, 0.0]);
    let first = 2.0 * 0.1_f64.atan();
    assert_abs_diff_eq!(
        value(&case, "azimuth_mae").unwrap(),
        (first / 2.0).to_degrees(),
        epsilon = 1e-12
    );
    let mean_square: f64 = first * first / 2.0;
    assert_abs_diff_eq!(
        value(&case, "azimuth_rmse").unwrap(),
        mean_square.sqrt().to_degrees(),
        epsilon = 1e-12
    );
    assert_abs_diff_eq!(
        value(&case, "rmse_x").unwrap(),
        (0.16_f64 / 2.0).sqrt(),
        epsilon = 1e-12
    );
    assert_abs_diff_eq!(
        value(&case, "rmse_y").unwrap(),
        (0.04_f64 / 2.0).sqrt(),
        epsilon = 1e-12
    );
    assert_abs_diff_eq!(
        value(&case, "rmse").unwrap(),
        (0.2_f64 / 2.0).sqrt(),
        epsilon = 1e-12
    );
    assert_eq!(value(&case, "rmse_z"), Some(0.0));
}

#[test]
fn marks_are_judged_by_the_person_of_their_track() {
    let mut sequence = Sequence::new(Measure::Metres, 0.5).unwrap();
    let person = |who, x, speaks| Sighting {
        speaking: Some(speaks),
        ..point(who, x, 0.0)
    };
    let track = |who, x, marked: bool, probability| Sighting {
        speaking: Some(marked),
        speaking_probability: Some(probability),
        ..point(who, x, 0.0)
    };
    // Right; a mark on the silent and a miss; a mark on nobody; a speaker without a track.
    sequence
        .push(
            0,
            None,
            &[person(0, 0.0, true), person(1, 5.0, false)],
            &[track(0, 0.1, true, 0.9), track(1, 5.0, false, 0.1)],
        )
        .unwrap();
    sequence
        .push(
            1,
            None,
            &[person(0, 0.0, true), person(1, 5.0, false)],
            &[track(0, 0.1, false, 0.4), track(1, 5.0, true, 0.6)],
        )
        .unwrap();
    sequence
        .push(2, None, &[person(0, 0.0, true)], &[track(7, 50.0, true, 0.8)])
        .unwrap();
    let case = Case::new("marks", sequence).unwrap();
    assert_eq!(value(&case, "speaking_tp"), Some(1.0));
    assert_eq!(value(&case, "speaking_fp"), Some(2.0));
    assert_eq!(value(&case, "speaking_fn"), Some(2.0));
    assert_eq!(value(&case, "speaking_precision"), Some(1.0 / 3.0));
    assert_eq!(value(&case, "speaking_f1"), Some(2.0 / 6.0));
    // Speaking 0.9, 0.4, 0 (no track); silent 0.1, 0.6, 0.8: at 0.8 a third is missed no more than two thirds are.
    assert_abs_diff_eq!(value(&case, "speaking_eer").unwrap(), 2.0 / 3.0, epsilon = 1e-12);
    // One in each bin: |0.9 - 1|, |0.1 - 0|, |0.4 - 1|, |0.6 - 0|, |0.8 - 0|.
    assert_abs_diff_eq!(
        value(&case, "speaking_ece").unwrap(),
        (0.1 + 0.1 + 0.6 + 0.6 + 0.8) / 5.0,
        epsilon = 1e-12
    );
    assert_eq!(value(&case, "existence_ece"), None);
}

#[test]
fn people_are_identified_when_they_get_their_own_track() {
    let mut sequence = Sequence::new(Measure::Metres, 0.5).unwrap();
    let mut push = |second: f64, people: &[u32], tracks: &[(u32, f64)]| {
        let truth: Vec<Sighting> = people
            .iter()
            .map(|&who| point(who, f64::from(who) * 3.0, 0.0))
            .collect();
        let tracks: Vec<Sighting> = tracks.iter().map(|&(who, x)| point(who, x, 0.0)).collect();
        sequence
            .push((second * 10.0) as u64, Some(second), &truth, &tracks)
            .unwrap();
    };
    // Missed, then the wrong number, then the own one; away for long, back under the own number at once.
    push(0.0, &[0], &[]);
    push(0.5, &[0], &[(5, 0.0)]);
    push(1.0, &[0], &[(2, 0.0)]);
    push(1.5, &[0], &[(2, 0.0)]);
    push(4.0, &[0, 1], &[(2, 0.0)]);
    let case = Case::new("stays", sequence).unwrap();
    assert_eq!(value(&case, "num_stays"), Some(3.0));
    assert_eq!(value(&case, "num_never_identified"), Some(1.0));
    assert_eq!(value(&case, "time_to_identify"), Some(0.5));
    assert_eq!(value(&case, "identification_error"), Some(0.25));
}

#[test]
fn a_reliability_diagram_leaves_out_what_is_no_probability() {
    let mut reliability = Reliability::default();
    for probability in [f64::NAN, -0.1, 1.1, f64::INFINITY] {
        reliability.push(probability, true);
    }
    assert_eq!(reliability.expected_error(), None);
    reliability.push(1.0, true);
    reliability.push(0.95, false);
    let (mean, part, count) = reliability.bins()[9].unwrap();
    assert_eq!((mean, part, count), (0.975, 0.5, 2));
    assert_abs_diff_eq!(reliability.expected_error().unwrap(), 0.475, epsilon = 1e-12);
    assert_abs_diff_eq!(reliability.brier().unwrap(), 0.9025 / 2.0, epsilon = 1e-12);
}

#[test]
fn frames_that_cannot_be_compared_are_refused() {
    let mut sequence = Sequence::new(Measure::Metres, 0.5).unwrap();
    let pixel = Sighting::new(0, Place::Pixel([1.0, 2.0]));
    assert!(matches!(
        sequence.push(1, None, &[pixel], &[]),
        Err(SequenceError::WrongPlace { frame: 1, .. })
    ));
    assert!(matches!(
        sequence.push(1, None, &[point(0, f64::NAN, 0.0)], &[]),
        Err(SequenceError::WrongPlace { .. })
    ));
    for count in [2, 40] {
        let mut twice: Vec<Sighting> = (0..count).map(|who| point(who, 0.0, 0.0)).collect();
        twice.push(point(1, 0.0, 0.0));
        assert!(matches!(
            sequence.push(1, None, &[], &twice),
            Err(SequenceError::Twice {
                who: 1,
                side: "track",
                ..
            })
        ));
    }
    let crowd: Vec<Sighting> = (0..5000).map(|who| point(who, 0.0, 0.0)).collect();
    assert!(matches!(
        sequence.push(1, None, &crowd, &crowd),
        Err(SequenceError::TooLarge { .. })
    ));
    assert!(sequence.is_empty());
    for gate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Sequence::new(Measure::Pixels, gate).is_err());
    }
}
