//! The time of every sample of a stream of blocks: what to fill, what to skip, when to start anew.
//!
//! Shared by whatever consumes blocks, so that a gap means the same to all of them.

use crate::error::{AudioError, MOST_COUNTED, check_setting, check_shape, check_state};
use hearsight_core::{AudioBlock, Instant, Span};
use serde::{Deserialize, Serialize};

/// A block whose time is this near to the expected one follows on without a gap: the clock is followed, no sample is
/// added or left out. Wider than the jitter of time stamps, narrower than any lost packet.
const TOLERANCE: Span = Span::from_nanoseconds(1_000_000);

/// What a block means for the stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Arrival {
    /// Everything before is to be forgotten; the block's first sample opens a new run.
    pub(crate) restart: bool,
    /// Zeros to insert before the block.
    pub(crate) fill: usize,
    /// Samples at the block's start that were already heard.
    pub(crate) skip: usize,
}

/// The clock of a stream of samples. Sample 0 is the first of the current run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Timeline {
    rate_hz: u32,
    longest_fill: Span,
    /// Time and index of the sample from which times are reckoned.
    anchor: Option<(Instant, i64)>,
    /// Index of the sample that comes next.
    next: i64,
}

impl Timeline {
    pub(crate) fn new(rate_hz: u32, longest_fill: Span) -> Result<Self, AudioError> {
        check_setting(rate_hz > 0, "rate_hz", "above 0", f64::from(rate_hz))?;
        let fill_s = longest_fill.seconds();
        check_setting(
            (0.0..=60.0).contains(&fill_s),
            "longest_fill",
            "within 0 and 60 s",
            fill_s,
        )?;
        Ok(Self {
            rate_hz,
            longest_fill,
            anchor: None,
            next: 0,
        })
    }

    /// Checks a timeline that was saved against this one, which is to be replaced by it.
    pub(crate) fn check_saved(&self, saved: &Self) -> Result<(), AudioError> {
        check_state(
            saved.rate_hz == self.rate_hz && saved.longest_fill == self.longest_fill,
            "the rate of the sound and the gaps that are filled",
        )?;
        let counted = 0..=MOST_COUNTED as i64;
        let anchored = saved
            .anchor
            .is_none_or(|(_, index)| (0..=saved.next).contains(&index));
        check_state(
            counted.contains(&saved.next) && anchored,
            "the number of samples heard",
        )
    }

    /// Takes note of a block of `count` samples, the first at `time`.
    pub(crate) fn accept(&mut self, time: Instant, count: usize) -> Arrival {
        let mut arrival = Arrival {
            restart: true,
            fill: 0,
            skip: 0,
        };
        if self.anchor.is_some() {
            arrival.restart = false;
            let late = time - self.time_of(self.next);
            let late_samples = late.samples(self.rate_hz);
            if late.magnitude() <= TOLERANCE {
                if late_samples != 0 {
                    self.anchor = Some((time, self.next));
                }
            } else if late > self.longest_fill {
                arrival.restart = true;
            } else if late_samples > 0 {
                arrival.fill = late_samples as usize;
            } else {
                arrival.skip = count.min(late_samples.unsigned_abs() as usize);
            }
        }
        if arrival.restart {
            self.anchor = Some((time, 0));
            self.next = 0;
        }
        self.next += (arrival.fill + count - arrival.skip) as i64;
        arrival
    }

    /// The instant of a sample of the current run.
    pub(crate) fn time_of(&self, index: i64) -> Instant {
        self.time_at_rate(index, self.rate_hz)
    }

    /// The instant of sample `index` of a stream at another rate whose sample 0 fell on sample 0 of this one.
    pub(crate) fn time_at_rate(&self, index: i64, rate_hz: u32) -> Instant {
        let (time, anchor) = self.anchor.unwrap_or_default();
        // Both offsets as one fraction, rounded once: index / rate - anchor / own rate.
        let scale = i128::from(rate_hz) * i128::from(self.rate_hz);
        let offset = i128::from(index) * i128::from(self.rate_hz) - i128::from(anchor) * i128::from(rate_hz);
        let nanoseconds = (offset * 1_000_000_000 + scale / 2).div_euclid(scale.max(1));
        time + Span::from_nanoseconds(nanoseconds as i64)
    }
}

/// Checks a block against the shape agreed on.
pub(crate) fn check_block(block: &AudioBlock, channels: usize, rate_hz: u32) -> Result<(), AudioError> {
    check_shape("channels of a block", channels, block.channels.len())?;
    check_shape("samples a second", rate_hz as usize, block.rate_hz as usize)?;
    for channel in &block.channels {
        check_shape("samples of a channel", block.len(), channel.len())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(milliseconds: i64) -> Instant {
        Instant::from_nanoseconds(milliseconds * 1_000_000)
    }

    #[test]
    fn gaps_are_filled_overlaps_skipped_and_long_gaps_restart() {
        let mut timeline = Timeline::new(1000, Span::from_seconds(0.5)).unwrap();
        assert!(timeline.accept(at(100), 10).restart);
        assert_eq!(
            timeline.accept(at(110), 10),
            Arrival {
                restart: false,
                fill: 0,
                skip: 0
            }
        );
        assert_eq!(
            timeline.accept(at(125), 10),
            Arrival {
                restart: false,
                fill: 5,
                skip: 0
            }
        );
        assert_eq!(
            timeline.accept(at(130), 10),
            Arrival {
                restart: false,
                fill: 0,
                skip: 5
            }
        );
        assert_eq!(
            timeline.accept(at(0), 10),
            Arrival {
                restart: false,
                fill: 0,
                skip: 10
            }
        );
        assert_eq!(timeline.time_of(timeline.next), at(140));
        assert!(timeline.accept(at(700), 10).restart);
        assert_eq!(timeline.time_of(0), at(700));
    }

    #[test]
    fn a_drifting_clock_is_followed_without_touching_samples() {
        let mut timeline = Timeline::new(16_000, Span::from_seconds(1.0)).unwrap();
        timeline.accept(Instant::ZERO, 1600);
        let drifted = at(100) + Span::from_nanoseconds(200_000);
        assert_eq!(
            timeline.accept(drifted, 1600),
            Arrival {
                restart: false,
                fill: 0,
                skip: 0
            }
        );
        assert_eq!(timeline.time_of(1600), drifted);
    }
}
