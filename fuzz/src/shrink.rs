//! Makes a case that goes wrong smaller, as long as it goes wrong in the same way.

use crate::guard::Guard;
use crate::run::kind;
use std::time::{Duration, Instant};

const TIME: Duration = Duration::from_secs(5);

/// Takes away ever smaller parts.
pub(crate) fn shrink(guard: &mut Guard<'_>, input: &[u8], wrong: &str) -> Vec<u8> {
    let (begun, wanted) = (Instant::now(), kind(wrong));
    let mut best = input.to_vec();
    let mut part = best.len().div_ceil(2);
    while part > 0 {
        let mut at = 0;
        while at < best.len() {
            if begun.elapsed() > TIME {
                return best;
            }
            let mut smaller = best.clone();
            smaller.drain(at..(at + part).min(best.len()));
            match guard.attempt(&smaller).verdict {
                Err(wrong) if kind(&wrong) == wanted => best = smaller,
                _ => at += part,
            }
        }
        part /= 2;
    }
    best
}
