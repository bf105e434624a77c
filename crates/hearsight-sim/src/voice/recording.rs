//! Voices from recordings: a folder of utterances becomes what a person says.

use super::file::read_sound;
use super::speech::{Speech, Utterance, active_floor, loudness, mouth_of, normalize};
use super::talker::{fade, spans_of};
use super::turns::Turn;
use crate::acoustics::AcousticsError;
use crate::acoustics::error::check;
use crate::acoustics::random::{between, derive, generator};
use rand::Rng;
use rubato::audioadapter_buffers::direct::InterleavedSlice;
use rubato::{Fft, FixedSync, Resampler};
use std::path::{Path, PathBuf};

/// Files that are read of a folder at most, and how much speech is kept of them, seconds.
const MOST_FILES: usize = 2000;
const MOST_S: f64 = 1800.0;
/// Kept before and after the speech of a file, in units of 10 ms.
const KEPT: usize = 5;

/// One person's recorded utterances, each trimmed and with a root mean square of 1 while it is not a pause.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedVoice {
    rate_hz: u32,
    utterances: Vec<Vec<f32>>,
}

impl RecordedVoice {
    /// Reads all WAV and FLAC files of a folder, in the order of their names, resamples them to `rate_hz`, and trims
    /// and levels them. Of files with several channels the first is taken. At most half an hour of speech is kept.
    ///
    /// # Errors
    /// [`AcousticsError::File`] where the folder or one of its sound files cannot be read, or no file has any speech;
    /// [`AcousticsError::Setting`] for a rate outside 8000 to 192000 Hz.
    pub fn open(folder: &Path, rate_hz: u32) -> Result<Self, AcousticsError> {
        check(
            (8000..=192_000).contains(&rate_hz),
            "the rate of speech",
            "within 8000 and 192000 Hz",
            f64::from(rate_hz),
        )?;
        let fail = |reason: String| AcousticsError::File {
            path: folder.to_owned(),
            reason,
        };
        let entries = std::fs::read_dir(folder).map_err(|error| fail(error.to_string()))?;
        let mut paths: Vec<PathBuf> = Vec::new();
        for entry in entries {
            let path = entry.map_err(|error| fail(error.to_string()))?.path();
            let ending = path
                .extension()
                .map(|ending| ending.to_string_lossy().to_lowercase());
            if matches!(ending.as_deref(), Some("wav" | "flac")) {
                paths.push(path);
            }
        }
        paths.sort();
        let (mut utterances, mut left_s) = (Vec::new(), MOST_S);
        for path in paths.iter().take(MOST_FILES) {
            let sound = read_sound(path)?;
            let Some(first) = sound.channels.into_iter().next() else {
                continue;
            };
            let resampled =
                resample(first, sound.rate_hz, rate_hz).map_err(|reason| AcousticsError::File {
                    path: path.clone(),
                    reason,
                })?;
            if let Some(mut utterance) = trim(&resampled, rate_hz) {
                fade(&mut utterance, rate_hz);
                normalize(&mut utterance, rate_hz);
                left_s -= utterance.len() as f64 / f64::from(rate_hz);
                utterances.push(utterance);
            }
            if left_s <= 0.0 {
                break;
            }
        }
        if utterances.is_empty() {
            return Err(fail(
                "no .wav or .flac file in it has any speech: put recordings of one person there".to_owned(),
            ));
        }
        Ok(Self { rate_hz, utterances })
    }

    /// How many utterances there are.
    pub fn utterances(&self) -> usize {
        self.utterances.len()
    }

    /// What this person says in these turns, one utterance after the other from one that the seed chooses, with pauses
    /// of 0.2 to 0.5 s between them. What does not fit into a turn is cut where it is quietest.
    ///
    /// # Errors
    /// [`AcousticsError::Setting`] as [`super::Talker::speak`].
    pub fn speak(&self, turns: &[Turn], person: usize, seed: u64) -> Result<Speech, AcousticsError> {
        let rate = f64::from(self.rate_hz);
        let own = spans_of(turns, person, self.rate_hz)?;
        let mut random = generator(derive(seed, "recorded", 0), "utterances", person as u64);
        let mut next = (random.next_u32() as usize) % self.utterances.len();
        let mut stretches = Vec::new();
        for [start_s, end_s] in own {
            let length = ((end_s - start_s) * rate) as usize;
            let mut samples: Vec<f32> = Vec::new();
            while samples.len() < length {
                let utterance = &self.utterances[next];
                next = (next + 1) % self.utterances.len();
                let left = length - samples.len();
                if utterance.len() <= left {
                    samples.extend_from_slice(utterance);
                    let pause = between(&mut random, 0.2, 0.5) * rate;
                    samples.resize((samples.len() + pause as usize).min(length), 0.0);
                } else {
                    let mut part = utterance[..quietest_end(utterance, left, self.rate_hz)].to_vec();
                    fade(&mut part, self.rate_hz);
                    samples.extend_from_slice(&part);
                    break;
                }
            }
            let mouth = mouth_of(&samples, self.rate_hz);
            stretches.push(((start_s * rate).round() as i64, Utterance { samples, mouth }));
        }
        Ok(Speech::new(self.rate_hz, stretches))
    }
}

/// Where to end an utterance that may have `most` samples: the quietest 10 ms of the last 0.6 s.
fn quietest_end(samples: &[f32], most: usize, rate_hz: u32) -> usize {
    let frame = rate_hz as usize / 100;
    let from = most.saturating_sub(60 * frame).max(most / 2);
    let energy = |at: usize| {
        samples[at..at + frame]
            .iter()
            .map(|sample| sample * sample)
            .sum::<f32>()
    };
    (from..most.saturating_sub(frame))
        .step_by(frame)
        .min_by(|a, b| energy(*a).total_cmp(&energy(*b)))
        .map_or(most, |at| at + frame / 2)
}

/// The part from the first to the last speech, or `None` where there is silence alone.
fn trim(samples: &[f32], rate_hz: u32) -> Option<Vec<f32>> {
    let mean = samples.iter().sum::<f32>() / samples.len().max(1) as f32;
    let centred: Vec<f32> = samples.iter().map(|sample| sample - mean).collect();
    let loudness = loudness(&centred, rate_hz);
    let floor = active_floor(&loudness);
    let active = |value: &f32| *value > floor;
    let (first, last) = (
        loudness.iter().position(active)?,
        loudness.iter().rposition(active)?,
    );
    let frame = (f64::from(rate_hz) / 100.0).round() as usize;
    let from = first.saturating_sub(KEPT) * frame;
    let to = ((last + 1 + KEPT) * frame).min(centred.len());
    (floor > 0.0).then(|| centred[from..to].to_vec())
}

/// Samples at another rate.
fn resample(samples: Vec<f32>, from_hz: u32, to_hz: u32) -> Result<Vec<f32>, String> {
    if from_hz == to_hz || samples.is_empty() {
        return Ok(samples);
    }
    let text = |error: &dyn std::fmt::Display| format!("it cannot be resampled to {to_hz} Hz: {error}");
    let mut resampler = Fft::<f32>::new(from_hz as usize, to_hz as usize, 1024, 1, FixedSync::Input)
        .map_err(|error| text(&error))?;
    let length = samples.len();
    let input = InterleavedSlice::new(&samples, 1, length).map_err(|error| text(&error))?;
    let output = resampler
        .process_all(&input, length, None)
        .map_err(|error| text(&error))?;
    Ok(output.take_data())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::acoustics::Sound;
    use std::f64::consts::TAU;

    /// A tone between silences.
    fn write(path: &Path, rate_hz: u32, frequency_hz: f64) {
        let spec = hound::WavSpec {
            channels: 2,
            sample_rate: rate_hz,
            bits_per_sample: 16,
            sample_format: hound::SampleFormat::Int,
        };
        let mut writer = hound::WavWriter::create(path, spec).unwrap();
        for n in 0..2 * rate_hz {
            let time = f64::from(n) / f64::from(rate_hz);
            let sounds = (0.5..1.5).contains(&time);
            let value = if sounds {
                3000.0 * (TAU * frequency_hz * time).sin()
            } else {
                0.0
            };
            writer.write_sample(value as i16).unwrap();
            writer.write_sample(0_i16).unwrap();
        }
        writer.finalize().unwrap();
    }

    #[test]
    fn a_folder_becomes_a_voice() {
        let folder = tempfile::tempdir().unwrap();
        write(&folder.path().join("a.wav"), 44_100, 300.0);
        write(&folder.path().join("B.WAV"), 8000, 300.0);
        std::fs::write(folder.path().join("notes.txt"), "not sound").unwrap();
        let voice = RecordedVoice::open(folder.path(), 16_000).unwrap();
        assert_eq!(voice.utterances(), 2);
        for utterance in &voice.utterances {
            let seconds = utterance.len() as f64 / 16_000.0;
            assert!((seconds - 1.1).abs() < 0.03, "{seconds}");
            // Still the tone: as many upward crossings as periods, and its level is 1.
            let middle = &utterance[3200..12_800];
            let crossings = middle
                .windows(2)
                .filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0)
                .count();
            assert!((crossings as i32 - 180).abs() <= 1, "{crossings}");
            let power = middle.iter().map(|x| x * x).sum::<f32>() / middle.len() as f32;
            assert!((power - 1.0).abs() < 0.05, "{power}");
        }
        let turns = [
            Turn {
                person: 0,
                start_s: 1.0,
                end_s: 3.1,
            },
            Turn {
                person: 0,
                start_s: 5.0,
                end_s: 5.4,
            },
        ];
        let speech = voice.speak(&turns, 0, 7).unwrap();
        assert_eq!(speech, voice.speak(&turns, 0, 7).unwrap());
        let mut samples = vec![0.0; 96_000];
        speech.fill(0, &mut samples);
        assert!(samples[..16_000].iter().all(|sample| *sample == 0.0));
        assert!(samples[49_600..80_000].iter().all(|sample| *sample == 0.0));
        assert!(speech.mouth_opening(1.5) > 0.5 && speech.mouth_opening(4.0) == 0.0);
    }

    #[test]
    fn unusable_folders_and_files_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let message = |error: AcousticsError| error.to_string();
        assert!(message(RecordedVoice::open(folder.path(), 16_000).unwrap_err()).contains("put recordings"));
        assert!(RecordedVoice::open(&folder.path().join("none"), 16_000).is_err());
        std::fs::write(folder.path().join("bad.flac"), b"fLaC nonsense").unwrap();
        assert!(message(RecordedVoice::open(folder.path(), 16_000).unwrap_err()).contains("bad.flac"));
        std::fs::write(folder.path().join("bad.flac"), b"").unwrap();
        assert!(RecordedVoice::open(folder.path(), 16_000).is_err());
        std::fs::remove_file(folder.path().join("bad.flac")).unwrap();
        std::fs::write(folder.path().join("bad.wav"), b"RIFF\x24\0\0\0WAVEfmt ").unwrap();
        assert!(message(RecordedVoice::open(folder.path(), 16_000).unwrap_err()).contains("bad.wav"));
    }

    #[test]
    fn real_speech_is_read_where_there_is_some() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/speech");
        if !folder.is_dir() {
            println!("skipped: no data at {}", folder.display());
            return;
        }
        let voice = RecordedVoice::open(&folder, 16_000).unwrap();
        let turns = [Turn {
            person: 2,
            start_s: 0.5,
            end_s: 20.0,
        }];
        let speech = voice.speak(&turns, 2, 1).unwrap();
        let mouths: Vec<f64> = (0..2000)
            .map(|n| speech.mouth_opening(f64::from(n) * 0.01))
            .collect();
        assert!(mouths.iter().any(|opening| *opening > 0.7) && mouths.iter().any(|opening| *opening < 0.1));
    }
}
