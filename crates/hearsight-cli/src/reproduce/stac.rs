//! Experiment D2: the stac system on scenes VO (a pillar hides the talker) and SD (two people talk in turns).
//!
//! Table 1 of the paper, sound alone and sound with pictures, by what is done against reverberation; pictures alone at
//! occlusions; who speaks; and eq. 8 as printed, which must fail. Errors are of the column alone, since two microphones
//! tell no more.

use super::claim::{Claim, Report, Statement, Table, cell, mean_within, ratio_within, reduction, smaller};
use super::lockstep::{Variant, observe};
use super::observed::{Axes, Observed};
use super::trials::Results;
use super::{Experiment, Extent, Measured, Trial};
use hearsight::sim::scenario;
use hearsight::sim::simulation::Simulation;
use miette::IntoDiagnostic;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The experiment.
pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "stac",
    paper: "Bregonzio, Taj, Cavallaro: Multi-modal particle filtering tracking using appearance, motion and audio \
            likelihoods",
    scenes,
    run,
    judge,
    causes: &[
        (
            &[
                "audio-onset",
                "audio-bands",
                "audio-onset-size",
                "audio-bands-size",
                "right-speaker",
            ],
            "the scene. With 0.6 s of reverberation a wall that somebody faces sounds louder at the microphones than a mouth \
             turned away: the delays heard are those of its mirror image, steadily, which neither onsets nor bands remove. \
             At 0.3 s and without noise the right one is marked for 91 % instead of 43 % (one seed). The paper does not say \
             how its people were turned",
        ),
        (
            &[
                "both-onset",
                "both-bands",
                "both-onset-size",
                "both-bands-size",
                "printed-fails",
            ],
            "the tracker: where pictures show the walker they decide, and where the pillar hides him the sound of the mirror \
             image (above) does not hold the track, so that errors come from being lost, in either form",
        ),
        (
            &["both-switches"],
            "the tracker: behind the pillar the track ends, since the sound heard there is a mirror image's for much of the \
             time, and the walker who comes out is somebody new",
        ),
    ],
};

const OCCLUSION: &str = "VO";
const DIALOGUE: &str = "SD";
/// The person whom scene VO is about.
const WALKER: u64 = 1;
/// Farther from the person, a track is of somebody or something else: a quarter of the picture, since sound alone is
/// coarse.
const GATE_PX: f64 = 90.0;
/// How near to a head a track of a picture must be, pixels.
const HEAD_GATE_PX: f64 = 30.0;

/// What is done against reverberation: name, onset filter, bands.
const AGAINST_REVERBERATION: [(&str, bool, bool); 3] = [
    ("plain", false, false),
    ("onset", true, false),
    ("onset+bands", true, true),
];
const AUDIO: [&str; 3] = ["audio plain", "audio onset", "audio onset+bands"];
const BOTH: [&str; 3] = ["both plain", "both onset", "both onset+bands"];
const VIDEO: &str = "video";
const PRINTED: &str = "both, eq. 8 printed";
const OURS: &str = "both, beyond the paper";

fn scenes(extent: Extent) -> Vec<(&'static str, u64)> {
    match extent {
        Extent::Quick => vec![(OCCLUSION, 8), (DIALOGUE, 8)],
        Extent::Full => vec![(OCCLUSION, 20), (DIALOGUE, 20)],
    }
}

fn run(trial: &Trial) -> miette::Result<Measured> {
    let (file, text, short_s, variants) = if trial.scene == OCCLUSION {
        // The first walk behind the pillar and on.
        (
            "stac-vo.toml",
            include_str!("../../../../scenes/stac-vo.toml"),
            7.4,
            occlusion_variants(),
        )
    } else {
        (
            "stac-sd.toml",
            include_str!("../../../../scenes/stac-sd.toml"),
            12.0,
            dialogue_variants(),
        )
    };
    let mut overrides = vec![("seed".to_owned(), trial.seed.to_string())];
    if trial.quick {
        overrides.push(("seconds".to_owned(), format!("{short_s:?}")));
    }
    let world = scenario::from_text(file, text, &overrides)?;
    let simulation = Simulation::new(world).into_diagnostic()?;
    let observed = observe(&simulation, trial.seed, &variants)?;
    let mut measured = Measured::new();
    for (variant, observed) in variants.iter().zip(&observed) {
        let metrics = if trial.scene == OCCLUSION {
            following(observed)?
        } else {
            speaking(observed)?
        };
        measured.insert(variant.name.to_owned(), metrics);
    }
    Ok(measured)
}

fn following(observed: &Observed) -> miette::Result<BTreeMap<String, f64>> {
    let Some(following) = observed.following(WALKER, GATE_PX, Axes::Column)? else {
        return Ok(BTreeMap::new());
    };
    let mut metrics = BTreeMap::from([
        ("error_px".to_owned(), following.error_px),
        ("switches".to_owned(), following.switches),
        ("share".to_owned(), following.share),
    ]);
    if let Some(error_px) = observed.hearing_error() {
        metrics.insert("hearing_error_px".to_owned(), error_px);
    }
    Ok(metrics)
}

fn speaking(observed: &Observed) -> miette::Result<BTreeMap<String, f64>> {
    let mut metrics = BTreeMap::from([("diarization_error".to_owned(), observed.diarization_error()?)]);
    if let Some(right) = observed.right_speaker(HEAD_GATE_PX)? {
        metrics.insert("right_speaker".to_owned(), right);
    }
    Ok(metrics)
}

/// The paper's system: what we added for several people is off, and its one person is not given up when nothing is seen.
fn as_in_the_paper(more: &[(&str, Value)]) -> Value {
    let mut parameters = json!({
        "detected": { "share": 0.0 },
        "encounter": { "margin": 9.0, "stranger": 9.0 },
        "re_entry": { "enabled": false },
        "existence": { "absent": -0.5, "present": -0.5 },
    });
    for (name, value) in more {
        parameters[*name] = value.clone();
    }
    parameters
}

fn variant(name: &'static str, parameters: Value) -> Variant {
    Variant {
        name,
        system: EXPERIMENT.name,
        parameters,
    }
}

fn occlusion_variants() -> Vec<Variant> {
    let mut variants = Vec::new();
    for (row, (_, onset_filter, bands)) in AGAINST_REVERBERATION.into_iter().enumerate() {
        let audio = json!({ "onset_filter": onset_filter, "bands": bands });
        let only = [("modality", json!("audio")), ("audio", audio.clone())];
        let both = [("one_talker", json!(true)), ("audio", audio)];
        variants.push(variant(AUDIO[row], as_in_the_paper(&only)));
        variants.push(variant(BOTH[row], as_in_the_paper(&both)));
    }
    variants.push(variant(VIDEO, as_in_the_paper(&[("modality", json!("video"))])));
    variants.push(variant(
        PRINTED,
        as_in_the_paper(&[("one_talker", json!(true)), ("printed_equation_8", json!(true))]),
    ));
    variants.push(variant(OURS, json!({})));
    variants
}

fn dialogue_variants() -> Vec<Variant> {
    vec![variant(BOTH[2], as_in_the_paper(&[])), variant(OURS, json!({}))]
}

fn judge(results: &Results) -> Report {
    Report {
        tables: vec![
            table_1(results),
            table_of_occlusions(results),
            table_of_speakers(results),
        ],
        claims: claims(results),
    }
}

fn table_1(results: &Results) -> Table {
    let row = |name: &str, paper: [f64; 3], ours: [&str; 3]| {
        let mut cells = vec![name.to_owned()];
        for (paper, ours) in paper.into_iter().zip(ours) {
            cells.push(format!("{paper:.2}"));
            cells.push(cell(&results.values(OCCLUSION, "error_px", ours), 2));
        }
        cells
    };
    let columns = [
        "scene VO",
        "plain: paper",
        "ours",
        "onset: paper",
        "ours",
        "onset+bands: paper",
        "ours",
    ];
    Table {
        title: "Table 1: mean error of the column, pixels (ours with its interval of 95 %)".to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: vec![
            row("audio only", [28.63, 23.35, 15.36], AUDIO),
            row("audio-visual", [4.47, 3.93, 3.47], BOTH),
        ],
    }
}

fn table_of_occlusions(results: &Results) -> Table {
    let names = AUDIO.into_iter().chain(BOTH).chain([VIDEO, PRINTED, OURS]);
    let value = |name: &str, metric: &str| cell(&results.values(OCCLUSION, metric, name), 2);
    Table {
        title: "Scene VO: how the talker is followed past the pillar".to_owned(),
        columns: [
            "variant",
            "error, px",
            "of what is heard, px",
            "switches",
            "share with a track",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: names
            .map(|name| {
                let mut row = vec![name.to_owned()];
                row.extend(
                    ["error_px", "hearing_error_px", "switches", "share"].map(|metric| value(name, metric)),
                );
                row
            })
            .collect(),
    }
}

fn table_of_speakers(results: &Results) -> Table {
    let value = |name: &str, metric: &str| cell(&results.values(DIALOGUE, metric, name), 3);
    Table {
        title: "Scene SD: who speaks".to_owned(),
        columns: [
            "variant",
            "right speaker, share of speech",
            "diarization error rate",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: [BOTH[2], OURS]
            .into_iter()
            .map(|name| {
                vec![
                    name.to_owned(),
                    value(name, "right_speaker"),
                    value(name, "diarization_error"),
                ]
            })
            .collect(),
    }
}

fn claims(results: &Results) -> Vec<Claim> {
    let errors = |pair: [&str; 2]| results.rows(OCCLUSION, "error_px", pair);
    let switches = |name: &str| results.values(OCCLUSION, "switches", name);
    let said = |id: &'static str, text: &str, paper: Option<f64>| Statement {
        id,
        text: text.to_owned(),
        paper,
    };
    let ratio = |id, text, row: usize, paper| {
        ratio_within(
            said(id, text, Some(paper)),
            &errors([BOTH[row], AUDIO[row]]),
            [0.0, 0.25],
        )
    };
    vec![
        smaller(
            said(
                "audio-onset",
                "sound alone: the onset filter reduces the error (share of it)",
                Some(0.184),
            ),
            &errors([AUDIO[1], AUDIO[0]]),
        ),
        smaller(
            said(
                "audio-bands",
                "sound alone: bands reduce the error that the onset filter leaves",
                Some(0.342),
            ),
            &errors([AUDIO[2], AUDIO[1]]),
        ),
        reduction(
            said(
                "audio-onset-size",
                "sound alone: the onset filter saves 10 to 30 %",
                Some(0.184),
            ),
            &errors([AUDIO[1], AUDIO[0]]),
            [0.10, 0.30],
        ),
        reduction(
            said(
                "audio-bands-size",
                "sound alone: onset filter and bands save 35 to 55 %",
                Some(0.463),
            ),
            &errors([AUDIO[2], AUDIO[0]]),
            [0.35, 0.55],
        ),
        smaller(
            said(
                "both-onset",
                "with pictures: the onset filter reduces the error (share of it)",
                Some(0.121),
            ),
            &errors([BOTH[1], BOTH[0]]),
        ),
        smaller(
            said(
                "both-bands",
                "with pictures: bands reduce the error that the onset filter leaves",
                Some(0.117),
            ),
            &errors([BOTH[2], BOTH[1]]),
        ),
        reduction(
            said(
                "both-onset-size",
                "with pictures: the onset filter saves 5 to 20 %",
                Some(0.121),
            ),
            &errors([BOTH[1], BOTH[0]]),
            [0.05, 0.20],
        ),
        reduction(
            said(
                "both-bands-size",
                "with pictures: onset filter and bands save 12 to 32 %",
                Some(0.224),
            ),
            &errors([BOTH[2], BOTH[0]]),
            [0.12, 0.32],
        ),
        ratio(
            "ratio-plain",
            "error with pictures over error of sound alone below 0.25, plain",
            0,
            0.156,
        ),
        ratio("ratio-onset", "the same with the onset filter", 1, 0.168),
        ratio("ratio-bands", "the same with onset filter and bands", 2, 0.226),
        mean_within(
            said(
                "video-switches",
                "pictures alone: at least one switch of identity at each occlusion",
                None,
            ),
            &results.values(OCCLUSION, "switches", VIDEO),
            [1.0, f64::INFINITY],
        ),
        mean_within(
            said("audio-switches", "sound alone: no switch of identity", Some(0.0)),
            &switches(AUDIO[2]),
            [0.0, 0.0],
        ),
        mean_within(
            said(
                "both-switches",
                "sound and pictures: no switch of identity",
                Some(0.0),
            ),
            &switches(BOTH[2]),
            [0.0, 0.0],
        ),
        mean_within(
            said(
                "right-speaker",
                "of two who talk in turns the right one is marked for 90 % of their speech",
                None,
            ),
            &results.values(DIALOGUE, "right_speaker", BOTH[2]),
            [0.9, 1.0],
        ),
        smaller(
            said(
                "printed-fails",
                "with eq. 8 as printed the error is larger than with pictures alone",
                None,
            ),
            &errors([VIDEO, PRINTED]),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_variant_is_a_system_that_can_be_built_and_has_its_own_name() {
        let world =
            scenario::from_text("vo", include_str!("../../../../scenes/stac-vo.toml"), &Vec::new()).unwrap();
        let room = Simulation::new(world).unwrap().room();
        let variants: Vec<Variant> = occlusion_variants();
        for (place, variant) in variants.iter().enumerate() {
            hearsight::systems::build(variant.system, &variant.parameters, &room, 1).unwrap();
            assert!(variants[..place].iter().all(|other| other.name != variant.name));
        }
    }

    #[test]
    fn claims_have_names_of_their_own_and_what_was_not_measured_fails() {
        let claims = claims(&Results::default());
        for (place, claim) in claims.iter().enumerate() {
            assert!(!claim.holds, "{claim:?}");
            assert!(claims[..place].iter().all(|other| other.id != claim.id));
        }
    }
}
