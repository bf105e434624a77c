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
    let report = run(target, &options);
    println!(
        "{name}: {} cases from seed {}, {} read, {} kept",
        report.cases, options.seed, report.read, report.kept
    );
    for (number, finding) in report.findings.iter().enumerate() {
        let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}-{number}", options.seed));
        std::fs::write(&file, &finding.input).unwrap();
        let start = &finding.input[..finding.input.len().min(200)];
        eprintln!(
            "{name}: seed {}, case {}: {}",
            options.seed, finding.case, finding.wrong
        );
        eprintln!(
            "cargo run -p hearsight-fuzz -- {name} {}\n{}",
            file.display(),
            start.escape_ascii()
        );
    }
    assert!(
        report.findings.is_empty(),
        "{} findings, printed above",
        report.findings.len()
    );
}

macro_rules! targets {
    ($($(#[$attribute:meta])* $name:ident)*) => {
        $($(#[$attribute])* #[test] fn $name() { explore(stringify!($name)); })*

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
    microphones
    #[ignore = "parameters of sound are believed unchecked: frame_s = 1e308 overflows"]
    parameters
    #[ignore = "saved states of sound are believed unchecked: a framer without buffers panics at the next block"]
    state
    saved_run
    wav
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
