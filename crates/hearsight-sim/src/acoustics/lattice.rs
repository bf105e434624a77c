//! Image sources of a box (Allen and Berkley 1979): where they are and what is left of their sound.
//!
//! An image is a cell of the lattice that mirrors the room, c = (0, 0, 0) being the room itself. Along an axis of length
//! L, cell c holds the source at c L + x where c is even and at (c + 1) L - x where it is odd, after |c| reflections,
//! alternately by both walls. Positions are kept as offset and sign, so that one list serves all sources.

use super::random::{Generator, between, generator, mix};
use super::room::{BANDS, Shoebox};
use nalgebra::{SMatrix, SVector};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Images that mirror alike: each is at sign x source + offset, from the room's corner.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Mirror {
    /// Whether each axis is mirrored: -1 or 1.
    pub(crate) sign: [f64; 3],
    /// Offsets along x, y and z, metres, displacement included.
    pub(crate) offset_m: [Vec<f64>; 3],
    /// For each band the product of the reflections; one band where bands do not differ.
    pub(crate) gain: Vec<Vec<f32>>,
}

/// Image sources, but for the direct sound, which is in the room itself.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Lattice {
    pub(crate) mirrors: [Mirror; 8],
    /// Where bands differ, for each band the images that are heard in it alone.
    pub(crate) single: Vec<[Mirror; 8]>,
}

/// Which images to list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reach {
    /// Distance from the room's middle within which images are listed, metres.
    pub(crate) distance_m: f64,
    /// Reflections at most.
    pub(crate) order: u32,
    /// Images a metre of distance at most: where there are more, so many are drawn, and made louder accordingly.
    pub(crate) density_per_m: f64,
}

/// Shares of drawn images that are heard in each band: fewer in narrow bands, which need fewer to be dense.
const BAND_SHARES: [f64; BANDS] = [0.07, 0.08, 0.1, 0.15, 0.22, 0.38];

impl Lattice {
    pub(crate) fn new(room: &Shoebox, reach: &Reach) -> Self {
        let bands = if room.is_banded() { BANDS } else { 1 };
        let single = if room.is_banded() { BANDS } else { 0 };
        let mirrors = |bands: usize| std::array::from_fn(|number| mirror(number, bands));
        let mut lattice = Self {
            mirrors: mirrors(bands),
            single: vec![mirrors(1); single],
        };
        let size = room.settings().size_m;
        if room
            .reflection()
            .iter()
            .all(|wall| wall.iter().all(|share| *share == 0.0))
        {
            return lattice;
        }
        let volume: f64 = size.iter().product();
        // Up to here all are taken.
        let full_m = (reach.density_per_m * volume / (4.0 * PI))
            .sqrt()
            .min(reach.distance_m);
        let order_limit = i64::from(reach.order);
        let cells = size.map(|side| ((full_m / side).ceil() as i64).min(order_limit));
        // Everything that depends on one coordinate alone, once.
        let axes: [Vec<Cell>; 3] = std::array::from_fn(|axis| {
            (-cells[axis]..=cells[axis])
                .map(|c| Cell::new(room, axis, c))
                .collect()
        });
        let limit = full_m * full_m;
        for x in &axes[0] {
            for y in &axes[1] {
                let (square, order) = (x.square + y.square, x.order + y.order);
                if square > limit || order > order_limit {
                    continue;
                }
                let mut pair = [0.0; BANDS];
                for (band, pair) in pair.iter_mut().enumerate() {
                    *pair = x.gain[band] * y.gain[band];
                }
                for z in &axes[2] {
                    let order = order + z.order;
                    if square + z.square <= limit && order <= order_limit && order > 0 {
                        push(room, &mut lattice.mirrors, [x, y, z], &pair, 0..bands, 1.0);
                    }
                }
            }
        }
        if full_m < reach.distance_m {
            lattice.draw(room, reach, full_m);
        }
        lattice
    }

    /// Adds images beyond `full_m`, drawn evenly over distance and direction.
    fn draw(&mut self, room: &Shoebox, reach: &Reach, full_m: f64) {
        let size = room.settings().size_m;
        let volume: f64 = size.iter().product();
        let mut random: Generator = generator(room.settings().seed, "late images", 0);
        let count = ((reach.distance_m - full_m) * reach.density_per_m).ceil() as usize;
        for number in 0..count {
            // One in each equal step of distance: as many everywhere.
            let step = (number as f64 + between(&mut random, 0.0, 1.0)) / count as f64;
            let distance = full_m + step * (reach.distance_m - full_m);
            let (z, angle) = (between(&mut random, -1.0, 1.0), between(&mut random, 0.0, TAU));
            let around = (1.0 - z * z).sqrt();
            let direction = [around * angle.cos(), around * angle.sin(), z];
            let [x, y, z]: [Cell; 3] = std::array::from_fn(|axis| {
                Cell::new(
                    room,
                    axis,
                    (direction[axis] * distance / size[axis]).round() as i64,
                )
            });
            let order = x.order + y.order + z.order;
            if order == 0 || order > i64::from(reach.order) {
                continue;
            }
            // It stands for as many images as there are where one was drawn.
            let stands_for = 4.0 * PI * distance * distance / (volume * reach.density_per_m);
            let pair = std::array::from_fn(|band| x.gain[band] * y.gain[band]);
            let cells = [&x, &y, &z];
            if !room.is_banded() {
                push(room, &mut self.mirrors, cells, &pair, 0..1, stands_for.sqrt());
                continue;
            }
            // It is heard in one band: wide bands get as many more as they need.
            let chance = between(&mut random, 0.0, 1.0);
            let (mut chosen, mut reached) = (0, BAND_SHARES[0]);
            while chance >= reached && chosen < BANDS - 1 {
                chosen += 1;
                reached += BAND_SHARES[chosen];
            }
            let louder = (stands_for / BAND_SHARES[chosen]).sqrt();
            push(
                room,
                &mut self.single[chosen],
                cells,
                &pair,
                chosen..chosen + 1,
                louder,
            );
        }
    }

    /// Replaces the gains in bands by fewer: each image's gains become a sum of few mixtures of bands, the first of
    /// which is all bands alike. Gives the mixtures; their number is the least with which no image's gains differ by more than
    /// `tolerance` of their norm.
    ///
    /// Gains of bands fall together, if not equally; so two or three mixtures do what six bands would.
    pub(crate) fn mix_bands(&mut self, tolerance: f64) -> Vec<[f64; BANDS]> {
        let mut mixtures = vec![[1.0; BANDS]];
        if self.mirrors[0].gain.len() == 1 {
            return mixtures;
        }
        let gains = |mirror: &Mirror, image: usize| -> SVector<f64, BANDS> {
            SVector::from_fn(|band, _| f64::from(mirror.gain[band][image]))
        };
        // What is not alike in all bands, of each image as much as of the others.
        let mut products = SMatrix::<f64, BANDS, BANDS>::zeros();
        for mirror in &self.mirrors {
            for image in 0..mirror.offset_m[0].len() {
                let gains = gains(mirror, image);
                let rest = gains.add_scalar(-gains.mean()) / gains.norm().max(1e-30);
                products += rest * rest.transpose();
            }
        }
        let eigen = products.symmetric_eigen();
        let mut order: Vec<usize> = (0..BANDS).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        for axis in order.into_iter().take(BANDS - 1) {
            let worst = self.mirrors.iter().flat_map(|mirror| {
                let mixtures = &mixtures;
                (0..mirror.offset_m[0].len()).map(move |image| {
                    let gains = gains(mirror, image);
                    let mut rest = gains;
                    for mixture in mixtures {
                        let mixture = SVector::from(*mixture);
                        rest -= mixture * (mixture.dot(&gains) / mixture.norm_squared());
                    }
                    rest.norm() / gains.norm().max(1e-30)
                })
            });
            if worst.fold(0.0, f64::max) <= tolerance {
                break;
            }
            mixtures.push(eigen.eigenvectors.column(axis).into_owned().into());
        }
        for mirror in &mut self.mirrors {
            let mixed = mixtures.iter().map(|mixture| {
                let mixture = SVector::from(*mixture);
                (0..mirror.offset_m[0].len())
                    .map(|image| (mixture.dot(&gains(mirror, image)) / mixture.norm_squared()) as f32)
                    .collect()
            });
            mirror.gain = mixed.collect();
        }
        mixtures
    }

    /// How many images there are.
    pub(crate) fn len(&self) -> usize {
        let all = self.mirrors.iter().chain(self.single.iter().flatten());
        all.map(|mirror| mirror.offset_m[0].len()).sum()
    }
}

/// Appends an image with its gains in these bands.
fn push(
    room: &Shoebox,
    mirrors: &mut [Mirror; 8],
    cells: [&Cell; 3],
    pair: &[f64; BANDS],
    bands: Range<usize>,
    louder: f64,
) {
    let displacement = displacement(room, cells.map(|cell| cell.cell));
    let mirror = &mut mirrors[cells[0].odd | cells[1].odd << 1 | cells[2].odd << 2];
    for axis in 0..3 {
        mirror.offset_m[axis].push(cells[axis].offset_m + displacement[axis]);
    }
    for (gains, band) in mirror.gain.iter_mut().zip(bands) {
        gains.push((louder * pair[band] * cells[2].gain[band]) as f32);
    }
}

/// The signs of a mirror: bit a of its number says whether axis a is mirrored.
fn mirror(number: usize, bands: usize) -> Mirror {
    let sign = [0, 1, 2].map(|axis| if number >> axis & 1 == 1 { -1.0 } else { 1.0 });
    Mirror {
        sign,
        offset_m: Default::default(),
        gain: vec![Vec::new(); bands],
    }
}

/// A coordinate of a cell of the lattice, and what follows from it alone.
struct Cell {
    cell: i64,
    /// 1 where the axis is mirrored.
    odd: usize,
    offset_m: f64,
    /// Reflections.
    order: i64,
    /// Square of the distance along the axis from the room's middle to its image.
    square: f64,
    /// What the reflections leave in each band.
    gain: [f64; BANDS],
}

impl Cell {
    fn new(room: &Shoebox, axis: usize, cell: i64) -> Self {
        let side = room.settings().size_m[axis];
        let odd = cell.rem_euclid(2);
        let hits = cell.unsigned_abs() as i32;
        // The first wall met is the one on the image's side.
        let (first, second) = if cell > 0 { (1, 0) } else { (0, 1) };
        let gain = std::array::from_fn(|band| {
            let reflection = |wall: usize| room.reflection()[2 * axis + wall][band];
            reflection(first).powi((hits + 1) / 2) * reflection(second).powi(hits / 2)
        });
        Self {
            cell,
            odd: odd as usize,
            offset_m: (cell + odd) as f64 * side,
            order: i64::from(hits),
            square: (cell as f64 * side).powi(2),
            gain,
        }
    }
}

/// Where the image is instead of its place in the lattice: always the same for one cell of one room.
fn displacement(room: &Shoebox, cell: [i64; 3]) -> [f64; 3] {
    let jitter = room.settings().jitter_m;
    if jitter == 0.0 {
        return [0.0; 3];
    }
    let mut state = cell.iter().fold(mix(room.settings().seed), |state, c| {
        mix(state ^ c.cast_unsigned())
    });
    [0; 3].map(|_| {
        state = mix(state);
        jitter * ((state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::super::room::{ShoeboxSettings, Walls};
    use super::*;

    fn room(walls: Walls, jitter_m: f64) -> Shoebox {
        Shoebox::new(&ShoeboxSettings {
            jitter_m,
            ..ShoeboxSettings::new([6.0, 5.0, 3.0], walls)
        })
        .unwrap()
    }

    fn positions(lattice: &Lattice, source: [f64; 3]) -> Vec<([f64; 3], f32)> {
        let mut all = Vec::new();
        for mirror in &lattice.mirrors {
            for image in 0..mirror.offset_m[0].len() {
                let place =
                    [0, 1, 2].map(|axis| mirror.sign[axis] * source[axis] + mirror.offset_m[axis][image]);
                all.push((place, mirror.gain[0][image]));
            }
        }
        all
    }

    #[test]
    fn the_first_reflections_are_behind_the_six_walls() {
        let walls = [0.19, 0.36, 0.51, 0.64, 0.75, 0.84];
        let room = room(Walls::Absorption(walls), 0.0);
        let reach = Reach {
            distance_m: 100.0,
            order: 1,
            density_per_m: 1e9,
        };
        let found = positions(&Lattice::new(&room, &reach), [1.0, 2.0, 0.5]);
        let wanted = [
            ([-1.0, 2.0, 0.5], 0.9),
            ([11.0, 2.0, 0.5], 0.8),
            ([1.0, -2.0, 0.5], 0.7),
            ([1.0, 8.0, 0.5], 0.6),
            ([1.0, 2.0, -0.5], 0.5),
            ([1.0, 2.0, 5.5], 0.4),
        ];
        assert_eq!(found.len(), 6);
        for (place, gain) in wanted {
            let close = |other: &([f64; 3], f32)| other.0 == place && (other.1 - gain).abs() < 1e-6;
            assert!(found.iter().any(close), "{place:?} {gain} in {found:?}");
        }
    }

    #[test]
    fn there_are_as_many_as_there_must_be() {
        let room = room(Walls::T60(0.5), 0.07);
        // Of order n there are 4 n^2 + 2.
        let reach = Reach {
            distance_m: 1e4,
            order: 5,
            density_per_m: 1e9,
        };
        let wanted: usize = (1..=5).map(|n| 4 * n * n + 2).sum();
        assert_eq!(Lattice::new(&room, &reach).len(), wanted);
    }

    #[test]
    fn few_mixtures_do_what_the_bands_do() {
        let walls = Walls::BandT60([0.7, 0.65, 0.6, 0.5, 0.4, 0.35]);
        let reach = Reach {
            distance_m: 25.0,
            order: u32::MAX,
            density_per_m: f64::INFINITY,
        };
        let banded = Lattice::new(&room(walls, 0.07), &reach);
        let mut mixed = banded.clone();
        let mixtures = mixed.mix_bands(0.02);
        println!("{} mixtures", mixtures.len());
        assert!(mixtures.len() < BANDS);
        for (banded, mixed) in banded.mirrors.iter().zip(&mixed.mirrors) {
            for image in 0..banded.offset_m[0].len() {
                for band in 0..BANDS {
                    let wanted = f64::from(banded.gain[band][image]);
                    let found: f64 = mixtures
                        .iter()
                        .zip(&mixed.gain)
                        .map(|(mixture, gain)| mixture[band] * f64::from(gain[image]))
                        .sum();
                    let norm: f64 = banded
                        .gain
                        .iter()
                        .map(|gain| f64::from(gain[image]).powi(2))
                        .sum();
                    assert!((found - wanted).abs() <= 0.02 * norm.sqrt());
                }
            }
        }
        let mut plain = Lattice::new(&room(Walls::T60(0.5), 0.07), &reach);
        assert_eq!(plain.mix_bands(0.02), [[1.0; BANDS]]);
    }

    #[test]
    fn drawn_images_have_the_energy_of_all() {
        let room = room(Walls::T60(0.5), 0.07);
        let energy = |density_per_m: f64| {
            let reach = Reach {
                distance_m: 120.0,
                order: u32::MAX,
                density_per_m,
            };
            let lattice = Lattice::new(&room, &reach);
            let mut shells = [0.0; 4];
            for (place, gain) in positions(&lattice, [3.0, 2.5, 1.5]) {
                let square: f64 = place
                    .iter()
                    .zip([3.0, 2.5, 1.5])
                    .map(|(p, m)| (p - m) * (p - m))
                    .sum();
                if let Some(shell) = shells.get_mut((square.sqrt() / 30.0) as usize) {
                    *shell += f64::from(gain).powi(2) / square;
                }
            }
            (shells, lattice.len())
        };
        let ((all, many), (drawn, few)) = (energy(1e9), energy(200.0));
        assert!(few * 3 < many, "{few} of {many}");
        for (all, drawn) in all.iter().zip(drawn) {
            assert!((10.0 * (drawn / all).log10()).abs() < 0.5, "{all} {drawn}");
        }
    }
}
