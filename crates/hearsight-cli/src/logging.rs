//! Logs to standard error, by `-v` or `RUST_LOG`.

use std::io::IsTerminal;
use tracing_subscriber::EnvFilter;

/// Begins to log: warnings, with one `-v` also information, with two everything of ours and what libav complains of.
pub(crate) fn begin(verbose: u8) {
    let default = match verbose {
        0 => "warn",
        1 => "info",
        _ => {
            "info,hearsight=trace,hearsight_engine=trace,hearsight_media=trace,hearsight_tracking=trace,libav=debug"
        }
    };
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(default));
    let _ = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(crate::progress::Stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .with_target(false)
        .without_time()
        .try_init();
}
