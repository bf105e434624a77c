//! Faces as cameras see them, lines of sight without a distance, and how late the tracker that follows them is.
//!
//! A tracker lags behind whom it follows, and no sound tells its lag from a late clock. Faces that a detector finds anew
//! in a picture do not lag: how far the track is behind them, against how fast it moves, is the lag.

use super::INDEPENDENT_S;
use hearsight_core::{Instant, Ray, Span};
use nalgebra::{Unit, Vector3};

/// A mouth in one camera's picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceSight {
    /// Number of the camera.
    pub camera: usize,
    /// Whose, as far as this camera can tell.
    pub track: u64,
    /// When the picture was taken.
    pub time: Instant,
    /// From the camera through the mouth.
    pub ray: Ray,
    /// Standard deviation of the ray's direction, radians, above 0.
    pub deviation_rad: f64,
    /// Distance along the ray that the size of the face speaks for and its standard deviation, metres.
    pub range_m: Option<(f64, f64)>,
}

/// How late a tracker is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// Seconds.
    pub lag_s: f64,
    /// Its standard deviation.
    pub deviation_s: f64,
    /// Faces that it was measured by.
    pub faces: usize,
}

impl Lag {
    /// What is taken where too few faces are found anew: trackers of heads were measured at 0.08 and 0.12 seconds.
    pub const USUAL: Self = Self {
        lag_s: 0.1,
        deviation_s: 0.04,
        faces: 0,
    };
}

/// A mouth is known between two sights not farther apart than this.
pub(super) const LONGEST_GAP: Span = Span::from_nanoseconds(300_000_000);
/// Lags are tried from the first to the last in steps, seconds.
const LAGS_S: (f64, f64, f64) = (-0.1, 0.35, 0.01);
/// So many that count once are needed,
const LEAST_COUNTS: usize = 6;
/// and a deviation of no more than this, seconds.
const LARGEST_DEVIATION_S: f64 = 0.04;
/// However many faces there are, a detector puts them before the heads of people who walk: standard deviation, seconds. Of
/// AV16.3's sequence 30 the faces tell 0.08 where the annotated mouths tell 0.11.
const FACE_DEVIATION_S: f64 = 0.02;

/// Sights by camera and track, each track's in order of time.
pub(super) fn tracks(sights: &[FaceSight]) -> Vec<Vec<FaceSight>> {
    let usable = |sight: &&FaceSight| {
        let ray = &sight.ray;
        let numbers = ray.origin.0.iter().chain(ray.direction.iter());
        numbers
            .chain([&sight.deviation_rad])
            .all(|value| value.is_finite())
            && sight.deviation_rad > 0.0
    };
    let mut sorted: Vec<FaceSight> = sights.iter().filter(usable).copied().collect();
    sorted.sort_by_key(|sight| (sight.camera, sight.track, sight.time));
    sorted.dedup_by_key(|sight| (sight.camera, sight.track, sight.time));
    let same = |one: &FaceSight, other: &FaceSight| (one.camera, one.track) == (other.camera, other.track);
    sorted.chunk_by(same).map(<[FaceSight]>::to_vec).collect()
}

/// The two around a time, of those in order of time, and how far it is from the first to the second, 0 to 1; none where
/// they are too far apart.
pub(super) fn around<T>(all: &[T], time: Instant, of: impl Fn(&T) -> Instant) -> Option<(&T, &T, f64)> {
    let after = all.partition_point(|one| of(one) < time);
    let last = all.get(after)?;
    let Some(first) = after.checked_sub(1).and_then(|before| all.get(before)) else {
        return (of(last) == time).then_some((last, last, 0.0));
    };
    let gap = of(last) - of(first);
    let part = (time - of(first)).seconds() / gap.seconds().max(1e-9);
    (gap <= LONGEST_GAP).then_some((first, last, part))
}

/// A track between two of its sights.
pub(super) fn between(track: &[FaceSight], time: Instant) -> Option<FaceSight> {
    let (first, last, part) = around(track, time, |sight| sight.time)?;
    let mix = |one: f64, other: f64| one + (other - one) * part;
    let direction = first.ray.direction.lerp(&last.ray.direction, part);
    Some(FaceSight {
        time,
        ray: Ray {
            origin: first.ray.origin,
            direction: Unit::new_normalize(direction),
        },
        deviation_rad: mix(first.deviation_rad, last.deviation_rad),
        range_m: match (first.range_m, last.range_m) {
            (Some(one), Some(other)) => Some((mix(one.0, other.0), mix(one.1, other.1))),
            _ => None,
        },
        ..*first
    })
}

/// One face found anew beside its track.
struct Beside<'a> {
    found: &'a FaceSight,
    track: &'a [FaceSight],
    /// Level and across the line of sight.
    across: Vector3<f64>,
}

impl Beside<'_> {
    /// How far the face is before the track, radians, were the track so late.
    fn ahead_rad(&self, lag_s: f64) -> Option<f64> {
        let followed = between(self.track, self.found.time + Span::from_seconds(lag_s))?;
        Some((self.found.ray.direction.into_inner() - followed.ray.direction.into_inner()).dot(&self.across))
    }

    fn residual(&self, lag_s: f64) -> Option<f64> {
        Some(self.ahead_rad(lag_s)? / self.found.deviation_rad)
    }
}

/// How late the tracks of `followed` are, by faces found anew in single pictures near a track of the same camera and
/// number. None where too few are found, or none moves.
pub fn measure_lag(followed: &[FaceSight], found: &[FaceSight]) -> Option<Lag> {
    let tracks = tracks(followed);
    let found = self::tracks(found);
    // Faces and lags are the same in all sums: those of which the track is not known at some lag take no part.
    let beside: Vec<Beside<'_>> = found
        .iter()
        .flatten()
        .filter_map(|found| {
            let key = |track: &&Vec<FaceSight>| {
                track.first().map(|sight| (sight.camera, sight.track)) == Some((found.camera, found.track))
            };
            let across = Vector3::z().cross(&found.ray.direction).try_normalize(1e-6)?;
            let beside = Beside {
                found,
                track: tracks.iter().find(key)?,
                across,
            };
            lags()
                .all(|lag_s| beside.ahead_rad(lag_s).is_some())
                .then_some(beside)
        })
        .collect();
    let mut counts: Vec<(usize, u64, i64)> = beside
        .iter()
        .map(|beside| {
            let slot = (beside.found.time - Instant::ZERO).seconds() / INDEPENDENT_S;
            (beside.found.camera, beside.found.track, slot.floor() as i64)
        })
        .collect();
    counts.dedup();
    if counts.len() < LEAST_COUNTS {
        return None;
    }
    let cost = |lag_s: f64| -> f64 {
        let residuals = beside.iter().filter_map(|beside| beside.residual(lag_s));
        residuals.map(|r| r * r / (1.0 + r * r)).sum()
    };
    let lag_s = lags().min_by(|one, other| cost(*one).total_cmp(&cost(*other)))?;
    // A step of Gauss and Newton from the best lag, weighted as the cost is.
    let half_s = 0.02;
    let (mut curvature, mut slope, mut squares, mut weights) = (0.0, 0.0, 0.0, 0.0);
    for beside in &beside {
        let ends = (beside.residual(lag_s + half_s), beside.residual(lag_s - half_s));
        let (Some(residual), (Some(later), Some(earlier))) = (beside.residual(lag_s), ends) else {
            continue;
        };
        let weight = (1.0 + residual * residual).powi(-2);
        let change = (later - earlier) / (2.0 * half_s);
        curvature += weight * change * change;
        slope += weight * change * residual;
        squares += weight * residual * residual;
        weights += weight;
    }
    let step_s = (-slope / curvature).clamp(-LAGS_S.2, LAGS_S.2);
    let inflation = beside.len() as f64 / counts.len() as f64;
    let deviation_s = (squares / weights.max(1e-9) / curvature * inflation)
        .sqrt()
        .hypot(FACE_DEVIATION_S);
    let lag = Lag {
        lag_s: lag_s + step_s,
        deviation_s,
        faces: beside.len(),
    };
    (lag.lag_s.is_finite() && lag.deviation_s <= LARGEST_DEVIATION_S).then_some(lag)
}

fn lags() -> impl Iterator<Item = f64> {
    let (first, last, step) = LAGS_S;
    let count = ((last - first) / step).round() as u32;
    (0..=count).map(move |number| first + f64::from(number) * step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight_core::WorldPoint;

    fn sight(seconds: f64, angle_rad: f64, track: u64) -> FaceSight {
        FaceSight {
            camera: 0,
            track,
            time: Instant::ZERO + Span::from_seconds(seconds),
            ray: Ray {
                origin: WorldPoint::new(0.0, 0.0, 1.5),
                direction: Unit::new_normalize(Vector3::new(angle_rad.cos(), angle_rad.sin(), -0.1)),
            },
            deviation_rad: 0.01,
            range_m: None,
        }
    }

    fn angle(seconds: f64) -> f64 {
        0.3 * (0.8 * seconds).sin()
    }

    fn followed(late_s: f64) -> Vec<FaceSight> {
        let ticks = (0..500).map(|tick| f64::from(tick) * 0.04);
        ticks
            .map(|seconds| sight(seconds, angle(seconds - late_s), 1))
            .collect()
    }

    /// One face a third of a second, every fifth a mistake.
    fn found() -> Vec<FaceSight> {
        let at = |number: u32| {
            let seconds = 1.0 + f64::from(number) / 3.0;
            let wrong = if number.is_multiple_of(5) {
                0.08
            } else {
                0.004 * f64::from(number % 3) - 0.004
            };
            sight(seconds, angle(seconds) + wrong, 1)
        };
        (0..50).map(at).collect()
    }

    #[test]
    fn the_lag_of_a_track_is_seen_by_faces_that_do_not_lag() {
        for late_s in [0.0, 0.12] {
            let lag = measure_lag(&followed(late_s), &found()).unwrap();
            assert!((lag.lag_s - late_s).abs() < 0.01, "{lag:?}");
            assert!(
                lag.deviation_s >= FACE_DEVIATION_S && lag.deviation_s < 0.03,
                "{lag:?}"
            );
        }
    }

    #[test]
    fn of_who_stands_still_or_is_hardly_found_no_lag_is_told() {
        let still: Vec<FaceSight> = (0..500)
            .map(|tick| sight(f64::from(tick) * 0.04, 0.1, 1))
            .collect();
        let found_still: Vec<FaceSight> = (0..50).map(|n| sight(1.0 + f64::from(n) / 3.0, 0.1, 1)).collect();
        assert_eq!(measure_lag(&still, &found_still), None);
        assert_eq!(measure_lag(&followed(0.1), &found()[..5]), None);
        assert_eq!(measure_lag(&followed(0.1), &[]), None);
    }
}
