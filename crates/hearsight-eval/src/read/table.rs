//! Rows of fields between commas with names for their columns, and numbers out of them.
//!
//! None of the formats quotes fields, and files of millions of rows are read before every judgement: splitting at commas
//! and a short way for short numbers take a quarter of the time of general readers.

use super::{ReadError, Source};

/// Largest number of a frame or person: whole numbers up to here are exact.
const MOST: f64 = 9_007_199_254_740_992.0;

/// Rows of a file in turn.
pub(super) struct Rows<'a> {
    source: &'a Source<'a>,
    rest: &'a [u8],
    /// The line read last, from 1.
    line: u64,
    fields: Vec<&'a [u8]>,
    columns: Vec<String>,
}

/// A row in hand.
pub(super) struct Row<'r> {
    source: &'r Source<'r>,
    fields: &'r [&'r [u8]],
    columns: &'r [String],
    pub(super) line: u64,
}

impl<'a> Rows<'a> {
    /// A file whose first row names the columns.
    pub(super) fn with_header(source: &'a Source<'a>) -> Self {
        let mut rows = Self::new(source, Vec::new());
        let text = |field: &&[u8]| String::from_utf8_lossy(field).to_ascii_lowercase();
        let first = rows.next().map(|row| row.fields.iter().map(text).collect());
        rows.columns = first.unwrap_or_default();
        rows
    }

    /// A file without a header; `columns` are names for messages.
    pub(super) fn without_header(source: &'a Source<'a>, columns: &[&str]) -> Self {
        Self::new(source, columns.iter().map(|name| (*name).to_owned()).collect())
    }

    fn new(source: &'a Source<'a>, columns: Vec<String>) -> Self {
        Self {
            source,
            rest: source.bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(source.bytes),
            line: 0,
            fields: Vec::new(),
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
    pub(super) fn next(&mut self) -> Option<Row<'_>> {
        while !self.rest.is_empty() {
            self.line += 1;
            self.fields.clear();
            let (mut start, mut end) = (0, self.rest.len());
            for (at, &byte) in self.rest.iter().enumerate() {
                if byte == b',' {
                    self.fields.push(self.rest[start..at].trim_ascii());
                    start = at + 1;
                } else if byte == b'\n' {
                    end = at;
                    break;
                }
            }
            self.fields.push(self.rest[start..end].trim_ascii());
            self.rest = self.rest.get(end + 1..).unwrap_or_default();
            if self.fields.iter().any(|field| !field.is_empty()) {
                return Some(Row {
                    source: self.source,
                    fields: &self.fields,
                    columns: &self.columns,
                    line: self.line,
                });
            }
        }
        None
    }
}

/// The number of a short text of digits, perhaps with a sign and a point; none for any other text. Digits and power of
/// ten are exact, so that their quotient is the number nearest to the text, as of the general way.
fn short_number(text: &[u8]) -> Option<f64> {
    const POWERS: [f64; 16] = [
        1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
    ];
    let (is_negative, digits) = match text {
        [b'-', digits @ ..] => (true, digits),
        digits => (false, digits),
    };
    if digits.len() > 16 {
        return None;
    }
    let (mut whole, mut decimals, mut has_point) = (0_u64, 0, false);
    for &byte in digits {
        match byte {
            b'0'..=b'9' => {
                whole = 10 * whole + u64::from(byte - b'0');
                decimals += usize::from(has_point);
            }
            b'.' if !has_point => has_point = true,
            _ => return None,
        }
    }
    let count = digits.len() - usize::from(has_point);
    if !(1..=15).contains(&count) {
        return None;
    }
    let number = whole as f64 / POWERS[decimals];
    Some(if is_negative { -number } else { number })
}

impl Row<'_> {
    /// Number of fields.
    pub(super) fn len(&self) -> usize {
        self.fields.len()
    }

    /// The text of a field; empty where the row is too short.
    pub(super) fn text(&self, place: usize) -> &[u8] {
        self.fields.get(place).copied().unwrap_or_default()
    }

    /// A number, perhaps not finite.
    pub(super) fn number(&self, place: usize) -> Result<f64, ReadError> {
        let text = self.text(place);
        let general = || std::str::from_utf8(text).ok()?.parse().ok();
        short_number(text)
            .or_else(general)
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn short_numbers_are_those_of_the_general_way(text in "-?[0-9.]{0,18}") {
            if let Some(number) = short_number(text.as_bytes()) {
                prop_assert_eq!(number.to_bits(), text.parse::<f64>().unwrap().to_bits(), "{}", text);
            }
        }
    }

    #[test]
    fn what_is_no_short_number_is_left_to_the_general_way() {
        for text in [
            "",
            "-",
            ".",
            "-.",
            "1.2.3",
            "1e5",
            "nan",
            "+1",
            "1234567890123456",
            "0x1",
            "1 2",
        ] {
            assert_eq!(short_number(text.as_bytes()), None, "{text}");
        }
        for (text, number) in [
            ("5", 5.0),
            (".5", 0.5),
            ("5.", 5.0),
            ("-12.25", -12.25),
            ("123456789012345", 123_456_789_012_345.0),
        ] {
            assert_eq!(short_number(text.as_bytes()), Some(number));
        }
    }
}
