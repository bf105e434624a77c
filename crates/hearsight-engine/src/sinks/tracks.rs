//! `tracks.csv`: where each track is in the world, tick by tick.

use super::lines::Lines;
use super::{Sink, SinkContext, SinkError, SinkInfo, Tick};
use crate::summary::Summary;
use hearsight_core::record::TrackPhase;
use std::io::Write;

pub(super) const INFO: SinkInfo = SinkInfo {
    name: "tracks",
    file: "tracks.csv",
    summary: "Place in the world of each track at each tick, metres; empty where the system has none.",
    default: true,
    open,
};

const HEADER: &str = "t_sec,track,x_m,y_m,z_m,phase,existence,speaking,speaking_probability";

fn open(context: &SinkContext<'_>) -> Result<Box<dyn Sink>, SinkError> {
    let mut lines = Lines::create(context.directory.join(INFO.file))?;
    lines.line(HEADER.as_bytes())?;
    Ok(Box::new(Tracks {
        lines,
        text: Vec::new(),
    }))
}

struct Tracks {
    lines: Lines,
    text: Vec<u8>,
}

impl Sink for Tracks {
    fn write(&mut self, tick: Tick<'_>) -> Result<(), SinkError> {
        for track in &tick.scene.tracks {
            self.text.clear();
            let place = match track.position_m {
                Some([x, y, z]) => format!("{x:.4},{y:.4},{z:.4}"),
                None => ",,".to_owned(),
            };
            let phase = match track.phase {
                TrackPhase::Visible => "visible",
                TrackPhase::Occluded => "occluded",
            };
            let probability = track
                .speaking_probability
                .map_or_else(String::new, |p| format!("{p:.4}"));
            // Writing into a vector cannot fail.
            let _ = write!(
                self.text,
                "{:.4},{},{place},{phase},{:.4},{},{probability}",
                tick.scene.time_s,
                track.id,
                track.existence,
                u8::from(track.speaking),
            );
            self.lines.line(&self.text)?;
        }
        Ok(())
    }

    fn finish(&mut self, _: &Summary) -> Result<(), SinkError> {
        self.lines.flush()
    }
}
