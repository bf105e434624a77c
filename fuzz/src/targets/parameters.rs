//! Parameters of systems, as the table `[system.stac]` of a `room.toml` gives them.

use super::state::{moment, room};
use super::{Target, Verdict, texts};
use hearsight_core::finite::is_finite;
use hearsight_core::record::Scene;
use hearsight_systems::{REGISTRY, build};
use serde_json::Value;

pub(super) const TARGET: Target = Target {
    name: "parameters",
    meaning: "Parameters of the system stac as JSON; what is not refused can run.",
    text: true,
    words: &[
        "null",
        "true",
        "false",
        "{}",
        "[]",
        "\"plain\"",
        "\"phat\"",
        "\"magnitude\"",
        "-",
        "e9",
        "e-9",
        "0",
    ],
    longest: 16 << 10,
    seeds: || {
        let mut seeds = vec![super::state::parameters(), serde_json::json!({})];
        // Every default that the parameters tell of themselves.
        let stac = REGISTRY.iter().filter(|system| system.name == "stac");
        seeds.extend(stac.map(|system| defaults(&(system.parameters)())));
        let mut seeds: Vec<Vec<u8>> = seeds
            .iter()
            .map(|value| format!("{value:#}").into_bytes())
            .collect();
        seeds.extend(texts(&[
            include_str!("../../seeds/went-wrong/parameters/endless-heads.json"),
            include_str!("../../seeds/went-wrong/parameters/frame-of-hours.json"),
            include_str!("../../seeds/went-wrong/parameters/frame-overflows.json"),
        ]));
        seeds
    },
    open: || {
        let room = room();
        let moments: Vec<_> = (0..12).map(moment).collect();
        Box::new(move |bytes| {
            let Ok(parameters) = serde_json::from_slice::<Value>(bytes) else {
                return Verdict::Refused("no JSON".to_owned());
            };
            let mut system = match build("stac", &parameters, &room, 1) {
                Ok(system) => system,
                Err(error) => return Verdict::Refused(error.to_string()),
            };
            let mut scene = Scene::default();
            for moment in &moments {
                system.step(moment, &mut scene);
            }
            if !is_finite(&scene) {
                return Verdict::Broken("a number in the scene is not finite".to_owned());
            }
            match serde_json::to_string(&scene) {
                Ok(_) => Verdict::Read(format!(
                    "{} tracks, {} sounds",
                    scene.tracks.len(),
                    scene.sounds.len()
                )),
                Err(error) => Verdict::Broken(format!("the scene cannot be written: {error}")),
            }
        })
    },
};

/// The defaults in a JSON schema.
fn defaults(schema: &Value) -> Value {
    let properties = schema.get("properties").and_then(Value::as_object);
    let entries = properties.into_iter().flatten();
    entries
        .filter_map(|(name, property)| Some((name.clone(), property.get("default")?.clone())))
        .collect()
}
