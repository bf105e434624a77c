//! Opens the sensors of a room, and checks that they fit each other.

mod fit;
mod panorama;

use crate::config::{Input, ResolvedArray, ResolvedCamera, ResolvedRoom};
use crate::error::EngineError;
use hearsight_core::camera::Camera;
use hearsight_core::room::{ArraySensor, CameraSensor, Room};
use hearsight_core::source::{AudioSource, VideoSource};
use hearsight_core::{Instant, Span};
use hearsight_media::{
    AudioFile, AudioOptions, ChannelSelection, ImageOptions, ImageSequence, InputOptions, LiveAudio,
    LiveVideo, MediaError, MomentOptions, MomentReader, Pace, QueueOptions, ReconnectingAudio,
    ReconnectingVideo, RunClock, SourceClock, VideoFile, VideoOptions,
};
use std::collections::BTreeMap;

/// Open sensors, ready to be read.
pub(crate) struct Sources {
    pub(crate) room: Room,
    pub(crate) reader: MomentReader,
    /// Where the run begins and ends; the end is unknown for live sources.
    pub(crate) start: Instant,
    pub(crate) end: Option<Instant>,
    pub(crate) live: bool,
}

/// Opens every sensor.
pub(crate) fn open(configuration: &ResolvedRoom) -> Result<Sources, EngineError> {
    let starts = configuration.cameras.iter().map(|camera| camera.start);
    let first = starts
        .chain(configuration.arrays.iter().map(|array| array.start))
        .flatten()
        .min();
    let clock = RunClock::starting_at(configuration.run.from.or(first).unwrap_or(Instant::ZERO));
    let (mut cameras, mut made) = (Vec::new(), Vec::new());
    for camera in &configuration.cameras {
        let (source, calibration) = match &camera.ring {
            Some(ring) => {
                let (source, calibration) = panorama::open(camera, ring, clock)?;
                (source, Some(calibration))
            }
            None => (open_camera(camera, clock)?, None),
        };
        cameras.push(source);
        made.push(calibration);
    }
    let mut arrays = Vec::new();
    for array in &configuration.arrays {
        arrays.push(open_array(array, clock)?);
    }
    align(configuration, cameras, &made, arrays, clock)
}

/// Sources of the caller's own instead of what the configuration names.
pub(crate) fn take(
    configuration: &ResolvedRoom,
    cameras: Vec<Box<dyn VideoSource>>,
    arrays: Vec<Box<dyn AudioSource>>,
) -> Result<Sources, EngineError> {
    let wanted = [configuration.cameras.len(), configuration.arrays.len()];
    let given = [cameras.len(), arrays.len()];
    if wanted != given {
        return Err(EngineError::Sources { wanted, given });
    }
    let starts = cameras.iter().map(|camera| camera.format().start);
    let first = starts
        .chain(arrays.iter().map(|array| array.format().start))
        .min();
    let clock = RunClock::starting_at(configuration.run.from.or(first).unwrap_or(Instant::ZERO));
    align(configuration, cameras, &[], arrays, clock)
}

/// Checks that sensors fit each other, and puts them on one clock.
fn align(
    configuration: &ResolvedRoom,
    cameras: Vec<Box<dyn VideoSource>>,
    made: &[Option<Camera>],
    arrays: Vec<Box<dyn AudioSource>>,
    clock: RunClock,
) -> Result<Sources, EngineError> {
    let room = room(configuration, &cameras, made, &arrays)?;
    let ranges = fit::ranges(&room, &cameras, &arrays);
    fit::check(&room, &ranges, configuration)?;
    let live =
        cameras.iter().any(|camera| camera.format().live) || arrays.iter().any(|array| array.format().live);
    let (start, end) = fit::whole(&ranges, live, configuration);
    let options = MomentOptions {
        tick: configuration.run.tick,
        from: configuration.run.from,
        // The engine ends the run: a tick that is cut short would differ from the same tick of a longer run.
        until: None,
        clock: live.then_some(clock),
        ..MomentOptions::default()
    };
    let named_cameras = configuration.cameras.iter().zip(cameras);
    let named_arrays = configuration.arrays.iter().zip(arrays);
    let reader = MomentReader::new(
        named_cameras
            .map(|(camera, source)| hearsight_media::Camera {
                name: camera.name.clone(),
                source,
            })
            .collect(),
        named_arrays
            .map(|(array, source)| hearsight_media::Microphones {
                name: array.name.clone(),
                source,
            })
            .collect(),
        options,
    )?;
    Ok(Sources {
        room,
        reader,
        start,
        end,
        live,
    })
}

/// Opens and closes each sensor by itself: its name, and its facts for people or what is wrong.
pub(crate) fn open_each(configuration: &ResolvedRoom) -> Vec<(String, Result<String, EngineError>)> {
    let clock = RunClock::starting_at(Instant::ZERO);
    let cameras = configuration.cameras.iter().map(|camera| {
        let opened = match &camera.ring {
            Some(ring) => panorama::open(camera, ring, clock).map(|(source, _)| source),
            None => open_camera(camera, clock),
        };
        let opened = opened.map(|source| {
            let format = source.format();
            let rate = 1.0 / format.interval.seconds();
            let length = match format.frames {
                Some(frames) => format!("{frames} frames"),
                None => if format.live { "live" } else { "of unknown length" }.to_owned(),
            };
            format!(
                "{} x {} pixels, {rate:.2} frames a second, {length}",
                format.width, format.height
            )
        });
        (camera.name.clone(), opened)
    });
    let arrays = configuration.arrays.iter().map(|array| {
        let opened = open_array(array, clock).map(|source| {
            let format = source.format();
            let rate = f64::from(format.rate_hz.max(1));
            let length = match format.samples {
                Some(count) => format!("{:.2} s", count as f64 / rate),
                None => if format.live { "live" } else { "of unknown length" }.to_owned(),
            };
            format!(
                "{} channels, {} samples a second, {length}",
                format.channels, format.rate_hz
            )
        });
        (array.name.clone(), opened)
    });
    cameras.chain(arrays).collect()
}

fn source_clock(start: Option<Instant>, drift_ppm: f64, clock: RunClock) -> SourceClock {
    let mut source = start.map_or_else(|| SourceClock::on_arrival(clock), SourceClock::at);
    source.drift_ppm = drift_ppm;
    source
}

fn input_options(format: &Option<String>, options: &BTreeMap<String, String>) -> InputOptions {
    InputOptions {
        format: format.clone(),
        parameters: options
            .iter()
            .map(|(key, value)| (key.clone(), value.clone()))
            .collect(),
        ..InputOptions::default()
    }
}

fn open_camera(camera: &ResolvedCamera, clock: RunClock) -> Result<Box<dyn VideoSource>, EngineError> {
    let source = camera_source(camera, clock).map_err(|error| EngineError::Sensor {
        sensor: camera.name.clone(),
        error,
    })?;
    let Some(pace) = pace(camera.paced, source.format().live, clock) else {
        return Ok(source);
    };
    let queue = QueueOptions {
        name: camera.name.clone(),
        pace,
        ..QueueOptions::default()
    };
    Ok(Box::new(LiveVideo::spawn(source, &queue).map_err(no_thread)?))
}

/// There is no file behind a panorama.
fn nothing(name: &str) -> MediaError {
    MediaError::Missing {
        location: name.to_owned(),
    }
}

fn camera_source(camera: &ResolvedCamera, run: RunClock) -> Result<Box<dyn VideoSource>, MediaError> {
    let clock = source_clock(camera.start, camera.drift_ppm, run);
    let name = camera.name.clone();
    if let Input::Images(pattern) = &camera.input {
        let options = ImageOptions {
            name,
            clock,
            interval: Span::from_seconds(1.0 / camera.rate_hz),
        };
        return Ok(Box::new(ImageSequence::open(pattern, options)?));
    }
    let input = input_options(&camera.format, &camera.options);
    let options = VideoOptions {
        name,
        clock,
        interval: None,
        input,
    };
    let location = match &camera.input {
        // Opened as what it is made of.
        Input::Panorama => return Err(nothing(&camera.name)),
        Input::File(path) | Input::Images(path) => return Ok(Box::new(VideoFile::open(path, options)?)),
        Input::Device(location) | Input::Stream(location) => location,
    };
    let source = VideoFile::open_location(location, options.clone())?;
    if !source.format().live || camera.reconnect_s == 0.0 {
        return Ok(Box::new(source));
    }
    let patience = Span::from_seconds(camera.reconnect_s);
    let source = ReconnectingVideo::around(source, location, options, run, patience);
    Ok(Box::new(source))
}

fn open_array(array: &ResolvedArray, clock: RunClock) -> Result<Box<dyn AudioSource>, EngineError> {
    let source = array_source(array, clock).map_err(|error| EngineError::Sensor {
        sensor: array.name.clone(),
        error,
    })?;
    let Some(pace) = pace(array.paced, source.format().live, clock) else {
        return Ok(source);
    };
    let queue = QueueOptions {
        name: array.name.clone(),
        pace,
        ..QueueOptions::default()
    };
    Ok(Box::new(LiveAudio::spawn(source, &queue).map_err(no_thread)?))
}

fn array_source(array: &ResolvedArray, run: RunClock) -> Result<Box<dyn AudioSource>, MediaError> {
    let channels = match &array.channels {
        Some(channels) => ChannelSelection::These(channels.clone()),
        None if array.microphones.is_empty() => ChannelSelection::All,
        None => ChannelSelection::Exactly(array.microphones.len()),
    };
    let options = AudioOptions {
        name: array.name.clone(),
        clock: source_clock(array.start, array.drift_ppm, run),
        channels,
        rate_hz: array.rate_hz,
        input: input_options(&array.format, &array.options),
    };
    let location = match &array.input {
        Input::Panorama => return Err(nothing(&array.name)),
        Input::File(path) | Input::Images(path) => return Ok(Box::new(AudioFile::open(path, options)?)),
        Input::Device(location) | Input::Stream(location) => location,
    };
    let source = AudioFile::open_location(location, options.clone())?;
    if !source.format().live || array.reconnect_s == 0.0 {
        return Ok(Box::new(source));
    }
    let patience = Span::from_seconds(array.reconnect_s);
    let source = ReconnectingAudio::around(source, location, options, run, patience);
    Ok(Box::new(source))
}

/// How a source is queued; nothing for a file that waits to be read.
fn pace(paced: bool, live: bool, clock: RunClock) -> Option<Pace> {
    match (live, paced) {
        (true, _) => Some(Pace::AsItComes),
        (false, true) => Some(Pace::By(clock)),
        (false, false) => None,
    }
}

fn no_thread(error: std::io::Error) -> EngineError {
    EngineError::Threads {
        threads: 1,
        reason: error.to_string(),
    }
}

/// What systems may know of the sensors.
fn room(
    configuration: &ResolvedRoom,
    cameras: &[Box<dyn VideoSource>],
    made: &[Option<Camera>],
    arrays: &[Box<dyn AudioSource>],
) -> Result<Room, EngineError> {
    let cameras = configuration.cameras.iter().zip(cameras).enumerate();
    let cameras = cameras.map(|(number, (camera, source))| {
        let format = source.format();
        let lens = camera.calibration.as_ref();
        let calibration = lens
            .map(|lens| lens.camera(format.width, format.height))
            .transpose();
        Ok(CameraSensor {
            name: camera.name.clone(),
            width: format.width,
            height: format.height,
            interval: format.interval,
            calibration: calibration
                .map_err(|error| EngineError::Calibration {
                    camera: camera.name.clone(),
                    error,
                })?
                .or(made.get(number).copied().flatten()),
        })
    });
    let arrays = configuration.arrays.iter().zip(arrays).map(|(array, source)| {
        let format = source.format();
        ArraySensor {
            name: array.name.clone(),
            rate_hz: format.rate_hz,
            channels: format.channels,
            microphones: array.microphones.clone(),
            camera: array.camera,
        }
    });
    Ok(Room {
        cameras: cameras.collect::<Result<_, EngineError>>()?,
        arrays: arrays.collect(),
        speed_of_sound_m_s: configuration.speed_of_sound_m_s,
    })
}
