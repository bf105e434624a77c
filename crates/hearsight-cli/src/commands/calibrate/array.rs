//! Clock, turn and place of an array from people who talk and are seen.

mod seeing;

use crate::exit::Code;
use crate::overrides::RoomOverrides;
use crate::say;
use hearsight::Engine;
use hearsight::calibrate::speech::{
    ArrayCalibration, Lag, Listener, SpeechSettings, calibrate, measure_lag, sightings,
};
use hearsight::core::microphones::MicrophoneArray;
use hearsight::core::room::Room;
use hearsight::engine::config::load;
use miette::{IntoDiagnostic, miette};
use seeing::Seeing;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  hearsight calibrate array room.toml
  hearsight calibrate array room.toml --array table --offset 1.0 --turn 45
  hearsight calibrate array room.toml --json
Record one or two minutes of one person who walks about before the cameras, face towards them, and talks.

One calibrated camera tells how far away a face is by its width, badly. With two or more in the room file, heads are \
placed where the cameras' lines of sight meet, turned away or not: let whoever talks be seen by two at a time. Nothing has to \
be chosen; --set camera.NAME.start=... puts their clocks right, which must agree to a frame. Others may be in view: who \
is seen where the sound comes from counts. Walk to and fro and near as well as far: who stays at one distance makes a \
turn look like a step aside, which the printed deviations then say.";

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
    let mut engine = open(arguments)?;
    let number = array_of(engine.room(), arguments.array.as_deref())?;
    let sensor = engine.room().arrays[number].clone();
    let declared = MicrophoneArray::new(sensor.microphones.clone())
        .and_then(|array| array.with_speed_of_sound(engine.room().speed_of_sound_m_s))
        .into_diagnostic()?;
    let mut listener = Listener::new(&declared, sensor.rate_hz).into_diagnostic()?;
    let mut seeing = Seeing::new();
    while engine.step().is_some() {
        let tick = engine.tick();
        seeing.see(engine.room(), tick.scene, tick.moment);
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
    let lag = measure_lag(&seeing.followed, &seeing.found).unwrap_or(Lag::USUAL);
    let seen = sightings(&seeing.followed, lag.lag_s);
    let mut found = calibrate(&declared, &listener.loud(), &seen, &settings).into_diagnostic()?;
    // A tracker that lags as much more as it may would make the clock as much later.
    found.offset_deviation_s = found.offset_deviation_s.hypot(lag.deviation_s);
    let places = found.apply(&declared).into_diagnostic()?;
    print(arguments, &sensor.name, &found, lag, &places)?;
    Ok(Code::Done)
}

/// The room with a system that follows heads, whatever tracks it otherwise. Several cameras find a head's distance where
/// their lines of sight meet, so that heads that are turned away serve too; of one alone the width of a face must tell it.
fn open(arguments: &Arguments) -> miette::Result<Engine> {
    let mut overrides = arguments.overrides.list();
    let with_system = |overrides: &mut Vec<(String, String)>, name: &str| {
        overrides.push(("system.name".to_owned(), format!("{name:?}")));
    };
    with_system(&mut overrides, "three-mics");
    let resolved = load(&arguments.room, &overrides)?;
    let cameras = resolved.cameras.iter();
    if cameras.filter(|camera| camera.calibration.is_some()).count() < 2 {
        return Engine::open(resolved).into_diagnostic();
    }
    with_system(&mut overrides, "stac");
    overrides.push(("system.stac.modality".to_owned(), "\"video\"".to_owned()));
    Engine::open(load(&arguments.room, &overrides)?).into_diagnostic()
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

fn print(
    arguments: &Arguments,
    name: &str,
    found: &ArrayCalibration,
    lag: Lag,
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
            "lag_s": lag.lag_s, "lag_deviation_s": lag.deviation_s, "lag_faces": lag.faces,
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
    let by = match lag.faces {
        0 => "as is usual: too few faces are found to measure it".to_owned(),
        faces => format!("by {faces} faces"),
    };
    say::line(format_args!(
        "lag    of the tracks {:.3} +- {:.3} s, {by}",
        lag.lag_s, lag.deviation_s
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
