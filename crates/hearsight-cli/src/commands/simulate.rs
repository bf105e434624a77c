//! `hearsight simulate`: a scenario to recordings and their truth.

use crate::exit::Code;
use crate::interrupt;
use crate::progress::Bar;
use crate::recording::{self, Choice, Format};
use crate::say;
use hearsight::sim::scenario::load;
use hearsight::sim::simulation::Simulation;
use miette::IntoDiagnostic;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  hearsight simulate scenes/meeting.toml --out meeting
  hearsight simulate scenes/meeting.toml --out meeting --seed 7 --seconds 10
  hearsight simulate scenes/stac-vo.toml --out vo --set room.t60=0.9 --format mp4
  hearsight simulate scene.toml --out ears --no-video        sound and truth alone
  hearsight track meeting/room.toml                          tracks what was simulated
  hearsight schema scenario                                  every key of a scenario";

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The scenario: room, people, what they do and say, sounds, sensors. scenes/ holds examples.
    scene: PathBuf,
    /// Directory of the recordings, of room.toml and of the truth; made where it is missing.
    #[arg(short, long, value_name = "DIRECTORY")]
    out: PathBuf,
    /// Seed of everything that the scenario leaves open.
    #[arg(long)]
    seed: Option<u64>,
    /// Length, seconds.
    #[arg(long)]
    seconds: Option<f64>,
    /// Any key of the scenario, such as room.t60=0.9 or camera.front.rate=25. May be given again.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    set: Vec<(String, String)>,
    /// How files are written.
    #[arg(long, value_enum, default_value_t = Format::Lossless)]
    format: Format,
    /// Take no pictures: truth then knows no boxes.
    #[arg(long)]
    no_video: bool,
    /// Record no sound.
    #[arg(long, conflicts_with = "no_video")]
    no_audio: bool,
    /// Threads; 0 takes one a processor. Results do not depend on it.
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
}

fn assignment(text: &str) -> Result<(String, String), String> {
    text.split_once('=')
        .filter(|(key, _)| !key.is_empty())
        .map(|(key, value)| (key.to_owned(), value.to_owned()))
        .ok_or_else(|| "write KEY=VALUE, such as room.t60=0.9".to_owned())
}

/// Simulates.
pub(crate) fn run(arguments: &Arguments) -> miette::Result<Code> {
    let mut overrides = arguments.set.clone();
    overrides.extend(arguments.seed.map(|seed| ("seed".to_owned(), seed.to_string())));
    overrides.extend(
        arguments
            .seconds
            .map(|seconds| ("seconds".to_owned(), format!("{seconds:?}"))),
    );
    let world = load(&arguments.scene, &overrides)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.min(1024))
        .build()
        .into_diagnostic()?;
    let choice = Choice {
        format: arguments.format,
        video: !arguments.no_video,
        sound: !arguments.no_audio,
    };
    let stop = interrupt::flag();
    let begun = std::time::Instant::now();
    let bar = Bar::of_seconds(world.seconds, arguments.quiet);
    let (simulation, interrupted) = pool.install(|| {
        let simulation = Simulation::new(world).into_diagnostic()?;
        let (_, interrupted) =
            recording::record(&simulation, &arguments.out, choice, &stop, &mut |done_s| {
                bar.show_seconds(done_s);
            })?;
        Ok::<_, miette::Report>((simulation, interrupted))
    })?;
    bar.end();
    if interrupted {
        return Ok(Code::Interrupted);
    }
    if !arguments.quiet {
        recording::describe(&simulation, &arguments.out, begun.elapsed().as_secs_f64());
        say::line(format_args!(
            "next: hearsight track {}",
            arguments.out.join("room.toml").display()
        ));
    }
    Ok(Code::Done)
}
