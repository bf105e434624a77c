//! From light to the codes of a picture: exposure, white balance, noise, gamma, 4:2:0.

use super::hash::mix;
use super::{Range, SensorNoise};
use hearsight_core::yuv::Primaries;
use multiversion::multiversion;

/// Entries of the tables over the square root of light.
const STEPS: usize = 1024;
/// Entries of the table of normal deviates.
const DEVIATES: usize = 1024;
/// Pixels that are developed together.
const BLOCK: usize = 64;

/// Tables that a sensor needs.
#[derive(Clone, Debug)]
pub(super) struct Developer {
    noise: Option<SensorNoise>,
    /// Code (0 to 255, full range, with the gamma of sRGB) and deviation of a code, by the root of light.
    codes: Vec<[f32; 2]>,
    deviates: Vec<f32>,
}

/// How a picture is developed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Development {
    pub(super) gains: [f32; 3],
    pub(super) range: Range,
    /// What tells this picture's noise from others'.
    pub(super) seed: u64,
    pub(super) width: usize,
}

impl Developer {
    pub(super) fn new() -> Self {
        let deviate = |index: usize| normal_quantile((index as f64 + 0.5) / DEVIATES as f64) as f32;
        Self {
            noise: None,
            codes: Vec::new(),
            deviates: (0..DEVIATES).map(deviate).collect(),
        }
    }

    /// Makes the tables fit a sensor.
    pub(super) fn set(&mut self, noise: SensorNoise) {
        if self.noise == Some(noise) {
            return;
        }
        let sound = |value: f64| {
            if value.is_finite() {
                value.clamp(0.0, 10.0)
            } else {
                0.0
            }
        };
        let (dark, shot) = (sound(noise.dark), sound(noise.shot));
        self.codes.clear();
        self.codes.extend((0..STEPS).map(|step| {
            let light = (step as f64 / (STEPS - 1) as f64).powi(2);
            // IEC 61966-2-1 and its slope.
            let (code, slope) = if light <= 0.003_130_8 {
                (12.92 * light, 12.92)
            } else {
                (
                    1.055 * light.powf(1.0 / 2.4) - 0.055,
                    1.055 / 2.4 * light.powf(1.0 / 2.4 - 1.0),
                )
            };
            let deviation = (dark * dark + shot * light).sqrt() * slope;
            [(255.0 * code) as f32, (255.0 * deviation) as f32]
        }));
        self.noise = Some(noise);
    }

    /// Develops rows that begin at an even row `first`; `light` is one value a pixel, `luma` and both chroma planes are
    /// the rows' codes.
    pub(super) fn develop(
        &self,
        how: &Development,
        first: usize,
        light: &[[f32; 3]],
        luma: &mut [u8],
        chroma: [&mut [u8]; 2],
    ) {
        let width = how.width;
        let columns = width.div_ceil(2);
        let [red, green, blue] = Primaries::Bt601.weights().map(|weight| weight as f32);
        let (black, luma_gain, chroma_gain) = match how.range {
            Range::Full => (0.0, 1.0, 1.0),
            Range::Limited => (16.0, 219.0 / 255.0, 224.0 / 255.0),
        };
        let [blues, reds] = chroma;
        let gains = std::array::from_fn(|at| how.gains[at % 3]);
        let mut entries = [0; 3 * BLOCK];
        let byte = |value: f32| (value + 0.5).clamp(0.0, 255.0) as i32 as u8;
        let rows = light.chunks(2 * width).zip(luma.chunks_mut(2 * width));
        let planes = blues.chunks_mut(columns).zip(reds.chunks_mut(columns));
        for (pair, ((light, luma), (blues, reds))) in rows.zip(planes).enumerate() {
            let high = light.len() / width;
            for left in (0..width).step_by(BLOCK) {
                let wide = BLOCK.min(width - left);
                // Blue and red less luma, summed over rows.
                let mut differences = [[0.0_f32; BLOCK]; 2];
                for row in 0..high {
                    let place = row * width + left;
                    let seed = mix(how.seed ^ ((first + 2 * pair + row) * width + left) as u64);
                    look_up(light[place..place + wide].as_flattened(), &gains, &mut entries);
                    for x in 0..wide {
                        let [r, g, b] =
                            self.noisy([3 * x, 3 * x + 1, 3 * x + 2].map(|at| entries[at]), seed, x);
                        let y = red * r + green * g + blue * b;
                        luma[place + x] = byte(black + luma_gain * y);
                        differences[0][x] += b - y;
                        differences[1][x] += r - y;
                    }
                }
                for x in (0..wide).step_by(2) {
                    let across = 2.min(wide - x);
                    let share = chroma_gain / (across * high) as f32;
                    let sum = |which: usize| -> f32 { differences[which][x..x + across].iter().sum() };
                    blues[(left + x) / 2] = byte(128.0 + share * sum(0) / (2.0 * (1.0 - blue)));
                    reds[(left + x) / 2] = byte(128.0 + share * sum(1) / (2.0 * (1.0 - red)));
                }
            }
        }
    }

    /// Red, green and blue of a pixel, with noise; `x` is its place in the block with this seed.
    #[inline(always)]
    fn noisy(&self, entries: [u16; 3], seed: u64, x: usize) -> [f32; 3] {
        // 60 bits serve two pixels.
        let bits = mix(seed.wrapping_add(x as u64 / 2)) >> (30 * (x & 1));
        [0, 1, 2].map(|channel| {
            let [code, deviation] = self.codes[usize::from(entries[channel]) & (STEPS - 1)];
            let deviate = self.deviates[(bits >> (10 * channel)) as usize & (DEVIATES - 1)];
            (code + deviation * deviate).clamp(0.0, 255.0)
        })
    }
}

/// Entries of the table of codes for the light of pixels.
#[multiversion(targets("x86_64+avx2"))]
fn look_up(light: &[f32], gains: &[f32; 3 * BLOCK], entries: &mut [u16; 3 * BLOCK]) {
    for ((entry, light), gain) in entries.iter_mut().zip(light).zip(gains) {
        // A number that is none stays one here and becomes 0 as a whole number.
        let value = (light * gain).clamp(0.0, 1.0);
        *entry = (value.sqrt() * (STEPS - 1) as f32 + 0.5) as i32 as u16;
    }
}

/// The inverse of the normal distribution function (Acklam's rational approximation, relative error below 1.2e-9).
fn normal_quantile(p: f64) -> f64 {
    const A: [f64; 6] = [
        -3.969_683_028_665_376e1,
        2.209_460_984_245_205e2,
        -2.759_285_104_469_687e2,
        1.383_577_518_672_69e2,
        -3.066_479_806_614_716e1,
        2.506_628_277_459_239,
    ];
    const B: [f64; 5] = [
        -5.447_609_879_822_406e1,
        1.615_858_368_580_409e2,
        -1.556_989_798_598_866e2,
        6.680_131_188_771_972e1,
        -1.328_068_155_288_572e1,
    ];
    const C: [f64; 6] = [
        -7.784_894_002_430_293e-3,
        -3.223_964_580_411_365e-1,
        -2.400_758_277_161_838,
        -2.549_732_539_343_734,
        4.374_664_141_464_968,
        2.938_163_982_698_783,
    ];
    const D: [f64; 4] = [
        7.784_695_709_041_462e-3,
        3.224_671_290_700_398e-1,
        2.445_134_137_142_996,
        3.754_408_661_907_416,
    ];
    let horner = |numbers: &[f64], x: f64| numbers.iter().fold(0.0, |sum, number| sum * x + number);
    let tail = |p: f64| {
        let q = (-2.0 * p.ln()).sqrt();
        horner(&C, q) / (horner(&D, q) * q + 1.0)
    };
    if p < 0.02425 {
        tail(p)
    } else if p > 1.0 - 0.02425 {
        -tail(1.0 - p)
    } else {
        let q = p - 0.5;
        horner(&A, q * q) * q / (horner(&B, q * q) * q * q + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn developed(light: f32, gain: f32, noise: SensorNoise, range: Range) -> (Vec<u8>, Vec<u8>) {
        let mut developer = Developer::new();
        developer.set(noise);
        let how = Development {
            gains: [gain; 3],
            range,
            seed: 5,
            width: 101,
        };
        let (mut luma, mut blues, mut reds) = (vec![0; 101 * 51], vec![0; 51 * 26], vec![0; 51 * 26]);
        developer.develop(
            &how,
            0,
            &vec![[light; 3]; 101 * 51],
            &mut luma,
            [&mut blues, &mut reds],
        );
        assert_eq!(blues.len(), reds.len());
        (luma, blues)
    }

    #[test]
    fn deviates_are_normal() {
        let developer = Developer::new();
        let moment = |power: i32| {
            developer
                .deviates
                .iter()
                .map(|d| f64::from(*d).powi(power))
                .sum::<f64>()
                / DEVIATES as f64
        };
        assert!(moment(1).abs() < 1e-6 && (moment(2) - 1.0).abs() < 2e-3 && (moment(4) - 3.0).abs() < 0.05);
    }

    #[test]
    fn exposure_scales_light() {
        let silent = SensorNoise { dark: 0.0, shot: 0.0 };
        for range in [Range::Full, Range::Limited] {
            let (twice, chroma) = developed(0.2, 2.0, silent, range);
            assert_eq!(twice, developed(0.4, 1.0, silent, range).0);
            assert!(chroma.iter().all(|code| *code == 128));
            let (black, white) = if range == Range::Full { (0, 255) } else { (16, 235) };
            assert!(
                developed(0.0, 1.0, silent, range)
                    .0
                    .iter()
                    .all(|code| *code == black)
            );
            assert!(
                developed(3.0, 1.0, silent, range)
                    .0
                    .iter()
                    .all(|code| *code == white)
            );
        }
        // A quarter of full scale is 0.537 of the largest code in sRGB.
        assert_eq!(developed(0.25, 1.0, silent, Range::Full).0[0], 137);
        assert!(
            developed(f32::NAN, 1.0, silent, Range::Full)
                .0
                .iter()
                .all(|code| *code == 0)
        );
    }

    #[test]
    fn noise_has_the_deviation_that_is_said_and_depends_on_light() {
        let deviation = |light: f32| {
            let noise = SensorNoise {
                dark: 0.005,
                shot: 1e-3,
            };
            let (luma, _) = developed(light, 1.0, noise, Range::Full);
            let mean = luma.iter().map(|code| f64::from(*code)).sum::<f64>() / luma.len() as f64;
            let square = luma
                .iter()
                .map(|code| (f64::from(*code) - mean).powi(2))
                .sum::<f64>()
                / luma.len() as f64;
            (square - 1.0 / 12.0).max(0.0).sqrt()
        };
        for light in [0.05_f64, 0.2, 0.5] {
            let slope = 255.0 * 1.055 / 2.4 * light.powf(1.0 / 2.4 - 1.0);
            // Luma averages three channels with their own noise.
            let luma = (0.299_f64.powi(2) + 0.587_f64.powi(2) + 0.114_f64.powi(2)).sqrt();
            let expected = (0.005_f64.powi(2) + 1e-3 * light).sqrt() * slope * luma;
            let found = deviation(light as f32);
            assert!(
                (found / expected - 1.0).abs() < 0.06,
                "{light}: {found} is not {expected}"
            );
        }
    }
}
