use super::*;
use crate::random::generator;
use proptest::prelude::*;

fn any_scheme() -> impl Strategy<Value = Resampling> {
    prop::sample::select(Resampling::ALL.to_vec())
}

fn weights() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(
        prop_oneof![3 => 0.0..1.0_f64, 1 => Just(0.0), 1 => 0.0..1e-12_f64],
        1..80,
    )
    .prop_filter("some weight", |weights| {
        weights.iter().any(|weight| *weight > 0.0)
    })
}

fn offspring(ancestors: &[u32], particles: usize) -> Vec<usize> {
    let mut counts = vec![0; particles];
    for ancestor in ancestors {
        counts[*ancestor as usize] += 1;
    }
    counts
}

proptest! {
    #[test]
    fn ancestors_are_sorted_have_weight_and_repeat_by_seed(
        scheme in any_scheme(), weights in weights(), draws in 0..200_usize, seed: u64, scale in 1e-200..1e200_f64,
    ) {
        let mut first = vec![u32::MAX; draws];
        scheme.draw(&weights, &mut generator(seed, "test", 0), &mut first).unwrap();
        prop_assert!(first.is_sorted());
        prop_assert!(first.iter().all(|ancestor| weights[*ancestor as usize] > 0.0));
        let mut second = vec![0; draws];
        scheme.draw(&weights, &mut generator(seed, "test", 0), &mut second).unwrap();
        prop_assert_eq!(&first, &second);
        let scaled: Vec<f64> = weights.iter().map(|weight| weight * scale).collect();
        scheme.draw(&scaled, &mut generator(seed, "test", 0), &mut second).unwrap();
        prop_assert!(second.iter().all(|ancestor| weights[*ancestor as usize] > 0.0));
    }

    #[test]
    fn offspring_stay_within_the_bounds_of_the_scheme(weights in weights(), seed: u64) {
        let total: f64 = weights.iter().sum();
        let draws = 100;
        let mut ancestors = vec![0; draws];
        for (scheme, below, above) in [
            (Resampling::Systematic, 1.0, 1.0),
            (Resampling::Stratified, 2.0, 2.0),
            (Resampling::Residual, 1.0, f64::INFINITY),
        ] {
            scheme.draw(&weights, &mut generator(seed, "test", 0), &mut ancestors).unwrap();
            for (count, weight) in offspring(&ancestors, weights.len()).into_iter().zip(&weights) {
                let surplus = count as f64 - draws as f64 * weight / total;
                prop_assert!(surplus > -below - 1e-9 && surplus < above + 1e-9, "{:?} {}", scheme, surplus);
            }
        }
    }
}

/// Mean offspring over many runs against `draws * weight`: each within five standard errors, and, for the multinomial
/// scheme, whose offspring have a known covariance, chi-square over all particles together.
#[test]
fn every_scheme_is_unbiased() {
    let weights = [0.07, 0.0, 0.31, 0.02, 0.2, 0.004, 0.146, 0.05, 0.2, 0.0];
    let runs = 40_000;
    for (draws, scheme) in [10, 7, 33]
        .into_iter()
        .flat_map(|draws| Resampling::ALL.map(|scheme| (draws, scheme)))
    {
        let mut generator = generator(5, scheme.name(), draws as u64);
        let mut sums = vec![0.0; weights.len()];
        let mut squares = vec![0.0; weights.len()];
        let mut ancestors = vec![0; draws];
        for _ in 0..runs {
            scheme.draw(&weights, &mut generator, &mut ancestors).unwrap();
            for (index, count) in offspring(&ancestors, weights.len()).into_iter().enumerate() {
                sums[index] += count as f64;
                squares[index] += (count * count) as f64;
            }
        }
        let mut chi_square = 0.0;
        for (index, weight) in weights.iter().enumerate() {
            let (mean, expected) = (sums[index] / f64::from(runs), draws as f64 * weight);
            let variance = (squares[index] / f64::from(runs) - mean * mean).max(0.0);
            let multinomial_variance = expected * (1.0 - weight);
            assert!(
                variance <= 1.05 * multinomial_variance + 1e-9,
                "{scheme:?} has more variance than independent draws: {variance} > {multinomial_variance}"
            );
            let error = (mean - expected).abs();
            assert!(
                error <= 5.0 * (variance / f64::from(runs)).sqrt() + 1e-9,
                "{scheme:?}: {mean} {expected}"
            );
            if *weight > 0.0 {
                chi_square += f64::from(runs) * (mean - expected).powi(2) / expected;
            }
        }
        // Eight particles have weight: seven degrees of freedom; the 99.99th percentile is 29.9. The other schemes
        // vary less, so that theirs lies below.
        assert!(chi_square < 29.9, "{scheme:?} with {draws} draws: {chi_square}");
        if scheme == Resampling::Multinomial {
            // And not too good to be true: the 0.1st percentile is 0.6.
            assert!(chi_square > 0.4, "{chi_square}");
        }
    }
}

#[test]
fn independent_draws_have_the_variance_and_covariance_of_the_multinomial_distribution() {
    let weights = [0.5, 0.3, 0.2];
    let (runs, draws) = (100_000, 12);
    let mut generator = generator(6, "test", 0);
    let mut ancestors = vec![0; draws];
    let (mut variance, mut covariance) = (0.0, 0.0);
    for _ in 0..runs {
        Resampling::Multinomial
            .draw(&weights, &mut generator, &mut ancestors)
            .unwrap();
        let counts = offspring(&ancestors, 3);
        variance += (counts[0] as f64 - 6.0).powi(2) / f64::from(runs);
        covariance += (counts[0] as f64 - 6.0) * (counts[1] as f64 - 3.6) / f64::from(runs);
    }
    assert!((variance - 3.0).abs() < 0.08, "{variance}");
    assert!((covariance + 1.8).abs() < 0.08, "{covariance}");
}

#[test]
fn equal_weights_leave_every_particle_in_place() {
    let weights = vec![1.0 / 1000.0; 1000];
    let mut ancestors = vec![0; 1000];
    for scheme in [Resampling::Systematic, Resampling::Stratified] {
        scheme
            .draw(&vec![1.0; 1000], &mut generator(1, "test", 1), &mut ancestors)
            .unwrap();
        assert!(
            ancestors
                .iter()
                .enumerate()
                .all(|(index, ancestor)| index == *ancestor as usize),
            "{scheme:?}"
        );
    }
    Resampling::Residual
        .draw(&weights, &mut generator(1, "test", 1), &mut ancestors)
        .unwrap();
    assert!(
        offspring(&ancestors, 1000)
            .into_iter()
            .filter(|count| *count == 1)
            .count()
            > 990
    );
}

#[test]
fn weights_that_cannot_be_drawn_from_are_errors() {
    let mut ancestors = [7; 3];
    let mut generator = generator(1, "test", 0);
    for scheme in Resampling::ALL {
        for weights in [&[][..], &[0.0, 0.0]] {
            assert_eq!(
                scheme.draw(weights, &mut generator, &mut ancestors),
                Err(FilterError::NoWeight)
            );
        }
        for weights in [[1.0, f64::NAN], [1.0, f64::INFINITY]] {
            assert!(matches!(
                scheme.draw(&weights, &mut generator, &mut ancestors),
                Err(FilterError::NotFinite { .. })
            ));
        }
        assert_eq!(ancestors, [7; 3]);
    }
}

#[test]
fn schemes_describe_themselves_and_are_found_by_name() {
    for scheme in Resampling::ALL {
        assert!(!scheme.description().is_empty() && !scheme.source().is_empty());
        let text = serde_json::to_string(&scheme).unwrap();
        assert_eq!(text, format!("\"{}\"", scheme.name()));
        assert_eq!(serde_json::from_str::<Resampling>(&text).unwrap(), scheme);
    }
}
