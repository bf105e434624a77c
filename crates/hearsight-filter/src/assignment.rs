//! Pairing rows with columns at the least total cost, where some pairs are forbidden.
//!
//! Tracks with detections, faces with voices, truth with estimates. Own shortest augmenting paths, because the
//! common routines want square or wide matrices of integers and have no forbidden pairs; large costs in their stead
//! lose digits and can still be chosen.

use crate::error::FilterError;

/// What a row costs that gets no column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unpaired {
    /// More than any sum of costs: as many pairs as possible, and among those the cheapest. For scoring.
    AsFewAsPossible,
    /// This much: pairs that cost more than it only happen where they free a cheaper pair. For tracking, where a
    /// missed detection is better than a far one.
    Costs(f64),
}

/// Who is paired with whom.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Assignment {
    /// For each row its column.
    pub column_of_row: Vec<Option<usize>>,
    /// For each column its row.
    pub row_of_column: Vec<Option<usize>>,
    /// The sum of the costs of the pairs; rows without one add nothing.
    pub cost: f64,
}

impl Assignment {
    /// The pairs (row, column), by row.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.column_of_row
            .iter()
            .enumerate()
            .filter_map(|(row, column)| column.map(|column| (row, column)))
    }
}

/// Finds assignments; owns its buffers, so that one that is kept allocates nothing in the long run.
#[derive(Clone, Debug, Default)]
pub struct Assigner {
    row_price: Vec<Cost>,
    column_price: Vec<Cost>,
    distance: Vec<Option<Cost>>,
    done: Vec<bool>,
    previous: Vec<usize>,
    assignment: Assignment,
}

/// Pairs each row with at most one column and each column with at most one row, at the least total cost.
///
/// `costs`: rows x columns, row by row, of any sign. A pair whose cost is above `gate`, infinite or NaN is forbidden.
/// Of several best pairings one is taken that depends on nothing but the costs. Time: rows^2 x columns (Jonker and
/// Volgenant 1987, without their initialization).
///
/// ```
/// use hearsight_filter::{Unpaired, assign};
/// let costs = [
///     1.0, 2.0, 9.0, //
///     1.5, 9.0, 9.0,
/// ];
/// let assignment = assign(&costs, 2, 3, 5.0, Unpaired::AsFewAsPossible)?;
/// assert_eq!(assignment.column_of_row, [Some(1), Some(0)]);
/// assert_eq!(assignment.cost, 3.5);
/// # Ok::<(), hearsight_filter::FilterError>(())
/// ```
///
/// # Errors
/// [`FilterError::SizeMismatch`] unless there are rows x columns costs; [`FilterError::NotFinite`] for an
/// [`Unpaired::Costs`] that is not finite; [`FilterError::OutOfRange`] for a gate of NaN or a cost of negative infinity.
pub fn assign(
    costs: &[f64],
    rows: usize,
    columns: usize,
    gate: f64,
    unpaired: Unpaired,
) -> Result<Assignment, FilterError> {
    let mut assigner = Assigner::default();
    assigner.assign(costs, rows, columns, gate, unpaired)?;
    Ok(assigner.assignment)
}

impl Assigner {
    /// As [`assign`]; the result is that of [`Assigner::assignment`] too, until the next call.
    ///
    /// # Errors
    /// As [`assign`]; the result of the call before is kept then.
    pub fn assign(
        &mut self,
        costs: &[f64],
        rows: usize,
        columns: usize,
        gate: f64,
        unpaired: Unpaired,
    ) -> Result<&Assignment, FilterError> {
        FilterError::check_length("costs", rows.saturating_mul(columns), costs.len())?;
        if gate.is_nan() {
            return Err(FilterError::OutOfRange {
                what: "gate",
                range: "a number",
                found: gate,
            });
        }
        if costs.contains(&f64::NEG_INFINITY) {
            return Err(FilterError::OutOfRange {
                what: "cost",
                range: "above -infinity",
                found: f64::NEG_INFINITY,
            });
        }
        let alone = match unpaired {
            Unpaired::AsFewAsPossible => Cost {
                unpaired: 1,
                sum: 0.0,
            },
            Unpaired::Costs(sum) if sum.is_finite() => Cost { unpaired: 0, sum },
            Unpaired::Costs(_) => {
                return Err(FilterError::NotFinite {
                    what: "the cost of an unpaired row",
                });
            }
        };
        self.reset(rows, columns);
        let mut search = Search {
            costs,
            columns,
            gate,
            alone,
            row_price: &mut self.row_price,
            column_price: &mut self.column_price,
            column_of_row: &mut self.assignment.column_of_row,
            row_of_column: &mut self.assignment.row_of_column,
            distance: &mut self.distance,
            done: &mut self.done,
            previous: &mut self.previous,
        };
        for row in 0..rows {
            search.place(row);
        }
        let pairs = self.assignment.pairs();
        self.assignment.cost = pairs.map(|(row, column)| costs[row * columns + column]).sum();
        Ok(&self.assignment)
    }

    /// The result of the last call.
    pub fn assignment(&self) -> &Assignment {
        &self.assignment
    }

    fn reset(&mut self, rows: usize, columns: usize) {
        fn refill<T: Clone>(buffer: &mut Vec<T>, length: usize, value: T) {
            buffer.clear();
            buffer.resize(length, value);
        }
        refill(&mut self.row_price, rows, Cost::default());
        refill(&mut self.column_price, columns, Cost::default());
        refill(&mut self.assignment.column_of_row, rows, None);
        refill(&mut self.assignment.row_of_column, columns, None);
        refill(&mut self.distance, columns, None);
        refill(&mut self.done, columns, false);
        refill(&mut self.previous, columns, 0);
    }
}

/// A cost in two parts, the first of which outweighs any second: exact where one large number would lose digits.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
struct Cost {
    unpaired: i64,
    sum: f64,
}

impl std::ops::Add for Cost {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            unpaired: self.unpaired + other.unpaired,
            sum: self.sum + other.sum,
        }
    }
}

impl std::ops::Sub for Cost {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            unpaired: self.unpaired - other.unpaired,
            sum: self.sum - other.sum,
        }
    }
}

struct Search<'a> {
    costs: &'a [f64],
    columns: usize,
    gate: f64,
    /// The cost of staying alone: an edge from every row to a place that is never full, so that its price stays zero.
    alone: Cost,
    row_price: &'a mut [Cost],
    column_price: &'a mut [Cost],
    column_of_row: &'a mut [Option<usize>],
    row_of_column: &'a mut [Option<usize>],
    /// Of each column, the length of the shortest path found to it; none if not reached.
    distance: &'a mut [Option<Cost>],
    done: &'a mut [bool],
    /// Of each reached column, the row before it on its path.
    previous: &'a mut [usize],
}

impl Search<'_> {
    /// The cost of a pair less the prices of both, never negative between rows placed so far; none if forbidden.
    fn reduced(&self, row: usize, column: usize) -> Option<Cost> {
        let cost = self.costs[row * self.columns + column];
        (cost <= self.gate && cost < f64::INFINITY).then(|| {
            Cost {
                unpaired: 0,
                sum: cost,
            } - self.row_price[row]
                - self.column_price[column]
        })
    }

    /// Places one more row along the shortest path (Dijkstra's) to a free column or to staying alone.
    fn place(&mut self, new: usize) {
        self.distance.fill(None);
        self.done.fill(false);
        // The row in hand, and the length of the path to it.
        let (mut row, mut length) = (new, Cost::default());
        // The shortest way to end with some row alone.
        let (mut loner, mut loner_length) = (new, self.alone - self.row_price[new]);
        let free_column = loop {
            let through = length + self.alone - self.row_price[row];
            if through < loner_length {
                (loner, loner_length) = (row, through);
            }
            let mut nearest: Option<(usize, Cost)> = None;
            for column in 0..self.columns {
                if self.done[column] {
                    continue;
                }
                if let Some(reduced) = self.reduced(row, column) {
                    let candidate = length + reduced;
                    if self.distance[column].is_none_or(|known| candidate < known) {
                        self.distance[column] = Some(candidate);
                        self.previous[column] = row;
                    }
                }
                if let Some(distance) = self.distance[column]
                    && nearest.is_none_or(|(_, best)| distance < best)
                {
                    nearest = Some((column, distance));
                }
            }
            let Some((column, distance)) = nearest.filter(|(_, distance)| *distance < loner_length) else {
                length = loner_length;
                break None;
            };
            length = distance;
            self.done[column] = true;
            match self.row_of_column[column] {
                Some(next) => row = next,
                None => break Some(column),
            }
        };
        self.raise_prices(new, length);
        // Along the path backwards: each row takes the column after it and gives up its own.
        let mut free = match free_column {
            Some(column) => column,
            None => match self.column_of_row[loner].take() {
                Some(column) => column,
                None => return,
            },
        };
        loop {
            let row = self.previous[free];
            self.row_of_column[free] = Some(row);
            match self.column_of_row[row].replace(free) {
                Some(given_up) => free = given_up,
                None => return,
            }
        }
    }

    /// Changes the prices so that every pair on a shortest path is free and none becomes negative.
    fn raise_prices(&mut self, new: usize, length: Cost) {
        self.row_price[new] = self.row_price[new] + length;
        for column in 0..self.columns {
            if let Some(distance) = self.distance[column].filter(|_| self.done[column]) {
                let slack = length - distance;
                self.column_price[column] = self.column_price[column] - slack;
                if let Some(row) = self.row_of_column[column] {
                    self.row_price[row] = self.row_price[row] + slack;
                }
            }
        }
    }
}

#[cfg(test)]
#[path = "assignment_tests.rs"]
mod tests;
