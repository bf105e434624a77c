//! What was judged, for people and for programs: a table, JSON, and one page of HTML.

mod figures;
mod html;
mod json;
mod plot;
mod table;

use crate::case::Case;
use crate::measure::Measure;
use crate::metrics::{FAMILIES, Judge, JudgeError, Judged};
use crate::pair::Options;

/// Everything that was found out.
pub struct Report {
    /// What the truth and the tracks are called.
    pub names: [String; 2],
    /// How it was judged.
    pub options: Options,
    /// What was judged.
    pub cases: Vec<Case>,
    /// What was left out.
    pub notes: Vec<String>,
    /// The families that apply, with their values.
    judged: Vec<(&'static dyn Judge, Judged)>,
}

impl Report {
    /// Judges cases by every family of metrics that applies.
    ///
    /// # Errors
    /// [`JudgeError`], for cases that are too large.
    pub fn new(
        names: [String; 2],
        cases: Vec<Case>,
        notes: Vec<String>,
        options: Options,
    ) -> Result<Self, JudgeError> {
        let mut judged = Vec::with_capacity(FAMILIES.len());
        for &family in FAMILIES {
            if let Some(values) = family.judge(&cases)? {
                judged.push((family, values));
            }
        }
        Ok(Self {
            names,
            options,
            cases,
            notes,
            judged,
        })
    }

    /// The value of a metric over all cases; none where it does not apply or is not defined.
    pub fn value(&self, metric: &str) -> Option<f64> {
        self.judged.iter().find_map(|(family, judged)| {
            let place = family.metrics().iter().position(|info| info.name == metric)?;
            judged.overall[place]
        })
    }

    /// What distances are.
    pub fn measure(&self) -> Measure {
        let with_frames = self.cases.iter().find(|case| !case.sequence.is_empty());
        with_frames.map_or(Measure::Metres, |case| case.sequence.measure())
    }

    /// The gate of the cases with frames.
    pub fn gate(&self) -> Option<f64> {
        let with_frames = self.cases.iter().find(|case| !case.sequence.is_empty());
        with_frames.map(|case| case.sequence.gate())
    }

    /// The table, for a terminal.
    pub fn table(&self) -> String {
        table::table(self)
    }

    /// Everything for programs. What is not defined is null.
    pub fn json(&self) -> serde_json::Value {
        json::json(self)
    }

    /// One page of HTML with everything in it.
    pub fn html(&self) -> String {
        html::html(self)
    }
}

/// The list of metrics for `--help`.
pub fn list_of_metrics() -> String {
    table::list()
}

/// A value as people read it: whole numbers whole, others with three or four digits that mean something.
fn shown(value: Option<f64>, is_count: bool) -> String {
    match value {
        None => "-".to_owned(),
        Some(value) if is_count => format!("{value:.0}"),
        Some(value) if value.abs() >= 100.0 => format!("{value:.1}"),
        Some(value) if value.abs() >= 10.0 => format!("{value:.2}"),
        Some(value) => format!("{value:.3}"),
    }
}
