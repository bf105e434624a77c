//! `hearsight demo`: makes a little recording, tracks it, and says what came out beside what is true.

use super::track;
use crate::demo::{FRAMES_PER_SECOND, World, make};
use crate::exit::Code;
use crate::interrupt;
use crate::say;
use hearsight::engine::config::load;
use hearsight::engine::{Outcome, Sink, SinkError, Summary, Tick};
use hearsight::{Engine, Scene};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

/// A head this near to where a person is counts as found, pixels.
const GATE_PX: f64 = 20.0;
/// People have walked in by then, seconds.
const SETTLED_S: f64 = 3.0;

const EXAMPLES: &str = "\
Examples:
  hearsight demo                         makes hearsight-demo/ and tracks it
  hearsight demo --out /tmp/d --seconds 30
  hearsight track hearsight-demo/room.toml --out again";

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Directory for the recording and the results; made where it is missing.
    #[arg(short, long, value_name = "DIRECTORY", default_value = "hearsight-demo")]
    out: PathBuf,
    /// Length of the recording, seconds.
    #[arg(long, default_value_t = 16.0, value_parser = seconds)]
    seconds: f64,
    /// Make the recording only.
    #[arg(long)]
    only_make: bool,
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

/// Makes, tracks and prints.
pub(crate) fn run(arguments: &Arguments) -> miette::Result<Code> {
    let world = World {
        seconds: arguments.seconds,
    };
    let path = make(&world, &arguments.out)?;
    if arguments.only_make {
        say::line(format_args!("made {}", path.display()));
        return Ok(Code::Done);
    }
    let results = arguments.out.join("tracks");
    let overrides = vec![("output.overlay".to_owned(), "true".to_owned())];
    let mut room = load(&path, &overrides)?;
    room.output.directory.clone_from(&results);
    let tally = Arc::new(Mutex::new(Tally::default()));
    let judge = Judge {
        world,
        tally: Arc::clone(&tally),
    };
    let mut engine = Engine::open(room)?;
    let mut outputs = engine.open_outputs()?;
    outputs.add(Box::new(judge));
    let stop = interrupt::flag();
    let summary = track::drive(&mut engine, outputs, &stop, arguments.quiet)?;
    if !arguments.quiet {
        track::print(&engine, &summary);
        if let Ok(tally) = tally.lock() {
            tally.print();
        }
        let shown = results.join("front.mp4");
        say::line(format_args!(
            "look at {}, or run: hearsight check {}",
            shown.display(),
            path.display()
        ));
    }
    Ok(if summary.outcome == Outcome::Interrupted {
        Code::Interrupted
    } else {
        Code::Done
    })
}

/// How often the results agree with what is true.
#[derive(Default)]
struct Tally {
    people: u64,
    found: u64,
    error_px: f64,
    talking: u64,
    right: u64,
    wrong: u64,
}

/// A sink that knows the truth.
struct Judge {
    world: World,
    tally: Arc<Mutex<Tally>>,
}

impl Sink for Judge {
    fn write(&mut self, tick: Tick<'_>) -> Result<(), SinkError> {
        if let Ok(mut tally) = self.tally.lock()
            && tick.scene.time_s >= SETTLED_S
        {
            tally.add(&self.world, tick.scene);
        }
        Ok(())
    }

    fn finish(&mut self, _: &Summary) -> Result<(), SinkError> {
        Ok(())
    }
}

impl Tally {
    fn add(&mut self, world: &World, scene: &Scene) {
        for person in world.people(scene.time_s) {
            let distance = |track: &hearsight::TrackRecord| {
                let head = track.views.first()?.head;
                let (u, v) = (head.left + head.width / 2.0, head.top + head.height / 2.0);
                Some((u - person.head_px[0]).hypot(v - person.head_px[1]))
            };
            let nearest = scene
                .tracks
                .iter()
                .filter_map(|track| Some((distance(track)?, track)));
            let nearest = nearest
                .min_by(|one, other| one.0.total_cmp(&other.0))
                .filter(|(px, _)| *px < GATE_PX);
            self.people += 1;
            if let Some((error_px, _)) = nearest {
                self.found += 1;
                self.error_px += error_px;
            }
            if person.talking {
                self.talking += 1;
                match (scene.speaker, nearest) {
                    (Some(speaker), Some((_, track))) if speaker == track.id => self.right += 1,
                    (Some(_), _) => self.wrong += 1,
                    (None, _) => {}
                }
            }
        }
    }

    fn print(&self) {
        let part = |count: u64, all: u64| {
            if all > 0 {
                100.0 * count as f64 / all as f64
            } else {
                0.0
            }
        };
        let seconds = self.people as f64 / 2.0 / FRAMES_PER_SECOND;
        let error = self.error_px / self.found.max(1) as f64;
        say::line(format_args!("beside the truth, over the last {seconds:.1} s:"));
        say::line(format_args!(
            "  heads found {:.0} %, {error:.1} px off on average",
            part(self.found, self.people)
        ));
        say::line(format_args!(
            "  of the time that someone talks: the right person marked {:.0} %, a wrong one {:.0} %",
            part(self.right, self.talking),
            part(self.wrong, self.talking)
        ));
    }
}
