//! Where the lines of sight of several cameras meet: mouths in the room, without the size of a face.
//!
//! Tracks of two cameras are of one person where their rays pass one another within their deviations for as long as both
//! are seen. People as tall as the cameras stand are in one plane with all of them, so that rays of different people may
//! meet too: tracks are put together only where no two of one camera would be one person at one time.

use super::Sighting;
use super::sights::{FaceSight, LONGEST_GAP, between, tracks};
use hearsight_core::{Instant, Ray, Span, WorldPoint};
use nalgebra::{Matrix3, Vector3};

/// Tracks must be seen together for so long, seconds,
const LEAST_TOGETHER_S: f64 = 1.5;
/// their rays within so many deviations of one another
const GATE: f64 = 3.0;
/// in this share of the pictures,
const LEAST_SHARE: f64 = 0.9;
/// and within so many in half of them.
const MEDIAN: f64 = 1.0;
/// Two tracks of one camera that are seen together for longer than this are two people, seconds.
const LONGEST_TWICE_S: f64 = 0.2;
/// A mouth is not where a box of a head says, however many cameras see it: standard deviation, metres.
const MOUTH_M: f64 = 0.04;
/// Nobody is nearer to a camera, metres.
const NEAREST_M: f64 = 0.2;
/// Places are not computed more often than this.
const APART: Span = Span::from_nanoseconds(20_000_000);
/// Rounds in which weights follow the distance.
const ROUNDS: usize = 3;

/// The mouths of people seen by two cameras or more; where nobody is, those of which the size of the face tells the
/// distance. `lag_s`: how late the tracks are.
pub fn sightings(sights: &[FaceSight], lag_s: f64) -> Vec<Sighting> {
    let tracks = tracks(sights);
    let groups = groups(&tracks);
    let lag = Span::from_seconds(lag_s);
    let mut met: Vec<Sighting> = Vec::new();
    for (person, group) in (0_u64..).zip(&groups) {
        let mut times: Vec<Instant> = group
            .iter()
            .flat_map(|&track| &tracks[track])
            .map(|sight| sight.time)
            .collect();
        times.sort_unstable();
        let mut last = None;
        for time in times {
            if last.is_some_and(|last| time - last < APART) {
                continue;
            }
            let seen: Vec<FaceSight> = group
                .iter()
                .filter_map(|&track| between(&tracks[track], time))
                .collect();
            let Some((mouth, covariance)) = meet(&seen) else {
                continue;
            };
            last = Some(time);
            met.push(Sighting {
                time: time - lag,
                person,
                mouth,
                covariance,
            });
        }
    }
    if met.is_empty() {
        let sizes = (0_u64..).zip(&tracks);
        met.extend(
            sizes.flat_map(|(person, track)| {
                track.iter().filter_map(move |sight| by_size(sight, person, lag))
            }),
        );
    }
    met
}

fn by_size(sight: &FaceSight, person: u64, lag: Span) -> Option<Sighting> {
    let (range_m, deviation_m) = sight.range_m?;
    let direction = sight.ray.direction.into_inner();
    let along = direction * direction.transpose();
    let across = (sight.deviation_rad * range_m).powi(2);
    Some(Sighting {
        time: sight.time - lag,
        person,
        mouth: sight.ray.at(range_m),
        covariance: (Matrix3::identity() - along) * across + along * deviation_m.powi(2),
    })
}

/// How well two tracks agree: seconds seen together, and the rays' distance in deviations in the median, if they may be
/// one person.
fn agreement(one: &[FaceSight], other: &[FaceSight]) -> Option<(f64, f64)> {
    let (mut together_s, mut last): (f64, Option<Instant>) = (0.0, None);
    let mut gaps = Vec::new();
    for sight in one {
        let Some(seen) = between(other, sight.time) else {
            continue;
        };
        if let Some(step) = last.map(|last| sight.time - last)
            && step <= LONGEST_GAP
        {
            together_s += step.seconds();
        }
        last = Some(sight.time);
        gaps.push(gap(sight, &seen));
    }
    if together_s < LEAST_TOGETHER_S {
        return None;
    }
    gaps.sort_by(f64::total_cmp);
    let close = gaps.partition_point(|gap| *gap < GATE) as f64 / gaps.len() as f64;
    let median = gaps[gaps.len() / 2];
    (close >= LEAST_SHARE && median < MEDIAN).then_some((together_s, median))
}

/// Distance of two rays in units of its deviation; infinite where they meet behind a camera or are parallel.
fn gap(one: &FaceSight, other: &FaceSight) -> f64 {
    let (a, b) = (one.ray.direction.into_inner(), other.ray.direction.into_inner());
    let between = other.ray.origin.0 - one.ray.origin.0;
    let cosine = a.dot(&b);
    let determinant = 1.0 - cosine * cosine;
    let on_one = (between.dot(&a) - cosine * between.dot(&b)) / determinant;
    let on_other = (cosine * between.dot(&a) - between.dot(&b)) / determinant;
    if !(determinant > 1e-4 && on_one > NEAREST_M && on_other > NEAREST_M) {
        return f64::INFINITY;
    }
    let apart = (one.ray.at(on_one).0 - other.ray.at(on_other).0).norm();
    apart / (one.deviation_rad * on_one).hypot(other.deviation_rad * on_other)
}

/// Whether two tracks of one camera are seen at the same time.
fn exclude(one: &[FaceSight], other: &[FaceSight]) -> bool {
    let ([one_first, .., one_last], [other_first, .., other_last]) = (one, other) else {
        return false;
    };
    let together = one_last.time.min(other_last.time) - one_first.time.max(other_first.time);
    one_first.camera == other_first.camera && together.seconds() > LONGEST_TWICE_S
}

/// Tracks of one person each, two cameras or more; those seen together longest are put together first.
fn groups(tracks: &[Vec<FaceSight>]) -> Vec<Vec<usize>> {
    let mut agreeing = Vec::new();
    for one in 0..tracks.len() {
        for other in one + 1..tracks.len() {
            let cameras = [one, other].map(|track| tracks[track].first().map(|sight| sight.camera));
            if cameras[0] == cameras[1] {
                continue;
            }
            if let Some((together_s, median)) = agreement(&tracks[one], &tracks[other]) {
                agreeing.push((together_s, median, one, other));
            }
        }
    }
    agreeing.sort_by(|one, other| other.0.total_cmp(&one.0).then(one.1.total_cmp(&other.1)));
    let mut of: Vec<usize> = (0..tracks.len()).collect();
    for (_, _, one, other) in agreeing {
        let (into, from) = (of[one], of[other]);
        let members = |group: usize| {
            let of = &of;
            (0..of.len()).filter(move |&track| of[track] == group)
        };
        let clash = members(into).any(|a| members(from).any(|b| exclude(&tracks[a], &tracks[b])));
        if into != from && !clash {
            for group in &mut of {
                if *group == from {
                    *group = into;
                }
            }
        }
    }
    (0..tracks.len())
        .map(|group| {
            (0..tracks.len())
                .filter(|&track| of[track] == group)
                .collect::<Vec<_>>()
        })
        .filter(|group| group.len() > 1)
        .collect()
}

/// The point that suits all rays, weighted with their deviations, if it suits each.
fn meet(seen: &[FaceSight]) -> Option<(WorldPoint, Matrix3<f64>)> {
    let across = |ray: &Ray| {
        let direction = ray.direction.into_inner();
        Matrix3::identity() - direction * direction.transpose()
    };
    let mut cameras: Vec<usize> = seen.iter().map(|sight| sight.camera).collect();
    cameras.sort_unstable();
    cameras.dedup();
    if cameras.len() < 2 {
        return None;
    }
    let mut ranges_m = vec![1.0; seen.len()];
    let mut met: Option<(Vector3<f64>, Matrix3<f64>)> = None;
    for _ in 0..ROUNDS {
        let (mut weight, mut side) = (Matrix3::zeros(), Vector3::zeros());
        for (sight, range_m) in seen.iter().zip(&ranges_m) {
            let own = across(&sight.ray) / (sight.deviation_rad * range_m).powi(2);
            weight += own;
            side += own * sight.ray.origin.0.coords;
        }
        let covariance = weight.try_inverse()?;
        let point = covariance * side;
        for (sight, range_m) in seen.iter().zip(&mut ranges_m) {
            *range_m = (point - sight.ray.origin.0.coords).dot(&sight.ray.direction);
            if !range_m.is_finite() || *range_m < NEAREST_M {
                return None;
            }
        }
        met = Some((point, covariance));
    }
    let (point, covariance) = met?;
    let suits = seen.iter().zip(&ranges_m).all(|(sight, range_m)| {
        let beside = (across(&sight.ray) * (point - sight.ray.origin.0.coords)).norm();
        beside < GATE * sight.deviation_rad * range_m
    });
    let covariance = covariance + Matrix3::identity() * MOUTH_M.powi(2);
    suits.then_some((WorldPoint(point.into()), covariance))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Unit;

    const CAMERAS: [[f64; 3]; 3] = [[0.0, 0.0, 1.8], [4.0, 0.2, 1.9], [2.0, 4.0, 1.7]];

    fn place(person: u64, seconds: f64) -> WorldPoint {
        let way = 0.8 * (0.7 * seconds).sin();
        match person {
            0 => WorldPoint::new(1.6 + way, 1.4, 1.5),
            _ => WorldPoint::new(2.2, 2.3 - way, 1.65),
        }
    }

    /// A track, from second to second; `wrong_m`: how far its rays miss the mouth.
    fn track(
        camera: usize,
        person: u64,
        number: u64,
        seconds: std::ops::Range<f64>,
        wrong_m: f64,
    ) -> Vec<FaceSight> {
        let count = ((seconds.end - seconds.start) * 25.0) as u32;
        // Every camera takes its pictures at times of its own.
        let at = |tick: u32| seconds.start + (f64::from(tick) + 0.3 * camera as f64) * 0.04;
        let sight = |tick: u32| {
            let origin = WorldPoint(CAMERAS[camera].into());
            let target = place(person, at(tick)).0 + Vector3::new(0.0, 0.0, wrong_m * f64::from(tick).sin());
            let range_m = (target - origin.0).norm();
            FaceSight {
                camera,
                track: number,
                time: Instant::ZERO + Span::from_seconds(at(tick)),
                ray: Ray {
                    origin,
                    direction: Unit::new_normalize(target - origin.0),
                },
                deviation_rad: 0.012,
                range_m: Some((1.2 * range_m, 0.2 * range_m)),
            }
        };
        (0..count).map(sight).collect()
    }

    #[test]
    fn two_people_before_three_cameras_are_matched_and_placed() {
        let mut sights = Vec::new();
        for camera in 0..3 {
            sights.extend(track(camera, 0, 7, 0.0..8.0, 0.02));
            sights.extend(track(camera, 1, 9, 0.0..4.0, 0.02));
            // The second is lost and found again under another number.
            sights.extend(track(camera, 1, 11, 4.5..8.0, 0.02));
        }
        let lag_s = 0.1;
        let met = sightings(&sights, lag_s);
        assert!(met.len() > 500, "{}", met.len());
        let (mut squared, mut errors_m) = (0.0, Vec::new());
        for sighting in &met {
            let seconds = (sighting.time - Instant::ZERO).seconds() + lag_s;
            let error = |person: u64| sighting.mouth.0 - place(person, seconds).0;
            let error = if error(0).norm() < error(1).norm() {
                error(0)
            } else {
                error(1)
            };
            errors_m.push(error.norm());
            squared += error.dot(&(sighting.covariance.try_inverse().unwrap() * error));
        }
        errors_m.sort_by(f64::total_cmp);
        assert!(errors_m[errors_m.len() - 1] < 0.05, "{errors_m:?}");
        assert!(squared / (met.len() as f64) < 3.0);
    }

    #[test]
    fn rays_that_pass_one_another_are_of_two_people() {
        let mut sights = track(0, 0, 1, 0.0..8.0, 0.0);
        sights.extend(track(1, 1, 1, 0.0..8.0, 0.0));
        let met = sightings(&sights, 0.0);
        // Nobody is seen twice: sizes tell the distances, badly.
        assert_eq!(met.len(), 400);
        assert!(met.iter().all(|sighting| sighting.covariance.trace() > 0.05));
    }

    #[test]
    fn two_tracks_of_one_camera_at_one_time_are_not_one_person() {
        let mut sights = track(0, 0, 1, 0.0..8.0, 0.0);
        sights.extend(track(1, 0, 1, 0.0..8.0, 0.0));
        sights.extend(track(1, 0, 2, 3.0..8.0, 0.0));
        let grouped = groups(&tracks(&sights));
        assert_eq!(grouped, vec![vec![0, 1]]);
    }
}
