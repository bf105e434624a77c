//! The program `hearsight`: reads the command line, calls the library, prints, and turns errors into exit codes.
//!
//! One file a command in [`commands`]. No tracking happens here.

mod commands;
mod exit;
mod formats;
mod interrupt;
mod logging;
mod overrides;
mod progress;
mod recording;
mod reproduce;
mod say;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Who is here, where are they, and who is speaking: from raw cameras and microphones.
#[derive(Parser)]
#[command(version, propagate_version = true, arg_required_else_help = true, after_help = exit::HELP)]
struct Arguments {
    /// More to the log on standard error: -v for what is going on, -vv for everything. RUST_LOG is heeded instead
    /// where it is set.
    #[arg(short, long, action = clap::ArgAction::Count, global = true)]
    verbose: u8,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Track people in a recording or live: scenes, who speaks, overlay video.
    Track(commands::track::Arguments),
    /// Find out whether a room is sane: channels, clocks, levels, geometry, calibration.
    Check(commands::check::Arguments),
    /// Learn the lens and place of a camera from a board, or clock, turn and place of an array from people who talk.
    Calibrate(commands::calibrate::Arguments),
    /// Make recordings of a simulated room, with the exact truth.
    Simulate(commands::simulate::Arguments),
    /// Simulate a meeting, track it, judge the tracks and show them. Needs no data and no device.
    Demo(commands::demo::Arguments),
    /// Judge tracks by the truth: CLEAR MOT, identity, HOTA, speech, calibration; table, JSON, HTML with plots.
    Evaluate(commands::evaluate::Arguments),
    /// Run a paper's experiment again on simulated rooms and put its table beside ours.
    Reproduce(commands::reproduce::Arguments),
    /// Print the JSON schema of a scene, of `room.toml`, or of a system's parameters.
    Schema(commands::schema::Arguments),
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    logging::begin(arguments.verbose);
    let result = match arguments.command {
        Command::Track(arguments) => commands::track::run(&arguments),
        Command::Check(arguments) => commands::check::run(&arguments),
        Command::Calibrate(arguments) => commands::calibrate::run(&arguments),
        Command::Simulate(arguments) => commands::simulate::run(&arguments),
        Command::Demo(arguments) => commands::demo::run(&arguments),
        Command::Evaluate(arguments) => commands::evaluate::run(&arguments),
        Command::Reproduce(arguments) => commands::reproduce::run(&arguments),
        Command::Schema(arguments) => commands::schema::run(&arguments),
    };
    match result {
        Ok(code) => code.into(),
        Err(report) => {
            say::error(format_args!("{report:?}"));
            exit::Code::Failure.into()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn every_command_has_examples() {
        for command in Arguments::command().get_subcommands() {
            let help = command
                .get_after_help()
                .map(ToString::to_string)
                .unwrap_or_default();
            assert!(
                help.contains("hearsight "),
                "{} has no examples",
                command.get_name()
            );
        }
    }
}
