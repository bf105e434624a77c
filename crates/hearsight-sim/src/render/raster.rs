//! Triangles to pixels.

use super::figure::Seen;

/// A triangle in the picture, ready to be asked which pixels it covers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    /// First corner, and edges to the second and third.
    u: f32,
    v: f32,
    one: [f32; 2],
    two: [f32; 2],
    inverse: f32,
    /// One over the distance at the first corner, and its change to the second and third.
    near: [f32; 3],
    /// Left, top, right, bottom.
    bounds: [f32; 4],
}

impl Triangle {
    /// The triangle at a time of the shutter, moved by `shift`; nothing where it is seen from behind, where a corner is
    /// not seen at all, or where it has no area. What is `thin` is seen from both sides.
    #[inline]
    pub(super) fn new(corners: [&Seen; 3], time: f32, shift: [f32; 2], thin: bool) -> Option<Self> {
        let [a, b, c] = corners.map(|seen| {
            [
                seen.u + time * seen.du + shift[0],
                seen.v + time * seen.dv + shift[1],
            ]
        });
        let one = [b[0] - a[0], b[1] - a[1]];
        let two = [c[0] - a[0], c[1] - a[1]];
        let area = one[0] * two[1] - one[1] * two[0];
        // A number that is none compares false.
        if !(area > 1e-9 || (thin && area < -1e-9)) {
            return None;
        }
        let near = [
            corners[0].near,
            corners[1].near - corners[0].near,
            corners[2].near - corners[0].near,
        ];
        let least = |axis: usize| a[axis].min(b[axis]).min(c[axis]);
        let most = |axis: usize| a[axis].max(b[axis]).max(c[axis]);
        let bounds = [least(0), least(1), most(0), most(1)];
        Some(Self {
            u: a[0],
            v: a[1],
            one,
            two,
            inverse: 1.0 / area,
            near,
            bounds,
        })
    }

    /// Weights of the second and third corner at a place.
    #[inline(always)]
    pub(super) fn weights(&self, u: f32, v: f32) -> (f32, f32) {
        let (x, y) = (u - self.u, v - self.v);
        (
            (x * self.two[1] - y * self.two[0]) * self.inverse,
            (y * self.one[0] - x * self.one[1]) * self.inverse,
        )
    }

    /// Columns of a picture of this width, from and before, that it may cover.
    pub(super) fn columns(&self, width: usize) -> (usize, usize) {
        let [left, _, right, _] = self.bounds;
        // Negative numbers become 0.
        (
            (left.ceil() as usize).min(width),
            ((right.floor() + 1.0) as usize).min(width),
        )
    }

    /// Calls `covered` with column, row and one over the distance for each pixel centre in the columns and rows given
    /// (from, before) that it covers.
    #[inline]
    pub(super) fn scan(&self, columns: (i32, i32), rows: (i32, i32), mut covered: impl FnMut(i32, i32, f32)) {
        let [left, top, right, bottom] = self.bounds;
        let (first, last) = (
            (left.ceil() as i32).max(columns.0),
            (right.floor() as i32).min(columns.1 - 1),
        );
        let (upper, lower) = (
            (top.ceil() as i32).max(rows.0),
            (bottom.floor() as i32).min(rows.1 - 1),
        );
        // Change of both weights and of the nearness from one column to the next.
        let (one_step, two_step) = (self.two[1] * self.inverse, -self.one[1] * self.inverse);
        let near_step = one_step * self.near[1] + two_step * self.near[2];
        for y in upper..=lower {
            let (mut one, mut two) = self.weights(first as f32, y as f32);
            let mut near = self.near[0] + one * self.near[1] + two * self.near[2];
            for x in first..=last {
                if one >= 0.0 && two >= 0.0 && one + two <= 1.0 {
                    covered(x, y, near);
                }
                one += one_step;
                two += two_step;
                near += near_step;
            }
        }
    }
}
