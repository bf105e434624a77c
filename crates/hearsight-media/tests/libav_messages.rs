//! What libav complains of can be read by who asks for it, and is silent otherwise.

#![cfg(target_arch = "x86_64")]
#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its input fails")]

use hearsight_media::{VideoFile, VideoOptions};
use std::fmt;
use std::sync::{Arc, Mutex};
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Level, Metadata, Subscriber};

/// Keeps what is said up to a level, a line an event.
struct Lines {
    level: Level,
    said: Arc<Mutex<String>>,
}

impl Subscriber for Lines {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        *metadata.level() <= self.level
    }

    fn event(&self, event: &Event<'_>) {
        struct Line(String);
        impl Visit for Line {
            fn record_debug(&mut self, _: &Field, value: &dyn fmt::Debug) {
                self.0.push_str(&format!("{value:?} "));
            }
        }
        let metadata = event.metadata();
        let mut line = Line(format!("{} {}: ", metadata.level(), metadata.target()));
        event.record(&mut line);
        self.said.lock().unwrap().push_str(&(line.0 + "\n"));
    }

    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}

    fn record_follows_from(&self, _: &Id, _: &Id) {}

    fn enter(&self, _: &Id) {}

    fn exit(&self, _: &Id) {}
}

/// What is logged up to a level while an MP4 without an index is opened.
fn logged(level: Level) -> String {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("no-index.mp4");
    let mut bytes = b"\0\0\0\x18ftypisom\0\0\x02\0isomiso2\0\0\0\x40mdat".to_vec();
    bytes.resize(24 + 64, 7);
    std::fs::write(&path, bytes).unwrap();
    let said = Arc::new(Mutex::new(String::new()));
    let lines = Lines {
        level,
        said: said.clone(),
    };
    tracing::subscriber::with_default(lines, || {
        assert!(VideoFile::open(&path, VideoOptions::default()).is_err());
    });
    said.lock().unwrap().clone()
}

#[test]
fn libav_is_heard_where_it_is_listened_to() {
    let text = logged(Level::DEBUG);
    assert!(
        text.contains("DEBUG libav: libav: [mov") && text.contains("moov atom not found"),
        "{text}"
    );
    assert_eq!(logged(Level::WARN), "");
}
