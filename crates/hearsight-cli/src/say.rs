//! Printing that does not mind when nobody listens any more, as in `hearsight schema | head -1`.

use std::fmt::Display;
use std::io::Write;

/// Prints a line to standard output.
pub(crate) fn line(text: impl Display) {
    // The run goes on for its files; there is nobody left to tell.
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// Prints a line to standard error.
pub(crate) fn error(text: impl Display) {
    let _ = writeln!(std::io::stderr(), "{text}");
}
