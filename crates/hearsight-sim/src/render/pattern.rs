//! What a painted surface looks like at a place: every pattern, as a function of metres.

use super::hash::{cell, smooth, unit};
use crate::world::{Colour, Material, Pattern};

/// Smallest size of a repetition, metres; smaller ones would only flicker.
const SMALLEST_M: f32 = 0.005;
/// Clouds are noise of so many sizes, each half as large as the one before.
const OCTAVES: i32 = 3;

/// The colour at `across` and `up` (metres on the surface), where a pixel covers `pixel_m` metres: details smaller than
/// that fade to their mean.
pub(super) fn paint(material: &Material, across: f32, up: f32, pixel_m: f32) -> Colour {
    let Material {
        colour,
        second,
        pattern,
        scale_m,
        seed,
    } = *material;
    let size = if scale_m.is_finite() {
        scale_m.max(SMALLEST_M)
    } else {
        1.0
    };
    let (x, y) = (across / size, up / size);
    let sharp = (1.5 - 2.0 * pixel_m / size).clamp(0.0, 1.0);
    let share = |exact: f32, mean: f32| mean + sharp * (exact - mean);
    let odd = |number: f32| {
        if (number.floor() as i64) & 1 == 0 {
            0.0
        } else {
            1.0
        }
    };
    match pattern {
        Pattern::Plain => colour,
        Pattern::Stripes => blend(colour, second, share(odd(2.0 * x), 0.5)),
        Pattern::Squares => blend(colour, second, share((odd(2.0 * x) - odd(2.0 * y)).abs(), 0.5)),
        Pattern::Clouds => {
            let sum: f32 = (0..OCTAVES)
                .map(|octave| {
                    let finer = f32::from(1_u8 << octave);
                    smooth(seed.wrapping_add(octave as u64), 2.0 * x * finer, 2.0 * y * finer) / finer
                })
                .sum();
            blend(colour, second, share(1.6 * sum / 1.75 - 0.3, 0.5).clamp(0.0, 1.0))
        }
        Pattern::Planks => {
            let row = y.floor();
            let line = if y - row < 0.08 { 1.0 } else { 0.0 };
            let tone = 0.9 + 0.2 * unit(cell(seed, 0, row as i64), 0);
            blend(colour.map(|channel| channel * tone), second, share(line, 0.08))
        }
        Pattern::Clutter => things(material, x, y, sharp),
    }
}

/// Small things on a shelf or a board: in every cell a thing with its own shape, size and colour, perhaps none.
fn things(material: &Material, x: f32, y: f32, sharp: f32) -> Colour {
    let (column, row) = (x.floor(), y.floor());
    let number = cell(material.seed, column as i64, row as i64);
    let other = cell(!material.seed, column as i64, row as i64);
    let ground = material.colour;
    if unit(number, 0) < 0.25 {
        return ground;
    }
    let (half_width, half_height) = (0.2 + 0.28 * unit(number, 1), 0.2 + 0.28 * unit(number, 2));
    let (dx, dy) = ((x - column - 0.5) / half_width, (y - row - 0.5) / half_height);
    let round = unit(number, 3) < 0.3;
    let inside = if round {
        dx * dx + dy * dy < 1.0
    } else {
        dx.abs().max(dy.abs()) < 1.0
    };
    let own = match (other & 7) as u8 {
        0 | 1 => material.second,
        // As skin: red over green over blue, from pale to brown.
        2 => [0.62, 0.36, 0.24].map(|channel: f32| channel * (0.5 + unit(other, 1))),
        _ => [1, 2, 3].map(|which| 0.05 + 0.6 * unit(other, which) * unit(other, which)),
    };
    let shade = 0.8 + 0.3 * (0.5 - 0.5 * dy.clamp(-1.0, 1.0));
    let thing = if inside {
        own.map(|channel| channel * shade)
    } else {
        ground
    };
    blend(blend(ground, own, 0.4), thing, sharp)
}

/// From one colour to another.
#[inline(always)]
pub(super) fn blend(from: Colour, to: Colour, share: f32) -> Colour {
    [0, 1, 2].map(|channel| from[channel] + share * (to[channel] - from[channel]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pattern_draws_and_only_the_plain_one_is_plain() {
        use Pattern::*;
        for pattern in [Plain, Stripes, Squares, Clouds, Planks, Clutter] {
            let material = Material {
                colour: [0.8, 0.7, 0.6],
                second: [0.1, 0.2, 0.3],
                pattern,
                scale_m: 0.2,
                seed: 3,
            };
            let colours: Vec<Colour> = (0..400)
                .map(|place| {
                    paint(
                        &material,
                        (place % 20) as f32 * 0.031,
                        (place / 20) as f32 * 0.029,
                        0.001,
                    )
                })
                .collect();
            assert!(
                colours
                    .iter()
                    .flatten()
                    .all(|channel| (0.0..=1.0).contains(channel)),
                "{pattern:?}"
            );
            let varied = colours.iter().any(|colour| *colour != colours[0]);
            assert_eq!(varied, pattern != Plain, "{pattern:?}");
            let far = paint(&material, 1.0, 1.0, 1.0);
            assert_eq!(
                paint(&material, 1.11, 1.0, 1.0),
                far,
                "{pattern:?} is even from afar"
            );
        }
    }

    #[test]
    fn senseless_sizes_still_give_colours() {
        for scale_m in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let material = Material {
                colour: [0.5; 3],
                second: [0.1; 3],
                pattern: Pattern::Clutter,
                scale_m,
                seed: 0,
            };
            assert!(
                paint(&material, 1e6, -1e6, 0.0)
                    .iter()
                    .all(|channel| channel.is_finite())
            );
        }
    }
}
