//! An array that hears AV16.3's sequence 30, declared wrong: put right from the true places of the mouths, so that what is
//! tested is listening and fitting, not seeing. Skips where the data is missing.
#![expect(clippy::unwrap_used, reason = "tests")]

use hearsight_calibrate::speech::{ArrayCalibration, Listener, Sighting, SpeechSettings, calibrate};
use hearsight_core::microphones::MicrophoneArray;
use hearsight_core::{AudioBlock, Instant, Span, WorldPoint};
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::path::{Path, PathBuf};

const RATE_HZ: u32 = 16_000;
/// When the arrays' files begin.
const START_S: f64 = 11.0;
const LATE_S: f64 = 0.08;
const TURN_DEG: f64 = 10.0;

fn folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/av16.3-seq30/arrays");
    if !folder.exists() {
        println!("skipped: {} is not there", folder.display());
        return None;
    }
    Some(folder)
}

/// The channels of a file of 16-bit samples with the plain header of 44 bytes.
fn channels(file: &Path) -> Vec<Vec<f32>> {
    let bytes = std::fs::read(file).unwrap();
    let count = usize::from(u16::from_le_bytes([bytes[22], bytes[23]]));
    assert_eq!(u32::from_le_bytes(bytes[24..28].try_into().unwrap()), RATE_HZ);
    let mut channels = vec![Vec::new(); count];
    for (number, sample) in bytes[44..].chunks_exact(2).enumerate() {
        channels[number % count].push(f32::from(i16::from_le_bytes([sample[0], sample[1]])) / 32768.0);
    }
    channels
}

fn mouths(file: &Path) -> Vec<Sighting> {
    let text = std::fs::read_to_string(file).unwrap();
    let sighting = |line: &str| {
        let values: Vec<f64> = line.split(',').map(|value| value.parse().unwrap()).collect();
        Sighting {
            time: Instant::ZERO + Span::from_seconds(values[0]),
            person: values[1] as u64,
            mouth: WorldPoint::new(values[2], values[3], values[4]),
            covariance: Matrix3::identity() * 0.03_f64.powi(2),
        }
    };
    text.lines().skip(1).map(sighting).collect()
}

/// What may be left of the wrong that was declared.
struct Bounds {
    clock_s: f64,
    turn_deg: f64,
    level_m: f64,
    /// Least share of frames that fit.
    share: f64,
}

fn assert_put_right(name: &str, bounds: &Bounds) {
    let shift = Vector3::new(0.14, 0.14, 0.0);
    let Some(found) = put_right(name, shift) else {
        return;
    };
    assert!((found.offset_s - LATE_S).abs() < bounds.clock_s, "{found:?}");
    let turn_deg = found.turn_rad.to_degrees();
    assert!((turn_deg - TURN_DEG).abs() < bounds.turn_deg, "{found:?}");
    assert!((found.shift_m - shift).xy().norm() < bounds.level_m, "{found:?}");
    assert!(found.share > bounds.share, "{found:?}");
}

fn put_right(name: &str, shift_m: Vector3<f64>) -> Option<ArrayCalibration> {
    let folder = folder()?;
    let text = std::fs::read_to_string(folder.join("arrays.json")).unwrap();
    let arrays: serde_json::Value = serde_json::from_str(&text).unwrap();
    let places: Vec<[f64; 3]> = serde_json::from_value(arrays["arrays_m"][name].clone()).unwrap();
    let places = places.into_iter().map(|[x, y, z]| WorldPoint::new(x, y, z));
    let truth = MicrophoneArray::new(places.collect()).unwrap();
    let centre = truth.centre().0;
    let back = Rotation3::from_axis_angle(&Vector3::z_axis(), -TURN_DEG.to_radians());
    let wrong = truth.positions().iter();
    let wrong = wrong.map(|place| WorldPoint(centre - shift_m + back * (place.0 - centre)));
    let declared = MicrophoneArray::new(wrong.collect()).unwrap();
    let mut listener = Listener::new(&declared, RATE_HZ).unwrap();
    let channels = channels(&folder.join(format!("{name}.wav")));
    for start in (0..channels[0].len()).step_by(640) {
        let end = (start + 640).min(channels[0].len());
        let seconds = START_S - LATE_S + start as f64 / f64::from(RATE_HZ);
        let block = AudioBlock {
            time: Instant::ZERO + Span::from_seconds(seconds),
            rate_hz: RATE_HZ,
            channels: channels
                .iter()
                .map(|channel| channel[start..end].to_vec())
                .collect(),
        };
        listener.hear(&block).unwrap();
    }
    let seen = mouths(&folder.join("truth.csv"));
    let found = calibrate(&declared, &listener.loud(), &seen, &SpeechSettings::default()).unwrap();
    println!("{name}: {found:?}");
    Some(found)
}

#[test]
fn a_circle_of_eight_is_put_right() {
    let bounds = Bounds {
        clock_s: 0.04,
        turn_deg: 1.5,
        level_m: 0.06,
        share: 0.9,
    };
    assert_put_right("array1", &bounds);
}

#[test]
fn a_line_of_three_is_put_right() {
    let bounds = Bounds {
        clock_s: 0.05,
        turn_deg: 3.0,
        level_m: 0.12,
        share: 0.7,
    };
    assert_put_right("line3", &bounds);
}
