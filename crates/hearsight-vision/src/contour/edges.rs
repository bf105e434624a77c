//! Edges along a line: all local maxima of its strength, between the samples.

use super::gradient::GradientPicture;
use super::normals::{Normal, Normals};
use crate::VisionError;
use hearsight_core::Rectangle;
use serde::{Deserialize, Serialize};

/// What counts as an edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EdgeOptions {
    /// Lines of an outline (M), 4 to 256, default 32. Raising it is surer and slower.
    pub lines: usize,
    /// Length of a line on each side of the outline (N) as a share of the ellipse's half height, above 0 to 2, default
    /// 0.6. Raising it follows faster heads and meets more clutter.
    pub reach: f32,
    /// Longest such length, pixels, 3 to 64, default 15.
    pub longest_px: usize,
    /// Least strength, grey levels a pixel over all channels (root of the sum of squares), above 0, default 8. Lowering
    /// it finds weak outlines, and noise.
    pub least_strength: f32,
}

impl Default for EdgeOptions {
    fn default() -> Self {
        Self {
            lines: 32,
            reach: 0.6,
            longest_px: 15,
            least_strength: 8.0,
        }
    }
}

/// Shortest line on each side of the outline, pixels: a maximum needs neighbours.
const SHORTEST_PX: usize = 3;
/// Longest line on each side, pixels.
const LONGEST_PX: usize = 64;
/// Most edges of a line that are kept, the first ones from inside.
const MOST: usize = 8;

impl EdgeOptions {
    /// # Errors
    /// [`VisionError::Parameter`] where a number is outside its range.
    pub fn validate(&self) -> Result<(), VisionError> {
        VisionError::within("lines", self.lines as f64, 4.0, 256.0, "4 to 256")?;
        VisionError::within("reach", f64::from(self.reach), 0.01, 2.0, "above 0 to 2")?;
        VisionError::within(
            "longest_px",
            self.longest_px as f64,
            3.0,
            LONGEST_PX as f64,
            "3 to 64",
        )?;
        VisionError::within(
            "least_strength",
            f64::from(self.least_strength),
            1e-3,
            1e3,
            "0.001 to 1000",
        )
    }

    /// Length of a line on each side of the outline of an ellipse, pixels.
    pub fn reach_px(&self, bounds: &Rectangle) -> usize {
        let wanted = (0.5 * self.reach * bounds.height).round();
        (wanted as usize).clamp(SHORTEST_PX, self.longest_px.clamp(SHORTEST_PX, LONGEST_PX))
    }
}

/// An edge on a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Edge {
    /// Distance from the line's middle, pixels, positive outwards.
    pub offset_px: f32,
    /// Strength, grey levels a pixel over all channels.
    pub strength: f32,
}

/// The edges of one line, from inside outwards.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LineEdges {
    edges: [Edge; MOST],
    count: usize,
}

impl LineEdges {
    /// The edges.
    pub fn edges(&self) -> &[Edge] {
        &self.edges[..self.count]
    }

    /// Looks along a line, `reach` pixels to both sides.
    #[inline]
    pub fn find(gradients: &GradientPicture, normal: &Normal, reach: usize, least_strength: f32) -> Self {
        let mut found = Self::default();
        let [nx, ny] = normal.direction;
        let products = [nx * nx, 2.0 * nx * ny, ny * ny];
        let at = |step: i32| {
            let step = step as f32;
            gradients.weighted(normal.x + step * nx, normal.y + step * ny, products)
        };
        let least = least_strength * least_strength;
        let reach = reach as i32;
        // One sample more at each end, so that an edge at the end has neighbours.
        let (mut before, mut here) = (at(-reach - 1), at(-reach));
        for step in -reach..=reach {
            let after = at(step + 1);
            if here > before && here >= after && here >= least {
                let [a, b, c] = [before, here, after].map(|square| square.max(0.0).sqrt());
                let bend = a - 2.0 * b + c;
                let shift = if bend < 0.0 { 0.5 * (a - c) / bend } else { 0.0 };
                found.edges[found.count] = Edge {
                    offset_px: step as f32 + shift.clamp(-0.5, 0.5),
                    strength: b,
                };
                found.count += 1;
                if found.count == MOST {
                    break;
                }
            }
            (before, here) = (here, after);
        }
        found
    }
}

/// Finds the edges along the normals of an ellipse; owns the directions of its lines.
#[derive(Clone, Debug)]
pub struct EdgeFinder {
    options: EdgeOptions,
    normals: Normals,
}

impl EdgeFinder {
    /// A finder.
    ///
    /// # Errors
    /// [`VisionError::Parameter`] where an option is outside its range.
    pub fn new(options: EdgeOptions) -> Result<Self, VisionError> {
        options.validate()?;
        Ok(Self {
            options,
            normals: Normals::new(options.lines),
        })
    }

    /// The options.
    pub fn options(&self) -> &EdgeOptions {
        &self.options
    }

    /// Replaces `lines` by the normals of the ellipse in `bounds` with their edges; returns how far each line reaches on
    /// both sides, pixels. Bounds that are not finite have no lines.
    pub fn find(
        &self,
        gradients: &GradientPicture,
        bounds: &Rectangle,
        lines: &mut Vec<(Normal, LineEdges)>,
    ) -> usize {
        lines.clear();
        let reach = self.options.reach_px(bounds);
        if !bounds.is_finite() {
            return reach;
        }
        let least = self.options.least_strength;
        lines.extend(
            self.normals
                .of(bounds)
                .map(|normal| (normal, LineEdges::find(gradients, &normal, reach, least))),
        );
        reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight_core::RgbView;

    /// A disc with a soft edge, centre and radius as given; how far a pixel is inside decides its colour.
    pub(crate) fn disc(width: usize, height: usize, centre: [f32; 2], axes: [f32; 2]) -> GradientPicture {
        let data: Vec<u8> = (0..width * height)
            .flat_map(|i| {
                let [x, y] = [(i % width) as f32 + 0.5, (i / width) as f32 + 0.5];
                let (u, v) = ((x - centre[0]) / axes[0], (y - centre[1]) / axes[1]);
                let radius = (u * u + v * v).sqrt();
                // Signed distance to first order, over two pixels.
                let gradient = ((u / axes[0]).powi(2) + (v / axes[1]).powi(2)).sqrt() / radius.max(1e-3);
                let inside = ((1.0 - radius) / gradient / 2.0 + 0.5).clamp(0.0, 1.0);
                [40.0 + 160.0 * inside, 60.0 + 60.0 * inside, 90.0].map(|value| value as u8)
            })
            .collect();
        let mut gradients = GradientPicture::default();
        gradients.compute(RgbView::new(width, height, &data).unwrap());
        gradients
    }

    #[test]
    fn the_outline_is_found_between_the_pixels() {
        let gradients = disc(100, 100, [50.3, 48.8], [20.4, 24.5]);
        let finder = EdgeFinder::new(EdgeOptions::default()).unwrap();
        // Looked for from an ellipse that is two pixels off and a little too large.
        let bounds = Rectangle::from_centre(51.8, 50.1, 42.0, 50.0);
        let mut lines = Vec::new();
        let reach = finder.find(&gradients, &bounds, &mut lines);
        assert_eq!((lines.len(), reach), (32, 15));
        for (normal, edges) in &lines {
            let strongest = edges
                .edges()
                .iter()
                .max_by(|a, b| a.strength.total_cmp(&b.strength))
                .unwrap();
            let expected = super::super::signed_distance(
                [50.3, 48.8],
                [20.4, 24.5],
                [normal.x.into(), normal.y.into()],
                normal.direction.map(f64::from),
            );
            let off = f64::from(strongest.offset_px) - expected;
            assert!(off.abs() < 0.25, "{off} px at {normal:?}");
        }
    }

    #[test]
    fn a_line_keeps_every_edge_in_order() {
        // Stripes of six pixels.
        let data: Vec<u8> = (0..60 * 20)
            .flat_map(|i| [if (i % 60) / 6 % 2 == 0 { 40 } else { 200 }; 3])
            .collect();
        let mut gradients = GradientPicture::default();
        gradients.compute(RgbView::new(60, 20, &data).unwrap());
        let normal = Normal {
            x: 33.0,
            y: 10.0,
            direction: [1.0, 0.0],
        };
        let found = LineEdges::find(&gradients, &normal, 10, 8.0);
        let offsets: Vec<f32> = found.edges().iter().map(|edge| edge.offset_px).collect();
        assert_eq!(offsets.len(), 4, "{offsets:?}");
        for (offset, expected) in offsets.iter().zip([-9.0, -3.0, 3.0, 9.0]) {
            assert!((offset - expected).abs() < 0.51, "{offsets:?}");
        }
    }

    #[test]
    fn a_picture_of_one_colour_and_ellipses_outside_have_no_edges() {
        let data = vec![90_u8; 40 * 40 * 3];
        let mut gradients = GradientPicture::default();
        gradients.compute(RgbView::new(40, 40, &data).unwrap());
        let finder = EdgeFinder::new(EdgeOptions::default()).unwrap();
        let mut lines = Vec::new();
        for bounds in [
            Rectangle::from_centre(20.0, 20.0, 20.0, 24.0),
            Rectangle::from_centre(-500.0, 20.0, 20.0, 24.0),
            Rectangle::from_centre(20.0, 20.0, 0.0, 0.0),
        ] {
            finder.find(&gradients, &bounds, &mut lines);
            assert!(lines.iter().all(|(_, edges)| edges.edges().is_empty()));
        }
        finder.find(
            &gradients,
            &Rectangle::from_centre(f32::NAN, 0.0, 2.0, 2.0),
            &mut lines,
        );
        assert!(lines.is_empty());
        assert!(
            EdgeFinder::new(EdgeOptions {
                lines: 3,
                ..EdgeOptions::default()
            })
            .is_err()
        );
    }
}
