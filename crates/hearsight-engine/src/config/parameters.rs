//! Parameters of systems against the schemas that the systems publish: names and types, with the place in the text.
//!
//! Whether a value is in range is the system's own to judge; it does not know where in the file it stands.

use hearsight_core::configuration::ConfigurationError;
use hearsight_core::configuration::{Document, Field, suggest};
use serde_json::Value;

/// Checks values against one schema.
pub(super) struct Checker<'a> {
    document: &'a Document,
    schema: Value,
}

impl<'a> Checker<'a> {
    pub(super) fn new(document: &'a Document, schema: Value) -> Self {
        Self { document, schema }
    }

    /// Refuses names that are unknown and values of another type.
    pub(super) fn check(&self, field: &Field, value: &Value) -> Result<(), ConfigurationError> {
        self.check_part(field, value, &self.schema)
    }

    /// The value with the defaults that the schema has for what is not given.
    pub(super) fn with_defaults(&self, given: &Value) -> Value {
        let mut all = serde_json::Map::new();
        for (key, property) in self
            .schema
            .get("properties")
            .and_then(Value::as_object)
            .into_iter()
            .flatten()
        {
            all.extend(
                property
                    .get("default")
                    .map(|default| (key.clone(), default.clone())),
            );
        }
        let mut all = Value::Object(all);
        lay_over(&mut all, given);
        all
    }

    fn check_part(&self, field: &Field, value: &Value, schema: &Value) -> Result<(), ConfigurationError> {
        let schema = self.follow(schema);
        if let Some(wanted) = types(schema)
            && !wanted.iter().any(|kind| is_of(kind, value))
        {
            let what = format!("is {value}, not {}", describe(&wanted));
            return Err(self.document.error(field, what, meaning(schema)));
        }
        let properties = schema.get("properties").and_then(Value::as_object);
        if let (Some(properties), Some(table)) = (properties, value.as_object()) {
            for (key, value) in table {
                let Some(property) = properties.get(key) else {
                    let known: Vec<&str> = properties.keys().map(String::as_str).collect();
                    let what = format!("there is no parameter `{key}`");
                    return Err(self.document.error(&field.key(key), what, suggest(key, &known)));
                };
                self.check_part(&field.key(key), value, property)?;
            }
        }
        if let (Some(items), Some(list)) = (schema.get("items"), value.as_array()) {
            for (place, value) in list.iter().enumerate() {
                self.check_part(&field.index(place), value, items)?;
            }
        }
        Ok(())
    }

    /// The definition that a reference names.
    fn follow<'s>(&'s self, schema: &'s Value) -> &'s Value {
        let reference = schema.get("$ref").and_then(Value::as_str);
        let definition = reference.and_then(|reference| self.schema.pointer(reference.strip_prefix('#')?));
        definition.unwrap_or(schema)
    }
}

/// Lays tables over tables; anything else replaces what was there.
fn lay_over(under: &mut Value, over: &Value) {
    match (under, over) {
        (Value::Object(under), Value::Object(over)) => {
            for (key, value) in over {
                lay_over(under.entry(key).or_insert(Value::Null), value);
            }
        }
        (under, over) => *under = over.clone(),
    }
}

/// The types that a schema allows, where it says so.
fn types(schema: &Value) -> Option<Vec<&str>> {
    match schema.get("type")? {
        Value::String(kind) => Some(vec![kind]),
        Value::Array(kinds) => Some(kinds.iter().filter_map(Value::as_str).collect()),
        _ => None,
    }
}

fn is_of(kind: &str, value: &Value) -> bool {
    match kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "null" => value.is_null(),
        _ => true,
    }
}

fn describe(kinds: &[&str]) -> String {
    let words = kinds
        .iter()
        .filter(|kind| **kind != "null")
        .map(|kind| match *kind {
            "object" => "a table",
            "array" => "a list",
            "string" => "text",
            "boolean" => "true or false",
            "integer" => "a whole number",
            "number" => "a number",
            other => other,
        });
    words.collect::<Vec<_>>().join(" or ")
}

/// What the schema says of the parameter, as the cure.
fn meaning(schema: &Value) -> String {
    let description = schema
        .get("description")
        .and_then(Value::as_str)
        .unwrap_or("see `hearsight schema`");
    description.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn problem(value: &Value) -> Option<String> {
        let document = Document::new("room.toml", "");
        let schema = json!({
            "properties": {
                "particles": {"type": "integer", "description": "How many."},
                "bands": {"type": "array", "items": {"type": "number"}},
                "sound": {"$ref": "#/$defs/Sound"},
                "limit": {"type": ["number", "null"]},
            },
            "$defs": {"Sound": {"type": "object", "properties": {"plain": {"type": "boolean"}}}},
        });
        Checker::new(&document, schema)
            .check(&Field::of("system"), value)
            .err()
            .map(|error| error.to_string())
    }

    #[test]
    fn defaults_stand_for_what_is_not_given() {
        let document = Document::new("room.toml", "");
        let schema =
            json!({"properties": {"a": {"default": 1}, "b": {"default": {"c": 2, "d": 3}}, "e": {}}});
        let all = Checker::new(&document, schema).with_defaults(&json!({"b": {"d": 4}}));
        assert_eq!(all, json!({"a": 1, "b": {"c": 2, "d": 4}}));
    }

    #[test]
    fn names_and_types_are_checked_at_every_depth() {
        let good = json!({"particles": 3, "bands": [1, 2.5], "sound": {"plain": true}, "limit": null});
        assert_eq!(problem(&good), None);
        for (bad, place) in [
            (json!({"particle": 3}), "system.particle:"),
            (
                json!({"particles": "many"}),
                "system.particles: is \"many\", not a whole number",
            ),
            (json!({"particles": 2.5}), "system.particles:"),
            (
                json!({"bands": [1, true]}),
                "system.bands[1]: is true, not a number",
            ),
            (json!({"sound": {"plan": true}}), "system.sound.plan:"),
            (
                json!({"sound": {"plain": 1}}),
                "system.sound.plain: is 1, not true or false",
            ),
            (json!({"limit": "none"}), "system.limit:"),
        ] {
            let message = problem(&bad).unwrap();
            assert!(message.contains(place), "{message}");
        }
    }
}
