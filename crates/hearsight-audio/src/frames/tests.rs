use super::*;
use proptest::prelude::*;

fn block(start: usize, count: usize, rate_hz: u32) -> AudioBlock {
    AudioBlock {
        time: Instant::from_seconds(3.0) + Span::of_samples(start as i64, rate_hz),
        rate_hz,
        channels: vec![
            (start..start + count).map(|k| k as f32).collect(),
            (start..start + count).map(|k| -(k as f32)).collect(),
        ],
    }
}

fn settings(length: usize, hop: usize) -> FrameSettings {
    FrameSettings {
        length,
        hop,
        rate_hz: 44_100,
        channels: 2,
        longest_fill: Span::from_seconds(0.1),
    }
}

fn collect(framer: &mut Framer, block: &AudioBlock) -> Vec<(u64, Instant, usize, Vec<Vec<f32>>)> {
    let mut frames = Vec::new();
    framer
        .push(block, |frame| {
            frames.push((frame.number, frame.start, frame.filled, frame.channels.to_vec()))
        })
        .unwrap();
    frames
}

proptest! {
    #[test]
    fn frames_do_not_depend_on_how_blocks_are_cut(
        length in 1usize..40,
        hop_share in 0.01f64..1.0,
        cuts in prop::collection::vec(1usize..60, 1..12),
    ) {
        let hop = ((length as f64 * hop_share) as usize).clamp(1, length);
        let total: usize = cuts.iter().sum();
        let mut whole = Framer::new(settings(length, hop)).unwrap();
        let expected = collect(&mut whole, &block(0, total, 44_100));
        let mut pieces = Framer::new(settings(length, hop)).unwrap();
        let mut start = 0;
        let mut found = Vec::new();
        for count in cuts {
            found.extend(collect(&mut pieces, &block(start, count, 44_100)));
            start += count;
            // A saved run goes on with the same bytes.
            let saved = serde_json::to_string(&pieces).unwrap();
            pieces = serde_json::from_str(&saved).unwrap();
        }
        prop_assert_eq!(&found, &expected);
        for (number, start, filled, channels) in expected {
            prop_assert_eq!(start, block(number as usize * hop, 1, 44_100).time);
            prop_assert_eq!(filled, 0);
            prop_assert_eq!(channels[0][0], (number as usize * hop) as f32);
        }
    }
}

#[test]
fn a_short_gap_is_zero_and_a_long_one_begins_anew() {
    let mut framer = Framer::new(settings(100, 50)).unwrap();
    collect(&mut framer, &block(0, 120, 44_100));
    let frames = collect(&mut framer, &block(180, 100, 44_100));
    assert_eq!(frames[0].2, 30);
    assert_eq!(frames[0].3[0][69], 119.0);
    assert_eq!(frames[0].3[0][70], 0.0);
    assert_eq!(frames[1].2, 60);
    assert_eq!(frames[1].3[1][80], -180.0);
    assert_eq!(framer.filled(), 60);
    let frames = collect(&mut framer, &block(88_200, 100, 44_100));
    assert_eq!(frames[0].1, block(88_200, 1, 44_100).time);
    assert_eq!((frames[0].2, framer.restarts()), (0, 1));
}

#[test]
fn samples_that_are_not_numbers_become_zero_and_are_counted() {
    let mut framer = Framer::new(settings(4, 4)).unwrap();
    let mut data = block(1, 4, 44_100);
    data.channels[0][2] = f32::NAN;
    data.channels[1][0] = f32::INFINITY;
    let frames = collect(&mut framer, &data);
    assert_eq!(
        frames[0].3,
        vec![vec![1.0, 2.0, 0.0, 4.0], vec![0.0, -2.0, -3.0, -4.0]]
    );
    assert_eq!(framer.non_finite(), 2);
}

#[test]
fn a_block_of_another_shape_is_refused() {
    let mut framer = Framer::new(settings(4, 2)).unwrap();
    let mut data = block(0, 4, 44_100);
    data.channels[1].pop();
    assert!(framer.push(&data, |_| ()).is_err());
    assert!(framer.push(&block(0, 4, 48_000), |_| ()).is_err());
    assert!(Framer::new(settings(4, 5)).is_err());
}
