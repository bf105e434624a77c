use super::*;
use nalgebra::{Matrix1x2, Matrix2, Matrix6, Vector2, Vector6};

fn six() -> UnscentedKalman<6> {
    let mean = Vector6::new(100.0, 80.0, 20.0, 5.0, -3.0, 0.5);
    let covariance = Matrix6::from_diagonal(&Vector6::new(9.0, 9.0, 4.0, 100.0, 100.0, 9.0));
    UnscentedKalman::new(mean, covariance).unwrap()
}

#[test]
fn agrees_with_the_linear_filter_where_all_is_linear() {
    let (mean, covariance) = (Vector2::new(1.0, -0.5), Matrix2::new(4.0, 0.5, 0.5, 1.0));
    let mut linear = crate::KalmanFilter::new(mean, covariance).unwrap();
    let step = Matrix2::new(1.0, 0.1, 0.0, 0.9);
    let noise = Matrix2::new(0.1, 0.02, 0.02, 0.3);
    for alpha in [1.0, 0.5, 1e-2] {
        let form = UnscentedForm {
            alpha,
            ..UnscentedForm::default()
        };
        let mut unscented = UnscentedKalman::new(mean, covariance).unwrap();
        linear = crate::KalmanFilter::new(mean, covariance).unwrap();
        let mut scratch = UnscentedScratch::default();
        for measured in [1.2, 0.4, 0.5, -0.9] {
            linear.predict(&step, &noise);
            unscented.predict(&form, |state| step * state, &noise).unwrap();
            let innovation = linear
                .update(
                    &nalgebra::Vector1::new(measured),
                    &Matrix1x2::new(1.0, 0.5),
                    &nalgebra::Matrix1::new(0.3),
                )
                .unwrap();
            let distance = unscented
                .update(
                    &form,
                    &[measured],
                    &[0.3],
                    |state, out| out[0] = state[0] + 0.5 * state[1],
                    &mut scratch,
                )
                .unwrap();
            assert!((distance - innovation.squared_distance).abs() < 1e-7);
            assert!((unscented.mean() - linear.mean()).norm() < 1e-8);
            assert!((unscented.covariance() - linear.covariance()).norm() < 1e-8);
        }
    }
    assert!(linear.mean().norm() > 0.0);
}

#[test]
fn a_thousand_sharp_measurements_keep_the_covariance_proper() {
    let mut filter = six();
    let form = UnscentedForm::default();
    let mut scratch = UnscentedScratch::default();
    let angles: Vec<f64> = (0..32)
        .map(|k| f64::from(k) * std::f64::consts::TAU / 32.0)
        .collect();
    for _ in 0..1000 {
        filter
            .predict(&form, |state| *state, &(Matrix6::identity() * 1e-6))
            .unwrap();
        filter
            .update(
                &form,
                &[20.0; 32],
                &[1e-6; 32],
                |state, out| {
                    for (value, angle) in out.iter_mut().zip(&angles) {
                        *value = state[2]
                            + 0.1 * (state[0] - 100.0) * angle.cos()
                            + 0.1 * (state[1] - 80.0) * angle.sin();
                    }
                },
                &mut scratch,
            )
            .unwrap();
        assert!(filter.covariance().cholesky().is_some());
    }
    assert!((filter.mean()[2] - 20.0).abs() < 1e-3);
}

#[test]
fn bad_input_is_an_error_and_leaves_the_state() {
    let mut filter = six();
    let before = filter.clone();
    let form = UnscentedForm::default();
    let mut scratch = UnscentedScratch::default();
    let observe = |state: &Vector6<f64>, out: &mut [f64]| out.fill(state[0]);
    assert!(
        filter
            .update(&form, &[f64::NAN], &[1.0], observe, &mut scratch)
            .is_err()
    );
    assert!(filter.update(&form, &[1.0], &[], observe, &mut scratch).is_err());
    assert!(
        filter
            .update(&form, &[1.0], &[-1e9], observe, &mut scratch)
            .is_err()
    );
    assert!(
        filter
            .update(
                &form,
                &[1.0],
                &[1.0],
                |_, out| out.fill(f64::INFINITY),
                &mut scratch
            )
            .is_err()
    );
    assert!(
        filter
            .predict(&form, |_| Vector6::repeat(f64::NAN), &Matrix6::zeros())
            .is_err()
    );
    for bad in [
        UnscentedForm { alpha: 0.0, ..form },
        UnscentedForm {
            beta: f64::NAN,
            ..form
        },
        UnscentedForm { kappa: -6.0, ..form },
    ] {
        assert!(
            filter
                .predict(&bad, |state| *state, &Matrix6::identity())
                .is_err()
        );
    }
    assert_eq!(filter.update(&form, &[], &[], observe, &mut scratch), Ok(0.0));
    assert_eq!(filter, before);
    assert!(UnscentedKalman::new(Vector2::zeros(), Matrix2::zeros()).is_err());
}
