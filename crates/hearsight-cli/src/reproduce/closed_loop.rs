//! Experiment D1: the closed-loop system of Chen and Rui.
//!
//! Sequence A ([`follow`]): one head that jerks aside, is crossed by a hand and turns away, followed by each tracker alone,
//! by all together, by the transition prior (CONDENSATION) and in an open loop. Sequence B ([`meeting`]): six people around
//! five cameras that are stitched to one picture of 360 degrees, and a harder room of our own. Equation 24 as printed and
//! corrected ([`sign`]). The paper gives no numbers: orders and the sheet's thresholds are judged.

mod claims;
mod follow;
mod meeting;
mod sign;

use super::{Experiment, Extent, Measured, Trial};
use hearsight::sim::scenario;
use hearsight::sim::simulation::Simulation;
use miette::{IntoDiagnostic, miette};
use serde_json::{Value, json};

/// The experiment.
pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "closed-loop",
    paper: "Chen, Rui: Real-time speaker tracking using particle filter sensor fusion",
    scenes,
    run,
    judge: claims::judge,
    causes: &[
        (
            &["jerk-contour", "hand-contour"],
            "contour alone is off the head before the event in 12 or 13 of 30 seeds, which are not judged then. Why half of the \
             others hold on in the jerk has not been found out",
        ),
        (
            &["hand-colour"],
            "probably the scene: the rendered hand is half as wide as a face, passes to and fro in half a second, and leaves most \
             of head and hair to be seen (looked at in one seed)",
        ),
        (
            &["particles"],
            "heads are lost between the events as well: in one seed that was looked at, while its person walks and turns aside \
             before a busy poster, since neither contrast nor outlines know whose head it is. The prior with 400 hypotheses loses \
             as many as the mixture with 25 to 200, so that the ratio is about 16 where both level off, but neither comes to 5 %",
        ),
        (
            &["jerk-fused", "closed-loop"],
            "not found out: with 200 hypotheses two of 27 seeds were lost in the jerk, with 100 none, and closed and open loop hardly \
             differed after it",
        ),
        (
            &["heard-alone"],
            "it is better than was expected: eight microphones, all pairs, the noise of the fan taken out",
        ),
        (
            &["right-both"],
            "eight of ten seeds are right more often with pictures; in one of the two others somebody has no track for a time",
        ),
        (
            &["beyond-single"],
            "in part the shortness of turns: with true places of heads nine of ten errors fall into the first half second of a \
             turn (three other seeds); the rest not found out",
        ),
    ],
};

/// One head that is hard to follow.
const FOLLOW: &str = "A";
/// Left and right of a camera between two microphones.
const SIGN: &str = "eq24";
/// Harder than the paper's meeting.
const BEYOND: &str = "beyond";
/// The meeting by noise (decibels) and reverberation (seconds): fan and television together are so much below speech.
const MEETINGS: [(&str, f64, f64); 4] = [
    ("B 15 dB 0.3 s", 15.0, 0.3),
    ("B 10 dB 0.3 s", 10.0, 0.3),
    ("B 5 dB 0.3 s", 5.0, 0.3),
    ("B 10 dB 0.5 s", 10.0, 0.5),
];

fn scenes(extent: Extent) -> Vec<(&'static str, u64)> {
    let mut scenes = match extent {
        Extent::Quick => vec![(FOLLOW, 7), (SIGN, 7), (MEETINGS[1].0, 7), (BEYOND, 2)],
        Extent::Full => vec![(FOLLOW, 30), (SIGN, 10), (BEYOND, 5)],
    };
    if extent == Extent::Full {
        scenes.extend(MEETINGS.map(|(name, ..)| (name, 10)));
    }
    scenes
}

fn run(trial: &Trial) -> miette::Result<Measured> {
    match trial.scene.as_str() {
        FOLLOW => {
            let text = include_str!("../../../../scenes/closed-loop-a.toml");
            follow::measure(
                &simulation("closed-loop-a.toml", text, trial, f64::INFINITY, &[])?,
                trial,
            )
        }
        SIGN => {
            let text = include_str!("../../../../scenes/closed-loop-pair.toml");
            sign::measure(&simulation("closed-loop-pair.toml", text, trial, 12.0, &[])?)
        }
        BEYOND => {
            let text = include_str!("../../../../scenes/closed-loop-beyond.toml");
            let simulation = simulation("closed-loop-beyond.toml", text, trial, 30.0, &[])?;
            meeting::measure(&simulation, trial, &meeting::beyond_variants())
        }
        other => {
            let (_, ratio_db, t60_s) = MEETINGS
                .into_iter()
                .find(|(name, ..)| *name == other)
                .ok_or_else(|| miette!("there is no scene `{other}`"))?;
            let text = include_str!("../../../../scenes/closed-loop-b.toml");
            // The sheet's claims are judged in one of these meetings; the others show how it goes on from there.
            let longest_s = match (other == MEETINGS[1].0, trial.quick) {
                (true, true) => 25.0,
                (true, false) => 45.0,
                (false, _) => 12.0,
            };
            // Two noises that are as loud as each other.
            let each = format!("{:?}", ratio_db + 3.0);
            let more = [
                ("noise.fan.snr", each.as_str()),
                ("noise.television.snr", each.as_str()),
                ("room.t60", &format!("{t60_s:?}")),
            ];
            let simulation = simulation("closed-loop-b.toml", text, trial, longest_s, &more)?;
            meeting::measure(&simulation, trial, &meeting::variants())
        }
    }
}

/// A scene with the trial's seed, cut short where it is longer than `longest_s`: six people in five cameras cost twice
/// real time, twelve three times.
fn simulation(
    file: &str,
    text: &str,
    trial: &Trial,
    longest_s: f64,
    more: &[(&str, &str)],
) -> miette::Result<Simulation> {
    let mut overrides = vec![("seed".to_owned(), trial.seed.to_string())];
    if longest_s.is_finite() {
        overrides.push(("seconds".to_owned(), format!("{longest_s:?}")));
    }
    overrides.extend(
        more.iter()
            .map(|(key, value)| ((*key).to_owned(), (*value).to_owned())),
    );
    Simulation::new(scenario::from_text(file, text, &overrides)?).into_diagnostic()
}

/// The paper's system: people are started by faces alone, searched for every ten seconds, and what we added for several
/// people is off.
fn as_in_the_paper(more: &[(&str, Value)]) -> Value {
    let mut parameters = json!({
        "changes": false,
        "faces": { "period_s": 10.0 },
        "fuser": { "shares": { "detected": 0.0 } },
        "encounter": { "margin": 9.0, "stranger": 9.0 },
        "re_entry": { "enabled": false },
        "verifiers": { "likeness": { "enabled": false } },
    });
    for (path, value) in more {
        let mut place = &mut parameters;
        for key in path.split('.') {
            place = &mut place[key];
        }
        *place = value.clone();
    }
    parameters
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_resolves_and_every_variant_is_a_system_of_its_own_name() {
        let trial = |scene: &str| Trial {
            scene: scene.into(),
            seed: 3,
            quick: true,
        };
        let text = include_str!("../../../../scenes/closed-loop-a.toml");
        let follow = simulation("a", text, &trial(FOLLOW), f64::INFINITY, &[]).unwrap();
        let variants = follow::variants();
        for (place, variant) in variants.iter().enumerate() {
            hearsight::systems::build(variant.system, &variant.parameters, &follow.room(), 1).unwrap();
            assert!(variants[..place].iter().all(|other| other.name != variant.name));
        }
        for variant in meeting::variants().iter().chain(&meeting::beyond_variants()) {
            hearsight::systems::build(variant.system, &variant.parameters, &follow.room(), 1).unwrap();
        }
        let text = include_str!("../../../../scenes/closed-loop-b.toml");
        let more = [("noise.fan.snr", "5"), ("room.t60", "0.5")];
        let meeting = simulation("b", text, &trial(MEETINGS[0].0), 5.0, &more).unwrap();
        assert_eq!(meeting.world().people.len(), 6);
    }
}
