//! `hearsight demo`: simulates a meeting, tracks it, judges the tracks by the truth, and says where to look.

use super::track;
use crate::exit::Code;
use crate::interrupt;
use crate::progress::Bar;
use crate::recording::{self, Choice, Format};
use crate::say;
use hearsight::Engine;
use hearsight::engine::Outcome;
use hearsight::engine::config::load;
use hearsight::eval::read::read;
use hearsight::eval::{Options, Report, Side, pair};
use hearsight::sim::scenario::from_text;
use hearsight::sim::simulation::Simulation;
use miette::{Context, IntoDiagnostic};
use std::path::{Path, PathBuf};

/// The report's name.
const REPORT: &str = "report.html";

const EXAMPLES: &str = "\
Examples:
  hearsight demo                         a meeting of three, into hearsight-demo/
  hearsight demo --room living-room      two people who walk about, with a television that talks
  hearsight demo --out /tmp/d --seconds 15 --seed 4
  hearsight track hearsight-demo/room.toml --out again
  hearsight simulate scenes/meeting.toml --out mine      your own: scenes/ holds the demo's rooms";

/// The rooms to choose from: files in scenes/.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum DemoRoom {
    /// Three people come into a small meeting room and talk.
    Meeting,
    /// Two people walk about in a living room whose television talks.
    LivingRoom,
}

impl DemoRoom {
    const fn scenario(self) -> (&'static str, &'static str) {
        match self {
            Self::Meeting => ("meeting.toml", include_str!("../../../../scenes/meeting.toml")),
            Self::LivingRoom => (
                "living-room.toml",
                include_str!("../../../../scenes/living-room.toml"),
            ),
        }
    }
}

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Directory for the recording and the results; made where it is missing.
    #[arg(short, long, value_name = "DIRECTORY", default_value = "hearsight-demo")]
    out: PathBuf,
    /// The room.
    #[arg(long, value_enum, default_value_t = DemoRoom::Meeting)]
    room: DemoRoom,
    /// Length, seconds. Default: that of the scenario.
    #[arg(long, value_parser = seconds)]
    seconds: Option<f64>,
    /// Seed of what is drawn: looks, voices, who speaks when. Default: that of the scenario.
    #[arg(long)]
    seed: Option<u64>,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (1.0..=600.0).contains(&value) => Ok(value),
        _ => Err("give seconds from 1 to 600".to_owned()),
    }
}

/// Simulates, tracks, judges and prints.
pub(crate) fn run(arguments: &Arguments) -> miette::Result<Code> {
    let (name, text) = arguments.room.scenario();
    let mut overrides = Vec::new();
    overrides.extend(arguments.seed.map(|seed| ("seed".to_owned(), seed.to_string())));
    overrides.extend(
        arguments
            .seconds
            .map(|seconds| ("seconds".to_owned(), format!("{seconds:?}"))),
    );
    let world = from_text(name, text, &overrides)?;
    let choice = Choice {
        format: Format::Lossless,
        video: true,
        sound: true,
    };
    let stop = interrupt::flag();
    let begun = std::time::Instant::now();
    let bar = Bar::of_seconds(world.seconds, arguments.quiet);
    let simulation = Simulation::new(world).into_diagnostic()?;
    let (room, interrupted) = recording::record(&simulation, &arguments.out, choice, &stop, &mut |done_s| {
        bar.show_seconds(done_s);
    })?;
    bar.end();
    if interrupted {
        return Ok(Code::Interrupted);
    }
    if !arguments.quiet {
        recording::describe(&simulation, &arguments.out, begun.elapsed().as_secs_f64());
    }
    let tracks = arguments.out.join("tracks");
    let mut configuration = load(&room, &vec![("output.overlay".to_owned(), "true".to_owned())])?;
    configuration.output.directory.clone_from(&tracks);
    let mut engine = Engine::open(configuration)?;
    let outputs = engine.open_outputs()?;
    let summary = track::drive(&mut engine, outputs, &stop, arguments.quiet)?;
    if summary.outcome == Outcome::Interrupted {
        return Ok(Code::Interrupted);
    }
    let report = judge(&arguments.out, &tracks)?;
    let page = arguments.out.join(REPORT);
    std::fs::write(&page, report.html())
        .into_diagnostic()
        .wrap_err_with(|| format!("cannot write {}", page.display()))?;
    if !arguments.quiet {
        track::print(&engine, &summary);
        say::line(format_args!("beside the truth:\n{}", report.table().trim_end()));
        for camera in &simulation.world().cameras {
            let video = tracks.join(format!("{}.mp4", camera.name));
            say::line(format_args!("look at {} and {}", video.display(), page.display()));
        }
    }
    Ok(Code::Done)
}

/// Judges the tracks in a directory by the truth in another.
fn judge(truth: &Path, tracks: &Path) -> miette::Result<Report> {
    let of_truth = read(truth, Side::Truth, None).into_diagnostic()?;
    let of_tracks = read(tracks, Side::Tracks, None).into_diagnostic()?;
    let options = Options::default();
    let paired = pair("", &of_truth, &of_tracks, &options).into_diagnostic()?;
    let names = [truth, tracks].map(|path| path.display().to_string());
    Report::new(names, paired.cases, paired.notes, options).into_diagnostic()
}
