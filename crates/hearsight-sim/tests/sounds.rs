//! Sound files are read as they were written, damaged ones are refused; measured responses are heard.

use hearsight_core::{AudioBlock, WorldPoint};
use hearsight_sim::acoustics::{
    ArrayRenderer, Clip, Directivity, Emission, MeasuredResponse, Microphone, RenderSettings, Shoebox,
    ShoeboxSettings, SoundSource, Standing, Walls,
};
use hearsight_sim::voice::read_sound;
use nalgebra::Vector3;
use std::path::Path;
use std::sync::Arc;

const TONE: &[u8] = include_bytes!("goldens/tone.flac");

#[test]
fn flac_is_read_to_the_last_bit() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/goldens/tone.flac");
    let sound = read_sound(&path).unwrap();
    assert_eq!(
        (sound.rate_hz, sound.channels.len(), sound.channels[0].len()),
        (16_000, 2, 1600)
    );
    for (n, (left, right)) in sound.channels[0].iter().zip(&sound.channels[1]).enumerate() {
        let tone = 10_000.0 * (0.2 * n as f64).sin();
        assert_eq!(f64::from(*left) * 32_768.0, tone.round_ties_even());
        assert_eq!(f64::from(*right) * 32_768.0, (-0.5 * tone).round_ties_even());
    }
}

#[test]
fn damaged_flac_is_refused_or_read_but_never_worse() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.flac");
    let (mut read, mut refused) = (0, 0);
    let mut state = 1_u64;
    for case in 0..800 {
        let mut bytes = TONE.to_vec();
        for _ in 0..1 + case % 4 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let at = (state >> 33) as usize % bytes.len();
            // Most damage where the file says what it is.
            let at = if case % 2 == 0 { at % 80 } else { at };
            bytes[at] = (state >> 24) as u8;
        }
        if case % 5 == 0 {
            bytes.truncate((state >> 40) as usize % bytes.len());
        }
        std::fs::write(&path, &bytes).unwrap();
        match read_sound(&path) {
            Ok(sound) => {
                assert!(
                    sound
                        .channels
                        .iter()
                        .all(|channel| channel.len() == sound.channels[0].len())
                );
                read += 1;
            }
            Err(error) => {
                assert!(error.to_string().contains("damaged.flac"));
                refused += 1;
            }
        }
    }
    println!("{read} read, {refused} refused");
    assert!(read > 0 && refused > 0);
}

#[test]
fn measured_responses_are_heard_instead_of_simulated_ones() {
    let rate_hz = 16_000;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hall.wav");
    let spec = hound::WavSpec {
        channels: 2,
        sample_rate: rate_hz,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(&path, spec).unwrap();
    for n in 0..5000_u32 {
        for (channel, at) in [(0, 100), (1, 4321)] {
            writer
                .write_sample(if n == at { 0.5 + channel as f32 } else { 0.0 })
                .unwrap();
        }
    }
    writer.finalize().unwrap();
    let room = Shoebox::new(&ShoeboxSettings::new([5.0, 4.0, 2.6], Walls::T60(0.3))).unwrap();
    let source = |name: &str| SoundSource {
        name: name.to_owned(),
        path: Arc::new(Standing(Emission {
            position: WorldPoint::new(1.0, 1.0, 1.0),
            facing: Vector3::x(),
        })),
        sound: Arc::new(Clip {
            rate_hz,
            first: 1000,
            samples: vec![1.0],
        }),
        directivity: Directivity::CARDIOID,
        level_db: 0.0,
    };
    let mut settings = RenderSettings::new(rate_hz);
    settings.measured = MeasuredResponse::read(&path, "flute").unwrap();
    assert_eq!(settings.measured.len(), 2);
    let microphones = || {
        vec![
            Microphone {
                corner_hz: 1.0,
                ..Microphone::default()
            };
            3
        ]
    };
    let mut renderer = ArrayRenderer::new(&room, vec![source("flute")], microphones(), &settings).unwrap();
    let mut block = AudioBlock::default();
    let places = vec![WorldPoint::new(3.0, 2.0, 1.0); 3];
    renderer.render(&places, 8000, &mut block).unwrap();
    for (channel, at, value) in [(0, 1100, 0.5), (1, 5321, 1.5)] {
        let found = &block.channels[channel];
        assert!((found[at] - value).abs() < 1e-2, "{}", found[at]);
        let other = found
            .iter()
            .enumerate()
            .filter(|(n, _)| *n != at)
            .map(|(_, x)| x.abs())
            .fold(0.0, f32::max);
        assert!(other < 2e-3 * value, "{other}");
    }
    // The third microphone has none and hears the room: 2.24 m away, and its echoes.
    let direct = 1000 + (5.0_f64.sqrt() / 343.0 * 16_000.0).round() as usize;
    assert!(block.channels[2][direct].abs() > 0.2);
    assert!(
        block.channels[2][direct + 200..]
            .iter()
            .filter(|sample| sample.abs() > 1e-3)
            .count()
            > 50
    );

    let unknown = ArrayRenderer::new(&room, vec![source("oboe")], microphones(), &settings)
        .err()
        .unwrap();
    assert!(unknown.to_string().contains("flute"), "{unknown}");
    settings.measured[0].rate_hz = 44_100;
    let error = ArrayRenderer::new(&room, vec![source("flute")], microphones(), &settings)
        .err()
        .unwrap();
    assert!(error.to_string().contains("16000"), "{error}");
}
