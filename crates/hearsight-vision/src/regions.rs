//! Connected components of a mask: eight-connected, with bounding box, area and centroid.

use hearsight_core::{Mask, Rectangle};

/// One connected component.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Region {
    /// The smallest rectangle around it, pixels.
    pub bounds: Rectangle,
    /// Pixels in it.
    pub area: u32,
    /// Mean position of its pixels (x, y), where (0, 0) is the centre of the top-left pixel.
    pub centroid: (f32, f32),
}

/// Pixels on in one row without a gap: columns `start..end`.
#[derive(Clone, Copy, Debug)]
struct Run {
    row: u32,
    start: u32,
    end: u32,
    /// A run of the same component found earlier, or itself.
    parent: u32,
}

#[derive(Clone, Copy, Debug)]
struct Sums {
    left: u32,
    top: u32,
    right: u32,
    bottom: u32,
    area: u64,
    x: u64,
    y: u64,
}

/// Finds regions, with the buffers that takes.
#[derive(Clone, Debug, Default)]
pub struct RegionFinder {
    runs: Vec<Run>,
    /// The region of each run.
    labels: Vec<u32>,
    sums: Vec<Sums>,
    regions: Vec<Region>,
}

impl RegionFinder {
    /// The regions of `mask` of at least `smallest` pixels, in the order of their first pixels, row by row.
    pub fn find(&mut self, mask: &Mask, smallest: u32) -> &[Region] {
        self.runs.clear();
        let mut above = 0;
        for y in 0..mask.height {
            let row = &mask.data[y * mask.width..(y + 1) * mask.width];
            let here = self.runs.len();
            self.collect(y as u32, row);
            self.join(above, here);
            above = here;
        }
        self.label();
        self.regions.clear();
        let (sums, regions) = (&self.sums, &mut self.regions);
        regions.extend(
            sums.iter()
                .filter(|sum| sum.area >= u64::from(smallest))
                .map(Sums::region),
        );
        regions
    }

    /// Writes for each pixel of the mask last searched 0 where it was off, else 1 + the index of its region among all
    /// regions of any size, in the order of their first pixels. `labels` has the mask's width and row-major order.
    pub fn write_labels(&self, width: usize, height: usize, labels: &mut Vec<u32>) {
        labels.clear();
        labels.resize(width * height, 0);
        for (run, &label) in self.runs.iter().zip(&self.labels) {
            let start = run.row as usize * width;
            if let Some(row) = labels.get_mut(start + run.start as usize..start + run.end as usize) {
                row.fill(label + 1);
            }
        }
    }

    fn collect(&mut self, y: u32, row: &[u8]) {
        let mut x = 0;
        while x < row.len() {
            let Some(gap) = row[x..].iter().position(|&pixel| pixel != 0) else {
                break;
            };
            let start = x + gap;
            let length = row[start..]
                .iter()
                .position(|&pixel| pixel == 0)
                .unwrap_or(row.len() - start);
            let parent = self.runs.len() as u32;
            self.runs.push(Run {
                row: y,
                start: start as u32,
                end: (start + length) as u32,
                parent,
            });
            x = start + length;
        }
    }

    /// Joins the runs from `here` on with those of the row above, which start at `above`.
    fn join(&mut self, above: usize, here: usize) {
        let (mut upper, mut lower) = (above, here);
        while upper < here && lower < self.runs.len() {
            let (over, under) = (self.runs[upper], self.runs[lower]);
            // Eight-connected: touching corners count.
            if over.end >= under.start && under.end >= over.start {
                let (a, b) = (self.root(upper), self.root(lower));
                let (first, second) = (a.min(b), a.max(b));
                self.runs[second].parent = first as u32;
            }
            if over.end < under.end {
                upper += 1
            } else {
                lower += 1
            }
        }
    }

    fn root(&mut self, run: usize) -> usize {
        let mut at = run;
        while self.runs[at].parent as usize != at {
            // Halve the path on the way.
            let parent = self.runs[at].parent as usize;
            self.runs[at].parent = self.runs[parent].parent;
            at = self.runs[at].parent as usize;
        }
        at
    }

    /// Numbers the components in the order of their first runs and sums them up.
    fn label(&mut self) {
        self.labels.clear();
        self.sums.clear();
        for at in 0..self.runs.len() {
            let root = self.root(at);
            let run = self.runs[at];
            // A root is the first run of its component, so it already has its label.
            let label = if root == at {
                self.sums.len() as u32
            } else {
                self.labels[root]
            };
            self.labels.push(label);
            if root == at {
                self.sums.push(Sums::new(run));
            } else {
                self.sums[label as usize].add(run);
            }
        }
    }
}

impl Sums {
    fn new(run: Run) -> Self {
        let mut sums = Self {
            left: run.start,
            top: run.row,
            right: run.end,
            bottom: run.row + 1,
            area: 0,
            x: 0,
            y: 0,
        };
        sums.add(run);
        sums
    }

    fn add(&mut self, run: Run) {
        let length = u64::from(run.end - run.start);
        self.left = self.left.min(run.start);
        self.right = self.right.max(run.end);
        self.bottom = self.bottom.max(run.row + 1);
        self.area += length;
        self.x += length * u64::from(run.start + run.end - 1);
        self.y += length * u64::from(run.row);
    }

    fn region(&self) -> Region {
        let area = self.area as f64;
        Region {
            bounds: Rectangle::new(
                self.left as f32,
                self.top as f32,
                (self.right - self.left) as f32,
                (self.bottom - self.top) as f32,
            ),
            area: self.area as u32,
            centroid: ((self.x as f64 / 2.0 / area) as f32, (self.y as f64 / area) as f32),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mask(rows: &[&str]) -> Mask {
        let data = rows
            .iter()
            .flat_map(|row| row.bytes().map(|c| if c == b'#' { 255 } else { 0 }))
            .collect();
        Mask {
            width: rows[0].len(),
            height: rows.len(),
            data,
        }
    }

    #[test]
    fn corners_join_and_gaps_part() {
        let mask = mask(&[
            "##....#.", //
            "..#..#..",
            "........",
            "#.#.#..#",
            "#########".get(..8).unwrap(),
        ]);
        let mut finder = RegionFinder::default();
        let regions = finder.find(&mask, 1).to_vec();
        assert_eq!(regions.len(), 3);
        assert_eq!(regions[0].bounds, Rectangle::new(0.0, 0.0, 3.0, 2.0));
        assert_eq!(regions[0].area, 3);
        assert_eq!(regions[0].centroid, (1.0, 1.0 / 3.0));
        assert_eq!(regions[1].bounds, Rectangle::new(5.0, 0.0, 2.0, 2.0));
        assert_eq!(regions[2].area, 12);
        let mut labels = Vec::new();
        finder.write_labels(8, 5, &mut labels);
        assert_eq!(labels[..8], [1, 1, 0, 0, 0, 0, 2, 0]);
        assert_eq!(labels[24..32], [3, 0, 3, 0, 3, 0, 0, 3]);
        assert_eq!(finder.find(&mask, 4).len(), 1);
    }

    #[test]
    fn a_spiral_is_one_region() {
        let mask = mask(&["#######", "#.....#", "#.###.#", "#.#...#", "#.#####", "#......"]);
        assert_eq!(RegionFinder::default().find(&mask, 1).len(), 1);
        let comb = mask_of_comb(64);
        assert_eq!(RegionFinder::default().find(&comb, 1).len(), 1);
    }

    /// Teeth that only the last row joins.
    fn mask_of_comb(width: usize) -> Mask {
        let mut mask = Mask::new(width, 3);
        for x in 0..width {
            let pixel = if x % 2 == 0 { 255 } else { 0 };
            (mask.data[x], mask.data[width + x], mask.data[2 * width + x]) = (pixel, pixel, 255);
        }
        mask
    }
}
