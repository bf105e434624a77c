//! The whole run: steps an engine to its end, feeds the outputs, closes them whatever happens.

use crate::engine::Engine;
use crate::error::EngineError;
use crate::progress::Progress;
use crate::sinks::Outputs;
use crate::summary::{Outcome, Summary};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Steps `engine` until its sources end or `stop` is set, gives every tick to `outputs` and then to `watch`, and
/// closes the outputs.
///
/// # Errors
/// [`EngineError::Output`] where an output cannot be written; the run ends there, and every output is closed.
pub fn run(
    engine: &mut Engine,
    mut outputs: Outputs,
    stop: &Arc<AtomicBool>,
    watch: &mut dyn FnMut(&Progress),
) -> Result<Summary, EngineError> {
    engine.stop_when(Arc::clone(stop));
    let mut result = Ok(());
    while result.is_ok() && engine.step().is_some() {
        let begun = Instant::now();
        result = outputs.write(engine.tick());
        engine.add_writing_time(begun.elapsed());
        watch(&engine.progress());
    }
    let outcome = match &result {
        Err(_) => Outcome::Failed,
        Ok(()) if stop.load(Ordering::Relaxed) => Outcome::Interrupted,
        Ok(()) => Outcome::Finished,
    };
    let summary = engine.summary(outcome);
    let closed = outputs.finish(&summary);
    result.and(closed)?;
    Ok(summary)
}
