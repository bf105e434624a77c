use super::*;
use crate::spectrum::{SpectrumAnalyzer, Window, power_into};

struct White(u64);

impl White {
    /// Near Gaussian: the sum of twelve uniform numbers, of unit variance.
    fn sample(&mut self) -> f32 {
        let mut uniform = || {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 40) as f32 / (1 << 24) as f32
        };
        (0..12).map(|_| uniform()).sum::<f32>() - 6.0
    }

    fn frame(&mut self, amplitude: f32) -> Vec<f32> {
        (0..640).map(|_| amplitude * self.sample()).collect()
    }
}

fn decibels(ratio: f32) -> f32 {
    10.0 * ratio.log10()
}

#[test]
fn the_floor_of_white_noise_is_its_power() {
    let mut white = White(5);
    let settings = NoiseSettings {
        first_power: 1.0,
        ..NoiseSettings::default()
    };
    let mut analyzer = SpectrumAnalyzer::new(640, 1024, Window::Hann).unwrap();
    let mut whole = NoiseFloor::of_frames(&settings, 0.02, 640).unwrap();
    let mut bins = NoiseFloor::of_spectra(&settings, 0.02, 513, analyzer.window_energy()).unwrap();
    let (mut spectrum, mut power) = (Vec::new(), Vec::new());
    let (mut past, mut error_db) = (vec![0.0; 640], 0.0);
    for frame in 0..1000 {
        // Half overlap, as in use.
        past.copy_within(320.., 0);
        past[320..].copy_from_slice(&white.frame(0.01)[..320]);
        whole.observe(&[mean_square(&past)]).unwrap();
        analyzer.transform(&past, &mut spectrum).unwrap();
        power_into(&spectrum, &mut power);
        bins.observe(&power).unwrap();
        if frame >= 500 {
            let mean = bins.power()[1..512].iter().sum::<f32>() / 511.0;
            error_db += decibels(mean / (1e-4 * analyzer.window_energy())) / 500.0;
        }
    }
    let whole_db = decibels(whole.mean_square() / 1e-4);
    println!("bias left: whole {whole_db:.2} dB, bins {error_db:.2} dB");
    assert!(whole_db.abs() < 0.7, "{whole_db}");
    assert!(error_db.abs() < 2.0, "{error_db}");
}

#[test]
fn speech_at_once_is_not_taken_for_noise_and_a_pause_tells() {
    let mut floor = NoiseFloor::of_frames(&NoiseSettings::default(), 0.02, 640).unwrap();
    let mut white = White(9);
    for _ in 0..40 {
        let power = mean_square(&white.frame(0.1));
        floor.observe(&[power]).unwrap();
        assert!(floor.snr_db(power) > 25.0);
    }
    for _ in 0..30 {
        floor.observe(&[mean_square(&white.frame(0.001))]).unwrap();
    }
    assert!(decibels(floor.mean_square() / 1e-6).abs() < 1.5);
    // Two seconds of speech without a pause leave it where it is.
    for _ in 0..100 {
        floor.observe(&[mean_square(&white.frame(0.1))]).unwrap();
    }
    assert!(decibels(floor.mean_square() / 1e-6).abs() < 1.5);
}

#[test]
fn a_louder_noise_is_followed_slowly() {
    let mut floor = NoiseFloor::of_frames(&NoiseSettings::default(), 0.02, 640).unwrap();
    let mut white = White(2);
    let mut last = 0.0;
    for frame in 0..600 {
        let amplitude = if frame < 200 { 0.001 } else { 0.01 };
        floor.observe(&[mean_square(&white.frame(amplitude))]).unwrap();
        if frame > 0 {
            assert!(decibels(floor.mean_square() / last) < 0.21);
        }
        last = floor.mean_square();
    }
    assert!(decibels(last / 1e-4).abs() < 1.0);
}

#[test]
fn silence_bad_values_and_saving_change_nothing() {
    let mut floor = NoiseFloor::of_frames(&NoiseSettings::default(), 0.02, 640).unwrap();
    let mut white = White(1);
    for _ in 0..70 {
        floor.observe(&[mean_square(&white.frame(0.001))]).unwrap();
    }
    let before = floor.clone();
    floor.observe(&[0.0]).unwrap();
    floor.observe(&[f32::NAN]).unwrap();
    assert!(floor.observe(&[1.0, 2.0]).is_err());
    assert_eq!(floor, before);
    let mut restored: NoiseFloor = serde_json::from_str(&serde_json::to_string(&floor).unwrap()).unwrap();
    for _ in 0..200 {
        let power = [mean_square(&white.frame(0.002))];
        floor.observe(&power).unwrap();
        restored.observe(&power).unwrap();
    }
    assert_eq!(floor, restored);
}
