//! What libav complains of can be read by who asks for it, and is silent otherwise.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its input fails")]

use hearsight_media::{VideoFile, VideoOptions};
use std::io::Write;
use std::sync::{Arc, Mutex};
use tracing::Level;

#[derive(Clone, Default)]
struct Lines(Arc<Mutex<Vec<u8>>>);

impl Write for Lines {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// What is logged at a level while an MP4 without an index is opened.
fn logged(level: Level) -> String {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("no-index.mp4");
    let mut bytes = b"\0\0\0\x18ftypisom\0\0\x02\0isomiso2\0\0\0\x40mdat".to_vec();
    bytes.resize(24 + 64, 7);
    std::fs::write(&path, bytes).unwrap();
    let lines = Lines::default();
    let writer = lines.clone();
    let subscriber = tracing_subscriber::fmt()
        .with_ansi(false)
        .with_max_level(level)
        .with_writer(move || writer.clone())
        .finish();
    tracing::subscriber::with_default(subscriber, || {
        assert!(VideoFile::open(&path, VideoOptions::default()).is_err());
    });
    let bytes = lines.0.lock().unwrap().clone();
    String::from_utf8(bytes).unwrap()
}

#[cfg(target_arch = "x86_64")]
#[test]
fn libav_is_heard_where_it_is_listened_to() {
    let text = logged(Level::DEBUG);
    assert!(
        text.contains("DEBUG libav: libav: [mov") && text.contains("moov atom not found"),
        "{text}"
    );
    assert_eq!(logged(Level::WARN), "");
}
