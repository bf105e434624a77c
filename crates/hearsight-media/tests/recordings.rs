//! The real recordings of AV16.3, whole, cut short and damaged.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its input fails")]

mod common;

use common::{count, hear_all, read_all, recordings};
use hearsight_core::source::{AudioSource, Delivery, VideoSource};
use hearsight_core::{FaultKind, Instant, Moment, Span};
use hearsight_media::{
    AudioFile, AudioOptions, Camera, Microphones, MomentOptions, MomentReader, SourceClock, VideoFile,
    VideoOptions,
};

const CAMERAS: [(&str, u64, f64); 3] = [
    ("seq30-2p-1101_cam1_divx_audio.avi", 551, 11.08),
    ("seq30-2p-1101_cam2_divx_audio.avi", 530, 12.32),
    ("seq30-2p-1101_cam3_divx_audio.avi", 533, 13.12),
];

fn starting_at(seconds: f64) -> VideoOptions {
    VideoOptions {
        clock: SourceClock::at(Instant::from_seconds(seconds)),
        ..VideoOptions::default()
    }
}

#[test]
fn every_frame_comes_at_its_time() {
    let Some(folder) = recordings() else { return };
    for (name, expected, start) in CAMERAS {
        let mut camera = VideoFile::open(folder.join(name), starting_at(start)).unwrap();
        let format = camera.format().clone();
        assert_eq!(
            (format.width, format.height, format.frames),
            (360, 288, Some(expected))
        );
        assert_eq!(format.interval, Span::from_nanoseconds(40_000_000));
        assert_eq!(format.start, Instant::from_seconds(start));
        let begun = std::time::Instant::now();
        let (frames, faults) = read_all(&mut camera);
        println!(
            "{name}: {:.0} frames/s",
            expected as f64 / begun.elapsed().as_secs_f64()
        );
        assert_eq!(faults, []);
        assert_eq!(frames.len() as u64, expected);
        for (index, (number, time)) in frames.iter().enumerate() {
            assert_eq!(*number, index as u64 + 1);
            assert_eq!(*time, format.start.nanoseconds() + index as i64 * 40_000_000);
        }
        assert_eq!(camera.counts().frames, expected);
    }
}

#[test]
fn threads_change_nothing() {
    let Some(folder) = recordings() else { return };
    let pixels = |threads| {
        let mut options = VideoOptions::default();
        options.input.threads = threads;
        let mut camera = VideoFile::open(folder.join(CAMERAS[1].0), options).unwrap();
        let (mut frame, mut faults) = Default::default();
        let mut sum = 0_u64;
        while camera.read(&mut frame, &mut faults) == Delivery::Data {
            let bytes = frame.rgb.iter().chain(&frame.luma);
            sum = bytes.fold(sum.rotate_left(7), |sum, byte| {
                sum.wrapping_mul(31).wrapping_add(u64::from(*byte))
            });
        }
        sum
    };
    assert_eq!(pixels(1), pixels(3));
}

#[test]
fn a_file_cut_short_gives_what_is_there_and_says_so() {
    let Some(folder) = recordings() else { return };
    let bytes = std::fs::read(folder.join(CAMERAS[0].0)).unwrap();
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("cut.avi");
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let (frames, faults) = read_all(&mut VideoFile::open(&path, VideoOptions::default()).unwrap());
    assert!((200..350).contains(&frames.len()), "{}", frames.len());
    assert!(
        frames
            .iter()
            .enumerate()
            .all(|(index, (number, _))| *number == index as u64 + 1)
    );
    assert_eq!(count(&faults, FaultKind::EndedEarly), 1, "{faults:?}");
    assert!(
        faults.iter().any(|fault| fault.detail.contains("551")),
        "{faults:?}"
    );
    let (sound, faults) = hear_all(&mut AudioFile::open(&path, AudioOptions::default()).unwrap());
    assert!((100_000..250_000).contains(&sound[0].len()));
    assert_eq!(count(&faults, FaultKind::EndedEarly), 1, "{faults:?}");
}

#[test]
fn damaged_bytes_cost_frames_but_not_the_times_of_the_others() {
    let Some(folder) = recordings() else { return };
    let mut bytes = std::fs::read(folder.join(CAMERAS[0].0)).unwrap();
    let mut state = 7_u64;
    for _ in 0..400 {
        // A linear congruential generator (Knuth, MMIX): the same damage in every run.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let at = 20_000 + (state >> 20) as usize % (bytes.len() - 20_000);
        bytes[at] ^= 1 << (state >> 61);
    }
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("damaged.avi");
    std::fs::write(&path, bytes).unwrap();
    let mut camera = VideoFile::open(&path, starting_at(11.08)).unwrap();
    let (frames, faults) = read_all(&mut camera);
    println!("{} frames, {:?}", frames.len(), camera.counts());
    assert!((200..551).contains(&frames.len()), "{}", frames.len());
    assert!(count(&faults, FaultKind::Corrupt) > 0, "{faults:?}");
    for (number, time) in frames {
        assert_eq!(time, 11_080_000_000 + (number as i64 - 1) * 40_000_000);
    }
    for fault in faults {
        assert!((11.0..34.0).contains(&fault.time_s), "{fault:?}");
    }
}

#[test]
fn three_cameras_and_two_arrays_meet_on_one_clock() {
    let Some(folder) = recordings() else { return };
    let cameras = CAMERAS.map(|(name, _, start)| Camera {
        name: name.to_owned(),
        source: Box::new(VideoFile::open(folder.join(name), starting_at(start)).unwrap()),
    });
    let arrays = ["array1.wav", "line3.wav"].map(|name| {
        let clock = SourceClock::at(Instant::from_seconds(11.0));
        let options = AudioOptions {
            clock,
            ..AudioOptions::default()
        };
        let source = AudioFile::open(folder.join("arrays").join(name), options).unwrap();
        Microphones {
            name: name.to_owned(),
            source: Box::new(source),
        }
    });
    let total = |name: &str| {
        let source = AudioFile::open(folder.join("arrays").join(name), AudioOptions::default()).unwrap();
        source.format().samples.unwrap()
    };
    let totals = [total("array1.wav"), total("line3.wav")];
    let mut reader = MomentReader::new(cameras.into(), arrays.into(), MomentOptions::default()).unwrap();
    let mut moment = Moment::default();
    let (mut frames, mut samples) = ([0_u64; 3], [0_u64; 2]);
    let mut tick = 0;
    while reader.read(&mut moment) == Delivery::Data {
        assert_eq!(moment.tick, tick);
        assert_eq!(
            moment.time,
            Instant::from_nanoseconds(11_000_000_000 + tick as i64 * 40_000_000)
        );
        assert_eq!(moment.faults, []);
        for (index, video) in moment.video.iter().enumerate() {
            let Some(frame) = video.get() else { continue };
            frames[index] += 1;
            assert_eq!(frame.number, frames[index]);
            assert_eq!(frame.time, moment.time);
        }
        for (index, audio) in moment.audio.iter().enumerate() {
            let Some(block) = audio.get() else { continue };
            let expected = Instant::from_seconds(11.0) + Span::of_samples(samples[index] as i64, 16_000);
            assert_eq!(block.time, expected);
            assert!(block.end() <= moment.time);
            samples[index] += block.len() as u64;
        }
        tick += 1;
    }
    assert_eq!(frames, CAMERAS.map(|(_, count, _)| count));
    assert_eq!(samples, totals);
    assert_eq!(reader.superseded().sum::<u64>(), 0);
}

#[test]
fn a_run_may_be_limited_in_time() {
    let Some(folder) = recordings() else { return };
    let source = VideoFile::open(folder.join(CAMERAS[0].0), starting_at(11.08)).unwrap();
    let camera = Camera {
        name: "one".to_owned(),
        source: Box::new(source),
    };
    let clock = SourceClock::at(Instant::from_seconds(11.08));
    let source = AudioFile::open(
        folder.join(CAMERAS[0].0),
        AudioOptions {
            clock,
            ..AudioOptions::default()
        },
    )
    .unwrap();
    let array = Microphones {
        name: "its sound".to_owned(),
        source: Box::new(source),
    };
    let options = MomentOptions {
        from: Some(Instant::from_seconds(13.01)),
        until: Some(Instant::from_seconds(14.0)),
        ..MomentOptions::default()
    };
    let mut reader = MomentReader::new(vec![camera], vec![array], options).unwrap();
    let mut moment = Moment::default();
    let (mut numbers, mut samples) = (Vec::new(), 0);
    let mut first = None;
    while reader.read(&mut moment) == Delivery::Data {
        first.get_or_insert((moment.tick, moment.time));
        numbers.extend(moment.video[0].get().map(|frame| frame.number));
        samples += moment.audio[0].get().map_or(0, |block| block.len());
    }
    assert_eq!(first, Some((0, Instant::from_seconds(13.04))));
    assert_eq!(numbers, (50..=73).collect::<Vec<_>>());
    assert_eq!(samples, (0.99 * 16_000.0) as usize);
}
