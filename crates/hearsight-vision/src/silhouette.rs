//! Heads from the outline of a change mask: the top of a body, narrower than the shoulders below it.
//!
//! A change region is a body; its top maps to the head (method sheet of the stac system, notes for several people).
//! Bodies that touch make one region with several tops, so every top of the outline is tried at several widths. The
//! score of a width is made of area fractions only, each from four reads of one integral image.

use crate::VisionError;
use crate::integral::SumTable;
use hearsight_core::{Mask, Rectangle};
use serde::{Deserialize, Serialize};

/// How heads are looked for. Lengths are in head widths unless the name says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HeadSearch {
    /// Narrowest head, pixels, 4 to 10000. Default 14. Raising it loses people far away and saves time.
    pub smallest_px: f32,
    /// Widest head as a share of the picture's height, 0 to 1. Default 0.4.
    pub widest_share: f32,
    /// Ratio of one width tried to the next, 1.02 to 10. Default 1.15.
    pub step: f32,
    /// Height of a head over its width, 0.2 to 5. Default 1.3.
    pub aspect: f32,
    /// Least score of a head, 0 to 1. Default 0.35. Raising it gives fewer false heads and more missed ones.
    pub least_score: f32,
    /// Most heads returned for one picture, 1 to 1000. Default 16.
    pub most: usize,
}

impl Default for HeadSearch {
    fn default() -> Self {
        Self {
            smallest_px: 14.0,
            widest_share: 0.4,
            step: 1.15,
            aspect: 1.3,
            least_score: 0.35,
            most: 16,
        }
    }
}

impl HeadSearch {
    /// # Errors
    /// [`VisionError::Parameter`] where a number is outside its range.
    pub fn validate(&self) -> Result<(), VisionError> {
        let checks = [
            ("smallest_px", self.smallest_px, 4.0, 10_000.0, "4 to 10000"),
            ("widest_share", self.widest_share, 0.0, 1.0, "0 to 1"),
            ("step", self.step, 1.02, 10.0, "1.02 to 10"),
            ("aspect", self.aspect, 0.2, 5.0, "0.2 to 5"),
            ("least_score", self.least_score, 0.0, 1.0, "0 to 1"),
            ("most", self.most as f32, 1.0, 1000.0, "1 to 1000"),
        ];
        for (name, value, low, high, allowed) in checks {
            VisionError::within(name, f64::from(value), low, high, allowed)?;
        }
        Ok(())
    }
}

/// A head found on an outline.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// Box from the crown to the chin, pixels.
    pub region: Rectangle,
    /// How well the outline fits head and shoulders; about 1 at best.
    pub score: f32,
}

/// Finds heads in masks; owns its buffers.
#[derive(Clone, Debug, Default)]
pub struct HeadFinder {
    sums: SumTable,
    tops: Vec<(f32, f32)>,
    candidates: Vec<Head>,
}

/// Share of switched-on pixels that is assumed where the picture ends, by part: nothing is known there.
const UNKNOWN_SIDE: f32 = 0.5;
const UNKNOWN_ABOVE: f32 = 0.3;

impl HeadFinder {
    /// Prepares the sums of `mask`; [`HeadFinder::find`] and [`HeadFinder::fraction`] speak of it afterwards.
    pub fn load(&mut self, mask: &Mask) {
        self.sums.compute(mask.view());
    }

    /// Share of switched-on pixels in the part of `region` that lies in the picture, or `None` where less than a
    /// quarter of the region does.
    pub fn fraction(&self, region: &Rectangle) -> Option<f32> {
        self.share(region.left, region.top, region.right(), region.bottom())
    }

    fn share(&self, left: f32, top: f32, right: f32, bottom: f32) -> Option<f32> {
        let (width, height) = self.sums.size();
        let [l, r] = [left, right].map(|x| x.round().clamp(0.0, width as f32) as usize);
        let [t, b] = [top, bottom].map(|y| y.round().clamp(0.0, height as f32) as usize);
        let inside = (r.saturating_sub(l) * b.saturating_sub(t)) as f32;
        let whole = ((right - left) * (bottom - top)).max(1.0);
        if inside < 0.25 * whole || inside == 0.0 {
            return None;
        }
        Some(self.sums.rectangle(l, t, r, b) as f32 / (255.0 * inside))
    }

    /// The heads of the loaded mask, best first, none inside the body of another. A search that is out of its ranges
    /// (see [`HeadSearch::validate`]) finds none.
    pub fn find(&mut self, mask: &Mask, search: &HeadSearch, heads: &mut Vec<Head>) {
        heads.clear();
        if search.validate().is_err() {
            return;
        }
        self.collect_tops(mask);
        let mut candidates = std::mem::take(&mut self.candidates);
        candidates.clear();
        let widest = (search.widest_share * mask.height as f32).max(search.smallest_px);
        let mut width = search.smallest_px;
        while width <= widest {
            for &(x, y) in &self.tops {
                if let Some(score) = self.fit(x, y, width, search.aspect)
                    && score > search.least_score
                {
                    let region = Rectangle::new(x - width / 2.0, y, width, width * search.aspect);
                    candidates.push(Head { region, score });
                }
            }
            width *= search.step;
        }
        // Ties are broken by place and size, so that the order never depends on how the list was made.
        candidates.sort_unstable_by(|a, b| {
            b.score
                .total_cmp(&a.score)
                .then(a.region.left.total_cmp(&b.region.left))
                .then(a.region.top.total_cmp(&b.region.top))
                .then(a.region.width.total_cmp(&b.region.width))
        });
        for candidate in &candidates {
            if heads.len() >= search.most {
                break;
            }
            if !heads.iter().any(|kept| same_head(kept, candidate)) {
                heads.push(*candidate);
            }
        }
        candidates.clear();
        candidates.extend_from_slice(heads);
        drop_body_parts(heads, &candidates);
        self.candidates = candidates;
    }

    /// Pixels that are on with three pixels off above them (or the picture's edge).
    fn collect_tops(&mut self, mask: &Mask) {
        const CLEAR_ROWS: usize = 3;
        self.tops.clear();
        for y in 0..mask.height {
            let row = &mask.data[y * mask.width..(y + 1) * mask.width];
            let above = y
                .checked_sub(CLEAR_ROWS)
                .map(|y| &mask.data[y * mask.width..(y + 1) * mask.width]);
            for x in 0..mask.width {
                if row[x] != 0 && above.is_none_or(|above| above[x] == 0) {
                    self.tops.push((x as f32 + 0.5, y as f32));
                }
            }
        }
    }

    /// How well head and shoulders of this width fit under the top (x, y).
    fn fit(&self, x: f32, y: f32, width: f32, aspect: f32) -> Option<f32> {
        let height = aspect * width;
        let inside = self.share(x - 0.4 * width, y, x + 0.4 * width, y + 0.9 * height)?;
        if inside < 0.6 {
            return None;
        }
        let core = self.share(
            x - 0.25 * width,
            y + 0.05 * height,
            x + 0.25 * width,
            y + 1.3 * height,
        )?;
        if core < 0.6 {
            return None;
        }
        let beside = |from: f32, to: f32| {
            self.share(
                x + from * width,
                y - 0.1 * height,
                x + to * width,
                y + 0.75 * height,
            )
            .unwrap_or(UNKNOWN_SIDE)
        };
        let (left, right) = (beside(-1.0, -0.55), beside(0.55, 1.0));
        let above = self
            .share(
                x - 0.5 * width,
                y - 0.35 * height,
                x + 0.5 * width,
                y - 0.05 * height,
            )
            .unwrap_or(UNKNOWN_ABOVE);
        let shoulder = |from: f32, to: f32| {
            self.share(
                x + from * width,
                y + 1.35 * height,
                x + to * width,
                y + 1.9 * height,
            )
            .unwrap_or(UNKNOWN_SIDE)
        };
        let (near, far) = (shoulder(-1.0, -0.3), shoulder(0.3, 1.0));
        let shoulders = 0.5 * near.max(far) + 0.25 * (near + far);
        // One side may be covered by a neighbour, so the clearer side counts less than the other.
        let sides = 0.7 * left.max(right) + 0.3 * left.min(right);
        Some(inside.min(core) - 0.7 * above - 0.8 * sides + 0.5 * shoulders - 0.5)
    }
}

fn same_head(a: &Head, b: &Head) -> bool {
    let ((ax, ay), (bx, by)) = (a.region.centre(), b.region.centre());
    (ax - bx).abs() <= 0.6 * a.region.width.max(b.region.width)
        && (ay - by).abs() <= 0.8 * a.region.height.max(b.region.height)
}

/// Takes away what looks like a head but is a shoulder, an elbow or a leg of a better one above.
fn drop_body_parts(heads: &mut Vec<Head>, all: &[Head]) {
    heads.retain(|head| {
        !all.iter().any(|other| {
            other.score + 0.25 > head.score
                && head.region.width < 1.3 * other.region.width
                && body_zone(&other.region).contains(head.region.centre())
        })
    });
}

/// Where the body under a head is: an area that a second head of the same size does not share.
#[derive(Clone, Copy, Debug)]
pub struct BodyZone(Rectangle);

/// The body under `head`: three heads wide, from the mouth down seven heads.
pub fn body_zone(head: &Rectangle) -> BodyZone {
    let (x, _) = head.centre();
    BodyZone(Rectangle::new(
        x - 1.5 * head.width,
        head.top + 0.95 * head.height,
        3.0 * head.width,
        6.5 * head.height,
    ))
}

impl BodyZone {
    /// Whether a point (x, y) lies in it.
    pub fn contains(&self, (x, y): (f32, f32)) -> bool {
        x >= self.0.left && x < self.0.right() && y >= self.0.top && y < self.0.bottom()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fill(mask: &mut Mask, region: Rectangle) {
        for y in region.top.max(0.0) as usize..(region.bottom() as usize).min(mask.height) {
            for x in region.left.max(0.0) as usize..(region.right() as usize).min(mask.width) {
                mask.data[y * mask.width + x] = 255;
            }
        }
    }

    /// A figure: head, shoulders twice as wide, legs.
    fn person(mask: &mut Mask, x: f32, top: f32, width: f32) {
        fill(mask, Rectangle::new(x - width / 2.0, top, width, 1.45 * width));
        fill(
            mask,
            Rectangle::new(x - 1.1 * width, top + 1.4 * width, 2.2 * width, 3.0 * width),
        );
    }

    fn find(mask: &Mask) -> Vec<Head> {
        let mut finder = HeadFinder::default();
        let mut heads = Vec::new();
        finder.load(mask);
        finder.find(mask, &HeadSearch::default(), &mut heads);
        heads
    }

    #[test]
    fn one_figure_gives_one_head_at_its_place() {
        let mut mask = Mask::new(320, 240);
        person(&mut mask, 150.0, 60.0, 24.0);
        let heads = find(&mask);
        assert_eq!(heads.len(), 1, "{heads:?}");
        let (x, _) = heads[0].region.centre();
        assert!((x - 150.0).abs() < 4.0 && (heads[0].region.top - 60.0).abs() < 2.0);
        assert!((heads[0].region.width / 24.0).ln().abs() < 0.35, "{heads:?}");
    }

    #[test]
    fn two_figures_that_touch_are_two_heads() {
        let mut mask = Mask::new(320, 240);
        person(&mut mask, 120.0, 60.0, 24.0);
        person(&mut mask, 170.0, 50.0, 26.0);
        assert_eq!(find(&mask).len(), 2);
    }

    #[test]
    fn an_empty_and_a_full_mask_have_no_head() {
        let mut mask = Mask::new(64, 48);
        assert!(find(&mask).is_empty());
        mask.data.fill(255);
        assert!(find(&mask).is_empty());
        assert!(find(&Mask::new(0, 0)).is_empty());
    }
}
