//! The table for a terminal, and the list of metrics for `--help`. Plain text: a crate for tables would bring more code
//! than this is.

use super::{Report, shown};
use crate::metrics::{Better, FAMILIES, Unit};
use std::fmt::Write;

/// Most cases that get a column of their own.
const MOST_COLUMNS: usize = 6;

pub(super) fn table(report: &Report) -> String {
    let cases = report.cases.len();
    let each = (2..=MOST_COLUMNS).contains(&cases);
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut header = vec!["metric".to_owned()];
    if each {
        header.extend(report.cases.iter().map(|case| case.name.clone()));
    }
    header.push(if cases > 1 {
        "all".to_owned()
    } else {
        "value".to_owned()
    });
    header.extend(["unit".to_owned(), "better".to_owned()]);
    rows.push(header);
    for (family, judged) in &report.judged {
        rows.push(vec![family.name().to_owned()]);
        for (place, metric) in family.metrics().iter().enumerate() {
            let is_count = metric.unit == Unit::Count;
            let mut row = vec![format!("  {}", metric.name)];
            if each {
                let of_case = judged.of_each.iter().map(|values| {
                    let value = values.as_ref().and_then(|values| values[place]);
                    shown(value, is_count)
                });
                row.extend(of_case);
            }
            row.push(shown(judged.overall[place], is_count));
            row.push(metric.unit.name(report.measure()).to_owned());
            row.push(arrow(metric.better).to_owned());
            rows.push(row);
        }
    }
    let columns = rows[0].len();
    let widths: Vec<usize> = (0..columns)
        .map(|column| {
            let cells = rows
                .iter()
                .filter(|row| row.len() > 1)
                .filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        })
        .collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (column, cell) in row.iter().enumerate() {
            let width = widths[column];
            // Values to the right, words to the left. Writing into a string cannot fail.
            let _ = if (1..columns - 2).contains(&column) {
                write!(line, "  {cell:>width$}")
            } else if column == 0 {
                write!(line, "{cell:<width$}")
            } else {
                write!(line, "  {cell:<width$}")
            };
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

/// Every metric with its meaning.
pub(super) fn list() -> String {
    let mut text = String::from("Metrics (^ larger is better, v smaller is better):\n");
    let metrics = FAMILIES.iter().flat_map(|family| family.metrics());
    let width = metrics.map(|metric| metric.name.len()).max().unwrap_or(0);
    for family in FAMILIES {
        let _ = writeln!(text, "  {} ({})", family.name(), family.source());
        for metric in family.metrics() {
            let sign = arrow(metric.better);
            let _ = writeln!(text, "    {:<width$} {sign:1}  {}", metric.name, metric.meaning);
        }
    }
    text
}

fn arrow(better: Better) -> &'static str {
    match better {
        Better::Up => "^",
        Better::Down => "v",
        Better::Neither => "",
    }
}
