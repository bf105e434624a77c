//! The bar with the time left, on standard error and only on a terminal.

use hearsight::Instant;
use hearsight::engine::Progress;
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::OnceLock;
use tracing_subscriber::fmt::MakeWriter;

/// Bars know parts in thousandths of a second of the recording.
const UNITS_PER_SECOND: f64 = 1000.0;

fn bars() -> &'static MultiProgress {
    static BARS: OnceLock<MultiProgress> = OnceLock::new();
    BARS.get_or_init(|| MultiProgress::with_draw_target(ProgressDrawTarget::stderr_with_hz(8)))
}

/// How far a run is, for people.
pub(crate) struct Bar(Option<ProgressBar>);

impl Bar {
    /// A bar, or nothing where nobody would see it.
    pub(crate) fn new(first: &Progress, quiet: bool) -> Self {
        if quiet || !std::io::stderr().is_terminal() {
            return Self(None);
        }
        let (template, bar) = match first.end {
            Some(end) => (
                "{wide_bar} {percent:>3} %  {msg}  {eta} left",
                ProgressBar::new(((end - first.start).seconds() * UNITS_PER_SECOND) as u64),
            ),
            None => ("{spinner} {elapsed}  {msg}", ProgressBar::new_spinner()),
        };
        let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        Self(Some(bars().add(bar.with_style(style))))
    }

    /// A bar for so many seconds of a recording, or nothing where nobody would see it.
    pub(crate) fn of_seconds(seconds: f64, quiet: bool) -> Self {
        let first = Progress {
            start: Instant::ZERO,
            position: Instant::ZERO,
            end: Some(Instant::from_seconds(seconds)),
            ticks: 0,
            tracks: 0,
        };
        Self::new(&first, quiet)
    }

    /// Shows how many seconds are done.
    pub(crate) fn show_seconds(&self, seconds: f64) {
        if let Some(bar) = &self.0 {
            bar.set_position((seconds * UNITS_PER_SECOND) as u64);
            bar.set_message(format!("{seconds:.1} s"));
        }
    }

    /// Shows how far the run is.
    pub(crate) fn show(&self, progress: &Progress) {
        let Some(bar) = &self.0 else { return };
        bar.set_position((progress.done().seconds() * UNITS_PER_SECOND) as u64);
        if progress.ticks % 25 == 1 {
            let people = if progress.tracks == 1 { "person" } else { "people" };
            bar.set_message(format!(
                "{:.1} s, {} {people}",
                progress.position.seconds(),
                progress.tracks
            ));
        }
    }

    /// Takes the bar away.
    pub(crate) fn end(self) {
        if let Some(bar) = self.0 {
            bar.finish_and_clear();
        }
    }
}

/// How many trials of an experiment are done, with the time left.
pub(crate) struct Trials(Option<ProgressBar>);

impl Trials {
    /// A bar, or nothing where nobody would see it.
    pub(crate) fn new(quiet: bool) -> Self {
        if quiet || !std::io::stderr().is_terminal() {
            return Self(None);
        }
        let style = ProgressStyle::with_template("{wide_bar} {pos} of {len} trials  {eta} left");
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
        Self(Some(bars().add(ProgressBar::no_length().with_style(style))))
    }

    /// Shows how many are done.
    pub(crate) fn show(&self, done: usize, all: usize) {
        let Some(bar) = &self.0 else { return };
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    }

    /// Takes the bar away.
    pub(crate) fn end(self) {
        if let Some(bar) = self.0 {
            bar.finish_and_clear();
        }
    }
}

/// Standard error for the log, which a bar must not cut through.
#[derive(Clone, Copy)]
pub(crate) struct Stderr;

impl Write for Stderr {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        bars().suspend(|| std::io::stderr().write(bytes))
    }

    fn flush(&mut self) -> std::io::Result<()> {
        std::io::stderr().flush()
    }
}

impl MakeWriter<'_> for Stderr {
    type Writer = Self;

    fn make_writer(&self) -> Self::Writer {
        *self
    }
}
