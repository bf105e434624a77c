use super::*;
use hearsight_core::Instant;

const START: Instant = Instant::from_nanoseconds(7_000_000_123);

fn tone(frequency_hz: f64, rate_hz: u32, first: usize, count: usize) -> AudioBlock {
    let sample = |k: usize, phase: f64| {
        (0.5 * (2.0 * PI * frequency_hz * k as f64 / f64::from(rate_hz) + phase).sin()) as f32
    };
    AudioBlock {
        time: START + Span::of_samples(first as i64, rate_hz),
        rate_hz,
        channels: vec![
            (first..first + count).map(|k| sample(k, 0.0)).collect(),
            (first..first + count).map(|k| sample(k, 1.0)).collect(),
        ],
    }
}

#[test]
fn tones_keep_amplitude_and_phase_and_their_exact_time() {
    for rate in [8_000, 16_000, 22_050, 32_000, 44_100, 48_000, 96_000] {
        for frequency in [100.0, 1000.0, 0.44 * f64::from(rate.min(12_000))] {
            let mut resampler = Resampler::new(2, rate, 12_000, Span::ZERO).unwrap();
            let mut output = AudioBlock::default();
            resampler
                .process(&tone(frequency, rate, 0, rate as usize / 4), &mut output)
                .unwrap();
            assert_eq!(output.time, START);
            let expected = tone(frequency, 12_000, 0, output.len());
            let edge = (resampler.latency().seconds() * 12_000.0) as usize + 1;
            assert!(output.len() > 2900 - edge, "{rate} gives {}", output.len());
            for channel in 0..2 {
                for k in edge..output.len() {
                    let error = output.channels[channel][k] - expected.channels[channel][k];
                    assert!(
                        error.abs() < 3e-4,
                        "{rate} Hz, tone {frequency}, sample {k}: {error}"
                    );
                }
            }
        }
    }
}

#[test]
fn what_would_fold_back_is_gone() {
    for frequency in [6_000.0, 6_500.0, 7_500.0, 15_000.0, 23_000.0] {
        let mut resampler = Resampler::new(2, 48_000, 12_000, Span::ZERO).unwrap();
        let mut output = AudioBlock::default();
        resampler
            .process(&tone(frequency, 48_000, 0, 9600), &mut output)
            .unwrap();
        let loudest = output.channels[0][100..]
            .iter()
            .fold(0.0_f32, |most, x| most.max(x.abs()));
        assert!(loudest < 0.5 * 2e-4, "{frequency} Hz leaves {loudest}");
    }
}

#[test]
fn cutting_into_blocks_and_saving_change_nothing() {
    for rate in [16_000, 44_100] {
        let fill = Span::from_seconds(0.1);
        let mut whole = Resampler::new(2, rate, 12_000, fill).unwrap();
        let mut expected = AudioBlock::default();
        whole.process(&tone(700.0, rate, 0, 5000), &mut expected).unwrap();
        let mut pieces = Resampler::new(2, rate, 12_000, fill).unwrap();
        let (mut first, mut count, mut found) = (0, 1, Vec::new());
        while first < 5000 {
            let taken = count.min(5000 - first);
            let mut output = AudioBlock::default();
            pieces
                .process(&tone(700.0, rate, first, taken), &mut output)
                .unwrap();
            assert_eq!(
                output.time,
                expected.time + Span::of_samples(found.len() as i64, 12_000)
            );
            found.extend_from_slice(&output.channels[1]);
            let saved = serde_json::to_string(pieces.state()).unwrap();
            pieces = Resampler::new(2, rate, 12_000, fill).unwrap();
            pieces.restore(serde_json::from_str(&saved).unwrap()).unwrap();
            first += taken;
            count = (count * 7) % 611 + 1;
        }
        assert_eq!(found, expected.channels[1]);
    }
}

#[test]
fn a_long_gap_begins_anew_at_the_time_of_the_block() {
    let mut resampler = Resampler::new(2, 16_000, 12_000, Span::from_seconds(0.1)).unwrap();
    let mut output = AudioBlock::default();
    resampler
        .process(&tone(500.0, 16_000, 0, 1600), &mut output)
        .unwrap();
    resampler
        .process(&tone(500.0, 16_000, 32_000, 1600), &mut output)
        .unwrap();
    assert_eq!(output.time, START + Span::from_seconds(2.0));
    // A short gap keeps the grid.
    let before = output.len() as i64;
    resampler
        .process(&tone(500.0, 16_000, 34_000, 1600), &mut output)
        .unwrap();
    assert_eq!(
        output.time,
        START + Span::from_seconds(2.0) + Span::of_samples(before, 12_000)
    );
}
