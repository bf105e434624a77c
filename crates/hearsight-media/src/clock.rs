//! Clocks: from a source's own time to the common clock, and from the machine's to the common clock.

use hearsight_core::{Instant, Span};
use std::time;

/// The common clock of a live run: the machine's monotonic clock with a chosen zero and speed.
#[derive(Clone, Copy, Debug)]
pub struct RunClock {
    origin: time::Instant,
    zero: Instant,
    speed: f64,
}

impl RunClock {
    /// A clock that reads `zero` now and runs at true speed.
    pub fn starting_at(zero: Instant) -> Self {
        Self {
            origin: time::Instant::now(),
            zero,
            speed: 1.0,
        }
    }

    /// The same clock at `speed` seconds a true second; a speed that is not positive and finite counts as 1.
    #[must_use]
    pub fn with_speed(mut self, speed: f64) -> Self {
        self.speed = if speed.is_finite() && speed > 0.0 {
            speed
        } else {
            1.0
        };
        self
    }

    /// The common clock now.
    pub fn now(&self) -> Instant {
        self.zero + Span::from_seconds(self.origin.elapsed().as_secs_f64() * self.speed)
    }

    /// What the clock read, or will read, at a time of the machine.
    pub(crate) fn reading(&self, machine: time::Instant) -> Instant {
        let seconds = match machine.checked_duration_since(self.origin) {
            Some(after) => after.as_secs_f64(),
            None => -self.origin.duration_since(machine).as_secs_f64(),
        };
        self.zero + Span::from_seconds(seconds * self.speed)
    }

    /// True time until the clock reads `instant`; zero where that is past.
    pub fn until(&self, instant: Instant) -> time::Duration {
        let seconds = (instant - self.now()).seconds() / self.speed;
        if seconds > 0.0 {
            time::Duration::from_secs_f64(seconds.min(1e6))
        } else {
            time::Duration::ZERO
        }
    }
}

/// Where a source's own time zero lies on the common clock.
#[derive(Clone, Copy, Debug)]
pub enum Start {
    /// Declared: the instant of the beginning of the file or stream.
    At(Instant),
    /// The moment at which the first data arrive, read from the clock of the run; for live sources.
    OnArrival(RunClock),
}

/// How a source's own time maps to the common clock.
#[derive(Clone, Copy, Debug)]
pub struct SourceClock {
    /// The beginning.
    pub start: Start,
    /// How much faster than the common clock the source's clock runs, in parts per million; default 0. With 100, an
    /// hour by the source is 0.36 s less by the common clock.
    pub drift_ppm: f64,
}

impl Default for SourceClock {
    fn default() -> Self {
        Self::at(Instant::ZERO)
    }
}

impl SourceClock {
    /// A clock without drift whose zero is `start`.
    pub fn at(start: Instant) -> Self {
        Self {
            start: Start::At(start),
            drift_ppm: 0.0,
        }
    }

    /// A clock without drift whose zero is the arrival of the first data.
    pub fn on_arrival(clock: RunClock) -> Self {
        Self {
            start: Start::OnArrival(clock),
            drift_ppm: 0.0,
        }
    }

    /// The declared start, or what the clock of the run read when the first data arrived.
    pub(crate) fn start_on_arrival(&self, arrival: time::Instant) -> Instant {
        match self.start {
            Start::At(instant) => instant,
            Start::OnArrival(clock) => clock.reading(arrival),
        }
    }

    /// Whether the source's zero has been declared.
    pub(crate) fn is_declared(&self) -> bool {
        matches!(self.start, Start::At(_))
    }

    /// The span on the common clock of a span on the source's.
    pub(crate) fn common_from_own(&self, own: Span) -> Span {
        if self.drift_ppm == 0.0 || !self.drift_ppm.is_finite() {
            return own;
        }
        let ratio = self.drift_ppm * 1e-6;
        own - Span::from_nanoseconds((own.nanoseconds() as f64 * ratio / (1.0 + ratio)).round() as i64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drift_shortens_a_fast_clock() {
        let clock = SourceClock {
            drift_ppm: 100.0,
            ..SourceClock::default()
        };
        let hour = clock.common_from_own(Span::from_seconds(3600.0));
        assert!((hour.seconds() - (3600.0 - 0.36)).abs() < 1e-3, "{hour:?}");
        assert_eq!(
            SourceClock::default().common_from_own(Span::from_seconds(1.0)),
            Span::from_seconds(1.0)
        );
    }

    #[test]
    fn a_run_clock_goes_on_at_its_speed() {
        let clock = RunClock::starting_at(Instant::from_seconds(5.0)).with_speed(1000.0);
        std::thread::sleep(time::Duration::from_millis(3));
        assert!(clock.now() >= Instant::from_seconds(8.0));
        assert!(clock.until(Instant::ZERO).is_zero());
        assert!(clock.until(clock.now() + Span::from_seconds(1000.0)) <= time::Duration::from_secs(1));
    }
}
