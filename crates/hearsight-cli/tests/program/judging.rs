//! `hearsight evaluate` on what `hearsight track` writes, and on files that are not to be judged.

use crate::common::{errors, printed, recording, run};
use std::path::Path;
use tempfile::TempDir;

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn tracks_judged_by_themselves_are_perfect() {
    let directory = TempDir::new().unwrap();
    let out = directory.path().join("tracks");
    let room = recording().join("room.toml");
    let tracked = run(&["track", text(&room), "--out", text(&out), "--quiet"]);
    assert!(tracked.status.success(), "{}", errors(&tracked));
    let (json, html) = (
        directory.path().join("report.json"),
        directory.path().join("report.html"),
    );
    let boxes = out.join("front.mot.txt");
    // Boxes as truth, scenes as tracks: the same heads, to the hundredth of a pixel.
    let judged = run(&[
        "evaluate",
        text(&boxes),
        text(&out),
        "--json",
        text(&json),
        "--html",
        text(&html),
    ]);
    assert!(judged.status.success(), "{}", errors(&judged));
    let table = printed(&judged);
    for word in ["CLEAR MOT", "mota", "idf1", "HOTA", "written to"] {
        assert!(table.contains(word), "no `{word}` in: {table}");
    }
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(json).unwrap()).unwrap();
    let overall = &report["overall"];
    assert!(overall["num_objects"].as_f64().unwrap() > 50.0, "{overall}");
    assert_eq!(
        (&overall["mota"], &overall["idf1"]),
        (&1.0.into(), &1.0.into()),
        "{overall}"
    );
    assert!(overall["LocA"].as_f64().unwrap() > 0.99, "{overall}");
    assert!(std::fs::read_to_string(html).unwrap().contains("Error over time"));
    let speech = out.join("speech.rttm");
    let judged = run(&["evaluate", text(&speech), text(&speech)]);
    assert!(
        printed(&judged).contains("diarization error rate"),
        "{}",
        errors(&judged)
    );
}

#[test]
fn what_cannot_be_judged_is_refused_with_a_cure() {
    let directory = TempDir::new().unwrap();
    let file = |name: &str, content: &str| {
        let path = directory.path().join(name);
        std::fs::write(&path, content).unwrap();
        path
    };
    let good = file("gt.txt", "1,1,0,0,5,5\n");
    let bad = file("bad.txt", "1,1,0,0,5,5\n1,2,0,x,5,5\n");
    let speech = file("a.rttm", "SPEAKER a 1 0 1 <NA> <NA> anna <NA> <NA>\n");
    let empty = file("empty.txt", "");
    let missing = directory.path().join("missing");
    for (arguments, words) in [
        (
            vec!["evaluate", text(&good), text(&bad)],
            vec!["line 2: `top` is x", "correct the row", "bad.txt"],
        ),
        (
            vec!["evaluate", text(&good), text(&speech)],
            vec!["nothing to compare", "boxes in pictures", "speech"],
        ),
        (
            vec!["evaluate", text(&good), text(&missing)],
            vec!["cannot read", "check the path", "missing"],
        ),
        (
            vec!["evaluate", text(&empty), text(&empty)],
            vec!["both sides are empty", "name files with rows"],
        ),
        (
            vec!["evaluate", text(&good), text(&good), "--gate", "0"],
            vec!["the gate must be a number above 0"],
        ),
        (
            vec!["evaluate", text(&good), text(&good), text(&good)],
            vec!["has no partner", "in turn"],
        ),
    ] {
        let refused = run(&arguments);
        assert_eq!(refused.status.code(), Some(1), "{arguments:?}");
        // The message is broken into lines.
        let message: String = errors(&refused).replace('│', "").split_whitespace().collect();
        for word in words {
            let word: String = word.split_whitespace().collect();
            assert!(message.contains(&word), "no `{word}` in {message}");
        }
    }
    let unknown = run(&["evaluate", "a", "b", "--truth-format", "dream"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(
        errors(&unknown).contains("choose one of truth, scenes, mot"),
        "{}",
        errors(&unknown)
    );
}

#[test]
fn help_lists_every_metric() {
    let help = printed(&run(&["evaluate", "--help"]));
    for word in [
        "mota",
        "idf1",
        "HOTA(0)",
        "jaccard error rate",
        "existence_ece",
        "Examples:",
    ] {
        assert!(help.contains(word), "no `{word}` in: {help}");
    }
}
