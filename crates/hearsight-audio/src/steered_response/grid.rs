//! The best point of a room: a coarse grid all over it, then ever finer ones around the best of the points.
//!
//! A coarse grid steps over narrow peaks. Each of its points therefore stands for its cell: pairs are looked up in
//! tables whose values are the highest within the delays that a cell covers.

use super::SteeredResponse;
use super::lookup::{DelayTable, Entry};
use crate::error::{AudioError, check_setting};
use hearsight_core::WorldPoint;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Most points of a coarse grid: beyond, the room or the step is a slip.
const MOST_POINTS: usize = 4_000_000;

/// Steps uphill from the best point of the finest grid.
const CLIMBS: usize = 24;

/// A box in the world, metres, lower and upper corner; no side may be negative.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bounds {
    /// Least x, y, z.
    pub low_m: [f64; 3],
    /// Greatest x, y, z.
    pub high_m: [f64; 3],
}

/// How a room is searched.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SearchSettings {
    /// Step of the coarse grid, metres, default 0.25. Raising it is faster and may miss a source.
    pub coarse_m: f64,
    /// Step of the finest grid, metres, default 0.02.
    pub fine_m: f64,
    /// Cells that are looked at more finely at every level, 1 to 1000, default 24.
    pub kept: usize,
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self {
            coarse_m: 0.25,
            fine_m: 0.02,
            kept: 24,
        }
    }
}

/// What a search found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The best point.
    pub point: WorldPoint,
    /// Its score.
    pub score: f32,
}

/// A search of one room by one array, with the buffers that takes.
#[derive(Clone)]
pub struct Search {
    bounds: Bounds,
    settings: SearchSettings,
    coarse: Vec<WorldPoint>,
    table: DelayTable,
    /// Entries of the tables that a coarse cell covers on both sides, for each pair.
    reach: Vec<usize>,
    pooled: Vec<Entry>,
    scores: Vec<f32>,
    order: Vec<(f32, u32)>,
    cells: [Vec<f32>; 3],
    cell_scores: Vec<f32>,
    best: Vec<[f32; 3]>,
    /// Middle of the microphones.
    centre: Vector3<f32>,
}

impl Bounds {
    /// # Errors
    /// [`AudioError::Setting`] where a corner is not finite or low is above high.
    pub fn validate(&self) -> Result<(), AudioError> {
        for (low, high) in self.low_m.iter().zip(self.high_m) {
            let holds = low.is_finite() && high.is_finite() && *low <= high;
            check_setting(holds, "bounds", "finite, low not above high", high - low)?;
        }
        Ok(())
    }

    /// Whether a point is inside or on the border.
    pub fn contains(&self, point: WorldPoint) -> bool {
        (0..3).all(|axis| (self.low_m[axis]..=self.high_m[axis]).contains(&point.0[axis]))
    }

    /// The points of a grid whose cells of at most `step_m` fill the box, each in the middle of its cell. A side of
    /// no length has one point.
    ///
    /// # Errors
    /// [`AudioError::Setting`] for bounds or a step that make no grid, or one of more than four million points.
    pub fn grid(&self, step_m: f64) -> Result<Vec<WorldPoint>, AudioError> {
        self.validate()?;
        check_setting(step_m > 0.0 && step_m.is_finite(), "step_m", "above 0", step_m)?;
        let counts: [f64; 3] =
            std::array::from_fn(|k| ((self.high_m[k] - self.low_m[k]) / step_m - 1e-9).ceil().max(1.0));
        let points: f64 = counts.iter().product();
        check_setting(
            points <= MOST_POINTS as f64,
            "points of the grid",
            "at most 4 million",
            points,
        )?;
        let at = |axis: usize, k: f64| {
            self.low_m[axis] + (self.high_m[axis] - self.low_m[axis]) * (k + 0.5) / counts[axis]
        };
        let [nx, ny, nz] = counts.map(|count| count as u32);
        let mut grid = Vec::with_capacity(points as usize);
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    grid.push(WorldPoint::new(at(0, x.into()), at(1, y.into()), at(2, z.into())));
                }
            }
        }
        Ok(grid)
    }
}

impl Search {
    /// A search of `bounds` for the array of `response`.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where bounds or settings make no grid.
    pub fn new(
        response: &SteeredResponse,
        bounds: Bounds,
        settings: SearchSettings,
    ) -> Result<Self, AudioError> {
        let SearchSettings {
            coarse_m,
            fine_m,
            kept,
        } = settings;
        check_setting(
            fine_m > 0.0 && fine_m <= coarse_m,
            "fine_m",
            "above 0 and at most coarse_m",
            fine_m,
        )?;
        check_setting(
            (1..=1000).contains(&kept),
            "kept",
            "within 1 and 1000",
            kept as f64,
        )?;
        let coarse = bounds.grid(coarse_m)?;
        let positions: Vec<Vector3<f64>> = response
            .positions
            .iter()
            .map(|p| Vector3::new(p[0].into(), p[1].into(), p[2].into()))
            .collect();
        let half_diagonal = 0.5 * coarse_m * 3.0_f64.sqrt();
        let reach = response.pairs.iter().map(|&(i, j)| {
            let away = |point: &WorldPoint, k: usize| {
                (point.0.coords - positions[k])
                    .try_normalize(1e-9)
                    .unwrap_or_else(Vector3::zeros)
            };
            let squares: f64 = coarse
                .iter()
                .map(|p| (away(p, i) - away(p, j)).norm_squared())
                .sum();
            let change_m = (squares / coarse.len() as f64).sqrt() * half_diagonal;
            (change_m * f64::from(response.scale.per_metre)).round() as usize
        });
        Ok(Self {
            reach: reach.collect(),
            table: response.table(&coarse),
            pooled: Vec::new(),
            scores: Vec::new(),
            order: Vec::new(),
            cells: Default::default(),
            cell_scores: Vec::new(),
            best: Vec::new(),
            centre: positions
                .iter()
                .map(|p| p.map(|v| v as f32))
                .sum::<Vector3<f32>>()
                / positions.len() as f32,
            bounds,
            settings,
            coarse,
        })
    }

    /// The box that is searched.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// How many points the coarse grid has.
    pub fn coarse_points(&self) -> usize {
        self.coarse.len()
    }

    /// The best point for the frame that `response` observed last, by the sum of its score and `prior` of the point
    /// (a logarithm of a density for products; 0 for none).
    ///
    /// # Errors
    /// [`AudioError::Shape`] where `response` is of another array.
    pub fn find(
        &mut self,
        response: &mut SteeredResponse,
        prior: impl Fn([f32; 3]) -> f32,
    ) -> Result<Found, AudioError> {
        self.pool(response);
        let length = response.curves.length();
        self.table
            .score(&self.pooled, response.pairs.len(), length, &mut self.scores)?;
        self.best.clear();
        for (score, point) in self.scores.iter_mut().zip(&self.coarse) {
            *score += prior(narrow(point));
        }
        rank(&self.scores, self.settings.kept, &mut self.order);
        self.best
            .extend(self.order.iter().map(|&(_, k)| narrow(&self.coarse[k as usize])));
        let mut step = self.settings.coarse_m as f32;
        let mut found = (f32::NEG_INFINITY, self.best.first().copied().unwrap_or_default());
        while step > self.settings.fine_m as f32 {
            step *= 0.5;
            self.divide(step);
            let [x, y, z] = &self.cells;
            self.cell_scores.resize(x.len(), 0.0);
            response.score_points([x, y, z], &mut self.cell_scores);
            for (k, score) in self.cell_scores.iter_mut().enumerate() {
                *score += prior([x[k], y[k], z[k]]);
            }
            rank(&self.cell_scores, self.settings.kept, &mut self.order);
            self.best.clear();
            self.best.extend(self.order.iter().map(|&(_, k)| {
                let k = k as usize;
                [x[k], y[k], z[k]]
            }));
            if let (Some(&(score, _)), Some(&point)) = (self.order.first(), self.best.first()) {
                found = (score, point);
            }
        }
        let (score, [x, y, z]) = self.climb(response, &prior, found);
        Ok(Found {
            point: WorldPoint::new(x.into(), y.into(), z.into()),
            score,
        })
    }

    /// Steps uphill from the best point. An array is far less sure of the range than of the direction, so that its
    /// ridges are long and narrow: steps go along the line to the array, many times as far as across it.
    fn climb(
        &mut self,
        response: &mut SteeredResponse,
        prior: &impl Fn([f32; 3]) -> f32,
        from: (f32, [f32; 3]),
    ) -> (f32, [f32; 3]) {
        let (mut best, mut at) = from;
        let mut step = self.settings.fine_m as f32;
        for _ in 0..CLIMBS {
            let away = Vector3::from(at) - self.centre;
            let along = away.try_normalize(1e-3).unwrap_or_else(Vector3::x);
            let side = along
                .cross(&Vector3::z())
                .try_normalize(1e-3)
                .unwrap_or_else(Vector3::y);
            let up = side.cross(&along);
            for cells in &mut self.cells {
                cells.clear();
            }
            for (axis, factor) in [(along, 8.0), (along, 1.0), (side, 1.0), (up, 1.0)] {
                for sign in [-1.0, 1.0] {
                    let point = Vector3::from(at) + axis * (sign * factor * step);
                    for k in 0..3 {
                        let [low, high] = [self.bounds.low_m[k], self.bounds.high_m[k]].map(|v| v as f32);
                        self.cells[k].push(point[k].clamp(low, high));
                    }
                }
            }
            let [x, y, z] = &self.cells;
            self.cell_scores.resize(x.len(), 0.0);
            response.score_points([x, y, z], &mut self.cell_scores);
            let before = best;
            for (k, score) in self.cell_scores.iter().enumerate() {
                let point = [x[k], y[k], z[k]];
                let score = score + prior(point);
                if score > best {
                    (best, at) = (score, point);
                }
            }
            if best == before {
                step *= 0.5;
            }
        }
        (best, at)
    }

    /// The cells of half the size: eight for each of the best, kept inside the room.
    fn divide(&mut self, step: f32) {
        for cells in &mut self.cells {
            cells.clear();
        }
        for best in &self.best {
            for corner in 0..8 {
                for axis in 0..3 {
                    let offset = if corner >> axis & 1 == 0 { -0.5 } else { 0.5 };
                    let [low, high] = [self.bounds.low_m[axis], self.bounds.high_m[axis]].map(|v| v as f32);
                    self.cells[axis].push((best[axis] + offset * step).clamp(low, high));
                }
            }
        }
    }

    /// The highest value within a cell's reach, for every entry of every pair.
    fn pool(&mut self, response: &SteeredResponse) {
        let length = response.curves.length();
        self.pooled.resize(response.entries.len(), Entry::default());
        let tables = response
            .entries
            .chunks_exact(length)
            .zip(self.pooled.chunks_exact_mut(length));
        for ((from, to), &reach) in tables.zip(&self.reach) {
            for k in 0..length {
                let window = &from[k.saturating_sub(reach)..(k + reach + 1).min(length)];
                let value = window
                    .iter()
                    .fold(f32::NEG_INFINITY, |most, entry| most.max(entry.value));
                to[k] = Entry { value, step: 0.0 };
            }
        }
    }
}

fn narrow(point: &WorldPoint) -> [f32; 3] {
    [point.0.x as f32, point.0.y as f32, point.0.z as f32]
}

/// The `kept` highest scores with their places, highest first; among equals the first.
fn rank(scores: &[f32], kept: usize, order: &mut Vec<(f32, u32)>) {
    order.clear();
    let finite = scores
        .iter()
        .map(|score| if score.is_nan() { f32::NEG_INFINITY } else { *score });
    order.extend(finite.zip(0..));
    let before = |a: &(f32, u32), b: &(f32, u32)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
    if order.len() > kept {
        order.select_nth_unstable_by(kept, before);
        order.truncate(kept);
    }
    order.sort_unstable_by(before);
}
