//! Text to raw configuration. Touches no file but the text.

use super::document::{Document, suggest};
use super::problem::ConfigurationError;
use serde::de::DeserializeOwned;
use std::ops::Range;

/// Values given from outside, such as on the command line: `("run.seed", "7")`. Later ones win.
pub type Overrides = Vec<(String, String)>;

/// Reads the text of a configuration file, with `overrides` laid over it. `name` is what errors call the file.
///
/// # Errors
/// [`ConfigurationError`] where the text is not TOML, a key is unknown, a value has the wrong type, or an override
/// names no field.
pub fn parse<Raw: DeserializeOwned>(
    name: &str,
    text: &str,
    overrides: &Overrides,
) -> Result<Raw, ConfigurationError> {
    let document = Document::new(name, text);
    let raw: Raw = toml::from_str(text).map_err(|error| explain(&document, &error))?;
    if overrides.is_empty() {
        return Ok(raw);
    }
    let mut table: toml::Table = toml::from_str(text).map_err(|error| explain(&document, &error))?;
    for (key, value) in overrides {
        set(&mut table, key, parse_value(value)).map_err(|what| at_override(key, value, &what, None))?;
        // Each at once, so that an error is blamed on the right one.
        if let Err(error) = table.clone().try_into::<Raw>() {
            let (what, cure) = explain_message(error.message());
            return Err(at_override(key, value, &what, cure));
        }
    }
    table.try_into().map_err(|error| explain(&document, &error))
}

/// A TOML value where it is one, otherwise the text as a string: `--set run.seed=7` and `--set system.name=stac` both
/// work without quotes in quotes.
fn parse_value(text: &str) -> toml::Value {
    toml::from_str::<toml::Table>(&format!("value = {text}"))
        .ok()
        .and_then(|mut table| table.remove("value"))
        .unwrap_or_else(|| toml::Value::String(text.to_owned()))
}

/// Puts `value` at the dotted `key`; a number picks an element of a list, a name the sensor called so.
fn set(table: &mut toml::Table, key: &str, value: toml::Value) -> Result<(), String> {
    let mut steps: Vec<&str> = key.split('.').collect();
    let Some(last) = steps.pop().filter(|last| !last.is_empty()) else {
        return Err("the key is empty".to_owned());
    };
    let mut at = table;
    let mut steps = steps.into_iter().peekable();
    while let Some(step) = steps.next() {
        let entry = at
            .entry(step)
            .or_insert_with(|| toml::Value::Table(toml::Table::new()));
        at = match entry {
            toml::Value::Table(inner) => inner,
            toml::Value::Array(list) => {
                let which = steps
                    .next()
                    .ok_or_else(|| format!("`{step}` is a list: name one, as in `{step}.0.{last}`"))?;
                element(list, which).ok_or_else(|| format!("`{step}` has no element `{which}`"))?
            }
            _ => return Err(format!("`{step}` is a value, not a table")),
        };
    }
    at.insert(last.to_owned(), value);
    Ok(())
}

fn element<'a>(list: &'a mut [toml::Value], which: &str) -> Option<&'a mut toml::Table> {
    let place = match which.parse::<usize>() {
        Ok(place) => place,
        Err(_) => list
            .iter()
            .position(|entry| entry.get("name").and_then(toml::Value::as_str) == Some(which))?,
    };
    list.get_mut(place)?.as_table_mut()
}

fn at_override(key: &str, value: &str, what: &str, cure: Option<String>) -> ConfigurationError {
    let document = Document::new("--set", &format!("{key}={value}"));
    document.error_at(Some(0..key.len()), &format!("{key}={value}: {what}"), cure)
}

fn explain(document: &Document, error: &toml::de::Error) -> ConfigurationError {
    let (what, cure) = explain_message(error.message());
    document.error_at(error.span().map(|span| clip(document.text(), span)), &what, cure)
}

fn clip(text: &str, span: Range<usize>) -> Range<usize> {
    let length = text
        .get(span.clone())
        .and_then(|part| part.lines().next())
        .map_or(0, str::len);
    span.start..span.start + length
}

/// What people call the types of the language.
const TYPES: [(&str, &str); 5] = [
    ("f64", "a number"),
    ("a boolean", "true or false"),
    ("usize", "a whole number"),
    ("u32", "a whole number"),
    ("u64", "a whole number"),
];

/// What serde says of an unknown field, in our words and with a suggestion.
fn explain_message(message: &str) -> (String, Option<String>) {
    let message = message.trim();
    for (start, kind) in [("unknown field `", "key"), ("unknown variant `", "value")] {
        let Some(rest) = message.find(start).and_then(|at| message.get(at + start.len()..)) else {
            continue;
        };
        let mut words = rest.split('`');
        let Some(word) = words.next() else { continue };
        let known: Vec<&str> = words.skip(1).step_by(2).collect();
        return (format!("unknown {kind} `{word}`"), Some(suggest(word, &known)));
    }
    let mut message = message.lines().collect::<Vec<_>>().join(" ");
    for (type_name, words) in TYPES {
        if let Some(start) = message.strip_suffix(&format!("expected {type_name}")) {
            message = format!("{start}expected {words}");
        }
    }
    (message, None)
}
