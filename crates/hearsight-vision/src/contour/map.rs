//! Scores of outlines by look-ups: equation 10 at every place where a hypothesis asks, found once for all hypotheses.
//!
//! Heads of one shape have the same normals whatever their size and place, so that a line is a place and one of few
//! directions. For each direction the map holds the logarithm of equation 10 of the line through each pixel's centre, in
//! tiles that are made when somebody first asks for one; a hypothesis reads one value a line, between the pixels. Against
//! [`ContourScorer`], which looks along each line of each ellipse, three things are approximate: between the pixels the
//! logarithm is interpolated, not found anew; edges are sought in the strength interpolated, not its square; and the
//! Gaussian of a distance is its Taylor polynomial around the nearest whole pixel (within 0.002).

mod tile;

use super::gradient::GradientPicture;
use super::likelihood::{ContourScorer, LineLikelihood};
use crate::VisionError;
use hearsight_core::Rectangle;
use serde::{Deserialize, Serialize};
use tile::{Direction, Rule, SMOOTH_PX, TILE, VALUES, Values, Work, kernel};

/// How outlines of heads are scored.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OutlineOptions {
    /// The model of one line.
    pub line: LineLikelihood,
    /// Lines of each outline, 4 to 256, default 16.
    pub lines: usize,
    /// Least strength of an edge, grey levels a pixel, 0.001 to 1000, default 8.
    pub least_strength: f32,
    /// Height over width of the ellipses that are read from the map, 0.1 to 10, default 1.2. Others are scored line by
    /// line.
    pub aspect: f32,
}

impl Default for OutlineOptions {
    fn default() -> Self {
        Self {
            line: LineLikelihood::default(),
            lines: 16,
            least_strength: 8.0,
            aspect: 1.2,
        }
    }
}

/// Pixels from tile to tile.
const PITCH: [usize; 2] = [TILE[0] - 1, TILE[1] - 1];
/// A tile that nobody has asked for.
const UNKNOWN: u32 = u32::MAX;
/// The tile of all places where no edge is near.
const NOTHING: u32 = 0;
/// Tiles for which there is memory from the start, at most.
const RESERVED: usize = 1 << 14;
/// Largest relative difference of an ellipse's aspect from that of the map.
const SAME_ASPECT: f32 = 1e-3;

/// A line of an outline: where it crosses an ellipse of half axes 1, and which direction it has.
#[derive(Clone, Copy, Debug)]
struct Line {
    cosine: f32,
    sine: f32,
    direction: usize,
}

/// Scores ellipses of one picture after another; owns its buffers.
#[derive(Clone, Debug)]
pub struct OutlineMap {
    options: OutlineOptions,
    exact: ContourScorer,
    rule: Rule,
    lines: Vec<Line>,
    directions: Vec<Direction>,
    /// Tiles across and down.
    grid: [usize; 2],
    /// Of each direction and tile, which of the tiles it is.
    places: Vec<u32>,
    /// Which places are known.
    known: Vec<usize>,
    tiles: Vec<Values>,
    work: Work,
}

impl OutlineMap {
    /// A map.
    ///
    /// # Errors
    /// [`VisionError::Parameter`] where an option is outside its range.
    pub fn new(options: OutlineOptions) -> Result<Self, VisionError> {
        let exact = ContourScorer::new(options.line, options.lines, options.least_strength)?;
        VisionError::within("aspect", options.aspect.into(), 0.1, 10.0, "0.1 to 10")?;
        let count = options.lines;
        // Opposite lines are one.
        let distinct = if count.is_multiple_of(2) { count / 2 } else { count };
        let angle = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
        let lines = (0..count)
            .map(|k| Line {
                cosine: angle(k).cos() as f32,
                sine: angle(k).sin() as f32,
                direction: k % distinct,
            })
            .collect();
        let reach = exact.reach();
        let directions = (0..distinct)
            .map(|k| {
                let [along, down] = [f64::from(options.aspect) * angle(k).cos(), angle(k).sin()];
                let length = along.hypot(down);
                Direction::new([along / length, down / length], reach)
            })
            .collect();
        Ok(Self {
            options,
            exact,
            rule: Rule {
                reach,
                kernel: kernel(options.line.deviation_px, reach),
                least: options.least_strength,
                gain: options.line.gain(),
            },
            lines,
            directions,
            grid: [0; 2],
            places: Vec::new(),
            known: Vec::new(),
            tiles: Vec::new(),
            work: Work::default(),
        })
    }

    /// Forgets the picture before; to be called for each new picture, before its ellipses are scored.
    pub fn begin(&mut self, gradients: &GradientPicture) {
        let (width, height) = gradients.size();
        let tiles = |size: usize, pitch: usize| (size + 2 * self.margin()).div_ceil(pitch);
        let grid = [tiles(width, PITCH[0]), tiles(height, PITCH[1])];
        self.tiles.clear();
        self.tiles.push([0.0; VALUES]);
        if grid == self.grid {
            for place in self.known.drain(..) {
                self.places[place] = UNKNOWN;
            }
            return;
        }
        self.grid = grid;
        let count = self.directions.len() * grid[0] * grid[1];
        self.places.clear();
        self.places.resize(count, UNKNOWN);
        self.known.clear();
        self.known.reserve(count.min(RESERVED));
        self.tiles.reserve(count.min(RESERVED));
    }

    /// Pixels around the picture that have values as well: lines whose middle is outside may reach into it.
    fn margin(&self) -> usize {
        self.rule.reach + 2
    }

    /// Writes the mean over the lines of the logarithm of equation 10 on the outline into `scores`, as
    /// [`ContourScorer::score`] does.
    pub fn score(&mut self, gradients: &GradientPicture, ellipses: &[Rectangle], scores: &mut [f32]) {
        let smooth = self.options.line.deviation_px >= SMOOTH_PX;
        for (score, bounds) in scores.iter_mut().zip(ellipses) {
            let alike =
                (bounds.height - self.options.aspect * bounds.width).abs() <= SAME_ASPECT * bounds.height;
            *score = if bounds.is_finite() && alike && smooth {
                self.look_up(gradients, bounds)
            } else {
                self.exact.score_one(gradients, bounds)
            };
        }
    }

    fn look_up(&mut self, gradients: &GradientPicture, bounds: &Rectangle) -> f32 {
        let (x, y) = bounds.centre();
        // Places count from the picture's corner, values from the centre of the first pixel of the margin.
        let shift = self.margin() as f32 - 0.5;
        let (x, y) = (x + shift, y + shift);
        let (across, down) = (0.5 * bounds.width, 0.5 * bounds.height);
        let [columns, rows] = self.grid;
        let (right, bottom) = ((columns * PITCH[0]) as f32, (rows * PITCH[1]) as f32);
        let mut sum = 0.0;
        for number in 0..self.lines.len() {
            let line = self.lines[number];
            let (x, y) = (x + across * line.cosine, y + down * line.sine);
            if !(x >= 0.0 && y >= 0.0 && x < right && y < bottom) {
                continue;
            }
            let (column, row) = (x as u32 as usize, y as u32 as usize);
            let (part_x, part_y) = (x - column as f32, y - row as f32);
            let (tile_x, tile_y) = (column / PITCH[0], row / PITCH[1]);
            let place = (line.direction * rows + tile_y) * columns + tile_x;
            let mut slot = self.places[place];
            if slot == UNKNOWN {
                slot = self.make(gradients, line.direction, [tile_x, tile_y]);
                self.places[place] = slot;
                self.known.push(place);
            }
            let at = (row - tile_y * PITCH[1]) * TILE[0] + (column - tile_x * PITCH[0]);
            let tile = &self.tiles[slot as usize];
            let (upper, lower) = (&tile[at..at + 2], &tile[at + TILE[0]..at + TILE[0] + 2]);
            let above = upper[0] + part_x * (upper[1] - upper[0]);
            let below = lower[0] + part_x * (lower[1] - lower[0]);
            sum += above + part_y * (below - above);
        }
        sum / self.lines.len() as f32
    }

    /// Makes a tile of one direction; returns its number.
    fn make(&mut self, gradients: &GradientPicture, direction: usize, [tile_x, tile_y]: [usize; 2]) -> u32 {
        let margin = self.margin() as i32;
        let corner = [
            (tile_x * PITCH[0]) as i32 - margin,
            (tile_y * PITCH[1]) as i32 - margin,
        ];
        let direction = &self.directions[direction];
        let Some(tile) = self.work.make(gradients, direction, &self.rule, corner) else {
            return NOTHING;
        };
        self.tiles.push(tile);
        (self.tiles.len() - 1) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight_core::RgbView;

    const SIZE: [usize; 2] = [160, 120];

    /// A head with a soft edge before a wall with noise and a striped board.
    fn gradients() -> GradientPicture {
        let mut state = 7_u32;
        let data: Vec<u8> = (0..SIZE[0] * SIZE[1])
            .flat_map(|i| {
                let (x, y) = (i % SIZE[0], i / SIZE[0]);
                let (u, v) = ((x as f32 - 59.3) / 18.0, (y as f32 - 47.8) / 21.6);
                let inside = ((1.0 - (u * u + v * v).sqrt()) * 9.0 + 0.5).clamp(0.0, 1.0);
                let board = if x > 100 && y / 7 % 2 == 0 { 60.0 } else { 0.0 };
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let noise = (state >> 24) as f32 / 16.0;
                [70.0 + 110.0 * inside + board, 80.0 + 50.0 * inside, 90.0].map(|value| (value + noise) as u8)
            })
            .collect();
        let mut gradients = GradientPicture::default();
        gradients.compute(RgbView::new(SIZE[0], SIZE[1], &data).unwrap());
        gradients
    }

    fn head(x: f32, y: f32, half: f32) -> Rectangle {
        Rectangle::from_centre(x, y, 2.0 * half / 1.2, 2.0 * half)
    }

    #[test]
    fn look_ups_say_what_looking_along_each_line_says() {
        let gradients = gradients();
        for lines in [16, 15, 24] {
            let options = OutlineOptions {
                lines,
                ..OutlineOptions::default()
            };
            let mut map = OutlineMap::new(options).unwrap();
            map.begin(&gradients);
            let exact = ContourScorer::new(options.line, lines, options.least_strength).unwrap();
            // All over the picture and beyond its edges, in many sizes.
            let ellipses: Vec<Rectangle> = (0..600_u16)
                .map(|k| {
                    let k = f32::from(k);
                    head(
                        (7.31 * k) % 190.0 - 15.0,
                        (3.77 * k) % 150.0 - 15.0,
                        6.0 + (0.37 * k) % 25.0,
                    )
                })
                .chain((0..200_u16).map(|k| {
                    let k = f32::from(k);
                    head(
                        56.0 + (1.31 * k) % 8.0,
                        44.0 + (0.77 * k) % 8.0,
                        18.0 + (0.19 * k) % 7.0,
                    )
                }))
                .collect();
            let (mut fast, mut slow) = (vec![0.0; ellipses.len()], vec![0.0; ellipses.len()]);
            map.score(&gradients, &ellipses, &mut fast);
            exact.score(&gradients, &ellipses, &mut slow);
            let count = ellipses.len() as f32;
            let mean = |values: &[f32]| values.iter().sum::<f32>() / count;
            let (fast_mean, slow_mean) = (mean(&fast), mean(&slow));
            let (mut both, mut own, mut apart) = (0.0, [0.0; 2], 0.0_f32);
            for (a, b) in fast.iter().zip(&slow) {
                both += (a - fast_mean) * (b - slow_mean);
                own[0] += (a - fast_mean).powi(2);
                own[1] += (b - slow_mean).powi(2);
                apart = apart.max((a - b).abs());
            }
            let correlation = both / (own[0] * own[1]).sqrt();
            assert!(
                correlation > 0.98 && (fast_mean - slow_mean).abs() < 0.05 && apart < 0.6,
                "{lines}: {correlation} {fast_mean} {slow_mean} {apart}"
            );
            // The best of all is the same but for a pixel.
            let best = |scores: &[f32]| {
                (0..scores.len())
                    .max_by(|a, b| scores[*a].total_cmp(&scores[*b]))
                    .unwrap()
            };
            let (a, b) = (ellipses[best(&fast)].centre(), ellipses[best(&slow)].centre());
            assert!((a.0 - b.0).abs() < 1.5 && (a.1 - b.1).abs() < 1.5, "{a:?} {b:?}");
        }
    }

    #[test]
    fn neighbours_at_a_head_differ_as_they_do_when_each_line_is_looked_along() {
        let gradients = gradients();
        let options = OutlineOptions::default();
        let mut map = OutlineMap::new(options).unwrap();
        map.begin(&gradients);
        let exact = ContourScorer::new(options.line, options.lines, options.least_strength).unwrap();
        // Half a pixel aside, down, and larger: what a filter with some pixels of spread tells apart.
        let ellipses: Vec<Rectangle> = (0..300_u16)
            .flat_map(|k| {
                let k = f32::from(k);
                let (x, y, half) = (
                    57.0 + (1.31 * k) % 5.0,
                    45.5 + (0.77 * k) % 5.0,
                    20.0 + (0.19 * k) % 3.0,
                );
                [
                    head(x, y, half),
                    head(x + 0.5, y, half),
                    head(x, y + 0.5, half),
                    head(x, y, half + 0.5),
                ]
            })
            .collect();
        let (mut fast, mut slow) = (vec![0.0; ellipses.len()], vec![0.0; ellipses.len()]);
        map.score(&gradients, &ellipses, &mut fast);
        exact.score(&gradients, &ellipses, &mut slow);
        let (mut wrong, mut all) = (0.0_f32, 0.0_f32);
        for (fast, slow) in fast.chunks_exact(4).zip(slow.chunks_exact(4)) {
            for other in 1..4 {
                let differ = slow[other] - slow[0];
                wrong += (fast[other] - fast[0] - differ).powi(2);
                all += differ * differ;
            }
        }
        assert!((wrong / all).sqrt() < 0.3, "{} of {}", wrong.sqrt(), all.sqrt());
    }

    #[test]
    fn a_new_picture_is_looked_at_anew_and_the_order_of_questions_does_not_matter() {
        let (first, mut other) = (gradients(), GradientPicture::default());
        let grey = vec![90_u8; SIZE[0] * SIZE[1] * 3];
        other.compute(RgbView::new(SIZE[0], SIZE[1], &grey).unwrap());
        let mut ellipses: Vec<Rectangle> = (0..50_u16)
            .map(|k| head(20.0 + 2.3 * f32::from(k), 40.0 + f32::from(k), 14.0))
            .collect();
        let mut map = OutlineMap::new(OutlineOptions::default()).unwrap();
        map.begin(&first);
        let mut scores = vec![0.0; 50];
        map.score(&first, &ellipses, &mut scores);
        assert!(scores.iter().any(|score| *score > 1.0));
        let mut again = vec![0.0; 50];
        map.begin(&other);
        map.score(&other, &ellipses, &mut again);
        assert!(again.iter().all(|score| *score == 0.0));
        map.begin(&first);
        ellipses.reverse();
        map.score(&first, &ellipses, &mut again);
        again.reverse();
        assert_eq!(scores, again);
    }

    #[test]
    fn other_shapes_are_scored_line_by_line() {
        let gradients = gradients();
        let mut map = OutlineMap::new(OutlineOptions::default()).unwrap();
        map.begin(&gradients);
        let exact = ContourScorer::new(LineLikelihood::default(), 16, 8.0).unwrap();
        let ellipses = [
            Rectangle::from_centre(60.0, 48.0, 30.0, 60.0),
            Rectangle::from_centre(60.0, 48.0, f32::NAN, 60.0),
            Rectangle::from_centre(60.0, 48.0, 0.0, 10.0),
        ];
        let (mut fast, mut slow) = ([0.0; 3], [0.0; 3]);
        map.score(&gradients, &ellipses, &mut fast);
        exact.score(&gradients, &ellipses, &mut slow);
        assert_eq!((fast[0], fast[2]), (slow[0], slow[2]));
        assert!(fast[1].is_nan());
        for options in [
            OutlineOptions {
                aspect: 0.0,
                ..OutlineOptions::default()
            },
            OutlineOptions {
                lines: 3,
                ..OutlineOptions::default()
            },
        ] {
            assert!(OutlineMap::new(options).is_err());
        }
    }
}
