//! How a run went: counts, timings and faults, as `report.json` has them.

use hearsight_core::{Fault, FaultKind, Moment};
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Duration;

/// How a run ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It has not: the program was ended before it could say.
    #[default]
    Running,
    /// The sources came to their end, or the time asked for was over.
    Finished,
    /// Someone asked it to stop.
    Interrupted,
    /// An output could not be written.
    Failed,
}

/// How a run went.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Summary {
    /// Version of the program.
    pub version: &'static str,
    /// How it ended.
    pub outcome: Outcome,
    /// What was counted.
    pub counts: Counts,
    /// Time on the common clock of the first tick, seconds.
    pub first_tick_s: Option<f64>,
    /// Time on the common clock of the last tick, seconds.
    pub last_tick_s: Option<f64>,
    /// Time from tick to tick, seconds.
    pub tick_s: f64,
    /// Threads that tracked.
    pub threads: usize,
    /// True time that the run took, seconds.
    pub elapsed_s: f64,
    /// Time of the recording over true time.
    pub times_real_time: f64,
    /// True time spent in each stage, in the order of the data's way.
    pub stages: Vec<StageTime>,
    /// Every kind of fault that occurred.
    pub faults: Vec<FaultSummary>,
    /// What the system cannot do in this room and sensors that gave no data, with reason and cure.
    pub warnings: Vec<String>,
    /// Numbers that were not finite and were set aside, and records of scenes with such numbers.
    pub quarantined: u64,
}

/// What was counted in a run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, serde::Deserialize)]
pub struct Counts {
    /// Ticks.
    pub ticks: u64,
    /// New frames by camera.
    pub frames: BTreeMap<String, u64>,
    /// New samples a channel by array.
    pub samples: BTreeMap<String, u64>,
    /// Persons that were ever published.
    pub tracks: u64,
    /// Ticks in which someone was marked as speaking.
    pub ticks_with_speaker: u64,
}

/// Time spent in a stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageTime {
    /// Its name.
    pub stage: String,
    /// True time, seconds.
    pub seconds: f64,
    /// Part of the time of all stages, 0 to 1.
    pub share: f64,
}

/// Every fault of one kind of one sensor.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct FaultSummary {
    /// The sensor's name.
    pub sensor: String,
    /// What kind.
    pub kind: FaultKind,
    /// How many.
    pub count: u64,
    /// When the first one was, seconds on the common clock.
    pub first_s: f64,
    /// When the last one was, seconds on the common clock.
    pub last_s: f64,
    /// What was said of the first one.
    pub first_detail: String,
}

/// Faults gathered by sensor and kind, so that a bad source cannot fill the memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct FaultBook(BTreeMap<(String, FaultKind), FaultSummary>);

impl FaultBook {
    /// Takes the faults of one moment.
    pub(crate) fn add(&mut self, faults: &[Fault]) {
        for fault in faults {
            let key = (fault.sensor.clone(), fault.kind);
            let entry = self.0.entry(key).or_insert_with(|| {
                tracing::warn!(
                    sensor = fault.sensor,
                    time_s = fault.time_s,
                    "{}; further faults of this kind are only counted",
                    fault.detail
                );
                FaultSummary {
                    sensor: fault.sensor.clone(),
                    kind: fault.kind,
                    count: 0,
                    first_s: fault.time_s,
                    last_s: fault.time_s,
                    first_detail: fault.detail.clone(),
                }
            });
            entry.count += 1;
            entry.last_s = fault.time_s;
        }
    }

    /// Everything so far, by sensor and kind.
    pub(crate) fn list(&self) -> Vec<FaultSummary> {
        self.0.values().cloned().collect()
    }

    /// The book with this content.
    pub(crate) fn from_list(list: Vec<FaultSummary>) -> Self {
        Self(
            list.into_iter()
                .map(|fault| ((fault.sensor.clone(), fault.kind), fault))
                .collect(),
        )
    }
}

impl Counts {
    /// Sensors that gave no data.
    pub(crate) fn silent(&self) -> impl Iterator<Item = &str> {
        let all = self.frames.iter().chain(&self.samples);
        all.filter(|(_, count)| **count == 0)
            .map(|(name, _)| name.as_str())
    }

    /// Takes the data of one moment.
    pub(crate) fn add_moment(&mut self, moment: &Moment, cameras: &[String], arrays: &[String]) {
        self.ticks += 1;
        for (name, observed) in cameras.iter().zip(&moment.video) {
            let count = self.frames.entry(name.clone()).or_default();
            *count += u64::from(observed.new);
        }
        for (name, observed) in arrays.iter().zip(&moment.audio) {
            let count = self.samples.entry(name.clone()).or_default();
            *count += observed.get().map_or(0, |block| block.len() as u64);
        }
    }
}

/// Shares of a list of stages.
pub(crate) fn stage_times(stages: &[(&str, Duration)]) -> Vec<StageTime> {
    let total: f64 = stages.iter().map(|(_, time)| time.as_secs_f64()).sum();
    let share = |seconds: f64| if total > 0.0 { seconds / total } else { 0.0 };
    stages
        .iter()
        .map(|(stage, time)| {
            let seconds = time.as_secs_f64();
            StageTime {
                stage: (*stage).to_owned(),
                seconds,
                share: share(seconds),
            }
        })
        .collect()
}
