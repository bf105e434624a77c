//! Statistics beside scipy (goldens/make_statistics.py), and where scipy has no answer.

#![expect(
    clippy::unwrap_used,
    reason = "a test stops at what it does not expect, also in its helpers"
)]

use approx::assert_relative_eq;
use hearsight_eval::statistics::{
    Alternative, Bootstrap, Interval, StatisticsError, bootstrap_mean, bootstrap_ratio_of_means, sign_test,
    signed_rank,
};
use serde_json::Value;

fn goldens() -> Value {
    serde_json::from_str(include_str!("goldens/statistics.json")).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    let values = value.as_array().unwrap().iter();
    values.map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn tests_of_differences_agree_with_scipy() {
    let goldens = goldens();
    let cases = goldens["tests"].as_array().unwrap();
    assert!(cases.len() > 15);
    for case in cases {
        let values = numbers(&case["values"]);
        for (name, alternative) in [
            ("two-sided", Alternative::TwoSided),
            ("greater", Alternative::Greater),
            ("less", Alternative::Less),
        ] {
            let expected = numbers(&case[name]);
            let sign = sign_test(&values, alternative).unwrap();
            assert_relative_eq!(sign.p, expected[0], max_relative = 1e-10);
            let rank = signed_rank(&values, alternative).unwrap();
            assert_relative_eq!(rank.p, expected[1], max_relative = 1e-9);
            assert_eq!(rank.exact, rank.count <= 50);
            assert_eq!(
                rank.above + rank.below,
                (rank.count * (rank.count + 1)) as f64 / 2.0
            );
        }
    }
}

#[test]
fn intervals_agree_with_scipy() {
    let goldens = goldens();
    let options = Bootstrap {
        resamples: 400_000,
        ..Bootstrap::default()
    };
    let check = |ours: Interval, theirs: Vec<f64>| {
        // Both draw at random: their ends scatter by some thousandths of the length.
        let length = theirs[1] - theirs[0];
        for (our, their) in [(ours.low, theirs[0]), (ours.high, theirs[1])] {
            assert!((our - their).abs() < 0.012 * length, "{ours:?} {theirs:?}");
        }
    };
    for case in goldens["intervals"].as_array().unwrap() {
        let (values, other) = (numbers(&case["values"]), numbers(&case["other"]));
        check(bootstrap_mean(&values, &options).unwrap(), numbers(&case["mean"]));
        let ratio = bootstrap_ratio_of_means(&values, &other, &options).unwrap();
        check(ratio, numbers(&case["ratio"]));
    }
}

#[test]
fn an_interval_is_the_same_for_the_same_seed_only() {
    let values = [0.2013, 0.5171, 0.9329, 0.4087, 0.7451, 0.6533, 0.3119, 0.4777];
    let of_seed = |seed| {
        let options = Bootstrap {
            seed,
            ..Bootstrap::default()
        };
        bootstrap_mean(&values, &options).unwrap()
    };
    assert_eq!(of_seed(3), of_seed(3));
    assert_ne!(of_seed(3), of_seed(4));
    assert!(of_seed(3).excludes(0.0, Alternative::Greater));
    assert!(!of_seed(3).excludes(0.5, Alternative::TwoSided));
}

#[test]
fn what_has_no_spread_has_an_interval_of_no_length() {
    let options = Bootstrap::default();
    for values in [vec![2.0], vec![2.0; 9]] {
        let interval = bootstrap_mean(&values, &options).unwrap();
        assert_eq!([interval.low, interval.estimate, interval.high], [2.0; 3]);
    }
}

#[test]
fn nothing_speaks_for_nothing() {
    for alternative in [Alternative::TwoSided, Alternative::Greater, Alternative::Less] {
        for differences in [&[][..], &[0.0, 0.0]] {
            assert_eq!(sign_test(differences, alternative).unwrap().p, 1.0);
            assert_eq!(signed_rank(differences, alternative).unwrap().p, 1.0);
        }
    }
}

#[test]
fn what_cannot_be_computed_is_refused() {
    let options = Bootstrap::default();
    assert!(matches!(
        bootstrap_mean(&[], &options),
        Err(StatisticsError::TooFew { .. })
    ));
    assert!(matches!(
        bootstrap_mean(&[1.0, f64::NAN], &options),
        Err(StatisticsError::NotFinite { index: 1, .. })
    ));
    assert!(matches!(
        bootstrap_ratio_of_means(&[1.0], &[1.0, 2.0], &options),
        Err(StatisticsError::NotPaired { .. })
    ));
    assert!(matches!(
        bootstrap_ratio_of_means(&[1.0, 1.0], &[1.0, -2.0], &options),
        Err(StatisticsError::OutOfRange { .. })
    ));
    assert!(sign_test(&[f64::INFINITY], Alternative::Less).is_err());
    assert!(signed_rank(&[f64::NAN], Alternative::Less).is_err());
    for bad in [
        Bootstrap {
            level: 1.0,
            ..options
        },
        Bootstrap {
            level: f64::NAN,
            ..options
        },
        Bootstrap {
            resamples: 3,
            ..options
        },
    ] {
        assert!(bootstrap_mean(&[1.0], &bad).is_err());
    }
}

#[test]
fn thousands_of_pairs_do_not_leave_the_range() {
    let mut differences = vec![1.0; 2600];
    differences.extend([-1.0; 2400]);
    let p = sign_test(&differences, Alternative::TwoSided).unwrap().p;
    // scipy.stats.binomtest(2600, 5000).pvalue
    assert_relative_eq!(p, 0.004_883_649_737_517_494, max_relative = 1e-9);
}
