//! The tables and claims of experiment D3.

use super::super::claim::{
    Claim, Report, Statement, Table, cell, mean_within, ratio_within, reduction, smaller,
};
use super::super::trials::Results;
use super::{
    CHILD, DEAD, LONG, OURS, PAPER, PLAIN_RESTART, PRINTED, SEATED, SUM, TELEVISION, TRAP, WALKING, WEIGHTED,
};

/// Judges what was measured.
pub(super) fn judge(results: &Results) -> Report {
    Report {
        tables: vec![errors(results), rates(results), beyond(results)],
        claims: claims(results),
    }
}

const AXES: [&str; 5] = ["audio_x", "audio_y", "fused_x", "fused_y", "fused_z"];

fn table(title: &str, columns: &[&str], rows: Vec<Vec<String>>) -> Table {
    Table {
        title: title.to_owned(),
        columns: columns.iter().map(|&column| column.to_owned()).collect(),
        rows,
    }
}

fn errors(results: &Results) -> Table {
    let mut rows = vec![
        ["the paper", "0.771", "0.676", "0.391", "0.354", "0.146"]
            .map(str::to_owned)
            .to_vec(),
    ];
    for name in [PAPER, WEIGHTED, PRINTED, SUM, OURS] {
        let cells = AXES.map(|metric| cell(&results.values(SEATED, metric, name), 3));
        rows.push(std::iter::once(name.to_owned()).chain(cells).collect());
    }
    table(
        "Seated: root mean square error where speech is recognized, metres (ours with its interval of 95 %)",
        &["variant", "audio x", "audio y", "audio-visual x", "y", "z"],
        rows,
    )
}

fn rates(results: &Results) -> Table {
    let mut rows = vec![["the paper", "0.835", "-", "-", "-"].map(str::to_owned).to_vec()];
    for name in [PAPER, WEIGHTED, PRINTED, SUM, OURS] {
        let value = |metric| cell(&results.values(SEATED, metric, name), 3);
        rows.push(vec![
            name.to_owned(),
            value("equal"),
            value("speech"),
            value("silence"),
            cell(&results.values(TRAP, "trapped", name), 3),
        ]);
    }
    rows.push(vec![
        PLAIN_RESTART.to_owned(),
        "-".to_owned(),
        "-".to_owned(),
        "-".to_owned(),
        cell(&results.values(TRAP, "trapped", PLAIN_RESTART), 3),
    ]);
    table(
        "Seated: speech and silence recognized, at the equal point and by the marks; time in the trap",
        &["variant", "equal point", "speech", "silence", "trapped"],
        rows,
    )
}

fn beyond(results: &Results) -> Table {
    let mut rows = Vec::new();
    for scene in [SEATED, WALKING, CHILD, TELEVISION, DEAD, LONG] {
        for name in [PAPER, OURS] {
            let value = |metric| cell(&results.values(scene, metric, name), 3);
            rows.push(vec![
                scene.to_owned(),
                name.to_owned(),
                value("fused_3d"),
                value("equal"),
                value("rejected"),
            ]);
        }
    }
    table(
        "Beyond the paper: audio-visual error in three dimensions, metres; rates",
        &["scene", "variant", "error", "equal point", "television rejected"],
        rows,
    )
}

fn said(id: &'static str, text: &str, paper: Option<f64>) -> Statement {
    Statement {
        id,
        text: text.to_owned(),
        paper,
    }
}

fn claims(results: &Results) -> Vec<Claim> {
    let of = |metric: &str, name: &str| results.values(SEATED, metric, name);
    let pairs = |metric: &str, pair: [&str; 2]| results.rows(SEATED, metric, pair);
    // Both metrics of one variant, seed by seed.
    let within = |first: &str, second: &str| -> Vec<[f64; 2]> {
        let (first, second) = (of(first, PAPER), of(second, PAPER));
        // A seed without speech that is recognized has neither.
        if first.len() == second.len() {
            first.into_iter().zip(second).map(|(a, b)| [a, b]).collect()
        } else {
            Vec::new()
        }
    };
    let mut claims = vec![
        ratio_within(
            said(
                "ratio-x",
                "x: error with pictures at most 0.55 of that of sound",
                Some(0.507),
            ),
            &within("fused_x", "audio_x"),
            [0.0, 0.55],
        ),
        ratio_within(
            said(
                "ratio-y",
                "y: error with pictures at most 0.55 of that of sound",
                Some(0.524),
            ),
            &within("fused_y", "audio_y"),
            [0.0, 0.55],
        ),
    ];
    for (id, metric, text, paper, range) in [
        (
            "audio-x",
            "audio_x",
            "sound alone: error of x 0.5 to 1 m",
            0.771,
            [0.5, 1.0],
        ),
        (
            "audio-y",
            "audio_y",
            "sound alone: error of y 0.5 to 1 m",
            0.676,
            [0.5, 1.0],
        ),
        (
            "fused-x",
            "fused_x",
            "with pictures: error of x 0.25 to 0.5 m",
            0.391,
            [0.25, 0.5],
        ),
        (
            "fused-y",
            "fused_y",
            "with pictures: error of y 0.25 to 0.5 m",
            0.354,
            [0.25, 0.5],
        ),
        (
            "fused-z",
            "fused_z",
            "with pictures: error of z 0.1 to 0.2 m",
            0.146,
            [0.1, 0.2],
        ),
        (
            "equal-point",
            "equal",
            "speech and silence recognized at the equal point, 80 to 90 %",
            0.835,
            [0.8, 0.9],
        ),
    ] {
        claims.push(mean_within(
            said(id, text, Some(paper)),
            &of(metric, PAPER),
            range,
        ));
    }
    claims.extend([
        reduction(
            said(
                "external",
                "the external filter saves more than half of the time in a trap",
                None,
            ),
            &results.rows(TRAP, "trapped", [PAPER, PLAIN_RESTART]),
            [0.5, 1.0],
        ),
        smaller(
            said(
                "product",
                "the product of pairs has a smaller error of sound than their sum",
                None,
            ),
            &pairs("audio_3d", [PAPER, SUM]),
        ),
        smaller(
            said(
                "equation-13",
                "eq. 13 corrected has a smaller error with pictures than as printed",
                None,
            ),
            &pairs("fused_3d", [PAPER, PRINTED]),
        ),
        smaller(
            said(
                "weighted",
                "weighted by both uncertainties the error is smaller than that of eq. 20",
                None,
            ),
            &pairs("fused_3d", [WEIGHTED, PAPER]),
        ),
        mean_within(
            said(
                "better-error",
                "beyond the paper: error with pictures at most 0.15 m",
                None,
            ),
            &of("fused_3d", OURS),
            [0.0, 0.15],
        ),
        mean_within(
            said(
                "better-equal",
                "beyond the paper: at least 93 % at the equal point",
                None,
            ),
            &of("equal", OURS),
            [0.93, 1.0],
        ),
        mean_within(
            said(
                "television",
                "a television as loud as people is rejected for 95 % of its time",
                None,
            ),
            &results.values(TELEVISION, "rejected", OURS),
            [0.95, 1.0],
        ),
    ]);
    for (id, scene, text) in [
        (
            "walking",
            WALKING,
            "people who stand and walk: error at most 0.15 m",
        ),
        ("child", CHILD, "a child of 1.1 m: error at most 0.15 m"),
        (
            "dead-microphone",
            DEAD,
            "one of three microphones dead: error at most 0.15 m",
        ),
        (
            "long-reverberation",
            LONG,
            "reverberation of a second: error at most 0.15 m",
        ),
    ] {
        claims.push(mean_within(
            said(id, text, None),
            &results.values(scene, "fused_3d", OURS),
            [0.0, 0.15],
        ));
    }
    claims
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn claims_have_names_of_their_own_and_what_was_not_measured_fails() {
        let claims = claims(&Results::default());
        for (place, claim) in claims.iter().enumerate() {
            assert!(!claim.holds, "{claim:?}");
            assert!(claims[..place].iter().all(|other| other.id != claim.id));
        }
    }
}
