//! Small functions that movement is made of.

use std::f64::consts::{PI, TAU};

/// From 0 to 1 without a jump in speed, for `part` from 0 to 1; constant outside.
pub(crate) fn smooth(part: f64) -> f64 {
    let part = part.clamp(0.0, 1.0);
    part * part * (3.0 - 2.0 * part)
}

/// From 0 to 1 without a jump in acceleration, as a hand moves (Flash and Hogan 1985); constant outside.
pub(crate) fn reach(part: f64) -> f64 {
    let part = part.clamp(0.0, 1.0);
    part * part * part * (10.0 + part * (6.0 * part - 15.0))
}

/// Between two numbers.
pub(crate) fn mix(from: f64, to: f64, part: f64) -> f64 {
    from + (to - from) * part
}

/// The angle in -pi to pi that is the same direction, radians.
pub(crate) fn wrap(angle_rad: f64) -> f64 {
    let turned = (angle_rad + PI).rem_euclid(TAU) - PI;
    if turned.is_finite() { turned } else { 0.0 }
}

/// Between two directions the shorter way round, radians.
pub(crate) fn mix_angles(from_rad: f64, to_rad: f64, part: f64) -> f64 {
    from_rad + wrap(to_rad - from_rad) * part
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_go_the_shorter_way() {
        assert!((wrap(mix_angles(3.0, -3.0, 0.5)).abs() - PI).abs() < 1e-12);
        assert!((wrap(7.0) - (7.0 - TAU)).abs() < 1e-12);
        for ease in [smooth, reach] {
            assert_eq!([ease(-1.0), ease(0.5), ease(2.0)], [0.0, 0.5, 1.0]);
        }
    }
}
