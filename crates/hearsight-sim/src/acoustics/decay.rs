//! How fast sound decays: Schroeder's integration, and the absorption that gives a wanted reverberation time.
//!
//! In a box the field is not diffuse: what travels along the longest side meets walls rarely and outlives the rest, so
//! formulas for diffuse fields (Sabine, Eyring) come out 28 to 48 % long in walls. Here the decay of the image sources
//! themselves is integrated: late images fill space evenly, so that the energy that comes from direction u after r
//! metres is the product of the reflections on the way, |u_i| r / L_i of them by each pair of walls.

use super::error::AcousticsError;
use std::f64::consts::{PI, TAU};

/// Directions over an eighth of a sphere: enough for the reverberation time to 0.2 %.
const DIRECTIONS: usize = 1500;
/// Instants at which the decay is computed, evenly up to the time of -60 dB that a wall's absorption lets expect.
const INSTANTS: usize = 160;
/// How often the time over which the decay is computed may be doubled before there is none.
const LONGEST_DOUBLINGS: u32 = 10;
/// Walls that absorb more than this leave no decay to speak of.
pub(crate) const MOST_ABSORBED: f64 = 0.99;
/// Walls that absorb less than this reverberate longer than any room.
const LEAST_ABSORBED: f64 = 1e-4;

/// The reverberation time of a response: from the first instant 5 dB below the whole energy (Schroeder 1965) to the
/// first one 35 dB below it, a straight line is fitted and extended to 60 dB (ISO 3382: T30). Seconds, or `None`
/// where the response is empty, too short, or not finite.
///
/// What precedes the direct sound does not matter.
pub fn reverberation_time_s(response: &[f32], rate_hz: u32) -> Option<f64> {
    let mut left = 0.0;
    let mut decay: Vec<f64> = response
        .iter()
        .rev()
        .map(|sample| {
            left += f64::from(*sample).powi(2);
            left
        })
        .collect();
    decay.reverse();
    fit(&decay, 1.0 / f64::from(rate_hz))
}

/// The time of 60 dB from energies left at instants `step_s` apart.
fn fit(decay: &[f64], step_s: f64) -> Option<f64> {
    let whole = *decay.first()?;
    if whole <= 0.0 || !whole.is_finite() {
        return None;
    }
    let below = |db: f64| {
        decay
            .iter()
            .position(|left| *left <= whole * 10.0_f64.powf(-0.1 * db))
    };
    let (from, to) = (below(5.0)?, below(35.0)?);
    if to < from + 2 {
        return None;
    }
    let count = (to - from + 1) as f64;
    let middle = 0.5 * (from + to) as f64;
    let (mut product, mut square) = (0.0, 0.0);
    for (number, left) in decay.iter().enumerate().take(to + 1).skip(from) {
        let away = number as f64 - middle;
        product += away * 10.0 * left.log10();
        square += away * away;
    }
    debug_assert!(count >= 3.0);
    let slope_db_s = product / square / step_s;
    (slope_db_s < 0.0).then(|| -60.0 / slope_db_s)
}

/// The reverberation time that the image sources of a box have, seconds.
///
/// `reflection`: for each pair of walls across x, y and z the mean of the logarithms of both amplitude reflections.
pub(crate) fn time_of_box_s(size_m: [f64; 3], log_reflection: [f64; 3], speed_m_s: f64) -> Option<f64> {
    // Energy lost along each direction, nepers a second.
    let losses: Vec<f64> = directions()
        .map(|direction| {
            let mut loss = 0.0;
            for axis in 0..3 {
                loss -= 2.0 * speed_m_s * direction[axis] / size_m[axis] * log_reflection[axis];
            }
            loss
        })
        .collect();
    let mean = losses.iter().sum::<f64>() / losses.len() as f64;
    if !(mean > 0.0 && mean.is_finite()) {
        return None;
    }
    // Sixty decibels at the mean loss, and more for the directions that outlive it: twice as long, and in flat rooms
    // as much longer as it takes.
    (1..=LONGEST_DOUBLINGS).find_map(|doublings| {
        let step_s = f64::from(1_u32 << doublings) * 6.0 * std::f64::consts::LN_10 / mean / INSTANTS as f64;
        let mut left: Vec<f64> = losses.iter().map(|loss| 1.0 / loss).collect();
        let factors: Vec<f64> = losses.iter().map(|loss| (-loss * step_s).exp()).collect();
        let mut decay = Vec::with_capacity(INSTANTS);
        for _ in 0..INSTANTS {
            decay.push(left.iter().sum());
            for (left, factor) in left.iter_mut().zip(&factors) {
                *left *= factor;
            }
        }
        fit(&decay, step_s)
    })
}

/// The absorption (share of the energy, the same for all walls) with which a box has this reverberation time.
///
/// # Errors
/// [`AcousticsError::Unreachable`] where even walls that absorb nearly all are too few, or too far apart.
pub(crate) fn absorption(
    size_m: [f64; 3],
    wanted_s: f64,
    speed_m_s: f64,
    entry: &str,
) -> Result<f64, AcousticsError> {
    let time = |absorption: f64| {
        let log_reflection = 0.5 * (1.0 - absorption).ln();
        time_of_box_s(size_m, [log_reflection; 3], speed_m_s).unwrap_or(f64::INFINITY)
    };
    let shortest_s = time(MOST_ABSORBED);
    if wanted_s < shortest_s || wanted_s > time(LEAST_ABSORBED) {
        return Err(AcousticsError::Unreachable {
            entry: entry.to_owned(),
            wanted_s,
            shortest_s,
            most_absorbed: MOST_ABSORBED,
        });
    }
    // Time falls as absorption grows; forty halvings are beyond any need.
    let bisect = |time: &dyn Fn(f64) -> f64| {
        let (mut low, mut high) = (LEAST_ABSORBED, MOST_ABSORBED);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if time(middle) > wanted_s {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    };
    let volume: f64 = size_m.iter().product();
    let reach_m = 1.3 * wanted_s * speed_m_s;
    if 4.0 / 3.0 * PI * reach_m.powi(3) / volume > MOST_IMAGES {
        return Ok(bisect(&time));
    }
    // Where few images matter, each of them does: measure what they really have.
    let energies = Energies::new(size_m, reach_m);
    Ok(bisect(&|absorption| {
        energies
            .time_s(1.0 - absorption, speed_m_s)
            .unwrap_or_else(|| time(absorption))
    }))
}

/// Up to so many images are counted one by one; where there are more, they fill space evenly enough.
const MOST_IMAGES: f64 = 1e6;
/// Metres of distance that are counted as one.
const SHELL_M: f64 = 0.5;

/// Energies of images without absorption, by distance and number of reflections, over a few places in the room.
struct Energies {
    /// For each shell of distances and each number of reflections the sum of 1 / distance^2.
    shells: Vec<Vec<f64>>,
}

impl Energies {
    /// Sources and microphones, as shares of the sides.
    const PLACES: [[[f64; 3]; 2]; 3] = [
        [[0.22, 0.31, 0.55], [0.71, 0.64, 0.43]],
        [[0.60, 0.25, 0.52], [0.35, 0.80, 0.38]],
        [[0.81, 0.72, 0.58], [0.28, 0.17, 0.30]],
    ];

    fn new(size_m: [f64; 3], reach_m: f64) -> Self {
        let cells = size_m.map(|side| (reach_m / side).ceil() as i64 + 1);
        let orders = cells.iter().sum::<i64>() as usize + 1;
        let mut shells = vec![vec![0.0; orders]; (reach_m / SHELL_M).ceil() as usize];
        for [source, microphone] in Self::PLACES {
            // Squared distance along an axis of the image in cell c.
            let square = |axis: usize, c: i64| {
                let within = if c % 2 == 0 {
                    source[axis]
                } else {
                    1.0 - source[axis]
                };
                ((c as f64 + within - microphone[axis]) * size_m[axis]).powi(2)
            };
            for x in -cells[0]..=cells[0] {
                for y in -cells[1]..=cells[1] {
                    let across = square(0, x) + square(1, y);
                    for z in -cells[2]..=cells[2] {
                        let distance = across + square(2, z);
                        let shell = (distance.sqrt() / SHELL_M) as usize;
                        if let Some(shell) = shells.get_mut(shell) {
                            shell[(x.abs() + y.abs() + z.abs()) as usize] += 1.0 / distance;
                        }
                    }
                }
            }
        }
        Self { shells }
    }

    /// The reverberation time where each reflection leaves this share of the energy.
    fn time_s(&self, left: f64, speed_m_s: f64) -> Option<f64> {
        let mut sum = 0.0;
        let mut decay: Vec<f64> = self
            .shells
            .iter()
            .rev()
            .map(|shell| {
                // Horner's rule over the number of reflections.
                sum += shell
                    .iter()
                    .rev()
                    .fold(0.0, |value, energy| value * left + energy);
                sum
            })
            .collect();
        decay.reverse();
        // The decay begins with the direct sound, as that of a response does.
        fit(&decay, SHELL_M / speed_m_s)
    }
}

/// Directions spread evenly over the eighth of a sphere where all coordinates are positive (a spiral of equal areas).
fn directions() -> impl Iterator<Item = [f64; 3]> {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    (0..DIRECTIONS).map(move |number| {
        let z = (number as f64 + 0.5) / DIRECTIONS as f64;
        let angle = TAU * (number as f64 * golden).fract() / 4.0;
        let around = (1.0 - z * z).sqrt();
        debug_assert!(angle <= PI / 2.0);
        [around * angle.cos(), around * angle.sin(), z]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exponential_decay_has_its_time() {
        let rate = 16_000;
        let response: Vec<f32> = (0..16_000)
            .map(|sample| {
                let sign = if sample % 2 == 0 { 1.0 } else { -1.0 };
                sign * 10.0_f32.powf(-3.0 * sample as f32 / 16_000.0 / 0.4)
            })
            .collect();
        let time = reverberation_time_s(&response, rate).unwrap();
        assert!((time - 0.4).abs() < 0.002, "{time}");
        assert_eq!(reverberation_time_s(&[], rate), None);
        assert_eq!(reverberation_time_s(&[0.0; 100], rate), None);
        assert_eq!(reverberation_time_s(&[f32::NAN; 100], rate), None);
    }

    #[test]
    fn the_absorption_found_gives_the_time() {
        let size = [6.0, 5.0, 3.0];
        let found = absorption(size, 0.5, 343.0, "t60").unwrap();
        let time = time_of_box_s(size, [0.5 * (1.0 - found).ln(); 3], 343.0).unwrap();
        assert!((time - 0.5).abs() < 0.01, "{time}");
        // A diffuse field (Eyring) would need less absorption.
        let (volume, surface) = (90.0, 126.0);
        let eyring = 1.0 - (-24.0 * 10.0_f64.ln() * volume / (343.0 * surface * 0.5)).exp();
        assert!(found > 1.1 * eyring, "{found} {eyring}");
    }

    #[test]
    fn a_time_too_short_is_refused_with_the_shortest() {
        let error = absorption([20.0, 15.0, 8.0], 0.1, 343.0, "room.t60").unwrap_err();
        assert!(error.to_string().starts_with("room.t60 is 0.1 s"), "{error}");
        let AcousticsError::Unreachable { shortest_s, .. } = error else {
            panic!()
        };
        assert!(absorption([20.0, 15.0, 8.0], shortest_s * 1.01, 343.0, "room.t60").is_ok());
    }
}
