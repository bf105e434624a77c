//! The steered response of an array: how well a point explains what all microphone pairs hear.
//!
//! Each channel is whitened once, each pair is correlated once a frame over the delays that the array allows, and any
//! number of points then only looks its delays up. No transform a point: ten thousand points of a grid or the particles
//! of a filter cost a few additions each. Delays are those of spherical waves, between the samples.
//!
//! * [`SteeredResponse`] — correlates a frame and scores points.
//! * [`DelayTable`] — the delays of points that stay where they are, found once.
//! * [`Search`] — the best point of a room, from a coarse grid to a fine one.

mod curves;
mod grid;
mod lag_window;
mod lookup;

pub use grid::{Bounds, Found, Search, SearchSettings};
pub use lookup::DelayTable;

use crate::Complex;
use crate::error::{AudioError, check_setting};
use crate::spectrum::bin_range;
use curves::PairCurves;
use hearsight_core::WorldPoint;
use hearsight_core::microphones::MicrophoneArray;
use lookup::{Entry, LANES, PlaceScale};
use serde::{Deserialize, Serialize};

/// Lowest mean correlation that counts where pairs are summed.
const LEAST_SUM: f32 = 0.02;
/// Highest frequency used, as a share of the rate.
const HIGHEST_SHARE: f64 = 0.46;

/// How the pairs of an array are put together into one score of a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Combination {
    /// The logarithm of the product of the pairs, each held at `floor` of its highest value and raised to `exponent`:
    /// `sum_p exponent ln(max(R_p, floor max R_p) / max R_p)`. A correlation is signed, so the bare product of
    /// Pnevmatikakis and Talantzis, equation 12, is no likelihood; this is its corrected form (Ward, Lehmann and
    /// Williamson 2003). At most 0. Intersections tell places apart better than unions (Pertila, Korhonen and Visa
    /// 2008).
    Product {
        /// Share of its highest value below which a pair says nothing, above 0 to below 1.
        floor: f32,
        /// Power of each pair, above 0: 1 to 3 is usual. Raising it trusts every frame more.
        exponent: f32,
    },
    /// The mean of the pairs, at most 1: the classic steered response power with phase transform.
    Sum,
}

impl Default for Combination {
    fn default() -> Self {
        Self::Product {
            floor: 0.05,
            exponent: 1.0,
        }
    }
}

/// How a frame becomes a response.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SteeredSettings {
    /// Values of a pair's correlation a sample, 1 to 64, default 8; between them a point is interpolated linearly.
    /// Of a flat spectrum the peak is then right to 0.7 %. Raising it costs time in proportion.
    pub interpolation: usize,
    /// Lowest frequency that counts, hertz, default 150: below it rooms hum.
    pub low_hz: f64,
    /// Highest frequency that counts, hertz, default 8000; 0.46 of the rate where that is lower: nearer to half of it
    /// converters leave nothing, and the phase transform would make it as loud as all the rest.
    pub high_hz: f64,
    /// How pairs are put together.
    pub combination: Combination,
}

impl Default for SteeredSettings {
    fn default() -> Self {
        Self {
            interpolation: 8,
            low_hz: 150.0,
            high_hz: 8000.0,
            combination: Combination::default(),
        }
    }
}

/// Scores points by what all pairs of an array hear in one frame. Holds plans, tables and scratch; saves nothing from
/// frame to frame.
#[derive(Clone)]
pub struct SteeredResponse {
    settings: SteeredSettings,
    positions: Vec<[f32; 3]>,
    pairs: Vec<(usize, usize)>,
    scale: PlaceScale,
    curves: PairCurves,
    /// For each pair the score at every delay and the step to the next one.
    entries: Vec<Entry>,
    /// Distances of a block of points: microphones x lanes.
    distances: Vec<[f32; LANES]>,
}

impl SteeredResponse {
    /// A response of all pairs of `array` to spectra of `transform_length` at `rate_hz`.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where a setting is out of its range, the array has fewer than two microphones, or the
    /// transform is too short for its delays.
    pub fn new(
        array: &MicrophoneArray,
        transform_length: usize,
        rate_hz: u32,
        settings: SteeredSettings,
    ) -> Result<Self, AudioError> {
        let count = array.positions().len();
        check_setting(count >= 2, "microphones", "two or more", count as f64)?;
        check_setting(rate_hz > 0, "rate_hz", "above 0", f64::from(rate_hz))?;
        if let Combination::Product { floor, exponent } = settings.combination {
            let holds = floor > 0.0 && floor < 1.0;
            check_setting(holds, "floor", "above 0 and below 1", f64::from(floor))?;
            let holds = exponent > 0.0 && exponent.is_finite();
            check_setting(holds, "exponent", "above 0", f64::from(exponent))?;
        }
        check_setting(
            settings.low_hz >= 0.0 && settings.low_hz < settings.high_hz,
            "low_hz",
            "from 0 to below high_hz",
            settings.low_hz,
        )?;
        let high_hz = settings.high_hz.min(HIGHEST_SHARE * f64::from(rate_hz));
        let bins = bin_range(settings.low_hz, high_hz, rate_hz, transform_length);
        check_setting(
            !bins.is_empty(),
            "low_hz",
            "low enough that a frequency is left",
            settings.low_hz,
        )?;
        let pairs: Vec<(usize, usize)> = array.pairs().map(|pair| (pair.first, pair.second)).collect();
        let max_delay = array.max_delay_s() * f64::from(rate_hz);
        let curves = PairCurves::new(transform_length, max_delay, settings.interpolation, bins, count)?;
        let scale = PlaceScale {
            per_metre: (f64::from(rate_hz) * settings.interpolation as f64 / array.speed_of_sound_m_s())
                as f32,
            middle: curves.half() as f32,
        };
        Ok(Self {
            positions: array
                .positions()
                .iter()
                .map(|p| [p.0.x as f32, p.0.y as f32, p.0.z as f32])
                .collect(),
            entries: vec![Entry::default(); pairs.len() * curves.length()],
            distances: vec![[0.0; LANES]; count],
            settings,
            pairs,
            scale,
            curves,
        })
    }

    /// The settings it was made with.
    pub fn settings(&self) -> &SteeredSettings {
        &self.settings
    }

    /// How many microphones there are.
    pub fn microphones(&self) -> usize {
        self.positions.len()
    }

    /// The pairs (i, j), i < j, in the order of [`MicrophoneArray::pairs`].
    pub fn pairs(&self) -> &[(usize, usize)] {
        &self.pairs
    }

    /// Correlates one frame: `channels` are the spectra of all microphones. A channel that is silent takes part in
    /// nothing: its pairs say the same of every point.
    ///
    /// # Errors
    /// [`AudioError::Shape`] where there is not one spectrum a microphone or one value a bin.
    pub fn observe(&mut self, channels: &[Vec<Complex>]) -> Result<(), AudioError> {
        self.curves.whiten(channels)?;
        let length = self.curves.length();
        for (&pair, entries) in self.pairs.iter().zip(self.entries.chunks_exact_mut(length)) {
            let curve = self.curves.correlate(pair)?;
            fill_entries(curve, self.settings.combination, self.pairs.len(), entries);
        }
        Ok(())
    }

    /// The score of one point that is worked on nowhere else; for many points see [`Self::score_points`].
    pub fn score(&mut self, point: WorldPoint) -> f32 {
        let mut score = [0.0];
        let coordinates = point.0.coords.map(|value| value as f32);
        self.score_points([&[coordinates.x], &[coordinates.y], &[coordinates.z]], &mut score);
        score[0]
    }

    /// Scores points given by their coordinates in metres, x, y and z; `scores` gets one value a point, what is
    /// left over of the longest of the four slices is not touched. A point that is not finite has the score of some
    /// delay or other: set such points aside.
    pub fn score_points(&mut self, points: [&[f32]; 3], scores: &mut [f32]) {
        let length = self.curves.length();
        let [x, y, z] = points;
        let blocks = x.chunks(LANES).zip(y.chunks(LANES)).zip(z.chunks(LANES));
        for (((x, y), z), scores) in blocks.zip(scores.chunks_mut(LANES)) {
            lookup::distances([x, y, z], &self.positions, &mut self.distances);
            scores.fill(0.0);
            for (&(i, j), entries) in self.pairs.iter().zip(self.entries.chunks_exact(length)) {
                lookup::add_differences(
                    &self.distances[i],
                    &self.distances[j],
                    self.scale,
                    entries,
                    scores,
                );
            }
        }
    }

    /// The log-likelihood that a score stands for, up to a constant: of products the score itself, of sums one that is
    /// as sharp, `pairs ln(max(score, 0.02))`.
    pub fn log_likelihood(&self, score: f32) -> f32 {
        match self.settings.combination {
            Combination::Product { .. } => score,
            Combination::Sum => self.pairs.len() as f32 * lookup::ln(score.max(LEAST_SUM)),
        }
    }

    /// The delays of fixed points, for [`Self::score_table`].
    pub fn table(&self, points: &[WorldPoint]) -> DelayTable {
        DelayTable::new(
            points,
            &self.positions,
            &self.pairs,
            self.scale,
            self.curves.length(),
        )
    }

    /// Scores the points of a table made by [`Self::table`]; `scores` is overwritten with one value a point.
    ///
    /// # Errors
    /// [`AudioError::Shape`] where the table is of another array.
    pub fn score_table(&self, table: &DelayTable, scores: &mut Vec<f32>) -> Result<(), AudioError> {
        table.score(&self.entries, self.pairs.len(), self.curves.length(), scores)
    }
}

/// Turns the correlation of a pair into scores; a pair that heard nothing says nothing.
fn fill_entries(curve: &[f32], combination: Combination, pairs: usize, entries: &mut [Entry]) {
    let highest = curve.iter().copied().fold(0.0, f32::max);
    match combination {
        Combination::Product { floor, exponent } if highest > 0.0 => {
            let scale = 1.0 / highest;
            for (entry, value) in entries.iter_mut().zip(curve) {
                entry.value = exponent * lookup::ln((value * scale).max(floor));
            }
        }
        Combination::Product { .. } => entries.iter_mut().for_each(|entry| entry.value = 0.0),
        Combination::Sum => {
            let scale = 1.0 / pairs as f32;
            for (entry, value) in entries.iter_mut().zip(curve) {
                entry.value = scale * value;
            }
        }
    }
    for k in 0..entries.len() {
        let next = entries.get(k + 1).map_or(entries[k].value, |entry| entry.value);
        entries[k].step = next - entries[k].value;
    }
}

#[cfg(test)]
mod tests;
