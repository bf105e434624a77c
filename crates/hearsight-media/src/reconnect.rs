//! Live sources that are opened again where they were lost: cameras that restart, networks that fail for a while.
//!
//! A source that is lost is reported at once. It is tried again after pauses that double up to ten seconds, for as long as
//! the caller has patience; what comes then goes on at its time on the common clock, and frames go on with the numbers
//! that they would have had. To be read from a thread of its own ([`LiveVideo`](crate::LiveVideo)): opening waits.

mod outage;

use crate::audio_file::{AudioFile, AudioOptions};
use crate::clock::{RunClock, Start};
use crate::error::{MediaError, fault};
use crate::video_file::{VideoFile, VideoOptions};
use hearsight_core::source::{AudioFormat, AudioSource, Delivery, VideoFormat, VideoSource};
use hearsight_core::{AudioBlock, Fault, FaultKind, Instant, Span, VideoFrame};
use outage::{Keeper, Next};

/// A camera that is opened again where it was lost.
pub struct ReconnectingVideo {
    source: Option<VideoFile>,
    location: String,
    options: VideoOptions,
    format: VideoFormat,
    keeper: Keeper,
    /// Time and number of the last frame.
    last: Option<(Instant, u64)>,
    /// Added to the numbers of the source that is open now; nothing before its first frame.
    offset: Option<u64>,
}

impl ReconnectingVideo {
    /// Opens a stream or device as [`VideoFile::open_location`] does, and again whenever it is lost, until it stayed away
    /// for `patience`. `clock` tells when data come that were not declared.
    ///
    /// # Errors
    /// As [`VideoFile::open_location`], for the first time.
    pub fn open(
        location: &str,
        options: VideoOptions,
        clock: RunClock,
        patience: Span,
    ) -> Result<Self, MediaError> {
        let source = VideoFile::open_location(location, options.clone())?;
        Ok(Self::around(source, location, options, clock, patience))
    }

    /// Keeps a source that was opened at `location` with `options`.
    pub fn around(
        source: VideoFile,
        location: &str,
        mut options: VideoOptions,
        clock: RunClock,
        patience: Span,
    ) -> Self {
        let name = if options.name.is_empty() {
            location
        } else {
            &options.name
        };
        let keeper = Keeper::new(name, patience);
        // A declared start is that of the first time.
        options.clock.start = Start::OnArrival(clock);
        Self {
            format: source.format().clone(),
            source: Some(source),
            location: location.to_owned(),
            options,
            keeper,
            last: None,
            offset: Some(0),
        }
    }

    fn reopen(&mut self) -> Result<VideoFile, String> {
        let source = VideoFile::open_location(&self.location, self.options.clone())
            .map_err(|error| error.to_string())?;
        let (found, wanted) = (source.format(), &self.format);
        if (found.width, found.height) == (wanted.width, wanted.height) {
            return Ok(source);
        }
        Err(format!(
            "it came back with pictures of {} x {} pixels instead of {} x {}",
            found.width, found.height, wanted.width, wanted.height
        ))
    }

    /// Time of the newest frame.
    fn reached(&self) -> Instant {
        self.last.map_or(self.format.start, |(time, _)| time)
    }

    /// Numbers a frame on; false where its time was seen already.
    fn admit(&mut self, frame: &mut VideoFrame, faults: &mut Vec<Fault>) -> bool {
        let offset = match (self.offset, self.last) {
            (Some(offset), _) => offset,
            (None, Some((time, number))) => {
                if frame.time <= time {
                    return false;
                }
                let interval_s = self.format.interval.seconds().max(1e-6);
                let steps = ((frame.time - time).seconds() / interval_s).round().max(1.0) as u64;
                if let Some(back) = self.keeper.is_back() {
                    let detail = format!("{back}; {} frames are missing before this time", steps - 1);
                    faults.push(fault(self.keeper.name(), frame.time, FaultKind::Gap, detail));
                }
                (number + steps).saturating_sub(frame.number)
            }
            (None, None) => {
                self.keeper.is_back();
                0
            }
        };
        self.offset = Some(offset);
        frame.number += offset;
        self.last = Some((frame.time, frame.number));
        true
    }
}

impl VideoSource for ReconnectingVideo {
    fn format(&self) -> &VideoFormat {
        &self.format
    }

    fn read(&mut self, frame: &mut VideoFrame, faults: &mut Vec<Fault>) -> Delivery {
        let known = faults.len();
        loop {
            if let Some(source) = &mut self.source {
                let delivery = source.read(frame, faults);
                self.keeper.hear(&faults[known..]);
                match delivery {
                    Delivery::Data if self.admit(frame, faults) => return Delivery::Data,
                    Delivery::Data => continue,
                    Delivery::Pending => return Delivery::Pending,
                    Delivery::End => {
                        self.keeper.lose(self.reached(), faults);
                        self.source = None;
                    }
                }
            }
            match self.keeper.next() {
                Next::Wait => return Delivery::Pending,
                Next::GiveUp => {
                    self.keeper.give_up(self.reached(), faults);
                    return Delivery::End;
                }
                Next::Try => match self.reopen() {
                    Ok(source) => {
                        self.source = Some(source);
                        self.offset = None;
                    }
                    Err(reason) => self.keeper.fail(&reason),
                },
            }
        }
    }
}

/// An array that is opened again where it was lost.
pub struct ReconnectingAudio {
    source: Option<AudioFile>,
    location: String,
    options: AudioOptions,
    format: AudioFormat,
    keeper: Keeper,
    /// Just after the last sample.
    end: Option<Instant>,
}

impl ReconnectingAudio {
    /// As [`ReconnectingVideo::open`].
    ///
    /// # Errors
    /// As [`AudioFile::open_location`], for the first time.
    pub fn open(
        location: &str,
        options: AudioOptions,
        clock: RunClock,
        patience: Span,
    ) -> Result<Self, MediaError> {
        let source = AudioFile::open_location(location, options.clone())?;
        Ok(Self::around(source, location, options, clock, patience))
    }

    /// As [`ReconnectingVideo::around`].
    pub fn around(
        source: AudioFile,
        location: &str,
        mut options: AudioOptions,
        clock: RunClock,
        patience: Span,
    ) -> Self {
        let name = if options.name.is_empty() {
            location
        } else {
            &options.name
        };
        let keeper = Keeper::new(name, patience);
        options.clock.start = Start::OnArrival(clock);
        let format = source.format().clone();
        // A device that comes back at another rate is converted to the one that was agreed on.
        options.rate_hz = Some(format.rate_hz);
        Self {
            format,
            source: Some(source),
            location: location.to_owned(),
            options,
            keeper,
            end: None,
        }
    }

    fn reopen(&mut self) -> Result<AudioFile, String> {
        let source = AudioFile::open_location(&self.location, self.options.clone())
            .map_err(|error| error.to_string())?;
        let (found, wanted) = (source.format().channels, self.format.channels);
        if found == wanted {
            return Ok(source);
        }
        Err(format!("it came back with {found} channels instead of {wanted}"))
    }

    /// Time up to which samples have come.
    fn reached(&self) -> Instant {
        self.end.unwrap_or(self.format.start)
    }

    /// Leaves out what was heard already; false where nothing is left.
    fn admit(&mut self, block: &mut AudioBlock, faults: &mut Vec<Fault>) -> bool {
        if let Some(back) = self.keeper.is_back()
            && let Some(end) = self.end
        {
            let early = (end - block.time).samples(block.rate_hz).max(0) as usize;
            let early = early.min(block.len());
            for channel in &mut block.channels {
                channel.drain(..early);
            }
            block.time += Span::of_samples(early as i64, block.rate_hz);
            faults.push(fault(self.keeper.name(), block.time, FaultKind::Gap, back));
        }
        self.end = Some(block.end());
        !block.is_empty()
    }
}

impl AudioSource for ReconnectingAudio {
    fn format(&self) -> &AudioFormat {
        &self.format
    }

    fn read(&mut self, block: &mut AudioBlock, faults: &mut Vec<Fault>) -> Delivery {
        let known = faults.len();
        loop {
            if let Some(source) = &mut self.source {
                let delivery = source.read(block, faults);
                self.keeper.hear(&faults[known..]);
                match delivery {
                    Delivery::Data if self.admit(block, faults) => return Delivery::Data,
                    Delivery::Data => continue,
                    Delivery::Pending => return Delivery::Pending,
                    Delivery::End => {
                        self.keeper.lose(self.reached(), faults);
                        self.source = None;
                    }
                }
            }
            match self.keeper.next() {
                Next::Wait => return Delivery::Pending,
                Next::GiveUp => {
                    self.keeper.give_up(self.reached(), faults);
                    return Delivery::End;
                }
                Next::Try => match self.reopen() {
                    Ok(source) => self.source = Some(source),
                    Err(reason) => self.keeper.fail(&reason),
                },
            }
        }
    }
}
