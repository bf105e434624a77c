//! A microphone array from a file, device or network stream.

use crate::audio_stream::{AudioStream, Step, Trouble};
use crate::channels::ChannelSelection;
use crate::clock::{SourceClock, Start};
use crate::error::{MediaError, fault};
use crate::input::InputOptions;
use crate::location;
use crate::reader::StreamReader;
use crate::resample::RateConverter;
use crate::samples::quarantine;
use crate::wav::Wav;
use ffmpeg_next::media;
use hearsight_core::source::{AudioFormat, AudioSource, Delivery};
use hearsight_core::{AudioBlock, Fault, FaultKind, Instant, Span};
use std::path::Path;

/// How an array's file, device or stream is read.
#[derive(Clone, Debug, Default)]
pub struct AudioOptions {
    /// The sensor's name, which faults carry; default is the location.
    pub name: String,
    /// When it began on the common clock: the beginning of the whole file, pictures included. Default 0 s, no drift.
    pub clock: SourceClock,
    /// Which channels, in which order; default all.
    pub channels: ChannelSelection,
    /// Samples a second to deliver; default as in the file.
    pub rate_hz: Option<u32>,
    /// How it is opened.
    pub input: InputOptions,
}

/// Reads the sound of WAV files and of anything that libav opens.
pub struct AudioFile {
    origin: Origin,
    selection: Vec<usize>,
    converter: Option<RateConverter>,
    name: String,
    format: AudioFormat,
    clock: SourceClock,
    /// Samples a second before conversion.
    own_rate_hz: u32,
    /// Samples a channel read before conversion, and delivered after it.
    taken: u64,
    delivered: u64,
    promised: Option<u64>,
    planes: Vec<Vec<f32>>,
    troubles: Vec<Trouble>,
    begun: bool,
    ended: bool,
}

enum Origin {
    Wav(Box<Wav>),
    Stream(Box<AudioStream>),
}

impl AudioFile {
    /// Opens a file.
    ///
    /// # Errors
    /// As [`AudioFile::open_location`].
    pub fn open(path: impl AsRef<Path>, options: AudioOptions) -> Result<Self, MediaError> {
        Self::open_location(&location::text(path.as_ref())?, options)
    }

    /// Opens a path, an address such as `rtsp://array/1`, or a device (format `alsa`, location `hw:0`).
    ///
    /// # Errors
    /// Says what is wrong with the place and what to do: missing, a directory, empty, no media, no audio stream, the
    /// wrong number of channels, no decoder, or not answering in time.
    pub fn open_location(location: &str, options: AudioOptions) -> Result<Self, MediaError> {
        location::check_as(location, options.input.format.as_deref())?;
        let declared = options.clock.is_declared();
        let wav = if location::is_path(location) && options.input.format.is_none() {
            Wav::open(location)
        } else {
            None
        };
        let (origin, own_rate_hz, present, promised, lead, live) = match wav {
            Some(wav) => {
                let facts = (wav.rate_hz, wav.channels, Some(wav.promised));
                (
                    Origin::Wav(Box::new(wav)),
                    facts.0,
                    facts.1,
                    facts.2,
                    Span::ZERO,
                    false,
                )
            }
            None => {
                let reader = StreamReader::open(location, media::Type::Audio, &options.input)?;
                let stream = AudioStream::new(reader, declared);
                let facts = (
                    stream.rate_hz,
                    stream.channels,
                    stream.promised,
                    stream.lead(),
                    stream.live(),
                );
                (
                    Origin::Stream(Box::new(stream)),
                    facts.0,
                    facts.1,
                    facts.2,
                    facts.3,
                    facts.4,
                )
            }
        };
        if own_rate_hz == 0 || present == 0 {
            return Err(MediaError::NotMedia {
                location: location.to_owned(),
                reason: "its sound has no rate or no channels".to_owned(),
            });
        }
        let selection = options.channels.resolve(location, present)?;
        let rate_hz = options.rate_hz.unwrap_or(own_rate_hz);
        let converter = converter_of(location, own_rate_hz, rate_hz, selection.len())?;
        let lead = if declared {
            options.clock.common_from_own(lead)
        } else {
            Span::ZERO
        };
        let arrival = match &origin {
            Origin::Wav(_) => std::time::Instant::now(),
            Origin::Stream(stream) => stream.arrival(),
        };
        let format = AudioFormat {
            rate_hz,
            channels: selection.len(),
            samples: promised.map(|count| {
                converter
                    .as_ref()
                    .map_or(count, |converter| converter.length(count))
            }),
            start: options.clock.start_on_arrival(arrival) + lead,
            live,
        };
        Ok(Self {
            planes: vec![Vec::new(); selection.len()],
            name: if options.name.is_empty() {
                location.to_owned()
            } else {
                options.name
            },
            clock: options.clock,
            taken: 0,
            delivered: 0,
            troubles: Vec::new(),
            begun: declared,
            ended: false,
            origin,
            selection,
            converter,
            format,
            own_rate_hz,
            promised,
        })
    }

    fn common(&self, own: Span) -> Instant {
        self.format.start + self.clock.common_from_own(own)
    }

    /// The present since the stream's zero, where the arrival of data is what tells their time.
    fn now(&self) -> Option<Span> {
        match self.clock.start {
            Start::OnArrival(clock) if self.format.live => Some(clock.now() - self.format.start),
            _ => None,
        }
    }

    /// Reads the next samples into `planes`; `false` at the end.
    fn pull(&mut self, faults: &mut Vec<Fault>) -> bool {
        self.planes.iter_mut().for_each(Vec::clear);
        let now = self.now();
        let more = match &mut self.origin {
            Origin::Wav(wav) => wav.append(&self.selection, &mut self.planes),
            Origin::Stream(stream) => {
                let step = stream.append(now, &self.selection, &mut self.planes, &mut self.troubles);
                if let (false, Some(since)) = (self.begun, stream.since_arrival()) {
                    self.begun = true;
                    self.format.start = self.clock.start_on_arrival(stream.arrival()) + since;
                }
                step == Step::More
            }
        };
        for (kind, own, detail) in std::mem::take(&mut self.troubles) {
            faults.push(fault(&self.name, self.common(own), kind, detail));
        }
        let bad = quarantine(&mut self.planes);
        if bad > 0 {
            let time = self.common(Span::of_samples(self.taken as i64, self.own_rate_hz));
            let detail = format!("{bad} samples are not finite numbers; zeros stand for them");
            faults.push(fault(&self.name, time, FaultKind::NonFinite, detail));
        }
        self.taken += self.planes.first().map_or(0, Vec::len) as u64;
        more
    }

    fn finish(&mut self, faults: &mut Vec<Fault>) {
        self.ended = true;
        // Compressed sound may end a packet early without anything being lost; WAV may not.
        let slack = match self.origin {
            Origin::Wav(_) => 0,
            Origin::Stream(_) => u64::from(self.own_rate_hz) / 10,
        };
        if let Some(promised) = self.promised.filter(|promised| self.taken + slack < *promised) {
            let time = self.common(Span::of_samples(self.taken as i64, self.own_rate_hz));
            let detail = format!(
                "ended after {} of the {promised} samples that the file promises",
                self.taken
            );
            faults.push(fault(&self.name, time, FaultKind::EndedEarly, detail));
        }
    }
}

impl AudioSource for AudioFile {
    fn format(&self) -> &AudioFormat {
        &self.format
    }

    fn read(&mut self, block: &mut AudioBlock, faults: &mut Vec<Fault>) -> Delivery {
        block.channels.resize_with(self.format.channels, Vec::new);
        block.clear();
        while block.is_empty() {
            if self.ended {
                return Delivery::End;
            }
            let more = self.pull(faults);
            match &mut self.converter {
                Some(converter) => {
                    converter.push(&self.planes, &mut block.channels);
                    if !more {
                        converter.finish(&mut block.channels);
                    }
                }
                None => std::mem::swap(&mut self.planes, &mut block.channels),
            }
            if !more {
                self.finish(faults);
            }
        }
        block.rate_hz = self.format.rate_hz;
        block.time = self.common(Span::of_samples(self.delivered as i64, self.format.rate_hz));
        self.delivered += block.len() as u64;
        Delivery::Data
    }
}

fn converter_of(
    location: &str,
    from_hz: u32,
    to_hz: u32,
    channels: usize,
) -> Result<Option<RateConverter>, MediaError> {
    if from_hz == to_hz {
        return Ok(None);
    }
    RateConverter::new(from_hz, to_hz, channels)
        .map(Some)
        .map_err(|_| MediaError::BadOption {
            location: location.to_owned(),
            option: "rate_hz",
            value: to_hz.to_string(),
            cure: "give a positive number of samples a second, or leave it out",
        })
}
