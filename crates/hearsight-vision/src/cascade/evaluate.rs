//! Running a cascade over a row of windows: many windows at once while many are left, then one by one.

#[cfg(target_arch = "x86_64")]
use super::evaluate_avx2;
use super::level::{LANES, Level};
use super::plan::{Corners, Plan, PlanNode};
use super::{Stage, Tree};
use multiversion::multiversion;

/// With fewer windows left of a group, they are finished one by one.
const FEW: u32 = 2;
/// Windows with less contrast are passed over: area / (area * standard deviation) above this (OpenCV's bound).
const FLAT: f64 = 0.1;

/// A window that passed all stages: its number in the row and the last stage's sum.
pub(crate) type Accepted = (usize, f64);

static NOTHING: [u32; LANES] = [0; LANES];

/// Runs all windows of one row: window i has its first entry at `first + i`. After a window that the first stage
/// rejects, the next one is passed over, as OpenCV does. `results` is scratch of at least as many entries as the
/// largest tree has nodes.
#[multiversion(targets("x86_64+avx2"))]
pub(crate) fn run_row(
    plan: &Plan,
    level: &Level,
    first: usize,
    windows: usize,
    results: &mut [[f32; LANES]],
    accepted: &mut Vec<Accepted>,
) {
    let mut skip = false;
    for start in (0..windows).step_by(LANES) {
        let base = first + start;
        let mut scale = [0.0; LANES];
        let present = u32::MAX >> (32 - (windows - start).min(LANES));
        let contrasted = scales(plan, level, base, &mut scale) & present;
        let mut sums = [0.0; LANES];
        let Some((opening, stages)) = plan.stages.split_first() else {
            return;
        };
        let passed = __multiversion::match_target! {
            "x86_64+avx2" => evaluate_avx2::run_stage(plan, opening, &level.sums, base, &scale, results, &mut sums),
            _ => run_stage(plan, opening, &level.sums, base, &scale, results, &mut sums)
        };
        let mut left = visited(contrasted & !passed, &mut skip) & contrasted & passed;
        let mut done = 0;
        for stage in stages {
            if left.count_ones() < FEW {
                break;
            }
            left &= __multiversion::match_target! {
                "x86_64+avx2" => evaluate_avx2::run_stage(plan, stage, &level.sums, base, &scale, results, &mut sums),
                _ => run_stage(plan, stage, &level.sums, base, &scale, results, &mut sums)
            };
            done += 1;
        }
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            let mut sum = sums[lane];
            let passed = stages[done..].iter().all(|stage| {
                sum = stage_sum(plan, stage, &level.sums, base + lane, scale[lane]);
                sum >= f64::from(stage.threshold)
            });
            if passed {
                accepted.push((start + lane, sum));
            }
        }
    }
}

/// Which windows are looked at: not those after one that was looked at and rejected.
#[inline(always)]
fn visited(rejected: u32, skip: &mut bool) -> u32 {
    let mut visited = 0;
    for lane in 0..LANES {
        let looked_at = !*skip;
        visited |= u32::from(looked_at) << lane;
        *skip = looked_at && rejected >> lane & 1 == 1;
    }
    visited
}

#[inline(always)]
pub(crate) fn entries(table: &[u32], at: usize) -> &[u32; LANES] {
    table
        .get(at..)
        .and_then(|rest| rest.first_chunk())
        .unwrap_or(&NOTHING)
}

/// The sums over one rectangle in all windows of a group.
#[inline(always)]
fn rectangle_sums(table: &[u32], base: usize, corners: &Corners) -> [i32; LANES] {
    let [a, b, c, d] = corners.map(|offset| entries(table, base + offset as usize));
    let mut sums = [0; LANES];
    for i in 0..LANES {
        sums[i] = a[i].wrapping_sub(b[i]).wrapping_sub(c[i]).wrapping_add(d[i]) as i32;
    }
    sums
}

/// One over area times standard deviation of each window; returns which windows have contrast enough.
#[inline(always)]
fn scales(plan: &Plan, level: &Level, base: usize, scale: &mut [f32; LANES]) -> u32 {
    let sums = rectangle_sums(&level.sums, base, &plan.inner);
    let squares = rectangle_sums(&level.squares, base, &plan.inner);
    let mut enough = 0;
    for i in 0..LANES {
        let sum = f64::from(sums[i]);
        let spread = plan.inner_area * f64::from(squares[i] as u32) - sum * sum;
        scale[i] = (1.0 / spread.sqrt()) as f32;
        let contrasted = spread > 0.0 && plan.inner_area * f64::from(scale[i]) < FLAT;
        enough |= u32::from(contrasted) << i;
    }
    enough
}

/// One over area times standard deviation of the first window, if it has contrast enough.
pub(crate) fn contrast(plan: &Plan, level: &Level) -> Option<f32> {
    let mut scale = [0.0; LANES];
    (scales(plan, level, 0, &mut scale) & 1 == 1).then_some(scale[0])
}

/// Sums up a stage for all windows of a group; returns which reach its threshold.
#[inline(always)]
fn run_stage(
    plan: &Plan,
    stage: &Stage,
    table: &[u32],
    base: usize,
    scale: &[f32; LANES],
    results: &mut [[f32; LANES]],
    sums: &mut [f64; LANES],
) -> u32 {
    *sums = [0.0; LANES];
    for tree in &plan.trees[stage.first_tree..stage.first_tree + stage.trees] {
        let nodes = &plan.nodes[tree.first_node..tree.first_node + tree.nodes];
        let leaves = &plan.leaves[tree.first_leaf..=tree.first_leaf + tree.nodes];
        // Children come after their parents, so backwards every node finds its children's results.
        for (at, node) in nodes.iter().enumerate().rev() {
            let values = values(table, base, node, scale);
            let branch = |child: i32| match child {
                1.. => results[child as usize],
                _ => [leaves[child.unsigned_abs() as usize]; LANES],
            };
            let (left, right) = (branch(node.left), branch(node.right));
            let result = &mut results[at];
            for i in 0..LANES {
                result[i] = if values[i] < node.threshold {
                    left[i]
                } else {
                    right[i]
                };
            }
        }
        for i in 0..LANES {
            sums[i] += f64::from(results[0][i]);
        }
    }
    let threshold = f64::from(stage.threshold);
    let mut passed = 0;
    for i in 0..LANES {
        passed |= u32::from(sums[i] >= threshold) << i;
    }
    passed
}

/// A feature's value in all windows of a group.
#[inline(always)]
fn values(table: &[u32], base: usize, node: &PlanNode, scale: &[f32; LANES]) -> [f32; LANES] {
    let first = rectangle_sums(table, base, &node.corners[0]);
    let second = rectangle_sums(table, base, &node.corners[1]);
    let mut values = [0.0; LANES];
    for i in 0..LANES {
        values[i] = node.weights[0] * first[i] as f32 + node.weights[1] * second[i] as f32;
    }
    if node.weights[2] != 0.0 {
        let third = rectangle_sums(table, base, &node.corners[2]);
        for i in 0..LANES {
            values[i] += node.weights[2] * third[i] as f32;
        }
    }
    for i in 0..LANES {
        values[i] *= scale[i];
    }
    values
}

/// Sums up a stage for one window.
#[inline(always)]
pub(crate) fn stage_sum(plan: &Plan, stage: &Stage, table: &[u32], base: usize, scale: f32) -> f64 {
    let mut sum = 0.0;
    for tree in &plan.trees[stage.first_tree..stage.first_tree + stage.trees] {
        sum += f64::from(tree_leaf(plan, tree, table, base, scale));
    }
    sum
}

#[inline(always)]
fn tree_leaf(plan: &Plan, tree: &Tree, table: &[u32], base: usize, scale: f32) -> f32 {
    let mut at = 0;
    loop {
        let node = &plan.nodes[tree.first_node + at];
        let below = value(table, base, node) * scale < node.threshold;
        let child = if below { node.left } else { node.right };
        if child <= 0 {
            return plan.leaves[tree.first_leaf + child.unsigned_abs() as usize];
        }
        at = child as usize;
    }
}

#[inline(always)]
fn value(table: &[u32], base: usize, node: &PlanNode) -> f32 {
    let sum = |corners: &Corners| {
        let [a, b, c, d] = corners.map(|offset| table[base + offset as usize]);
        a.wrapping_sub(b).wrapping_sub(c).wrapping_add(d) as i32 as f32
    };
    let mut value = node.weights[0] * sum(&node.corners[0]) + node.weights[1] * sum(&node.corners[1]);
    if node.weights[2] != 0.0 {
        value += node.weights[2] * sum(&node.corners[2]);
    }
    value
}

#[cfg(test)]
mod tests;
