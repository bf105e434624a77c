//! Grouping overlapping windows, as OpenCV's `groupRectangles` does.

use super::detect::{Detection, Window};
use hearsight_core::Rectangle;

/// Groups windows, with the buffers that takes.
#[derive(Clone, Debug)]
pub(crate) struct Grouping {
    parents: Vec<usize>,
    numbers: Vec<usize>,
    groups: Vec<Group>,
}

impl Grouping {
    /// Buffers for so many windows.
    pub(crate) fn with_room_for(windows: usize) -> Self {
        Self {
            parents: Vec::with_capacity(windows),
            numbers: Vec::with_capacity(windows),
            groups: Vec::with_capacity(windows),
        }
    }

    /// Groups `windows`: those alike within `tolerance` (as a share of the smaller one's size), directly or over others,
    /// become their mean. Groups of no more than `neighbours` windows are dropped, and so are those within a larger group
    /// of more windows. With 0 neighbours every window stays as it is.
    ///
    /// The order is that of each group's first window.
    pub(crate) fn group(
        &mut self,
        windows: &[Window],
        neighbours: u32,
        tolerance: f64,
    ) -> impl Iterator<Item = Detection> {
        self.groups.clear();
        if neighbours == 0 {
            self.groups.extend(windows.iter().map(Group::of));
        } else {
            self.merge(windows, tolerance);
        }
        let groups = &self.groups;
        groups
            .iter()
            .enumerate()
            .filter(move |(at, group)| {
                neighbours == 0
                    || group.count > neighbours
                        && !groups.iter().enumerate().any(|(other, large)| {
                            other != *at && large.count > neighbours && group.is_within(large, tolerance)
                        })
            })
            .map(|(_, group)| group.detection())
    }

    /// The connected components under likeness, averaged, in the order of their first windows.
    fn merge(&mut self, windows: &[Window], tolerance: f64) {
        let Self {
            parents,
            numbers,
            groups,
        } = self;
        parents.clear();
        parents.extend(0..windows.len());
        for second in 1..windows.len() {
            for first in 0..second {
                if alike(&windows[first], &windows[second], tolerance) {
                    let (a, b) = (root(parents, first), root(parents, second));
                    parents[a.max(b)] = a.min(b);
                }
            }
        }
        // The root is the first window of its group.
        numbers.clear();
        numbers.resize(windows.len(), 0);
        for (at, window) in windows.iter().enumerate() {
            let root = root(parents, at);
            if root == at {
                numbers[at] = groups.len();
                groups.push(Group::of(window));
            } else {
                groups[numbers[root]].add(window);
            }
        }
        groups.iter_mut().for_each(Group::average);
    }
}

/// Windows alike, summed up and then averaged.
#[derive(Clone, Debug)]
struct Group {
    left: i32,
    top: i32,
    width: i32,
    height: i32,
    count: u32,
    score: f32,
    mirrored: bool,
}

impl Group {
    fn of(window: &Window) -> Self {
        Self {
            left: window.left,
            top: window.top,
            width: window.width,
            height: window.height,
            count: 1,
            score: window.score,
            mirrored: window.mirrored,
        }
    }

    fn add(&mut self, window: &Window) {
        self.left += window.left;
        self.top += window.top;
        self.width += window.width;
        self.height += window.height;
        self.count += 1;
        self.score = self.score.max(window.score);
    }

    /// Divides, in OpenCV's arithmetic.
    fn average(&mut self) {
        let share = 1.0 / self.count as f32;
        for side in [&mut self.left, &mut self.top, &mut self.width, &mut self.height] {
            *side = (*side as f32 * share).round_ties_even() as i32;
        }
    }

    fn is_within(&self, large: &Self, tolerance: f64) -> bool {
        let across = (f64::from(large.width) * tolerance).round_ties_even() as i32;
        let down = (f64::from(large.height) * tolerance).round_ties_even() as i32;
        self.left >= large.left - across
            && self.top >= large.top - down
            && self.left + self.width <= large.left + large.width + across
            && self.top + self.height <= large.top + large.height + down
            && (large.count > self.count.max(3) || self.count < 3)
    }

    fn detection(&self) -> Detection {
        Detection {
            bounds: Rectangle::new(
                self.left as f32,
                self.top as f32,
                self.width as f32,
                self.height as f32,
            ),
            neighbours: self.count,
            score: self.score,
            mirrored: self.mirrored,
        }
    }
}

fn alike(a: &Window, b: &Window, tolerance: f64) -> bool {
    let smaller = f64::from(a.width.min(b.width) + a.height.min(b.height));
    let most = tolerance * smaller * 0.5;
    let near = |a: i32, b: i32| f64::from((a - b).abs()) <= most;
    near(a.left, b.left)
        && near(a.top, b.top)
        && near(a.left + a.width, b.left + b.width)
        && near(a.top + a.height, b.top + b.height)
}

fn root(parents: &mut [usize], mut at: usize) -> usize {
    while parents[at] != at {
        parents[at] = parents[parents[at]];
        at = parents[at];
    }
    at
}
