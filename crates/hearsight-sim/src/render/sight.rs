//! The truth of who is seen: outlines as if nothing hid them, and what of them is not hidden.

use super::band::HEAD;
use super::figure::{Figure, Seen};
use super::raster::Triangle;
use super::{Extent, Sight};
use hearsight_core::Rectangle;

/// Cells of an outline each way; larger outlines are counted in coarser cells.
const MOST_CELLS: f32 = 640.0;
/// In a cell: covered by the person, by the head, and the head is what is in front.
const BODY: u8 = 1;
const SKULL: u8 = 2;
const FRONT: u8 = 4;

/// Memory for outlines.
#[derive(Clone, Debug, Default)]
pub(super) struct Outline {
    near: Vec<f32>,
    cells: Vec<u8>,
}

/// A picture of who is where: the person's number from 1, perhaps with [`HEAD`].
#[derive(Clone, Copy)]
pub(super) struct Identity<'a> {
    pub(super) pixels: &'a [u16],
    pub(super) width: usize,
    pub(super) height: usize,
    /// Columns a turn of a panorama.
    pub(super) turn: Option<f32>,
}

/// Edges in pixel coordinates: left, top, right, bottom.
type Edges = [f32; 4];

impl Outline {
    /// What is seen of the person with this number (from 1).
    pub(super) fn sight(&mut self, figure: &Figure, number: u16, identity: &Identity<'_>) -> Sight {
        if !figure.drawn || identity.pixels.is_empty() {
            return Sight::default();
        }
        let Some(body) = edges(figure, false) else {
            return Sight::default();
        };
        let head = edges(figure, true);
        let (width, height) = (identity.width as f32, identity.height as f32);
        let limit = |edges: Edges| {
            let [left, top, right, bottom] = edges;
            [
                left.max(-width),
                top.max(-height),
                right.min(2.0 * width),
                bottom.min(2.0 * height),
            ]
        };
        let body = limit(body);
        let counts = self.count(figure, number, identity, body);
        let extent = |edges: Edges, [whole, seen]: [f64; 2], area: f64| {
            let [left, top, right, bottom] = limit(edges);
            let whole_box = Rectangle::new(
                left + 0.5,
                top + 0.5,
                (right - left).max(0.0),
                (bottom - top).max(0.0),
            );
            let visible = if whole > 0.0 { seen / whole } else { 0.0 };
            Extent {
                whole: whole_box,
                inside: inside(&whole_box, identity),
                visible,
                seen_px: seen * area,
            }
        };
        let area = f64::from(counts.cell_px).powi(2);
        Sight {
            head: head.map(|edges| extent(edges, counts.head, area)),
            body: Some(extent(body, counts.body, area)),
        }
    }

    fn count(&mut self, figure: &Figure, number: u16, identity: &Identity<'_>, edges: Edges) -> Counts {
        let [left, top, right, bottom] = edges;
        let (first_column, first_row) = (left.ceil(), top.ceil());
        let (wide, high) = (right - first_column + 1.0, bottom - first_row + 1.0);
        let cell_px = (wide.max(high) / MOST_CELLS).ceil().max(1.0);
        let columns = (wide / cell_px).ceil().max(0.0) as usize;
        let rows = (high / cell_px).ceil().max(0.0) as usize;
        self.near.clear();
        self.near.resize(columns * rows, 0.0);
        self.cells.clear();
        self.cells.resize(columns * rows, 0);
        let moved = |seen: &Seen| Seen {
            u: (seen.u - first_column) / cell_px,
            v: (seen.v - first_row) / cell_px,
            ..*seen
        };
        for facet in figure.facets() {
            let [a, b, c] = facet.corners.map(|corner| moved(&figure.seen[corner as usize]));
            let Some(triangle) = Triangle::new([&a, &b, &c], 0.0, [0.0; 2], facet.thin) else {
                continue;
            };
            triangle.scan((0, columns as i32), (0, rows as i32), |x, y, close| {
                let at = y as usize * columns + x as usize;
                let cell = &mut self.cells[at];
                *cell |= if facet.head { BODY | SKULL } else { BODY };
                if close > self.near[at] {
                    self.near[at] = close;
                    *cell = if facet.head { *cell | FRONT } else { *cell & !FRONT };
                }
            });
        }
        let mut counts = Counts {
            cell_px,
            body: [0.0; 2],
            head: [0.0; 2],
        };
        for row in 0..rows {
            for column in 0..columns {
                let cell = self.cells[row * columns + column];
                if cell == 0 {
                    continue;
                }
                let (u, v) = (
                    first_column + column as f32 * cell_px,
                    first_row + row as f32 * cell_px,
                );
                let shown = identity.at(u, v);
                let own = shown & !HEAD == number;
                counts.body[0] += 1.0;
                counts.body[1] += f64::from(u8::from(own));
                if cell & SKULL != 0 {
                    counts.head[0] += 1.0;
                    counts.head[1] += f64::from(u8::from(own && cell & FRONT != 0));
                }
            }
        }
        counts
    }
}

/// Cells of an outline: all, and those that are seen.
struct Counts {
    cell_px: f32,
    body: [f64; 2],
    head: [f64; 2],
}

impl Identity<'_> {
    fn at(&self, u: f32, v: f32) -> u16 {
        let wrapped = match self.turn {
            Some(turn) if turn > 0.0 => (u + 0.5).rem_euclid(turn) - 0.5,
            _ => u,
        };
        let (column, row) = (wrapped.round() as i64, v.round() as i64);
        if (0..self.width as i64).contains(&column) && (0..self.height as i64).contains(&row) {
            self.pixels[row as usize * self.width + column as usize]
        } else {
            0
        }
    }
}

/// The part of a box that is in the picture; across the seam of a panorama, the larger of its two parts.
fn inside(whole: &Rectangle, identity: &Identity<'_>) -> Rectangle {
    let frame = Rectangle::new(0.0, 0.0, identity.width as f32, identity.height as f32);
    let shifts = identity.turn.map_or([0.0; 3], |turn| [0.0, -turn, turn]);
    let mut best = Rectangle::default();
    for shift in shifts {
        let part = Rectangle {
            left: whole.left + shift,
            ..*whole
        }
        .intersection(&frame);
        if part.area() > best.area() {
            best = part;
        }
    }
    best
}

/// The outermost corners that the lens sees, of the head or of all.
fn edges(figure: &Figure, head: bool) -> Option<Edges> {
    let mut edges = [f32::INFINITY, f32::INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY];
    for facet in figure.facets().iter().filter(|facet| facet.head || !head) {
        for corner in facet.corners {
            let seen = &figure.seen[corner as usize];
            if !seen.u.is_nan() {
                edges = [
                    edges[0].min(seen.u),
                    edges[1].min(seen.v),
                    edges[2].max(seen.u),
                    edges[3].max(seen.v),
                ];
            }
        }
    }
    (edges[0] <= edges[2]).then_some(edges)
}
