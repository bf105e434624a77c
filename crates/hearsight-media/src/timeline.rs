//! The place of each frame in its camera's time: numbers, gaps, duplicates and clocks that jump.

use hearsight_core::Span;

/// A frame is missed when the next comes later than this many intervals: `GAP_NUMERATOR / 2` = 1.5.
const GAP_NUMERATOR: i64 = 3;
/// A jump beyond this is set aside until a second frame confirms it: one damaged time stamp must not open a gap of
/// hours, in which all frames that follow would look old.
const LONGEST_BELIEVED: Span = Span::from_nanoseconds(10_000_000_000);

/// A jump beyond this is damage even where it is confirmed: nobody wants ticks for years.
pub(crate) const NEVER_BELIEVED: Span = Span::from_nanoseconds(86_400_000_000_000);

/// What to do with a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// It is the camera's frame `number`, `missing` of which before it never came; `time` is its time.
    Next { number: u64, missing: u64, time: Span },
    /// Not after the frame before; leave it out.
    Repeated,
    /// A time stamp too far off to believe; leave it out.
    Incredible,
    /// The source's clock was set anew; the frame is placed one interval after the last.
    Reset { number: u64, time: Span },
}

/// Places frames by their time since the stream's beginning.
#[derive(Clone, Debug)]
pub(crate) struct Timeline {
    interval: Span,
    live: bool,
    last: Option<(Span, u64)>,
    suspect: Option<Span>,
    /// Added to times since the source's clock was set anew.
    correction: Span,
}

impl Timeline {
    pub(crate) fn new(interval: Span, live: bool) -> Self {
        Self {
            interval,
            live,
            last: None,
            suspect: None,
            correction: Span::ZERO,
        }
    }

    /// The time expected of the next frame.
    pub(crate) fn expected(&self) -> Span {
        self.last.map_or(Span::ZERO, |(time, _)| time + self.interval)
    }

    /// The correction to times of the source, should its clock have been set anew.
    pub(crate) fn correction(&self) -> Span {
        self.correction
    }

    /// The number of the last frame, 0 before the first.
    pub(crate) fn last_number(&self) -> u64 {
        self.last.map_or(0, |(_, number)| number)
    }

    /// Places a frame of the given time on the source's clock.
    pub(crate) fn place(&mut self, own: Span) -> Place {
        let time = own + self.correction;
        let Some((last, number)) = self.last else {
            if time.magnitude() > NEVER_BELIEVED {
                self.correction = -own;
                return self.take(Span::ZERO, 1, 0);
            }
            // The stream's beginning is known, so frames lost before the first keep their numbers.
            let missing = if time > LONGEST_BELIEVED {
                0
            } else {
                self.missed(time + self.interval)
            };
            return self.take(time, 1 + missing, missing);
        };
        let step = time - last;
        let confirmed = self.suspect.take().is_some_and(|suspect| {
            own > suspect && own - suspect <= LONGEST_BELIEVED && (own - suspect).nanoseconds() > 0
        });
        if step > LONGEST_BELIEVED && !confirmed {
            self.suspect = Some(own);
            return Place::Incredible;
        }
        if step <= Span::ZERO || step > NEVER_BELIEVED {
            if step <= Span::ZERO && (!self.live || step.magnitude() < Span::from_seconds(1.0)) {
                return Place::Repeated;
            }
            if !confirmed {
                self.suspect = Some(own);
                return Place::Incredible;
            }
            let time = last + self.interval;
            self.correction = time - own;
            self.last = Some((time, number + 1));
            return Place::Reset {
                number: number + 1,
                time,
            };
        }
        let missing = self.missed(step);
        self.take(time, number + 1 + missing, missing)
    }

    fn take(&mut self, time: Span, number: u64, missing: u64) -> Place {
        self.last = Some((time, number));
        Place::Next {
            number,
            missing,
            time,
        }
    }

    /// Frames missed in a step from one frame to the next.
    fn missed(&self, step: Span) -> u64 {
        let (step, interval) = (step.nanoseconds(), self.interval.nanoseconds().max(1));
        if step.saturating_mul(2) <= interval.saturating_mul(GAP_NUMERATOR) {
            return 0;
        }
        ((step.saturating_add(interval / 2) / interval).max(2) - 1) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn milliseconds(count: i64) -> Span {
        Span::from_nanoseconds(count * 1_000_000)
    }

    fn next(number: u64, missing: u64, time: i64) -> Place {
        Place::Next {
            number,
            missing,
            time: milliseconds(time),
        }
    }

    #[test]
    fn lost_frames_keep_their_numbers() {
        let mut timeline = Timeline::new(milliseconds(40), false);
        assert_eq!(timeline.place(milliseconds(0)), next(1, 0, 0));
        assert_eq!(timeline.place(milliseconds(40)), next(2, 0, 40));
        assert_eq!(timeline.place(milliseconds(99)), next(3, 0, 99));
        assert_eq!(timeline.place(milliseconds(240)), next(7, 3, 240));
        assert_eq!(timeline.place(milliseconds(240)), Place::Repeated);
        assert_eq!(timeline.place(milliseconds(200)), Place::Repeated);
        assert_eq!(timeline.place(milliseconds(301)), next(9, 1, 301));
    }

    #[test]
    fn frames_lost_before_the_first_keep_their_numbers() {
        let mut timeline = Timeline::new(milliseconds(40), false);
        assert_eq!(timeline.place(milliseconds(80)), next(3, 2, 80));
    }

    #[test]
    fn one_wild_time_stamp_is_set_aside_and_two_are_believed() {
        let mut timeline = Timeline::new(milliseconds(40), false);
        timeline.place(milliseconds(0));
        assert_eq!(timeline.place(milliseconds(100_000_000)), Place::Incredible);
        assert_eq!(timeline.place(milliseconds(40)), next(2, 0, 40));
        assert_eq!(timeline.place(milliseconds(60_000)), Place::Incredible);
        assert_eq!(timeline.place(milliseconds(60_040)), next(1502, 1499, 60_040));
    }

    #[test]
    fn years_are_never_believed() {
        let year = 31_536_000_000;
        let mut timeline = Timeline::new(milliseconds(40), false);
        assert_eq!(timeline.place(milliseconds(-year)), next(1, 0, 0));
        assert_eq!(timeline.place(milliseconds(40 - year)), next(2, 0, 40));
        assert_eq!(timeline.place(milliseconds(year)), Place::Incredible);
        assert_eq!(
            timeline.place(milliseconds(year + 40)),
            Place::Reset {
                number: 3,
                time: milliseconds(80)
            }
        );
        assert_eq!(timeline.place(milliseconds(year + 80)), next(4, 0, 120));
    }

    #[test]
    fn a_live_clock_that_was_set_back_goes_on() {
        let mut timeline = Timeline::new(milliseconds(40), true);
        timeline.place(milliseconds(0));
        timeline.place(milliseconds(5000));
        assert_eq!(timeline.place(milliseconds(0)), Place::Incredible);
        assert_eq!(
            timeline.place(milliseconds(40)),
            Place::Reset {
                number: 127,
                time: milliseconds(5040)
            }
        );
        assert_eq!(timeline.place(milliseconds(80)), next(128, 0, 5080));
    }
}
