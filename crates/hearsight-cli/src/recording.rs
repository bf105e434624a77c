//! A simulation to files: lossless or small video, sound, `room.toml`, and the truth beside them.
//!
//! Time goes forward by chunks of about a second; within one, pictures and sound are made at once. Whatever was begun is
//! closed and valid when the run is interrupted.

use crate::say;
use hearsight::core::AudioBlock;
use hearsight::core::truth::TruthRecord;
use hearsight::media::{Encoder, SampleForm, SoundWriter, VideoWriter, VideoWriterOptions};
use hearsight::sim::simulation::{Files, SimulatedArray, SimulatedCamera, Simulation, mot_rows};
use miette::{Context, IntoDiagnostic};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Length of a chunk, seconds.
const CHUNK_S: f64 = 1.0;
/// Quality of video that is not lossless, 1 (best) to 63.
const QUALITY: u8 = 18;

/// How files are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Format {
    /// FFV1 in QuickTime files and 32-bit floating-point WAV: not a bit is lost.
    Lossless,
    /// MP4 that browsers play, and 24-bit WAV: small.
    Mp4,
}

/// What is written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Choice {
    pub(crate) format: Format,
    pub(crate) video: bool,
    pub(crate) sound: bool,
}

impl Choice {
    fn files(self) -> Files {
        let video = match self.format {
            Format::Lossless => "mov",
            Format::Mp4 => "mp4",
        };
        Files {
            video: self.video.then_some(video),
            sound: self.sound.then_some("wav"),
        }
    }
}

/// A camera and its file.
struct Video {
    camera: SimulatedCamera,
    writer: VideoWriter,
    /// Frames written; the next one's time decides whether it belongs to a chunk.
    written: u64,
}

/// An array and its file.
struct Sound {
    array: SimulatedArray,
    writer: SoundWriter,
    block: AudioBlock,
}

/// Writes all of a simulation into a directory; gives the path of its `room.toml` and whether it was interrupted.
/// `progress` is told how many seconds are done.
pub(crate) fn record(
    simulation: &Simulation,
    directory: &Path,
    choice: Choice,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(f64),
) -> miette::Result<(PathBuf, bool)> {
    std::fs::create_dir_all(directory)
        .into_diagnostic()
        .wrap_err_with(|| format!("cannot make {}", directory.display()))?;
    let room = directory.join("room.toml");
    write(&room, &simulation.room_file(&choice.files()))?;
    write(&directory.join("speech.rttm"), &simulation.rttm())?;
    let mut videos = open_videos(simulation, directory, choice)?;
    let mut sounds = open_sounds(simulation, directory, choice)?;
    let mut truth = TruthFiles::create(simulation, directory)?;
    let (ticks, seconds) = (simulation.ticks(), simulation.world().seconds);
    let mut tick = 0;
    let mut interrupted = false;
    while tick < ticks || tick == 0 {
        if stop.load(Ordering::Relaxed) {
            interrupted = true;
            break;
        }
        let begun = simulation.tick_time(tick);
        let mut end = tick + 1;
        while end < ticks && (simulation.tick_time(end) - begun).seconds() < CHUNK_S {
            end += 1;
        }
        let last = end >= ticks;
        let until = simulation.tick_time(end - 1);
        let (video, sound) = rayon::join(
            || videos.iter_mut().try_for_each(|video| video.advance(until, last)),
            || {
                sounds
                    .iter_mut()
                    .try_for_each(|sound| sound.advance(until.seconds(), last))
            },
        );
        video.and(sound)?;
        for tick in tick..end {
            truth.write(&simulation.truth(tick))?;
        }
        tick = end;
        progress(until.seconds().min(seconds));
    }
    for video in videos {
        video.writer.finish().into_diagnostic()?;
    }
    for sound in sounds {
        sound.writer.finish().into_diagnostic()?;
    }
    truth.finish()?;
    Ok((room, interrupted))
}

fn open_videos(simulation: &Simulation, directory: &Path, choice: Choice) -> miette::Result<Vec<Video>> {
    let Some(extension) = choice.files().video else {
        return Ok(Vec::new());
    };
    let cameras = simulation.world().cameras.iter().enumerate();
    let videos = cameras.map(|(number, device)| {
        let options = VideoWriterOptions {
            encoder: match choice.format {
                Format::Lossless => Encoder::Lossless,
                Format::Mp4 => Encoder::Automatic,
            },
            quality: QUALITY,
            interval: device.interval(),
            threads: rayon::current_num_threads().min(4),
        };
        let path = directory.join(format!("{}.{extension}", device.name));
        Ok(Video {
            camera: simulation.camera(number),
            writer: VideoWriter::create(&path, device.width, device.height, &options).into_diagnostic()?,
            written: 0,
        })
    });
    videos.collect()
}

fn open_sounds(simulation: &Simulation, directory: &Path, choice: Choice) -> miette::Result<Vec<Sound>> {
    let Some(extension) = choice.files().sound else {
        return Ok(Vec::new());
    };
    let form = match choice.format {
        Format::Lossless => SampleForm::Float32,
        Format::Mp4 => SampleForm::Integer24,
    };
    let arrays = simulation.world().arrays.iter().enumerate();
    let sounds = arrays.map(|(number, device)| {
        let path = directory.join(format!("{}.{extension}", device.name));
        let (channels, rate_hz) = (device.microphones.len(), device.rate_hz);
        Ok(Sound {
            array: simulation.array(number).into_diagnostic()?,
            writer: SoundWriter::create(&path, channels, rate_hz, form).into_diagnostic()?,
            block: AudioBlock::default(),
        })
    });
    sounds.collect()
}

impl Video {
    /// Takes and writes the frames up to a time, or all that are left.
    fn advance(&mut self, until: hearsight::Instant, all: bool) -> miette::Result<()> {
        while all || self.camera.time(self.written) <= until {
            // The file begins with its first frame; where that is on the common clock, room.toml says.
            let time = hearsight::Instant::ZERO + self.camera.own_time(self.written);
            let Some((_, picture)) = self.camera.shoot() else {
                break;
            };
            let [blue, red] = &picture.chroma;
            let planes = [picture.luma.as_slice(), blue, red];
            self.writer.write_planes(time, planes).into_diagnostic()?;
            self.written += 1;
        }
        Ok(())
    }
}

impl Sound {
    /// Makes and writes samples at least up to a time, or all that are left.
    fn advance(&mut self, until_s: f64, all: bool) -> miette::Result<()> {
        while all || self.array.end_s() <= until_s {
            if !self.array.record(&mut self.block).into_diagnostic()? {
                break;
            }
            self.writer.write(&self.block.channels).into_diagnostic()?;
        }
        Ok(())
    }
}

/// `truth.jsonl` and a `.gt.txt` a camera.
struct TruthFiles {
    records: BufWriter<File>,
    cameras: Vec<(String, BufWriter<File>)>,
}

impl TruthFiles {
    fn create(simulation: &Simulation, directory: &Path) -> miette::Result<Self> {
        let create = |name: String| {
            let path = directory.join(name);
            let file = File::create(&path)
                .into_diagnostic()
                .wrap_err_with(|| format!("cannot write {}", path.display()))?;
            Ok::<_, miette::Report>(BufWriter::new(file))
        };
        let cameras = simulation.world().cameras.iter();
        let cameras =
            cameras.map(|camera| Ok((camera.name.clone(), create(format!("{}.gt.txt", camera.name))?)));
        Ok(Self {
            records: create("truth.jsonl".to_owned())?,
            cameras: cameras.collect::<miette::Result<_>>()?,
        })
    }

    fn write(&mut self, record: &TruthRecord) -> miette::Result<()> {
        serde_json::to_writer(&mut self.records, record).into_diagnostic()?;
        self.records.write_all(b"\n").into_diagnostic()?;
        for (camera, file) in &mut self.cameras {
            file.write_all(mot_rows(record, camera).as_bytes())
                .into_diagnostic()?;
        }
        Ok(())
    }

    fn finish(mut self) -> miette::Result<()> {
        self.records.flush().into_diagnostic()?;
        for (_, file) in &mut self.cameras {
            file.flush().into_diagnostic()?;
        }
        Ok(())
    }
}

fn write(path: &Path, text: &str) -> miette::Result<()> {
    std::fs::write(path, text)
        .into_diagnostic()
        .wrap_err_with(|| format!("cannot write {}", path.display()))
}

/// What was written, for people.
pub(crate) fn describe(simulation: &Simulation, directory: &Path, elapsed_s: f64) {
    let world = simulation.world();
    say::line(format_args!(
        "{}: {:.1} s in {elapsed_s:.1} s ({:.1} times real time)",
        world.name,
        world.seconds,
        world.seconds / elapsed_s.max(1e-9)
    ));
    let talk: f64 = simulation
        .utterances()
        .iter()
        .map(|utterance| utterance.until_s - utterance.from_s)
        .fold(0.0, |sum, length| sum + length);
    say::line(format_args!(
        "{} people, {} cameras, {} arrays; {talk:.1} s of speech; written to {}",
        world.people.len(),
        world.cameras.len(),
        world.arrays.len(),
        directory.display()
    ));
}
