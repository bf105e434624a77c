//! When a lost source is tried again, and what is said of it.

use crate::error::fault;
use hearsight_core::{Fault, FaultKind, Instant, Span};
use std::time::{self, Duration};

/// Pause before the first attempt; each further one is twice as long.
const FIRST_PAUSE: Duration = Duration::from_millis(250);
const LONGEST_PAUSE: Duration = Duration::from_secs(10);

/// What to do about a source that is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// Open it now.
    Try,
    /// Ask again later.
    Wait,
    /// It stayed away for too long.
    GiveUp,
}

/// Follows one source through its outages.
pub(super) struct Keeper {
    name: String,
    patience: Duration,
    /// A fault has said that the source is lost.
    said: bool,
    outage: Option<Outage>,
    given_up: bool,
}

struct Outage {
    since: time::Instant,
    next: time::Instant,
    pause: Duration,
    attempts: u32,
}

impl Keeper {
    pub(super) fn new(name: &str, patience: Span) -> Self {
        Self {
            name: name.to_owned(),
            patience: Duration::from_nanos(patience.nanoseconds().max(0).unsigned_abs()),
            said: false,
            outage: None,
            given_up: false,
        }
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Notes whether the source itself said that it is lost.
    pub(super) fn hear(&mut self, faults: &[Fault]) {
        self.said |= faults.iter().any(|fault| fault.kind == FaultKind::Lost);
    }

    /// The source has ended at `time`.
    pub(super) fn lose(&mut self, time: Instant, faults: &mut Vec<Fault>) {
        if !std::mem::replace(&mut self.said, true) {
            let detail = "the source ended; it is opened again as soon as it can be".to_owned();
            faults.push(fault(&self.name, time, FaultKind::Lost, detail));
        }
        let now = time::Instant::now();
        // A source that is opened and gives nothing is still the same outage.
        let outage = self.outage.get_or_insert(Outage {
            since: now,
            next: now,
            pause: FIRST_PAUSE,
            attempts: 0,
        });
        outage.next = now + outage.pause;
    }

    pub(super) fn next(&mut self) -> Next {
        let now = time::Instant::now();
        match &mut self.outage {
            Some(outage) if now.duration_since(outage.since) >= self.patience => Next::GiveUp,
            Some(outage) if now < outage.next => Next::Wait,
            Some(outage) => {
                outage.attempts = outage.attempts.saturating_add(1);
                outage.pause = (2 * outage.pause).min(LONGEST_PAUSE);
                Next::Try
            }
            None => Next::GiveUp,
        }
    }

    /// It stayed away for too long; said once.
    pub(super) fn give_up(&mut self, time: Instant, faults: &mut Vec<Fault>) {
        if !std::mem::replace(&mut self.given_up, true) {
            let detail = format!(
                "the source stayed away for {:.0} s and is given up",
                self.patience.as_secs_f64()
            );
            faults.push(fault(&self.name, time, FaultKind::Lost, detail));
        }
    }

    /// An attempt has failed.
    pub(super) fn fail(&mut self, reason: &str) {
        tracing::debug!(sensor = self.name, reason, "it cannot be opened again yet");
        if let Some(outage) = &mut self.outage {
            outage.next = time::Instant::now() + outage.pause;
        }
    }

    /// Data come again: what there is to say of the outage, if there was one.
    pub(super) fn is_back(&mut self) -> Option<String> {
        let outage = self.outage.take()?;
        self.said = false;
        Some(format!(
            "the source is back after {:.1} s, at attempt {}",
            outage.since.elapsed().as_secs_f64(),
            outage.attempts
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_double_and_patience_ends() {
        let mut keeper = Keeper::new("front", Span::from_seconds(3600.0));
        let mut faults = Vec::new();
        assert!(keeper.is_back().is_none());
        keeper.lose(Instant::from_seconds(2.0), &mut faults);
        keeper.lose(Instant::from_seconds(2.0), &mut faults);
        assert_eq!(
            (faults.len(), faults[0].kind, faults[0].time_s),
            (1, FaultKind::Lost, 2.0)
        );
        assert_eq!(keeper.next(), Next::Wait);
        let mut pauses = Vec::new();
        for _ in 0..8 {
            let outage = keeper.outage.as_mut().unwrap();
            pauses.push(outage.pause.as_secs_f64());
            outage.next = time::Instant::now();
            assert_eq!(keeper.next(), Next::Try);
            keeper.fail("not there");
        }
        assert_eq!(pauses, [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 10.0, 10.0]);
        assert!(keeper.is_back().unwrap().contains("attempt 8"));
        let mut hasty = Keeper::new("front", Span::ZERO);
        hasty.hear(&faults);
        hasty.lose(Instant::ZERO, &mut faults);
        assert_eq!(
            (hasty.next(), faults.len()),
            (Next::GiveUp, 1),
            "the source has said it itself"
        );
    }
}
