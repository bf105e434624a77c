//! What the paper claims and the sheet demands of the closed loop, from what was measured.

use super::super::claim::{Claim, Report, Statement, Table, cell, mean_within, ratio_within, smaller};
use super::super::trials::Results;
use super::follow::{BIN_FRAMES, COLOUR, CONTOUR, EVENTS, FUSED, OPEN, OTHERS, OURS, PRINTED, PRIOR, USUAL};
use super::meeting::{self, HEARD, SEEN};
use super::{BEYOND, FOLLOW, MEETINGS, SIGN, sign};

/// Loss that more hypotheses are to bring both proposals to, a share of the seeds.
const LOSS: f64 = 0.05;

pub(super) fn judge(results: &Results) -> Report {
    let mut claims = following(results);
    claims.extend(speaking(results));
    Report {
        tables: vec![
            table_of_following(results),
            table_of_reliabilities(results),
            table_of_meetings(results),
            table_of_signs(results),
        ],
        claims,
    }
}

fn said(id: &'static str, text: &str) -> Statement {
    Statement {
        id,
        text: text.to_owned(),
        paper: None,
    }
}

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

fn table_of_following(results: &Results) -> Table {
    let names = [CONTOUR, COLOUR, FUSED, OPEN, PRINTED, OURS]
        .into_iter()
        .chain(OTHERS.map(|(name, _)| name))
        .chain(PRIOR.map(|(name, _)| name));
    let value = |name: &str, metric: &str| cell(&results.values(FOLLOW, metric, name), 2);
    let metrics = [
        "lost_jerk",
        "lost_hand",
        "lost_turn",
        "error",
        "overlap",
        "share",
        "effective",
    ];
    Table {
        title: "Sequence A: share of the seeds in which the head is lost; error in head widths; overlap; share of time on \
                the head; effective sample size"
            .to_owned(),
        columns: owned(&[
            "variant",
            "lost: jerk",
            "hand",
            "turn",
            "error",
            "overlap",
            "on it",
            "effective",
        ]),
        rows: names
            .map(|name| {
                let mut row = vec![name.to_owned()];
                row.extend(metrics.map(|metric| value(name, metric)));
                row
            })
            .collect(),
    }
}

/// Reliabilities over the sequence: the curves.
fn table_of_reliabilities(results: &Results) -> Table {
    let mean = |metric: String| {
        let values = results.values(FOLLOW, &metric, FUSED);
        let sum: f64 = values.iter().sum();
        if values.is_empty() {
            "-".to_owned()
        } else {
            format!("{:.2}", sum / values.len() as f64)
        }
    };
    let bins = (0..700).step_by(BIN_FRAMES);
    Table {
        title: "Sequence A: mean reliabilities of the trackers while fused, over frames".to_owned(),
        columns: owned(&["frames", "contour", "colour", "event"]),
        rows: bins
            .map(|from| {
                let event = EVENTS
                    .iter()
                    .find(|(_, first, last)| from < *last && from + BIN_FRAMES > *first);
                vec![
                    format!("{from}-{}", from + BIN_FRAMES - 1),
                    mean(format!("contour_{from:04}")),
                    mean(format!("colour_{from:04}")),
                    event.map_or(String::new(), |(name, ..)| (*name).to_owned()),
                ]
            })
            .collect(),
    }
}

fn table_of_meetings(results: &Results) -> Table {
    let metrics = [
        "right",
        "right_answered",
        "right_overlap",
        "error_deg",
        "switch_s",
        "false_switches_per_min",
        "tracked",
        "false_tracks",
    ];
    let scenes = MEETINGS.map(|(name, ..)| name).into_iter().chain([BEYOND]);
    let mut rows = Vec::new();
    for scene in scenes {
        for variant in [HEARD, SEEN, meeting::FUSED, meeting::OURS] {
            if results.values(scene, "tracked", variant).is_empty() {
                continue;
            }
            let mut row = vec![scene.to_owned(), variant.to_owned()];
            row.extend(metrics.map(|metric| cell(&results.values(scene, metric, variant), 2)));
            rows.push(row);
        }
    }
    Table {
        title: "Sequence B: share of the time of one talker in which the right one is named (and where anybody is), of two \
                at once; median error, degrees; time to switch, seconds; false switches a minute; people with a track; \
                false tracks"
            .to_owned(),
        columns: owned(&[
            "scene",
            "variant",
            "right",
            "where answered",
            "overlap",
            "error",
            "switch",
            "false switches",
            "tracked",
            "false tracks",
        ]),
        rows,
    }
}

fn table_of_signs(results: &Results) -> Table {
    let value = |name: &str, side: &str| cell(&results.values(SIGN, side, name), 3);
    Table {
        title: "Equation 24: share of sound that is heard in the talker's column".to_owned(),
        columns: owned(&["equation", "talker on the left", "on the right"]),
        rows: [sign::PRINTED, sign::CORRECTED]
            .map(|name| vec![name.to_owned(), value(name, "left"), value(name, "right")])
            .into(),
    }
}

fn following(results: &Results) -> Vec<Claim> {
    let lost = |id, text, metric: &str, variant: &str, range| {
        mean_within(said(id, text), &results.values(FOLLOW, metric, variant), range)
    };
    let pairs = |metrics: [&str; 2], variants: [&str; 2]| -> Vec<[f64; 2]> {
        let [first, second] = [0, 1].map(|place| results.values(FOLLOW, metrics[place], variants[place]));
        first.into_iter().zip(second).map(|(a, b)| [a, b]).collect()
    };
    let best: Vec<[f64; 2]> = results
        .rows(FOLLOW, "error", [FUSED, CONTOUR, COLOUR])
        .into_iter()
        .map(|[fused, contour, colour]| [fused, contour.min(colour)])
        .collect();
    vec![
        lost(
            "jerk-contour",
            "C1: contour alone is lost in the jerk in 90 % of the seeds",
            "lost_jerk",
            CONTOUR,
            [0.9, 1.0],
        ),
        lost(
            "jerk-colour",
            "C1: colour alone is lost in it in at most 10 %",
            "lost_jerk",
            COLOUR,
            [0.0, 0.1],
        ),
        lost(
            "jerk-fused",
            "C1: fused in at most 5 %",
            "lost_jerk",
            FUSED,
            [0.0, 0.05],
        ),
        lost(
            "hand-contour",
            "C2: contour alone is lost at the hand in at most 10 %",
            "lost_hand",
            CONTOUR,
            [0.0, 0.1],
        ),
        lost(
            "hand-colour",
            "C2: colour alone is lost at it in 90 %",
            "lost_hand",
            COLOUR,
            [0.9, 1.0],
        ),
        lost(
            "hand-fused",
            "C2: fused in at most 5 %",
            "lost_hand",
            FUSED,
            [0.0, 0.05],
        ),
        ratio_within(
            said(
                "error-fused",
                "C3: error fused over that of the better tracker alone, outside transients, at most 1.1",
            ),
            &best,
            [0.0, 1.1],
        ),
        smaller(
            said(
                "reliable-jerk",
                "in the jerk the contour is less reliable than the colour",
            ),
            &pairs(["contour_jerk", "colour_jerk"], [FUSED, FUSED]),
        ),
        mean_within(
            said("reliable-soon", "and so within 3 frames"),
            &results.values(FOLLOW, "frames_to_cross", FUSED),
            [0.0, 3.0],
        ),
        smaller(
            said(
                "reliable-hand",
                "at the hand the colour is less reliable than the contour",
            ),
            &pairs(["colour_hand", "contour_hand"], [FUSED, FUSED]),
        ),
        particles(results),
        smaller(
            said(
                "effective",
                "E2: eq. 8 as printed has a smaller effective sample size than marginal weights",
            ),
            &results.rows(FOLLOW, "effective", [PRINTED, FUSED]),
        ),
        smaller(
            said(
                "closed-loop",
                "C7: after the jerk the closed loop is on the head better than the open one",
            ),
            &results.rows(FOLLOW, "shortfall_after", [FUSED, OPEN]),
        ),
    ]
}

/// How many times as many hypotheses the prior needs for the same loss. Where even the most that were tried lose more, it
/// needs more than those.
fn particles(results: &Results) -> Claim {
    let needed = |variants: &[(&'static str, usize)]| {
        variants
            .iter()
            .find(|(name, _)| {
                let lost = results.values(FOLLOW, "lost", name);
                !lost.is_empty() && lost.iter().sum::<f64>() <= LOSS * lost.len() as f64
            })
            .map(|(_, count)| *count as f64)
    };
    let mut mixture = OTHERS.to_vec();
    mixture.push((FUSED, USUAL));
    mixture.sort_by_key(|(_, count)| *count);
    let seeds = results.values(FOLLOW, "lost", FUSED).len();
    let tried: Vec<(&'static str, usize)> = PRIOR
        .into_iter()
        .filter(|(name, _)| !results.values(FOLLOW, "lost", name).is_empty())
        .collect();
    let most = tried.last().map(|(_, count)| *count as f64);
    let ours = needed(&mixture);
    let ratio = ours.and_then(|ours| Some(needed(&tried).or(most)? / ours));
    let beyond = needed(&tried).is_none();
    Claim {
        id: "particles",
        statement: format!(
            "C4: for a loss of 5 % the prior needs at least 4 times as many hypotheses{}",
            if beyond { " (more than were tried)" } else { "" }
        ),
        paper: None,
        ours: ratio,
        interval: None,
        p: None,
        seeds,
        holds: ratio.is_some_and(|ratio| ratio >= 4.0),
        cause: None,
    }
}

fn speaking(results: &Results) -> Vec<Claim> {
    let scene = MEETINGS[1].0;
    let mean = |id, text, scene: &str, metric: &str, variant: &str, range| {
        mean_within(said(id, text), &results.values(scene, metric, variant), range)
    };
    let signs: Vec<[f64; 2]> = results
        .values(SIGN, "left", sign::CORRECTED)
        .into_iter()
        .zip(results.values(SIGN, "right", sign::CORRECTED))
        .map(|(left, right)| [left, right])
        .collect();
    vec![
        mean(
            "seen-alone",
            "C5: pictures alone do not tell who of six speaks",
            scene,
            "right",
            SEEN,
            [0.0, 0.25],
        ),
        mean(
            "heard-alone",
            "C5: sound alone is coarse: 3 to 8 degrees off",
            scene,
            "error_deg",
            HEARD,
            [3.0, 8.0],
        ),
        ratio_within(
            said(
                "error-both",
                "C5: error with pictures at most half that of sound alone",
            ),
            &results.rows(scene, "error_deg", [meeting::FUSED, HEARD]),
            [0.0, 0.5],
        ),
        smaller(
            said(
                "right-both",
                "C5: with pictures the right one is named more often than by sound alone",
            ),
            &results.rows(scene, "right", [HEARD, meeting::FUSED]),
        ),
        mean(
            "printed-left",
            "eq. 24 as printed hears fewer than 10 % of the talkers on the left",
            SIGN,
            "left",
            sign::PRINTED,
            [0.0, 0.1],
        ),
        ratio_within(
            said(
                "corrected-left",
                "corrected, the left is heard as well as the right (within a quarter)",
            ),
            &signs,
            [0.75, 1.25],
        ),
        mean(
            "beyond-single",
            "beyond: the right one of twelve is named for 90 % of the time of one talker",
            BEYOND,
            "right",
            meeting::OURS,
            [0.9, 1.0],
        ),
        mean(
            "beyond-overlap",
            "beyond: and one of the talkers for 80 % of the time of two",
            BEYOND,
            "right_overlap",
            meeting::OURS,
            [0.8, 1.0],
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn claims_have_names_of_their_own_and_what_was_not_measured_fails() {
        let report = judge(&Results::default());
        for (place, claim) in report.claims.iter().enumerate() {
            assert!(!claim.holds, "{claim:?}");
            assert!(report.claims[..place].iter().all(|other| other.id != claim.id));
        }
    }
}
