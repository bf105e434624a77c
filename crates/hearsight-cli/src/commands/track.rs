//! `hearsight track`: the main job.

use crate::exit::Code;
use crate::formats::Formats;
use crate::overrides::RoomOverrides;
use crate::say;
use crate::{interrupt, progress};
use hearsight::engine::config::{ResolvedRoom, load};
use hearsight::engine::{Engine, EngineError, Outcome, Outputs, SavedRun, Summary, run as run_engine};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

const EXAMPLES: &str = "\
Examples:
  hearsight track room.toml                              all outputs, beside room.toml in out/
  hearsight track room.toml --out tracks --overlay       and a video with the tracks drawn on it
  hearsight track room.toml --from 20 --until 30 --timing
  hearsight track room.toml --set system.stac.particles=400 --seed 7
  hearsight track room.toml --until 60 --save run.state  put the run aside at 60 s ...
  hearsight track room.toml --restore run.state          ... and go on";

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The room: sensors, geometry, system. See the examples that come with the program.
    room: PathBuf,
    /// Directory of the outputs; made where it is missing.
    #[arg(short, long, value_name = "DIRECTORY")]
    out: Option<PathBuf>,
    #[command(flatten)]
    formats: Formats,
    #[command(flatten)]
    overrides: RoomOverrides,
    /// Put the run aside in this file when it ends.
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,
    /// Go on where a run of the same room was put aside; outputs begin there.
    #[arg(long, value_name = "FILE")]
    restore: Option<PathBuf>,
    /// Print the time spent in each stage.
    #[arg(long)]
    timing: bool,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
    /// Exit with code 3 where the data had faults.
    #[arg(long)]
    strict: bool,
}

/// Tracks.
pub(crate) fn run(arguments: &Arguments) -> miette::Result<Code> {
    let mut overrides = arguments.overrides.list();
    overrides.extend(arguments.formats.overrides());
    let mut room = load(&arguments.room, &overrides)?;
    if let Some(out) = &arguments.out {
        room.output.directory.clone_from(out);
    }
    let (engine, summary) = track(room, arguments.restore.as_deref(), arguments.quiet)?;
    if let Some(path) = &arguments.save {
        engine.save()?.write(path)?;
    }
    if !arguments.quiet {
        print(&engine, &summary);
    }
    if arguments.timing {
        print_timing(&summary);
    }
    Ok(match summary.outcome {
        Outcome::Interrupted => Code::Interrupted,
        _ if arguments.strict && !summary.faults.is_empty() => Code::Faults,
        _ => Code::Done,
    })
}

/// Tracks a resolved room with all its outputs and a progress bar.
fn track(room: ResolvedRoom, restore: Option<&Path>, quiet: bool) -> Result<(Engine, Summary), EngineError> {
    let stop = interrupt::flag();
    let mut engine = Engine::open(room)?;
    if let Some(path) = restore {
        let saved = SavedRun::read(path)?;
        engine.restore(&saved).map_err(|error| EngineError::Saved {
            path: path.to_path_buf(),
            reason: error.to_string(),
            cure: "restore with the room.toml and options of the run that was saved".to_owned(),
        })?;
    }
    let outputs = engine.open_outputs()?;
    let summary = drive(&mut engine, outputs, &stop, quiet)?;
    Ok((engine, summary))
}

/// Runs an engine to its end with a progress bar.
pub(crate) fn drive(
    engine: &mut Engine,
    outputs: Outputs,
    stop: &Arc<AtomicBool>,
    quiet: bool,
) -> Result<Summary, EngineError> {
    let bar = progress::Bar::new(&engine.progress(), quiet);
    let result = run_engine(engine, outputs, stop, &mut |progress| bar.show(progress));
    bar.end();
    result
}

/// What a run came to, for people.
pub(crate) fn print(engine: &Engine, summary: &Summary) {
    let counts = &summary.counts;
    let seconds = summary.tick_s * counts.ticks as f64;
    let frames: Vec<String> = counts
        .frames
        .iter()
        .map(|(camera, frames)| format!("{camera} {frames}"))
        .collect();
    say::line(format_args!(
        "{seconds:.1} s in {:.1} s ({:.1} times real time)",
        summary.elapsed_s, summary.times_real_time
    ));
    if !frames.is_empty() {
        say::line(format_args!("frames: {}", frames.join(", ")));
    }
    let speech = summary.tick_s * counts.ticks_with_speaker as f64;
    say::line(format_args!(
        "tracks: {}; someone speaks for {speech:.1} s",
        counts.tracks
    ));
    for warning in &summary.warnings {
        say::line(format_args!("warning: {warning}"));
    }
    for fault in &summary.faults {
        let times = if fault.count == 1 {
            String::new()
        } else {
            format!(" ({} in all)", fault.count)
        };
        say::line(format_args!(
            "fault: {} at {:.2} s: {}{times}",
            fault.sensor, fault.first_s, fault.first_detail
        ));
    }
    if summary.quarantined > 0 {
        say::line(format_args!(
            "fault: {} numbers were not finite and were set aside",
            summary.quarantined
        ));
    }
    let output = &engine.configuration().output;
    if !output.formats.is_empty() {
        say::line(format_args!("written to {}", output.directory.display()));
    }
}

fn print_timing(summary: &Summary) {
    say::line(format_args!("{:<16} {:>9} {:>7}", "stage", "seconds", "share"));
    for stage in &summary.stages {
        say::line(format_args!(
            "{:<16} {:>9.3} {:>5.1} %",
            stage.stage,
            stage.seconds,
            100.0 * stage.share
        ));
    }
    say::line(format_args!(
        "{:<16} {:>9.3}  ({} threads)",
        "elapsed", summary.elapsed_s, summary.threads
    ));
}
