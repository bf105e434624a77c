//! Pairs of people and tracks at the least cost, where few of all pairs are allowed.
//!
//! Most people have one track near them and it has nobody else: these are paired at once, and only groups that share
//! are assigned, each alone. Pairings of separate groups do not touch, so the result is that of the whole.

use crate::sequence::{MOST_PAIRS, SequenceError};
use hearsight_filter::{Unpaired, assign};

/// An allowed pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Edge {
    pub(crate) row: u32,
    pub(crate) column: u32,
    pub(crate) cost: f64,
}

/// What a pairing aims at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Aim {
    /// As many pairs as possible, and among those the cheapest.
    Most,
    /// The least sum of costs; only pairs of negative cost are worth having.
    Least,
}

/// Memory that is used again.
#[derive(Debug, Default)]
pub(crate) struct Matcher {
    row_degree: Vec<u32>,
    column_degree: Vec<u32>,
    /// Of rows, then of columns: the one that leads to the root of their group.
    parent: Vec<u32>,
    shared: Vec<(u32, Edge)>,
}

impl Matcher {
    /// Pairs rows and columns; `pairs` becomes the places of the chosen edges, ascending. Costs are finite; no pair
    /// stands twice.
    pub(crate) fn pair(
        &mut self,
        rows: usize,
        columns: usize,
        edges: &[Edge],
        aim: Aim,
        pairs: &mut Vec<(u32, u32)>,
    ) -> Result<(), SequenceError> {
        pairs.clear();
        self.row_degree.clear();
        self.row_degree.resize(rows, 0);
        self.column_degree.clear();
        self.column_degree.resize(columns, 0);
        let wanted = |edge: &&Edge| aim == Aim::Most || edge.cost < 0.0;
        for edge in edges.iter().filter(wanted) {
            self.row_degree[edge.row as usize] += 1;
            self.column_degree[edge.column as usize] += 1;
        }
        self.shared.clear();
        for edge in edges.iter().filter(wanted) {
            if self.row_degree[edge.row as usize] == 1 && self.column_degree[edge.column as usize] == 1 {
                pairs.push((edge.row, edge.column));
            } else {
                self.shared.push((0, *edge));
            }
        }
        if !self.shared.is_empty() {
            self.pair_groups(rows, columns, aim, pairs)?;
        }
        pairs.sort_unstable();
        Ok(())
    }

    fn pair_groups(
        &mut self,
        rows: usize,
        columns: usize,
        aim: Aim,
        pairs: &mut Vec<(u32, u32)>,
    ) -> Result<(), SequenceError> {
        let Self { parent, shared, .. } = self;
        parent.clear();
        parent.extend(0..(rows + columns) as u32);
        for (_, edge) in shared.iter() {
            let (one, other) = (root(parent, edge.row), root(parent, edge.column + rows as u32));
            parent[one.max(other) as usize] = one.min(other);
        }
        for (group, edge) in shared.iter_mut() {
            *group = root(parent, edge.row);
        }
        shared.sort_by_key(|(group, edge)| (*group, edge.row, edge.column));
        let (mut group_rows, mut group_columns, mut costs) = (Vec::new(), Vec::new(), Vec::new());
        for group in shared.chunk_by(|one, other| one.0 == other.0) {
            group_rows.clear();
            group_rows.extend(group.iter().map(|(_, edge)| edge.row));
            group_rows.dedup();
            group_columns.clear();
            group_columns.extend(group.iter().map(|(_, edge)| edge.column));
            group_columns.sort_unstable();
            group_columns.dedup();
            let (height, width) = (group_rows.len(), group_columns.len());
            if height.saturating_mul(width) > MOST_PAIRS {
                return Err(SequenceError::TooLarge {
                    what: "a group that meets".to_owned(),
                    people: height,
                    tracks: width,
                });
            }
            costs.clear();
            costs.resize(height * width, f64::INFINITY);
            let mut row = 0;
            for (_, edge) in group {
                if group_rows[row] != edge.row {
                    row += 1;
                }
                let column = group_columns.partition_point(|&column| column < edge.column);
                costs[row * width + column] = edge.cost;
            }
            let unpaired = match aim {
                Aim::Most => Unpaired::AsFewAsPossible,
                Aim::Least => Unpaired::Costs(0.0),
            };
            // Sizes fit, no cost is negative infinity and the gate is a number: nothing is left to refuse.
            if let Ok(assignment) = assign(&costs, height, width, f64::MAX, unpaired) {
                let chosen = assignment.pairs();
                pairs.extend(chosen.map(|(row, column)| (group_rows[row], group_columns[column])));
            }
        }
        Ok(())
    }
}

/// The one that stands for the group of `index`, shortening the way to it.
fn root(parent: &mut [u32], mut index: u32) -> u32 {
    while parent[index as usize] != index {
        parent[index as usize] = parent[parent[index as usize] as usize];
        index = parent[index as usize];
    }
    index
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn groups_apart_give_what_all_together_give(
            rows in 1_usize..7,
            columns in 1_usize..7,
            costs in prop::collection::vec(prop::option::of(-1.0..1.0_f64), 36),
            most in any::<bool>(),
        ) {
            let cost = |row: usize, column: usize| costs[row * 6 + column];
            let mut edges = Vec::new();
            let mut dense = vec![f64::INFINITY; rows * columns];
            for row in 0..rows {
                for column in 0..columns {
                    if let Some(cost) = cost(row.min(5), column.min(5)) {
                        edges.push(Edge { row: row as u32, column: column as u32, cost });
                        dense[row * columns + column] = cost;
                    }
                }
            }
            let (aim, unpaired) = if most {
                (Aim::Most, Unpaired::AsFewAsPossible)
            } else {
                (Aim::Least, Unpaired::Costs(0.0))
            };
            let mut pairs = Vec::new();
            Matcher::default().pair(rows, columns, &edges, aim, &mut pairs).unwrap();
            let together = assign(&dense, rows, columns, f64::MAX, unpaired).unwrap();
            let sum: f64 = pairs.iter().map(|&(row, column)| dense[row as usize * columns + column as usize]).sum();
            prop_assert!((sum - together.cost).abs() < 1e-12, "{pairs:?} {together:?}");
            if most {
                prop_assert_eq!(pairs.len(), together.pairs().count());
            }
        }
    }
}
