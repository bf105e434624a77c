//! What arrays hear in simulated rooms, against what physics says.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use hearsight_core::{AudioBlock, WorldPoint};
use hearsight_sim::acoustics::{
    ArrayRenderer, Clip, DeviceClock, DiffuseNoise, Directivity, Emission, ImpulseResponse, Microphone, Path,
    RenderSettings, Responder, ResponseSettings, Shoebox, ShoeboxSettings, Sound, SoundSource, Walls,
    reverberation_time_s,
};
use nalgebra::Vector3;
use realfft::RealFftPlanner;
use std::f64::consts::TAU;
use std::sync::Arc;

const RATE: u32 = 16_000;

/// A tone for ever.
struct Tone {
    frequency_hz: f64,
}

impl Sound for Tone {
    fn rate_hz(&self) -> u32 {
        RATE
    }

    fn fill(&self, first: i64, samples: &mut [f32]) {
        for (n, sample) in samples.iter_mut().enumerate() {
            let time = (first + n as i64) as f64 / f64::from(RATE);
            *sample = (TAU * (self.frequency_hz * time).fract()).sin() as f32;
        }
    }
}

/// Noise that is the same wherever it is asked for.
struct Noise;

impl Sound for Noise {
    fn rate_hz(&self) -> u32 {
        RATE
    }

    fn fill(&self, first: i64, samples: &mut [f32]) {
        for (n, sample) in samples.iter_mut().enumerate() {
            let mut state = (first + n as i64)
                .cast_unsigned()
                .wrapping_mul(0x9E37_79B9_7F4A_7C15);
            state = (state ^ (state >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            state = (state ^ (state >> 29)).wrapping_mul(0x94D0_49BB_1331_11EB);
            *sample = ((state >> 40) as f32 / (1_u64 << 23) as f32) - 1.0;
        }
    }
}

fn point(place: [f64; 3]) -> WorldPoint {
    WorldPoint::new(place[0], place[1], place[2])
}

fn stands(place: [f64; 3]) -> impl Path + 'static {
    move |_: f64| {
        Some(Emission {
            position: point(place),
            facing: Vector3::x(),
        })
    }
}

fn source(name: &str, path: impl Path + 'static, sound: impl Sound + 'static) -> SoundSource {
    SoundSource {
        name: name.to_owned(),
        path: Arc::new(path),
        sound: Arc::new(sound),
        directivity: Directivity::OMNIDIRECTIONAL,
        level_db: 0.0,
    }
}

fn room(walls: Walls) -> Shoebox {
    Shoebox::new(&ShoeboxSettings::new([6.0, 5.0, 3.0], walls)).unwrap()
}

fn microphones(count: usize, corner_hz: f64) -> Vec<Microphone> {
    vec![
        Microphone {
            corner_hz,
            ..Microphone::default()
        };
        count
    ]
}

/// All channels of the first `samples` samples.
fn render(
    room: &Shoebox,
    sources: Vec<SoundSource>,
    places: &[[f64; 3]],
    settings: &RenderSettings,
    corner_hz: f64,
    samples: usize,
) -> Vec<Vec<f32>> {
    let mut renderer =
        ArrayRenderer::new(room, sources, microphones(places.len(), corner_hz), settings).unwrap();
    let places: Vec<WorldPoint> = places.iter().map(|place| point(*place)).collect();
    let mut block = AudioBlock::default();
    renderer.render(&places, samples, &mut block).unwrap();
    block.channels
}

/// The same second-order Butterworth filter as a microphone's, in its first form.
fn high_pass(corner_hz: f64, samples: &mut [f32]) {
    let (sine, cosine) = (TAU * corner_hz / f64::from(RATE)).sin_cos();
    let alpha = sine / 2.0_f64.sqrt();
    let (mut inputs, mut outputs) = ([0.0; 2], [0.0; 2]);
    for sample in samples {
        let input = f64::from(*sample);
        let output = (0.5 * (1.0 + cosine) * (input - 2.0 * inputs[0] + inputs[1])
            + 2.0 * cosine * outputs[0]
            - (1.0 - alpha) * outputs[1])
            / (1.0 + alpha);
        (inputs, outputs) = ([input, inputs[0]], [output, outputs[0]]);
        *sample = output as f32;
    }
}

/// Power of each bin of a Hann-windowed stretch.
fn powers(samples: &[f32]) -> Vec<f64> {
    let length = samples.len();
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(length);
    let mut windowed: Vec<f64> = samples
        .iter()
        .enumerate()
        .map(|(n, sample)| {
            // Blackman and Harris: leaks less than -92 dB.
            let phase = TAU * n as f64 / length as f64;
            let window = 0.35875 - 0.48829 * phase.cos() + 0.14128 * (2.0 * phase).cos()
                - 0.01168 * (3.0 * phase).cos();
            f64::from(*sample) * window
        })
        .collect();
    let mut spectrum = forward.make_output_vec();
    forward.process(&mut windowed, &mut spectrum).unwrap();
    spectrum.iter().map(|bin| bin.norm_sqr()).collect()
}

/// Delay of the first signal against the second in samples, from the slope of the cross spectrum's phase.
fn delay(first: &[f32], second: &[f32], expected: f64) -> f64 {
    let length = first.len();
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(length);
    let transform = |samples: &[f32]| {
        let mut input: Vec<f64> = samples.iter().map(|sample| f64::from(*sample)).collect();
        let mut output = forward.make_output_vec();
        forward.process(&mut input, &mut output).unwrap();
        output
    };
    let (a, b) = (transform(first), transform(second));
    let (mut product, mut square) = (0.0, 0.0);
    for bin in length / 40..length * 2 / 5 {
        let omega = TAU * bin as f64 / length as f64;
        let cross = a[bin] * b[bin].conj();
        let turned = cross * realfft::num_complex::Complex::from_polar(1.0, omega * expected);
        let weight = cross.norm();
        product += weight * -turned.arg() * omega;
        square += weight * omega * omega;
    }
    expected + product / square
}

#[test]
fn delays_are_those_of_the_distances() {
    let room = room(Walls::Anechoic);
    let places = [
        [3.0, 2.0, 1.0],
        [3.37, 2.1, 1.2],
        [5.9, 4.9, 2.9],
        [1.21, 1.0, 1.5],
    ];
    let from: [f64; 3] = [1.0, 1.0, 1.5];
    let samples = 32_768;
    let channels = render(
        &room,
        vec![source("noise", stands(from), Noise)],
        &places,
        &RenderSettings::new(RATE),
        1.0,
        samples,
    );
    let mut emitted = vec![0.0; samples];
    Noise.fill(0, &mut emitted);
    for (place, channel) in places.iter().zip(&channels) {
        let metres = (0..3)
            .map(|axis| (place[axis] - from[axis]).powi(2))
            .sum::<f64>()
            .sqrt();
        let expected = metres / 343.0 * f64::from(RATE);
        let found = delay(channel, &emitted, expected.round());
        println!("{metres:.3} m: {found:.4} samples of {expected:.4}");
        assert!((found - expected).abs() < 0.02);
        let power = |samples: &[f32]| samples.iter().map(|x| f64::from(x * x)).sum::<f64>();
        let level = (power(&channel[1000..]) / power(&emitted[1000..])).sqrt() * metres;
        assert!((level - 1.0).abs() < 0.03, "1/r: {level}");
    }
}

#[test]
fn a_renderer_hears_the_response_of_the_room() {
    for (walls, limit_db) in [
        (Walls::T60(0.3), -80.0),
        (Walls::BandT60([0.5, 0.45, 0.4, 0.35, 0.3, 0.25]), -45.0),
    ] {
        let db = difference_to_the_response(walls);
        println!("{walls:?}: difference {db:.1} dB");
        assert!(db < limit_db);
    }
}

/// All images are in both: the renderer's early and late parts together are the responder's response.
fn difference_to_the_response(walls: Walls) -> f64 {
    let room = room(walls);
    let (from, to) = ([1.0, 1.2, 1.5], [4.1, 3.3, 1.1]);
    let click = Clip {
        rate_hz: RATE,
        first: 1000,
        samples: vec![1.0],
    };
    let settings = RenderSettings {
        late_per_sample: 1000.0,
        ..RenderSettings::new(RATE)
    };
    let heard = render(
        &room,
        vec![source("click", stands(from), click)],
        &[to],
        &settings,
        1.0,
        6000,
    );
    let response_settings = ResponseSettings {
        rate_hz: RATE,
        length_s: Some(0.29),
        order: None,
    };
    let mut responder = Responder::new(&room, &response_settings).unwrap();
    let mut response = ImpulseResponse::default();
    let emission = Emission {
        position: point(from),
        facing: Vector3::x(),
    };
    responder
        .respond(&emission, Directivity::OMNIDIRECTIONAL, point(to), &mut response)
        .unwrap();
    // The microphone takes away what is below 1 Hz, which in sums of positive reflections is much: from both.
    high_pass(1.0, &mut response.samples);
    let (mut error, mut energy) = (0.0, 0.0);
    for (n, wanted) in response.samples.iter().enumerate() {
        let found = heard[0][1000 + n - response.lead];
        error += f64::from(found - wanted).powi(2);
        energy += f64::from(*wanted).powi(2);
    }
    10.0 * (error / energy).log10()
}

#[test]
fn a_source_that_comes_nearer_sounds_higher() {
    let room = room(Walls::Anechoic);
    let path = |time: f64| {
        let position = WorldPoint::new(1.0 + 2.0 * time.clamp(-0.2, 2.2), 2.0, 1.5);
        Some(Emission {
            position,
            facing: Vector3::x(),
        })
    };
    let tone = Tone { frequency_hz: 1000.0 };
    let channels = render(
        &room,
        vec![source("tone", path, tone)],
        &[[5.9, 2.0, 1.5], [0.2, 2.0, 1.5]],
        &RenderSettings::new(RATE),
        40.0,
        32_000,
    );
    for (channel, speed) in channels.iter().zip([2.0, -2.0]) {
        // Fitted to the phase of the analytic tone: where the highest bin is, between its neighbours.
        let powers = powers(&channel[4000..4000 + 16_384]);
        let highest = (1..powers.len() - 1)
            .max_by(|a, b| powers[*a].total_cmp(&powers[*b]))
            .unwrap();
        let [below, at, above] = [-1, 0, 1].map(|step: i64| powers[(highest as i64 + step) as usize].ln());
        let bin = highest as f64 + 0.5 * (below - above) / (below - 2.0 * at + above);
        let frequency = bin * f64::from(RATE) / 16_384.0;
        let wanted = 1000.0 / (1.0 - speed / 343.0);
        println!("{frequency:.3} Hz of {wanted:.3}");
        assert!((frequency - wanted).abs() < 0.1);
    }
}

#[test]
fn movement_does_not_click() {
    for (walls, limit) in [(Walls::Anechoic, -60.0), (Walls::T60(0.4), -50.0)] {
        let room = room(walls);
        for frequency_hz in [500.0, 2000.0, 6000.0] {
            // Walks a circle and turns.
            let path = |time: f64| {
                let angle = 1.3 * time;
                let position = WorldPoint::new(3.0 + 1.5 * angle.cos(), 2.5 + 1.5 * angle.sin(), 1.6);
                Some(Emission {
                    position,
                    facing: Vector3::new(-angle.sin(), angle.cos(), 0.0),
                })
            };
            let mut tone = source("tone", path, Tone { frequency_hz });
            tone.directivity = Directivity::MOUTH;
            let channel = &render(
                &room,
                vec![tone],
                &[[3.2, 2.4, 1.0]],
                &RenderSettings::new(RATE),
                40.0,
                64_000,
            )[0];
            let mut worst = f64::MIN;
            for stretch in channel[8000..].windows(2048).step_by(512) {
                let powers = powers(stretch);
                let near = |bin: usize| {
                    let away_hz = (bin as f64 * f64::from(RATE) / 2048.0 - frequency_hz).abs();
                    away_hz < 100.0
                };
                let inside: f64 = powers
                    .iter()
                    .enumerate()
                    .filter(|(bin, _)| near(*bin))
                    .map(|(_, p)| p)
                    .sum();
                let outside: f64 = powers
                    .iter()
                    .enumerate()
                    .filter(|(bin, _)| !near(*bin))
                    .map(|(_, p)| p)
                    .sum();
                worst = worst.max(10.0 * (outside / inside).log10());
            }
            println!("{walls:?}, {frequency_hz} Hz: at most {worst:.1} dB beside the tone");
            assert!(worst < limit);
        }
    }
}

#[test]
fn microphones_that_move_do_not_click() {
    let room = room(Walls::T60(0.4));
    let sources = vec![source(
        "tone",
        stands([1.0, 1.0, 1.5]),
        Tone { frequency_hz: 2000.0 },
    )];
    let mut renderer =
        ArrayRenderer::new(&room, sources, microphones(2, 40.0), &RenderSettings::new(RATE)).unwrap();
    let placement = |time: f64, positions: &mut [WorldPoint]| {
        for (number, position) in positions.iter_mut().enumerate() {
            *position = WorldPoint::new(3.0 + 0.5 * time, 2.0 + 0.2 * number as f64, 1.0);
        }
    };
    let mut block = AudioBlock::default();
    renderer.render(&placement, 64_000, &mut block).unwrap();
    for stretch in block.channels[1][8000..].windows(2048).step_by(512) {
        let powers = powers(stretch);
        let near = |bin: usize| (bin as f64 * f64::from(RATE) / 2048.0 - 2000.0).abs() < 100.0;
        let inside: f64 = powers
            .iter()
            .enumerate()
            .filter(|(bin, _)| near(*bin))
            .map(|(_, p)| p)
            .sum();
        let outside: f64 = powers
            .iter()
            .enumerate()
            .filter(|(bin, _)| !near(*bin))
            .map(|(_, p)| p)
            .sum();
        assert!(10.0 * (outside / inside).log10() < -50.0);
    }
}

#[test]
fn mouths_have_a_front_and_a_back() {
    let room = room(Walls::Anechoic);
    for (directivity, wanted_db) in [
        (Directivity::MOUTH, 7.96),
        (Directivity { everywhere: 0.55 }, 20.0),
    ] {
        let mut talker = source("talker", stands([3.0, 2.5, 1.5]), Noise);
        talker.directivity = directivity;
        let channels = render(
            &room,
            vec![talker],
            &[[4.0, 2.5, 1.5], [2.0, 2.5, 1.5]],
            &RenderSettings::new(RATE),
            40.0,
            16_000,
        );
        let power = |samples: &[f32]| samples.iter().map(|x| f64::from(x * x)).sum::<f64>();
        let db = 10.0 * (power(&channels[0]) / power(&channels[1])).log10();
        assert!((db - wanted_db).abs() < 0.1, "{db}");
    }
}

fn meeting() -> (Shoebox, Vec<SoundSource>, RenderSettings) {
    let room = room(Walls::BandT60([0.5, 0.5, 0.45, 0.4, 0.35, 0.3]));
    let walk = |time: f64| {
        let position = WorldPoint::new(1.0 + 0.8 * time.clamp(0.0, 4.0), 1.5, 1.6);
        (time > 0.1).then_some(Emission {
            position,
            facing: Vector3::y(),
        })
    };
    let mut walker = source("walker", walk, Noise);
    walker.directivity = Directivity::MOUTH;
    let fan = source("fan", stands([5.0, 4.5, 0.5]), Noise);
    let mut settings = RenderSettings::new(RATE);
    settings.noise = Some(DiffuseNoise::default());
    settings.clock = DeviceClock {
        offset_s: 0.0123,
        drift_ppm: 35.0,
    };
    (room, vec![walker, fan], settings)
}

fn bytes(threads: usize, blocks: &[usize], total: usize) -> Vec<Vec<u32>> {
    let (room, sources, settings) = meeting();
    let microphones = vec![
        Microphone {
            noise_db: -80.0,
            delay_s: 3e-6,
            ..Microphone::default()
        };
        3
    ];
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| {
        let mut renderer = ArrayRenderer::new(&room, sources, microphones, &settings).unwrap();
        let placement = |time: f64, positions: &mut [WorldPoint]| {
            for (number, position) in positions.iter_mut().enumerate() {
                let angle = 0.5 * time + number as f64;
                *position = WorldPoint::new(3.0 + 0.1 * angle.cos(), 2.5 + 0.1 * angle.sin(), 0.8);
            }
        };
        let (mut all, mut block) = (vec![Vec::new(); 3], AudioBlock::default());
        for samples in blocks.iter().cycle() {
            let samples = *samples.min(&(total - all[0].len()));
            renderer.render(&placement, samples, &mut block).unwrap();
            for (all, channel) in all.iter_mut().zip(&block.channels) {
                assert_eq!(channel.len(), samples);
                all.extend(channel.iter().map(|sample| sample.to_bits()));
            }
            if all[0].len() == total {
                return all;
            }
        }
        all
    })
}

#[test]
fn blocks_and_threads_change_no_bit() {
    let total = 20_000;
    let wanted = bytes(1, &[total], total);
    assert!(
        wanted
            .iter()
            .flatten()
            .any(|bits| f32::from_bits(*bits).abs() > 0.01)
    );
    for (threads, blocks) in [(1, vec![160]), (2, vec![1, 7, 960, 333]), (3, vec![4096])] {
        assert!(
            bytes(threads, &blocks, total) == wanted,
            "{threads} threads, blocks of {blocks:?}"
        );
    }
}

#[test]
fn a_clock_that_drifts_shifts_what_is_heard() {
    let room = room(Walls::Anechoic);
    let hear = |clock: DeviceClock, samples: usize| {
        let settings = RenderSettings {
            clock,
            ..RenderSettings::new(RATE)
        };
        let noise = vec![source("noise", stands([1.0, 1.0, 1.0]), Noise)];
        render(&room, noise, &[[3.0, 2.0, 1.0]], &settings, 100.0, samples)[0].clone()
    };
    let seconds = 20;
    let samples = seconds * RATE as usize;
    let (right, fast) = (
        hear(DeviceClock::default(), samples),
        hear(
            DeviceClock {
                offset_s: 0.0,
                drift_ppm: 100.0,
            },
            samples,
        ),
    );
    // Sample n of a fast clock is taken n * 100 ppm samples early: the same sound comes at a later number.
    let last = samples - 8192;
    let found = delay(&fast[last..], &right[last..], 32.0);
    let wanted = 100e-6 * (last + 4096) as f64;
    println!("{found:.3} of {wanted:.3} samples");
    assert!((found - wanted).abs() < 0.1);
    // An offset of 10 ms: the device begins 160 samples later.
    let late = hear(
        DeviceClock {
            offset_s: 0.01,
            drift_ppm: 0.0,
        },
        8000,
    );
    let difference = (0..7000)
        .map(|n| (late[n + 500] - right[n + 660]).abs())
        .fold(0.0, f32::max);
    assert!(difference < 1e-4, "{difference}");
}

#[test]
fn rendered_reverberation_takes_the_time_wanted() {
    for t60 in [0.3, 0.6, 1.0] {
        let room = room(Walls::T60(t60));
        let click = Clip {
            rate_hz: RATE,
            first: 500,
            samples: vec![1.0],
        };
        let sources = vec![source("click", stands([1.3, 1.1, 1.6]), click)];
        let mut renderer = ArrayRenderer::new(
            &room,
            sources,
            vec![Microphone {
                corner_hz: 100.0,
                ..Microphone::default()
            }],
            &RenderSettings::new(RATE),
        )
        .unwrap();
        let mut block = AudioBlock::default();
        renderer
            .render(
                &vec![point([4.2, 3.4, 1.1])],
                500 + (t60 * 16_000.0) as usize,
                &mut block,
            )
            .unwrap();
        let found = reverberation_time_s(&block.channels[0], RATE).unwrap();
        println!("{found:.3} s of {t60}");
        assert!((found / t60 - 1.0).abs() < 0.1);
    }
}

#[test]
fn what_is_outside_or_unfit_is_refused_by_name() {
    let room = room(Walls::T60(0.3));
    let settings = RenderSettings::new(RATE);
    let make = |source: SoundSource| ArrayRenderer::new(&room, vec![source], microphones(1, 40.0), &settings);
    let mut loud = source("loud", stands([1.0; 3]), Noise);
    loud.level_db = f64::NAN;
    assert!(make(loud).err().unwrap().to_string().contains("\"loud\""));
    let other = source(
        "other",
        stands([1.0; 3]),
        Clip {
            rate_hz: 8000,
            first: 0,
            samples: vec![],
        },
    );
    assert!(
        make(other)
            .err()
            .unwrap()
            .to_string()
            .contains("make the sound at 16000 Hz")
    );
    let mut renderer = make(source("lost", stands([9.0, 1.0, 1.0]), Noise)).unwrap();
    let mut block = AudioBlock::default();
    let error = renderer
        .render(&vec![point([1.0; 3])], 100, &mut block)
        .unwrap_err();
    assert!(error.to_string().contains("source \"lost\""), "{error}");
    let mut renderer = make(source("here", stands([2.0, 1.0, 1.0]), Noise)).unwrap();
    let error = renderer
        .render(&Vec::<WorldPoint>::new(), 100, &mut block)
        .unwrap_err();
    assert!(error.to_string().contains("microphone 0"), "{error}");
    assert!(ArrayRenderer::new(&room, vec![], vec![], &settings).is_err());
    let bad = RenderSettings {
        early_s: f64::INFINITY,
        ..settings.clone()
    };
    assert!(ArrayRenderer::new(&room, vec![], microphones(1, 40.0), &bad).is_err());
}
