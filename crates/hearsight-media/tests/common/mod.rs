//! What several tests need: generated media, the real recordings, and the `ffmpeg` program.
#![allow(dead_code, reason = "each test binary uses a part of these helpers")]
#![allow(
    clippy::allow_attributes,
    reason = "`expect` would fail in the binaries that use everything"
)]

use hearsight_core::source::{AudioSource, Delivery, VideoSource};
use hearsight_core::{AudioBlock, Fault, FaultKind, VideoFrame};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The real recordings, where they are; otherwise says why the test is skipped.
pub(crate) fn recordings() -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/av16.3-seq30");
    if path.is_dir() {
        return Some(path);
    }
    println!("skipped: the recordings of AV16.3 are not at {}", path.display());
    None
}

/// Runs `ffmpeg` with the given arguments; `false`, saying so, where the program is missing.
pub(crate) fn ffmpeg(arguments: &[&str]) -> bool {
    let mut command = Command::new("ffmpeg");
    command
        .args(["-nostdin", "-loglevel", "error", "-y"])
        .args(arguments);
    match command.stdin(Stdio::null()).status() {
        Ok(status) => {
            assert!(status.success(), "ffmpeg {arguments:?}");
            true
        }
        Err(error) => {
            println!("skipped: the program ffmpeg cannot be started ({error})");
            false
        }
    }
}

/// A generated recording of `seconds` s at 25 frames/s with sound; `None` where `ffmpeg` is missing.
pub(crate) fn generate(folder: &Path, name: &str, seconds: u32, codec: &[&str]) -> Option<PathBuf> {
    let path = folder.join(name);
    let video = format!("testsrc=size=160x120:rate=25:duration={seconds}");
    let audio = format!("sine=frequency=440:sample_rate=16000:duration={seconds}");
    let mut arguments = vec!["-f", "lavfi", "-i", &video, "-f", "lavfi", "-i", &audio];
    arguments.extend_from_slice(codec);
    let text = path.to_str().unwrap().to_owned();
    arguments.push(&text);
    ffmpeg(&arguments).then_some(path)
}

/// Everything that a camera delivers.
pub(crate) fn read_all(source: &mut dyn VideoSource) -> (Vec<(u64, i64)>, Vec<Fault>) {
    let (mut frame, mut faults, mut frames) = (VideoFrame::default(), Vec::new(), Vec::new());
    loop {
        match source.read(&mut frame, &mut faults) {
            Delivery::Data => {
                assert_eq!(frame.rgb.len(), frame.width * frame.height * 3);
                assert_eq!(frame.luma.len(), frame.width * frame.height);
                frames.push((frame.number, frame.time.nanoseconds()));
            }
            Delivery::Pending => std::thread::sleep(std::time::Duration::from_millis(1)),
            Delivery::End => return (frames, faults),
        }
    }
}

/// Everything that an array delivers, joined.
pub(crate) fn hear_all(source: &mut dyn AudioSource) -> (Vec<Vec<f32>>, Vec<Fault>) {
    let (mut block, mut faults) = (AudioBlock::default(), Vec::new());
    let mut channels = vec![Vec::new(); source.format().channels];
    let mut expected = None;
    loop {
        match source.read(&mut block, &mut faults) {
            Delivery::Data => {
                let time = *expected.get_or_insert(block.time);
                assert!(
                    (block.time - time).nanoseconds().abs() <= 1,
                    "{} {}",
                    block.time.seconds(),
                    time.seconds()
                );
                expected = Some(block.end());
                for (all, new) in channels.iter_mut().zip(&block.channels) {
                    all.extend_from_slice(new);
                }
            }
            Delivery::Pending => std::thread::sleep(std::time::Duration::from_millis(1)),
            Delivery::End => return (channels, faults),
        }
    }
}

/// How many faults are of a kind.
pub(crate) fn count(faults: &[Fault], kind: FaultKind) -> usize {
    faults.iter().filter(|fault| fault.kind == kind).count()
}
