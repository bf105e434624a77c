//! Impulse responses against those of pyroomacoustics (`goldens/make_responses.py`).

use hearsight_core::WorldPoint;
use hearsight_sim::acoustics::{
    Directivity, Emission, ImpulseResponse, Responder, ResponseSettings, Shoebox, ShoeboxSettings, Walls,
};
use nalgebra::Vector3;

#[test]
fn responses_are_those_of_pyroomacoustics() {
    let goldens: serde_json::Value = serde_json::from_str(include_str!("goldens/responses.json")).unwrap();
    let cases = goldens["cases"].as_array().unwrap();
    assert!(cases.len() >= 3);
    for case in cases {
        let numbers = |key: &str| -> Vec<f64> { serde_json::from_value(case[key].clone()).unwrap() };
        let point = |key: &str| {
            let place = numbers(key);
            WorldPoint::new(place[0], place[1], place[2])
        };
        let walls = Walls::Absorption(numbers("absorption").try_into().unwrap());
        let size_m = numbers("size_m").try_into().unwrap();
        let room = Shoebox::new(&ShoeboxSettings {
            jitter_m: 0.0,
            ..ShoeboxSettings::new(size_m, walls)
        })
        .unwrap();
        let wanted = numbers("samples");
        let lead = case["lead"].as_u64().unwrap() as usize;
        let rate_hz = case["rate_hz"].as_u64().unwrap() as u32;
        let settings = ResponseSettings {
            rate_hz,
            length_s: Some((wanted.len() - lead) as f64 / f64::from(rate_hz)),
            order: Some(case["order"].as_u64().unwrap() as u32),
        };
        let azimuth = case["azimuth_degrees"].as_f64().unwrap_or(0.0).to_radians();
        let source = Emission {
            position: point("source_m"),
            facing: Vector3::new(azimuth.cos(), azimuth.sin(), 0.0),
        };
        let directivity = Directivity {
            everywhere: case["everywhere"].as_f64().unwrap(),
        };
        let mut found = ImpulseResponse::default();
        let mut responder = Responder::new(&room, &settings).unwrap();
        responder
            .respond(&source, directivity, point("microphone_m"), &mut found)
            .unwrap();
        assert_eq!((found.lead, found.samples.len()), (lead, wanted.len()));
        let (mut error, mut energy) = (0.0, 0.0);
        for (found, wanted) in found.samples.iter().zip(&wanted) {
            error += (f64::from(*found) - wanted).powi(2);
            energy += wanted * wanted;
        }
        let db = 10.0 * (error / energy).log10();
        println!("{}: difference {db:.1} dB", case["name"]);
        assert!(db < -45.0);
    }
}
