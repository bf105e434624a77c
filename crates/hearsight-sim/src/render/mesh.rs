//! Surfaces of triangles: grids wound around an axis.

use nalgebra::Vector3;
use std::f32::consts::TAU;

/// A place on a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) place: Vector3<f32>,
    /// Outwards, unit length.
    pub(super) normal: Vector3<f32>,
    /// Where in the texture.
    pub(super) at: [f32; 2],
}

/// A triangle; its corners go clockwise in a picture that sees it from outside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    pub(super) corners: [u32; 3],
    pub(super) surface: Surface,
    /// Whether it belongs to the head: skull, face, ears and hair down to the chin.
    pub(super) head: bool,
    /// Whether it is seen from both sides.
    pub(super) thin: bool,
}

/// What a facet is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Surface {
    Head,
    Skin,
    Hair,
    Top,
    Bottom,
    Shoe,
}

/// How many kinds of surface there are.
pub(super) const SURFACES: usize = 6;

/// Triangles and their corners.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    pub(super) corners: Vec<Corner>,
    pub(super) facets: Vec<Facet>,
}

/// What a grid is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cloth {
    pub(super) surface: Surface,
    pub(super) head: bool,
    pub(super) thin: bool,
}

impl Cloth {
    pub(super) const fn of(surface: Surface) -> Self {
        Self {
            surface,
            head: false,
            thin: false,
        }
    }
}

impl Mesh {
    pub(super) fn clear(&mut self) {
        self.corners.clear();
        self.facets.clear();
    }

    /// A grid of `rows` by `columns` corners. Rows go along an axis, columns anticlockwise around it seen against the
    /// axis; where it is closed, the last column is the first (its corners doubled, for its place in the texture).
    pub(super) fn grid(
        &mut self,
        rows: usize,
        columns: usize,
        closed: bool,
        cloth: impl Fn(usize) -> Cloth,
        corner: impl Fn(usize, usize) -> (Vector3<f32>, [f32; 2]),
    ) {
        let base = self.corners.len();
        for row in 0..rows {
            for column in 0..columns {
                let (place, at) = corner(row, column);
                self.corners.push(Corner {
                    place,
                    normal: Vector3::zeros(),
                    at,
                });
            }
        }
        for row in 0..rows {
            for column in 0..columns {
                let place = |row: usize, column: usize| self.corners[base + row * columns + column].place;
                let (left, right) = match column {
                    0 if closed => (columns - 2, 1),
                    _ if closed && column + 1 == columns => (column - 1, 1),
                    _ => (column.saturating_sub(1), (column + 1).min(columns - 1)),
                };
                let around = place(row, right) - place(row, left);
                let along = place((row + 1).min(rows - 1), column) - place(row.saturating_sub(1), column);
                let normal = along
                    .cross(&around)
                    .try_normalize(1e-12)
                    .unwrap_or_else(Vector3::z);
                self.corners[base + row * columns + column].normal = normal;
            }
        }
        for row in 0..rows - 1 {
            let Cloth { surface, head, thin } = cloth(row);
            for column in 0..columns - 1 {
                let at = |row: usize, column: usize| (base + row * columns + column) as u32;
                let (a, b, c, d) = (
                    at(row, column),
                    at(row, column + 1),
                    at(row + 1, column + 1),
                    at(row + 1, column),
                );
                self.facets.push(Facet {
                    corners: [a, b, c],
                    surface,
                    head,
                    thin,
                });
                self.facets.push(Facet {
                    corners: [a, c, d],
                    surface,
                    head,
                    thin,
                });
            }
        }
    }

    /// An ellipsoid with these half axes, the first of which is the axis that it is wound around.
    pub(super) fn ellipsoid(
        &mut self,
        centre: Vector3<f32>,
        axes: [Vector3<f32>; 3],
        sides: usize,
        cloth: Cloth,
    ) {
        let rows = sides / 2 + 1;
        let [along, forward, _] = axes;
        // Whatever the hand of the axes, the grid must be wound the same way.
        let side = if forward.cross(&axes[2]).dot(&along) > 0.0 {
            -axes[2]
        } else {
            axes[2]
        };
        self.grid(
            rows,
            sides + 1,
            true,
            |_| cloth,
            |row, column| {
                let polar = (row as f32 / (rows - 1) as f32).clamp(0.01, 0.99) * TAU / 2.0;
                let turn = column as f32 / sides as f32 * TAU;
                let offset = along * -polar.cos() + (forward * turn.cos() + side * turn.sin()) * polar.sin();
                (centre + offset, [0.5, 0.5])
            },
        );
    }

    /// A tube through centres, each with two half axes across (the second a quarter turn anticlockwise seen against the
    /// tube's direction). Its texture counts metres around and along.
    pub(super) fn tube(
        &mut self,
        rings: &[(Vector3<f32>, Vector3<f32>, Vector3<f32>)],
        sides: usize,
        cloth: impl Fn(usize) -> Cloth,
    ) {
        let Some((first, ..)) = rings.first() else { return };
        let widest = rings
            .iter()
            .map(|(_, one, other)| one.norm().max(other.norm()))
            .fold(0.0, f32::max);
        self.grid(rings.len(), sides + 1, true, cloth, |row, column| {
            let (centre, one, other) = rings[row];
            let turn = column as f32 / sides as f32 * TAU;
            let place = centre + one * turn.cos() + other * turn.sin();
            (place, [(turn - TAU / 2.0) * widest, (centre - first).norm()])
        });
    }
}

/// A vector of unit length across `axis`, as near to `wish` as can be.
pub(super) fn across(axis: Vector3<f32>, wish: Vector3<f32>) -> Vector3<f32> {
    let axis = axis.try_normalize(1e-9).unwrap_or_else(Vector3::z);
    let flat = |wish: Vector3<f32>| (wish - axis * axis.dot(&wish)).try_normalize(0.05);
    flat(wish)
        .or_else(|| flat(Vector3::z()))
        .or_else(|| flat(Vector3::x()))
        .unwrap_or_else(Vector3::y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_of_tubes_and_ellipsoids_point_outwards() {
        let mut mesh = Mesh::default();
        let cloth = Cloth::of(Surface::Skin);
        for hand in [1.0, -1.0] {
            mesh.clear();
            let axes = [Vector3::x() * 2.0, Vector3::y(), Vector3::z() * hand];
            mesh.ellipsoid(Vector3::zeros(), axes, 12, cloth);
            assert!(
                mesh.corners
                    .iter()
                    .all(|corner| corner.normal.dot(&corner.place) > 0.0)
            );
        }
        mesh.clear();
        let down = -Vector3::z();
        let one = across(down, Vector3::new(1.0, 0.0, 0.3));
        let rings = [0.0, 1.0, 2.0].map(|z: f32| (down * z, one, one.cross(&down)));
        mesh.tube(&rings, 10, |_| cloth);
        for corner in &mesh.corners {
            assert!(
                corner
                    .normal
                    .dot(&Vector3::new(corner.place.x, corner.place.y, 0.0))
                    > 0.9
            );
        }
        assert_eq!(mesh.facets.len(), 2 * 2 * 10);
    }
}
