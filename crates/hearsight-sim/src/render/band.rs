//! A band of rows: people are drawn into it, several times while the shutter is open, over the room.

use super::bins::{BAND_ROWS, Entry};
use super::figure::Figure;
use super::raster::Triangle;
use super::view::{OFFSETS_PX, SAMPLES, View, sample_time};

/// No triangle.
const NOTHING: u32 = u32::MAX;
/// Belongs to a person's head, in the picture of who is where.
pub(super) const HEAD: u16 = 0x8000;

/// What all bands of a picture need to know.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub(super) figures: &'a [Figure],
    /// Where in `figures` each person is.
    pub(super) people: &'a [usize],
    pub(super) view: &'a View,
    pub(super) width: usize,
    pub(super) height: usize,
    /// Columns a turn of a panorama.
    pub(super) turn: f32,
    /// How often people are drawn while the shutter is open: a multiple of the samples of the room.
    pub(super) times: usize,
}

/// Memory for a band.
#[derive(Clone, Debug, Default)]
pub(super) struct Band {
    near: Vec<f32>,
    covered: Vec<u32>,
    triangles: Vec<(Triangle, Entry)>,
    /// Columns, from and before, that the triangles are in.
    reach: (usize, usize),
    /// Sum of the samples of people and how many they are.
    sum: Vec<[f32; 4]>,
    /// Light of each pixel, people and room.
    pub(super) light: Vec<[f32; 3]>,
}

impl Band {
    /// Draws a band: its light, and who is where (0 nobody, else the person's number from 1, perhaps with [`HEAD`]).
    pub(super) fn draw(&mut self, scene: &Scene<'_>, entries: &[Entry], number: usize, identity: &mut [u16]) {
        let Scene {
            width, height, view, ..
        } = *scene;
        let first = number * BAND_ROWS;
        let rows = BAND_ROWS.min(height - first);
        let count = rows * width;
        let pixels = first * width..first * width + count;
        self.near.resize(count, 0.0);
        self.covered.resize(count, NOTHING);
        self.light.clear();
        self.light.extend_from_slice(&view.light[pixels.clone()]);
        identity.fill(0);
        self.shade_floor(scene, first, rows);
        if entries.is_empty() {
            return;
        }
        self.sum.clear();
        self.sum.resize(count, [0.0; 4]);
        for time in 0..scene.times {
            let sample = time % SAMPLES;
            self.scan(
                scene,
                entries,
                first,
                rows,
                sample_time(time, scene.times),
                OFFSETS_PX[sample],
            );
            for y in 0..rows {
                for place in y * width + self.reach.0..y * width + self.reach.1 {
                    let behind = view.nearness[pixels.start + place][sample];
                    if self.covered[place] != NOTHING && self.near[place] >= behind {
                        let colour = self.shade(scene, place);
                        let sum = &mut self.sum[place];
                        for channel in 0..3 {
                            sum[channel] += colour[channel];
                        }
                        sum[3] += 1.0;
                    }
                }
            }
        }
        let whole = scene.times as f32;
        for (light, sum) in self.light.iter_mut().zip(&self.sum) {
            if sum[3] > 0.0 {
                let rest = (whole - sum[3]) / whole;
                *light = [0, 1, 2].map(|channel| sum[channel] / whole + rest * light[channel]);
            }
        }
        self.scan(scene, entries, first, rows, 0.0, [0.0; 2]);
        for y in 0..rows {
            for place in y * width + self.reach.0..y * width + self.reach.1 {
                let covered = self.covered[place];
                if covered != NOTHING && self.near[place] >= view.nearness[pixels.start + place][0] {
                    let (_, entry) = self.triangles[covered as usize];
                    let figure = &scene.figures[scene.people[entry.person as usize]];
                    let head = figure.facets()[entry.facet as usize].head;
                    identity[place] = (entry.person as u16 + 1) | if head { HEAD } else { 0 };
                }
            }
        }
    }

    /// Darkens the floor where people's shadows are; two pixels side by side share one.
    fn shade_floor(&mut self, scene: &Scene<'_>, first: usize, rows: usize) {
        let shown = || {
            scene
                .people
                .iter()
                .map(|place| &scene.figures[*place])
                .filter(|figure| figure.drawn)
        };
        if shown().next().is_none() {
            return;
        }
        for y in 0..rows {
            let floor = &scene.view.floor[(first + y) * scene.width..][..scene.width];
            let light = &mut self.light[y * scene.width..][..scene.width];
            for (light, floor) in light.chunks_mut(2).zip(floor.chunks(2)) {
                let Some(at) = floor.iter().find(|at| !at[0].is_nan()) else {
                    continue;
                };
                let open: f32 = shown().map(|figure| figure.shadow.on(*at)).product();
                if open < 1.0 {
                    for (light, _) in light.iter_mut().zip(floor).filter(|(_, at)| !at[0].is_nan()) {
                        *light = light.map(|channel| channel * open);
                    }
                }
            }
        }
    }

    /// Finds the nearest triangle at each pixel.
    fn scan(
        &mut self,
        scene: &Scene<'_>,
        entries: &[Entry],
        first: usize,
        rows: usize,
        time: f32,
        offset: [f32; 2],
    ) {
        self.triangles.clear();
        let width = scene.width;
        let (mut left, mut right) = (width, 0);
        for entry in entries {
            let figure = &scene.figures[scene.people[entry.person as usize]];
            let facet = &figure.facets()[entry.facet as usize];
            let corners = facet.corners.map(|corner| &figure.seen[corner as usize]);
            let shift = [
                f32::from(entry.turns) * scene.turn - offset[0],
                -offset[1] - first as f32,
            ];
            let Some(triangle) = Triangle::new(corners, time, shift, facet.thin) else {
                continue;
            };
            let columns = triangle.columns(width);
            left = left.min(columns.0);
            right = right.max(columns.1);
            self.triangles.push((triangle, *entry));
        }
        self.reach = (left.min(right), right);
        for y in 0..rows {
            let row = y * width + self.reach.0..y * width + self.reach.1;
            self.near[row.clone()].fill(0.0);
            self.covered[row].fill(NOTHING);
        }
        let (near, covered) = (&mut self.near, &mut self.covered);
        for (own, (triangle, _)) in self.triangles.iter().enumerate() {
            triangle.scan((0, width as i32), (0, rows as i32), |x, y, close| {
                let place = y as usize * width + x as usize;
                if close > near[place] {
                    near[place] = close;
                    covered[place] = own as u32;
                }
            });
        }
    }

    fn shade(&self, scene: &Scene<'_>, place: usize) -> [f32; 3] {
        let (triangle, entry) = &self.triangles[self.covered[place] as usize];
        let figure = &scene.figures[scene.people[entry.person as usize]];
        let facet = &figure.facets()[entry.facet as usize];
        let (x, y) = (place % scene.width, place / scene.width);
        let (one, two) = triangle.weights(x as f32, y as f32);
        let zero = 1.0 - one - two;
        let [a, b, c] = facet.corners.map(|corner| &figure.seen[corner as usize]);
        let at = [0, 1].map(|axis| zero * a.at[axis] + one * b.at[axis] + two * c.at[axis]);
        let surface = facet.surface as usize;
        let paint = figure.textures[surface].sample(figure.levels[surface], at);
        [0, 1, 2].map(|channel| {
            paint[channel] * (zero * a.light[channel] + one * b.light[channel] + two * c.light[channel])
        })
    }
}
