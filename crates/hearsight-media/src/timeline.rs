//! The place of each frame in its camera's time: numbers, gaps, duplicates and clocks that jump.

use hearsight_core::Span;

/// A frame is missed when the next comes later than this many intervals: `GAP_NUMERATOR / 2` = 1.5.
const GAP_NUMERATOR: i64 = 3;
/// A jump beyond this is set aside until a second frame confirms it: one damaged time stamp must not open a gap of
/// hours, in which all frames that follow would look old.
const LONGEST_BELIEVED: Span = Span::from_nanoseconds(10_000_000_000);

/// A jump beyond this is damage even where it is confirmed: nobody wants ticks for years.
pub(crate) const NEVER_BELIEVED: Span = Span::from_nanoseconds(86_400_000_000_000);

const ONE_SECOND: Span = Span::from_nanoseconds(1_000_000_000);

/// What to do with a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// It is the camera's frame `number`, `missing` of which before it never came; `time` is its time.
    Next { number: u64, missing: u64, time: Span },
    /// Not after the frame before; leave it out.
    Repeated,
    /// A time stamp too far off to believe; leave it out.
    Incredible,
    /// The source's clock was set anew; the frame is placed where it arrived, where that is known, else one interval after
    /// the last.
    Reset { number: u64, missing: u64, time: Span },
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

    /// Places a frame of the given time on the source's clock. `now`, for sources that are timed by the arrival of their
    /// data, is the present on the camera's time: no frame is of the future.
    pub(crate) fn place(&mut self, own: Span, now: Option<Span>) -> Place {
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
        let of_the_future = step > LONGEST_BELIEVED && now.is_some_and(|now| time > now + ONE_SECOND);
        if step <= Span::ZERO || step > NEVER_BELIEVED || of_the_future {
            if step <= Span::ZERO && (!self.live || step.magnitude() < ONE_SECOND) {
                return Place::Repeated;
            }
            if !confirmed {
                self.suspect = Some(own);
                return Place::Incredible;
            }
            let time = now.unwrap_or(last).max(last + self.interval);
            self.correction = time - own;
            let missing = self.missed(time - last);
            let number = number + 1 + missing;
            self.last = Some((time, number));
            return Place::Reset {
                number,
                missing,
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
        assert_eq!(timeline.place(milliseconds(0), None), next(1, 0, 0));
        assert_eq!(timeline.place(milliseconds(40), None), next(2, 0, 40));
        assert_eq!(timeline.place(milliseconds(99), None), next(3, 0, 99));
        assert_eq!(timeline.place(milliseconds(240), None), next(7, 3, 240));
        assert_eq!(timeline.place(milliseconds(240), None), Place::Repeated);
        assert_eq!(timeline.place(milliseconds(200), None), Place::Repeated);
        assert_eq!(timeline.place(milliseconds(301), None), next(9, 1, 301));
    }

    #[test]
    fn frames_lost_before_the_first_keep_their_numbers() {
        let mut timeline = Timeline::new(milliseconds(40), false);
        assert_eq!(timeline.place(milliseconds(80), None), next(3, 2, 80));
    }

    #[test]
    fn one_wild_time_stamp_is_set_aside_and_two_are_believed() {
        let mut timeline = Timeline::new(milliseconds(40), false);
        timeline.place(milliseconds(0), None);
        assert_eq!(timeline.place(milliseconds(100_000_000), None), Place::Incredible);
        assert_eq!(timeline.place(milliseconds(40), None), next(2, 0, 40));
        assert_eq!(timeline.place(milliseconds(60_000), None), Place::Incredible);
        assert_eq!(
            timeline.place(milliseconds(60_040), None),
            next(1502, 1499, 60_040)
        );
    }

    #[test]
    fn years_are_never_believed() {
        let year = 31_536_000_000;
        let mut timeline = Timeline::new(milliseconds(40), false);
        assert_eq!(timeline.place(milliseconds(-year), None), next(1, 0, 0));
        assert_eq!(timeline.place(milliseconds(40 - year), None), next(2, 0, 40));
        assert_eq!(timeline.place(milliseconds(year), None), Place::Incredible);
        assert_eq!(
            timeline.place(milliseconds(year + 40), None),
            Place::Reset {
                number: 3,
                missing: 0,
                time: milliseconds(80)
            }
        );
        assert_eq!(timeline.place(milliseconds(year + 80), None), next(4, 0, 120));
    }

    #[test]
    fn a_live_clock_that_was_set_back_goes_on() {
        let mut timeline = Timeline::new(milliseconds(40), true);
        timeline.place(milliseconds(0), None);
        timeline.place(milliseconds(5000), None);
        assert_eq!(timeline.place(milliseconds(0), None), Place::Incredible);
        assert_eq!(
            timeline.place(milliseconds(40), None),
            Place::Reset {
                number: 127,
                missing: 0,
                time: milliseconds(5040)
            }
        );
        assert_eq!(timeline.place(milliseconds(80), None), next(128, 0, 5080));
    }

    #[test]
    fn a_live_source_that_begins_anew_goes_on_at_its_arrival() {
        let mut timeline = Timeline::new(milliseconds(40), true);
        timeline.place(milliseconds(0), Some(milliseconds(10)));
        timeline.place(milliseconds(5000), Some(milliseconds(5010)));
        // Three seconds later the sender is back with a clock that begins at 0, or at whatever it likes.
        for far in [0, 3_600_000] {
            let mut timeline = timeline.clone();
            let first = timeline.place(milliseconds(far), Some(milliseconds(8010)));
            assert_eq!(first, Place::Incredible);
            assert_eq!(
                timeline.place(milliseconds(far + 40), Some(milliseconds(8050))),
                Place::Reset {
                    number: 202,
                    missing: 75,
                    time: milliseconds(8050)
                }
            );
            let next = next(203, 0, 8090);
            assert_eq!(
                timeline.place(milliseconds(far + 80), Some(milliseconds(8091))),
                next
            );
        }
    }
}
