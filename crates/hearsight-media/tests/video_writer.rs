//! Video is read back as it was written, survives an interruption, and plays in Chromium.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its input fails")]

mod common;

use common::read_all;
use hearsight_core::source::{Delivery, VideoSource};
use hearsight_core::{Instant, Rectangle, RgbView, Span, VideoFrame};
use hearsight_media::{
    Canvas, EncodeError, Encoder, VideoFile, VideoOptions, VideoWriter, VideoWriterOptions,
    available_encoders, identity_color,
};
use std::path::Path;
use std::process::Command;

const WIDTH: usize = 360;
const HEIGHT: usize = 288;

fn picture(index: usize, rgb: &mut Vec<u8>) {
    rgb.clear();
    rgb.extend((0..WIDTH * HEIGHT).flat_map(|at| [(at % WIDTH / 2) as u8, (at / WIDTH / 2) as u8, 60]));
    let mut canvas = Canvas::new(WIDTH, HEIGHT, rgb).unwrap();
    let place = Rectangle::new(20.0 + 2.0 * index as f32, 80.0, 60.0, 90.0);
    canvas.outline(&place, 3.0, identity_color(1));
    canvas.ellipse(place.centre(), (30.0, 45.0), 0.3, 2.0, identity_color(2));
    canvas.label(
        place.left,
        place.top - 12.0,
        1,
        [255; 3],
        identity_color(1),
        &format!("person {index}"),
    );
    let curve: Vec<f32> = (0..120)
        .map(|lag| (-(lag as f32 - 60.0 - index as f32 % 20.0).powi(2) / 50.0).exp())
        .collect();
    canvas.strip(
        &Rectangle::new(0.0, 248.0, 360.0, 40.0),
        &curve,
        (0.0, 1.0),
        [255, 255, 0],
    );
}

fn write(path: &Path, frames: usize, options: &VideoWriterOptions) -> VideoWriter {
    let mut writer = VideoWriter::create(path, WIDTH, HEIGHT, options).unwrap();
    let mut rgb = Vec::new();
    let mut spent = std::time::Duration::ZERO;
    for index in 0..frames {
        picture(index, &mut rgb);
        let begun = std::time::Instant::now();
        let time = Instant::from_seconds(11.08) + Span::from_nanoseconds(40_000_000) * index as i64;
        writer
            .write(time, RgbView::new(WIDTH, HEIGHT, &rgb).unwrap())
            .unwrap();
        spent += begun.elapsed();
    }
    println!(
        "{:?}: {:.0} overlay frames/s",
        options.encoder,
        frames as f64 / spent.as_secs_f64()
    );
    writer
}

#[test]
fn what_is_written_is_read_back() {
    let place = tempfile::tempdir().unwrap();
    for (encoder, name) in [
        (Encoder::Automatic, "libvpx-vp9"),
        (Encoder::Av1, "libsvtav1"),
        (Encoder::H264, "libx264"),
    ] {
        if !available_encoders().contains(&name) {
            println!("skipped: the encoder {name} is not installed");
            continue;
        }
        let path = place.path().join(format!("{name}.mp4"));
        write(
            &path,
            75,
            &VideoWriterOptions {
                encoder,
                ..VideoWriterOptions::default()
            },
        )
        .finish()
        .unwrap();
        let mut video = VideoFile::open(&path, VideoOptions::default()).unwrap();
        assert_eq!(
            video.format().interval,
            Span::from_nanoseconds(40_000_000),
            "{name}"
        );
        let (mut frame, mut faults) = (VideoFrame::default(), Vec::new());
        let mut rgb = Vec::new();
        for index in 0..75 {
            assert_eq!(
                video.read(&mut frame, &mut faults),
                Delivery::Data,
                "{name} {index}"
            );
            assert_eq!(frame.time.nanoseconds(), index as i64 * 40_000_000, "{name}");
            assert_eq!((frame.width, frame.height), (WIDTH, HEIGHT));
            picture(index, &mut rgb);
            let error: u64 = frame
                .rgb
                .iter()
                .zip(&rgb)
                .map(|(a, b)| u64::from(a.abs_diff(*b)))
                .sum();
            assert!(
                error < 10 * rgb.len() as u64,
                "{name} {index}: {}",
                error as f64 / rgb.len() as f64
            );
        }
        assert_eq!(video.read(&mut frame, &mut faults), Delivery::End, "{name}");
        assert_eq!(faults, [], "{name}");
    }
}

#[test]
fn lossless_video_keeps_every_bit_and_every_time() {
    let place = tempfile::tempdir().unwrap();
    for (width, height, rate) in [(64, 48, 15_i64), (35, 17, 30)] {
        let path = place.path().join(format!("{width}.mov"));
        let interval = Span::from_seconds(1.0 / rate as f64);
        let options = VideoWriterOptions {
            encoder: Encoder::Lossless,
            interval,
            ..VideoWriterOptions::default()
        };
        let mut writer = VideoWriter::create(&path, width, height, &options).unwrap();
        let noise = |seed: usize, length: usize| -> Vec<u8> {
            (0..length)
                .map(|at| ((at * 7919 + seed * 104_729) % 251) as u8)
                .collect()
        };
        let chroma = width.div_ceil(2) * height.div_ceil(2);
        let mut wanted = Vec::new();
        for index in 0..40_usize {
            let planes = [width * height, chroma, chroma].map(|length| noise(index + length, length));
            let time = Instant::ZERO + Span::of_samples(index as i64, rate as u32);
            writer
                .write_planes(time, [&planes[0], &planes[1], &planes[2]])
                .unwrap();
            // BT.601-7, limited range: from code to full-range luma.
            let luma = |code: u8| {
                ((f64::from(code) - 16.0) * 255.0 / 219.0)
                    .round()
                    .clamp(0.0, 255.0) as u8
            };
            wanted.push((time, planes[0].iter().map(|code| luma(*code)).collect::<Vec<_>>()));
        }
        writer.finish().unwrap();
        let mut video = VideoFile::open(&path, VideoOptions::default()).unwrap();
        assert_eq!(video.format().interval, Span::of_samples(1, rate as u32));
        let (mut frame, mut faults) = (VideoFrame::default(), Vec::new());
        for (index, (time, luma)) in wanted.iter().enumerate() {
            assert_eq!(video.read(&mut frame, &mut faults), Delivery::Data, "{index}");
            assert_eq!(frame.time, *time, "{index}");
            assert!(frame.luma == *luma, "{index}");
        }
        assert_eq!(video.read(&mut frame, &mut faults), Delivery::End);
        assert_eq!(faults, []);
    }
}

#[test]
fn uneven_times_and_odd_sizes_are_kept() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("odd.mp4");
    let mut writer = VideoWriter::create(&path, 35, 17, &VideoWriterOptions::default()).unwrap();
    let times = [0, 40, 80, 200, 233, 1000];
    let rgb = vec![90; 35 * 17 * 3];
    for time in times {
        writer
            .write(
                Instant::from_nanoseconds(time * 1_000_000),
                RgbView::new(35, 17, &rgb).unwrap(),
            )
            .unwrap();
    }
    let repeated = writer.write(
        Instant::from_nanoseconds(1_000_000_000),
        RgbView::new(35, 17, &rgb).unwrap(),
    );
    assert!(matches!(repeated, Err(EncodeError::NotLater { .. })));
    let wrong = writer.write(Instant::from_seconds(2.0), RgbView::new(17, 35, &rgb).unwrap());
    assert!(matches!(wrong, Err(EncodeError::WrongSize { .. })));
    drop(writer);
    let options = VideoOptions {
        interval: Some(Span::from_nanoseconds(40_000_000)),
        ..VideoOptions::default()
    };
    let (frames, _) = read_all(&mut VideoFile::open(&path, options).unwrap());
    assert_eq!(
        frames
            .iter()
            .map(|(_, time)| time / 1_000_000)
            .collect::<Vec<_>>(),
        times
    );
}

#[test]
fn an_interrupted_file_still_plays() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("interrupted.mp4");
    let writer = write(&path, 120, &VideoWriterOptions::default());
    let copy = place.path().join("copy.mp4");
    std::fs::copy(&path, &copy).unwrap();
    drop(writer);
    let (frames, _) = read_all(&mut VideoFile::open(&copy, VideoOptions::default()).unwrap());
    assert!(frames.len() >= 90, "{}", frames.len());
    let (frames, faults) = read_all(&mut VideoFile::open(&path, VideoOptions::default()).unwrap());
    assert_eq!((frames.len(), faults.len()), (120, 0));
}

#[test]
fn what_cannot_be_written_is_said() {
    let options = VideoWriterOptions::default();
    let error = VideoWriter::create("/nowhere/at/all.mp4", 64, 48, &options)
        .err()
        .unwrap();
    assert!(matches!(error, EncodeError::Unwritable { .. }), "{error}");
    let named = VideoWriterOptions {
        encoder: Encoder::Named("none".to_owned()),
        ..options.clone()
    };
    let error = VideoWriter::create("/tmp/x.mp4", 64, 48, &named).err().unwrap();
    assert!(
        matches!(&error, EncodeError::NoEncoder { available, .. } if available.contains("vp9")),
        "{error}"
    );
    let error = VideoWriter::create("/tmp/x.mp4", 0, 48, &options).err().unwrap();
    assert!(matches!(error, EncodeError::Refused { .. }), "{error}");
}

#[test]
fn chromium_plays_it() {
    let browser = Path::new("/usr/bin/chromium");
    if !browser.exists() {
        println!("skipped: {} is not installed", browser.display());
        return;
    }
    let place = tempfile::tempdir().unwrap();
    write(
        &place.path().join("overlay.mp4"),
        75,
        &VideoWriterOptions::default(),
    )
    .finish()
    .unwrap();
    let page = r#"<body><pre id="out"></pre><video id="video" muted></video><script>
        const video = document.getElementById("video"), out = document.getElementById("out");
        let ready = false;
        const show = () => out.textContent = `ready=${ready} duration=${video.duration} width=${video.videoWidth} `
            + `moved=${video.currentTime > 0.2} error=${video.error ? video.error.message : "none"};`;
        video.oncanplay = () => { ready = true; video.play(); show(); };
        video.onerror = video.ontimeupdate = show;
        video.src = "overlay.mp4";
        </script>"#;
    let path = place.path().join("page.html");
    std::fs::write(&path, page).unwrap();
    let expected = "ready=true duration=3 width=360 moved=true error=none";
    // The page's time does not wait for the decoder: on a busy machine it is given more of it.
    let mut page = String::new();
    for budget_ms in [5_000, 20_000, 80_000, 320_000] {
        let output = Command::new(browser)
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-quic",
                "--no-first-run",
            ])
            .args([
                "--disable-background-networking",
                "--disable-component-update",
                "--disable-sync",
            ])
            .args(["--autoplay-policy=no-user-gesture-required", "--dump-dom"])
            .arg(format!("--virtual-time-budget={budget_ms}"))
            .arg(format!(
                "--user-data-dir={}",
                place.path().join("profile").display()
            ))
            .arg(format!("file://{}", path.display()))
            .output()
            .unwrap();
        page = String::from_utf8_lossy(&output.stdout).into_owned();
        if page.contains(expected) {
            break;
        }
    }
    let found = page
        .split("<pre id=\"out\">")
        .nth(1)
        .and_then(|rest| rest.split(';').next())
        .unwrap_or("");
    assert_eq!(found, expected, "{page}");
}
