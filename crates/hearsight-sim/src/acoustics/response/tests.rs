//! Responses are sums of kernels and decay as asked.

use super::*;
use crate::acoustics::bands;
use crate::acoustics::decay::reverberation_time_s;
use crate::acoustics::kernel::kernel;
use crate::acoustics::room::{ShoeboxSettings, Walls};
use nalgebra::Vector3;

fn at(x: f64, y: f64, z: f64) -> Emission {
    Emission {
        position: WorldPoint::new(x, y, z),
        facing: Vector3::x(),
    }
}

fn response(
    room: &Shoebox,
    settings: &ResponseSettings,
    source: &Emission,
    ear: WorldPoint,
) -> ImpulseResponse {
    let mut response = ImpulseResponse::default();
    let mut responder = Responder::new(room, settings).unwrap();
    responder
        .respond(source, Directivity::OMNIDIRECTIONAL, ear, &mut response)
        .unwrap();
    response
}

#[test]
fn a_response_is_the_sum_of_kernels() {
    let settings = ShoeboxSettings::new([4.0, 3.0, 2.5], Walls::T60(0.3));
    let room = Shoebox::new(&settings).unwrap();
    let wanted_settings = ResponseSettings {
        rate_hz: 16_000,
        length_s: Some(0.08),
        order: None,
    };
    let (source, ear) = (at(1.0, 1.2, 1.5), WorldPoint::new(2.9, 2.0, 1.1));
    let found = response(&room, &wanted_settings, &source, ear);
    let reach = Reach {
        distance_m: 60.0,
        order: u32::MAX,
        density_per_m: f64::INFINITY,
    };
    let lattice = Lattice::new(&room, &reach);
    let mut wanted = vec![0.0; found.samples.len()];
    let mut write = |place: [f64; 3], gain: f64| {
        let distance = (0..3)
            .map(|axis| (place[axis] - ear.0[axis]).powi(2))
            .sum::<f64>()
            .sqrt();
        let middle = found.lead as f64 + distance / 343.0 * 16_000.0;
        for (sample, wanted) in wanted.iter_mut().enumerate() {
            *wanted += gain / distance * kernel(sample as f64 - middle);
        }
    };
    write([1.0, 1.2, 1.5], 1.0);
    for mirror in &lattice.mirrors {
        for image in 0..mirror.offset_m[0].len() {
            let source = [1.0, 1.2, 1.5];
            let place = [0, 1, 2].map(|axis| mirror.sign[axis] * source[axis] + mirror.offset_m[axis][image]);
            write(place, f64::from(mirror.gain[0][image]));
        }
    }
    let energy: f64 = wanted.iter().map(|sample| sample * sample).sum();
    let error: f64 = wanted
        .iter()
        .zip(&found.samples)
        .map(|(wanted, found)| (wanted - f64::from(*found)).powi(2))
        .sum();
    let db = 10.0 * (error / energy).log10();
    println!("{db:.1} dB");
    assert!(db < -85.0, "{db}");
}

/// Takes away what is below 100 Hz: a first difference twice would colour, a slow mean does not.
fn high_pass(samples: &[f32], rate_hz: u32) -> Vec<f32> {
    let omega = 2.0 * PI * 100.0 / f64::from(rate_hz);
    let (sine, cosine) = omega.sin_cos();
    let alpha = sine / 2.0_f64.sqrt();
    let (b, a0, a1, a2) = (0.5 * (1.0 + cosine), 1.0 + alpha, -2.0 * cosine, 1.0 - alpha);
    let (mut x1, mut x2, mut y1, mut y2) = (0.0, 0.0, 0.0, 0.0);
    samples
        .iter()
        .map(|sample| {
            let x = f64::from(*sample);
            let y = (b * (x - 2.0 * x1 + x2) - a1 * y1 - a2 * y2) / a0;
            (x2, x1, y2, y1) = (x1, x, y1, y);
            y as f32
        })
        .collect()
}

#[test]
fn responses_decay_in_the_time_wanted() {
    let rooms = [[6.0, 5.0, 3.0], [4.0, 3.0, 2.5], [9.0, 6.0, 3.2]];
    let mut worst: f64 = 0.0;
    for size in rooms {
        for t60 in [0.2, 0.35, 0.5, 0.8, 1.2] {
            let room = Shoebox::new(&ShoeboxSettings::new(size, Walls::T60(t60))).unwrap();
            let settings = ResponseSettings {
                rate_hz: 16_000,
                length_s: None,
                order: None,
            };
            let ear = WorldPoint::new(size[0] * 0.71, size[1] * 0.64, 1.3);
            let found = response(&room, &settings, &at(size[0] * 0.22, size[1] * 0.31, 1.6), ear);
            let time = reverberation_time_s(&high_pass(&found.samples, 16_000), 16_000).unwrap();
            let raw = reverberation_time_s(&found.samples, 16_000).unwrap();
            println!("{size:?} {t60}: {time:.3} s, with what is below 100 Hz {raw:.3} s");
            worst = worst.max((time / t60 - 1.0).abs());
        }
    }
    println!("worst {worst:.3}");
    assert!(worst < 0.1);
}

#[test]
fn bands_decay_in_their_own_times() {
    let wanted = [0.7, 0.65, 0.55, 0.5, 0.4, 0.3];
    let room = Shoebox::new(&ShoeboxSettings::new([6.0, 5.0, 3.0], Walls::BandT60(wanted))).unwrap();
    let settings = ResponseSettings {
        rate_hz: 16_000,
        length_s: None,
        order: None,
    };
    let found = response(
        &room,
        &settings,
        &at(1.5, 1.6, 1.6),
        WorldPoint::new(4.3, 3.4, 1.2),
    );
    for (band, taps) in bands::filters(16_000).iter().enumerate().skip(1) {
        let mut filtered = vec![0.0; found.samples.len() - taps.len() + 1];
        crate::acoustics::kernel::correlate_into(&found.samples, taps, &mut filtered);
        let time = reverberation_time_s(&filtered, 16_000).unwrap();
        println!("band {band}: {time:.3} s of {}", wanted[band]);
        // Bands are not sharp: slower neighbours are heard in them.
        assert!((time / wanted[band] - 1.0).abs() < 0.2);
    }
}

#[test]
fn impossible_responses_are_refused() {
    let room = Shoebox::new(&ShoeboxSettings::new([2.0, 2.0, 2.0], Walls::T60(1.0))).unwrap();
    let settings = ResponseSettings {
        rate_hz: 16_000,
        length_s: Some(9.0),
        order: None,
    };
    assert!(
        Responder::new(&room, &settings)
            .err()
            .unwrap()
            .to_string()
            .contains("50 million")
    );
    let settings = ResponseSettings {
        rate_hz: 16_000,
        length_s: Some(0.1),
        order: Some(3),
    };
    let mut responder = Responder::new(&room, &settings).unwrap();
    let mut response = ImpulseResponse::default();
    let ear = WorldPoint::new(1.0, 1.0, 3.0);
    let error = responder
        .respond(&at(1.0, 1.0, 1.0), Directivity::CARDIOID, ear, &mut response)
        .unwrap_err();
    assert!(error.to_string().contains("the microphone"), "{error}");
}
