//! Real corpora beside the reference scorers; where the data are missing these tests skip and say so.

#![expect(
    clippy::unwrap_used,
    reason = "a test stops at what it does not expect, also in its helpers"
)]

use hearsight_eval::read::{parse, read};
use hearsight_eval::{Case, Options, Report, Side, pair};
use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A directory of the data that are not part of the project.
fn shared(name: &str) -> Option<PathBuf> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data")
        .join(name);
    if directory.is_dir() {
        return Some(directory);
    }
    eprintln!("skipped: {} is missing", directory.display());
    None
}

fn report(cases: Vec<Case>) -> Report {
    let names = ["truth".to_owned(), "tracks".to_owned()];
    Report::new(names, cases, Vec::new(), Options::default()).unwrap()
}

/// Every value of the golden that is a metric of the report.
fn compare(report: &Report, golden: &Value) {
    let mut compared = 0;
    for (name, expected) in golden.as_object().unwrap() {
        let Some(ours) = report.value(name) else { continue };
        let theirs = expected.as_f64().unwrap();
        assert!((ours - theirs).abs() <= 1e-6, "{name}: {ours} {theirs}");
        compared += 1;
    }
    assert!(compared >= 9, "{compared} values compared");
}

#[test]
fn the_usual_example_of_motchallenge_agrees_with_motmetrics_and_trackeval() {
    let Some(directory) = shared("mot-tud") else {
        return;
    };
    let goldens: Value = serde_json::from_str(include_str!("goldens/metrics.json")).unwrap();
    let goldens = &goldens["mot_tud"];
    let mut all = Vec::new();
    for name in ["TUD-Campus", "TUD-Stadtmitte"] {
        let side = |file, side| read(&directory.join(name).join(file), side, None).unwrap();
        let (truth, tracks) = (side("gt.txt", Side::Truth), side("test.txt", Side::Tracks));
        let cases = pair(name, &truth, &tracks, &Options::default()).unwrap().cases;
        all.extend(cases.clone());
        let report = report(cases);
        compare(&report, &goldens[name]["motmetrics"]);
        compare(&report, &goldens[name]["trackeval"]);
        // Where the two references differ in what they call MOTP, and agree in the rest.
        let clear = &goldens[name]["trackeval_clear"];
        let value = |metric| report.value(metric).unwrap();
        for (ours, theirs) in [
            (value("mota"), "MOTA"),
            (1.0 - value("motp"), "MOTP"),
            (value("num_switches"), "IDSW"),
            (value("idf1"), "IDF1"),
        ] {
            assert!((ours - clear[theirs].as_f64().unwrap()).abs() <= 1e-6, "{theirs}");
        }
    }
    let report = report(all);
    compare(&report, &goldens["overall"]["motmetrics"]);
    compare(&report, &goldens["overall"]["trackeval"]);
}

/// Fields of the rows of a CSV file, by name.
fn rows(path: &Path) -> Vec<impl Fn(&str) -> f64> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header: Vec<String> = lines.next().unwrap().split(',').map(str::to_owned).collect();
    let row = |line: &str| {
        let fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        let header = header.clone();
        move |name: &str| {
            fields[header.iter().position(|column| column == name).unwrap()]
                .parse()
                .unwrap()
        }
    };
    lines.map(row).collect()
}

#[test]
fn av16_3_in_the_picture_is_scored_as_usual() {
    let Some(directory) = shared("av16.3-seq30") else {
        return;
    };
    let goldens: Value = serde_json::from_str(include_str!("goldens/av163.json")).unwrap();
    for camera in ["cam1", "cam2", "cam3"] {
        let path = directory.join(format!("seq30_{camera}_frames.csv"));
        let mut text = String::new();
        for row in rows(&path) {
            for person in [1_i64, 2] {
                let frame = row("frame") as i64;
                if (frame * 3 + person) % 10 == 0 {
                    continue;
                }
                let u = row(&format!("p{person}_u")) + ((frame * 7 + person * 13) % 41 - 20) as f64;
                let v = row(&format!("p{person}_v")) + ((frame * 11 + person * 5) % 41 - 20) as f64;
                let (track, left, top) = (person + 2 * (frame / 97 % 2), u - 12.0, v - 24.0);
                writeln!(text, "{frame},{track},{left:.3},{top:.3},24,32,1,-1,-1,-1").unwrap();
            }
        }
        let name = format!("{camera}.mot.txt");
        let tracks = parse(Path::new(&name), text.as_bytes(), Side::Tracks, None).unwrap();
        // The file of the picture, and the whole corpus with its three pictures.
        for truth in [path, directory.clone()] {
            let truth = read(&truth, Side::Truth, None).unwrap();
            let paired = pair("", &truth, &tracks, &Options::default()).unwrap();
            assert_eq!(paired.cases.len(), 1);
            compare(&report(paired.cases), &goldens[camera]);
        }
    }
}

#[test]
fn av16_3_in_the_world_is_scored_as_usual() {
    let Some(directory) = shared("av16.3-seq30") else {
        return;
    };
    let goldens: Value = serde_json::from_str(include_str!("goldens/av163.json")).unwrap();
    let path = directory.join("seq30_gt3d.csv");
    let mut text = String::from("t_sec,track,x_m,y_m,z_m\n");
    for row in rows(&path) {
        let (tick, person) = ((row("t_sec") * 25.0).round() as i64, row("person") as i64);
        if (tick * 3 + person) % 10 == 0 {
            continue;
        }
        let x = row("x_m") + ((tick * 7 + person * 13) % 41 - 20) as f64 / 40.0;
        let y = row("y_m") + ((tick * 11 + person * 5) % 41 - 20) as f64 / 60.0;
        let (track, time, z) = (person + 2 * (tick / 97 % 2), row("t_sec"), row("z_m"));
        writeln!(text, "{time},{track},{x:.6},{y:.6},{z}").unwrap();
    }
    let truth = read(&path, Side::Truth, None).unwrap();
    let tracks = parse(Path::new("tracks.csv"), text.as_bytes(), Side::Tracks, None).unwrap();
    let paired = pair("", &truth, &tracks, &Options::default()).unwrap();
    compare(&report(paired.cases), &goldens["world"]);
}
