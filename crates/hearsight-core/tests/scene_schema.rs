//! The scene record against its own schema: every variant is written, validated and read back unchanged.
//!
//! The validator knows the few keywords that the generated schema uses and fails on any other, so that a schema that
//! grows is never silently half checked.

use hearsight_core::moment::{Fault, FaultKind};
use hearsight_core::record::{
    BoxRecord, SCENE_SCHEMA_VERSION, Scene, SoundRecord, TrackPhase, TrackRecord, ViewRecord, scene_schema,
};
use serde_json::{Value, json};

const ANNOTATIONS: &[&str] = &["$schema", "$defs", "title", "description", "default", "format"];

/// What is wrong with `value`, or nothing.
fn validate(root: &Value, schema: &Value, value: &Value, path: &str) -> Result<(), String> {
    let Some(keywords) = schema.as_object() else {
        return if schema == true {
            Ok(())
        } else {
            Err(format!("{path}: nothing is allowed here"))
        };
    };
    for (keyword, rule) in keywords {
        let problem = |what: &str| Err(format!("{path}: {value} {what} {rule}"));
        match keyword.as_str() {
            "$ref" => {
                let target = rule
                    .as_str()
                    .and_then(|reference| root.pointer(reference.trim_start_matches('#')));
                validate(
                    root,
                    target.ok_or(format!("{path}: {rule} leads nowhere"))?,
                    value,
                    path,
                )?;
            }
            "type" if !is_of_type(rule, value) => return problem("is not of type"),
            "type" => {}
            "properties" => {
                for (key, rule) in rule.as_object().into_iter().flatten() {
                    if let Some(field) = value.get(key) {
                        validate(root, rule, field, &format!("{path}.{key}"))?;
                    }
                }
                for key in value.as_object().into_iter().flatten().map(|(key, _)| key) {
                    rule.get(key)
                        .ok_or(format!("{path}.{key} is not in the schema"))?;
                }
            }
            "required" => {
                for key in rule.as_array().into_iter().flatten().filter_map(Value::as_str) {
                    value.get(key).ok_or(format!("{path}.{key} is missing"))?;
                }
            }
            "items" => {
                for (index, item) in value.as_array().into_iter().flatten().enumerate() {
                    validate(root, rule, item, &format!("{path}[{index}]"))?;
                }
            }
            "minItems"
                if value
                    .as_array()
                    .is_some_and(|a| (a.len() as u64) < rule.as_u64().unwrap_or(0)) =>
            {
                return problem("has fewer items than");
            }
            "maxItems"
                if value
                    .as_array()
                    .is_some_and(|a| a.len() as u64 > rule.as_u64().unwrap_or(0)) =>
            {
                return problem("has more items than");
            }
            "minimum" if value.is_number() && value.as_f64() < rule.as_f64() => return problem("is below"),
            "minItems" | "maxItems" | "minimum" => {}
            "const" if value != rule => return problem("is not"),
            "enum" if !rule.as_array().is_some_and(|options| options.contains(value)) => {
                return problem("is none of");
            }
            "const" | "enum" => {}
            "anyOf" | "oneOf" => {
                let fits = |rule: &&Value| validate(root, rule, value, path).is_ok();
                let count = rule
                    .as_array()
                    .map_or(0, |rules| rules.iter().filter(fits).count());
                if count == 0 || (keyword == "oneOf" && count > 1) {
                    return problem("does not fit");
                }
            }
            other if ANNOTATIONS.contains(&other) => {}
            other => return Err(format!("{path}: this validator does not know `{other}`")),
        }
    }
    Ok(())
}

fn is_of_type(rule: &Value, value: &Value) -> bool {
    match rule {
        Value::Array(rules) => rules.iter().any(|rule| is_of_type(rule, value)),
        _ => match rule.as_str().unwrap_or_default() {
            "null" => value.is_null(),
            "boolean" => value.is_boolean(),
            "integer" => value.is_i64() || value.is_u64(),
            "number" => value.is_number(),
            "string" => value.is_string(),
            "array" => value.is_array(),
            "object" => value.is_object(),
            _ => false,
        },
    }
}

/// A scene in which every field is set, and one in which every optional field is not.
fn scenes() -> [Scene; 2] {
    let view = ViewRecord {
        camera: "door".into(),
        frame: 7,
        head: BoxRecord {
            left: 0.1,
            top: 20.0,
            width: 1.0 / 3.0,
            height: 40.0,
        },
        deviation_px: [1.5, 2.5],
    };
    let track = |phase, full: bool| TrackRecord {
        id: u64::MAX,
        phase,
        existence: 0.99,
        views: if full { vec![view.clone()] } else { vec![] },
        position_m: full.then_some([0.1, -2.0, 1e-300]),
        deviation_m: full.then_some([0.1, 0.2, 0.3]),
        speaking: full,
        speaking_probability: full.then_some(0.75),
        effective_sample_size: 120.5,
    };
    let sound = |full: bool| SoundRecord {
        array: "table".into(),
        delay_s: -1.25e-4,
        column_px: full.then_some(101.5),
        signal_to_noise_db: 12.0,
        from_onset: true,
        position_m: full.then_some([1.0, 2.0, 1.5]),
        deviation_m: full.then_some([0.1, 0.7, 0.3]),
        track: full.then_some(1),
    };
    let kinds = [
        FaultKind::Gap,
        FaultKind::Duplicate,
        FaultKind::Corrupt,
        FaultKind::EndedEarly,
        FaultKind::Dropped,
        FaultKind::NonFinite,
        FaultKind::Lost,
    ];
    let fault = |kind| Fault {
        sensor: "door".into(),
        time_s: 1.0,
        kind,
        detail: "\u{e9}\"\n".into(),
    };
    let scene = |full: bool| Scene {
        schema: SCENE_SCHEMA_VERSION.into(),
        tick: 3,
        time_s: 13.12,
        tracks: vec![
            track(TrackPhase::Visible, full),
            track(TrackPhase::Occluded, full),
        ],
        sounds: vec![sound(full)],
        speaker: full.then_some(1),
        nobody_probability: full.then_some(0.125),
        last_speaker: full.then_some(1),
        faults: if full { kinds.map(fault).to_vec() } else { vec![] },
    };
    [scene(true), scene(false)]
}

#[test]
fn scenes_fit_their_schema_and_come_back_unchanged() {
    let schema = scene_schema();
    for scene in scenes() {
        let line = serde_json::to_string(&scene).unwrap();
        assert!(!line.contains('\n'), "a scene is one line");
        let written: Value = serde_json::from_str(&line).unwrap();
        validate(&schema, &schema, &written, "scene").unwrap();
        assert_eq!(serde_json::from_str::<Scene>(&line).unwrap(), scene);
    }
}

#[test]
fn the_schema_refuses_what_is_no_scene() {
    let schema = scene_schema();
    let good = serde_json::to_value(&scenes()[0]).unwrap();
    for (place, bad) in [
        ("/tick", json!("3")),
        ("/time_s", json!(null)),
        ("/tracks/0/phase", json!("asleep")),
        ("/tracks/0/position_m", json!([1.0, 2.0])),
        ("/tracks/0/views/0/head", json!({"left": 1.0})),
        ("/faults/0/kind", json!("Gap")),
    ] {
        let mut value = good.clone();
        *value.pointer_mut(place).unwrap() = bad;
        assert!(validate(&schema, &schema, &value, "scene").is_err(), "{place}");
        assert!(serde_json::from_value::<Scene>(value).is_err(), "{place}");
    }
}

#[test]
fn every_field_says_what_it_means() {
    let schema = scene_schema();
    let mut types: Vec<&Value> = vec![&schema];
    types.extend(schema["$defs"].as_object().unwrap().values());
    for one in types {
        for (key, field) in one["properties"].as_object().into_iter().flatten() {
            assert!(
                field["description"].is_string(),
                "{key} has no description in {}",
                one["title"]
            );
        }
    }
}
