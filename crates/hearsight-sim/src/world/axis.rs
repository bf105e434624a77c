//! One axis of a drive: it goes where it is sent, never faster than it can and never accelerating harder.

/// What an axis can do. Units are those of the axis: radians, metres or factors, a second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// The smallest position.
    pub low: f64,
    /// The largest position.
    pub high: f64,
    /// The largest speed.
    pub speed: f64,
    /// The largest acceleration.
    pub acceleration: f64,
}

/// An axis and all orders that it received; answers for any time.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    limits: AxisLimits,
    profiles: Vec<Profile>,
}

/// What follows from one order: up to three phases of constant acceleration, then rest.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Profile {
    from_s: f64,
    position: f64,
    speed: f64,
    /// Duration and acceleration.
    phases: [(f64, f64); 3],
}

impl Axis {
    /// An axis at rest.
    pub fn new(limits: AxisLimits, position: f64) -> Self {
        let rest = Profile {
            from_s: f64::NEG_INFINITY,
            position: position.clamp(limits.low, limits.high),
            speed: 0.0,
            phases: [(0.0, 0.0); 3],
        };
        Self {
            limits,
            profiles: vec![rest],
        }
    }

    /// Sends it to a position, no faster than `speed` and its own limit, from a time on: an earlier one than that of
    /// the last order counts as that.
    pub fn go(&mut self, from_s: f64, to: f64, speed: f64) {
        let from_s = self
            .profiles
            .last()
            .map_or(from_s, |last| from_s.max(last.from_s));
        let [position, now] = self.at(from_s);
        let to = to.clamp(self.limits.low, self.limits.high);
        let top = speed.abs().min(self.limits.speed).max(1e-9);
        self.profiles.push(Profile {
            from_s,
            position,
            speed: now,
            phases: phases(to - position, now, top, self.limits.acceleration),
        });
    }

    /// Sends it on at a speed, as far as it goes; 0 brakes.
    pub fn turn(&mut self, from_s: f64, speed: f64) {
        if speed == 0.0 || !speed.is_finite() {
            let from_s = self
                .profiles
                .last()
                .map_or(from_s, |last| from_s.max(last.from_s));
            let [position, now] = self.at(from_s);
            let braking = now * now.abs() / (2.0 * self.limits.acceleration);
            self.go(from_s, position + braking, self.limits.speed);
        } else if speed > 0.0 {
            self.go(from_s, self.limits.high, speed);
        } else {
            self.go(from_s, self.limits.low, speed);
        }
    }

    /// Position and speed at a time.
    pub fn at(&self, time_s: f64) -> [f64; 2] {
        let next = self.profiles.partition_point(|profile| profile.from_s <= time_s);
        let Some(profile) = self.profiles.get(next.saturating_sub(1)) else {
            return [0.0; 2];
        };
        let (mut position, mut speed) = (profile.position, profile.speed);
        // The first profile lasts since ever, and rests.
        let mut left = if profile.from_s.is_finite() {
            time_s - profile.from_s
        } else {
            0.0
        };
        for (duration, acceleration) in profile.phases {
            let step = duration.min(left).max(0.0);
            position += speed * step + 0.5 * acceleration * step * step;
            speed += acceleration * step;
            left -= step;
            if left <= 0.0 {
                return [position.clamp(self.limits.low, self.limits.high), speed];
            }
        }
        [position.clamp(self.limits.low, self.limits.high), 0.0]
    }
}

/// The fastest way over `distance` to rest, from `speed`, at most `top` fast.
fn phases(distance: f64, speed: f64, top: f64, acceleration: f64) -> [(f64, f64); 3] {
    let braking = speed * speed.abs() / (2.0 * acceleration);
    let direction = if distance >= braking { 1.0 } else { -1.0 };
    let (way, begin) = (direction * distance, direction * speed);
    let peak = (acceleration * way + 0.5 * begin * begin)
        .max(0.0)
        .sqrt()
        .min(top);
    // Who is faster than they may be brakes first.
    let first = (
        (peak - begin).abs() / acceleration,
        direction * acceleration * (peak - begin).signum(),
    );
    let covered = 0.5 * (begin + peak) * first.0 + 0.5 * peak * peak / acceleration;
    let cruise = if peak > 0.0 {
        ((way - covered) / peak).max(0.0)
    } else {
        0.0
    };
    [
        first,
        (cruise, 0.0),
        (peak / acceleration, -direction * acceleration),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis() -> Axis {
        let limits = AxisLimits {
            low: -2.0,
            high: 2.0,
            speed: 1.4,
            acceleration: 8.0,
        };
        Axis::new(limits, 0.0)
    }

    #[test]
    fn orders_are_obeyed_within_the_limits() {
        let mut axis = axis();
        assert_eq!(axis.at(-5.0), [0.0, 0.0]);
        axis.go(1.0, 1.5, 99.0);
        axis.go(1.5, -1.0, 1.0);
        axis.turn(4.5, 0.7);
        axis.turn(6.0, 0.0);
        axis.turn(7.0, -9.0);
        let step = 1e-4;
        let mut last = axis.at(0.0);
        for number in 1..120_000 {
            let now = axis.at(f64::from(number) * step);
            assert!(now[1].abs() <= 1.4 + 1e-9, "{now:?}");
            assert!((now[0] - last[0]).abs() <= 1.4 * step + 1e-9);
            assert!(
                (now[1] - last[1]).abs() <= 8.0 * step + 1e-9,
                "{number} {last:?} {now:?}"
            );
            last = now;
        }
        assert!((axis.at(4.4)[0] + 1.0).abs() < 1e-9);
        let steady = axis.at(5.5);
        assert!((steady[1] - 0.7).abs() < 1e-9);
        assert_eq!(axis.at(6.9)[1], 0.0);
        assert_eq!(axis.at(11.0), [-2.0, 0.0]);
    }
}
