//! The old format (`opencv-haar-classifier`): each node of a tree holds its own feature.

use super::error::CascadeError;
use super::parse::{Builder, Reader};
use super::{Feature, Node};
use roxmltree::Node as Element;

pub(super) fn parse<'a>(reader: &Reader<'a>, cascade: Element<'a, 'a>) -> Result<Builder, CascadeError> {
    let size = reader.child(cascade, "size")?;
    let mut words = reader.words(size);
    let width = Builder::side(reader, size, words.next())?;
    let height = Builder::side(reader, size, words.next())?;
    let mut builder = Builder::new(width, height);
    let (mut nodes, mut leaves) = (Vec::new(), Vec::new());
    for stage in reader.entries(reader.child(cascade, "stages")?) {
        let threshold = reader.child(stage, "stage_threshold")?;
        let value = reader.number(threshold, reader.words(threshold).next())?;
        builder.begin_stage(reader, stage, value)?;
        for tree in reader.entries(reader.child(stage, "trees")?) {
            nodes.clear();
            leaves.clear();
            for entry in reader.entries(tree) {
                let node = node(reader, &mut builder, entry, &mut leaves)?;
                nodes.push(node);
            }
            builder.add_tree(reader, tree, &nodes, &leaves)?;
        }
    }
    Ok(builder)
}

fn node<'a>(
    reader: &Reader<'a>,
    builder: &mut Builder,
    entry: Element<'a, 'a>,
    leaves: &mut Vec<f32>,
) -> Result<Node, CascadeError> {
    let element = reader.child(entry, "feature")?;
    let rectangles = reader.rectangles(reader.child(element, "rects")?)?;
    let tilted = match reader.optional(element, "tilted") {
        Some(element) => reader.whole(element, reader.words(element).next(), 0, 1)? == 1,
        None => false,
    };
    let feature = builder.add_feature(reader, element, Feature { tilted, rectangles })?;
    let threshold = reader.child(entry, "threshold")?;
    let threshold = reader.number(threshold, reader.words(threshold).next())?;
    let mut child = |value: &str, node: &str| match reader.optional(entry, value) {
        Some(element) => {
            leaves.push(reader.number(element, reader.words(element).next())?);
            Ok(-(leaves.len() as i32 - 1))
        }
        None => {
            let element = reader.child(entry, node)?;
            Ok(reader.whole(element, reader.words(element).next(), 1, 64)? as i32)
        }
    };
    Ok(Node {
        feature,
        threshold,
        left: child("left_val", "left_node")?,
        right: child("right_val", "right_node")?,
    })
}
