//! Exposure, shadows and highlights.

use super::{BackgroundOptions, BackgroundState};
use hearsight_core::RgbView;

/// Every so many rows and columns are looked at for the exposure.
const STEP: usize = 4;
/// Ratios are counted in steps of one in this many.
const FINENESS: usize = 256;
/// Fewer pixels than this say nothing about the exposure.
const FEWEST: u32 = 64;
/// Darker background pixels give too coarse ratios.
const DARKEST: usize = 24;

/// Median ratio of picture and background by channel, over pixels that were not foreground before. 1 where too
/// few pixels are of use. The result is within 1 / `largest` to `largest`. `counts` is memory to be used again.
pub(super) fn gain(
    picture: RgbView<'_>,
    state: &BackgroundState,
    largest: f32,
    counts: &mut Vec<[u32; 3]>,
) -> [f32; 3] {
    if largest <= 1.0 {
        return [1.0; 3];
    }
    counts.clear();
    counts.resize(FINENESS * 8 + 1, [0; 3]);
    let mut totals = [0; 3];
    let estimates = state.estimates();
    for y in (0..picture.height).step_by(STEP) {
        for x in (0..picture.width).step_by(STEP) {
            let at = y * picture.width + x;
            if state.still_ms[at] != 0 {
                continue;
            }
            for channel in 0..3 {
                let value = usize::from(picture.data[3 * at + channel]);
                let background = usize::from(estimates[3 * at + channel] >> 8);
                if background >= DARKEST && (4..252).contains(&value) {
                    let ratio = (value * FINENESS + background / 2) / background;
                    counts[ratio.min(FINENESS * 8)][channel] += 1;
                    totals[channel] += 1;
                }
            }
        }
    }
    [0, 1, 2].map(|channel| {
        let total = totals[channel];
        if total < FEWEST {
            return 1.0;
        }
        let mut below = 0;
        let median = counts.iter().position(|count| {
            below += count[channel];
            below * 2 >= total
        });
        let ratio = median.unwrap_or(FINENESS) as f32 / FINENESS as f32;
        ratio.clamp(1.0 / largest, largest)
    })
}

/// Takes the flag off pixels that have the expected colour at another brightness (Horprasert et al. 1999): with the
/// brightness a = (I E) / (E E), the colour's distance |I - a E| and a itself within bounds.
pub(super) fn clear_shadows(picture: &[u8], expected: &[u8], options: &BackgroundOptions, flags: &mut [u8]) {
    let (darkest, brightest) = (options.darkest_shadow, options.brightest_highlight);
    if darkest >= 1.0 && brightest <= 1.0 {
        return;
    }
    let farthest = options.shadow_colour * options.shadow_colour;
    let (picture, _) = picture.as_chunks::<3>();
    let (expected, _) = expected.as_chunks::<3>();
    for ((flag, pixel), expected) in flags.iter_mut().zip(picture).zip(expected) {
        if *flag == 0 {
            continue;
        }
        let (pixel, expected) = (pixel.map(f32::from), expected.map(f32::from));
        let product = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let power = product(expected, expected);
        if power <= 0.0 {
            continue;
        }
        let brightness = product(pixel, expected) / power;
        let rest = [0, 1, 2].map(|channel| pixel[channel] - brightness * expected[channel]);
        if brightness >= darkest && brightness <= brightest && product(rest, rest) <= farthest {
            *flag = 0;
        }
    }
}
