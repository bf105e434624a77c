//! Small plots as inline SVG, coloured by the classes of the page so that they follow light and dark. Made by hand: crates
//! for plots fix their colours when they draw.

use std::fmt::{Display, Write};

/// Width of a plot that spans the page, in the units of its view box.
pub(super) const WIDE: f64 = 860.0;

/// Text that is safe within HTML.
pub(super) fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            // Control characters are not allowed at all.
            other if other.is_control() => safe.push(' '),
            other => safe.push(other),
        }
    }
    safe
}

/// The class of the colour of a person or track.
pub(super) fn colour(index: usize) -> String {
    format!("c{}", index % COLOURS)
}

/// How many colours there are.
pub(super) const COLOURS: usize = 8;

/// What an axis shows.
pub(super) struct Axis {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) label: String,
}

impl Axis {
    /// An axis over values, a little wider; from zero to one where there are none.
    pub(super) fn around(values: impl Iterator<Item = f64>, label: impl Into<String>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|value| value.is_finite()) {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        if high - low <= 1e-9 * high.abs().max(1.0) {
            (low, high) = (low - 0.5, high + 0.5);
        }
        Self {
            low,
            high,
            label: label.into(),
        }
    }

    /// Round numbers within the axis, about `count` of them.
    fn ticks(&self, count: f64) -> Vec<(f64, String)> {
        // An axis may count downwards.
        let (low, high) = (self.low.min(self.high), self.low.max(self.high));
        let span = high - low;
        let rough = span / count;
        if !(rough > 0.0 && rough.is_finite()) {
            return Vec::new();
        }
        let power = 10.0_f64.powf(rough.log10().floor());
        let steps = [1.0, 2.0, 5.0, 10.0];
        let step = steps
            .iter()
            .map(|step| step * power)
            .find(|step| *step >= rough)
            .unwrap_or(rough);
        let digits = (-step.log10().floor()).clamp(0.0, 6.0) as usize;
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        (first..=last.min(first.saturating_add(40)))
            .map(|number| {
                let value = number as f64 * step;
                (value, format!("{:.digits$}", value + 0.0))
            })
            .collect()
    }
}

/// A plot in the making.
pub(super) struct Plot {
    svg: String,
    width: f64,
    height: f64,
    x: Axis,
    y: Axis,
}

const LEFT: f64 = 64.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 10.0;
const BOTTOM: f64 = 40.0;

impl Plot {
    /// A plot with grid, numbers and labels. `title` is what it is called for who cannot see it.
    pub(super) fn new(title: &str, width: f64, height: f64, x: Axis, y: Axis) -> Self {
        let mut plot = Self::without_rows(title, width, height, x, y);
        for (value, text) in plot.y.ticks((height - TOP - BOTTOM) / 42.0) {
            let y = plot.v(value);
            plot.element(format_args!(
                r#"<line class="grid" x1="{LEFT}" x2="{:.1}" y1="{y:.1}" y2="{y:.1}"/><text class="tick end" x="{}" y="{:.1}">{text}</text>"#,
                width - RIGHT,
                LEFT - 8.0,
                y + 4.0
            ));
        }
        let middle = (TOP + height - BOTTOM) / 2.0;
        let label = escape(&plot.y.label);
        plot.element(format_args!(
            r#"<text class="label" transform="translate(14 {middle:.1}) rotate(-90)">{label}</text>"#
        ));
        plot
    }

    /// A plot whose rows have names: row 0 at the top.
    pub(super) fn with_rows(title: &str, x: Axis, rows: &[String], row_height: f64) -> Self {
        let height = rows.len().max(1) as f64 * row_height + TOP + BOTTOM;
        let y = Axis {
            low: rows.len().max(1) as f64,
            high: 0.0,
            label: String::new(),
        };
        let mut plot = Self::without_rows(title, WIDE, height, x, y);
        for (row, name) in rows.iter().enumerate() {
            let shortened: String = name.chars().take(9).collect();
            let y = plot.v(row as f64 + 0.5) + 4.0;
            plot.element(format_args!(
                r#"<text class="tick end" x="{}" y="{y:.1}">{}<title>{}</title></text>"#,
                LEFT - 8.0,
                escape(&shortened),
                escape(name)
            ));
        }
        plot
    }

    fn without_rows(title: &str, width: f64, height: f64, x: Axis, y: Axis) -> Self {
        let mut plot = Self {
            svg: String::new(),
            width,
            height,
            x,
            y,
        };
        let title = escape(title);
        plot.element(format_args!(
            r#"<svg viewBox="0 0 {width} {height:.0}" style="max-width:{width}px" role="img" aria-label="{title}">"#
        ));
        let (top, bottom) = (TOP, height - BOTTOM);
        for (value, text) in plot.x.ticks((width - LEFT - RIGHT) / 80.0) {
            let u = plot.u(value);
            plot.element(format_args!(
                r#"<line class="grid" x1="{u:.1}" x2="{u:.1}" y1="{top}" y2="{bottom:.1}"/><text class="tick middle" x="{u:.1}" y="{:.1}">{text}</text>"#,
                bottom + 16.0
            ));
        }
        let label = escape(&plot.x.label);
        plot.element(format_args!(
            r#"<text class="label" x="{:.1}" y="{:.1}">{label}</text>"#,
            (LEFT + width - RIGHT) / 2.0,
            height - 6.0
        ));
        plot
    }

    /// Adds an element as it is.
    pub(super) fn element(&mut self, element: impl Display) {
        // Writing into a string cannot fail.
        let _ = writeln!(self.svg, "{element}");
    }

    /// The column of a value.
    pub(super) fn u(&self, value: f64) -> f64 {
        LEFT + (value - self.x.low) / (self.x.high - self.x.low) * (self.width - LEFT - RIGHT)
    }

    /// The row of a value.
    pub(super) fn v(&self, value: f64) -> f64 {
        let bottom = self.height - BOTTOM;
        bottom - (value - self.y.low) / (self.y.high - self.y.low) * (bottom - TOP)
    }

    /// A line through points, broken where one is none.
    pub(super) fn line(
        &mut self,
        class: &str,
        title: &str,
        points: impl Iterator<Item = Option<(f64, f64)>>,
    ) {
        let mut path = String::new();
        let mut pen_down = false;
        for point in points {
            let Some((x, y)) = point.filter(|(x, y)| x.is_finite() && y.is_finite()) else {
                pen_down = false;
                continue;
            };
            let letter = if pen_down { 'L' } else { 'M' };
            let _ = write!(path, "{letter}{:.1} {:.1}", self.u(x), self.v(y));
            if !pen_down {
                // A point alone is drawn too, as the round end of a line of no length.
                path.push_str("h0");
            }
            pen_down = true;
        }
        if !path.is_empty() {
            let title = escape(title);
            self.element(format_args!(
                r#"<path class="{class}" d="{path}"><title>{title}</title></path>"#
            ));
        }
    }

    /// A bar in a row from `start` to `end`; `part` of the row's height from `from`, 0 to 1.
    pub(super) fn bar(
        &mut self,
        class: &str,
        title: &str,
        row: f64,
        start: f64,
        end: f64,
        [from, to]: [f64; 2],
    ) {
        let (left, right) = (self.u(start.max(self.x.low)), self.u(end.min(self.x.high)));
        let (top, bottom) = (self.v(row + from), self.v(row + to));
        let (width, height) = ((right - left).max(0.6), (bottom - top).max(0.5));
        if right < left {
            return;
        }
        let title = escape(title);
        self.element(format_args!(
            r#"<rect class="{class}" x="{left:.1}" y="{top:.1}" width="{width:.1}" height="{height:.1}"><title>{title}</title></rect>"#
        ));
    }

    /// The finished plot.
    pub(super) fn finish(mut self) -> String {
        self.svg.push_str("</svg>\n");
        self.svg
    }
}

/// A legend: class of the colour and text of each entry.
pub(super) fn legend(entries: &[(String, String)]) -> String {
    let mut html = String::from("<ul class=\"legend\">");
    for (class, text) in entries {
        let _ = write!(html, r#"<li><span class="{class}"></span>{}</li>"#, escape(text));
    }
    html.push_str("</ul>\n");
    html
}
