//! `hearsight reproduce`: a paper's experiment on simulated rooms, its table beside ours.

use crate::exit::Code;
use crate::reproduce::claim::{self, Claim, Report, Table};
use crate::reproduce::trials::{self, Options};
use crate::reproduce::{EXPERIMENTS, Experiment, Extent};
use crate::{interrupt, progress, say};
use miette::{Context, IntoDiagnostic, miette};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  hearsight reproduce stac --quick             short scenes, few seeds: under two minutes
  hearsight reproduce stac                     the whole experiment; Ctrl-C puts it aside, the same command goes on
  hearsight reproduce stac --json claims.json  and the verdicts for programs
  hearsight reproduce stac --seeds 40 --out /tmp/stac
  hearsight reproduce closed-loop --scene beyond --seeds 2";

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The system whose experiment is run.
    #[arg(value_parser = known)]
    system: &'static Experiment,
    /// Short scenes and few seeds.
    #[arg(long)]
    quick: bool,
    /// Seeds of each scene. Default: the experiment's own number.
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u64).range(1..=10_000))]
    seeds: Option<u64>,
    /// Run this scene alone; may be given again. Claims about others are left out.
    #[arg(long, value_name = "NAME")]
    scene: Vec<String>,
    /// Write the claims to this file: id, statement, paper, ours, interval, seeds, holds, cause.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Directory in which finished trials are kept. Default `reproduce-<system>`.
    #[arg(short, long, value_name = "DIRECTORY")]
    out: Option<PathBuf>,
    /// Threads; 0 takes one a processor. Results do not depend on it.
    #[arg(long, value_name = "NUMBER", default_value_t = 0)]
    threads: usize,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
    /// Exit with code 3 where a claim does not hold.
    #[arg(long)]
    strict: bool,
}

fn known(name: &str) -> Result<&'static Experiment, String> {
    let found = EXPERIMENTS.iter().find(|experiment| experiment.name == name);
    found.copied().ok_or_else(|| {
        let names: Vec<&str> = EXPERIMENTS.iter().map(|experiment| experiment.name).collect();
        format!(
            "there is no experiment of that name; known are: {}",
            names.join(", ")
        )
    })
}

/// Runs, judges and prints.
pub(crate) fn run(arguments: &Arguments) -> miette::Result<Code> {
    let experiment = arguments.system;
    let directory = match &arguments.out {
        Some(out) => out.clone(),
        None => PathBuf::from(format!("reproduce-{}", experiment.name)),
    };
    let log = directory.join("trials.jsonl");
    let bar = progress::Trials::new(arguments.quiet);
    let options = Options {
        extent: if arguments.quick {
            Extent::Quick
        } else {
            Extent::Full
        },
        seeds: arguments.seeds,
        scenes: &arguments.scene,
        threads: arguments.threads,
        log: &log,
        stop: &interrupt::flag(),
    };
    let results = trials::run(experiment, &options, &|done, all| bar.show(done, all));
    bar.end();
    let Some(results) = results? else {
        say::error(format_args!(
            "put aside in {}; the same command goes on",
            directory.display()
        ));
        return Ok(Code::Interrupted);
    };
    let mut report = (experiment.judge)(&results);
    if !arguments.scene.is_empty() {
        report.claims.retain(|claim| claim.seeds > 0);
    }
    claim::explain(&mut report.claims, experiment.causes);
    if let Some(path) = &arguments.json {
        write_claims(&report.claims, path)?;
    }
    if !arguments.quiet {
        say::line(format_args!("{}", experiment.paper));
        print(&report);
    }
    let fails = report.claims.iter().any(|claim| !claim.holds);
    Ok(if arguments.strict && fails {
        Code::Faults
    } else {
        Code::Done
    })
}

fn write_claims(claims: &[Claim], path: &Path) -> miette::Result<()> {
    let text = serde_json::to_string_pretty(claims).into_diagnostic()?;
    std::fs::write(path, text + "\n")
        .into_diagnostic()
        .wrap_err_with(|| miette!("cannot write the claims to {}", path.display()))
}

fn print(report: &Report) {
    for table in &report.tables {
        say::line(format_args!("\n{}", table.title));
        say::line(aligned(table));
    }
    say::line("\nclaims (ours with its interval of 95 %)");
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3}"));
    let rows = report.claims.iter().map(|claim| {
        let interval = claim
            .interval
            .map_or(String::new(), |[low, high]| format!(" ({low:.3} to {high:.3})"));
        vec![
            if claim.holds { "holds" } else { "FAILS" }.to_owned(),
            claim.id.to_owned(),
            number(claim.paper),
            number(claim.ours) + &interval,
            claim.p.map_or(String::new(), |p| format!("{p:.2e}")),
            claim.seeds.to_string(),
            claim.statement.clone(),
        ]
    });
    let head = ["verdict", "claim", "paper", "ours", "p", "seeds", "statement"];
    say::line(aligned(&Table {
        title: String::new(),
        columns: head.map(str::to_owned).to_vec(),
        rows: rows.collect(),
    }));
    let mut causes: Vec<(&str, Vec<&str>)> = Vec::new();
    for claim in &report.claims {
        let Some(cause) = claim.cause else { continue };
        match causes.iter_mut().find(|(known, _)| *known == cause) {
            Some((_, names)) => names.push(claim.id),
            None => causes.push((cause, vec![claim.id])),
        }
    }
    if !causes.is_empty() {
        say::line("\nwhy claims fail, as far as it has been found out");
        for (cause, names) in causes {
            say::line(format_args!("{}: {cause}", names.join(", ")));
        }
    }
    let held = report.claims.iter().filter(|claim| claim.holds).count();
    say::line(format_args!("{held} of {} claims hold", report.claims.len()));
}

/// A table with columns under each other.
fn aligned(table: &Table) -> String {
    let widths: Vec<usize> = (0..table.columns.len())
        .map(|column| {
            let cells = table
                .rows
                .iter()
                .map(|row| row.get(column).map_or(0, |cell| cell.chars().count()));
            cells
                .max()
                .unwrap_or(0)
                .max(table.columns[column].chars().count())
        })
        .collect();
    let line = |row: &[String]| {
        let cells = row
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{cell:<width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    let lines = std::iter::once(&table.columns)
        .chain(&table.rows)
        .map(|row| line(row));
    lines.collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_under_each_other() {
        let table = Table {
            title: String::new(),
            columns: vec!["a".into(), "long".into()],
            rows: vec![vec!["four".into(), "1".into()], vec!["ü".into(), "22".into()]],
        };
        assert_eq!(aligned(&table), "a     long\nfour  1\nü     22");
    }

    #[test]
    fn experiments_have_names_of_their_own() {
        for (place, experiment) in EXPERIMENTS.iter().enumerate() {
            assert!(!experiment.paper.is_empty());
            assert!(
                EXPERIMENTS[..place]
                    .iter()
                    .all(|other| other.name != experiment.name)
            );
        }
    }
}
