//! Octave bands: filters that part a signal into what the walls treat differently, and add up to the signal.

use super::room::{BAND_CENTRES_HZ, BANDS};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Samples on each side of the middle tap: 12 ms, enough for the lowest band's edge.
pub(crate) fn half_length(rate_hz: u32) -> usize {
    (f64::from(rate_hz) / 80.0).ceil() as usize
}

/// Share of amplitude that a band has at a frequency: cosines over the logarithm between neighbouring centres.
fn share(band: usize, frequency_hz: f64) -> f64 {
    let octaves = (frequency_hz.max(1e-3) / BAND_CENTRES_HZ[band]).log2();
    let open = (band == 0 && octaves <= 0.0) || (band == BANDS - 1 && octaves >= 0.0);
    if open {
        1.0
    } else if octaves.abs() >= 1.0 {
        0.0
    } else {
        (FRAC_PI_2 * octaves).cos().powi(2)
    }
}

/// The taps of each band, symmetric about the middle one. Their sum is one tap of 1: bands add up to the signal.
pub(crate) fn filters(rate_hz: u32) -> [Vec<f32>; BANDS] {
    let half = half_length(rate_hz);
    let steps = 8 * half;
    let mut filters: [Vec<f32>; BANDS] = std::array::from_fn(|_| vec![0.0; 2 * half + 1]);
    let mut rest = vec![0.0; 2 * half + 1];
    rest[half] = 1.0;
    for (band, filter) in filters.iter_mut().enumerate().take(BANDS - 1) {
        let shares: Vec<f64> = (0..steps)
            .map(|step| {
                share(
                    band,
                    (step as f64 + 0.5) / steps as f64 * 0.5 * f64::from(rate_hz),
                )
            })
            .collect();
        for away in 0..=half {
            let angle = PI * away as f64 / steps as f64;
            let sum: f64 = shares
                .iter()
                .enumerate()
                .map(|(step, share)| share * (angle * (step as f64 + 0.5)).cos())
                .sum();
            let window = 0.5 + 0.5 * (PI * away as f64 / (half + 1) as f64).cos();
            let tap = window * sum / steps as f64;
            for place in [half - away, half + away] {
                filter[place] = tap as f32;
            }
        }
        for (rest, tap) in rest.iter_mut().zip(filter.iter()) {
            *rest -= *tap;
        }
    }
    filters[BANDS - 1] = rest;
    filters
}

/// The real response of symmetric taps at the bins of a transform of `length` samples: length / 2 + 1 values.
pub(crate) fn response(taps: &[f32], length: usize) -> Vec<f32> {
    let half = taps.len() / 2;
    (0..=length / 2)
        .map(|bin| {
            let angle = TAU * bin as f64 / length as f64;
            // cos(n a) by recurrence: no cosine a tap.
            let (mut before, mut now, twice) = (angle.cos(), 1.0, 2.0 * angle.cos());
            let mut sum = f64::from(taps[half]);
            for tap in &taps[half + 1..] {
                (before, now) = (now, twice * now - before);
                sum += 2.0 * f64::from(*tap) * now;
            }
            sum as f32
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_band_passes_its_centre_and_little_else() {
        let rate = 16_000;
        let filters = filters(rate);
        let length = 16_000;
        let bands: Vec<Vec<f32>> = filters.iter().map(|filter| response(filter, length)).collect();
        for (band, response) in bands.iter().enumerate() {
            for (other, centre) in BAND_CENTRES_HZ.iter().enumerate() {
                let value = response[*centre as usize];
                let wanted = if band == other { 1.0 } else { 0.0 };
                // The Hann window of 25 ms blurs the edges of the lowest bands.
                assert!((value - wanted).abs() < 0.1, "band {band} at {centre}: {value}");
            }
        }
        for bin in 0..=length / 2 {
            let sum: f32 = bands.iter().map(|band| band[bin]).sum();
            assert!((sum - 1.0).abs() < 1e-5);
        }
    }
}
