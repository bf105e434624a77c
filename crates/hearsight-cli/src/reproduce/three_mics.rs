//! Experiment D3: the three-mics system in a living room, three people in armchairs before a television set.
//!
//! Errors of sound alone and of sound with pictures, how much of speech and of silence is recognized, what the corrected
//! equations and the external filter are worth, and what the paper did not try: walking, a child, a television that talks, a
//! dead microphone, a longer reverberation.

mod judgement;
mod measured;

use super::lockstep::{Variant, follow};
use super::{Experiment, Extent, Measured, Trial};
use hearsight::core::Moment;
use hearsight::sim::scenario;
use hearsight::sim::simulation::Simulation;
use measured::Measurement;
use miette::IntoDiagnostic;
use serde_json::{Value, json};

/// The experiment.
pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "three-mics",
    paper: "Pnevmatikakis, Talantzis: Person tracking in enhanced cognitive care: a particle filtering approach",
    scenes,
    run,
    judge: judgement::judge,
    causes: &[
        (
            &[
                "ratio-x",
                "ratio-y",
                "audio-x",
                "audio-y",
                "fused-x",
                "fused-y",
                "fused-z",
                "equal-point",
            ],
            "the paper's filter follows a fan, which the phase transform makes as loud as a voice (direction wrong by 2, 65 and 84 \
             degrees in the median of speech in three other scenes), and stays where somebody spoke for a second of silence, before \
             the external filter takes over. With 0.2 s instead of 1 s the equal point is 0.71 to 0.80 in those scenes; without the \
             frequencies that are no louder than the noise the direction is wrong by 1 to 2 degrees",
        ),
        (
            &[
                "better-error",
                "child",
                "dead-microphone",
                "long-reverberation",
                "better-equal",
            ],
            "where two faces are drawn so wide and so narrow that each, at a wrong distance, is where the other's sound comes from, \
             they are exchanged and stay so, or nobody is marked (looked at in three scenes: boxes 0.12 and 0.21 m wide, 0.165 m in \
             the mean); of one person of one scene no face was found for half a minute",
        ),
        (
            &["external"],
            "away from the trap the paper's filter is on a fan as well: for 0.78 of the quiet time where there is no trap, 0.81 where \
             there is one",
        ),
        (&["product"], "not found out; probably both follow the fans alike"),
        (
            &["walking"],
            "who turns away from the only camera has no face and loses the track; their sound is then taken for somebody else's who \
             stands in that direction (looked at in one scene: a third of the time of all people without a track within 0.6 m)",
        ),
    ],
};

const SEATED: &str = "seated";
const TRAP: &str = "trap";
const WALKING: &str = "walking";
const CHILD: &str = "child";
const TELEVISION: &str = "television";
const DEAD: &str = "dead microphone";
const LONG: &str = "T60 1 s";

const PAPER: &str = "paper, corrected";
const PRINTED: &str = "eq. 13 as printed";
const SUM: &str = "sum of pairs";
const PLAIN_RESTART: &str = "no external filter";
const WEIGHTED: &str = "weighted fusion";
const OURS: &str = "beyond the paper";

/// The microphone that gives nothing in scene [`DEAD`].
const DEAD_CHANNEL: usize = 0;

fn scenes(extent: Extent) -> Vec<(&'static str, u64)> {
    // 25 minutes of seated people are the paper's five recordings of five.
    let (seated, beyond) = match extent {
        Extent::Quick => (8, 2),
        Extent::Full => (25, 10),
    };
    let mut scenes = vec![(SEATED, seated), (TRAP, seated)];
    scenes.extend([WALKING, CHILD, TELEVISION, DEAD, LONG].map(|scene| (scene, beyond)));
    scenes
}

/// File, text, short and full length of a scene, seconds.
fn scene(name: &str) -> (&'static str, String, f64, f64) {
    let seated = include_str!("../../../../scenes/three-mics.toml");
    let file = "three-mics.toml";
    let with = |more: &str| format!("{seated}\n{more}");
    match name {
        WALKING => {
            let text = include_str!("../../../../scenes/three-mics-walking.toml");
            ("three-mics-walking.toml", text.to_owned(), 10.0, 30.0)
        }
        CHILD => {
            let text = include_str!("../../../../scenes/three-mics-child.toml");
            ("three-mics-child.toml", text.to_owned(), 10.0, 30.0)
        }
        // As loud as people at the microphones, 1.5 m and more from every seat.
        TELEVISION => (
            file,
            with("[[noise]]\nkind = \"television\"\nname = \"rival\"\nat = [4.9, 2.6, 1.1]\nsnr = 0\n"),
            10.0,
            30.0,
        ),
        // As loud as a reflection from a bare wall can be and louder: it draws the filter away, and then stops.
        TRAP => (
            file,
            with(
                "[[noise]]\nkind = \"television\"\nname = \"rival\"\nat = [5.0, 3.6, 1.2]\nsnr = -10\nduring = [[0.3, \
                 2.0], [5.0, 6.5], [10.0, 11.5], [15.0, 16.5], [20.0, 21.5], [25.0, 26.5]]\n",
            ),
            10.0,
            30.0,
        ),
        _ => (file, seated.to_owned(), 10.0, 60.0),
    }
}

fn run(trial: &Trial) -> miette::Result<Measured> {
    let (file, text, short_s, full_s) = scene(&trial.scene);
    let seconds = if trial.quick { short_s } else { full_s };
    let mut overrides = vec![
        ("seed".to_owned(), trial.seed.to_string()),
        ("seconds".to_owned(), format!("{seconds:?}")),
    ];
    if trial.scene == LONG {
        overrides.push(("room.t60".to_owned(), "1.0".to_owned()));
    }
    let world = scenario::from_text(file, &text, &overrides)?;
    let simulation = Simulation::new(world).into_diagnostic()?;
    let variants = variants(&trial.scene);
    let mut measurements: Vec<Measurement> = variants.iter().map(|_| Measurement::default()).collect();
    let is_dead = trial.scene == DEAD;
    follow(
        &simulation,
        trial.seed,
        &variants,
        &mut |moment| {
            if is_dead {
                silence(moment);
            }
        },
        &mut |said| measurements[said.variant].push(said.scene, said.truth, "rival"),
    )?;
    Ok(variants
        .iter()
        .zip(&measurements)
        .map(|(variant, measurement)| (variant.name.to_owned(), measurement.metrics()))
        .collect())
}

/// A microphone that gives nothing.
fn silence(moment: &mut Moment) {
    for block in &mut moment.audio {
        if let Some(channel) = block.data.channels.get_mut(DEAD_CHANNEL) {
            channel.fill(0.0);
        }
    }
}

/// The paper's system with its own settings and the corrected equations. Widths of faces are the paper's by the ratio of
/// the boxes: OpenCV's cascade boxes a face 1.27 times as wide as the paper's, which was cropped above the eyebrows.
fn paper() -> Value {
    json!({
        "room": { "low_m": [0.0, 0.0, 0.0], "high_m": [5.5, 4.5, 2.7] },
        "audio": { "frame_s": 0.27, "hop_s": 0.1, "gate_db": -100.0 },
        "sound": {
            "particles": 50,
            "external": { "filter": { "particles": 500, "distance_m": 1.0, "time_s": 1.0 } },
        },
        "vision": { "smallest_px": 40, "largest_px": 120 },
        "association": { "weighted": false, "residual_m": 0.6, "height_m": [0.7, 2.1], "face_width_m": [0.141, 0.24] },
        "beyond": { "voice_gate": false, "face_range": false, "at_faces": false },
    })
}

/// Our own: what is default. The cascade boxes rendered adults 0.166 m wide in the mean (deviation 0.016 m, thirteen people
/// of seeds from 101; the bounds are more than two deviations away), less than the real ones that the default is for
/// (0.19 m). Faces in profile are not sought: that cascade boxes the same head a fifth wider, and everybody would seem half
/// a metre nearer. Boxes of the one cascade scatter less than those of two.
fn ours() -> Value {
    json!({
        "room": { "low_m": [0.0, 0.0, 0.0], "high_m": [5.5, 4.5, 2.7] },
        "vision": { "smallest_px": 40, "largest_px": 120 },
        "association": { "face_width_m": [0.12, 0.21] },
        "place": { "walk_m": 0.3, "box_deviation": 0.06 },
    })
}

fn variants(scene: &str) -> Vec<Variant> {
    let changed = |name: &'static str, pointer: &str, value: Value| {
        let mut parameters = paper();
        let (table, key) = pointer.split_once('.').unwrap_or((pointer, ""));
        parameters[table][key] = value;
        variant(name, parameters)
    };
    let mut variants = vec![variant(PAPER, paper()), variant(OURS, ours())];
    if scene == SEATED {
        variants.extend([
            changed(PRINTED, "faces.likelihood", json!({ "printed": true })),
            changed(SUM, "audio.response", json!({ "combination": "sum" })),
            changed(WEIGHTED, "association.weighted", json!(true)),
        ]);
    }
    if scene == TRAP {
        variants.push(changed(PLAIN_RESTART, "sound.external", json!("off")));
    }
    variants
}

fn variant(name: &'static str, parameters: Value) -> Variant {
    Variant {
        name,
        system: EXPERIMENT.name,
        parameters,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_resolves_and_every_variant_can_be_built() {
        for (name, _) in scenes(Extent::Full) {
            let (file, text, ..) = scene(name);
            let world = scenario::from_text(file, &text, &Vec::new()).unwrap();
            let room = Simulation::new(world).unwrap().room();
            let variants = variants(name);
            for (place, variant) in variants.iter().enumerate() {
                hearsight::systems::build(variant.system, &variant.parameters, &room, 1).unwrap();
                assert!(variants[..place].iter().all(|other| other.name != variant.name));
            }
        }
    }
}
