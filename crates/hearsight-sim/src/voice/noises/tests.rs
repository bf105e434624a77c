//! Noises sound when and as they should.

use super::*;
use realfft::RealFftPlanner;
use std::f64::consts::PI;

const KINDS: [NoiseKind; 8] = [
    NoiseKind::Fan,
    NoiseKind::Street,
    NoiseKind::Band {
        low_hz: 1000.0,
        high_hz: 2000.0,
    },
    NoiseKind::Television,
    NoiseKind::Telephone,
    NoiseKind::Cough,
    NoiseKind::Laugh,
    NoiseKind::Clap,
];

fn samples(noise: &Noise, first: i64, count: usize) -> Vec<f32> {
    let mut samples = vec![9.0; count];
    noise.fill(first, &mut samples);
    samples
}

#[test]
fn noises_sound_within_their_spans_and_nowhere_else() {
    for kind in KINDS {
        let noise = Noise::new(kind, &[[0.5, 2.5], [4.0, 9.0]], 16_000, 3).unwrap();
        let all = samples(&noise, 0, 160_000);
        assert!(all.iter().all(|sample| sample.is_finite()), "{kind:?}");
        let energy = |from: usize, to: usize| all[from..to].iter().map(|x| x * x).sum::<f32>();
        assert_eq!(
            energy(0, 8000) + energy(40_000, 64_000) + energy(144_000, 160_000),
            0.0,
            "{kind:?}"
        );
        assert!(
            energy(8000, 40_000) > 100.0 && energy(64_000, 144_000) > 100.0,
            "{kind:?}"
        );
        // In parts, and once more.
        let parts: Vec<f32> = [0, 70_001, 70_002]
            .iter()
            .zip([70_001, 1, 89_998])
            .flat_map(|(first, count)| samples(&noise, *first, count))
            .collect();
        assert_eq!(all, parts, "{kind:?}");
        assert_eq!(
            all,
            samples(
                &Noise::new(kind, &[[0.5, 2.5], [4.0, 9.0]], 16_000, 3).unwrap(),
                0,
                160_000
            )
        );
    }
}

#[test]
fn levels_are_the_same() {
    for kind in KINDS {
        let noise = Noise::new(kind, &[[0.0, 20.0]], 16_000, 1).unwrap();
        let loudness = loudness(&samples(&noise, 0, 320_000), 16_000);
        let loudest = loudness.windows(10).map(mean).fold(0.0, f32::max);
        let whole = mean(&loudness);
        println!("{kind:?}: loudest {loudest:.2}, mean {whole:.3}");
        match kind {
            NoiseKind::Fan | NoiseKind::Band { .. } => assert!((whole - 1.0).abs() < 0.1),
            NoiseKind::Street => assert!((0.5..2.0).contains(&whole)),
            _ => assert!((loudest - 1.0).abs() < 0.01),
        }
    }
}

#[test]
fn a_band_stays_in_its_band() {
    let kind = NoiseKind::Band {
        low_hz: 1000.0,
        high_hz: 2000.0,
    };
    let noise = Noise::new(kind, &[[0.0, 10.0]], 16_000, 1).unwrap();
    let mut input = samples(&noise, 16_000, 65_536);
    for (n, sample) in input.iter_mut().enumerate() {
        *sample *= (PI * n as f64 / 65_536.0).sin().powi(2) as f32;
    }
    let forward = RealFftPlanner::<f32>::new().plan_fft_forward(65_536);
    let mut spectrum = forward.make_output_vec();
    forward.process(&mut input, &mut spectrum).unwrap();
    let power = |low: f64, high: f64| -> f32 {
        let bin = |hz: f64| (hz / 16_000.0 * 65_536.0) as usize;
        spectrum[bin(low)..bin(high)]
            .iter()
            .map(|value| value.norm_sqr())
            .sum()
    };
    assert!(power(990.0, 2010.0) > 1e4 * (power(0.0, 990.0) + power(2010.0, 8000.0)));
}

#[test]
fn impossible_noises_are_refused() {
    let make = |kind, spans: &[[f64; 2]]| Noise::new(kind, spans, 16_000, 0);
    assert!(
        make(NoiseKind::Fan, &[[1.0, 2.0], [1.5, 3.0]])
            .unwrap_err()
            .to_string()
            .contains("span 1")
    );
    assert!(make(NoiseKind::Fan, &[[f64::NAN, 2.0]]).is_err());
    assert!(make(NoiseKind::Laugh, &[[0.0, 1e6]]).is_err());
    assert!(
        make(
            NoiseKind::Band {
                low_hz: 100.0,
                high_hz: 9000.0
            },
            &[[0.0, 1.0]]
        )
        .is_err()
    );
    assert!(
        make(
            NoiseKind::Band {
                low_hz: -1.0,
                high_hz: 900.0
            },
            &[[0.0, 1.0]]
        )
        .is_err()
    );
}
