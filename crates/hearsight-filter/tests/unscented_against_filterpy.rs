//! The unscented filter against filterpy, number for number, on a head's contour (goldens/make_unscented.py).

use hearsight_core::Span;
use hearsight_filter::motion::{LangevinAxis, LangevinIntegration};
use hearsight_filter::{UnscentedForm, UnscentedKalman, UnscentedScratch};
use nalgebra::{SMatrix, SVector};
use serde::Deserialize;

type State = SVector<f64, 6>;
type Covariance = SMatrix<f64, 6, 6>;

#[derive(Deserialize)]
struct Run {
    alpha: f64,
    beta: f64,
    kappa: f64,
    frames: Vec<Frame>,
}

#[derive(Deserialize)]
struct Frame {
    lines: Vec<[f64; 3]>,
    measured: Vec<f64>,
    prior_mean: Vec<f64>,
    prior_covariance: Vec<Vec<f64>>,
    mean: Vec<f64>,
    covariance: Vec<Vec<f64>>,
}

/// Signed distance from a line's centre to the ellipse: equation 13, corrected.
fn distance(state: &State, [x, y, angle]: [f64; 3]) -> f64 {
    let axes = [state[2] / 1.2, state[2]];
    let offset = [(x - state[0]) / axes[0], (y - state[1]) / axes[1]];
    let direction = [angle.cos() / axes[0], angle.sin() / axes[1]];
    let a = direction[0].powi(2) + direction[1].powi(2);
    let h = offset[0] * direction[0] + offset[1] * direction[1];
    let c = offset[0].powi(2) + offset[1].powi(2) - 1.0;
    let root = (h * h - a * c).max(0.0).sqrt();
    let (near, far) = ((-h - root) / a, (-h + root) / a);
    if near.abs() < far.abs() { near } else { far }
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    for (a, b) in found.iter().zip(expected) {
        assert!(
            (a - b).abs() <= tolerance * b.abs().max(1.0),
            "{a} where filterpy has {b}"
        );
    }
}

#[test]
fn every_number_is_that_of_filterpy() {
    let runs: Vec<Run> = serde_json::from_str(include_str!("goldens/unscented.json")).unwrap();
    assert_eq!(runs.len(), 3);
    for run in runs {
        let form = UnscentedForm {
            alpha: run.alpha,
            beta: run.beta,
            kappa: run.kappa,
        };
        // With alpha 0.001 the middle point counts minus a million: six digits are lost, there and here.
        let tolerance = if run.alpha < 0.1 { 1e-5 } else { 1e-9 };
        let mut noise = Covariance::zeros();
        let mut step = Covariance::identity();
        for (axis, rms_velocity) in [100.0, 100.0, 10.0].into_iter().enumerate() {
            let langevin = LangevinAxis {
                position: axis,
                velocity: axis + 3,
                rate_per_sec: 10.0,
                rms_velocity,
            };
            let langevin = langevin
                .over(Span::from_seconds(0.064), LangevinIntegration::OldVelocity)
                .unwrap();
            step[(axis, axis + 3)] = langevin.position_from_velocity;
            step[(axis + 3, axis + 3)] = langevin.velocity_from_velocity;
            noise[(axis, axis)] = 0.5;
            noise[(axis + 3, axis + 3)] = langevin.velocity_noise.powi(2);
        }
        let mean = State::from_row_slice(&[100.0, 80.0, 20.0, 5.0, -3.0, 0.5]);
        let covariance =
            Covariance::from_diagonal(&State::from_row_slice(&[9.0, 9.0, 4.0, 100.0, 100.0, 9.0]));
        let mut filter = UnscentedKalman::new(mean, covariance).unwrap();
        let mut scratch = UnscentedScratch::default();
        let variances: Vec<f64> = (0..12).map(|k| 0.5 + 0.25 * f64::from(k)).collect();
        for frame in run.frames {
            filter.predict(&form, |state| step * state, &noise).unwrap();
            assert_close(filter.mean().as_slice(), &frame.prior_mean, tolerance);
            assert_close(
                filter.covariance().as_slice(),
                &frame.prior_covariance.concat(),
                tolerance,
            );
            let observe = |state: &State, out: &mut [f64]| {
                for (value, line) in out.iter_mut().zip(&frame.lines) {
                    *value = distance(state, *line);
                }
            };
            filter
                .update(&form, &frame.measured, &variances, observe, &mut scratch)
                .unwrap();
            assert_close(filter.mean().as_slice(), &frame.mean, tolerance);
            assert_close(
                filter.covariance().as_slice(),
                &frame.covariance.concat(),
                tolerance,
            );
        }
    }
}
