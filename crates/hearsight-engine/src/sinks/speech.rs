//! `speech.rttm`: who speaks when, as NIST's rich transcription time marks.
//!
//! A tick at t stands for the time from t to the tick after it; ticks of the same speaker that follow each other make
//! one interval.

use super::lines::Lines;
use super::{Sink, SinkContext, SinkError, SinkInfo, Tick};
use crate::summary::Summary;

pub(super) const INFO: SinkInfo = SinkInfo {
    name: "speech",
    file: "speech.rttm",
    summary: "Who speaks when, as RTTM; speakers are called `track<id>`.",
    default: true,
    open,
};

fn open(context: &SinkContext<'_>) -> Result<Box<dyn Sink>, SinkError> {
    Ok(Box::new(Speech {
        lines: Lines::create(context.directory.join(INFO.file))?,
        recording: context.configuration.name.clone(),
        tick_s: context.tick_s,
        speaking: None,
    }))
}

struct Speech {
    lines: Lines,
    recording: String,
    tick_s: f64,
    speaking: Option<Interval>,
}

#[derive(Clone, Copy)]
struct Interval {
    track: u64,
    start_s: f64,
    end_s: f64,
}

impl Speech {
    fn close(&mut self) -> Result<(), SinkError> {
        let Some(Interval {
            track,
            start_s,
            end_s,
        }) = self.speaking.take()
        else {
            return Ok(());
        };
        let (recording, duration_s) = (&self.recording, end_s - start_s);
        let line =
            format!("SPEAKER {recording} 1 {start_s:.3} {duration_s:.3} <NA> <NA> track{track} <NA> <NA>");
        self.lines.line(line.as_bytes())
    }
}

impl Sink for Speech {
    fn write(&mut self, tick: Tick<'_>) -> Result<(), SinkError> {
        let now = tick.scene.time_s;
        if let Some(interval) = &mut self.speaking
            && tick.scene.speaker == Some(interval.track)
            && now <= interval.end_s + self.tick_s / 2.0
        {
            interval.end_s = now + self.tick_s;
            return Ok(());
        }
        self.close()?;
        self.speaking = tick.scene.speaker.map(|track| Interval {
            track,
            start_s: now,
            end_s: now + self.tick_s,
        });
        Ok(())
    }

    fn finish(&mut self, _: &Summary) -> Result<(), SinkError> {
        let closed = self.close();
        closed.and(self.lines.flush())
    }
}
