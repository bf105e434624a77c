//! Watches a case: panics are caught, time and memory measured, and a case without end ends the process.

use crate::memory::peak_bytes;
use crate::targets::{Target, Trial, Verdict};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};
use std::time::{Duration, Instant};

/// Longest time for a case.
const LONGEST: Duration = Duration::from_secs(1);
/// A case that takes this long has no end.
const ENDLESS: Duration = Duration::from_secs(60);
/// Most bytes for a case.
const MOST_BYTES: usize = 256 << 20;

static ALONE: Mutex<()> = Mutex::new(());
static WATCHING: AtomicBool = AtomicBool::new(false);
static PANIC: Mutex<Option<String>> = Mutex::new(None);
static CURRENT: Mutex<Option<(Instant, Vec<u8>)>> = Mutex::new(None);

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What became of a case.
pub(crate) struct Outcome {
    /// What the target said, or what went wrong.
    pub(crate) verdict: Result<Verdict, String>,
    pub(crate) time: Duration,
    pub(crate) bytes: usize,
}

/// A target being tried. Only one is at a time: memory and panics are those of the whole process.
pub(crate) struct Guard<'a> {
    target: &'a Target,
    trial: Trial,
    trace: Option<PathBuf>,
    _alone: MutexGuard<'static, ()>,
}

impl<'a> Guard<'a> {
    /// Opens a target; every case is written to the file `trace` before it is tried.
    pub(crate) fn new(target: &'a Target, trace: Option<PathBuf>) -> Self {
        let alone = lock(&ALONE);
        watch();
        WATCHING.store(true, Ordering::SeqCst);
        Self {
            target,
            trial: (target.open)(),
            trace,
            _alone: alone,
        }
    }

    /// Tries a case; what takes too long is tried twice more, for a busy machine is no finding.
    pub(crate) fn attempt(&mut self, input: &[u8]) -> Outcome {
        let mut outcome = self.attempt_once(input);
        for _ in 0..2 {
            if outcome.verdict.is_ok() && outcome.time > LONGEST {
                let again = self.attempt_once(input);
                outcome.time = outcome.time.min(again.time);
            }
        }
        if outcome.verdict.is_ok() && outcome.time > LONGEST {
            outcome.verdict = Err(format!("slow: {:.1} s", outcome.time.as_secs_f64()));
        }
        if outcome.verdict.is_ok() && outcome.bytes > MOST_BYTES {
            outcome.verdict = Err(format!("memory: {} MB", outcome.bytes >> 20));
        }
        outcome
    }

    fn attempt_once(&mut self, input: &[u8]) -> Outcome {
        if let Some(trace) = &self.trace {
            // The trace only helps to find what ended the process: without it the run is as good.
            let _ = std::fs::write(trace, input);
        }
        let (begun, worked) = (Instant::now(), processor_time());
        *lock(&CURRENT) = Some((begun, input.to_vec()));
        let trial = &mut self.trial;
        let (result, bytes) = peak_bytes(|| catch_unwind(AssertUnwindSafe(|| trial(input))));
        // Time of the processor: other programs on the machine make no case slow.
        let time = processor_time()
            .zip(worked)
            .map_or_else(|| begun.elapsed(), |(now, before)| now.saturating_sub(before));
        *lock(&CURRENT) = None;
        let verdict = match result {
            Ok(Verdict::Broken(promise)) => Err(format!("broken: {promise}")),
            Ok(verdict) => Ok(verdict),
            Err(_) => {
                self.trial = (self.target.open)();
                Err(lock(&PANIC)
                    .take()
                    .unwrap_or_else(|| "panic without a message".to_owned()))
            }
        };
        Outcome { verdict, time, bytes }
    }
}

impl Drop for Guard<'_> {
    fn drop(&mut self) {
        WATCHING.store(false, Ordering::SeqCst);
    }
}

/// Time that this thread has had of a processor, where the system tells.
fn processor_time() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds = text.split_whitespace().next()?.parse().ok()?;
    Some(Duration::from_nanos(nanoseconds))
}

/// Keeps the message of the first panic of a case, and starts the thread that ends cases without end.
fn watch() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            // Outside of a case a panic is a failed test, which says so itself.
            if WATCHING.load(Ordering::SeqCst) && lock(&CURRENT).is_some() {
                lock(&PANIC).get_or_insert_with(|| panic.to_string());
            } else {
                before(panic);
            }
        }));
        std::thread::spawn(|| {
            loop {
                std::thread::sleep(Duration::from_secs(1));
                let current = lock(&CURRENT);
                if let Some((begun, input)) = current.as_ref()
                    && begun.elapsed() > ENDLESS
                {
                    let file =
                        std::env::temp_dir().join(format!("hearsight-fuzz-endless-{}", std::process::id()));
                    let written = std::fs::write(&file, input);
                    eprintln!(
                        "a case without end, {} bytes, {}: {written:?}",
                        input.len(),
                        file.display()
                    );
                    std::process::abort();
                }
            }
        });
    });
}
