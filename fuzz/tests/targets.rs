//! Every target for HEARSIGHT_FUZZ_SECONDS (default 1): seeds, files that went wrong once, and what comes of them.

#![expect(
    clippy::unwrap_used,
    reason = "a test stops at what it does not expect, also in its helpers"
)]

use hearsight_fuzz::{Options, TARGETS, Verdict, run, run_one};
use std::path::Path;

fn explore(name: &str) {
    let target = TARGETS.iter().find(|target| target.name == name).unwrap();
    let options = Options::from_environment().unwrap();
    let report = run(target, &options, &mut |finding| {
        let again = finding.write(target, &options, Path::new(env!("CARGO_TARGET_TMPDIR")));
        eprintln!("{name}: {}\n{}", finding.describe(&options), again.unwrap());
    });
    println!(
        "{name}: {} cases from seed {}, {} read, {} kept",
        report.cases, options.seed, report.read, report.kept
    );
    assert!(
        report.findings.is_empty(),
        "{} findings, printed above",
        report.findings.len()
    );
}

macro_rules! targets {
    ($($name:ident)*) => {
        $(#[test] fn $name() { explore(stringify!($name)); })*

        #[test]
        fn every_target_has_a_test() {
            let names: Vec<&str> = TARGETS.iter().map(|target| target.name).collect();
            assert_eq!(names, [$(stringify!($name)),*]);
        }
    };
}

targets! {
    cascade
    calibration
    room
    scenario
    microphones
    parameters
    state
    saved_run
    recording
    wav flac
}

#[test]
fn most_seeds_are_read() {
    for target in TARGETS {
        let seeds = (target.seeds)();
        let read = |seed: &Vec<u8>| matches!(run_one(target, seed), Ok(Verdict::Read(_)));
        let good = seeds.iter().filter(|seed| read(seed)).count();
        assert!(
            good >= 1 && 2 * good >= seeds.len(),
            "{}: {good} of {}",
            target.name,
            seeds.len()
        );
    }
}
