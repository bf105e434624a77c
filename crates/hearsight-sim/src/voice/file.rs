//! Sound files: WAV and FLAC, whole, as numbers within ±1.

use crate::acoustics::AcousticsError;
use std::path::Path;

/// A file's samples.
#[derive(Clone, Debug, PartialEq)]
pub struct SoundFile {
    /// Samples a second.
    pub rate_hz: u32,
    /// One vector a channel, all of one length; full scale is ±1.
    pub channels: Vec<Vec<f32>>,
}

/// Most samples of all channels together that are read: twenty minutes of 48 kHz.
const MOST_SAMPLES: usize = 48_000 * 1200;

/// Reads a WAV or FLAC file, by its ending.
///
/// # Errors
/// [`AcousticsError::File`] where it is neither, cannot be read, is damaged, longer than twenty minutes of one channel
/// at 48 kHz, or has samples that are not finite.
pub fn read_sound(path: &Path) -> Result<SoundFile, AcousticsError> {
    let fail = |reason: String| AcousticsError::File {
        path: path.to_owned(),
        reason,
    };
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_lowercase());
    let sound = match ending.as_deref() {
        Some("wav") => read_wav(path),
        Some("flac") => read_flac(path),
        _ => return Err(fail("its name must end in .wav or .flac".to_owned())),
    }
    .map_err(fail)?;
    if sound.channels.iter().flatten().any(|sample| !sample.is_finite()) {
        return Err(fail("it has samples that are not finite".to_owned()));
    }
    Ok(sound)
}

fn read_wav(path: &Path) -> Result<SoundFile, String> {
    let mut reader = hound::WavReader::open(path).map_err(|error| error.to_string())?;
    let spec = reader.spec();
    let mut samples = Interleaved::new(usize::from(spec.channels), spec.sample_rate)?;
    match spec.sample_format {
        hound::SampleFormat::Float => {
            for sample in reader.samples::<f32>() {
                samples.push(sample.map_err(|error| error.to_string())?)?;
            }
        }
        hound::SampleFormat::Int => {
            let scale = 0.5_f64.powi(i32::from(spec.bits_per_sample) - 1);
            for sample in reader.samples::<i32>() {
                let sample = sample.map_err(|error| error.to_string())?;
                samples.push((f64::from(sample) * scale) as f32)?;
            }
        }
    }
    Ok(samples.finish())
}

fn read_flac(path: &Path) -> Result<SoundFile, String> {
    let mut reader = claxon::FlacReader::open(path).map_err(|error| error.to_string())?;
    let info = reader.streaminfo();
    let mut samples = Interleaved::new(info.channels as usize, info.sample_rate)?;
    let scale = 0.5_f64.powi(info.bits_per_sample as i32 - 1);
    for sample in reader.samples() {
        let sample = sample.map_err(|error| error.to_string())?;
        samples.push((f64::from(sample) * scale) as f32)?;
    }
    Ok(samples.finish())
}

/// Takes samples of one channel after the other.
struct Interleaved {
    sound: SoundFile,
    next: usize,
    left: usize,
}

impl Interleaved {
    fn new(channels: usize, rate_hz: u32) -> Result<Self, String> {
        if channels == 0 || !(1000..=400_000).contains(&rate_hz) {
            return Err(format!("{channels} channels at {rate_hz} Hz cannot be used"));
        }
        Ok(Self {
            sound: SoundFile {
                rate_hz,
                channels: vec![Vec::new(); channels],
            },
            next: 0,
            left: MOST_SAMPLES,
        })
    }

    /// What there is, without a last sample that not all channels have.
    fn finish(mut self) -> SoundFile {
        for channel in &mut self.sound.channels[..self.next] {
            channel.pop();
        }
        self.sound
    }

    fn push(&mut self, sample: f32) -> Result<(), String> {
        if self.left == 0 {
            return Err("it is longer than twenty minutes of one channel at 48 kHz: split it".to_owned());
        }
        self.left -= 1;
        self.sound.channels[self.next].push(sample);
        self.next = (self.next + 1) % self.sound.channels.len();
        Ok(())
    }
}
