//! A cascade made ready for tables of one shape: corners as offsets from a window's first entry.

use super::level::{Layout, Shape};
use super::{Cascade, Feature, Node, Stage, Tree, Weighted};

/// Offsets of a rectangle's corners; its sum is 0 - 1 - 2 + 3.
pub(crate) type Corners = [u32; 4];

/// A node with its feature.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlanNode {
    pub(crate) corners: [Corners; 3],
    pub(crate) weights: [f32; 3],
    pub(crate) threshold: f32,
    pub(crate) left: i32,
    pub(crate) right: i32,
}

#[derive(Clone, Debug)]
pub(crate) struct Plan {
    pub(crate) shape: Shape,
    pub(crate) stages: Vec<Stage>,
    pub(crate) trees: Vec<Tree>,
    pub(crate) nodes: Vec<PlanNode>,
    pub(crate) leaves: Vec<f32>,
    /// Corners of the part of the window whose contrast normalizes: one pixel less on each side.
    pub(crate) inner: Corners,
    /// Pixels of that part.
    pub(crate) inner_area: f64,
    /// Most nodes of a tree.
    pub(crate) largest_tree: usize,
}

impl Plan {
    pub(crate) fn new(cascade: &Cascade, shape: Shape, layout: Layout) -> Self {
        let at = |x: usize, y: usize| shape.at(layout, x, y) as u32;
        let upright = |x: usize, y: usize, width: usize, height: usize| {
            [
                at(x, y),
                at(x + width, y),
                at(x, y + height),
                at(x + width, y + height),
            ]
        };
        let corners = |feature: &Feature, rectangle: &Weighted| {
            let Weighted {
                x,
                y,
                width,
                height,
                weight,
            } = *rectangle;
            if weight == 0.0 {
                [0; 4]
            } else if feature.tilted {
                let first = shape.area() as u32;
                [
                    first + at(x, y),
                    first + at(x - height, y + height),
                    first + at(x + width, y + width),
                    first + at(x + width - height, y + width + height),
                ]
            } else {
                upright(x, y, width, height)
            }
        };
        let node = |node: &Node| {
            let feature = &cascade.features[node.feature];
            PlanNode {
                corners: feature
                    .rectangles
                    .each_ref()
                    .map(|rectangle| corners(feature, rectangle)),
                weights: feature.rectangles.map(|rectangle| rectangle.weight),
                threshold: node.threshold,
                left: node.left,
                right: node.right,
            }
        };
        let (width, height) = (cascade.width - 2, cascade.height - 2);
        Self {
            shape,
            stages: cascade.stages.clone(),
            trees: cascade.trees.clone(),
            nodes: cascade.nodes.iter().map(node).collect(),
            leaves: cascade.leaves.clone(),
            inner: upright(1, 1, width, height),
            inner_area: (width * height) as f64,
            largest_tree: cascade.trees.iter().map(|tree| tree.nodes).max().unwrap_or(0),
        }
    }
}
