//! Ghosts: places that differ from the background because someone stood there while it was learnt, and has left.
//!
//! A ghost does not move, and its outline is seen in the background, not in the picture; with a person who stands
//! still it is the other way round.

use super::{BackgroundOptions, BackgroundState};
use crate::regions::{Region, RegionFinder};
use hearsight_core::{Mask, RgbView};

/// Ghosts are looked for this often, seconds: searching every picture would find none sooner that matters.
const INTERVAL: f32 = 0.2;

/// Finds ghosts and takes them into the background, with the buffers that takes.
#[derive(Clone, Debug, Default)]
pub struct GhostFinder {
    still: Mask,
    regions: RegionFinder,
    found: Vec<Region>,
    /// Which of them are ghosts.
    ghosts: Vec<bool>,
    labels: Vec<u32>,
    /// Edges along the contour of each region: in the background, in the picture.
    edges: Vec<[u64; 2]>,
}

impl GhostFinder {
    /// Notes what has not moved, and from time to time takes ghosts into the background; returns how many.
    pub(super) fn step(
        &mut self,
        state: &mut BackgroundState,
        picture: RgbView<'_>,
        expected: &[u8],
        foreground: &Mask,
        gain: [f32; 3],
        seconds: f32,
        options: &BackgroundOptions,
    ) -> usize {
        let milliseconds = (seconds * 1000.0).round().clamp(1.0, 60_000.0) as u16;
        let needed = (options.ghost_secs * 1000.0) as u16;
        let mut any = false;
        let (settled, _) = state.settled.as_chunks_mut::<3>();
        let (pixels, _) = picture.data.as_chunks::<3>();
        for (((&on, pixel), settled), still) in foreground
            .data
            .iter()
            .zip(pixels)
            .zip(settled)
            .zip(&mut state.still_ms)
        {
            if on == 0 {
                *still = 0;
                continue;
            }
            let change = |channel: usize| pixel[channel].abs_diff(settled[channel]);
            if *still == 0 || change(0).max(change(1)).max(change(2)) > options.threshold {
                (*settled, *still) = (*pixel, milliseconds);
            } else {
                *still = still.saturating_add(milliseconds);
                any |= *still >= needed;
            }
        }
        state.since_ghosts += seconds;
        if !any || options.ghost_secs <= 0.0 || state.since_ghosts < INTERVAL {
            return 0;
        }
        state.since_ghosts = 0.0;
        self.adopt(state, picture, expected, gain, needed, options)
    }

    fn adopt(
        &mut self,
        state: &mut BackgroundState,
        picture: RgbView<'_>,
        expected: &[u8],
        gain: [f32; 3],
        needed: u16,
        options: &BackgroundOptions,
    ) -> usize {
        let (width, height) = (picture.width, picture.height);
        self.still.resize(width, height);
        for (pixel, &still) in self.still.data.iter_mut().zip(&state.still_ms) {
            *pixel = if still >= needed { 255 } else { 0 };
        }
        // All regions are found, so that labels count them all; the small ones are passed over below.
        self.found.clear();
        self.found.extend_from_slice(self.regions.find(&self.still, 1));
        let regions = &self.found;
        self.regions.write_labels(width, height, &mut self.labels);
        self.edges.clear();
        self.edges.resize(regions.len(), [0; 2]);
        for y in 1..height.saturating_sub(1) {
            for x in 1..width.saturating_sub(1) {
                let at = y * width + x;
                let label = self.labels[at];
                let neighbours = [at - 1, at + 1, at - width, at + width];
                if label == 0
                    || neighbours
                        .iter()
                        .all(|&neighbour| self.labels[neighbour] == label)
                {
                    continue;
                }
                let edges = &mut self.edges[label as usize - 1];
                edges[0] += u64::from(edge(expected, width, at));
                edges[1] += u64::from(edge(picture.data, width, at));
            }
        }
        let ghost = |label: u32| {
            let at = label as usize - 1;
            let [before, now] = self.edges[at];
            regions[at].area >= options.ghost_pixels
                && before > 0
                && before as f64 > f64::from(options.ghost_contrast) * now as f64
        };
        self.ghosts.clear();
        self.ghosts.extend((1..=regions.len() as u32).map(ghost));
        for (at, &label) in self.labels.iter().enumerate() {
            if label > 0 && self.ghosts[label as usize - 1] {
                state.adopt(at, gain);
            }
        }
        self.ghosts.iter().filter(|&&ghost| ghost).count()
    }
}

/// Strength of the edge at a pixel off the border: differences across it, all channels, both directions.
fn edge(data: &[u8], width: usize, at: usize) -> u32 {
    let difference = |a: usize, b: usize| -> u32 {
        (0..3)
            .map(|channel| u32::from(data[3 * a + channel].abs_diff(data[3 * b + channel])))
            .sum()
    };
    difference(at - 1, at + 1) + difference(at - width, at + width)
}
