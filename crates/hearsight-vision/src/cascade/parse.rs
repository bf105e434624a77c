//! Reading cascades: what both formats have in common.

use super::error::CascadeError;
use super::{Cascade, Feature, Node, Stage, Tree, Weighted, parse_new, parse_old};
use roxmltree::{Document, Node as Element, ParsingOptions};

/// Largest file, bytes: OpenCV's largest has 3 million.
const LARGEST_FILE: usize = 64 << 20;
/// Most nodes of XML: OpenCV's largest cascade has 400 thousand.
const MOST_ELEMENTS: u32 = 8_000_000;
const MOST_STAGES: usize = 1_000;
const MOST_TREES: usize = 200_000;
const MOST_NODES_OF_A_TREE: usize = 64;
const MOST_FEATURES: usize = 400_000;
/// Sides of the training window, pixels. Below 3 it has no inside to take the contrast of; above, sums of squares over
/// a window could pass 32 bits.
const SIDES: std::ops::RangeInclusive<usize> = 3..=256;

pub(super) fn parse(file: &str, bytes: &[u8]) -> Result<Cascade, CascadeError> {
    let xml = |reason: String| CascadeError::Xml {
        file: file.to_owned(),
        reason,
    };
    if bytes.len() > LARGEST_FILE {
        return Err(xml(format!("{} bytes, more than {LARGEST_FILE}", bytes.len())));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| xml(error.to_string()))?;
    let options = ParsingOptions {
        allow_dtd: false,
        nodes_limit: MOST_ELEMENTS,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options).map_err(|error| xml(error.to_string()))?;
    let reader = Reader {
        file,
        document: &document,
    };
    let root = document.root_element();
    if root.tag_name().name() != "opencv_storage" {
        return Err(reader.element(root, "the outermost element must be <opencv_storage>"));
    }
    let Some(cascade) = root.children().find(Element::is_element) else {
        return Err(reader.element(root, "it is empty"));
    };
    let builder = if reader.optional(cascade, "stageType").is_some() {
        parse_new::parse(&reader, cascade)?
    } else {
        parse_old::parse(&reader, cascade)?
    };
    builder.finish(&reader, cascade)
}

/// Reads elements and says what is wrong with them.
pub(super) struct Reader<'a> {
    file: &'a str,
    document: &'a Document<'a>,
}

impl<'a> Reader<'a> {
    fn place(&self, element: Element<'_, '_>) -> (String, String, u32) {
        let line = self.document.text_pos_at(element.range().start).row;
        (self.file.to_owned(), element.tag_name().name().to_owned(), line)
    }

    pub(super) fn element(&self, element: Element<'_, '_>, problem: impl Into<String>) -> CascadeError {
        let (file, element, line) = self.place(element);
        CascadeError::Element {
            file,
            element,
            line,
            problem: problem.into(),
        }
    }

    pub(super) fn unsupported(&self, element: Element<'_, '_>, found: &str) -> CascadeError {
        let (file, element, line) = self.place(element);
        CascadeError::Unsupported {
            file,
            element,
            line,
            found: found.chars().take(40).collect(),
        }
    }

    pub(super) fn optional(&self, parent: Element<'a, 'a>, name: &str) -> Option<Element<'a, 'a>> {
        parent.children().find(|child| child.has_tag_name(name))
    }

    pub(super) fn child(&self, parent: Element<'a, 'a>, name: &str) -> Result<Element<'a, 'a>, CascadeError> {
        self.optional(parent, name)
            .ok_or_else(|| self.element(parent, format!("it has no <{name}>")))
    }

    /// The entries `<_>` of a list.
    pub(super) fn entries(&self, list: Element<'a, 'a>) -> impl Iterator<Item = Element<'a, 'a>> {
        list.children().filter(|child| child.has_tag_name("_"))
    }

    /// The words of an element's text.
    pub(super) fn words(&self, element: Element<'a, 'a>) -> impl Iterator<Item = &'a str> {
        element.text().unwrap_or_default().split_ascii_whitespace()
    }

    /// A finite number. OpenCV reads 64 bits and keeps 32, which can round twice; so does this.
    pub(super) fn number(&self, element: Element<'_, '_>, word: Option<&str>) -> Result<f32, CascadeError> {
        let Some(word) = word else {
            return Err(self.element(element, "a number is missing"));
        };
        match word.parse::<f64>().map(|value| value as f32) {
            Ok(value) if value.is_finite() => Ok(value),
            _ => {
                let word: String = word.chars().take(40).collect();
                Err(self.element(element, format!("{word:?} is no finite number")))
            }
        }
    }

    /// A whole number from `least` to `most`.
    pub(super) fn whole(
        &self,
        element: Element<'_, '_>,
        word: Option<&str>,
        least: i64,
        most: i64,
    ) -> Result<i64, CascadeError> {
        let value = self.number(element, word)?;
        let whole = value as i64;
        if whole as f32 == value && (least..=most).contains(&whole) {
            return Ok(whole);
        }
        Err(self.element(
            element,
            format!("{value} is no whole number from {least} to {most}"),
        ))
    }

    /// The rectangles of a feature: x, y, width, height, weight each.
    pub(super) fn rectangles(&self, list: Element<'a, 'a>) -> Result<[Weighted; 3], CascadeError> {
        let mut rectangles = [Weighted::default(); 3];
        let mut count = 0;
        for entry in self.entries(list) {
            let Some(slot) = rectangles.get_mut(count) else {
                return Err(self.element(list, "more than three rectangles"));
            };
            count += 1;
            let mut words = self.words(entry);
            let most = *SIDES.end() as i64;
            let mut side = || Ok(self.whole(entry, words.next(), 0, most)? as usize);
            (slot.x, slot.y, slot.width, slot.height) = (side()?, side()?, side()?, side()?);
            slot.weight = self.number(entry, words.next())?;
            if words.next().is_some() {
                return Err(self.element(entry, "more than x, y, width, height and weight"));
            }
        }
        if count < 2 {
            return Err(self.element(list, "fewer than two rectangles"));
        }
        Ok(rectangles)
    }
}

/// A cascade in the making.
pub(super) struct Builder {
    pub(super) cascade: Cascade,
}

impl Builder {
    pub(super) fn new(width: i64, height: i64) -> Self {
        Self {
            cascade: Cascade {
                width: width as usize,
                height: height as usize,
                stages: Vec::new(),
                trees: Vec::new(),
                nodes: Vec::new(),
                leaves: Vec::new(),
                features: Vec::new(),
            },
        }
    }

    /// The sides of a training window.
    pub(super) fn side(
        reader: &Reader<'_>,
        element: Element<'_, '_>,
        word: Option<&str>,
    ) -> Result<i64, CascadeError> {
        reader.whole(element, word, *SIDES.start() as i64, *SIDES.end() as i64)
    }

    pub(super) fn begin_stage(
        &mut self,
        reader: &Reader<'_>,
        element: Element<'_, '_>,
        threshold: f32,
    ) -> Result<(), CascadeError> {
        if self.cascade.stages.len() == MOST_STAGES {
            return Err(reader.element(element, format!("more than {MOST_STAGES} stages")));
        }
        let first_tree = self.cascade.trees.len();
        self.cascade.stages.push(Stage {
            first_tree,
            trees: 0,
            threshold: threshold - super::THRESHOLD_ROOM,
        });
        Ok(())
    }

    /// Adds a tree to the last stage and checks that it ends: children come after their parents.
    pub(super) fn add_tree(
        &mut self,
        reader: &Reader<'_>,
        element: Element<'_, '_>,
        nodes: &[Node],
        leaves: &[f32],
    ) -> Result<(), CascadeError> {
        let wrong = |problem: String| Err(reader.element(element, problem));
        if nodes.is_empty() || nodes.len() > MOST_NODES_OF_A_TREE {
            return wrong(format!(
                "{} nodes in a tree, allowed are 1 to {MOST_NODES_OF_A_TREE}",
                nodes.len()
            ));
        }
        if leaves.len() != nodes.len() + 1 {
            return wrong(format!("{} leaves for {} nodes", leaves.len(), nodes.len()));
        }
        if self.cascade.trees.len() == MOST_TREES {
            return wrong(format!("more than {MOST_TREES} trees"));
        }
        for (at, node) in nodes.iter().enumerate() {
            for child in [node.left, node.right] {
                let known = if child > 0 {
                    child as usize > at && (child as usize) < nodes.len()
                } else {
                    (child.unsigned_abs() as usize) < leaves.len()
                };
                if !known {
                    return wrong(format!(
                        "node {at} goes to {child}, which is no later node and no leaf"
                    ));
                }
            }
        }
        let Some(stage) = self.cascade.stages.last_mut() else {
            return wrong("a tree outside of a stage".to_owned());
        };
        stage.trees += 1;
        self.cascade.trees.push(Tree {
            first_node: self.cascade.nodes.len(),
            nodes: nodes.len(),
            first_leaf: self.cascade.leaves.len(),
        });
        self.cascade.nodes.extend_from_slice(nodes);
        self.cascade.leaves.extend_from_slice(leaves);
        Ok(())
    }

    pub(super) fn add_feature(
        &mut self,
        reader: &Reader<'_>,
        element: Element<'_, '_>,
        feature: Feature,
    ) -> Result<usize, CascadeError> {
        if self.cascade.features.len() == MOST_FEATURES {
            return Err(reader.element(element, format!("more than {MOST_FEATURES} features")));
        }
        let (width, height) = (self.cascade.width, self.cascade.height);
        for rectangle in feature
            .rectangles
            .iter()
            .filter(|rectangle| rectangle.weight != 0.0)
        {
            let Weighted {
                x,
                y,
                width: across,
                height: down,
                ..
            } = *rectangle;
            let inside = if feature.tilted {
                x >= down && x + across <= width && y + across + down <= height
            } else {
                x + across <= width && y + down <= height
            };
            if !inside {
                return Err(reader.element(element, format!("{rectangle:?} leaves the window")));
            }
        }
        self.cascade.features.push(feature);
        Ok(self.cascade.features.len() - 1)
    }

    fn finish(self, reader: &Reader<'_>, element: Element<'_, '_>) -> Result<Cascade, CascadeError> {
        let cascade = self.cascade;
        if cascade.stages.is_empty() || cascade.stages.iter().any(|stage| stage.trees == 0) {
            return Err(reader.element(element, "no stages, or a stage without trees"));
        }
        match cascade
            .nodes
            .iter()
            .find(|node| node.feature >= cascade.features.len())
        {
            Some(node) => Err(reader.element(
                element,
                format!(
                    "feature {} of {} is asked for",
                    node.feature,
                    cascade.features.len()
                ),
            )),
            None => Ok(cascade),
        }
    }
}
