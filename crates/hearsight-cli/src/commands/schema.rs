//! `hearsight schema`: what files look like, generated from the types.

use crate::exit::Code;
use crate::say;
use hearsight::core::record::scene_schema;
use hearsight::core::truth::truth_schema;
use hearsight::engine::config::room_schema;
use hearsight::sim::scenario::scenario_schema;
use hearsight::systems::REGISTRY;
use miette::{IntoDiagnostic, miette};

const EXAMPLES: &str = "\
Examples:
  hearsight schema > scene.schema.json     a line of scenes.jsonl
  hearsight schema room                    room.toml, with meaning, unit and default of each key
  hearsight schema scenario                scene.toml, from which `hearsight simulate` makes a room
  hearsight schema truth                   a line of truth.jsonl, what a simulation knows
  hearsight schema stac                    the parameters of [system.stac]";

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// `scene`, `room`, `scenario`, `truth`, or the name of a system.
    #[arg(default_value = "scene")]
    of: String,
}

/// Prints.
pub(crate) fn run(arguments: &Arguments) -> miette::Result<Code> {
    let schema = match arguments.of.as_str() {
        "scene" => scene_schema(),
        "room" => room_schema(),
        "scenario" => scenario_schema(),
        "truth" => truth_schema(),
        name => match REGISTRY.iter().find(|system| system.name == name) {
            Some(system) => (system.parameters)(),
            None => {
                let systems: Vec<&str> = REGISTRY.iter().map(|system| system.name).collect();
                return Err(miette!(
                    help = format!("known are scene, room, scenario, truth, {}", systems.join(", ")),
                    "there is no schema of `{name}`"
                ));
            }
        },
    };
    say::line(format_args!(
        "{}",
        serde_json::to_string_pretty(&schema).into_diagnostic()?
    ));
    Ok(Code::Done)
}
