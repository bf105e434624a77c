//! `report.json`: how the run went, and with what configuration.

use super::{Sink, SinkContext, SinkError, SinkInfo, Tick};
use crate::config::ResolvedRoom;
use crate::summary::Summary;
use serde::Serialize;
use std::path::PathBuf;

pub(super) const INFO: SinkInfo = SinkInfo {
    name: "report",
    file: "report.json",
    summary: "Counts, timings, faults and the configuration as resolved.",
    default: true,
    open,
};

fn open(context: &SinkContext<'_>) -> Result<Box<dyn Sink>, SinkError> {
    let mut report = Report {
        path: context.directory.join(INFO.file),
        configuration: context.configuration.clone(),
    };
    // Also finds out now, not after hours, whether the file can be written.
    report.finish(&Summary::default())?;
    Ok(Box::new(report))
}

struct Report {
    path: PathBuf,
    configuration: ResolvedRoom,
}

#[derive(Serialize)]
struct Content<'a> {
    #[serde(flatten)]
    summary: &'a Summary,
    configuration: &'a ResolvedRoom,
}

impl Sink for Report {
    fn write(&mut self, _: Tick<'_>) -> Result<(), SinkError> {
        Ok(())
    }

    fn finish(&mut self, summary: &Summary) -> Result<(), SinkError> {
        let content = Content {
            summary,
            configuration: &self.configuration,
        };
        let mut text =
            serde_json::to_string_pretty(&content).map_err(|error| SinkError::new(&self.path, error))?;
        text.push('\n');
        std::fs::write(&self.path, text).map_err(|error| SinkError::new(&self.path, error))
    }
}
