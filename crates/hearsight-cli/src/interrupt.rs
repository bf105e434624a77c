//! Ctrl-C: the first asks the run to end and close its outputs, the second ends the program at once.

use crate::exit::Code;
use crate::say;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

/// The flag that Ctrl-C and a request to terminate set.
pub(crate) fn flag() -> Arc<AtomicBool> {
    static FLAG: OnceLock<Arc<AtomicBool>> = OnceLock::new();
    let flag = FLAG.get_or_init(|| {
        let flag = Arc::new(AtomicBool::new(false));
        let set = Arc::clone(&flag);
        let handler = ctrlc::set_handler(move || {
            if set.swap(true, Ordering::Relaxed) {
                std::process::exit(i32::from(Code::Interrupted.number()));
            }
            say::error(format_args!(
                "\ninterrupted: closing the outputs (again to end at once)"
            ));
        });
        if let Err(error) = handler {
            tracing::warn!(%error, "Ctrl-C cannot be caught: outputs may be cut");
        }
        flag
    });
    Arc::clone(flag)
}
