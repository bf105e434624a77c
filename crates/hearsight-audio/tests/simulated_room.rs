//! Delays, onsets and voice activity on two microphones 0.95 m apart, in a simulated room (T60 0.25 s) where two people
//! of sequence 30 of AV16.3 walk and speak in turn. Prints its tables; skipped where the data are missing.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use hearsight_audio::activity::{ActivityDetector, ActivitySettings};
use hearsight_audio::agreement::{Agreement, AgreementSettings};
use hearsight_audio::bands::{BandBank, BandShape, THREE_BANDS};
use hearsight_audio::correlation::{Correlator, CorrelatorSettings, Normalization};
use hearsight_audio::curve::CorrelationCurve;
use hearsight_audio::frames::{FrameSettings, Framer};
use hearsight_audio::levels::LevelMeter;
use hearsight_audio::noise::{NoiseFloor, NoiseSettings, mean_square};
use hearsight_audio::onset::{OnsetFilter, OnsetSettings};
use hearsight_audio::resample::Resampler;
use hearsight_audio::spectrum::{Spectra, SpectrumAnalyzer, Window, power_into, transform_length};
use hearsight_audio::weighting::{PairNoise, Weighting};
use hearsight_core::{AudioBlock, Instant, Span};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

const SPEED_M_S: f64 = 343.0;
const START_S: f64 = 11.0;

struct Room {
    sound: AudioBlock,
    /// Metres between the microphones.
    distance_m: f64,
    /// For each tick its time, and the true delay of who speaks, if somebody does.
    ticks: Vec<(f64, Option<f64>)>,
    /// From when to when somebody speaks, in seconds.
    turns: Vec<[f64; 2]>,
}

fn folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/av16.3-seq30/arrays");
    if folder.join("stac_cam1.wav").exists() {
        return Some(folder);
    }
    println!("skipped: no data at {}", folder.display());
    None
}

fn load() -> Option<Room> {
    let folder = folder()?;
    let mut reader = hound::WavReader::open(folder.join("stac_cam1.wav")).unwrap();
    assert_eq!((reader.spec().channels, reader.spec().bits_per_sample), (2, 16));
    let samples: Vec<f32> = reader
        .samples::<i16>()
        .map(|sample| f32::from(sample.unwrap()) / 32_768.0)
        .collect();
    let sound = AudioBlock {
        time: Instant::from_seconds(START_S),
        rate_hz: reader.spec().sample_rate,
        channels: (0..2)
            .map(|channel| samples.iter().skip(channel).step_by(2).copied().collect())
            .collect(),
    };
    let arrays: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("arrays.json")).unwrap()).unwrap();
    let microphones: Vec<Vec<f64>> = serde_json::from_value(arrays["arrays_m"]["stac_cam1"].clone()).unwrap();
    let away = |from: &[f64], to: &[f64]| {
        from.iter()
            .zip(to)
            .map(|(a, b)| (a - b) * (a - b))
            .sum::<f64>()
            .sqrt()
    };
    let mut ticks: Vec<(f64, Option<f64>)> = Vec::new();
    for line in std::fs::read_to_string(folder.join("truth.csv"))
        .unwrap()
        .lines()
        .skip(1)
    {
        let row: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        if ticks.last().is_none_or(|last| last.0 != row[0]) {
            ticks.push((row[0], None));
        }
        if row[5] > 0.0 {
            let path = away(&row[2..5], &microphones[0]) - away(&row[2..5], &microphones[1]);
            ticks.last_mut().unwrap().1 = Some(path / SPEED_M_S);
        }
    }
    let turn = |line: &str| {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let (start, length): (f64, f64) = (fields[3].parse().unwrap(), fields[4].parse().unwrap());
        [start, start + length]
    };
    let turns = std::fs::read_to_string(folder.join("speech.rttm"))
        .unwrap()
        .lines()
        .map(turn)
        .collect();
    Some(Room {
        sound,
        distance_m: away(&microphones[0], &microphones[1]),
        ticks,
        turns,
    })
}

/// What is done with a frame.
#[derive(Clone, Copy)]
enum Method {
    Plain(Weighting, Normalization),
    Bands(Weighting, Normalization, BandShape, AgreementSettings),
}

/// How a stream is framed.
#[derive(Clone, Copy)]
struct Framing {
    frame_s: f64,
    hop_s: f64,
}

impl Framing {
    fn settings(self, rate_hz: u32) -> FrameSettings {
        let samples = |seconds: f64| (seconds * f64::from(rate_hz)).round() as usize;
        FrameSettings {
            length: samples(self.frame_s),
            hop: samples(self.hop_s),
            ..FrameSettings::half_overlapping(self.frame_s, rate_hz, 2)
        }
    }
}

/// For each frame the signal-to-noise ratio in decibels of both channels.
fn ratios(room: &Room, framing: Framing) -> Vec<[f32; 2]> {
    let settings = framing.settings(room.sound.rate_hz);
    let floor = |_| NoiseFloor::of_frames(&NoiseSettings::default(), framing.hop_s, settings.length).unwrap();
    let mut floors = [0, 1].map(floor);
    let mut ratios = Vec::new();
    Framer::new(settings)
        .unwrap()
        .push(&room.sound, |frame| {
            ratios.push([0, 1].map(|channel| {
                let loudness = mean_square(&frame.channels[channel]);
                floors[channel].observe(&[loudness]).unwrap();
                floors[channel].snr_db(loudness)
            }));
        })
        .unwrap();
    ratios
}

struct Outcome {
    spoken: usize,
    errors_s: Vec<f64>,
    errors_degrees: Vec<f64>,
}

/// The errors of the highest peak in the chosen frames while somebody speaks, sorted.
fn localize(room: &Room, method: Method, chosen: &[bool], framing: Framing) -> Outcome {
    let (rate, weighting, normalization) = match method {
        Method::Plain(weighting, normalization) => (room.sound.rate_hz, weighting, normalization),
        Method::Bands(weighting, normalization, ..) => (12_000, weighting, normalization),
    };
    let mut sound = AudioBlock::default();
    let mut resampler = Resampler::new(2, room.sound.rate_hz, rate, Span::ZERO).unwrap();
    resampler.process(&room.sound, &mut sound).unwrap();
    let settings = framing.settings(rate);
    let max_delay_s = room.distance_m / SPEED_M_S;
    let padded = transform_length(settings.length, max_delay_s, rate);
    let mut analyzer = SpectrumAnalyzer::new(settings.length, padded, Window::Hann).unwrap();
    let correlation = CorrelatorSettings {
        weighting,
        normalization,
        ..CorrelatorSettings::new(padded, rate, max_delay_s)
    };
    let mut correlator = Correlator::new(correlation).unwrap();
    let floor = |_| {
        let settings = NoiseSettings::default();
        NoiseFloor::of_spectra(
            &settings,
            framing.hop_s,
            analyzer.bins(),
            analyzer.window_energy(),
        )
        .unwrap()
    };
    let mut floors = [0, 1].map(floor);
    let mut bands = match method {
        Method::Plain(..) => None,
        Method::Bands(_, _, shape, agreement) => Some((
            BandBank::new(&THREE_BANDS, shape, rate, padded).unwrap(),
            Agreement::new(agreement).unwrap(),
        )),
    };
    let (mut spectra, mut power, mut curve) = (Spectra::default(), Vec::new(), CorrelationCurve::default());
    let mut outcome = Outcome {
        spoken: 0,
        errors_s: Vec::new(),
        errors_degrees: Vec::new(),
    };
    let angle = |delay_s: f64| (delay_s / max_delay_s).clamp(-1.0, 1.0).asin().to_degrees();
    Framer::new(settings)
        .unwrap()
        .push(&sound, |frame| {
            analyzer.transform_all(frame.channels, &mut spectra).unwrap();
            for (floor, spectrum) in floors.iter_mut().zip(&spectra.channels) {
                power_into(spectrum, &mut power);
                floor.observe(&power).unwrap();
            }
            let tick = ((frame.middle().seconds() - room.ticks[0].0) / 0.04).round();
            if tick < 0.0 || tick >= room.ticks.len() as f64 {
                return;
            }
            let Some(truth_s) = room.ticks[tick as usize].1 else {
                return;
            };
            outcome.spoken += 1;
            if !chosen.get(frame.number as usize).is_some_and(|&chosen| chosen) {
                return;
            }
            let [first, second] = [&spectra.channels[0], &spectra.channels[1]];
            let noise = Some(PairNoise {
                first: floors[0].power(),
                second: floors[1].power(),
                cross: None,
            });
            match &mut bands {
                None => correlator
                    .correlate(first, second, noise, None, &mut curve)
                    .unwrap(),
                Some((bank, agreement)) => {
                    bank.correlate(&mut correlator, first, second, noise).unwrap();
                    agreement.combine(bank, &mut curve).unwrap();
                }
            }
            let found_s = curve.peak().map_or(0.0, |peak| peak.delay_s);
            outcome.errors_s.push((found_s - truth_s).abs());
            outcome
                .errors_degrees
                .push((angle(found_s) - angle(truth_s)).abs());
        })
        .unwrap();
    outcome.errors_s.sort_by(f64::total_cmp);
    outcome.errors_degrees.sort_by(f64::total_cmp);
    outcome
}

fn median(sorted: &[f64]) -> f64 {
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn report(room: &Room, name: &str, method: Method, chosen: &[bool], framing: Framing) -> Outcome {
    let outcome = localize(room, method, chosen, framing);
    let good = outcome
        .errors_degrees
        .iter()
        .filter(|&&error| error < 5.0)
        .count();
    println!(
        "{name:24} {:3.0} ms {:4}/{:4} | samples {:5.2} {:5.2} | degrees {:5.2} {:5.2} | within 5: {:4.1} %",
        1e3 * framing.frame_s,
        outcome.errors_s.len(),
        outcome.spoken,
        16_000.0 * median(&outcome.errors_s),
        16_000.0 * mean(&outcome.errors_s),
        median(&outcome.errors_degrees),
        mean(&outcome.errors_degrees),
        100.0 * good as f64 / outcome.errors_s.len().max(1) as f64,
    );
    outcome
}

/// Adds a sound of 1 to 1.3 kHz from a fixed direction, heard by both microphones, and white noise of each; both given
/// by their root mean square.
fn disturb(room: &mut Room, hum: f64, white: f64) {
    let mut state = 77_u64;
    let mut uniform = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 24)
    };
    let tones: Vec<(f64, f64)> = (0..60)
        .map(|_| (1000.0 + 300.0 * uniform(), TAU * uniform()))
        .collect();
    let amplitude = hum * (2.0 / tones.len() as f64).sqrt();
    for (channel, delay_s) in [(0, 0.0), (1, 0.0017)] {
        for (k, sample) in room.sound.channels[channel].iter_mut().enumerate() {
            let time = k as f64 / 16_000.0 - delay_s;
            let sum: f64 = tones
                .iter()
                .map(|(hertz, phase)| (TAU * hertz * time + phase).sin())
                .sum();
            let noise: f64 = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
            *sample += (amplitude * sum + white * noise) as f32;
        }
    }
}

/// Prints how each method does for each length of frames, and returns the median errors in seconds of the phase transform
/// on all frames and of bands on onsets.
fn table(room: &Room, lengths_s: &[f64]) -> Vec<[f64; 2]> {
    let magnitude = Normalization::Magnitude;
    let regular = Weighting::NoiseRegularized { gamma: 0.3 };
    let bands = |weighting| {
        Method::Bands(
            weighting,
            magnitude,
            BandShape::default(),
            AgreementSettings::default(),
        )
    };
    let sum = AgreementSettings {
        floor: 1.0,
        ..AgreementSettings::default()
    };
    let mut medians = Vec::new();
    for &frame_s in lengths_s {
        let framing = Framing { frame_s, hop_s: 0.02 };
        let ratios = ratios(room, framing);
        let all = vec![true; ratios.len()];
        let onsets = onsets(&ratios);
        let run = |name, method, chosen: &[bool]| report(room, name, method, chosen, framing);
        let plain = run("phase transform", Method::Plain(Weighting::Phat, magnitude), &all);
        run("  onsets", Method::Plain(Weighting::Phat, magnitude), &onsets);
        run("noise-regularized", Method::Plain(regular, magnitude), &all);
        run("  onsets", Method::Plain(regular, magnitude), &onsets);
        run("bands", bands(regular), &all);
        let best = run("  onsets", bands(regular), &onsets);
        run(
            "  onsets, sum alone",
            Method::Bands(regular, magnitude, BandShape::Bins, sum),
            &onsets,
        );
        run(
            "  onsets, filter shape",
            Method::Bands(
                regular,
                magnitude,
                BandShape::Filter,
                AgreementSettings::default(),
            ),
            &onsets,
        );
        run("  onsets, phase transform", bands(Weighting::Phat), &onsets);
        medians.push([median(&plain.errors_s), median(&best.errors_s)]);
    }
    medians
}

fn onsets(ratios: &[[f32; 2]]) -> Vec<bool> {
    let mut filter = OnsetFilter::new(OnsetSettings::default()).unwrap();
    ratios
        .iter()
        .map(|pair| filter.classify(pair).is_onset())
        .collect()
}

#[test]
fn delays() {
    let Some(room) = load() else { return };
    for [plain, best] in table(&room, &[0.064, 0.128]) {
        assert!(best < 0.8 * plain, "median errors {best} s and {plain} s");
    }
}

#[test]
#[ignore = "takes a minute: every length of frames, also with a hum and with noise"]
fn delays_at_length() {
    let lengths_s = [0.04, 0.064, 0.128, 0.256];
    for (title, hum, white) in [
        ("as recorded", 0.0, 0.0),
        ("with a hum of 1 to 1.3 kHz from the side", 0.01, 0.0),
        ("with white noise", 0.0, 0.01),
    ] {
        let Some(mut room) = load() else { return };
        println!("{title}");
        disturb(&mut room, hum, white);
        table(&room, &lengths_s);
    }
}

#[test]
fn activity() {
    let Some(room) = load() else { return };
    let plain = ActivitySettings::default();
    let short = ActivitySettings {
        hangover_s: 0.0,
        ..plain
    };
    for (frame_s, hop_s, settings) in [
        (0.04, 0.02, plain),
        (0.04, 0.02, short),
        (0.064, 0.032, plain),
        (0.04, 0.04, plain),
        (0.128, 0.02, plain),
    ] {
        let mut detector = ActivityDetector::new(settings).unwrap();
        let (mut counts, mut loss) = ([[0_usize; 2]; 2], 0.0);
        for (number, pair) in ratios(&room, Framing { frame_s, hop_s }).iter().enumerate() {
            let activity = detector.observe(0.5 * (pair[0] + pair[1]), hop_s);
            let middle_s = START_S + number as f64 * hop_s + 0.5 * frame_s;
            let truth = room
                .turns
                .iter()
                .any(|turn| (turn[0]..turn[1]).contains(&middle_s));
            counts[usize::from(truth)][usize::from(activity.active)] += 1;
            loss -= f64::from(if truth {
                activity.probability
            } else {
                1.0 - activity.probability
            })
            .ln();
        }
        let [[rest, alarm], [miss, hit]] = counts;
        let share = |part: usize, whole: usize| 100.0 * part as f64 / whole as f64;
        let total = rest + alarm + miss + hit;
        println!(
            "frames of {frame_s} s each {hop_s} s, hangover {} s: speech found {:.1} %, false alarms {:.1} % of {} quiet frames, right {:.1} %, log loss {:.3}",
            settings.hangover_s,
            share(hit, hit + miss),
            share(alarm, alarm + rest),
            alarm + rest,
            share(hit + rest, total),
            loss / total as f64,
        );
        assert!(share(hit + rest, total) > 80.0);
    }
}

#[test]
fn levels() {
    let Some(mut room) = load() else { return };
    for inverted in [false, true] {
        let mut meter = LevelMeter::new(2, 16_000, room.distance_m / SPEED_M_S).unwrap();
        meter.observe(&room.sound).unwrap();
        println!("{:?}\n{:?}", meter.channels(), meter.pairs());
        assert_eq!(meter.pairs()[0].inverted, inverted);
        room.sound.channels[1]
            .iter_mut()
            .for_each(|sample| *sample = -*sample);
    }
}
