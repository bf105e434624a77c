//! The test that every model shares: two steps of half the time are distributed as one of the whole.

use super::{GaussianStep, Motion};
use crate::particles::Particles;
use crate::random::generator;
use hearsight_core::Span;
use nalgebra::Vector2;

/// Particles around 10, 20, 30 ... with unit deviation.
pub(crate) fn clouds(dimensions: usize, count: usize) -> Particles {
    let mut particles = Particles::new(dimensions, count).unwrap();
    let mean: Vec<f64> = (1..=dimensions)
        .map(|dimension| 10.0 * dimension as f64)
        .collect();
    particles
        .draw_gaussian(&mean, &vec![1.0; dimensions], &mut generator(9, "start", 0))
        .unwrap();
    particles
}

/// Compares mean and covariance after one step of `seconds` with those after two halves and after three uneven parts,
/// within five Monte-Carlo errors of 200,000 particles.
pub(crate) fn assert_halves_equal_whole(model: &impl Motion, dimensions: usize, seconds: f64) {
    let count = 200_000;
    let start = clouds(dimensions, count);
    let moved = |parts: &[f64], id: u64| {
        let mut particles = start.clone();
        let mut random = generator(10, "motion", id);
        for part in parts {
            model
                .step(&mut particles, Span::from_seconds(part * seconds), &mut random)
                .unwrap();
        }
        particles
    };
    let whole = moved(&[1.0], 0);
    for (id, parts) in [&[0.5, 0.5][..], &[0.1, 0.65, 0.25]].into_iter().enumerate() {
        let parts = moved(parts, id as u64 + 1);
        for first in 0..dimensions {
            let variance = whole.covariance_of(first, first);
            let error = (whole.mean_of(first) - parts.mean_of(first)).abs();
            // Two independent means differ with variance 2 variance / n.
            let tolerance = 5.0 * (2.0 * variance / count as f64).sqrt() + 1e-5;
            assert!(error < tolerance, "mean {first}: {error} > {tolerance}");
            for second in 0..=first {
                let covariance = whole.covariance_of(first, second);
                let error = (covariance - parts.covariance_of(first, second)).abs();
                let spread = variance * whole.covariance_of(second, second) + covariance * covariance;
                let tolerance = 5.0 * (2.0 * spread / count as f64).sqrt() + 1e-5;
                assert!(
                    error < tolerance,
                    "covariance {first} {second}: {error} > {tolerance}"
                );
            }
        }
    }
}

/// Compares mean and covariance of moved particles with the matrices of the step, within five Monte-Carlo errors.
pub(crate) fn assert_moves_as(
    model: &impl Motion,
    dimensions: usize,
    axis: [usize; 2],
    seconds: f64,
    step: &GaussianStep,
) {
    let count = 200_000;
    let mut particles = clouds(dimensions, count);
    let start = Vector2::from(axis.map(|dimension| 10.0 * (dimension + 1) as f64));
    model
        .step(
            &mut particles,
            Span::from_seconds(seconds),
            &mut generator(11, "motion", 0),
        )
        .unwrap();
    let mean = step.transition() * start;
    let covariance = step.transition() * step.transition().transpose() + step.covariance();
    for (row, first) in axis.into_iter().enumerate() {
        let tolerance = 5.0 * (covariance[(row, row)] / count as f64).sqrt() + 1e-5;
        assert!((particles.mean_of(first) - mean[row]).abs() < tolerance);
        for (column, second) in axis.into_iter().enumerate() {
            let spread =
                covariance[(row, row)] * covariance[(column, column)] + covariance[(row, column)].powi(2);
            let error = (particles.covariance_of(first, second) - covariance[(row, column)]).abs();
            assert!(error < 5.0 * (spread / count as f64).sqrt() + 1e-5);
        }
    }
}
