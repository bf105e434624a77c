//! `scenes.jsonl`: every scene as a line of JSON, by the published schema.

use super::lines::Lines;
use super::{Sink, SinkContext, SinkError, SinkInfo, Tick};
use crate::summary::Summary;

pub(super) const INFO: SinkInfo = SinkInfo {
    name: "scenes",
    file: "scenes.jsonl",
    summary: "Every scene as a line of JSON, by the schema that `hearsight schema` prints.",
    default: true,
    open,
};

fn open(context: &SinkContext<'_>) -> Result<Box<dyn Sink>, SinkError> {
    Ok(Box::new(Scenes {
        lines: Lines::create(context.directory.join(INFO.file))?,
        text: Vec::new(),
    }))
}

struct Scenes {
    lines: Lines,
    text: Vec<u8>,
}

impl Sink for Scenes {
    fn write(&mut self, tick: Tick<'_>) -> Result<(), SinkError> {
        self.text.clear();
        serde_json::to_writer(&mut self.text, tick.scene)
            .map_err(|error| SinkError::new(self.lines.path(), error))?;
        self.lines.line(&self.text)
    }

    fn finish(&mut self, _: &Summary) -> Result<(), SinkError> {
        self.lines.flush()
    }
}
