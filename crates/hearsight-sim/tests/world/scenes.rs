//! The scenarios that come with the program.

use hearsight_core::configuration::Overrides;
use hearsight_sim::scenario::{load, scenario_schema};
use std::path::Path;

fn scenes() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

#[test]
fn every_scene_resolves_and_repeats() {
    let mut count = 0;
    for entry in std::fs::read_dir(scenes()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let world = load(&path, &Overrides::new()).unwrap_or_else(|error| panic!("{error}"));
        let again = load(&path, &Overrides::new()).unwrap();
        assert!(!world.cameras.is_empty(), "{path:?}");
        // Scenes of pictures alone are silent.
        let talks = world.people.iter().any(|person| !person.turns.is_empty());
        assert!(talks || world.arrays.is_empty(), "{path:?}");
        for person in 0..world.people.len() {
            for step in 0..50 {
                let time = f64::from(step) * 0.37;
                assert_eq!(world.posture(person, time), again.posture(person, time));
            }
        }
        count += 1;
    }
    assert!(count >= 4, "{count}");
}

#[test]
fn another_seed_makes_other_people_of_the_same_names() {
    let path = scenes().join("meeting.toml");
    let overrides = vec![("seed".to_owned(), "77".to_owned())];
    let (one, other) = (
        load(&path, &Overrides::new()).unwrap(),
        load(&path, &overrides).unwrap(),
    );
    for (one, other) in one.people.iter().zip(&other.people) {
        assert_eq!(one.name, other.name);
        assert_ne!(one.looks.seed, other.looks.seed);
        assert_ne!(one.turns, other.turns);
    }
}

#[test]
fn the_schema_describes_every_key() {
    fn describe(value: &serde_json::Value, path: &str) {
        if let Some(properties) = value.get("properties").and_then(serde_json::Value::as_object) {
            for (key, property) in properties {
                let described = property["description"]
                    .as_str()
                    .is_some_and(|text| !text.is_empty());
                assert!(described, "{path}.{key} has no description: {property}");
            }
        }
    }
    let schema = scenario_schema();
    describe(&schema, "");
    for (name, definition) in schema["$defs"].as_object().unwrap() {
        describe(definition, name);
    }
}
