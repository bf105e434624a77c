//! Whether sensors fit each other: times that overlap, channels that match microphones.

use crate::config::ResolvedRoom;
use crate::error::EngineError;
use hearsight_core::room::Room;
use hearsight_core::source::{AudioSource, VideoSource};
use hearsight_core::{Instant, Span};

/// When a sensor has data; no end where it is not known.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Range {
    name: String,
    start: Instant,
    end: Option<Instant>,
}

impl Range {
    fn overlaps(&self, other: &Self) -> bool {
        let (end, other_end) = (
            self.end.unwrap_or(Instant::FAR_FUTURE),
            other.end.unwrap_or(Instant::FAR_FUTURE),
        );
        self.start < other_end && other.start < end
    }

    fn describe(&self) -> String {
        let start = self.start.seconds();
        match self.end {
            Some(end) => format!(
                "{} has data from {start:.3} s to {:.3} s",
                self.name,
                end.seconds()
            ),
            None => format!("{} has data from {start:.3} s on", self.name),
        }
    }
}

/// When each sensor has data, cameras first.
pub(super) fn ranges(
    room: &Room,
    cameras: &[Box<dyn VideoSource>],
    arrays: &[Box<dyn AudioSource>],
) -> Vec<Range> {
    let video = room.cameras.iter().zip(cameras).map(|(sensor, source)| {
        let format = source.format();
        let length = format.frames.map(|frames| format.interval * frames as i64);
        Range {
            name: sensor.name.clone(),
            start: format.start,
            end: length.map(|length| format.start + length),
        }
    });
    let audio = room.arrays.iter().zip(arrays).map(|(sensor, source)| {
        let format = source.format();
        let length = format
            .samples
            .map(|samples| Span::of_samples(samples as i64, format.rate_hz));
        Range {
            name: sensor.name.clone(),
            start: format.start,
            end: length.map(|length| format.start + length),
        }
    });
    video.chain(audio).collect()
}

/// Where the run begins and ends; for live sources the end is what was asked for, if anything.
pub(super) fn whole(
    ranges: &[Range],
    live: bool,
    configuration: &ResolvedRoom,
) -> (Instant, Option<Instant>) {
    let first = ranges
        .iter()
        .map(|range| range.start)
        .min()
        .unwrap_or(Instant::ZERO);
    let start = configuration.run.from.map_or(first, |from| from.max(first));
    // A file that does not know its length likely ends with the others.
    let last = ranges
        .iter()
        .filter_map(|range| range.end)
        .max()
        .filter(|_| !live);
    let end = match (last, configuration.run.until) {
        (Some(last), Some(until)) => Some(last.min(until)),
        (last, until) => last.or(until),
    };
    (start, end)
}

/// Refuses what cannot be tracked.
pub(super) fn check(room: &Room, ranges: &[Range], configuration: &ResolvedRoom) -> Result<(), EngineError> {
    check_overlap(ranges)?;
    check_limits(ranges, configuration)?;
    for array in &room.arrays {
        if !array.microphones.is_empty() && array.microphones.len() != array.channels {
            return Err(EngineError::Room {
                what: format!(
                    "array `{}`: has {} channels, but {} microphones are given",
                    array.name,
                    array.channels,
                    array.microphones.len()
                ),
                cure: "list one microphone a channel, or pick channels with `channels = [0, 1, ...]`"
                    .to_owned(),
            });
        }
    }
    Ok(())
}

/// Every sensor must share some time with another one.
fn check_overlap(ranges: &[Range]) -> Result<(), EngineError> {
    for (place, range) in ranges.iter().enumerate() {
        let mut others = ranges
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != place)
            .map(|(_, other)| other);
        if ranges.len() > 1 && !others.clone().any(|other| range.overlaps(other)) {
            let other = others.next().map(Range::describe).unwrap_or_default();
            return Err(EngineError::Room {
                what: format!(
                    "{}, which overlaps with no other sensor: {other}",
                    range.describe()
                ),
                cure: "correct `start` (seconds on the common clock), or leave the sensor out".to_owned(),
            });
        }
    }
    Ok(())
}

/// The part of time that is asked for must hold data.
fn check_limits(ranges: &[Range], configuration: &ResolvedRoom) -> Result<(), EngineError> {
    let wanted = Range {
        name: "the run".to_owned(),
        start: configuration
            .run
            .from
            .unwrap_or(Instant::from_nanoseconds(i64::MIN / 4)),
        end: configuration.run.until,
    };
    if ranges.is_empty() || ranges.iter().any(|range| range.overlaps(&wanted)) {
        return Ok(());
    }
    let all: Vec<String> = ranges.iter().map(Range::describe).collect();
    Err(EngineError::Room {
        what: format!(
            "no sensor has data between `from` and `until`: {}",
            all.join(", ")
        ),
        cure: "choose them on the common clock, on which the first sensor's `start` lies".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(name: &str, start_s: f64, end_s: f64) -> Range {
        let end = end_s.is_finite().then(|| Instant::from_seconds(end_s));
        Range {
            name: name.to_owned(),
            start: Instant::from_seconds(start_s),
            end,
        }
    }

    #[test]
    fn sensors_apart_in_time_are_refused() {
        assert!(check_overlap(&[range("a", 0.0, 5.0)]).is_ok());
        assert!(check_overlap(&[range("a", 0.0, 5.0), range("b", 4.9, 9.0), range("c", 8.0, 9.0)]).is_ok());
        assert!(check_overlap(&[range("a", 0.0, f64::INFINITY), range("b", 400.0, 500.0)]).is_ok());
        let error = check_overlap(&[range("a", 0.0, 5.0), range("b", 5.0, 9.0)])
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("a has data from 0.000 s to 5.000 s") && error.contains("b has data"),
            "{error}"
        );
    }
}
