use super::*;
use hearsight_audio::Complex;
use hearsight_audio::steered_response::SteeredSettings;
use hearsight_core::microphones::MicrophoneArray;
use std::f64::consts::TAU;

const LENGTH: usize = 2048;
const RATE_HZ: u32 = 16_000;
const HOP: Span = Span::from_nanoseconds(100_000_000);
const BOUNDS: Bounds = Bounds {
    low_m: [0.0; 3],
    high_m: [5.0, 4.0, 2.5],
};

fn array() -> MicrophoneArray {
    let at = |k: usize| {
        let corner = |axis: usize| if k >> axis & 1 == 0 { -0.3 } else { 0.3 };
        WorldPoint::new(2.5 + corner(0), 0.4 + corner(1), 1.2 + corner(2))
    };
    MicrophoneArray::new((0..8).map(at).collect()).unwrap()
}

/// Spectra of a white sound at `source`, without walls; `number` changes its phases.
fn heard(array: &MicrophoneArray, source: WorldPoint, number: u32) -> Vec<Vec<Complex>> {
    let channel = |position: &WorldPoint| {
        let lag = source.distance_m(*position) / 343.0 * f64::from(RATE_HZ);
        let mut phase = 0.37 + 0.01 * f64::from(number);
        let mut bin = |k: usize| {
            phase = (phase * 997.0 + 0.123).fract();
            Complex::from_polar(1.0, (TAU * (phase - k as f64 * lag / LENGTH as f64)) as f32)
        };
        (0..=LENGTH / 2).map(&mut bin).collect()
    };
    array.positions().iter().map(channel).collect()
}

fn response() -> SteeredResponse {
    SteeredResponse::new(&array(), LENGTH, RATE_HZ, SteeredSettings::default()).unwrap()
}

fn tracker(settings: SoundSettings) -> SoundTracker {
    SoundTracker::new(settings, BOUNDS, &response(), 7, "sound").unwrap()
}

/// Listens to a sound at `source` from frame `from` on.
fn listen(tracker: &mut SoundTracker, source: [f64; 3], frames: std::ops::Range<i64>) {
    let mut response = response();
    for number in frames {
        let source = WorldPoint::new(source[0], source[1], source[2]);
        response.observe(&heard(&array(), source, number as u32)).unwrap();
        tracker
            .listen(&mut response, Instant::ZERO + HOP * number)
            .unwrap();
    }
}

fn error_m(tracker: &SoundTracker, source: [f64; 3]) -> f64 {
    let source = WorldPoint::new(source[0], source[1], source[2]);
    tracker.estimate().unwrap().mean.distance_m(source)
}

const LEFT: [f64; 3] = [1.2, 2.4, 1.5];
const RIGHT: [f64; 3] = [4.1, 2.2, 1.3];

#[test]
fn a_sound_is_found_in_three_dimensions_with_its_uncertainty() {
    let mut tracker = tracker(SoundSettings::default());
    assert!(tracker.estimate().is_none());
    listen(&mut tracker, LEFT, 0..20);
    let error = error_m(&tracker, LEFT);
    let covariance = tracker.estimate().unwrap().covariance;
    println!(
        "off by {error:.3} m, deviations {:?}",
        covariance.diagonal().map(f64::sqrt).as_slice()
    );
    assert!(error < 0.35, "{error}");
    let deviations = covariance.symmetric_eigenvalues().map(f64::sqrt);
    assert!(
        deviations.iter().all(|deviation| *deviation < 0.8),
        "{deviations}"
    );
}

#[test]
fn only_with_an_external_does_a_trapped_filter_follow_a_new_speaker() {
    let external = |external| SoundSettings {
        external,
        height: None,
        velocity_m_s: 0.3,
        ..SoundSettings::default()
    };
    let filter = External::Filter {
        particles: 2000,
        distance_m: 1.0,
        time_s: 1.0,
    };
    for (name, settings, frames, follows) in [
        ("off", external(External::Off), 8, false),
        ("filter", external(filter), 14, true),
        ("grid", external(External::default()), 5, true),
    ] {
        let mut tracker = tracker(settings);
        listen(&mut tracker, LEFT, 0..30);
        let before = tracker.takeovers();
        listen(&mut tracker, RIGHT, 30..30 + frames);
        let error = error_m(&tracker, RIGHT);
        println!("{name}: off by {error:.2} m after {frames} frames");
        assert_eq!(error < 1.0, follows, "{name}: {error}");
        assert_eq!(tracker.takeovers() > before, follows, "{name}");
    }
}

#[test]
fn a_saved_sound_goes_on_with_the_same_bytes() {
    let mut first = tracker(SoundSettings::default());
    listen(&mut first, LEFT, 0..6);
    let text = serde_json::to_string(first.belief()).unwrap();
    let mut second = tracker(SoundSettings::default());
    second.set_belief(serde_json::from_str(&text).unwrap());
    for tracker in [&mut first, &mut second] {
        listen(tracker, RIGHT, 6..14);
    }
    assert_eq!(first.belief(), second.belief());
    let few = SoundSettings {
        particles: 50,
        ..SoundSettings::default()
    };
    assert!(second.accepts(first.belief()) && !tracker(few).accepts(first.belief()));
}

#[test]
fn mistakes_are_errors() {
    let new = |settings, bounds| SoundTracker::new(settings, bounds, &response(), 1, "sound");
    let settings = SoundSettings::default();
    let no_room = Bounds {
        low_m: [1.0; 3],
        high_m: [0.0; 3],
    };
    assert!(new(settings, no_room).is_err());
    for wrong in [
        SoundSettings {
            particles: 0,
            ..settings
        },
        SoundSettings {
            velocity_m_s: -1.0,
            ..settings
        },
        SoundSettings {
            height: Some(HeightPrior {
                mean_m: 1.4,
                deviation_m: 0.0,
            }),
            ..settings
        },
        SoundSettings {
            external: External::Filter {
                particles: 10,
                distance_m: f64::NAN,
                time_s: 1.0,
            },
            ..settings
        },
    ] {
        assert!(new(wrong, BOUNDS).is_err());
    }
}
