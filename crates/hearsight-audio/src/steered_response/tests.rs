use super::*;
use hearsight_core::microphones::SPEED_OF_SOUND_M_S;
use std::f64::consts::TAU;

const LENGTH: usize = 2048;
const RATE_HZ: u32 = 16_000;

fn line(spacing_m: f64) -> MicrophoneArray {
    let at = |k: i32| WorldPoint::new(spacing_m * f64::from(k), 0.1, 0.9);
    MicrophoneArray::new((-1..=1).map(at).collect()).unwrap()
}

/// Eight microphones that see every direction: no plane holds them.
fn cloud() -> MicrophoneArray {
    let at = |k: usize| {
        let corner = |axis: usize| if k >> axis & 1 == 0 { -0.2 } else { 0.2 };
        WorldPoint::new(1.0 + corner(0), 2.0 + corner(1) * 0.9, 1.2 + corner(2) * 1.1)
    };
    MicrophoneArray::new((0..8).map(at).collect()).unwrap()
}

/// What the microphones hear of a white sound at `source` in a room without walls.
fn heard(array: &MicrophoneArray, source: WorldPoint) -> Vec<Vec<Complex>> {
    let phases: Vec<f64> =
        std::iter::successors(Some(0.37_f64), |phase| Some((phase * 997.0 + 0.123).fract()))
            .take(LENGTH / 2 + 1)
            .collect();
    let channel = |position: &WorldPoint| {
        let lag = source.distance_m(*position) / SPEED_OF_SOUND_M_S * f64::from(RATE_HZ);
        let bin = |(k, phase): (usize, &f64)| {
            let angle = TAU * (phase - k as f64 * lag / LENGTH as f64);
            Complex::from_polar(1.0 + *phase as f32, angle as f32)
        };
        phases.iter().enumerate().map(bin).collect()
    };
    array.positions().iter().map(channel).collect()
}

fn response(array: &MicrophoneArray, combination: Combination) -> SteeredResponse {
    let settings = SteeredSettings {
        combination,
        ..SteeredSettings::default()
    };
    SteeredResponse::new(array, LENGTH, RATE_HZ, settings).unwrap()
}

/// The sum of equation 10 (corrected) over all bins in the band, at any delay in samples.
fn direct(first: &[Complex], second: &[Complex], bins: std::ops::Range<usize>, delay: f64) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for k in bins {
        let [x, y] = [first[k], second[k]].map(|x| (f64::from(x.re), f64::from(x.im)));
        let cross = (x.0 * y.0 + x.1 * y.1, x.1 * y.0 - x.0 * y.1);
        let magnitude = cross.0.hypot(cross.1);
        let angle = TAU * k as f64 * delay / LENGTH as f64;
        sum += (cross.0 * angle.cos() - cross.1 * angle.sin()) / magnitude;
        total += 1.0;
    }
    sum / total
}

#[test]
fn curves_are_the_direct_sum_over_the_spectrum() {
    for (spacing_m, source) in [(0.2, [1.3, 2.0, 1.2]), (2.0, [-2.3, 1.0, 1.7])] {
        let array = line(spacing_m);
        let spectra = heard(&array, WorldPoint::new(source[0], source[1], source[2]));
        let mut response = response(&array, Combination::Sum);
        response.observe(&spectra).unwrap();
        let bins = bin_range(150.0, 0.46 * 16_000.0, RATE_HZ, LENGTH);
        for pair in [(0, 1), (0, 2), (1, 2)] {
            let half = response.curves.half();
            let curve = response.curves.correlate(pair).unwrap();
            let mut worst = 0.0_f64;
            for (k, value) in curve.iter().enumerate() {
                let delay = (k as f64 - half as f64) / 8.0;
                let expected = direct(&spectra[pair.0], &spectra[pair.1], bins.clone(), delay);
                worst = worst.max((f64::from(*value) - expected).abs());
            }
            println!("spacing {spacing_m}, pair {pair:?}: worst difference {worst:.2e}");
            // The window over the delays leaves 60 dB of what wraps around, from several sides.
            assert!(worst < 6e-3, "{worst}");
        }
    }
}

#[test]
fn the_source_has_the_highest_score_and_all_ways_to_it_agree() {
    let array = cloud();
    let source = WorldPoint::new(2.9, 3.4, 1.6);
    for combination in [Combination::Sum, Combination::default()] {
        let mut response = response(&array, combination);
        response.observe(&heard(&array, source)).unwrap();
        let points: Vec<WorldPoint> = (0..3000)
            .map(|k| {
                let part = |factor: f64| (f64::from(k) * factor).fract();
                WorldPoint::new(5.0 * part(0.618), 5.0 * part(0.414), 2.5 * part(0.732))
            })
            .chain([source])
            .collect();
        let mut scores = Vec::new();
        let table = response.table(&points);
        assert_eq!(table.points(), points.len());
        response.score_table(&table, &mut scores).unwrap();
        let coordinates: [Vec<f32>; 3] =
            std::array::from_fn(|axis| points.iter().map(|p| p.0[axis] as f32).collect());
        let mut moving = vec![0.0; points.len()];
        let [x, y, z] = &coordinates;
        response.score_points([x, y, z], &mut moving);
        for (a, b) in scores.iter().zip(&moving) {
            assert!((a - b).abs() < 2e-2, "{a} {b}");
        }
        let alone = response.score(source);
        assert!((alone - moving[points.len() - 1]).abs() < 1e-6);
        assert!(
            scores[..3000].iter().all(|score| *score < alone),
            "{combination:?}"
        );
        let expected = if combination == Combination::Sum { 1.0 } else { 0.0 };
        assert!((alone - expected).abs() < 0.12, "{combination:?}: {alone}");
    }
}

#[test]
fn a_search_finds_what_a_dense_grid_finds() {
    let array = cloud();
    let bounds = Bounds {
        low_m: [0.0, 0.0, 0.0],
        high_m: [5.0, 4.0, 2.5],
    };
    let mut response = response(&array, Combination::default());
    let mut search = Search::new(&response, bounds, SearchSettings::default()).unwrap();
    for source in [[4.0, 3.1, 0.4], [0.3, 0.2, 2.2], [2.2, 3.9, 1.1], [1.0, 0.6, 1.9]] {
        let source = WorldPoint::new(source[0], source[1], source[2]);
        response.observe(&heard(&array, source)).unwrap();
        let found = search.find(&mut response, |_| 0.0).unwrap();
        let dense = response.score(source);
        println!("{:?} off by {:.3} m", source.0, found.point.distance_m(source));
        assert!(found.score >= dense - 0.05, "{} {dense}", found.score);
        // The range of an array of 0.4 m is unsure; the direction is not.
        let centre = array.centre().0;
        let angle = (found.point.0 - centre).angle(&(source.0 - centre)).to_degrees();
        assert!(angle < 0.5, "{angle} degrees");
        assert!(found.point.distance_m(source) < 0.3, "{:?}", found.point);
        // A prior that forbids the right half moves the answer to the left one.
        let left = search.find(&mut response, |[x, ..]| if x > 0.25 { -1e3 } else { 0.0 });
        assert!(left.unwrap().point.0.x <= 0.26);
    }
}

#[test]
fn a_dead_microphone_takes_part_in_nothing() {
    let array = cloud();
    let source = WorldPoint::new(3.2, 1.0, 1.5);
    let mut spectra = heard(&array, source);
    spectra[3].fill(Complex::default());
    spectra[4][100] = Complex::new(f32::NAN, 1.0);
    let mut response = response(&array, Combination::default());
    response.observe(&spectra).unwrap();
    let at_source = response.score(source);
    assert!(at_source > -0.5 && at_source <= 0.0, "{at_source}");
    assert!(response.score(WorldPoint::new(0.5, 3.5, 0.3)) < at_source - 10.0);
    spectra
        .iter_mut()
        .for_each(|spectrum| spectrum.fill(Complex::default()));
    response.observe(&spectra).unwrap();
    assert_eq!(response.score(source), 0.0);
}

#[test]
fn mistakes_are_errors() {
    let array = line(0.2);
    let new = |length, settings| SteeredResponse::new(&array, length, RATE_HZ, settings);
    let settings = SteeredSettings::default();
    assert!(new(16, settings).is_err());
    assert!(
        new(
            LENGTH,
            SteeredSettings {
                interpolation: 0,
                ..settings
            }
        )
        .is_err()
    );
    assert!(
        new(
            LENGTH,
            SteeredSettings {
                low_hz: 9000.0,
                ..settings
            }
        )
        .is_err()
    );
    let combination = Combination::Product {
        floor: 0.0,
        exponent: 1.0,
    };
    assert!(
        new(
            LENGTH,
            SteeredSettings {
                combination,
                ..settings
            }
        )
        .is_err()
    );
    let one = MicrophoneArray::new(vec![WorldPoint::new(0.0, 0.0, 0.0)]).unwrap();
    assert!(SteeredResponse::new(&one, LENGTH, RATE_HZ, settings).is_err());
    let mut response = new(LENGTH, settings).unwrap();
    assert!(response.observe(&[]).is_err());
    let other = SteeredResponse::new(&cloud(), LENGTH, RATE_HZ, settings).unwrap();
    let table = other.table(&[WorldPoint::new(0.0, 0.0, 0.0)]);
    assert!(response.score_table(&table, &mut Vec::new()).is_err());
    let bounds = Bounds {
        low_m: [0.0; 3],
        high_m: [1.0, -1.0, 1.0],
    };
    assert!(Search::new(&response, bounds, SearchSettings::default()).is_err());
    let huge = Bounds {
        low_m: [0.0; 3],
        high_m: [1e9; 3],
    };
    assert!(huge.grid(0.1).is_err());
}

#[test]
fn the_logarithm_is_one() {
    for k in 0..200_000 {
        let x = 1e-3 + k as f32 * 1e-5;
        let expected = f64::from(x).ln();
        assert!((f64::from(lookup::ln(x)) - expected).abs() < 3e-6, "{x}");
    }
}
