//! One page of HTML that needs nothing else: no script, no network, light and dark.

use super::figures::figures;
use super::plot::{WIDE, escape};
use super::{Report, shown};
use crate::measure::Measure;
use crate::metrics::{Better, Unit};
use std::fmt::Write;

/// Most cases that get a column of their own.
const MOST_COLUMNS: usize = 8;
/// Most cases that get figures.
const MOST_WITH_FIGURES: usize = 12;

/// Metrics at the top of the page, with what people call them.
const HEADLINES: &[(&str, &str)] = &[
    ("mota", "MOTA"),
    ("idf1", "IDF1"),
    ("HOTA", "HOTA"),
    ("motp", "MOTP"),
    ("speaking_f1", "Speaker F1"),
    ("diarization error rate", "DER"),
    ("time_to_identify", "Time to identify"),
];

pub(super) fn html(report: &Report) -> String {
    let mut page = String::with_capacity(64 << 10);
    let [truth, tracks] = report.names.each_ref().map(|name| escape(name));
    page.push_str("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    page.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    // Writing into a string cannot fail.
    let _ = writeln!(page, "<title>{tracks} judged by {truth}</title>");
    let _ = writeln!(
        page,
        "<style>\n{}</style>\n</head>\n<body>\n<main>",
        include_str!("style.css")
    );
    let _ = writeln!(
        page,
        "<h1>How well it did</h1>\n<p class=\"sides\"><b>Tracks</b> {tracks}<br><b>Truth</b> {truth}</p>"
    );
    let _ = writeln!(page, "<p>{}</p>", escape(&how(report)));
    headlines(report, &mut page);
    if !report.notes.is_empty() {
        page.push_str("<h2>Notes</h2>\n<ul>\n");
        for note in &report.notes {
            let _ = writeln!(page, "<li>{}</li>", escape(note));
        }
        page.push_str("</ul>\n");
    }
    for case in report.cases.iter().take(MOST_WITH_FIGURES) {
        let figures = figures(case);
        if figures.is_empty() {
            continue;
        }
        if report.cases.len() > 1 {
            let _ = writeln!(page, "<h2 class=\"case\">{}</h2>", escape(&case.name));
        }
        page.push_str("<div class=\"figures\">\n");
        for figure in figures {
            let basis = if figure.width < WIDE {
                format!("{:.0}px", figure.width + 30.0)
            } else {
                "100%".to_owned()
            };
            let _ = writeln!(
                page,
                "<figure style=\"flex-basis:{basis}\"><figcaption><b>{}</b> {}</figcaption>\n{}</figure>",
                figure.title,
                escape(&figure.caption),
                figure.body
            );
        }
        page.push_str("</div>\n");
    }
    table(report, &mut page);
    let _ = writeln!(page, "<footer>Hearsight {}</footer>", env!("CARGO_PKG_VERSION"));
    page.push_str("</main>\n</body>\n</html>\n");
    page
}

/// How it was judged, in words.
fn how(report: &Report) -> String {
    let mut words = Vec::new();
    if let Some(gate) = report.gate() {
        words.push(match report.measure() {
            Measure::Overlap => format!("Boxes by intersection over union, at least {:.2}.", 1.0 - gate),
            Measure::Pixels => format!("Points in the picture, at most {gate} px apart."),
            Measure::Metres => format!("Places in the world, at most {gate} m apart."),
        });
    }
    let options = &report.options;
    if options.least_visibility > 0.0 {
        words.push(format!(
            "People less than {} visible do not count.",
            options.least_visibility
        ));
    }
    if options.collar_s > 0.0 {
        words.push(format!("Collar {} s.", options.collar_s));
    }
    if options.skip_overlap {
        words.push("Overlapping speech is left out.".to_owned());
    }
    words.join(" ")
}

fn headlines(report: &Report, page: &mut String) {
    page.push_str("<div class=\"headlines\">\n");
    for (metric, title) in HEADLINES {
        let info = report.judged.iter().flat_map(|(family, _)| family.metrics());
        let Some(info) = info.into_iter().find(|info| info.name == *metric) else {
            continue;
        };
        let Some(value) = report.value(metric) else {
            continue;
        };
        let value = shown(Some(value), false);
        let (unit, sign) = (info.unit.name(report.measure()), arrow(info.better));
        let _ = writeln!(
            page,
            "<div title=\"{}\"><span>{title} {sign}</span><strong>{value}<small> {unit}</small></strong></div>",
            escape(info.meaning)
        );
    }
    page.push_str("</div>\n");
}

fn table(report: &Report, page: &mut String) {
    let cases = report.cases.len();
    let each = (2..=MOST_COLUMNS).contains(&cases);
    page.push_str("<h2>All metrics</h2>\n<p>Larger is better where there is \u{2191}, smaller where there is \u{2193}.</p>\n");
    page.push_str("<div class=\"scroll\"><table>\n<thead><tr><th>metric</th>");
    if each {
        for case in &report.cases {
            let _ = write!(page, "<th class=\"number\">{}</th>", escape(&case.name));
        }
    }
    let all = if cases > 1 { "all" } else { "value" };
    let _ = writeln!(
        page,
        "<th class=\"number\">{all}</th><th>unit</th><th></th><th>meaning</th></tr></thead>"
    );
    let columns = 5 + if each { cases } else { 0 };
    for (family, judged) in &report.judged {
        let _ = writeln!(
            page,
            "<tbody><tr class=\"family\"><th colspan=\"{columns}\">{} <small>{}</small></th></tr>",
            escape(family.name()),
            escape(family.source())
        );
        for (place, metric) in family.metrics().iter().enumerate() {
            let is_count = metric.unit == Unit::Count;
            let _ = write!(page, "<tr><td>{}</td>", escape(metric.name));
            if each {
                for values in &judged.of_each {
                    let value = values.as_ref().and_then(|values| values[place]);
                    let _ = write!(page, "<td class=\"number\">{}</td>", shown(value, is_count));
                }
            }
            let _ = writeln!(
                page,
                "<td class=\"number all\">{}</td><td>{}</td><td>{}</td><td class=\"meaning\">{}</td></tr>",
                shown(judged.overall[place], is_count),
                metric.unit.name(report.measure()),
                arrow(metric.better),
                escape(metric.meaning)
            );
        }
        page.push_str("</tbody>\n");
    }
    page.push_str("</table></div>\n");
}

fn arrow(better: Better) -> &'static str {
    match better {
        Better::Up => "\u{2191}",
        Better::Down => "\u{2193}",
        Better::Neither => "",
    }
}
