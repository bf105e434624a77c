//! Network streams over loopback with the program `ffmpeg` as the sender: MPEG-TS, RTP and RTSP, and silence.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its input fails")]

mod common;

use common::count;
use hearsight_core::source::{Delivery, VideoSource};
use hearsight_core::{FaultKind, Instant, Span, VideoFrame};
use hearsight_media::{MediaError, RunClock, SourceClock, VideoFile, VideoOptions};
use std::net::{TcpListener, UdpSocket};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// A sender of three seconds of video at true speed; killed when dropped.
struct Sender(Child);

impl Sender {
    fn start(codec: &[&str], target: &[&str]) -> Option<Self> {
        let mut command = Command::new("ffmpeg");
        command.args(["-nostdin", "-loglevel", "error", "-re", "-f", "lavfi"]);
        command
            .args(["-i", "testsrc=size=160x120:rate=25", "-t", "3"])
            .args(codec)
            .args(target);
        match command.stdin(Stdio::null()).spawn() {
            Ok(child) => Some(Self(child)),
            Err(error) => {
                println!("skipped: the program ffmpeg cannot be started ({error})");
                None
            }
        }
    }
}

impl Drop for Sender {
    fn drop(&mut self) {
        // It may have ended by itself; either way nothing of it remains.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn udp_port() -> u16 {
    loop {
        let port = UdpSocket::bind("127.0.0.1:0")
            .unwrap()
            .local_addr()
            .unwrap()
            .port();
        // RTP wants an even port and the next one beside it.
        if port.is_multiple_of(2) && UdpSocket::bind(("127.0.0.1", port + 1)).is_ok() {
            return port;
        }
    }
}

fn tcp_port() -> u16 {
    TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap()
        .port()
}

fn options(clock: RunClock, parameters: &[(&str, &str)], timeout_s: f64) -> VideoOptions {
    let mut options = VideoOptions {
        clock: SourceClock::on_arrival(clock),
        ..VideoOptions::default()
    };
    options.input.timeout = Span::from_seconds(timeout_s);
    let owned = parameters
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
    options.input.parameters = owned.collect();
    options
}

/// Reads `location` while `ffmpeg` sends to it, and checks what comes.
fn receive(location: &str, parameters: &[(&str, &str)], codec: &[&str], target: &[&str]) {
    let clock = RunClock::starting_at(Instant::from_seconds(100.0));
    let (location, options) = (location.to_owned(), options(clock, parameters, 4.0));
    let shown = location.clone();
    let receiver = std::thread::spawn(move || {
        let mut camera = VideoFile::open_location(&location, options).unwrap();
        assert!(camera.format().live);
        assert_eq!((camera.format().width, camera.format().height), (160, 120));
        let (mut frame, mut faults, mut frames) = (VideoFrame::default(), Vec::new(), Vec::new());
        while camera.read(&mut frame, &mut faults) == Delivery::Data {
            // However long libav listened before the first frame, none may seem to be of the future.
            assert!(
                frame.time <= clock.now() + Span::from_seconds(0.1),
                "{} {}",
                frame.number,
                frame.time.seconds()
            );
            frames.push((frame.number, frame.time.nanoseconds()));
        }
        (frames, faults)
    });
    std::thread::sleep(Duration::from_millis(500));
    let Some(_sender) = Sender::start(codec, target) else {
        // The receiver gives up by itself.
        assert!(receiver.join().is_err());
        return;
    };
    let (frames, faults) = receiver.join().unwrap();
    println!("{shown}: {} frames, {faults:?}", frames.len());
    assert!(frames.len() > 30, "{shown}: {} frames, {faults:?}", frames.len());
    assert_eq!(frames[0].0, 1);
    assert!(frames[0].1 >= 100_000_000_000);
    for pair in frames.windows(2) {
        let (frames, time) = ((pair[1].0 - pair[0].0) as i64, pair[1].1 - pair[0].1);
        assert!(
            (time - frames * 40_000_000).abs() < 2_000_000,
            "{shown}: {pair:?}"
        );
    }
    assert!(count(&faults, FaultKind::Lost) <= 1, "{shown}: {faults:?}");
}

const MPEG2: [&str; 4] = ["-c:v", "mpeg2video", "-g", "5"];

#[test]
fn mpeg_ts_over_udp() {
    let address = format!("udp://127.0.0.1:{}", udp_port());
    receive(
        &address,
        &[],
        &MPEG2,
        &["-f", "mpegts", &format!("{address}?pkt_size=1316")],
    );
}

#[test]
fn mpeg_ts_over_tcp() {
    let address = format!("tcp://127.0.0.1:{}", tcp_port());
    receive(
        &format!("{address}?listen=1"),
        &[],
        &MPEG2,
        &["-f", "mpegts", &address],
    );
}

#[test]
fn rtp() {
    let port = udp_port();
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("session.sdp");
    // Payload type 32 is MPEG-1 or MPEG-2 video (RFC 3551).
    let session = format!(
        "v=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=test\r\nc=IN IP4 127.0.0.1\r\nt=0 0\r\nm=video {port} RTP/AVP 32\r\n"
    );
    std::fs::write(&path, session).unwrap();
    receive(
        path.to_str().unwrap(),
        &[],
        &MPEG2,
        &["-f", "rtp", &format!("rtp://127.0.0.1:{port}")],
    );
}

#[test]
fn rtsp() {
    let address = format!("rtsp://127.0.0.1:{}/camera", tcp_port());
    let codec = ["-c:v", "mpeg4", "-g", "5"];
    let target = ["-rtsp_transport", "tcp", "-f", "rtsp", &address];
    receive(&address, &[("rtsp_flags", "listen")], &codec, &target);
}

#[test]
fn silence_ends_after_the_time_allowed() {
    let clock = RunClock::starting_at(Instant::ZERO);
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let silent = listener.local_addr().unwrap().port();
    let udp = format!("udp://127.0.0.1:{}", udp_port());
    for location in [
        format!("tcp://127.0.0.1:{silent}"),
        format!("rtsp://127.0.0.1:{silent}/x"),
        udp,
    ] {
        let begun = std::time::Instant::now();
        let error = VideoFile::open_location(&location, options(clock, &[], 0.4))
            .err()
            .unwrap();
        assert!(matches!(error, MediaError::Unreachable { .. }), "{error}");
        assert!(error.to_string().contains(&location), "{error}");
        assert!(
            begun.elapsed() < Duration::from_secs(3),
            "{location}: {:?}",
            begun.elapsed()
        );
    }
    let closed = format!("rtsp://127.0.0.1:{}/x", tcp_port());
    let error = VideoFile::open_location(&closed, options(clock, &[], 2.0))
        .err()
        .unwrap();
    assert!(matches!(error, MediaError::Unreachable { .. }), "{error}");
}
