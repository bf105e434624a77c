//! A bootstrap particle filter on a linear Gaussian problem against the Kalman filter, which is exact there.
//!
//! The particle filter's mean and variance are averages over N particles: their errors are of order sqrt(variance / N)
//! and independent between seeds. Over several seeds the average error must vanish within its own standard error, the
//! spread must be that of N particles, and it must halve when N is multiplied by four.

#![expect(clippy::unwrap_used, reason = "a test may panic, also in its helpers")]

use hearsight_core::Span;
use hearsight_filter::motion::{
    ConstantVelocity, ConstantVelocityAxis, Langevin, LangevinAxis, LangevinIntegration,
};
use hearsight_filter::motion::{GaussianStep, Motion};
use hearsight_filter::{Generator, KalmanFilter, Particles, Resampling, generator, standard_normal, uniform};
use nalgebra::{Matrix1, Matrix1x2, Matrix2, Vector1, Vector2};

const STEPS: usize = 150;
const NOISE: f64 = 0.4;
const SEEDS: u64 = 24;
const PRIOR_SIGMA: [f64; 2] = [1.0, 0.7];

/// One instant of the problem: what had elapsed, what was measured (nothing if a frame was lost).
struct Measured {
    elapsed: Span,
    position: Option<f64>,
}

/// Uneven steps from 5 ms to half a second, one measurement in ten lost.
fn problem(step_over: &dyn Fn(Span) -> GaussianStep) -> Vec<Measured> {
    let mut random = generator(1, "truth", 0);
    let mut state = Vector2::new(PRIOR_SIGMA[0] * standard_normal(&mut random), PRIOR_SIGMA[1]);
    (0..STEPS)
        .map(|_| {
            let elapsed = Span::from_seconds(0.005 * 100.0_f64.powf(uniform(&mut random)));
            let step = step_over(elapsed);
            let noise = step
                .covariance()
                .cholesky()
                .map_or(Matrix2::zeros(), |factor| factor.l());
            let kick = Vector2::new(standard_normal(&mut random), standard_normal(&mut random));
            state = step.transition() * state + noise * kick;
            let seen = uniform(&mut random) > 0.1;
            let position = seen.then_some(state[0] + NOISE * standard_normal(&mut random));
            Measured { elapsed, position }
        })
        .collect()
}

/// Mean and variance of position and velocity after every step, and the log-likelihood of all measurements.
struct Summary {
    steps: Vec<[f64; 4]>,
    log_likelihood: f64,
}

fn exact(problem: &[Measured], step_over: &dyn Fn(Span) -> GaussianStep) -> Summary {
    let prior = Matrix2::from_diagonal(&Vector2::from(PRIOR_SIGMA.map(|sigma| sigma * sigma)));
    let mut filter = KalmanFilter::new(Vector2::zeros(), prior).unwrap();
    let mut log_likelihood = 0.0;
    let steps = problem
        .iter()
        .map(|measured| {
            let step = step_over(measured.elapsed);
            filter.predict(&step.transition(), &step.covariance());
            if let Some(position) = measured.position {
                let row = Matrix1x2::new(1.0, 0.0);
                let noise = Matrix1::new(NOISE * NOISE);
                log_likelihood += filter
                    .update(&Vector1::new(position), &row, &noise)
                    .unwrap()
                    .log_likelihood;
            }
            let (mean, covariance) = (filter.mean(), filter.covariance());
            [mean[0], mean[1], covariance.m11, covariance.m22]
        })
        .collect();
    Summary {
        steps,
        log_likelihood,
    }
}

fn bootstrap(problem: &[Measured], motion: &impl Motion, count: usize, random: &mut Generator) -> Summary {
    let mut particles = Particles::new(2, count).unwrap();
    particles
        .draw_gaussian(&[0.0, 0.0], &PRIOR_SIGMA, random)
        .unwrap();
    let constant = -(NOISE * std::f64::consts::TAU.sqrt()).ln();
    let mut log_likelihood = 0.0;
    let steps = problem
        .iter()
        .map(|measured| {
            motion.step(&mut particles, measured.elapsed, random).unwrap();
            if let Some(position) = measured.position {
                let report = particles.reweight(|columns, log_weights| {
                    for (log_weight, x) in log_weights.iter_mut().zip(&columns[0]) {
                        *log_weight += constant - 0.5 * ((f64::from(*x) - position) / NOISE).powi(2);
                    }
                });
                log_likelihood += report.log_evidence;
            }
            let summary = [
                particles.mean_of(0),
                particles.mean_of(1),
                particles.covariance_of(0, 0),
                particles.covariance_of(1, 1),
            ];
            particles
                .resample_below(0.5, Resampling::Systematic, random)
                .unwrap();
            summary
        })
        .collect();
    Summary {
        steps,
        log_likelihood,
    }
}

/// The error of one quantity in units of the Monte-Carlo deviation of `count` independent draws.
fn scaled_error(run: &Summary, exact: &Summary, step: usize, quantity: usize, count: usize) -> f64 {
    let truth = exact.steps[step];
    // The variance of a mean is variance / n, that of a variance 2 variance^2 / n.
    let unit = match quantity {
        0 | 1 => truth[quantity + 2].sqrt(),
        _ => truth[quantity] * 2.0_f64.sqrt(),
    } / (count as f64).sqrt();
    (run.steps[step][quantity] - truth[quantity]) / unit
}

fn mean_and_variance(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (
        mean,
        values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64,
    )
}

fn assert_agrees(motion: &impl Motion, step_over: &dyn Fn(Span) -> GaussianStep) {
    let problem = problem(step_over);
    let exact = exact(&problem, step_over);
    let mut spread = Vec::new();
    for count in [2_000, 8_000] {
        let runs: Vec<Summary> = (0..SEEDS)
            .map(|seed| {
                bootstrap(
                    &problem,
                    motion,
                    count,
                    &mut generator(seed, "track", count as u64),
                )
            })
            .collect();
        let mut squares = 0.0;
        for quantity in 0..4 {
            let mut run_means = vec![0.0; runs.len()];
            for step in 0..STEPS {
                let errors: Vec<f64> = runs
                    .iter()
                    .map(|run| scaled_error(run, &exact, step, quantity, count))
                    .collect();
                let (mean, variance) = mean_and_variance(&errors);
                // Student's t with 23 degrees of freedom exceeds 6.5 once in a million: of 1200 tests, never. The
                // bias, of the order 1/N, is a small part of the unit, 1/sqrt(N).
                let limit = 6.5 * (variance / SEEDS as f64).sqrt() + 0.1;
                assert!(
                    mean.abs() < limit,
                    "step {step}, quantity {quantity}: {mean} > {limit} with {count}"
                );
                squares += variance / (4 * STEPS) as f64;
                for (run_mean, error) in run_means.iter_mut().zip(errors) {
                    *run_mean += error / STEPS as f64;
                }
            }
            // Over all steps together, small errors in one direction show.
            let (mean, variance) = mean_and_variance(&run_means);
            let limit = 6.5 * (variance / SEEDS as f64).sqrt() + 0.1;
            assert!(
                mean.abs() < limit,
                "quantity {quantity} on average: {mean} > {limit} with {count}"
            );
        }
        // The weights of the past cost some of the N draws, but on average not more than nine in ten.
        spread.push(squares.sqrt());
        assert!(
            squares < 10.0,
            "{count} particles are worth {}",
            count as f64 / squares
        );
        let evidence: Vec<f64> = runs
            .iter()
            .map(|run| run.log_likelihood - exact.log_likelihood)
            .collect();
        let (mean, variance) = mean_and_variance(&evidence);
        // The likelihood, not its logarithm, is unbiased: the logarithm lies half the variance below.
        let error = (mean + 0.5 * variance).abs();
        assert!(
            error < 6.5 * (variance / SEEDS as f64).sqrt(),
            "evidence: {error}, variance {variance}"
        );
        assert!(
            variance < 150.0 * 20.0 / count as f64,
            "evidence: variance {variance} with {count}"
        );
    }
    // In units of sqrt(variance / N) the spread must not depend on N.
    let ratio = spread[0] / spread[1];
    assert!(
        (0.85..1.18).contains(&ratio),
        "spread {spread:?} does not fall as the root of the number of particles"
    );
}

#[test]
fn constant_velocity() {
    let axis = ConstantVelocityAxis {
        position: 0,
        velocity: 1,
        diffusion: 0.8,
    };
    assert_agrees(&ConstantVelocity { axes: vec![axis] }, &|elapsed| {
        axis.over(elapsed).unwrap()
    });
}

#[test]
fn langevin() {
    let axis = LangevinAxis {
        position: 0,
        velocity: 1,
        rate_per_sec: 2.0,
        rms_velocity: 1.2,
    };
    let integration = LangevinIntegration::Exact;
    let motion = Langevin {
        axes: vec![axis],
        integration,
    };
    assert_agrees(&motion, &|elapsed| axis.over(elapsed, integration).unwrap());
}
