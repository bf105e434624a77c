//! WAV files, through the reader of sound files.

use super::{Target, Verdict};
use hearsight_core::AudioBlock;
use hearsight_core::source::{AudioSource, Delivery};
use hearsight_media::{AudioFile, AudioOptions};

pub(super) const TARGET: Target = Target {
    name: "wav",
    meaning: "A WAV file; blocks that are read have all channels, equally long, with finite samples.",
    text: false,
    words: &[],
    longest: 4 << 10,
    seeds: || {
        let samples: Vec<f64> = (0..120).map(|at| (f64::from(at) * 0.37).sin()).collect();
        vec![
            wav(
                1,
                2,
                16,
                |value, bytes| bytes.extend(((value * 32767.0) as i16).to_le_bytes()),
                &samples,
            ),
            wav(
                1,
                1,
                8,
                |value, bytes| bytes.push((128.0 + value * 127.0) as u8),
                &samples,
            ),
            wav(
                1,
                3,
                24,
                |value, bytes| bytes.extend(&((value * 8e6) as i32).to_le_bytes()[..3]),
                &samples,
            ),
            wav(
                3,
                2,
                32,
                |value, bytes| bytes.extend((value as f32).to_le_bytes()),
                &samples,
            ),
            wav(
                3,
                1,
                64,
                |value, bytes| bytes.extend(value.to_le_bytes()),
                &samples,
            ),
        ]
    },
    open: || {
        let directory = tempfile::tempdir();
        Box::new(move |bytes| {
            let Ok(directory) = &directory else {
                return Verdict::Refused("no directory".to_owned());
            };
            let path = directory.path().join("a.wav");
            if std::fs::write(&path, bytes).is_err() {
                return Verdict::Refused("not written".to_owned());
            }
            match AudioFile::open(&path, AudioOptions::default()) {
                Ok(file) => read(file),
                Err(error) => Verdict::Refused(error.to_string()),
            }
        })
    },
};

fn read(mut file: AudioFile) -> Verdict {
    let (mut block, mut faults, mut samples) = (AudioBlock::default(), Vec::new(), 0);
    let channels = file.format().channels;
    while file.read(&mut block, &mut faults) == Delivery::Data {
        let lengths_agree = block.channels.iter().all(|channel| channel.len() == block.len());
        if block.channels.len() != channels || !lengths_agree || block.is_empty() {
            return Verdict::Broken(format!(
                "a block of {} of {channels} channels",
                block.channels.len()
            ));
        }
        if block.channels.iter().flatten().any(|sample| !sample.is_finite()) {
            return Verdict::Broken("a sample is not finite".to_owned());
        }
        samples += block.len();
    }
    let kinds: Vec<_> = faults.iter().map(|fault| fault.kind).collect();
    Verdict::Read(format!(
        "{} channels, {} bits of samples, {kinds:?}",
        channels.min(9),
        samples.max(1).ilog2()
    ))
}

fn wav(format: u16, channels: u16, bits: u16, write: impl Fn(f64, &mut Vec<u8>), samples: &[f64]) -> Vec<u8> {
    let mut data = Vec::new();
    for &sample in samples {
        write(sample, &mut data);
    }
    let (rate, frame) = (8000_u32, channels * bits / 8);
    let mut bytes = Vec::new();
    bytes.extend(b"RIFF");
    bytes.extend((36 + data.len() as u32).to_le_bytes());
    bytes.extend(b"WAVEfmt ");
    bytes.extend(16_u32.to_le_bytes());
    bytes.extend(format.to_le_bytes());
    bytes.extend(channels.to_le_bytes());
    bytes.extend(rate.to_le_bytes());
    bytes.extend((rate * u32::from(frame)).to_le_bytes());
    bytes.extend(frame.to_le_bytes());
    bytes.extend(bits.to_le_bytes());
    bytes.extend(b"data");
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(data);
    bytes
}
