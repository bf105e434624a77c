//! Is this room sane? Channels, clocks, levels, geometry, calibration, and whether the order of channels agrees with
//! what is seen.
//!
//! A check never ends at the first thing that is wrong: each finding is a pass, a warning or a failure with its cure.

mod delays;
mod geometry;
mod levels;
mod order;
mod picture;
mod sound;

use crate::config::ResolvedRoom;
use crate::engine::Engine;
use crate::error::EngineError;
use crate::sources;
use crate::summary::{Outcome, Summary};
use hearsight_core::record::Scene;
use hearsight_core::{Instant, Moment, Span};
use hearsight_systems::{StateError, System};
use miette::Diagnostic;
use serde::Serialize;
use std::time::Duration;

/// So much of a recording is listened to.
const LISTEN_S: f64 = 120.0;
/// So much of live sources is listened to.
const LISTEN_LIVE_S: f64 = 10.0;
/// So much is tracked in order to compare sound and picture.
const TRACK_S: f64 = 20.0;

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// As it should be.
    Pass,
    /// Tracking works, but likely worse than it could.
    Warning,
    /// Tracking does not work.
    Failure,
}

/// One thing that was looked at.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// How bad it is.
    pub verdict: Verdict,
    /// The sensor's name, or `room`.
    pub subject: String,
    /// What was looked at, a few words.
    pub aspect: &'static str,
    /// What was found.
    pub what: String,
    /// What helps, where something is wrong.
    pub cure: Option<String>,
}

/// Everything that was looked at.
#[derive(Clone, Debug, Default, Serialize)]
pub struct CheckReport {
    /// In the order in which it was looked at.
    pub findings: Vec<Finding>,
}

impl CheckReport {
    /// The worst verdict; a pass where nothing was found.
    pub fn worst(&self) -> Verdict {
        self.findings
            .iter()
            .map(|finding| finding.verdict)
            .max()
            .unwrap_or(Verdict::Pass)
    }

    fn pass(&mut self, subject: &str, aspect: &'static str, what: impl Into<String>) {
        self.add(Verdict::Pass, subject, aspect, what.into(), None);
    }

    fn warn(&mut self, subject: &str, aspect: &'static str, what: impl Into<String>, cure: &str) {
        self.add(
            Verdict::Warning,
            subject,
            aspect,
            what.into(),
            Some(cure.to_owned()),
        );
    }

    fn fail(&mut self, subject: &str, aspect: &'static str, what: impl Into<String>, cure: Option<String>) {
        self.add(Verdict::Failure, subject, aspect, what.into(), cure);
    }

    fn add(
        &mut self,
        verdict: Verdict,
        subject: &str,
        aspect: &'static str,
        what: String,
        cure: Option<String>,
    ) {
        self.findings.push(Finding {
            verdict,
            subject: subject.to_owned(),
            aspect,
            what,
            cure,
        });
    }

    fn error(&mut self, subject: &str, aspect: &'static str, error: &EngineError) {
        self.fail(
            subject,
            aspect,
            error.to_string(),
            error.help().map(|help| help.to_string()),
        );
    }
}

/// Checks a room. Reads up to two minutes of it and tracks up to twenty seconds.
pub fn check(configuration: &ResolvedRoom) -> CheckReport {
    let mut report = CheckReport::default();
    if !open_each(configuration, &mut report) {
        return report;
    }
    match Engine::open_with(configuration.clone(), |_| Ok(Box::new(Listener))) {
        Ok(mut engine) => {
            let limit_s = if engine.is_live() { LISTEN_LIVE_S } else { LISTEN_S };
            engine.end_by(engine.progress().start + Span::from_seconds(limit_s));
            geometry::check(engine.room(), configuration, &mut report);
            let (heard, begun) = listen(&mut engine, &mut report);
            clocks(&engine.summary(Outcome::Finished), &mut report);
            drop(engine);
            compare(configuration, &heard, begun, &mut report);
        }
        Err(error) => report.error("room", "sensors fit each other", &error),
    }
    report
}

/// Opens each sensor by itself, so that one which fails does not hide the others.
fn open_each(configuration: &ResolvedRoom, report: &mut CheckReport) -> bool {
    for (name, opened) in sources::open_each(configuration) {
        match opened {
            Ok(facts) => report.pass(&name, "opens", facts),
            Err(error) => report.error(&name, "opens", &error),
        }
    }
    report.worst() < Verdict::Failure
}

/// Reads the whole room once; gives what was heard, and when the last of the sensors began.
fn listen(engine: &mut Engine, report: &mut CheckReport) -> (Vec<sound::Heard>, Option<Instant>) {
    let room = engine.room().clone();
    let mut pictures: Vec<_> = room
        .cameras
        .iter()
        .map(|camera| picture::Looker::new(&camera.name))
        .collect();
    let mut sounds: Vec<_> = room
        .arrays
        .iter()
        .map(|array| sound::Ear::new(array, room.speed_of_sound_m_s))
        .collect();
    while engine.step().is_some() {
        let moment = engine.tick().moment;
        for (looker, observed) in pictures.iter_mut().zip(&moment.video) {
            observed.get().into_iter().for_each(|frame| looker.look(frame));
        }
        for (ear, observed) in sounds.iter_mut().zip(&moment.audio) {
            observed.get().into_iter().for_each(|block| ear.hear(block));
        }
    }
    for (looker, camera) in pictures.iter().zip(&room.cameras) {
        looker.report(camera, report);
    }
    let sounds = sounds.into_iter().zip(&room.arrays).enumerate();
    let heard: Vec<_> = sounds
        .map(|(number, (ear, array))| ear.report(number, array, report))
        .collect();
    let seen = pictures.iter().map(|looker| looker.first);
    let begun = seen.chain(heard.iter().map(|heard| heard.start)).flatten().max();
    (heard, begun)
}

/// Faults and rates, which the sources have counted.
fn clocks(summary: &Summary, report: &mut CheckReport) {
    if let (Some(first), Some(last)) = (summary.first_tick_s, summary.last_tick_s) {
        report.pass(
            "room",
            "clocks",
            format!("{:.2} s to {:.2} s on the common clock", first, last),
        );
    }
    for fault in &summary.faults {
        let what = format!(
            "{} times, first at {:.2} s: {}",
            fault.count, fault.first_s, fault.first_detail
        );
        let cure = "what was read is used; record or copy the file again if it matters";
        report.warn(&fault.sensor, "data", what, cure);
    }
    if summary.faults.is_empty() {
        report.pass("room", "data", "no gap, no duplicate, nothing damaged");
    }
}

/// Tracks where sensors overlap, and compares what is seen with what was heard.
fn compare(
    configuration: &ResolvedRoom,
    heard: &[sound::Heard],
    begun: Option<Instant>,
    report: &mut CheckReport,
) {
    let mut engine = match Engine::open(configuration.clone()) {
        Ok(engine) => engine,
        Err(error) => return report.error("room", "the system accepts the room", &error),
    };
    let system = &configuration.system.name;
    report.pass(
        "room",
        "the system accepts the room",
        format!("{system} is ready"),
    );
    let Some(begun) = begun else { return };
    // What live sources deliver now was not listened to.
    if engine.is_live() || heard.iter().all(|heard| heard.delays.is_empty()) {
        return;
    }
    engine.end_by(begun + Span::from_seconds(TRACK_S));
    let mut orders: Vec<_> = heard.iter().map(|_| order::Order::default()).collect();
    let room = engine.room().clone();
    while let Some(scene) = engine.step() {
        orders
            .iter_mut()
            .zip(heard)
            .for_each(|(order, heard)| order.see(&room, heard, scene));
    }
    for (order, array) in orders.iter().zip(&room.arrays) {
        order.report(array, report);
    }
}

/// A system that tracks nobody.
struct Listener;

impl System for Listener {
    fn name(&self) -> &'static str {
        "listener"
    }

    fn step(&mut self, _: &Moment, scene: &mut Scene) {
        scene.tracks.clear();
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        Ok(Vec::new())
    }

    fn restore(&mut self, _: &[u8]) -> Result<(), StateError> {
        Ok(())
    }

    fn timings(&self) -> Vec<(&'static str, Duration)> {
        Vec::new()
    }

    fn correlation_strip(&self, _: usize) -> &[f32] {
        &[]
    }

    fn quarantined(&self) -> u64 {
        0
    }
}
