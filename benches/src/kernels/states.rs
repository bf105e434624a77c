//! Work on particles.

use super::Work;
use crate::{Failure, Inputs};
use hearsight_core::Span;
use hearsight_filter::motion::{Motion, Noise, RandomWalk};
use hearsight_filter::{Particles, Resampling, generator};

const COUNT: usize = 1000;
const DIMENSIONS: usize = 6;

/// Random walk by 0.5 a root of a second in each dimension, 40 ms a step; a Gaussian likelihood over the first three;
/// systematic resampling at every step.
pub(super) fn step(_: &Inputs) -> Result<Work, Failure> {
    let mut random = generator(1, "bench", 0);
    let mut particles = Particles::new(DIMENSIONS, COUNT)?;
    particles.draw_gaussian(&[0.0; DIMENSIONS], &[1.0; DIMENSIONS], &mut random)?;
    let mut walk = RandomWalk::new();
    for dimension in 0..DIMENSIONS {
        walk = walk.with(
            dimension,
            Noise::Additive {
                sigma_per_sqrt_sec: 0.5,
            },
        )?;
    }
    let interval = Span::from_seconds(0.04);
    Ok(Box::new(move || {
        if walk.step(&mut particles, interval, &mut random).is_err() {
            return f64::NAN;
        }
        let _ = particles.reweight(|columns, log_weights| {
            let positions = columns[0].iter().zip(&columns[1]).zip(&columns[2]);
            for (log_weight, ((x, y), z)) in log_weights.iter_mut().zip(positions) {
                *log_weight -= 2.0 * f64::from(x * x + y * y + z * z);
            }
        });
        particles
            .resample(Resampling::Systematic, &mut random)
            .map_or(f64::NAN, |ancestors| f64::from(ancestors[0]))
    }))
}
