//! Video files: pictures with their instants to MP4 that browsers play, or kept to the last bit.

use crate::encode::{self, Encoder, Settings, UNITS_PER_SECOND};
use crate::error::EncodeError;
use ffmpeg_next::format::{self, Pixel};
use ffmpeg_next::{Dictionary, Error, Packet, Rational, color, encoder, frame};
use hearsight_core::{Instant, RgbView, Span};
use std::path::Path;

/// How a video is written.
#[derive(Clone, Debug)]
pub struct VideoWriterOptions {
    /// Which encoder; default is the first free one that is installed.
    pub encoder: Encoder,
    /// Quality from 1 (best) to 63 (worst); default 33.
    pub quality: u8,
    /// Expected interval between pictures, which steers keyframes and is the last picture's duration; default 40 ms.
    pub interval: Span,
    /// Threads of the encoder; default 1.
    pub threads: usize,
}

impl Default for VideoWriterOptions {
    fn default() -> Self {
        Self {
            encoder: Encoder::Automatic,
            quality: 33,
            interval: Span::from_nanoseconds(40_000_000),
            threads: 1,
        }
    }
}

/// Writes pictures as MP4, or as QuickTime (`.mov`) where the encoder is [`Encoder::Lossless`]: both keep the times of
/// pictures to 1/90000 s, which is exact at every usual rate. The file is fragmented, so it plays to within a second of where an interrupted run ended;
/// [`VideoWriter::finish`] closes it, and dropping the writer tries to.
pub struct VideoWriter {
    // The encoder goes before the file, whose stream copies its parameters.
    encoder: encoder::video::Encoder,
    output: format::context::Output,
    path: String,
    width: usize,
    height: usize,
    /// Time of the first picture, and of the last in encoded units.
    first: Option<Instant>,
    last: Option<i64>,
    /// Duration of a picture in encoded units.
    duration: i64,
    time_base: Rational,
    finished: bool,
}

impl VideoWriter {
    /// Creates the file for pictures of the given size, replacing one that is there.
    ///
    /// # Errors
    /// Says that no encoder is there, that it refuses the size, or that the file cannot be created.
    pub fn create(
        path: impl AsRef<Path>,
        width: usize,
        height: usize,
        options: &VideoWriterOptions,
    ) -> Result<Self, EncodeError> {
        let path = path.as_ref();
        let shown = path.to_string_lossy().into_owned();
        let unwritable = |reason: String| EncodeError::Unwritable {
            path: shown.clone(),
            reason,
        };
        let chosen = options.encoder.find()?;
        let text = path
            .to_str()
            .filter(|text| !text.contains('\0'))
            .ok_or_else(|| unwritable("its name is not UTF-8".to_owned()))?;
        let interval = options.interval.seconds().clamp(1e-3, 100.0);
        let settings = Settings {
            width,
            height,
            frames_per_second: 1.0 / interval,
            keyframe_seconds: 1.0,
            quality: options.quality,
            threads: options.threads,
            global_header: true,
        };
        let refused = |error: Error| EncodeError::Refused {
            path: shown.clone(),
            encoder: chosen.name().to_owned(),
            width,
            height,
            reason: error.to_string(),
        };
        if !(1..=16_384).contains(&width) || !(1..=16_384).contains(&height) {
            return Err(refused(Error::InvalidData));
        }
        let encoder = encode::open(chosen, &settings).map_err(refused)?;
        let failed = |error: Error| unwritable(error.to_string());
        let mut output = format::output_as(text, options.encoder.container()).map_err(failed)?;
        output
            .add_stream_with(&encoder)
            .map_err(failed)?
            .set_time_base(Rational::new(1, UNITS_PER_SECOND));
        // Every lossless picture is a keyframe, so that fragments are cut by time there.
        let cut = match options.encoder {
            Encoder::Lossless => ("movflags", "empty_moov+default_base_moof"),
            _ => ("movflags", "frag_keyframe+empty_moov+default_base_moof"),
        };
        let mut muxing = Dictionary::new();
        muxing.set(cut.0, cut.1);
        if options.encoder == Encoder::Lossless {
            muxing.set("frag_duration", "1000000");
        }
        muxing.set("flush_packets", "1");
        output.write_header_with(muxing).map_err(failed)?;
        let time_base = output
            .stream(0)
            .map_or(Rational::new(1, UNITS_PER_SECOND), |stream| stream.time_base());
        Ok(Self {
            encoder,
            output,
            path: shown,
            width,
            height,
            first: None,
            last: None,
            duration: (interval * f64::from(UNITS_PER_SECOND)).round() as i64,
            time_base,
            finished: false,
        })
    }

    /// Writes one picture; the first picture's time is the beginning of the video.
    ///
    /// # Errors
    /// A picture of the wrong size or not later than the one before (it is left out and the writer goes on), or a
    /// file that cannot be written.
    pub fn write(&mut self, time: Instant, picture: RgbView<'_>) -> Result<(), EncodeError> {
        let expected = self.width * self.height * 3;
        if (picture.width, picture.height) != (self.width, self.height) || picture.data.len() != expected {
            return Err(self.wrong_size(picture.data.len()));
        }
        self.encode(time, |frame| encode::planes_from_rgb(picture.data, frame))
    }

    /// Like [`VideoWriter::write`], of limited-range BT.601 planes: luma, then blue and red of half the width and
    /// height, rounded up.
    ///
    /// # Errors
    /// As [`VideoWriter::write`].
    pub fn write_planes(&mut self, time: Instant, planes: [&[u8]; 3]) -> Result<(), EncodeError> {
        let chroma = self.width.div_ceil(2) * self.height.div_ceil(2);
        let expected = [self.width * self.height, chroma, chroma];
        if planes.map(<[u8]>::len) != expected {
            return Err(self.wrong_size(planes.iter().map(|plane| plane.len()).sum()));
        }
        self.encode(time, |frame| encode::copy_planes(planes, frame))
    }

    fn encode(&mut self, time: Instant, fill: impl FnOnce(&mut frame::Video)) -> Result<(), EncodeError> {
        if self.finished {
            return Err(EncodeError::Finished {
                path: self.path.clone(),
            });
        }
        let first = *self.first.get_or_insert(time);
        let units = i128::from((time - first).nanoseconds()) * i128::from(UNITS_PER_SECOND);
        let units = (units + 500_000_000).div_euclid(1_000_000_000) as i64;
        if let Some(last) = self.last.filter(|last| units <= *last) {
            return Err(EncodeError::NotLater {
                path: self.path.clone(),
                time_s: time.seconds(),
                last_s: first.seconds() + last as f64 / f64::from(UNITS_PER_SECOND),
            });
        }
        self.last = Some(units);
        // The encoder may keep a reference to the last picture, so each gets memory of its own.
        let mut frame = frame::Video::new(Pixel::YUV420P, self.width as u32, self.height as u32);
        frame.set_color_range(color::Range::MPEG);
        frame.set_color_space(color::Space::SMPTE170M);
        fill(&mut frame);
        frame.set_pts(Some(units));
        self.encoder
            .send_frame(&frame)
            .map_err(|error| self.unwritable(error))?;
        self.drain()
    }

    fn wrong_size(&self, found: usize) -> EncodeError {
        EncodeError::WrongSize {
            path: self.path.clone(),
            found,
            width: self.width,
            height: self.height,
        }
    }

    /// Closes the file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(mut self) -> Result<(), EncodeError> {
        self.close()
    }

    fn close(&mut self) -> Result<(), EncodeError> {
        if std::mem::replace(&mut self.finished, true) {
            return Ok(());
        }
        let flushed = match self.encoder.send_eof() {
            Ok(()) | Err(Error::Eof) => self.drain(),
            Err(error) => Err(self.unwritable(error)),
        };
        let closed = self
            .output
            .write_trailer()
            .map_err(|error| self.unwritable(error));
        flushed.and(closed)
    }

    /// Moves what the encoder has ready to the file.
    fn drain(&mut self) -> Result<(), EncodeError> {
        loop {
            let mut packet = Packet::empty();
            match self.encoder.receive_packet(&mut packet) {
                Ok(()) => {}
                // Nothing more for now, or at all.
                Err(Error::Other { .. } | Error::Eof) => return Ok(()),
                Err(error) => return Err(self.unwritable(error)),
            }
            packet.set_stream(0);
            packet.set_duration(self.duration);
            packet.rescale_ts(Rational::new(1, UNITS_PER_SECOND), self.time_base);
            packet
                .write_interleaved(&mut self.output)
                .map_err(|error| self.unwritable(error))?;
        }
    }

    fn unwritable(&self, error: Error) -> EncodeError {
        EncodeError::Unwritable {
            path: self.path.clone(),
            reason: error.to_string(),
        }
    }
}

impl Drop for VideoWriter {
    fn drop(&mut self) {
        if let Err(error) = self.close() {
            tracing::error!(%error, "a video could not be closed");
        }
    }
}
