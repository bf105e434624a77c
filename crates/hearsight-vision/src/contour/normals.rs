//! The normals of an upright ellipse, and where another ellipse crosses them.

use hearsight_core::Rectangle;

/// A line across an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normal {
    /// Its middle, on the ellipse: pixels from the picture's corner.
    pub x: f32,
    /// Row of its middle.
    pub y: f32,
    /// Unit vector outwards.
    pub direction: [f32; 2],
}

/// Directions of lines that are evenly spread over the angle of an ellipse's parameter, found once.
#[derive(Clone, Debug, PartialEq)]
pub struct Normals {
    /// Cosine and sine of the parameter.
    angles: Vec<[f32; 2]>,
}

impl Normals {
    /// As many lines as this, the first to the right, then downwards.
    pub fn new(count: usize) -> Self {
        let angle = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
        Self {
            angles: (0..count)
                .map(|k| [angle(k).cos() as f32, angle(k).sin() as f32])
                .collect(),
        }
    }

    /// How many lines there are.
    pub fn count(&self) -> usize {
        self.angles.len()
    }

    /// The normals of the ellipse in `bounds`, in order.
    #[inline]
    pub fn of<'a>(&'a self, bounds: &Rectangle) -> impl ExactSizeIterator<Item = Normal> + 'a {
        let (x, y) = bounds.centre();
        let (a, b) = (0.5 * bounds.width, 0.5 * bounds.height);
        self.angles.iter().map(move |&[cosine, sine]| {
            // The gradient of (x/a)^2 + (y/b)^2 at (a cos, b sin), times a b.
            let (along, down) = (b * cosine, a * sine);
            let length = (along * along + down * down).sqrt().max(f32::MIN_POSITIVE);
            Normal {
                x: x + a * cosine,
                y: y + b * sine,
                direction: [along / length, down / length],
            }
        })
    }
}

/// Signed distance along a line from its middle to an upright ellipse with centre and half axes (Chen and Rui, equation
/// 13, corrected: the larger half axis belongs to y).
///
/// From a middle inside the ellipse it is the crossing outwards, positive; from outside the nearer crossing; where the
/// line misses the ellipse, the place where it passes nearest to it. Finite for positive axes and finite numbers.
pub fn signed_distance(centre: [f64; 2], axes: [f64; 2], middle: [f64; 2], direction: [f64; 2]) -> f64 {
    let scaled = |vector: [f64; 2]| [vector[0] / axes[0], vector[1] / axes[1]];
    let offset = scaled([middle[0] - centre[0], middle[1] - centre[1]]);
    let along = scaled(direction);
    let square = along[0] * along[0] + along[1] * along[1];
    let half = offset[0] * along[0] + offset[1] * along[1];
    let rest = offset[0] * offset[0] + offset[1] * offset[1] - 1.0;
    let root = (half * half - square * rest).max(0.0).sqrt();
    let (near, far) = ((-half - root) / square, (-half + root) / square);
    if rest > 0.0 && near.abs() < far.abs() {
        near
    } else {
        far
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_are_on_the_ellipse_and_at_right_angles_to_it() {
        let bounds = Rectangle::new(10.0, 20.0, 30.0, 36.0);
        let normals = Normals::new(16);
        for normal in normals.of(&bounds) {
            let (u, v) = ((normal.x - 25.0) / 15.0, (normal.y - 38.0) / 18.0);
            assert!((u * u + v * v - 1.0).abs() < 1e-5);
            // The tangent at (u, v) is (-15 v, 18 u).
            let [nx, ny] = normal.direction;
            assert!((nx * -15.0 * v + ny * 18.0 * u).abs() < 1e-3);
            assert!((nx * nx + ny * ny - 1.0).abs() < 1e-5 && nx * u + ny * v > 0.0);
        }
    }

    #[test]
    fn an_ellipse_is_taller_than_wide() {
        let axes = [50.0, 60.0];
        assert!((signed_distance([0.0; 2], axes, [0.0; 2], [1.0, 0.0]) - 50.0).abs() < 1e-12);
        assert!((signed_distance([0.0; 2], axes, [0.0; 2], [0.0, 1.0]) - 60.0).abs() < 1e-12);
    }

    #[test]
    fn every_case_of_the_crossing() {
        let at = |middle: [f64; 2], direction: [f64; 2]| {
            signed_distance([0.0; 2], [10.0, 12.0], middle, direction)
        };
        assert!(
            (at([8.0, 0.0], [1.0, 0.0]) - 2.0).abs() < 1e-12,
            "inside: outwards"
        );
        assert!(
            (at([-8.0, 0.0], [1.0, 0.0]) - 18.0).abs() < 1e-12,
            "inside, beyond the centre"
        );
        assert!(
            (at([13.0, 0.0], [1.0, 0.0]) + 3.0).abs() < 1e-12,
            "outside: the nearer one"
        );
        assert!(
            (at([-13.0, 0.0], [1.0, 0.0]) - 3.0).abs() < 1e-12,
            "outside on the other side"
        );
        assert!(
            (at([4.0, 20.0], [1.0, 0.0]) + 4.0).abs() < 1e-12,
            "missed: where it passes nearest"
        );
        assert_eq!(at([10.0, 0.0], [1.0, 0.0]), 0.0);
    }
}
