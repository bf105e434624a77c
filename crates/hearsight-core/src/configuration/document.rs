//! The text of a configuration and where each field stands in it, so that every later stage can point at the place.

use super::problem::{ConfigurationError, Problem};
use miette::NamedSource;
use std::fmt;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// The text of a configuration file with its name.
pub struct Document {
    name: String,
    text: String,
}

/// The way to a field: `camera[1].start`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Field(Vec<Step>);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Step {
    Key(String),
    Index(usize),
}

impl Field {
    /// The field of the top level.
    pub fn of(key: &str) -> Self {
        Self::default().key(key)
    }

    /// A field inside this one.
    pub fn key(&self, key: &str) -> Self {
        let mut steps = self.0.clone();
        steps.push(Step::Key(key.to_owned()));
        Self(steps)
    }

    /// An element of this list, from 0.
    pub fn index(&self, index: usize) -> Self {
        let mut steps = self.0.clone();
        steps.push(Step::Index(index));
        Self(steps)
    }
}

impl fmt::Display for Field {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, step) in self.0.iter().enumerate() {
            match step {
                Step::Key(key) if place == 0 => write!(formatter, "{key}")?,
                Step::Key(key) => write!(formatter, ".{key}")?,
                Step::Index(index) => write!(formatter, "[{index}]")?,
            }
        }
        Ok(())
    }
}

impl Document {
    /// A document from its name (as errors show it) and text.
    pub fn new(name: &str, text: &str) -> Self {
        Self {
            name: name.to_owned(),
            text: text.to_owned(),
        }
    }

    /// What errors call the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// An error at `field`: "`<file>: <field>: <what>`", pointing at the field or the nearest part of the way to it
    /// that the text has.
    pub fn error(
        &self,
        field: &Field,
        what: impl fmt::Display,
        cure: impl Into<String>,
    ) -> ConfigurationError {
        let separator = if field.0.is_empty() { "" } else { ": " };
        let message = format!("{}: {field}{separator}{what}", self.name);
        self.raw_error(message, self.span(field), Some(cure.into()))
    }

    /// An error at a known place.
    pub fn error_at(
        &self,
        span: Option<Range<usize>>,
        what: &str,
        cure: Option<String>,
    ) -> ConfigurationError {
        self.raw_error(format!("{}: {what}", self.name), span, cure)
    }

    fn raw_error(
        &self,
        message: String,
        span: Option<Range<usize>>,
        cure: Option<String>,
    ) -> ConfigurationError {
        ConfigurationError::from(Problem {
            message,
            text: NamedSource::new(&self.name, self.text.clone()).with_language("toml"),
            span: span.map(Into::into),
            cure,
        })
    }

    /// Where `field` stands, or the last part of the way to it that exists.
    fn span(&self, field: &Field) -> Option<Range<usize>> {
        let root = DeTable::parse(&self.text).ok()?;
        let mut steps = field.0.iter();
        let Some(Step::Key(first)) = steps.next() else {
            return None;
        };
        let mut value = root.get_ref().get(first.as_str())?;
        for step in steps {
            let next = match (step, value.get_ref()) {
                (Step::Key(key), DeValue::Table(table)) => table.get(key.as_str()),
                (Step::Index(index), DeValue::Array(list)) => list.get(*index),
                _ => None,
            };
            match next {
                Some(next) => value = next,
                None => break,
            }
        }
        let span = value.span();
        // A whole table would underline half of the file: its first line says enough.
        let length = self.text.get(span.clone())?.lines().next().map_or(0, str::len);
        Some(span.start..span.start + length)
    }
}

/// The known word nearest to `word`, where one is near enough to be a slip of the hand.
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|candidate| (strsim::jaro_winkler(word, candidate), candidate))
        .filter(|(likeness, _)| *likeness > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// A sentence with a suggestion where there is one, and the whole list of what is known.
pub fn suggest(word: &str, known: &[&str]) -> String {
    let list = known.join(", ");
    match nearest(word, known.iter().copied()) {
        Some(candidate) => format!("did you mean `{candidate}`? Known here: {list}"),
        None if known.is_empty() => "nothing may stand here".to_owned(),
        None => format!("known here: {list}"),
    }
}
