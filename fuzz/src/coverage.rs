//! Which parts of the program a case went through, where the compiler was asked to count (see `README.md`); else
//! nothing is known and only what targets say tells cases apart.

/// What has been gone through so far, and how often.
#[derive(Default)]
pub(crate) struct Coverage {
    #[cfg(hearsight_coverage)]
    seen: Vec<u8>,
}

#[cfg(not(hearsight_coverage))]
impl Coverage {
    pub(crate) fn begin(&mut self) {}

    /// Whether the case since [`Coverage::begin`] went a new way; `None` where nothing is counted.
    pub(crate) fn is_new(&mut self) -> Option<bool> {
        None
    }
}

#[cfg(hearsight_coverage)]
impl Coverage {
    pub(crate) fn begin(&mut self) {
        counters::each(|counter| counter.store(0, std::sync::atomic::Ordering::Relaxed));
    }

    pub(crate) fn is_new(&mut self) -> Option<bool> {
        let (mut at, mut new) = (0, false);
        self.seen.resize(counters::count(), 0);
        counters::each(|counter| {
            let count = counter.load(std::sync::atomic::Ordering::Relaxed);
            if count > 0 {
                // A loop that runs twice as often is a new way: one bit for each doubling.
                let bit = 1 << count.ilog2();
                new |= self.seen[at] & bit == 0;
                self.seen[at] |= bit;
            }
            at += 1;
        });
        Some(new)
    }
}

#[cfg(hearsight_coverage)]
mod counters {
    //! The counters of LLVM's sanitizer coverage, one byte an edge.

    use std::sync::atomic::AtomicU8;
    use std::sync::{Mutex, PoisonError};

    static REGIONS: Mutex<Vec<&[AtomicU8]>> = Mutex::new(Vec::new());

    /// Called by every instrumented module before `main`.
    #[expect(unsafe_code, reason = "the compiler calls this by its name, with addresses")]
    #[unsafe(no_mangle)]
    extern "C" fn __sanitizer_cov_8bit_counters_init(start: *const AtomicU8, end: *const AtomicU8) {
        let length = end.addr() - start.addr();
        // SAFETY: the compiler gives the beginning and end of an array of bytes that lives as long as the program.
        let region = unsafe { std::slice::from_raw_parts(start, length) };
        let mut regions = REGIONS.lock().unwrap_or_else(PoisonError::into_inner);
        if !regions.iter().any(|known| std::ptr::eq(*known, region)) {
            regions.push(region);
        }
    }

    pub(super) fn count() -> usize {
        let regions = REGIONS.lock().unwrap_or_else(PoisonError::into_inner);
        regions.iter().map(|region| region.len()).sum()
    }

    pub(super) fn each(mut visit: impl FnMut(&AtomicU8)) {
        let regions = REGIONS.lock().unwrap_or_else(PoisonError::into_inner);
        regions
            .iter()
            .for_each(|region| region.iter().for_each(&mut visit));
    }
}
