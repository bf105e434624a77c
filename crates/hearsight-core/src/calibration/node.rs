//! A place in the tree of a calibration file: typed reading whose errors name the place, the value and the cure.

use super::error::CalibrationError;
use super::words::{distance, plain, shorten};
use nalgebra::{SMatrix, SVector};
use serde_json::Value;
use std::path::Path;

/// Characters of a value that an error shows.
const SHOWN: usize = 60;

/// A value of the file, and the way to it.
#[derive(Clone, Debug)]
pub(super) struct Node<'a> {
    pub(super) file: &'a Path,
    /// Such as `cam[0].K`; empty for the whole file.
    pub(super) path: String,
    pub(super) value: &'a Value,
}

impl<'a> Node<'a> {
    pub(super) fn root(file: &'a Path, value: &'a Value) -> Self {
        Self {
            file,
            path: String::new(),
            value,
        }
    }

    /// The field `key`, where there is one and it is not null.
    pub(super) fn get(&self, key: &str) -> Option<Self> {
        let value = self.value.get(key).filter(|value| !value.is_null())?;
        Some(Self {
            file: self.file,
            path: self.path_of(key),
            value,
        })
    }

    /// The first field that has one of these names; capitals, `_`, `-` and blanks do not count.
    pub(super) fn find(&self, names: &[&str]) -> Option<Self> {
        let fields = self.value.as_object()?;
        names.iter().find_map(|name| {
            let wanted = plain(name);
            fields
                .keys()
                .find(|key| plain(key) == wanted)
                .and_then(|key| self.get(key))
        })
    }

    /// Like [`Node::find`], but a missing field is an error that says what there is instead.
    pub(super) fn require(&self, names: &[&str]) -> Result<Self, CalibrationError> {
        self.find(names).ok_or_else(|| {
            let found: Vec<&str> = self
                .value
                .as_object()
                .into_iter()
                .flatten()
                .map(|(key, _)| key.as_str())
                .take(12)
                .collect();
            let others = if names.len() > 1 {
                format!(" (or {})", names[1..].join(", "))
            } else {
                String::new()
            };
            let found = if found.is_empty() {
                "nothing".to_owned()
            } else {
                found.join(", ")
            };
            CalibrationError::Missing {
                file: self.file.to_owned(),
                field: self.path_of(names.first().copied().unwrap_or_default()),
                cure: shorten(&format!("add it{others}; found were {found}"), 4 * SHOWN),
            }
        })
    }

    fn path_of(&self, key: &str) -> String {
        let key = shorten(key, SHOWN);
        if self.path.is_empty() {
            key
        } else {
            format!("{}.{key}", self.path)
        }
    }

    /// The elements of a list; a single table counts as a list of one.
    pub(super) fn items(&self) -> Result<Vec<Self>, CalibrationError> {
        match self.value {
            Value::Array(items) => Ok((items.iter().enumerate())
                .map(|(index, value)| Self {
                    file: self.file,
                    path: format!("{}[{index}]", self.path),
                    value,
                })
                .collect()),
            Value::Object(_) => Ok(vec![self.clone()]),
            _ => Err(self.invalid("it must be a list; write it in [ ]")),
        }
    }

    /// Refuses fields other than `known`, naming the one that was probably meant.
    pub(super) fn refuse_unknown(&self, known: &[&str]) -> Result<(), CalibrationError> {
        let fields = self
            .value
            .as_object()
            .ok_or_else(|| self.invalid("it must have named fields"))?;
        let Some((key, _)) = fields.iter().find(|(key, _)| !known.contains(&key.as_str())) else {
            return Ok(());
        };
        let meant = known
            .iter()
            .min_by_key(|name| distance(name, key))
            .filter(|name| distance(name, key) <= 3);
        let cure = match meant {
            Some(name) => format!("there is no such field; did you mean `{name}`?"),
            None => format!("there is no such field; known are {}", known.join(", ")),
        };
        Err(self
            .get(key)
            .unwrap_or_else(|| Self {
                path: self.path_of(key),
                ..self.clone()
            })
            .invalid(cure))
    }

    /// The error that this value cannot be, with what it must be.
    pub(super) fn invalid(&self, cure: impl Into<String>) -> CalibrationError {
        let value = match self.value {
            Value::String(text) => format!("\"{text}\""),
            other => other.to_string(),
        };
        CalibrationError::Invalid {
            file: self.file.to_owned(),
            field: self.path.clone(),
            value: shorten(&value, SHOWN),
            cure: cure.into(),
        }
    }

    pub(super) fn text(&self) -> Result<&'a str, CalibrationError> {
        self.value
            .as_str()
            .ok_or_else(|| self.invalid("it must be text; write it in \" \""))
    }

    /// A finite number.
    pub(super) fn number(&self) -> Result<f64, CalibrationError> {
        let number = self.value.as_f64().filter(|number| number.is_finite());
        number.ok_or_else(|| self.invalid("it must be a finite number; correct it or calibrate again"))
    }

    /// A number of pixels or columns, 1 to 65536.
    pub(super) fn count(&self) -> Result<usize, CalibrationError> {
        let number = self.number()?;
        if number.fract() == 0.0 && (1.0..=65536.0).contains(&number) {
            return Ok(number as usize);
        }
        Err(self.invalid("it must be a whole number from 1 to 65536"))
    }

    /// Finite numbers with their shape (rows, columns), row-major: a list (one row), a list of equally long lists, or
    /// OpenCV's `rows`, `cols`, `data`.
    fn table(&self) -> Result<(usize, usize, Vec<f64>), CalibrationError> {
        if self.value.is_object() {
            let size = |names: &[&str]| self.require(names)?.count();
            let (rows, columns) = (size(&["rows"])?, size(&["cols", "columns"])?);
            let data = self.require(&["data"])?;
            let (_, _, numbers) = data.table()?;
            if rows.checked_mul(columns) != Some(numbers.len()) {
                let cure = format!(
                    "{rows} x {columns} numbers are declared but {} given",
                    numbers.len()
                );
                return Err(data.invalid(cure));
            }
            return Ok((rows, columns, numbers));
        }
        let items = self.items()?;
        let Some(first) = items.first().and_then(|item| item.value.as_array()) else {
            let numbers = items.iter().map(Self::number).collect::<Result<Vec<_>, _>>()?;
            return Ok((1, numbers.len(), numbers));
        };
        let columns = first.len();
        let mut numbers = Vec::new();
        for row in &items {
            let cells = row.value.as_array().filter(|cells| cells.len() == columns);
            cells.ok_or_else(|| {
                row.invalid(format!("it must be a row of {columns} numbers like the first"))
            })?;
            for cell in row.items()? {
                numbers.push(cell.number()?);
            }
        }
        Ok((items.len(), columns, numbers))
    }

    /// Finite numbers in a row or a column.
    pub(super) fn numbers(&self) -> Result<Vec<f64>, CalibrationError> {
        let (rows, columns, numbers) = self.table()?;
        if rows == 1 || columns == 1 {
            return Ok(numbers);
        }
        Err(self.invalid(format!(
            "it must be one row or column of numbers, not {rows} x {columns}"
        )))
    }

    /// Exactly N finite numbers in a row or a column.
    pub(super) fn vector<const N: usize>(&self) -> Result<SVector<f64, N>, CalibrationError> {
        let numbers = self.numbers()?;
        if numbers.len() == N {
            return Ok(SVector::from_row_slice(&numbers));
        }
        Err(self.invalid(format!("it must be {N} numbers, not {}", numbers.len())))
    }

    /// A matrix of R x C finite numbers: rows in rows, or a flat list row by row.
    pub(super) fn matrix<const R: usize, const C: usize>(
        &self,
    ) -> Result<SMatrix<f64, R, C>, CalibrationError> {
        let (rows, columns, numbers) = self.table()?;
        let flat = rows == 1 && columns == R * C && !self.value.is_object();
        if (rows, columns) == (R, C) || flat {
            return Ok(SMatrix::from_row_slice(&numbers));
        }
        Err(self.invalid(format!(
            "it must be a matrix of {R} x {C} numbers, not {rows} x {columns}"
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Vector2};
    use serde_json::json;

    fn node(value: &Value) -> Node<'_> {
        Node {
            file: Path::new("room/cam.json"),
            path: "cam[0].K".into(),
            value,
        }
    }

    #[test]
    fn shapes_are_read_and_wrong_ones_refused() {
        let expected = Matrix2::new(1.0, 2.0, 3.0, 4.0);
        for good in [
            json!([[1, 2], [3, 4]]),
            json!([1, 2, 3, 4]),
            json!({"rows": 2, "cols": 2, "data": [1, 2, 3, 4]}),
        ] {
            assert_eq!(node(&good).matrix::<2, 2>().unwrap(), expected);
        }
        for bad in [
            json!([[1, 2], [3]]),
            json!([[1, 2], 3]),
            json!([1, 2, 3]),
            json!(7),
            json!([[1, 2], [3, "NaN"]]),
            json!({"rows": 1, "cols": 4, "data": [1, 2, 3, 4]}),
            json!({"rows": 2, "cols": 2, "data": [1, 2, 3]}),
            json!({"rows": 65536, "cols": 65536, "data": []}),
            json!({"rows": -2, "cols": 2, "data": []}),
            json!({"cols": 2, "data": []}),
            json!({"rows": 1, "cols": 1, "data": {"rows": 1}}),
        ] {
            let message = node(&bad).matrix::<2, 2>().unwrap_err().to_string();
            assert!(
                message.contains("cam[0].K") && message.contains("room/cam.json"),
                "{message}"
            );
        }
        assert_eq!(
            node(&json!([[1], [2]])).vector::<2>().unwrap(),
            Vector2::new(1.0, 2.0)
        );
    }

    #[test]
    fn a_misspelt_field_is_named_with_the_one_meant() {
        let value = json!({"widht": 3});
        let message = node(&value)
            .refuse_unknown(&["width", "height"])
            .unwrap_err()
            .to_string();
        assert_eq!(
            message,
            "`cam[0].K.widht` is 3: there is no such field; did you mean `width`? (room/cam.json)"
        );
    }
}
