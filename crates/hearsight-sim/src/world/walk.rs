//! A walk along way-points: a speed that ramps up and down, corners that are rounded.

use super::ease::{mix_angles, smooth};
use nalgebra::{Point2, Vector2};

/// How fast people gain and lose speed, metres a second squared.
pub const ACCELERATION_M_S2: f64 = 1.2;
/// Corners are rounded over this length before and after, metres.
const ROUNDING_M: f64 = 0.25;
/// Places that a rounded one is the mean of.
const ROUNDING_STEPS: usize = 12;
/// A walk begins in the direction in which somebody stands and turns over this length, metres.
const TURN_IN_M: f64 = 0.6;

/// One walk without a stop. Time 0 is its beginning.
#[derive(Clone, Debug, PartialEq)]
pub struct Walk {
    points: Vec<Point2<f64>>,
    /// Length of the way up to each point, metres.
    lengths: Vec<f64>,
    /// Where the walker faces before, radians.
    facing_rad: f64,
    /// Speed between the ramps, metres a second.
    speed_m_s: f64,
}

impl Walk {
    /// A walk through these points at this speed, from where the walker faces. Points at one place count once.
    pub fn new(points: &[Point2<f64>], facing_rad: f64, speed_m_s: f64) -> Self {
        let mut kept: Vec<Point2<f64>> = Vec::with_capacity(points.len());
        let mut lengths = Vec::with_capacity(points.len());
        for point in points {
            match (kept.last(), lengths.last()) {
                (Some(last), Some(length)) => {
                    let step = (point - last).norm();
                    if step > 1e-9 {
                        lengths.push(length + step);
                        kept.push(*point);
                    }
                }
                _ => {
                    lengths.push(0.0);
                    kept.push(*point);
                }
            }
        }
        Self {
            points: kept,
            lengths,
            facing_rad,
            speed_m_s,
        }
    }

    /// Length of the way, metres.
    pub fn length_m(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// How long it takes, seconds.
    pub fn seconds(&self) -> f64 {
        let (length, speed) = (self.length_m(), self.top_speed_m_s());
        if length <= 0.0 {
            return 0.0;
        }
        length / speed + speed / ACCELERATION_M_S2
    }

    /// The speed that is reached: on a short way less than what is asked for.
    pub fn top_speed_m_s(&self) -> f64 {
        self.speed_m_s.min((self.length_m() * ACCELERATION_M_S2).sqrt())
    }

    /// How far the walker has come, metres, and how fast they are, metres a second.
    pub fn progress(&self, time_s: f64) -> (f64, f64) {
        let (top, length, whole) = (self.top_speed_m_s(), self.length_m(), self.seconds());
        let ramp = top / ACCELERATION_M_S2;
        let time = time_s.clamp(0.0, whole);
        if time < ramp {
            return (0.5 * ACCELERATION_M_S2 * time * time, ACCELERATION_M_S2 * time);
        }
        let left = whole - time;
        if left < ramp {
            return (
                length - 0.5 * ACCELERATION_M_S2 * left * left,
                ACCELERATION_M_S2 * left,
            );
        }
        (top * (time - 0.5 * ramp), top)
    }

    /// The place after this much of the way, corners rounded.
    pub fn place(&self, way_m: f64) -> Point2<f64> {
        let length = self.length_m();
        let way = way_m.clamp(0.0, length);
        let half = ROUNDING_M.min(way).min(length - way);
        if self.points.len() < 3 || half <= 0.0 {
            return self.sharp(way);
        }
        let sum: Vector2<f64> = (0..ROUNDING_STEPS)
            .map(|step| {
                let part = (step as f64 + 0.5) / ROUNDING_STEPS as f64 * 2.0 - 1.0;
                self.sharp(way + half * part).coords
            })
            .sum();
        Point2::from(sum / ROUNDING_STEPS as f64)
    }

    /// Where the walker faces after this much of the way, radians.
    pub fn facing(&self, way_m: f64) -> f64 {
        let (before, after) = (self.place(way_m - 0.15), self.place(way_m + 0.15));
        let ahead = after - before;
        if ahead.norm() < 1e-9 {
            return self.facing_rad;
        }
        let heading = ahead.y.atan2(ahead.x);
        let turn_in = TURN_IN_M.min(self.length_m());
        mix_angles(self.facing_rad, heading, smooth(way_m / turn_in))
    }

    fn sharp(&self, way_m: f64) -> Point2<f64> {
        let leg = self.lengths.partition_point(|length| *length <= way_m);
        let (Some(from), Some(to)) = (self.points.get(leg.wrapping_sub(1)), self.points.get(leg)) else {
            return self.points.last().copied().unwrap_or_else(Point2::origin);
        };
        let (start, end) = (self.lengths[leg - 1], self.lengths[leg]);
        from + (to - from) * ((way_m - start) / (end - start))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walk(speed: f64) -> Walk {
        let points = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.5]].map(Point2::from);
        Walk::new(&points, 0.3, speed)
    }

    #[test]
    fn walks_begin_and_end_at_rest_and_never_leap() {
        for speed in [0.3, 1.2, 9.0] {
            let walk = walk(speed);
            let step = 1e-3;
            let mut last = (walk.place(0.0), 0.0);
            let mut time = 0.0;
            while time <= walk.seconds() {
                let (way, now) = walk.progress(time);
                let place = walk.place(way);
                assert!((place - last.0).norm() <= 1.01 * step * walk.top_speed_m_s() + 1e-12);
                assert!((now - last.1).abs() <= 1.01 * step * ACCELERATION_M_S2);
                last = (place, now);
                time += step;
            }
            assert!((walk.progress(walk.seconds()).0 - 3.5).abs() < 1e-9);
            assert!((walk.place(3.5) - Point2::new(2.0, 1.5)).norm() < 1e-9);
            assert!((walk.facing(3.5) - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
            assert_eq!(walk.facing(0.0), 0.3);
        }
    }

    #[test]
    fn a_corner_is_cut_by_a_few_centimetres() {
        let place = walk(1.0).place(2.0);
        let off = (place - Point2::new(2.0, 0.0)).norm();
        assert!((0.05..0.2).contains(&off), "{off}");
    }
}
