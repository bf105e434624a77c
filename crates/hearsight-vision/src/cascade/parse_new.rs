//! The present format (`opencv-cascade-classifier`): stages of trees, then a list of features they refer to.

use super::error::CascadeError;
use super::parse::{Builder, Reader};
use super::{Feature, Node};
use roxmltree::Node as Element;

pub(super) fn parse<'a>(reader: &Reader<'a>, cascade: Element<'a, 'a>) -> Result<Builder, CascadeError> {
    for (name, wanted) in [("stageType", "BOOST"), ("featureType", "HAAR")] {
        let element = reader.child(cascade, name)?;
        let found = element.text().unwrap_or_default().trim();
        if found != wanted {
            return Err(reader.unsupported(element, found));
        }
    }
    let side = |name| {
        let element = reader.child(cascade, name)?;
        Builder::side(reader, element, reader.words(element).next())
    };
    let mut builder = Builder::new(side("width")?, side("height")?);
    for entry in reader.entries(reader.child(cascade, "features")?) {
        let rectangles = reader.rectangles(reader.child(entry, "rects")?)?;
        let tilted = match reader.optional(entry, "tilted") {
            Some(element) => reader.whole(element, reader.words(element).next(), 0, 1)? == 1,
            None => false,
        };
        builder.add_feature(reader, entry, Feature { tilted, rectangles })?;
    }
    let (mut nodes, mut leaves) = (Vec::new(), Vec::new());
    for stage in reader.entries(reader.child(cascade, "stages")?) {
        let threshold = reader.child(stage, "stageThreshold")?;
        let value = reader.number(threshold, reader.words(threshold).next())?;
        builder.begin_stage(reader, stage, value)?;
        for tree in reader.entries(reader.child(stage, "weakClassifiers")?) {
            nodes.clear();
            leaves.clear();
            let element = reader.child(tree, "internalNodes")?;
            let mut words = reader.words(element).peekable();
            while words.peek().is_some() {
                let most = i64::from(i32::MAX);
                nodes.push(Node {
                    left: reader.whole(element, words.next(), -most, most)? as i32,
                    right: reader.whole(element, words.next(), -most, most)? as i32,
                    feature: reader.whole(element, words.next(), 0, most)? as usize,
                    threshold: reader.number(element, words.next())?,
                });
            }
            let element = reader.child(tree, "leafValues")?;
            for word in reader.words(element) {
                leaves.push(reader.number(element, Some(word))?);
            }
            builder.add_tree(reader, tree, &nodes, &leaves)?;
        }
    }
    Ok(builder)
}
