//! Clock, turn and place of an array from people who talk and are seen.

use crate::exit::Code;
use crate::overrides::RoomOverrides;
use crate::say;
use hearsight::Engine;
use hearsight::calibrate::speech::{ArrayCalibration, Listener, Sighting, SpeechSettings, calibrate};
use hearsight::core::Instant;
use hearsight::core::camera::Camera;
use hearsight::core::microphones::MicrophoneArray;
use hearsight::core::record::ViewRecord;
use hearsight::core::room::Room;
use hearsight::engine::config::load;
use hearsight::tracking::sight_and_sound::{AssociationSettings, SightLine};
use miette::{IntoDiagnostic, miette};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  hearsight calibrate array room.toml
  hearsight calibrate array room.toml --array table --offset 1.0 --turn 45
  hearsight calibrate array room.toml --json
Record one or two minutes of one person who walks about before the cameras, face towards them, and talks.";

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The room, with calibrated cameras that have a place, and the array as far as it is known.
    room: PathBuf,
    #[command(flatten)]
    overrides: RoomOverrides,
    /// Name of the array. Default: the only one.
    #[arg(long, value_name = "NAME")]
    array: Option<String>,
    /// Largest offset of the array's clock, seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.4)]
    offset: f64,
    /// Largest turn of the array, degrees.
    #[arg(long, value_name = "DEGREES", default_value_t = 30.0)]
    turn: f64,
    /// How far the array may be from where it is declared, a standard deviation, metres.
    #[arg(long, value_name = "METRES", default_value_t = 0.3)]
    place: f64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// The height of a mouth in the box of a head.
const MOUTH: f64 = 0.75;
/// Width of a cascade's box over that of the head in it.
const FACE: f64 = 1.0 / 0.85;

/// Follows faces, listens, calibrates and prints.
pub(super) fn run(arguments: &Arguments) -> miette::Result<Code> {
    for (name, value) in [
        ("--offset", arguments.offset),
        ("--turn", arguments.turn),
        ("--place", arguments.place),
    ] {
        if !(value > 0.0 && value <= 180.0) {
            return Err(miette!("{name} is {value}; give a number above 0"));
        }
    }
    let mut overrides = arguments.overrides.list();
    // Faces alone are wanted, whatever tracks this room otherwise.
    overrides.push(("system.name".to_owned(), "\"three-mics\"".to_owned()));
    let mut engine = Engine::open(load(&arguments.room, &overrides)?).into_diagnostic()?;
    let number = array_of(engine.room(), arguments.array.as_deref())?;
    let sensor = engine.room().arrays[number].clone();
    let declared = MicrophoneArray::new(sensor.microphones.clone())
        .and_then(|array| array.with_speed_of_sound(engine.room().speed_of_sound_m_s))
        .into_diagnostic()?;
    let mut listener = Listener::new(&declared, sensor.rate_hz).into_diagnostic()?;
    let mut seen = Vec::new();
    while engine.step().is_some() {
        let tick = engine.tick();
        let room = engine.room();
        for (track, view) in tick
            .scene
            .tracks
            .iter()
            .flat_map(|track| track.views.iter().map(move |view| (track, view)))
        {
            let camera = room.cameras.iter().position(|camera| camera.name == view.camera);
            let new = camera.and_then(|camera| tick.moment.video.get(camera)?.get());
            let calibration = camera.and_then(|camera| room.cameras[camera].calibration);
            if let (Some(frame), Some(calibration)) = (new, calibration) {
                seen.extend(sighting(&calibration, track.id, view, frame.time));
            }
        }
        if let Some(block) = tick.moment.audio.get(number).and_then(|block| block.get()) {
            listener.hear(block).into_diagnostic()?;
        }
    }
    let settings = SpeechSettings {
        offset_s: arguments.offset,
        turn_deg: arguments.turn,
        place_m: [arguments.place, SpeechSettings::default().place_m[1]],
        ..SpeechSettings::default()
    };
    let found = calibrate(&declared, &listener.loud(), &seen, &settings).into_diagnostic()?;
    let places = found.apply(&declared).into_diagnostic()?;
    print(arguments, &sensor.name, &found, &places)?;
    Ok(Code::Done)
}

fn array_of(room: &Room, name: Option<&str>) -> miette::Result<usize> {
    let names = || {
        let names: Vec<&str> = room.arrays.iter().map(|array| array.name.as_str()).collect();
        names.join(", ")
    };
    match name {
        Some(name) => room
            .arrays
            .iter()
            .position(|array| array.name == name)
            .ok_or_else(|| miette!("there is no array {name}; there are: {}", names())),
        None if room.arrays.len() == 1 => Ok(0),
        None => Err(miette!("say which array with --array; there are: {}", names())),
    }
}

/// A mouth in the room, from its pixel and from how wide the face is.
fn sighting(camera: &Camera, person: u64, view: &ViewRecord, time: Instant) -> Option<Sighting> {
    let head = &view.head;
    let pixel = (
        (head.left + head.width / 2.0) as f32,
        (head.top + MOUTH * head.height) as f32,
    );
    let width_px = FACE * head.width;
    let deviation_px = (0.1 * width_px).hypot(view.deviation_px[0].max(view.deviation_px[1]));
    let width_m = AssociationSettings::default().face_width();
    let line = SightLine::new(
        camera,
        pixel,
        deviation_px,
        width_px,
        0.05 * width_px,
        Some(width_m),
    )?;
    let estimate = line.estimate()?;
    Some(Sighting {
        time,
        person,
        mouth: estimate.mean,
        covariance: estimate.covariance,
    })
}

fn print(
    arguments: &Arguments,
    name: &str,
    found: &ArrayCalibration,
    places: &MicrophoneArray,
) -> miette::Result<()> {
    let microphones: Vec<[f64; 3]> = places
        .positions()
        .iter()
        .map(|place| [0, 1, 2].map(|axis| (place.0[axis] * 1e4).round() / 1e4))
        .collect();
    let (turn_deg, turn_deviation_deg) = (found.turn_rad.to_degrees(), found.turn_deviation_rad.to_degrees());
    if arguments.json {
        let shift: [f64; 3] = found.shift_m.into();
        let shift_deviation: [f64; 3] = found.shift_deviation_m.into();
        let value = serde_json::json!({
            "array": name,
            "offset_s": found.offset_s, "offset_deviation_s": found.offset_deviation_s,
            "turn_deg": turn_deg, "turn_deviation_deg": turn_deviation_deg,
            "shift_m": shift, "shift_deviation_m": shift_deviation,
            "frames": found.frames, "share": found.share,
            "microphones_m": microphones,
        });
        say::line(serde_json::to_string_pretty(&value).into_diagnostic()?);
        return Ok(());
    }
    say::line(format_args!(
        "{name}: {} loud frames with somebody seen, {:.0} % of them fit",
        found.frames,
        100.0 * found.share
    ));
    say::line(format_args!(
        "clock  add {:.3} +- {:.3} s to the array's start",
        found.offset_s, found.offset_deviation_s
    ));
    say::line(format_args!(
        "turn   {turn_deg:.1} +- {turn_deviation_deg:.1} degrees, counter-clockwise from above"
    ));
    let (shift, deviation) = (found.shift_m, found.shift_deviation_m);
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        say::line(format_args!(
            "{name}      {:+.3} +- {:.3} m",
            shift[axis], deviation[axis]
        ));
    }
    let list = microphones.iter().map(|place| format!("{place:?}"));
    say::line(format_args!(
        "microphones = [{}]",
        list.collect::<Vec<_>>().join(", ")
    ));
    Ok(())
}
