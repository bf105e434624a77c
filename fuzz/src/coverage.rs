//! Which parts of the program a case went through, where the compiler was asked to count (see `README.md`); else
//! nothing is known and only what targets say tells cases apart.

/// What has been gone through so far, and how often.
#[derive(Default)]
pub(crate) struct Coverage {
    #[cfg(hearsight_coverage)]
    counts: Vec<u8>,
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
        counters::take(&mut self.counts);
    }

    pub(crate) fn is_new(&mut self) -> Option<bool> {
        const BLOCK: usize = 64;
        counters::take(&mut self.counts);
        self.seen.resize(self.counts.len(), 0);
        let mut new = false;
        for (counts, seen) in self.counts.chunks(BLOCK).zip(self.seen.chunks_mut(BLOCK)) {
            // Most blocks were not touched.
            if counts == &[0; BLOCK][..counts.len()] {
                continue;
            }
            for (&count, seen) in counts.iter().zip(seen) {
                // A loop that runs twice as often is a new way: one bit for each doubling.
                let bit = count.checked_ilog2().map_or(0, |doublings| 1 << doublings);
                new |= *seen & bit != bit;
                *seen |= bit;
            }
        }
        Some(new)
    }
}

#[cfg(hearsight_coverage)]
mod counters {
    //! The counters of LLVM's sanitizer coverage, one byte an edge.
    #![expect(
        unsafe_code,
        reason = "the compiler counts in memory that Rust knows nothing of"
    )]

    use std::sync::{Mutex, PoisonError};

    /// Address and length of each array of counters.
    static REGIONS: Mutex<Vec<(usize, usize)>> = Mutex::new(Vec::new());

    /// Called by every instrumented module before `main`.
    #[unsafe(no_mangle)]
    extern "C" fn __sanitizer_cov_8bit_counters_init(start: *mut u8, end: *mut u8) {
        let region = (start.expose_provenance(), end.addr() - start.addr());
        let mut regions = REGIONS.lock().unwrap_or_else(PoisonError::into_inner);
        if !regions.contains(&region) {
            regions.push(region);
        }
    }

    /// Replaces `counts` by all counters, which begin anew from 0.
    pub(super) fn take(counts: &mut Vec<u8>) {
        counts.clear();
        let regions = REGIONS.lock().unwrap_or_else(PoisonError::into_inner);
        for &(address, length) in regions.iter() {
            let start = std::ptr::with_exposed_provenance_mut::<u8>(address);
            counts.reserve(length);
            // SAFETY: the compiler gave beginning and end of an array of bytes that lives as long as the program;
            // nobody holds a reference to it, and a count lost to another thread does no harm.
            unsafe {
                start.copy_to_nonoverlapping(counts.as_mut_ptr().add(counts.len()), length);
                counts.set_len(counts.len() + length);
                start.write_bytes(0, length);
            }
        }
    }
}
