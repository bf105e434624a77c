//! Text to a tree, whatever its syntax: JSON, YAML (with the oddities of OpenCV's) or TOML.
//!
//! Formats read the tree through [`super::node::Node`] and never see the syntax. Bounds on size
//! and nesting are set here, so that no text, however made, can exhaust the memory or the stack.

use super::error::CalibrationError;
use saphyr::{LoadableYamlNode, Scalar, Yaml};
use serde_json::{Map, Number, Value};
use std::path::Path;

/// Largest file looked at, bytes; a calibration has a few thousand.
pub(super) const LARGEST_FILE_BYTES: usize = 1 << 20;
/// Columns by which a YAML line may be indented, and block collections that it may open: they bound the nesting.
const DEEPEST_INDENTATION: usize = 128;
const MOST_INDICATORS: usize = 64;

/// How a text is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Syntax {
    Json,
    Yaml,
    Toml,
}

/// The tree of a text. Its syntax is told by its beginning, then by the extension of `file`.
pub(super) fn parse(text: &str, file: &Path) -> Result<Value, CalibrationError> {
    let error = |syntax, detail: String, cure: &str| CalibrationError::Syntax {
        file: file.to_owned(),
        syntax,
        detail,
        cure: cure.to_owned(),
    };
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.len() > LARGEST_FILE_BYTES {
        return Err(too_large(file, text.len() as u64));
    }
    if text.trim_start().starts_with('<') {
        let cure = "write it with cv::FileStorage to a name that ends in .yaml or .json";
        return Err(error("JSON, YAML or TOML", "it is XML".into(), cure));
    }
    let tree = match syntax(text, file) {
        Syntax::Json => serde_json::from_str(text).map_err(|e| {
            error(
                "JSON",
                e.to_string(),
                "correct it there, or export the calibration again",
            )
        })?,
        Syntax::Toml => ::toml::from_str::<::toml::Table>(text)
            .map(|table| from_toml(::toml::Value::Table(table)))
            .map_err(|e| error("TOML", e.to_string(), "correct it there"))?,
        Syntax::Yaml => from_yaml_text(text).map_err(|detail| {
            error(
                "YAML",
                detail,
                "correct it there, or export the calibration again",
            )
        })?,
    };
    if tree.as_object().is_some_and(|fields| !fields.is_empty()) {
        return Ok(tree);
    }
    let cure = "a calibration starts with named fields such as `camera_matrix`";
    Err(error("calibration", "it has no named fields".into(), cure))
}

pub(super) fn too_large(file: &Path, bytes: u64) -> CalibrationError {
    CalibrationError::Format {
        file: file.to_owned(),
        detail: format!("{bytes} bytes are no calibration: more than {LARGEST_FILE_BYTES}"),
        cure: "keep images and board views out of the file".into(),
    }
}

fn syntax(text: &str, file: &Path) -> Syntax {
    let start = text.trim_start();
    if start.starts_with('{') {
        return Syntax::Json;
    }
    if start.starts_with("%YAML") || start.starts_with("---") {
        return Syntax::Yaml;
    }
    let extension = file
        .extension()
        .and_then(|extension| extension.to_str())
        .map(str::to_ascii_lowercase);
    match extension.as_deref() {
        Some("json") => Syntax::Json,
        Some("yaml" | "yml") => Syntax::Yaml,
        Some("toml") => Syntax::Toml,
        _ if ::toml::from_str::<::toml::Table>(text).is_ok() => Syntax::Toml,
        _ => Syntax::Yaml,
    }
}

/// JSON has no numbers that are not finite; as text they stay visible in the message that refuses them.
fn number(value: f64) -> Value {
    Number::from_f64(value).map_or_else(|| Value::String(value.to_string()), Value::Number)
}

fn from_toml(value: ::toml::Value) -> Value {
    match value {
        ::toml::Value::String(text) => Value::String(text),
        ::toml::Value::Integer(integer) => integer.into(),
        ::toml::Value::Float(float) => number(float),
        ::toml::Value::Boolean(boolean) => boolean.into(),
        ::toml::Value::Datetime(time) => Value::String(time.to_string()),
        ::toml::Value::Array(items) => items.into_iter().map(from_toml).collect(),
        ::toml::Value::Table(table) => Value::Object(
            table
                .into_iter()
                .map(|(key, value)| (key, from_toml(value)))
                .collect(),
        ),
    }
}

fn from_yaml_text(text: &str) -> Result<Value, String> {
    // OpenCV writes "%YAML:1.0", which is not the directive that YAML knows.
    let text = match text.trim_start().strip_prefix("%YAML:") {
        Some(rest) => rest.split_once(['\n', '\r']).map_or("", |(_, rest)| rest),
        None => text,
    };
    check_nesting(text)?;
    let documents = Yaml::load_from_str(text).map_err(|e| e.to_string())?;
    documents
        .into_iter()
        .next()
        .map_or(Err("it is empty".into()), from_yaml)
}

/// Refuses text that nests deeper than a calibration can.
///
/// A block collection starts either at the first column of a line that is not blank, further right than the one
/// around it, or behind an indicator (`-`, `?`, `:` and a blank). So the deepest indentation and the most indicators
/// in a line bound the nesting of blocks; that of `[` and `{` the parser bounds by itself. Aliases could multiply
/// both, and no calibration needs them.
fn check_nesting(text: &str) -> Result<(), String> {
    for (number, line) in text.split(['\n', '\r']).enumerate() {
        let number = number + 1;
        let indentation = line.len() - line.trim_start().len();
        if indentation > DEEPEST_INDENTATION {
            return Err(format!(
                "line {number} is indented by {indentation} columns, more than {DEEPEST_INDENTATION}"
            ));
        }
        let bytes = line.as_bytes();
        let blank = |at: usize| bytes.get(at).is_none_or(|byte| matches!(byte, b' ' | b'\t'));
        let indicators =
            (0..bytes.len()).filter(|&at| matches!(bytes[at], b'-' | b'?' | b':') && blank(at + 1));
        if indicators.count() > MOST_INDICATORS {
            return Err(format!(
                "line {number} opens more than {MOST_INDICATORS} collections"
            ));
        }
        let opens =
            |at: usize| at == 0 || matches!(bytes[at - 1], b' ' | b'\t' | b'[' | b'{' | b',' | b':' | b'-');
        if (0..bytes.len()).any(|at| bytes[at] == b'*' && opens(at) && !blank(at + 1)) {
            return Err(format!(
                "line {number} refers to another place with `*`: write the value out"
            ));
        }
    }
    Ok(())
}

fn from_yaml(value: Yaml<'_>) -> Result<Value, String> {
    Ok(match value {
        Yaml::Value(Scalar::Null) => Value::Null,
        Yaml::Value(Scalar::Boolean(boolean)) => boolean.into(),
        Yaml::Value(Scalar::Integer(integer)) => integer.into(),
        Yaml::Value(Scalar::FloatingPoint(float)) => number(float.into_inner()),
        Yaml::Value(Scalar::String(text)) => Value::String(text.into_owned()),
        Yaml::Sequence(items) => items.into_iter().map(from_yaml).collect::<Result<_, _>>()?,
        Yaml::Mapping(mapping) => {
            let mut object = Map::new();
            for (key, value) in mapping {
                let key = match from_yaml(key)? {
                    Value::String(text) => text,
                    other => other.to_string(),
                };
                object.insert(key, from_yaml(value)?);
            }
            Value::Object(object)
        }
        Yaml::Tagged(_, inner) => from_yaml(*inner)?,
        Yaml::Representation(text, ..) => Value::String(text.into_owned()),
        Yaml::Alias(_) | Yaml::BadValue => return Err("a value does not fit its tag".into()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opencv_yaml_is_read_with_its_odd_header_and_tags() {
        let text =
            "%YAML:1.0\n---\nK: !!opencv-matrix\n   rows: 1\n   cols: 2\n   dt: d\n   data: [ 500., .Nan ]\n";
        let tree = parse(text, Path::new("a.yml")).unwrap();
        assert_eq!(tree["K"]["data"][0], 500.0);
        assert!(tree["K"]["data"][1].is_string());
        // OpenCV 2 wrote no "---".
        assert_eq!(
            parse("%YAML:1.0\nwidth: 640\n", Path::new("")).unwrap()["width"],
            640
        );
    }

    #[test]
    fn the_syntax_is_told_by_the_beginning_before_the_extension() {
        for (text, file) in [
            ("{\"a\": 1}", "a.yaml"),
            ("a = 1", "a.txt"),
            ("a: 1", "a"),
            ("\u{feff}a: 1", "a.yml"),
        ] {
            assert_eq!(parse(text, Path::new(file)).unwrap()["a"], 1, "{text}");
        }
        for text in ["", "[1, 2]", "text", "<opencv_storage/>", "{", "a: *b", "\0"] {
            assert!(parse(text, Path::new("a")).is_err(), "{text:?}");
        }
    }

    #[test]
    fn nothing_nests_so_deep_that_the_stack_ends() {
        let many = 100_000;
        let stairs: String = (0..700)
            .map(|depth| format!("{}a:\n", " ".repeat(depth)))
            .collect();
        let widest: String = (0..=DEEPEST_INDENTATION)
            .map(|depth| format!("{0}a:\n{0}-\n", " ".repeat(depth)))
            .collect();
        for text in [
            "[".repeat(many),
            "{a: ".repeat(many),
            "- ".repeat(many),
            "-\t".repeat(many),
            "? ".repeat(many),
            "!a - ".repeat(many),
            "{\"a\":".repeat(many),
            "a = ".to_owned() + &"[".repeat(many),
            "a.".repeat(many) + "b = 1",
            stairs,
            widest + &"- ".repeat(MOST_INDICATORS) + &"[".repeat(250),
            "a".repeat(LARGEST_FILE_BYTES + 1),
        ] {
            for file in ["a.yaml", "a.toml", "a.json", "a"] {
                assert!(parse(&text, Path::new(file)).is_err(), "{}", &text[..10]);
            }
        }
    }
}
