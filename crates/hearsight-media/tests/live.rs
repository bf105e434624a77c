//! Live sources: recordings paced as if live, slow listeners, late data, and streams over loopback.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its input fails")]

mod common;

use common::{count, generate, hear_all, read_all};
use hearsight_core::source::{AudioSource, Delivery, VideoSource};
use hearsight_core::{AudioBlock, FaultKind, Instant, Moment, Span, VideoFrame};
use hearsight_media::{
    AudioFile, AudioOptions, Camera, LiveAudio, LiveVideo, Microphones, MomentOptions, MomentReader, Pace,
    QueueOptions, RunClock, VideoFile, VideoOptions,
};
use std::path::Path;
use std::time::Duration;

fn queue(clock: RunClock, capacity: usize) -> QueueOptions {
    QueueOptions {
        name: "live".to_owned(),
        capacity,
        pace: Pace::By(clock),
    }
}

fn camera(path: &Path, options: &QueueOptions) -> LiveVideo {
    let source = VideoFile::open(path, VideoOptions::default()).unwrap();
    LiveVideo::spawn(Box::new(source), options).unwrap()
}

fn array(path: &Path, options: &QueueOptions) -> LiveAudio {
    let source = AudioFile::open(path, AudioOptions::default()).unwrap();
    LiveAudio::spawn(Box::new(source), options).unwrap()
}

#[test]
fn a_paced_recording_keeps_its_times() {
    let place = tempfile::tempdir().unwrap();
    let Some(path) = generate(
        place.path(),
        "film.avi",
        2,
        &["-c:v", "mpeg4", "-c:a", "pcm_s16le"],
    ) else {
        return;
    };
    let clock = RunClock::starting_at(Instant::ZERO).with_speed(2.0);
    let mut camera = camera(&path, &queue(clock, 8));
    assert!(camera.format().live);
    let (mut frame, mut faults) = (VideoFrame::default(), Vec::new());
    let mut frames = 0;
    loop {
        match camera.read(&mut frame, &mut faults) {
            Delivery::Data => {
                frames += 1;
                assert!(clock.now() >= frame.time);
            }
            Delivery::Pending => std::thread::sleep(Duration::from_millis(1)),
            Delivery::End => break,
        }
    }
    assert!(clock.now() >= Instant::from_seconds(1.96));
    assert_eq!(frames + camera.dropped(), 50);
    assert_eq!(count(&faults, FaultKind::Dropped) > 0, camera.dropped() > 0);
}

#[test]
fn a_slow_listener_loses_the_oldest_and_is_told() {
    let place = tempfile::tempdir().unwrap();
    let Some(path) = generate(
        place.path(),
        "film.avi",
        2,
        &["-c:v", "mpeg4", "-c:a", "pcm_s16le"],
    ) else {
        return;
    };
    let clock = RunClock::starting_at(Instant::ZERO).with_speed(20.0);
    let (mut camera, mut array) = (camera(&path, &queue(clock, 3)), array(&path, &queue(clock, 3)));
    std::thread::sleep(Duration::from_millis(600));
    let (frames, faults) = read_all(&mut camera);
    assert_eq!(
        frames.iter().map(|(number, _)| *number).collect::<Vec<_>>(),
        [48, 49, 50]
    );
    assert_eq!(camera.dropped(), 47);
    assert!(
        faults[0].kind == FaultKind::Dropped && faults[0].detail.starts_with("47 "),
        "{faults:?}"
    );
    // The first blocks were dropped before any was given, so nothing has to be filled.
    let (heard, faults) = hear_all(&mut array);
    assert!(heard[0].len() < 32_000 && array.dropped() > 0);
    assert_eq!(count(&faults, FaultKind::Dropped), 1);
}

#[test]
fn dropped_samples_become_zeros() {
    let place = tempfile::tempdir().unwrap();
    let Some(path) = generate(
        place.path(),
        "film.avi",
        4,
        &["-c:v", "mpeg4", "-c:a", "pcm_s16le"],
    ) else {
        return;
    };
    let clock = RunClock::starting_at(Instant::ZERO).with_speed(10.0);
    let mut array = array(&path, &queue(clock, 2));
    let (mut block, mut faults) = (AudioBlock::default(), Vec::new());
    let mut next = None;
    let mut total = 0;
    loop {
        match array.read(&mut block, &mut faults) {
            Delivery::Data => {
                assert!((block.time - next.unwrap_or(block.time)).magnitude() <= Span::from_nanoseconds(2));
                next = Some(block.end());
                total += block.len();
                if total == block.len() {
                    std::thread::sleep(Duration::from_millis(150));
                }
            }
            Delivery::Pending => std::thread::sleep(Duration::from_millis(1)),
            Delivery::End => break,
        }
    }
    assert!(array.dropped() > 0);
    assert_eq!(total, 64_000, "{faults:?}");
}

#[test]
fn live_and_recorded_moments_are_the_same() {
    let place = tempfile::tempdir().unwrap();
    let Some(path) = generate(
        place.path(),
        "film.avi",
        2,
        &["-c:v", "mpeg4", "-c:a", "pcm_s16le"],
    ) else {
        return;
    };
    let video = || VideoFile::open(&path, VideoOptions::default()).unwrap();
    let audio = || AudioFile::open(&path, AudioOptions::default()).unwrap();
    let moments = |video: Box<dyn VideoSource>, audio: Box<dyn AudioSource>, clock| {
        let cameras = vec![Camera {
            name: "camera".to_owned(),
            source: video,
        }];
        let arrays = vec![Microphones {
            name: "array".to_owned(),
            source: audio,
        }];
        let options = MomentOptions {
            clock,
            patience: Span::from_seconds(20.0),
            ..MomentOptions::default()
        };
        let mut reader = MomentReader::new(cameras, arrays, options).unwrap();
        let (mut moment, mut all) = (Moment::default(), Vec::new());
        while reader.wait(&mut moment) == Delivery::Data {
            let number = moment.video[0].get().map(|frame| frame.number);
            let samples = moment.audio[0]
                .get()
                .map(|block| (block.time, block.channels.clone()));
            all.push((moment.tick, moment.time, number, samples, moment.faults.len()));
        }
        all
    };
    let recorded = moments(Box::new(video()), Box::new(audio()), None);
    assert_eq!(recorded.iter().filter(|moment| moment.2.is_some()).count(), 50);
    let clock = RunClock::starting_at(Instant::ZERO).with_speed(4.0);
    let options = queue(clock, 200);
    let live = moments(
        Box::new(LiveVideo::spawn(Box::new(video()), &options).unwrap()),
        Box::new(LiveAudio::spawn(Box::new(audio()), &options).unwrap()),
        Some(clock),
    );
    assert_eq!(live, recorded);
}

/// A camera that has nothing until the clock reads a certain time.
struct Late {
    inner: VideoFile,
    clock: RunClock,
    silent_until: Instant,
}

impl VideoSource for Late {
    fn format(&self) -> &hearsight_core::source::VideoFormat {
        self.inner.format()
    }

    fn read(&mut self, frame: &mut VideoFrame, faults: &mut Vec<hearsight_core::Fault>) -> Delivery {
        if self.clock.now() < self.silent_until {
            return Delivery::Pending;
        }
        self.inner.read(frame, faults)
    }
}

#[test]
fn a_camera_that_hangs_does_not_hold_up_the_others() {
    let place = tempfile::tempdir().unwrap();
    let Some(path) = generate(place.path(), "film.avi", 2, &["-an", "-c:v", "mpeg4"]) else {
        return;
    };
    let clock = RunClock::starting_at(Instant::ZERO).with_speed(4.0);
    let open = || VideoFile::open(&path, VideoOptions::default()).unwrap();
    let late = Late {
        inner: open(),
        clock,
        silent_until: Instant::from_seconds(1.5),
    };
    let cameras = vec![
        Camera {
            name: "steady".to_owned(),
            source: Box::new(LiveVideo::spawn(Box::new(open()), &queue(clock, 60)).unwrap()),
        },
        Camera {
            name: "late".to_owned(),
            source: Box::new(late),
        },
    ];
    let options = MomentOptions {
        clock: Some(clock),
        ..MomentOptions::default()
    };
    let mut reader = MomentReader::new(cameras, Vec::new(), options).unwrap();
    let (mut moment, mut seen, mut late) = (Moment::default(), [0, 0], 0);
    while reader.wait(&mut moment) == Delivery::Data {
        for (seen, video) in seen.iter_mut().zip(&moment.video) {
            *seen += u64::from(video.new);
        }
        late += moment
            .faults
            .iter()
            .filter(|fault| fault.sensor == "late")
            .count();
    }
    assert_eq!(seen[0], 50);
    assert!(late > 10 && seen[1] + late as u64 == 50, "{seen:?} {late}");
}
