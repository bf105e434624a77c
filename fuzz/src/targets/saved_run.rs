//! Files of runs that were put aside.

use super::{Target, Verdict};
use hearsight_core::{FaultKind, Instant};
use hearsight_engine::{Counts, FaultSummary, SavedRun};

pub(super) const TARGET: Target = Target {
    name: "saved_run",
    meaning: "A run that was put aside; what was read is written as it was.",
    text: false,
    words: &[],
    longest: 4 << 10,
    seeds: || {
        let fault = FaultSummary {
            sensor: "front".into(),
            kind: FaultKind::Gap,
            count: 3,
            first_s: 0.5,
            last_s: 2.5,
            first_detail: "a frame is missing".into(),
        };
        let run = SavedRun {
            version: "0.1.0".into(),
            fingerprint: 0x0123_4567_89ab_cdef,
            ticks: 250,
            tick: 300,
            first: Some(Instant::from_seconds(11.0)),
            counts: Counts {
                ticks: 250,
                tracks: 2,
                frames: [("front".to_owned(), 250)].into(),
                ..Counts::default()
            },
            last_track: 2,
            faults: vec![fault],
            system: vec![1, 2, 3],
        };
        run.to_bytes().into_iter().collect()
    },
    open: || {
        Box::new(|bytes| {
            let run = match SavedRun::from_bytes(bytes) {
                Ok(run) => run,
                Err(error) => return Verdict::Refused(error.to_string()),
            };
            // Compared as bytes, since numbers that are not finite do not equal themselves.
            let written = run.to_bytes();
            let again = written
                .as_deref()
                .ok()
                .and_then(|bytes| SavedRun::from_bytes(bytes).ok());
            match (written, again.map(|again| again.to_bytes())) {
                (Ok(written), Some(Ok(again))) if written == again => Verdict::Read(format!(
                    "{} faults {} cameras",
                    run.faults.len(),
                    run.counts.frames.len()
                )),
                _ => Verdict::Broken("what is written is read as another".to_owned()),
            }
        })
    },
};
