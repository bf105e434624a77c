//! Image sequences: names, numbers, gaps, damage.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its input fails")]

mod common;

use common::{count, read_all};
use hearsight_core::source::{Delivery, VideoSource};
use hearsight_core::{FaultKind, Instant, VideoFrame};
use hearsight_media::{ImageOptions, ImageSequence, SourceClock};
use std::path::Path;

fn save(folder: &Path, name: &str, level: u8) {
    image::RgbImage::from_pixel(8, 6, image::Rgb([level, level, level]))
        .save(folder.join(name))
        .unwrap();
}

#[test]
fn pictures_come_in_order_at_the_declared_rate() {
    let place = tempfile::tempdir().unwrap();
    for index in (1..=12).rev() {
        save(place.path(), &format!("frame_{index:03}.png"), index * 10);
    }
    std::fs::write(place.path().join("notes.txt"), "no picture").unwrap();
    let clock = SourceClock::at(Instant::from_seconds(7.0));
    for pattern in ["", "frame_*.png", "frame_%03d.png", "frame_???.png"] {
        let options = ImageOptions {
            clock,
            ..ImageOptions::default()
        };
        let mut source = ImageSequence::open(place.path().join(pattern), options).unwrap();
        assert_eq!(source.format().frames, Some(12));
        let (mut frame, mut faults) = (VideoFrame::default(), Vec::new());
        for index in 0..12_u8 {
            assert_eq!(source.read(&mut frame, &mut faults), Delivery::Data, "{pattern}");
            assert_eq!(frame.number, u64::from(index) + 1);
            assert_eq!(
                frame.time.nanoseconds(),
                7_000_000_000 + i64::from(index) * 40_000_000
            );
            assert!(
                frame
                    .luma
                    .iter()
                    .chain(&frame.rgb)
                    .all(|value| *value == (index + 1) * 10)
            );
        }
        assert_eq!(source.read(&mut frame, &mut faults), Delivery::End);
        assert_eq!(faults, []);
    }
}

#[test]
fn missing_and_damaged_pictures_keep_their_places() {
    let place = tempfile::tempdir().unwrap();
    for index in [3, 4, 7, 8, 9] {
        save(place.path(), &format!("{index}.png"), 100);
    }
    std::fs::write(place.path().join("8.png"), b"\x89PNG\r\n\x1a\nnothing").unwrap();
    image::RgbImage::new(5, 5)
        .save(place.path().join("9.png"))
        .unwrap();
    save(place.path(), "10.png", 100);
    let mut source = ImageSequence::open(place.path().join("%d.png"), ImageOptions::default()).unwrap();
    let (frames, faults) = read_all(&mut source);
    let expected: Vec<(u64, i64)> = [1, 2, 5, 8]
        .map(|number| (number, (number as i64 - 1) * 40_000_000))
        .into();
    assert_eq!(frames, expected);
    assert_eq!(
        (count(&faults, FaultKind::Gap), count(&faults, FaultKind::Corrupt)),
        (1, 2),
        "{faults:?}"
    );
}
