use super::*;
use crate::random::generator;
use crate::resampling::Resampling;
use proptest::prelude::*;

fn cloud(seed: u64, count: usize) -> Particles {
    let mut random = generator(seed, "test", 0);
    let mut particles = Particles::new(3, count).unwrap();
    particles
        .draw_gaussian(&[1.0, -2.0, 100.0], &[1.0, 0.5, 10.0], &mut random)
        .unwrap();
    let _ = particles.reweight(|columns, log_weights| {
        for (log_weight, x) in log_weights.iter_mut().zip(&columns[0]) {
            *log_weight += f64::from(*x);
        }
    });
    particles
}

proptest! {
    #[test]
    fn weights_sum_to_one_whatever_comes(
        log_likelihoods in prop::collection::vec(
            prop_oneof![
                8 => -2000.0..2000.0_f64,
                1 => Just(f64::NEG_INFINITY),
                1 => Just(f64::NAN),
                1 => Just(f64::INFINITY),
            ],
            1..50,
        ),
        bad_states in prop::collection::vec(0..50_usize, 0..5),
    ) {
        let count = log_likelihoods.len();
        let mut particles = Particles::new(2, count).unwrap();
        particles.draw_gaussian(&[5.0, 6.0], &[1.0, 1.0], &mut generator(1, "test", 0)).unwrap();
        let bad_states: std::collections::BTreeSet<_> = bad_states.into_iter().filter(|bad| *bad < count).collect();
        for bad in &bad_states {
            particles.column_mut(1)[*bad] = f32::NAN;
        }
        let is_bad = |index: usize| {
            bad_states.contains(&index) || log_likelihoods[index].is_nan() || log_likelihoods[index] == f64::INFINITY
        };
        let report = particles.add_log_likelihoods(&log_likelihoods).unwrap();
        prop_assert_eq!(report.quarantined, (0..count).filter(|index| is_bad(*index)).count());
        prop_assert!((particles.weights().iter().sum::<f64>() - 1.0).abs() < 1e-12);
        prop_assert!(particles.columns().iter().flatten().all(|state| state.is_finite()));
        prop_assert!(report.effective_sample_size >= 1.0 && report.effective_sample_size <= count as f64);
        let positive = (0..count).any(|index| !is_bad(index) && log_likelihoods[index].is_finite());
        let expected = if positive {
            NormalizationOutcome::Normalized
        } else if bad_states.len() == count {
            NormalizationOutcome::Lost
        } else {
            NormalizationOutcome::Reset
        };
        prop_assert_eq!(report.outcome, expected);
        if positive {
            for index in (0..count).filter(|index| is_bad(*index)) {
                prop_assert_eq!(particles.weights()[index], 0.0);
            }
        }
    }
}

#[test]
fn moments_agree_with_plain_sums() {
    let particles = cloud(1, 1003);
    let weights = particles.weights();
    for first in 0..3 {
        let mean: f64 = particles
            .column(first)
            .iter()
            .zip(weights)
            .map(|(x, weight)| f64::from(*x) * weight)
            .sum();
        assert!((particles.mean_of(first) - mean).abs() < 1e-11 * mean.abs());
        for second in 0..3 {
            let other = particles.mean_of(second);
            let covariance: f64 = (0..1003)
                .map(|index| {
                    weights[index]
                        * (f64::from(particles.column(first)[index]) - mean)
                        * (f64::from(particles.column(second)[index]) - other)
                })
                .sum();
            assert!(
                (particles.covariance_of(first, second) - covariance).abs()
                    < 1e-11 * covariance.abs().max(1.0)
            );
        }
    }
    let mut matrix = [0.0; 9];
    particles.covariance_into(&mut matrix).unwrap();
    assert_eq!(matrix[5], particles.covariance_of(2, 1));
    assert_eq!(matrix[7], particles.covariance_of(1, 2));
    let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
    assert!((particles.effective_sample_size() * squares - 1.0).abs() < 1e-12);
    let heaviest = particles.heaviest();
    assert!(weights.iter().all(|weight| *weight <= weights[heaviest]));
    assert!(particles.covariance_into(&mut [0.0; 4]).is_err() && particles.mean_into(&mut [0.0; 4]).is_err());
}

#[test]
fn log_evidence_is_the_mean_likelihood() {
    let mut particles = Particles::new(1, 4).unwrap();
    let report = particles
        .add_log_likelihoods(&[0.1_f64.ln(), 0.2_f64.ln(), 0.3_f64.ln(), f64::NEG_INFINITY])
        .unwrap();
    assert!((report.log_evidence - 0.15_f64.ln()).abs() < 1e-14);
    assert!((particles.weights()[2] - 0.5).abs() < 1e-14);
    assert!((particles.log_weights()[0] - (1.0_f64 / 6.0).ln()).abs() < 1e-14);
}

#[test]
fn weights_too_small_for_linear_numbers_come_back() {
    let mut particles = Particles::new(1, 2).unwrap();
    let _ = particles.add_log_likelihoods(&[0.0, -5000.0]).unwrap();
    assert_eq!(particles.weights(), [1.0, 0.0]);
    let _ = particles.add_log_likelihoods(&[-5000.0, 0.0]).unwrap();
    assert!((particles.weights()[1] - 0.5).abs() < 1e-9);
}

#[test]
fn a_mean_between_normalizations_leaves_out_what_is_not_finite() {
    let mut particles = Particles::new(1, 4).unwrap();
    particles
        .column_mut(0)
        .copy_from_slice(&[1.0, f32::INFINITY, 3.0, f32::NAN]);
    assert!((particles.mean_of(0) - 2.0).abs() < 1e-15);
    assert_eq!(particles.normalize().quarantined, 2);
    assert!((particles.mean_of(0) - 2.0).abs() < 1e-15);
}

#[test]
fn resampling_keeps_the_distribution_and_equalizes_the_weights() {
    for scheme in Resampling::ALL {
        let mut particles = cloud(2, 20_000);
        let (before, deviation) = (particles.mean(), particles.covariance_of(2, 2).sqrt());
        let original = particles.clone();
        let ancestors = particles
            .resample(scheme, &mut generator(2, "test", 1))
            .unwrap()
            .to_vec();
        for (index, ancestor) in ancestors.iter().enumerate() {
            assert!(particles.state(index).eq(original.state(*ancestor as usize)));
        }
        assert!((particles.effective_sample_size() - 20_000.0).abs() < 1e-6);
        let error = (particles.mean_of(2) - before[2]).abs();
        assert!(
            error < 5.0 * deviation / 20_000.0_f64.sqrt(),
            "{scheme:?}: {error}"
        );
    }
}

#[test]
fn resampling_by_importance_keeps_the_distribution() {
    let mut particles = cloud(3, 50_000);
    let before = particles.mean();
    let importance: Vec<f64> = particles
        .column(1)
        .iter()
        .map(|y| (f64::from(*y) + 2.0).exp())
        .collect();
    let report = particles
        .resample_by_importance(&importance, Resampling::Systematic, &mut generator(3, "test", 1))
        .unwrap();
    assert_eq!(report.outcome, NormalizationOutcome::Normalized);
    let tolerance = 5.0 / report.effective_sample_size.sqrt();
    assert!((particles.mean_of(0) - before[0]).abs() < tolerance);
    assert!((particles.mean_of(1) - before[1]).abs() < 0.5 * tolerance);
    // There are more particles now where the importance is greater.
    let plain = particles.column(1).iter().map(|y| f64::from(*y)).sum::<f64>() / 50_000.0;
    assert!(plain > before[1] + 0.2, "{plain}");
}

#[test]
fn resampling_waits_for_the_effective_sample_size() {
    let mut particles = cloud(4, 1000);
    let fraction = particles.effective_sample_size() / 1000.0;
    let mut random = generator(4, "test", 1);
    assert!(
        !particles
            .resample_below(fraction - 0.01, Resampling::Systematic, &mut random)
            .unwrap()
    );
    assert!(
        particles
            .resample_below(fraction + 0.01, Resampling::Systematic, &mut random)
            .unwrap()
    );
}

#[test]
fn a_saved_belief_goes_on_exactly() {
    let mut original = cloud(5, 100);
    let _ = original.reweight(|_, log_weights| log_weights[3] = f64::NEG_INFINITY);
    let text = serde_json::to_string(&original).unwrap();
    let mut restored: Particles = serde_json::from_str(&text).unwrap();
    assert_eq!(restored, original);
    for particles in [&mut original, &mut restored] {
        particles
            .resample(Resampling::Systematic, &mut generator(5, "test", 1))
            .unwrap();
    }
    assert_eq!(restored, original);
}

#[test]
fn what_was_saved_is_checked() {
    for text in [
        r#"{"columns": [], "log_weights": [0.0], "weights": [1.0]}"#,
        r#"{"columns": [[]], "log_weights": [], "weights": []}"#,
        r#"{"columns": [[1.0, 2.0]], "log_weights": [0.0], "weights": [1.0]}"#,
        r#"{"columns": [[1.0]], "log_weights": [0.0], "weights": [0.5, 0.5]}"#,
        r#"{"columns": [[1.0]], "log_weights": [0.0], "weights": [0.5]}"#,
    ] {
        assert!(serde_json::from_str::<Particles>(text).is_err(), "{text}");
    }
}

#[test]
fn mistakes_are_errors() {
    assert!(Particles::new(0, 1).is_err());
    assert!(Particles::new(1, 0).is_err());
    let mut particles = Particles::new(3, 2).unwrap();
    assert!(particles.columns_mut([0, 3]).is_err());
    assert!(particles.columns_mut([1, 1]).is_err());
    assert!(particles.columns_mut([2, 0]).is_ok());
    assert!(particles.set_state(2, &[0.0; 3]).is_err());
    assert!(particles.set_state(1, &[0.0; 2]).is_err());
    assert!(particles.add_log_likelihoods(&[0.0]).is_err());
    let mut random = generator(1, "test", 0);
    assert!(
        particles
            .draw_gaussian(&[0.0; 3], &[1.0, -1.0, 0.0], &mut random)
            .is_err()
    );
    assert!(
        particles
            .draw_uniform(&[0.0; 3], &[1.0, 1.0, -1.0], &mut random)
            .is_err()
    );
    particles
        .draw_uniform(&[0.0, 1.0, 2.0], &[1.0, 1.0, 3.0], &mut random)
        .unwrap();
    assert!(particles.column(1).iter().all(|value| *value == 1.0));
    assert!(
        particles
            .column(2)
            .iter()
            .all(|value| (2.0..=3.0).contains(value))
    );
}

#[test]
fn angles_have_a_circular_mean() {
    let mut particles = Particles::new(1, 2).unwrap();
    particles.column_mut(0).copy_from_slice(&[3.1, -3.1]);
    let (angle, length) = particles.circular_mean_of(0);
    assert!((angle.abs() - std::f64::consts::PI).abs() < 1e-6 && length > 0.99);
}
