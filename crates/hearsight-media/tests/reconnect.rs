//! Live sources that are lost and come back, over loopback: the program `ffmpeg` sends, is killed and started again.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test that cannot prepare its input fails"
)]

use hearsight_core::source::{AudioSource, Delivery, VideoSource};
use hearsight_core::{AudioBlock, Fault, FaultKind, Instant, Span, VideoFrame};
use hearsight_media::{
    AudioOptions, InputOptions, LiveAudio, LiveVideo, QueueOptions, ReconnectingAudio, ReconnectingVideo,
    RunClock, SourceClock, VideoOptions,
};
use std::net::{TcpListener, UdpSocket};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant as Clock};

/// A sender without end; killed when dropped.
struct Sender(Child);

impl Sender {
    fn start(input: &[&str], target: &[&str]) -> Option<Self> {
        let mut command = Command::new("ffmpeg");
        command.args(["-nostdin", "-loglevel", "quiet", "-re", "-f", "lavfi", "-i"]);
        command.args(input).args(target).stdin(Stdio::null());
        match command.spawn() {
            Ok(child) => Some(Self(child)),
            Err(error) => {
                println!("skipped: the program ffmpeg cannot be started ({error})");
                None
            }
        }
    }

    /// Whether it still sends: where nobody listened yet it has ended.
    fn lives(&mut self) -> bool {
        self.0.try_wait().unwrap().is_none()
    }
}

impl Drop for Sender {
    fn drop(&mut self) {
        // It may have ended by itself; either way nothing of it remains.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn tcp_port() -> u16 {
    TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap()
        .port()
}

fn udp_port() -> u16 {
    UdpSocket::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap()
        .port()
}

fn input(parameters: &[(&str, &str)]) -> InputOptions {
    let owned = parameters
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
    InputOptions {
        timeout: Span::from_seconds(3.0),
        parameters: owned.collect(),
        ..InputOptions::default()
    }
}

/// Longest wait for anything here.
const PATIENCE: Duration = Duration::from_secs(60);

fn count(faults: &[Fault], kind: FaultKind) -> usize {
    faults.iter().filter(|fault| fault.kind == kind).count()
}

/// A camera whose sender is killed after a while and started again `away_s` later. Where the receiver can notice it, the
/// camera is lost once.
fn camera_comes_back(
    location: &str,
    parameters: &[(&str, &str)],
    target: &[&str],
    away_s: f64,
    is_lost: bool,
) {
    let clock = RunClock::starting_at(Instant::from_seconds(50.0));
    let options = VideoOptions {
        name: "front".into(),
        clock: SourceClock::on_arrival(clock),
        input: input(parameters),
        ..VideoOptions::default()
    };
    let send = || Sender::start(&["testsrc=size=160x120:rate=25"], target);
    let place = location.to_owned();
    let opening = std::thread::spawn(move || {
        let begun = Clock::now();
        loop {
            let patience = Span::from_seconds(60.0);
            match ReconnectingVideo::open(&place, options.clone(), clock, patience) {
                Ok(camera) => return camera,
                Err(error) => assert!(begun.elapsed() < PATIENCE, "{error}"),
            }
        }
    });
    std::thread::sleep(Duration::from_millis(300));
    let Some(first) = send() else { return };
    let mut sender = Some(first);
    while !opening.is_finished() {
        std::thread::sleep(Duration::from_millis(200));
        if !sender.as_mut().unwrap().lives() {
            sender = send();
        }
    }
    let camera = opening.join().unwrap();
    let queue = QueueOptions {
        name: "front".into(),
        capacity: 64,
        ..QueueOptions::default()
    };
    let mut camera = LiveVideo::spawn(Box::new(camera), &queue).unwrap();
    let (mut frame, mut faults, mut frames) = (VideoFrame::default(), Vec::new(), Vec::new());
    let (begun, mut killed_at, mut before, mut after) = (Clock::now(), None, 0, 0);
    while after < 25 {
        assert!(
            begun.elapsed() < PATIENCE,
            "{location}: {} frames, {faults:?}",
            frames.len()
        );
        match camera.read(&mut frame, &mut faults) {
            Delivery::Data => {
                // What comes is of now, before the loss and after it.
                let late = clock.now() - frame.time;
                assert!(
                    late.seconds() > -0.1 && late.seconds() < 8.0,
                    "{} s",
                    late.seconds()
                );
                frames.push((frame.number, frame.time));
                after += u32::from(killed_at.is_some() && count(&faults[before..], FaultKind::Gap) > 0);
            }
            Delivery::Pending => std::thread::sleep(Duration::from_millis(2)),
            Delivery::End => panic!("{location}: ended, {faults:?}"),
        }
        if frames.len() == 25 && killed_at.is_none() {
            sender = None;
            killed_at = Some(clock.now());
            // Whatever was missed at the beginning, on a busy machine, is not what is tried here.
            before = faults.len();
        }
        let is_due = killed_at.is_some_and(|at| (clock.now() - at).seconds() > away_s);
        let is_due = is_due || killed_at.is_none();
        if is_due && !sender.as_mut().is_some_and(Sender::lives) {
            sender = send();
        }
    }
    drop(sender);
    println!("{location}: {faults:?}");
    let faults = &faults[before..];
    // Lost once, at the time of the last frame or a little after it, then back.
    let lost = count(faults, FaultKind::Lost);
    assert_eq!(lost, usize::from(is_lost), "{location}: {faults:?}");
    let killed_s = killed_at.unwrap().seconds();
    for lost in faults.iter().filter(|fault| fault.kind == FaultKind::Lost) {
        assert!(
            (lost.time_s - killed_s).abs() < 2.0,
            "{location}: {lost:?} {killed_s}"
        );
    }
    let words = if is_lost { "is back after" } else { "set anew" };
    let back = faults.iter().find(|fault| fault.detail.contains(words)).unwrap();
    assert!(
        back.time_s > killed_s + away_s - 0.5 && back.time_s < clock.now().seconds(),
        "{location}: {back:?}"
    );
    // Numbers and times go on together.
    for pair in frames.windows(2) {
        let steps = pair[1].0 as i64 - pair[0].0 as i64;
        let seconds = (pair[1].1 - pair[0].1).seconds();
        assert!(steps >= 1 && seconds > 0.0, "{location}: {pair:?}");
        assert!(
            (seconds - 0.04 * steps as f64).abs() < 0.03,
            "{location}: {pair:?}"
        );
    }
}

const VIDEO: [&str; 6] = ["-c:v", "mpeg2video", "-g", "5", "-f", "mpegts"];

#[test]
fn mpeg_ts_over_udp_comes_back() {
    let address = format!("udp://127.0.0.1:{}", udp_port());
    let target = format!("{address}?pkt_size=1316");
    camera_comes_back(&address, &[], &[&VIDEO[..], &[&target]].concat(), 5.0, true);
}

#[test]
fn a_sender_that_is_away_for_less_than_the_time_allowed_keeps_its_time() {
    let address = format!("udp://127.0.0.1:{}", udp_port());
    let target = format!("{address}?pkt_size=1316");
    camera_comes_back(&address, &[], &[&VIDEO[..], &[&target]].concat(), 1.5, false);
}

#[test]
fn mpeg_ts_over_tcp_comes_back() {
    let address = format!("tcp://127.0.0.1:{}", tcp_port());
    camera_comes_back(
        &format!("{address}?listen=1"),
        &[],
        &[&VIDEO[..], &[&address]].concat(),
        1.0,
        true,
    );
}

#[test]
fn rtsp_comes_back() {
    let address = format!("rtsp://127.0.0.1:{}/camera", tcp_port());
    let target = [
        "-c:v",
        "mpeg4",
        "-g",
        "5",
        "-rtsp_transport",
        "tcp",
        "-f",
        "rtsp",
        &address,
    ];
    camera_comes_back(&address, &[("rtsp_flags", "listen")], &target, 1.0, true);
}

#[test]
fn sound_comes_back_with_zeros_for_what_was_lost() {
    sound_comes_back(1.5, 0);
    sound_comes_back(5.0, 1);
}

/// An array whose sender is away for `away_s`, and is lost so many times by then.
fn sound_comes_back(away_s: f64, lost: usize) {
    let address = format!("udp://127.0.0.1:{}", udp_port());
    let target = format!("{address}?pkt_size=1316");
    let send = || {
        let codec = ["-c:a", "mp2", "-f", "mpegts", &target];
        Sender::start(&["sine=frequency=500:sample_rate=16000"], &codec)
    };
    let Some(first) = send() else { return };
    let mut sender = Some(first);
    let clock = RunClock::starting_at(Instant::ZERO);
    let options = AudioOptions {
        name: "pair".into(),
        clock: SourceClock::on_arrival(clock),
        input: input(&[]),
        ..AudioOptions::default()
    };
    let array = ReconnectingAudio::open(&address, options, clock, Span::from_seconds(60.0)).unwrap();
    let queue = QueueOptions {
        name: "pair".into(),
        capacity: 1000,
        ..QueueOptions::default()
    };
    let mut array = LiveAudio::spawn(Box::new(array), &queue).unwrap();
    let rate_hz = array.format().rate_hz;
    let (mut block, mut faults) = (AudioBlock::default(), Vec::new());
    let (mut next, mut zeros_s, mut loud_after, mut killed) = (None, 0.0, 0, None);
    let begun = Clock::now();
    while loud_after < rate_hz as usize {
        assert!(begun.elapsed() < PATIENCE, "{loud_after} samples, {faults:?}");
        match array.read(&mut block, &mut faults) {
            Delivery::Data => {
                let gap = next.map_or(0.0, |next: Instant| (block.time - next).seconds());
                assert!(gap.abs() < 0.005, "samples are {gap} s off, {faults:?}");
                next = Some(block.end());
                let loud = block.channels[0].iter().any(|sample| sample.abs() > 0.01);
                if !loud {
                    zeros_s += block.len() as f64 / f64::from(rate_hz);
                } else if zeros_s > 0.5 {
                    loud_after += block.len();
                }
            }
            Delivery::Pending => std::thread::sleep(Duration::from_millis(2)),
            Delivery::End => panic!("ended, {faults:?}"),
        }
        if killed.is_none() && begun.elapsed() > Duration::from_millis(1500) {
            sender = None;
            killed = Some(Clock::now());
        }
        if sender.is_none() && killed.is_some_and(|killed| killed.elapsed().as_secs_f64() > away_s) {
            sender = send();
        }
    }
    drop(sender);
    println!("{address}: {zeros_s} s of zeros, {faults:?}");
    assert_eq!(count(&faults, FaultKind::Lost), lost, "{faults:?}");
    // What comes now is of now; the sender packs some sound together and so sends it a little early.
    let late = clock.now() - next.unwrap();
    assert!(
        late.seconds() > -0.5 && late.seconds() < 3.0,
        "{} s late",
        late.seconds()
    );
    assert!(
        zeros_s > away_s - 0.5 && zeros_s < 40.0,
        "{zeros_s} s of zeros, {faults:?}"
    );
}

#[test]
fn a_source_that_stays_away_is_given_up() {
    let address = format!("udp://127.0.0.1:{}", udp_port());
    let target = format!("{address}?pkt_size=1316");
    let Some(sender) = Sender::start(
        &["testsrc=size=160x120:rate=25"],
        &[&VIDEO[..], &[&target]].concat(),
    ) else {
        return;
    };
    let clock = RunClock::starting_at(Instant::ZERO);
    let options = VideoOptions {
        clock: SourceClock::on_arrival(clock),
        input: InputOptions {
            timeout: Span::from_seconds(1.5),
            ..InputOptions::default()
        },
        ..VideoOptions::default()
    };
    let mut camera = loop {
        match ReconnectingVideo::open(&address, options.clone(), clock, Span::from_seconds(2.0)) {
            Ok(camera) => break camera,
            Err(error) => assert!(clock.now().seconds() < 60.0, "{error}"),
        }
    };
    drop(sender);
    let (mut frame, mut faults) = (VideoFrame::default(), Vec::new());
    loop {
        match camera.read(&mut frame, &mut faults) {
            Delivery::End => break,
            Delivery::Pending => std::thread::sleep(Duration::from_millis(10)),
            Delivery::Data => {}
        }
        assert!(clock.now().seconds() < 60.0, "{faults:?}");
    }
    assert_eq!(count(&faults, FaultKind::Lost), 2, "{faults:?}");
    assert!(faults[faults.len() - 1].detail.contains("given up"), "{faults:?}");
    assert_eq!(camera.read(&mut frame, &mut faults), Delivery::End);
}
