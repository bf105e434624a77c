//! Moments from made-up sources: jitter, gaps, different rates and starts, and no allocation in a steady run.

use hearsight_core::source::{AudioFormat, AudioSource, Delivery, VideoFormat, VideoSource};
use hearsight_core::{AudioBlock, Fault, FaultKind, Instant, Moment, Span, VideoFrame};
use hearsight_media::{Camera, Microphones, MomentOptions, MomentReader};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: everything is passed on to the system's allocator; counting touches only a thread-local number.
#[expect(unsafe_code, reason = "only an allocator can count allocations")]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // A thread that is ending has no counter any more.
        let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promises are passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Frames at given milliseconds, the numbers of which follow from an interval.
struct Frames {
    format: VideoFormat,
    times: Vec<(u64, Span)>,
    at: usize,
}

impl Frames {
    fn boxed(interval_us: i64, times_us: impl IntoIterator<Item = (u64, i64)>) -> Box<dyn VideoSource> {
        let span = |us: i64| Span::from_nanoseconds(us * 1000);
        let times: Vec<(u64, Span)> = times_us
            .into_iter()
            .map(|(number, us)| (number, span(us)))
            .collect();
        let format = VideoFormat {
            width: 4,
            height: 2,
            interval: span(interval_us),
            frames: None,
            start: Instant::ZERO + times.first().map_or(Span::ZERO, |first| first.1),
            live: false,
        };
        Box::new(Self { format, times, at: 0 })
    }
}

impl VideoSource for Frames {
    fn format(&self) -> &VideoFormat {
        &self.format
    }

    fn read(&mut self, frame: &mut VideoFrame, faults: &mut Vec<Fault>) -> Delivery {
        let Some((number, time)) = self.times.get(self.at) else {
            return Delivery::End;
        };
        self.at += 1;
        if *number == 13 {
            let (sensor, detail) = ("nobody".to_owned(), "unlucky".to_owned());
            faults.push(Fault {
                sensor,
                time_s: time.seconds(),
                kind: FaultKind::Corrupt,
                detail,
            });
        }
        (frame.number, frame.time) = (*number, Instant::ZERO + *time);
        (frame.width, frame.height) = (4, 2);
        frame.rgb.resize(24, 0);
        frame.luma.resize(8, 0);
        Delivery::Data
    }
}

/// Samples that count up, in blocks of uneven length.
struct Samples {
    format: AudioFormat,
    at: u64,
}

impl Samples {
    fn boxed(rate_hz: u32, start_s: f64, samples: u64) -> Box<dyn AudioSource> {
        let start = Instant::from_seconds(start_s);
        let format = AudioFormat {
            rate_hz,
            channels: 2,
            samples: Some(samples),
            start,
            live: false,
        };
        Box::new(Self { format, at: 0 })
    }
}

impl AudioSource for Samples {
    fn format(&self) -> &AudioFormat {
        &self.format
    }

    fn read(&mut self, block: &mut AudioBlock, _: &mut Vec<Fault>) -> Delivery {
        let left = self.format.samples.unwrap_or(0) - self.at;
        let count = (1 + self.at * 7 % 900).min(left);
        if count == 0 {
            return Delivery::End;
        }
        block.channels.resize_with(2, Vec::new);
        block.clear();
        for channel in &mut block.channels {
            channel.extend((self.at..self.at + count).map(|sample| sample as f32));
        }
        block.rate_hz = self.format.rate_hz;
        block.time = self.format.start + Span::of_samples(self.at as i64, block.rate_hz);
        self.at += count;
        Delivery::Data
    }
}

fn camera(name: &str, source: Box<dyn VideoSource>) -> Camera {
    Camera {
        name: name.to_owned(),
        source,
    }
}

fn reader(cameras: Vec<Camera>, arrays: Vec<Box<dyn AudioSource>>, options: MomentOptions) -> MomentReader {
    let name = |source| Microphones {
        name: "array".to_owned(),
        source,
    };
    match MomentReader::new(cameras, arrays.into_iter().map(name).collect(), options) {
        Ok(reader) => reader,
        Err(error) => unreachable!("{error}"),
    }
}

/// For each moment its time in milliseconds, the frame numbers of its cameras and its number of samples.
fn all(mut reader: MomentReader) -> Vec<(i64, Vec<Option<u64>>, usize)> {
    let (mut moment, mut rows) = (Moment::default(), Vec::new());
    let mut heard = 0;
    while reader.read(&mut moment) == Delivery::Data {
        let numbers = moment
            .video
            .iter()
            .map(|video| video.get().map(|frame| frame.number))
            .collect();
        let mut count = 0;
        for block in moment.audio.iter().filter_map(|audio| audio.get()) {
            for sample in &block.channels[1] {
                assert_eq!(*sample, heard as f32);
                heard += 1;
            }
            count += block.len();
            assert!(block.end() <= moment.time + Span::from_nanoseconds(1));
        }
        assert!(
            moment
                .video
                .iter()
                .filter_map(|video| video.get())
                .all(|frame| frame.time <= moment.time)
        );
        rows.push((moment.time.nanoseconds() / 1_000_000, numbers, count));
    }
    rows
}

#[test]
fn times_rounded_to_milliseconds_cost_no_frame() {
    // Thirty frames a second as Matroska stores them, and a second camera out of phase.
    let frames = |phase: i64| {
        let milliseconds = move |n: i64| (n * 100_000 / 3 + 500) / 1000 * 1000 + phase;
        Frames::boxed(33_333, (0..900).map(move |n| (n as u64 + 1, milliseconds(n))))
    };
    let (one, two) = (frames(0), frames(17_000));
    let rows = all(reader(
        vec![camera("one", one), camera("two", two)],
        Vec::new(),
        MomentOptions::default(),
    ));
    assert_eq!(rows.len(), 901);
    for (index, (_, numbers, _)) in rows.iter().enumerate() {
        let index = index as u64;
        assert_eq!(numbers[0], (index < 900).then_some(index + 1));
        assert_eq!(numbers[1], (index > 0).then_some(index));
    }
}

#[test]
fn sources_start_late_end_early_and_miss_frames() {
    let steady = Frames::boxed(40_000, (0..20).map(|n| (n as u64 + 1, n * 40_000)));
    let gappy = Frames::boxed(40_000, [(1, 80_000), (2, 120_000), (6, 280_000), (7, 320_000)]);
    let slow = Frames::boxed(100_000, (0..4).map(|n| (n as u64 + 1, n * 100_000)));
    let cameras = vec![
        camera("steady", steady),
        camera("gappy", gappy),
        camera("slow", slow),
    ];
    let rows = all(reader(
        cameras,
        vec![Samples::boxed(16_000, 0.1, 4000)],
        MomentOptions::default(),
    ));
    assert_eq!(rows.len(), 20);
    let column = |index: usize| -> Vec<(i64, u64)> {
        rows.iter()
            .filter_map(|(time, numbers, _)| Some((*time, numbers[index]?)))
            .collect()
    };
    assert_eq!(column(1), [(80, 1), (120, 2), (280, 6), (320, 7)]);
    assert_eq!(column(2), [(0, 1), (120, 2), (200, 3), (320, 4)]);
    let samples: Vec<(i64, usize)> = rows
        .iter()
        .filter(|row| row.2 > 0)
        .map(|(time, _, count)| (*time, *count))
        .collect();
    assert_eq!(samples[..3], [(120, 320), (160, 640), (200, 640)]);
    assert_eq!(samples.iter().map(|(_, count)| count).sum::<usize>(), 4000);
}

#[test]
fn sound_alone_is_cut_into_ticks() {
    let rows = all(reader(
        Vec::new(),
        vec![Samples::boxed(44_100, 5.0, 44_100)],
        MomentOptions::default(),
    ));
    assert_eq!(rows.len(), 25);
    assert!(rows.iter().all(|(_, _, count)| *count == 1764));
    assert_eq!((rows[0].0, rows[24].0), (5040, 6000));
}

#[test]
fn a_longer_tick_gives_the_newest_frame() {
    let frames = Frames::boxed(40_000, (0..50).map(|n| (n as u64 + 1, n * 40_000)));
    let options = MomentOptions {
        tick: Some(Span::from_seconds(0.2)),
        ..MomentOptions::default()
    };
    let mut reader = reader(
        vec![camera("one", frames)],
        vec![Samples::boxed(8000, 0.0, 8000)],
        options,
    );
    let (mut moment, mut numbers) = (Moment::default(), Vec::new());
    while reader.read(&mut moment) == Delivery::Data {
        numbers.extend(moment.video[0].get().map(|frame| frame.number));
    }
    assert_eq!(reader.superseded().sum::<u64>(), 50 - numbers.len() as u64);
    assert_eq!(numbers.len(), 11);
    assert!(
        numbers
            .windows(2)
            .skip(1)
            .take(8)
            .all(|pair| pair[1] == pair[0] + 5),
        "{numbers:?}"
    );
}

#[test]
fn faults_carry_the_name_in_the_room() {
    let frames = Frames::boxed(40_000, (0..20).map(|n| (n as u64 + 1, n * 40_000)));
    let mut reader = reader(vec![camera("door", frames)], Vec::new(), MomentOptions::default());
    let mut moment = Moment::default();
    let mut faults = Vec::new();
    while reader.read(&mut moment) == Delivery::Data {
        faults.extend(moment.faults.drain(..).map(|fault| (moment.tick, fault.sensor)));
    }
    assert_eq!(faults.len(), 1);
    assert_eq!(faults[0].1, "door");
}

#[test]
fn a_steady_run_allocates_nothing() {
    let frames = |phase: i64| Frames::boxed(40_000, (20..1000).map(move |n| (n as u64, phase + n * 40_000)));
    let cameras = vec![camera("one", frames(0)), camera("two", frames(7000))];
    let arrays = vec![
        Samples::boxed(16_000, 0.8, 600_000),
        Samples::boxed(48_000, 0.8, 1_800_000),
    ];
    let mut reader = reader(cameras, arrays, MomentOptions::default());
    let mut moment = Moment::default();
    for _ in 0..60 {
        assert_eq!(reader.read(&mut moment), Delivery::Data);
    }
    let before = ALLOCATIONS.with(Cell::get);
    for _ in 0..800 {
        assert_eq!(reader.read(&mut moment), Delivery::Data);
    }
    assert_eq!(ALLOCATIONS.with(Cell::get), before);
}
