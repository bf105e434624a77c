use super::search::UNKNOWNS;
use super::*;
use hearsight_core::Span;

fn ring() -> MicrophoneArray {
    let place = |k: usize| {
        let angle = std::f64::consts::TAU * k as f64 / 6.0;
        WorldPoint::new(0.15 * angle.cos(), 0.15 * angle.sin(), 0.9)
    };
    MicrophoneArray::new((0..6).map(place).collect()).unwrap()
}

/// Somebody who walks a figure before the array.
fn mouth(seconds: f64) -> WorldPoint {
    WorldPoint::new(
        1.6 + 0.7 * (0.5 * seconds).sin(),
        1.2 * (0.9 * seconds).sin(),
        1.5,
    )
}

fn sightings(error_m: f64) -> Vec<Sighting> {
    let at = |tick: u32| {
        let seconds = f64::from(tick) * 0.1;
        let wrong = error_m * (1.7 * seconds).sin();
        let place = mouth(seconds).0 + Vector3::new(wrong, 0.3 * wrong, 0.0);
        Sighting {
            time: Instant::ZERO + Span::from_seconds(seconds),
            person: 1,
            mouth: WorldPoint(place),
            covariance: Matrix3::identity() * error_m.max(0.02).powi(2),
        }
    };
    (0..300).map(at).collect()
}

/// What a wrongly declared array hears; every third frame is a reflection.
fn heard(truth: &MicrophoneArray, late_s: f64) -> Vec<HeardDelays> {
    let at = |tick: u32| {
        let seconds = 1.0 + f64::from(tick) * 0.064;
        let from = if tick.is_multiple_of(3) {
            WorldPoint::new(-2.0, 1.0 + f64::from(tick % 7), 2.0)
        } else {
            mouth(seconds)
        };
        let delays_s = truth.pairs().map(|pair| pair.delay_s(from)).collect();
        let declared = Instant::ZERO + Span::from_seconds(seconds - late_s);
        HeardDelays::new(declared, delays_s)
    };
    (0..400).map(at).collect()
}

fn truth() -> (MicrophoneArray, [f64; UNKNOWNS]) {
    let wrong = [0.08, 10.0_f64.to_radians(), 0.15, -0.12, 0.0];
    (moved(&ring(), &wrong).unwrap(), wrong)
}

#[test]
fn an_array_that_is_turned_moved_and_late_is_put_right() {
    let (truth, wrong) = truth();
    let found = calibrate(
        &ring(),
        &heard(&truth, wrong[0]),
        &sightings(0.1),
        &SpeechSettings::default(),
    )
    .unwrap();
    println!("{found:?}");
    assert!((found.offset_s - wrong[0]).abs() < 0.02, "{found:?}");
    assert!((found.turn_rad - wrong[1]).abs() < 0.02, "{found:?}");
    assert!(
        (found.shift_m - Vector3::new(wrong[2], wrong[3], 0.0)).norm() < 0.06,
        "{found:?}"
    );
    assert!(
        found.offset_deviation_s < 0.05 && found.turn_deviation_rad < 0.05,
        "{found:?}"
    );
    assert!(found.share > 0.5 && found.share < 0.8, "{found:?}");
    let applied = found.apply(&ring()).unwrap();
    for (ours, theirs) in applied.positions().iter().zip(truth.positions()) {
        assert!(ours.distance_m(*theirs) < 0.06);
    }
}

#[test]
fn an_answer_outside_of_the_search_is_none() {
    let (array, wrong) = truth();
    let (heard, seen) = (heard(&array, wrong[0]), sightings(0.05));
    let narrow = SpeechSettings {
        offset_s: 0.06,
        ..SpeechSettings::default()
    };
    let found = calibrate(&ring(), &heard, &seen, &narrow).err();
    assert!(
        matches!(found, Some(CalibrateError::Outside { offset_s, .. }) if offset_s > 0.06),
        "{found:?}"
    );
}

#[test]
fn an_answer_that_reaches_beyond_the_search_is_none() {
    let (array, wrong) = truth();
    let (heard, seen) = (heard(&array, wrong[0]), sightings(0.05));
    let free = calibrate(&ring(), &heard, &seen, &SpeechSettings::default()).unwrap();
    let border = |deviations: f64| SpeechSettings {
        offset_s: free.offset_s + deviations * free.offset_deviation_s,
        ..SpeechSettings::default()
    };
    let found = calibrate(&ring(), &heard, &seen, &border(0.5)).err();
    assert!(
        matches!(found, Some(CalibrateError::Outside { offset_s, .. }) if offset_s < border(0.5).offset_s),
        "{found:?}"
    );
    let found = calibrate(&ring(), &heard, &seen, &border(1.5));
    assert!(found.is_ok(), "{found:?}");
}

#[test]
fn who_walks_around_the_array_one_way_looks_the_same_late_as_turned() {
    let place = |seconds: f64| {
        let angle = 0.7 * seconds;
        WorldPoint::new(1.6 * angle.cos(), 1.6 * angle.sin(), 1.5)
    };
    let seen: Vec<Sighting> = (0..150_i32)
        .map(|tick| Sighting {
            time: Instant::ZERO + Span::from_seconds(f64::from(tick) * 0.1),
            person: 1,
            mouth: place(f64::from(tick) * 0.1),
            covariance: Matrix3::identity() * 0.02_f64.powi(2),
        })
        .collect();
    let heard: Vec<HeardDelays> = (0..200_i32)
        .map(|tick| {
            let seconds = 1.0 + f64::from(tick) * 0.064;
            let delays_s = ring().pairs().map(|pair| pair.delay_s(place(seconds))).collect();
            HeardDelays::new(Instant::ZERO + Span::from_seconds(seconds), delays_s)
        })
        .collect();
    let found = calibrate(&ring(), &heard, &seen, &SpeechSettings::default()).err();
    println!("{found:?}");
    assert!(
        matches!(
            found,
            Some(
                CalibrateError::Ambiguous { .. }
                    | CalibrateError::Outside { .. }
                    | CalibrateError::Singular(_)
            )
        ),
        "{found:?}"
    );
}

/// Somebody else walks the same way a little later, and either may be the one who talks.
#[test]
fn two_people_who_explain_the_sound_alike_are_told_apart_by_nothing() {
    let behind = Span::from_seconds(0.25);
    let follower = sightings(0.02).into_iter().map(|sighting| Sighting {
        time: sighting.time + behind,
        person: 2,
        ..sighting
    });
    let leader = sightings(0.02);
    let both: Vec<Sighting> = leader.iter().copied().chain(follower).collect();
    let heard = heard(&ring(), 0.0);
    let error = |seen: &[Sighting]| calibrate(&ring(), &heard, seen, &SpeechSettings::default()).err();
    let found = error(&both);
    let Some(CalibrateError::Ambiguous {
        offset_s,
        other_offset_s,
        ..
    }) = found
    else {
        panic!("{found:?}");
    };
    let apart_s = (offset_s - other_offset_s).abs();
    assert!((apart_s - behind.seconds()).abs() < 0.02, "{found:?}");
    assert_eq!(error(&leader), None);
}

/// Somebody else is in view, silent, and walks elsewhere.
#[test]
fn who_is_silent_in_view_does_no_harm() {
    let (array, wrong) = truth();
    let silent = sightings(0.1).into_iter().map(|sighting| Sighting {
        person: 2,
        mouth: WorldPoint(sighting.mouth.0 + Vector3::new(0.6, -1.5 * sighting.mouth.0.y + 0.4, 0.0)),
        ..sighting
    });
    let seen: Vec<Sighting> = sightings(0.1).into_iter().chain(silent).collect();
    let found = calibrate(
        &ring(),
        &heard(&array, wrong[0]),
        &seen,
        &SpeechSettings::default(),
    )
    .unwrap();
    assert!((found.offset_s - wrong[0]).abs() < 0.03, "{found:?}");
    assert!((found.turn_rad - wrong[1]).abs() < 0.03, "{found:?}");
    assert!(
        (found.shift_m - Vector3::new(wrong[2], wrong[3], 0.0)).norm() < 0.1,
        "{found:?}"
    );
}

#[test]
fn what_is_missing_is_said() {
    let (array, wrong) = truth();
    let (heard, seen) = (heard(&array, wrong[0]), sightings(0.05));
    let settings = SpeechSettings::default();
    let error = |heard: &[HeardDelays], seen: &[Sighting]| calibrate(&ring(), heard, seen, &settings).err();
    assert_eq!(error(&heard, &[]), Some(CalibrateError::SpeakerNeverSeen));
    assert_eq!(error(&[], &seen), Some(CalibrateError::SpeakerNeverHeard));
    assert!(matches!(
        error(&heard[..20], &seen),
        Some(CalibrateError::TooLittleSpeech { frames: 20, .. })
    ));
    let elsewhere: Vec<HeardDelays> = heard
        .iter()
        .enumerate()
        .map(|(tick, frame)| {
            let from = WorldPoint::new(-3.0, (tick % 11) as f64 - 5.0, 0.2);
            HeardDelays::new(frame.time, array.pairs().map(|pair| pair.delay_s(from)).collect())
        })
        .collect();
    let found = error(&elsewhere, &seen);
    assert!(
        matches!(found, Some(CalibrateError::DoesNotFit { .. })),
        "{found:?}"
    );
}
