//! Long runs: `hearsight-fuzz TARGET`, and single files: `hearsight-fuzz TARGET FILE`; `hearsight-fuzz list`.

use hearsight_fuzz::{Options, TARGETS, Target, Verdict, run, run_one};
use std::process::ExitCode;

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["list"] => {
            for target in TARGETS {
                println!("{:<12} {}", target.name, target.meaning);
            }
            Ok(ExitCode::SUCCESS)
        }
        [name] => explore(named(name)?),
        [name, file] => {
            let verdict = run_one(named(name)?, &std::fs::read(file)?);
            println!("{verdict:?}");
            Ok(
                if verdict.is_ok_and(|verdict| !matches!(verdict, Verdict::Broken(_))) {
                    ExitCode::SUCCESS
                } else {
                    ExitCode::FAILURE
                },
            )
        }
        _ => Err("usage: hearsight-fuzz list | TARGET | TARGET FILE".into()),
    }
}

fn named(name: &str) -> Result<&'static Target, String> {
    TARGETS
        .iter()
        .find(|target| target.name == name)
        .ok_or_else(|| format!("there is no target {name}; try `list`"))
}

/// Damages files for as long as HEARSIGHT_FUZZ_SECONDS says; what goes wrong is written to the working directory.
fn explore(target: &Target) -> Result<ExitCode, Box<dyn std::error::Error>> {
    let options = Options::from_environment()?;
    let directory = std::env::current_dir()?;
    let report = run(target, &options, &mut |finding| {
        let again = finding.write(target, &options, &directory);
        println!(
            "{}: {}\n{}",
            target.name,
            finding.describe(&options),
            again.unwrap_or_else(|error| error.to_string())
        );
    });
    println!(
        "{}: {} cases from seed {}, {} read, {} kept, slowest {:.3} s, most memory {} kB, {} findings",
        target.name,
        report.cases,
        options.seed,
        report.read,
        report.kept,
        report.slowest.as_secs_f64(),
        report.most_bytes >> 10,
        report.findings.len()
    );
    Ok(if report.findings.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}
