//! `hearsight check`: is this room sane?

use crate::exit::Code;
use crate::overrides::RoomOverrides;
use crate::say;
use hearsight::engine::check::{CheckReport, Verdict, check};
use hearsight::engine::config::load;
use miette::IntoDiagnostic;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  hearsight check room.toml             one line a finding, with its cure
  hearsight check room.toml --json      the same for programs
  hearsight check room.toml --strict    warnings give exit code 3";

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The room.
    room: PathBuf,
    #[command(flatten)]
    overrides: RoomOverrides,
    /// Print the findings as JSON.
    #[arg(long)]
    json: bool,
    /// Exit with code 3 where there are warnings.
    #[arg(long)]
    strict: bool,
}

/// Checks.
pub(crate) fn run(arguments: &Arguments) -> miette::Result<Code> {
    let room = load(&arguments.room, &arguments.overrides.list())?;
    let report = check(&room);
    if arguments.json {
        say::line(format_args!(
            "{}",
            serde_json::to_string_pretty(&report).into_diagnostic()?
        ));
    } else {
        print(&report);
    }
    Ok(match report.worst() {
        Verdict::Failure => Code::Failure,
        Verdict::Warning if arguments.strict => Code::Faults,
        Verdict::Warning | Verdict::Pass => Code::Done,
    })
}

fn print(report: &CheckReport) {
    let width = report
        .findings
        .iter()
        .map(|finding| finding.subject.chars().count())
        .max()
        .unwrap_or(0);
    for finding in &report.findings {
        let verdict = match finding.verdict {
            Verdict::Pass => "pass   ",
            Verdict::Warning => "WARNING",
            Verdict::Failure => "FAILURE",
        };
        say::line(format_args!(
            "{verdict}  {:<width$}  {}: {}",
            finding.subject, finding.aspect, finding.what
        ));
        if let Some(cure) = &finding.cure {
            say::line(format_args!("         {:width$}  -> {cure}", ""));
        }
    }
    let count = |verdict| {
        report
            .findings
            .iter()
            .filter(|finding| finding.verdict == verdict)
            .count()
    };
    let (warnings, failures) = (count(Verdict::Warning), count(Verdict::Failure));
    say::line(format_args!(
        "{} passed, {warnings} warnings, {failures} failures",
        count(Verdict::Pass)
    ));
}
