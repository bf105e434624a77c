//! Rows of CSV with names for their columns, and numbers out of them.

use super::{ReadError, Source};
use csv::{ByteRecord, ReaderBuilder, Trim};

/// Largest number of a frame or person: whole numbers up to here are exact.
const MOST: f64 = 9_007_199_254_740_992.0;

/// Rows of a file in turn.
pub(super) struct Rows<'a> {
    source: &'a Source<'a>,
    reader: csv::Reader<&'a [u8]>,
    record: ByteRecord,
    columns: Vec<String>,
}

/// A row in hand.
pub(super) struct Row<'r> {
    source: &'r Source<'r>,
    record: &'r ByteRecord,
    columns: &'r [String],
    pub(super) line: u64,
}

impl<'a> Rows<'a> {
    /// A file whose first row names the columns.
    pub(super) fn with_header(source: &'a Source<'a>) -> Result<Self, ReadError> {
        let mut rows = Self::new(source, Vec::new());
        let first = rows.next()?.map(|row| {
            let fields = row.record.iter();
            let text = |field| String::from_utf8_lossy(field).trim().to_ascii_lowercase();
            fields.map(text).collect()
        });
        rows.columns = first.unwrap_or_default();
        Ok(rows)
    }

    /// A file without a header; `columns` are names for messages.
    pub(super) fn without_header(source: &'a Source<'a>, columns: &[&str]) -> Self {
        Self::new(source, columns.iter().map(|name| (*name).to_owned()).collect())
    }

    fn new(source: &'a Source<'a>, columns: Vec<String>) -> Self {
        let reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .quoting(false)
            .trim(Trim::None)
            .from_reader(source.bytes);
        Self {
            source,
            reader,
            record: ByteRecord::new(),
            columns,
        }
    }

    /// The place of a column.
    pub(super) fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }

    /// The place of a column that must be there.
    pub(super) fn needed(&self, name: &str) -> Result<usize, ReadError> {
        self.column(name).ok_or_else(|| ReadError::Syntax {
            file: self.source.path.to_owned(),
            line: 1,
            detail: format!("there is no column `{name}`"),
            cure: "name the columns in the first line".to_owned(),
        })
    }

    /// Names of the columns.
    pub(super) fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The next row that is not empty.
    pub(super) fn next(&mut self) -> Result<Option<Row<'_>>, ReadError> {
        loop {
            let found = self.reader.read_byte_record(&mut self.record);
            let line = self.record.position().map_or(0, csv::Position::line);
            let good = found.map_err(|error| ReadError::Syntax {
                file: self.source.path.to_owned(),
                line,
                detail: error.to_string(),
                cure: "correct the row".to_owned(),
            })?;
            if !good {
                return Ok(None);
            }
            if self.record.iter().any(|field| !field.trim_ascii().is_empty()) {
                return Ok(Some(Row {
                    source: self.source,
                    record: &self.record,
                    columns: &self.columns,
                    line,
                }));
            }
        }
    }
}

impl Row<'_> {
    /// Number of fields.
    pub(super) fn len(&self) -> usize {
        self.record.len()
    }

    /// The text of a field; empty where the row is too short.
    pub(super) fn text(&self, place: usize) -> &[u8] {
        self.record.get(place).unwrap_or_default().trim_ascii()
    }

    /// A number, perhaps not finite.
    pub(super) fn number(&self, place: usize) -> Result<f64, ReadError> {
        let text = std::str::from_utf8(self.text(place)).ok();
        text.and_then(|text| text.parse().ok())
            .ok_or_else(|| self.invalid(place, "it must be a number; correct the row"))
    }

    /// A number, or none for an empty field.
    pub(super) fn optional(&self, place: Option<usize>) -> Result<Option<f64>, ReadError> {
        match place {
            Some(place) if !self.text(place).is_empty() => self.number(place).map(Some),
            _ => Ok(None),
        }
    }

    /// A whole number from zero on.
    pub(super) fn count(&self, place: usize) -> Result<u64, ReadError> {
        match self.number(place)? {
            number if number.fract() == 0.0 && (0.0..=MOST).contains(&number) => Ok(number as u64),
            _ => Err(self.invalid(place, "it must be a whole number from 0 on; correct the row")),
        }
    }

    /// A whole number of any sign.
    pub(super) fn whole(&self, place: usize) -> Result<i64, ReadError> {
        match self.number(place)? {
            number if number.fract() == 0.0 && number.abs() <= MOST => Ok(number as i64),
            _ => Err(self.invalid(place, "it must be a whole number; correct the row")),
        }
    }

    /// What is wrong with a field.
    pub(super) fn invalid(&self, place: usize, cure: &str) -> ReadError {
        let field = self.columns.get(place).cloned();
        ReadError::invalid(
            self.source.path,
            self.line,
            field.unwrap_or_else(|| format!("column {}", place + 1)),
            &String::from_utf8_lossy(self.text(place)),
            cure,
        )
    }

    /// Whether the row says so: 1, true or yes.
    pub(super) fn flag(&self, place: Option<usize>) -> Result<Option<bool>, ReadError> {
        let Some(place) = place else { return Ok(None) };
        match self.text(place) {
            b"" => Ok(None),
            b"1" | b"true" => Ok(Some(true)),
            b"0" | b"false" => Ok(Some(false)),
            _ => Err(self.invalid(place, "it must be 0 or 1; correct the row")),
        }
    }
}
