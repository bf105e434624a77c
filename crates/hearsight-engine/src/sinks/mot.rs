//! `<camera>.mot.txt`: head boxes in MOTChallenge's format, by the camera's own frames.
//!
//! Rows are `frame,id,left,top,width,height,confidence,-1,-1,-1`; frames count from 1 and edges are in pixels where
//! the top-left corner of the picture is (0, 0). A person who is believed hidden has no row: scorers count what can
//! be seen.

use super::lines::Lines;
use super::{Sink, SinkContext, SinkError, SinkInfo, Tick};
use crate::summary::Summary;
use hearsight_core::record::TrackPhase;
use std::io::Write;

pub(super) const INFO: SinkInfo = SinkInfo {
    name: "mot",
    file: "<camera>.mot.txt",
    summary: "Head boxes of each camera in MOTChallenge's format, frames from 1.",
    default: true,
    open,
};

fn open(context: &SinkContext<'_>) -> Result<Box<dyn Sink>, SinkError> {
    let files = context.room.cameras.iter().map(|camera| {
        let path = context.directory.join(format!("{}.mot.txt", camera.name));
        Ok((camera.name.clone(), Lines::create(path)?))
    });
    Ok(Box::new(Mot {
        files: files.collect::<Result<_, _>>()?,
        text: Vec::new(),
    }))
}

struct Mot {
    /// One a camera, in the order of the room.
    files: Vec<(String, Lines)>,
    text: Vec<u8>,
}

impl Sink for Mot {
    fn write(&mut self, tick: Tick<'_>) -> Result<(), SinkError> {
        for ((camera, lines), observed) in self.files.iter_mut().zip(&tick.moment.video) {
            let Some(frame) = observed.get() else { continue };
            for track in tick
                .scene
                .tracks
                .iter()
                .filter(|track| track.phase == TrackPhase::Visible)
            {
                for view in track.views.iter().filter(|view| view.camera == *camera) {
                    let head = view.head;
                    self.text.clear();
                    // Writing into a vector cannot fail.
                    let _ = write!(
                        self.text,
                        "{},{},{:.2},{:.2},{:.2},{:.2},{:.4},-1,-1,-1",
                        frame.number, track.id, head.left, head.top, head.width, head.height, track.existence
                    );
                    lines.line(&self.text)?;
                }
            }
        }
        Ok(())
    }

    fn finish(&mut self, _: &Summary) -> Result<(), SinkError> {
        let mut result = Ok(());
        for (_, lines) in &mut self.files {
            result = result.and(lines.flush());
        }
        result
    }
}
