//! What is wrong with an input is said when it is opened, with the file, the trouble and the cure.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its input fails")]

mod common;

use common::{count, generate, hear_all, read_all};
use hearsight_core::source::{AudioSource, Delivery, VideoSource};
use hearsight_core::{FaultKind, Span};
use hearsight_media::{
    AudioFile, AudioOptions, ChannelSelection, ImageOptions, ImageSequence, MediaError, MomentError,
    MomentOptions, MomentReader, VideoFile, VideoOptions,
};
use std::path::Path;

fn camera_error(path: &Path) -> MediaError {
    let error = VideoFile::open(path, VideoOptions::default()).err().unwrap();
    assert!(error.to_string().contains(path.to_str().unwrap()), "{error}");
    error
}

fn array_error(path: &Path, options: AudioOptions) -> MediaError {
    let error = AudioFile::open(path, options).err().unwrap();
    assert!(error.to_string().contains(path.to_str().unwrap()), "{error}");
    error
}

fn wav(path: &Path, channels: u16, samples: &[f32]) {
    let spec = hound::WavSpec {
        channels,
        sample_rate: 8000,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(path, spec).unwrap();
    for sample in samples {
        for channel in 0..channels {
            writer.write_sample(*sample + f32::from(channel)).unwrap();
        }
    }
    writer.finalize().unwrap();
}

#[test]
fn files_that_are_no_media() {
    let place = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| {
        let path = place.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let missing = place.path().join("missing.avi");
    let empty = file("empty.avi", b"");
    let text = file("text.avi", &b"This is not a film.\n".repeat(200));
    let zeros = file("zeros.mp4", &[0; 20_000]);
    assert!(matches!(camera_error(&missing), MediaError::Missing { .. }));
    assert!(matches!(camera_error(place.path()), MediaError::Directory { .. }));
    assert!(matches!(camera_error(&empty), MediaError::Empty { .. }));
    assert!(matches!(
        camera_error(&text),
        MediaError::NotMedia { .. } | MediaError::NoVideo { .. }
    ));
    assert!(matches!(
        camera_error(&zeros),
        MediaError::NotMedia { .. } | MediaError::NoVideo { .. }
    ));
    let array = |path: &Path| array_error(path, AudioOptions::default());
    assert!(matches!(array(&missing), MediaError::Missing { .. }));
    assert!(matches!(array(place.path()), MediaError::Directory { .. }));
    assert!(matches!(array(&empty), MediaError::Empty { .. }));
    assert!(matches!(
        array(&file("text.wav", b"RIFFxxxxWAVE")),
        MediaError::NotMedia { .. }
    ));
    let null = VideoFile::open_location("a\0b.avi", VideoOptions::default())
        .err()
        .unwrap();
    assert!(matches!(null, MediaError::Missing { .. }));
    let device = VideoFile::open_location("/dev/video97", VideoOptions::default())
        .err()
        .unwrap();
    assert!(matches!(device, MediaError::Missing { .. }));
    assert!(matches!(
        ImageSequence::open(place.path(), ImageOptions::default())
            .err()
            .unwrap(),
        MediaError::NoPictures { .. }
    ));
}

#[test]
fn sound_is_no_camera_and_the_other_way_round() {
    let place = tempfile::tempdir().unwrap();
    let sound = place.path().join("sound.wav");
    wav(&sound, 1, &[0.0; 4000]);
    let error = camera_error(&sound);
    assert!(
        matches!(&error, MediaError::NoVideo { found, .. } if found.contains("audio")),
        "{error}"
    );
    let Some(film) = generate(place.path(), "film.avi", 1, &["-an", "-c:v", "mpeg4"]) else {
        return;
    };
    let error = array_error(&film, AudioOptions::default());
    assert!(
        matches!(&error, MediaError::NoAudio { found, .. } if found.contains("video")),
        "{error}"
    );
    let mut options = VideoOptions::default();
    options.input.stream = Some(3);
    assert!(matches!(
        VideoFile::open(&film, options).err().unwrap(),
        MediaError::WrongStream {
            wanted: 3,
            kind: "video",
            ..
        }
    ));
}

#[test]
fn channels_are_counted_chosen_and_ordered() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("three.wav");
    wav(&path, 3, &[0.0; 500]);
    let options = |channels| AudioOptions {
        channels,
        ..AudioOptions::default()
    };
    assert!(matches!(
        array_error(&path, options(ChannelSelection::Exactly(8))),
        MediaError::WrongChannels {
            expected: 8,
            found: 3,
            ..
        }
    ));
    assert!(matches!(
        array_error(&path, options(ChannelSelection::These(vec![0, 3]))),
        MediaError::NoSuchChannel {
            channel: 3,
            last: 2,
            ..
        }
    ));
    assert!(matches!(
        array_error(&path, options(ChannelSelection::These(Vec::new()))),
        MediaError::BadOption { .. }
    ));
    assert!(matches!(
        array_error(
            &path,
            AudioOptions {
                rate_hz: Some(0),
                ..AudioOptions::default()
            }
        ),
        MediaError::BadOption { .. }
    ));
    let mut array = AudioFile::open(&path, options(ChannelSelection::These(vec![2, 0]))).unwrap();
    assert_eq!(array.format().channels, 2);
    let (samples, faults) = hear_all(&mut array);
    assert_eq!(samples, [vec![2.0; 500], vec![0.0; 500]]);
    assert_eq!(faults, []);
}

#[test]
fn samples_that_are_no_numbers_become_zero_and_are_counted() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("nan.wav");
    let mut samples = [0.25; 9000];
    samples[8000] = f32::NAN;
    samples[8001] = f32::NEG_INFINITY;
    wav(&path, 1, &samples);
    let (heard, faults) = hear_all(&mut AudioFile::open(&path, AudioOptions::default()).unwrap());
    assert_eq!(heard[0].iter().filter(|sample| **sample == 0.25).count(), 8998);
    assert_eq!(heard[0][8000..8002], [0.0, 0.0]);
    assert_eq!(count(&faults, FaultKind::NonFinite), 1, "{faults:?}");
    assert!(faults[0].detail.starts_with("2 samples"));
    assert!((faults[0].time_s - 1.0).abs() < 0.3);
}

#[test]
fn a_wav_cut_short_gives_what_is_there_and_says_so() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("cut.wav");
    wav(&path, 2, &[0.5; 8000]);
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() - 8 * 3000 - 4]).unwrap();
    let mut array = AudioFile::open(
        &path,
        AudioOptions {
            rate_hz: Some(16_000),
            ..AudioOptions::default()
        },
    )
    .unwrap();
    assert_eq!(array.format().samples, Some(16_000));
    let (heard, faults) = hear_all(&mut array);
    assert_eq!(heard[1].len(), 2 * 4999);
    assert_eq!(count(&faults, FaultKind::EndedEarly), 1, "{faults:?}");
    assert!(faults[0].detail.contains("4999 of the 8000"), "{faults:?}");
}

#[test]
fn every_depth_of_wav_has_the_same_level() {
    let place = tempfile::tempdir().unwrap();
    for bits in [8, 16, 24, 32_u16] {
        let path = place.path().join(format!("{bits}.wav"));
        let spec = hound::WavSpec {
            channels: 1,
            sample_rate: 16_000,
            bits_per_sample: bits,
            sample_format: hound::SampleFormat::Int,
        };
        let mut writer = hound::WavWriter::create(&path, spec).unwrap();
        for _ in 0..100 {
            writer.write_sample(-(1_i32 << (bits - 2))).unwrap();
        }
        writer.finalize().unwrap();
        let (heard, faults) = hear_all(&mut AudioFile::open(&path, AudioOptions::default()).unwrap());
        assert_eq!(heard, [vec![-0.5; 100]], "{bits}");
        assert_eq!(faults, []);
    }
}

#[test]
fn options_that_make_no_sense() {
    let place = tempfile::tempdir().unwrap();
    assert_eq!(
        MomentReader::new(Vec::new(), Vec::new(), MomentOptions::default()).err(),
        Some(MomentError::NoSources)
    );
    let Some(film) = generate(place.path(), "film.avi", 1, &["-c:v", "mpeg4"]) else {
        return;
    };
    let options = VideoOptions {
        interval: Some(Span::ZERO),
        ..VideoOptions::default()
    };
    assert!(matches!(
        VideoFile::open(&film, options).err().unwrap(),
        MediaError::BadOption { .. }
    ));
    let mut options = VideoOptions::default();
    options.input.format = Some("no such format".to_owned());
    assert!(matches!(
        VideoFile::open(&film, options).err().unwrap(),
        MediaError::BadOption { .. }
    ));
}

#[test]
fn sound_and_pictures_of_many_containers() {
    let place = tempfile::tempdir().unwrap();
    let kinds: [(&str, &[&str]); 6] = [
        ("a.avi", &["-c:v", "mpeg4", "-c:a", "pcm_s16le"]),
        ("b.mp4", &["-c:v", "libx264", "-c:a", "aac"]),
        (
            "c.mkv",
            &[
                "-c:v",
                "libvpx-vp9",
                "-deadline",
                "realtime",
                "-cpu-used",
                "8",
                "-c:a",
                "flac",
            ],
        ),
        ("d.ts", &["-c:v", "mpeg2video", "-c:a", "mp2"]),
        ("e.mov", &["-c:v", "mjpeg", "-c:a", "pcm_f32le"]),
        (
            "f.nut",
            &["-c:v", "rawvideo", "-pix_fmt", "bgr24", "-c:a", "pcm_s24le"],
        ),
    ];
    for (name, codecs) in kinds {
        let Some(path) = generate(place.path(), name, 2, codecs) else {
            return;
        };
        let mut camera = VideoFile::open(&path, VideoOptions::default()).unwrap();
        let start = camera.format().start.nanoseconds();
        assert_eq!(
            camera.format().interval,
            Span::from_nanoseconds(40_000_000),
            "{name}"
        );
        let (frames, faults) = read_all(&mut camera);
        assert_eq!(faults, [], "{name}");
        assert_eq!(frames.len(), 50, "{name}");
        for (index, (number, time)) in frames.iter().enumerate() {
            assert_eq!(*number, index as u64 + 1, "{name}");
            assert!(
                (time - start - index as i64 * 40_000_000).abs() <= 1_000_000,
                "{name} {index} {time}"
            );
        }
        let (sound, faults) = hear_all(&mut AudioFile::open(&path, AudioOptions::default()).unwrap());
        assert_eq!(faults, [], "{name}");
        let length = sound[0].len();
        assert!((31_000..=34_500).contains(&length), "{name}: {length}");
        let power = sound[0].iter().map(|sample| sample * sample).sum::<f32>() / length as f32;
        // The generator's sine has an amplitude of an eighth.
        assert!(
            (power.sqrt() - 0.125 / 2.0_f32.sqrt()).abs() < 0.01,
            "{name}: {power}"
        );
    }
}

#[test]
fn damaged_containers_neither_panic_nor_hang() {
    let place = tempfile::tempdir().unwrap();
    let kinds: [(&str, &[&str]); 5] = [
        ("a.avi", &["-c:v", "mpeg4", "-c:a", "pcm_s16le"]),
        ("b.mp4", &["-c:v", "libx264", "-c:a", "aac"]),
        ("c.mkv", &["-c:v", "mpeg4", "-c:a", "flac"]),
        ("d.ts", &["-c:v", "mpeg2video", "-c:a", "mp2"]),
        ("e.wav", &["-vn", "-c:a", "pcm_s24le"]),
    ];
    let mut state = 3_u64;
    let mut random = move |limit: usize| {
        // A linear congruential generator (Knuth, MMIX): the same damage in every run.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % limit
    };
    let begun = std::time::Instant::now();
    let mut opened = 0;
    for (name, codecs) in kinds {
        let Some(path) = generate(place.path(), name, 1, codecs) else {
            return;
        };
        let whole = std::fs::read(&path).unwrap();
        for round in 0..24 {
            let mut bytes = whole.clone();
            // Headers are hit as often as everything else.
            for _ in 0..=random(40) {
                let limit = if round % 2 == 0 {
                    bytes.len().min(3000)
                } else {
                    bytes.len()
                };
                bytes[random(limit)] = random(256) as u8;
            }
            if round % 3 == 0 {
                bytes.truncate(random(whole.len()).max(1));
            }
            std::fs::write(&path, &bytes).unwrap();
            if let Ok(mut camera) = VideoFile::open(&path, VideoOptions::default()) {
                opened += 1;
                read_all(&mut camera);
            }
            for rate_hz in [None, Some(8000)] {
                if let Ok(mut array) = AudioFile::open(
                    &path,
                    AudioOptions {
                        rate_hz,
                        ..AudioOptions::default()
                    },
                ) {
                    opened += 1;
                    let (mut block, mut faults) = Default::default();
                    while array.read(&mut block, &mut faults) == Delivery::Data {
                        assert!(block.channels.iter().flatten().all(|sample| sample.is_finite()));
                    }
                }
            }
        }
    }
    println!("{opened} damaged streams opened in {:?}", begun.elapsed());
    assert!(opened > 100 && begun.elapsed().as_secs() < 40);
}
