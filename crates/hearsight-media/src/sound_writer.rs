//! Sound files: any number of channels to WAV.

use crate::error::EncodeError;
use hound::{SampleFormat, WavSpec, WavWriter};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// The bytes of sound that a WAV file holds: its header counts them in 32 bits.
const LARGEST_BYTES: u64 = u32::MAX as u64 - 1024;
/// Full scale of 24 bits.
const FULL_SCALE: f32 = 8_388_607.0;

/// How samples are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SampleForm {
    /// 32-bit floating point, which keeps every bit.
    #[default]
    Float32,
    /// 24-bit integers; beyond full scale is cut.
    Integer24,
}

/// Writes channels of equal length as one WAV file. [`SoundWriter::finish`] completes the header; dropping the writer
/// tries to.
pub struct SoundWriter {
    writer: Option<WavWriter<BufWriter<File>>>,
    path: String,
    channels: usize,
    form: SampleForm,
    bytes: u64,
}

impl SoundWriter {
    /// Creates the file, replacing one that is there.
    ///
    /// # Errors
    /// Says that the file cannot be created.
    pub fn create(
        path: impl AsRef<Path>,
        channels: usize,
        rate_hz: u32,
        form: SampleForm,
    ) -> Result<Self, EncodeError> {
        let shown = path.as_ref().to_string_lossy().into_owned();
        let unwritable = |reason: String| EncodeError::Unwritable {
            path: shown.clone(),
            reason,
        };
        let count =
            u16::try_from(channels).map_err(|_| unwritable(format!("{channels} channels are too many")))?;
        let (bits_per_sample, sample_format) = match form {
            SampleForm::Float32 => (32, SampleFormat::Float),
            SampleForm::Integer24 => (24, SampleFormat::Int),
        };
        let spec = WavSpec {
            channels: count,
            sample_rate: rate_hz,
            bits_per_sample,
            sample_format,
        };
        let writer = WavWriter::create(path, spec).map_err(|error| unwritable(error.to_string()))?;
        Ok(Self {
            writer: Some(writer),
            path: shown,
            channels,
            form,
            bytes: 0,
        })
    }

    /// Appends samples, one vector a channel, all of the same length.
    ///
    /// # Errors
    /// Another number of channels or unequal lengths (nothing is written), or a file that is full or cannot be
    /// written.
    pub fn write(&mut self, channels: &[Vec<f32>]) -> Result<(), EncodeError> {
        let path = &self.path;
        let unwritable = |reason: String| EncodeError::Unwritable {
            path: path.clone(),
            reason,
        };
        let length = channels.first().map_or(0, Vec::len);
        if channels.len() != self.channels || channels.iter().any(|channel| channel.len() != length) {
            let reason = format!("{} channels of equal length must come", self.channels);
            return Err(unwritable(reason));
        }
        let width: u64 = if self.form == SampleForm::Float32 { 4 } else { 3 };
        let bytes = self.bytes + (length * channels.len()) as u64 * width;
        if bytes > LARGEST_BYTES {
            return Err(unwritable("a WAV file ends at 4 GB of sound".to_owned()));
        }
        let Some(writer) = &mut self.writer else {
            return Err(EncodeError::Finished { path: path.clone() });
        };
        for at in 0..length {
            for channel in channels {
                let written = match self.form {
                    SampleForm::Float32 => writer.write_sample(channel[at]),
                    SampleForm::Integer24 => {
                        writer.write_sample((channel[at].clamp(-1.0, 1.0) * FULL_SCALE).round() as i32)
                    }
                };
                written.map_err(|error| unwritable(error.to_string()))?;
            }
        }
        self.bytes = bytes;
        Ok(())
    }

    /// Completes the file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(mut self) -> Result<(), EncodeError> {
        let finished = self.writer.take().map_or(Ok(()), WavWriter::finalize);
        finished.map_err(|error| EncodeError::Unwritable {
            path: self.path.clone(),
            reason: error.to_string(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AudioFile, AudioOptions};
    use hearsight_core::AudioBlock;
    use hearsight_core::source::{AudioSource, Delivery};

    fn read_back(form: SampleForm, planes: &[Vec<f32>]) -> Vec<Vec<f32>> {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("sound.wav");
        let mut writer = SoundWriter::create(&path, planes.len(), 16_000, form).unwrap();
        writer.write(planes).unwrap();
        assert!(writer.write(&planes[1..]).is_err());
        writer.finish().unwrap();
        let mut file = AudioFile::open(&path, AudioOptions::default()).unwrap();
        let (mut block, mut faults) = (AudioBlock::default(), Vec::new());
        let mut all = vec![Vec::new(); planes.len()];
        while file.read(&mut block, &mut faults) == Delivery::Data {
            for (all, new) in all.iter_mut().zip(&block.channels) {
                all.extend_from_slice(new);
            }
        }
        assert_eq!(faults, []);
        all
    }

    #[test]
    fn floating_point_keeps_every_bit_and_integers_a_few_less() {
        let plane = |seed: usize| {
            (0..5000)
                .map(|at| ((at * seed) as f32 * 0.37).sin() * 0.9)
                .collect()
        };
        let planes: Vec<Vec<f32>> = (1..=9).map(plane).collect();
        assert_eq!(read_back(SampleForm::Float32, &planes), planes);
        let rounded = read_back(SampleForm::Integer24, &planes);
        for (new, old) in rounded.iter().flatten().zip(planes.iter().flatten()) {
            assert!((new - old).abs() < 3e-7, "{new} {old}");
        }
    }
}
