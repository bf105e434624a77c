//! WAV files by an own path: it knows what the header promised, which libav forgets.

use crate::samples::integer;
use hound::{SampleFormat, WavReader};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Samples a channel that one step reads.
const STEP: usize = 2048;

/// Reads interleaved WAV samples into planes.
pub(crate) struct Wav {
    reader: WavReader<BufReader<File>>,
    pub(crate) rate_hz: u32,
    pub(crate) channels: usize,
    /// Samples a channel that the header promises.
    pub(crate) promised: u64,
    frame: Vec<f32>,
}

impl Wav {
    /// Opens a WAV file; `None` where it is none or of a kind that hound leaves to others.
    pub(crate) fn open(location: &str) -> Option<Self> {
        let extension = Path::new(location).extension()?;
        if !extension.eq_ignore_ascii_case("wav") && !extension.eq_ignore_ascii_case("wave") {
            return None;
        }
        let reader = WavReader::open(location).ok()?;
        let spec = reader.spec();
        // A recorder that crashed leaves a length of zero; libav then reads to the end of the file.
        if spec.channels == 0 || spec.sample_rate == 0 || reader.duration() == 0 {
            return None;
        }
        Some(Self {
            rate_hz: spec.sample_rate,
            channels: usize::from(spec.channels),
            promised: u64::from(reader.duration()),
            frame: Vec::with_capacity(usize::from(spec.channels)),
            reader,
        })
    }

    /// Appends the next samples of the channels `selection` to `planes`; `false` at the end.
    pub(crate) fn append(&mut self, selection: &[usize], planes: &mut [Vec<f32>]) -> bool {
        let spec = self.reader.spec();
        match spec.sample_format {
            SampleFormat::Float => {
                let samples = self.reader.samples::<f32>();
                deal(samples, self.channels, &mut self.frame, selection, planes)
            }
            SampleFormat::Int => {
                let bits = u32::from(spec.bits_per_sample).clamp(1, 32) - 1;
                let samples = self
                    .reader
                    .samples::<i32>()
                    .map(|sample| sample.map(|sample| integer(i64::from(sample), bits)));
                deal(samples, self.channels, &mut self.frame, selection, planes)
            }
        }
    }
}

/// Deals whole frames out to planes; a frame cut short is forgotten.
fn deal(
    samples: impl Iterator<Item = hound::Result<f32>>,
    channels: usize,
    frame: &mut Vec<f32>,
    selection: &[usize],
    planes: &mut [Vec<f32>],
) -> bool {
    let mut dealt = 0;
    frame.clear();
    for sample in samples {
        let Ok(sample) = sample else { break };
        frame.push(sample);
        if frame.len() < channels {
            continue;
        }
        for (channel, plane) in selection.iter().zip(planes.iter_mut()) {
            plane.push(frame[*channel]);
        }
        frame.clear();
        dealt += 1;
        if dealt == STEP {
            break;
        }
    }
    dealt > 0
}
