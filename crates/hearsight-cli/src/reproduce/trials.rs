//! Runs the trials of an experiment in parallel and keeps what was measured, so that an interrupted run goes on.
//!
//! The log is JSON Lines, a line a trial. A line counts only for the program that wrote it: its fingerprint is a hash of
//! the executable, since a changed tracker measures something else.

use super::{Experiment, Extent, Measured, Trial};
use miette::{Context, IntoDiagnostic, miette};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::fs::{File, OpenOptions};
use std::hash::{DefaultHasher, Hasher};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// What is run, and how.
pub(crate) struct Options<'a> {
    /// How much.
    pub(crate) extent: Extent,
    /// Seeds a scene instead of the experiment's own number.
    pub(crate) seeds: Option<u64>,
    /// Names of the scenes that are run; all where none is named.
    pub(crate) scenes: &'a [String],
    /// Threads; 0 is one a processor.
    pub(crate) threads: usize,
    /// Where trials are kept.
    pub(crate) log: &'a Path,
    /// Ends the run after the trials under way.
    pub(crate) stop: &'a AtomicBool,
}

/// What was measured of every trial, in the order of scenes and seeds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Results {
    trials: Vec<(Trial, Measured)>,
}

impl Results {
    /// Results that were not read from a log.
    pub(crate) fn new(mut trials: Vec<(Trial, Measured)>) -> Self {
        trials.sort_by(|a, b| a.0.cmp(&b.0));
        Self { trials }
    }

    /// A metric of several variants, a row for each seed that has it of all of them.
    pub(crate) fn rows<const N: usize>(
        &self,
        scene: &str,
        metric: &str,
        variants: [&str; N],
    ) -> Vec<[f64; N]> {
        self.of_scene(scene)
            .filter_map(|measured| {
                let mut row = [0.0; N];
                for (value, variant) in row.iter_mut().zip(variants) {
                    *value = *measured.get(variant)?.get(metric)?;
                }
                Some(row)
            })
            .collect()
    }

    /// A metric of one variant, a number for each seed that has it.
    pub(crate) fn values(&self, scene: &str, metric: &str, variant: &str) -> Vec<f64> {
        let rows = self.rows(scene, metric, [variant]);
        rows.into_iter().map(|[value]| value).collect()
    }

    fn of_scene(&self, scene: &str) -> impl Iterator<Item = &Measured> {
        let of_scene = move |(trial, _): &&(Trial, Measured)| trial.scene == scene;
        self.trials.iter().filter(of_scene).map(|(_, measured)| measured)
    }
}

/// Runs every trial that the log does not hold yet. `progress` is told (trials done, trials in all) from any thread.
/// Nothing where it was stopped before the end; the log holds what was done.
pub(crate) fn run(
    experiment: &Experiment,
    options: &Options<'_>,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> miette::Result<Option<Results>> {
    let wanted = wanted(experiment, options)?;
    let fingerprint = fingerprint()?;
    let mut done = read_log(options.log, &fingerprint)?;
    done.retain(|(trial, _)| wanted.contains(trial));
    done.sort_by(|a, b| a.0.cmp(&b.0));
    done.dedup_by(|a, b| a.0 == b.0);
    let missing: Vec<&Trial> = wanted
        .iter()
        .filter(|trial| !done.iter().any(|(other, _)| other == *trial))
        .collect();
    progress(done.len(), wanted.len());
    let log = open_log(options.log)?;
    let state = Mutex::new((done, log));
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads)
        .build()
        .into_diagnostic()?;
    pool.install(|| {
        missing.par_iter().with_max_len(1).try_for_each(|trial| {
            if options.stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            let measured = (experiment.run)(trial)
                .wrap_err_with(|| format!("scene {} with seed {}", trial.scene, trial.seed))?;
            let line = to_line(trial, &fingerprint, &measured);
            let mut state = state.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            writeln!(state.1, "{line}")
                .into_diagnostic()
                .wrap_err_with(|| format!("cannot write to {}", options.log.display()))?;
            state.0.push(((*trial).clone(), measured));
            progress(state.0.len(), wanted.len());
            Ok::<(), miette::Report>(())
        })
    })?;
    let (done, _) = state
        .into_inner()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    Ok((done.len() == wanted.len()).then(|| Results::new(done)))
}

fn wanted(experiment: &Experiment, options: &Options<'_>) -> miette::Result<Vec<Trial>> {
    let mut scenes = (experiment.scenes)(options.extent);
    if let Some(unknown) = options
        .scenes
        .iter()
        .find(|name| scenes.iter().all(|(scene, _)| scene != name))
    {
        let names: Vec<&str> = scenes.iter().map(|(scene, _)| *scene).collect();
        return Err(miette!(
            "the experiment has no scene `{unknown}`; it has: {}",
            names.join(", ")
        ));
    }
    scenes.retain(|(scene, _)| options.scenes.is_empty() || options.scenes.iter().any(|name| name == scene));
    let trials = scenes
        .iter()
        .flat_map(|(scene, seeds)| {
            (1..=options.seeds.unwrap_or(*seeds)).map(|seed| Trial {
                scene: (*scene).to_owned(),
                seed,
                quick: options.extent == Extent::Quick,
            })
        })
        .collect();
    Ok(trials)
}

/// What distinguishes this very program from others.
fn fingerprint() -> miette::Result<String> {
    let path = std::env::current_exe().into_diagnostic()?;
    let program = std::fs::read(&path)
        .into_diagnostic()
        .wrap_err("cannot read the program itself, by which results are known as its own")?;
    let mut hasher = DefaultHasher::new();
    hasher.write(&program);
    Ok(format!("{:016x}", hasher.finish()))
}

fn to_line(trial: &Trial, fingerprint: &str, measured: &Measured) -> Value {
    json!({
        "program": fingerprint,
        "scene": trial.scene,
        "seed": trial.seed,
        "quick": trial.quick,
        "measured": measured,
    })
}

/// The trials in a log that are this program's. A line that was cut off by an interruption is left out.
fn read_log(path: &Path, fingerprint: &str) -> miette::Result<Vec<(Trial, Measured)>> {
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => {
            return Err(error)
                .into_diagnostic()
                .wrap_err_with(|| format!("cannot read {}", path.display()));
        }
    };
    let mut trials = Vec::new();
    for line in BufReader::new(file).split(b'\n') {
        let line = line
            .into_diagnostic()
            .wrap_err_with(|| format!("cannot read {}", path.display()))?;
        trials.extend(from_line(&line, fingerprint));
    }
    Ok(trials)
}

fn from_line(line: &[u8], fingerprint: &str) -> Option<(Trial, Measured)> {
    let value: Value = serde_json::from_slice(line).ok()?;
    if value.get("program")?.as_str()? != fingerprint {
        return None;
    }
    let trial = Trial {
        scene: value.get("scene")?.as_str()?.to_owned(),
        seed: value.get("seed")?.as_u64()?,
        quick: value.get("quick")?.as_bool()?,
    };
    let measured = serde_json::from_value(value.get("measured")?.clone()).ok()?;
    Some((trial, measured))
}

/// Opens the log for more lines, on a line of their own also after one that was cut off.
fn open_log(path: &Path) -> miette::Result<File> {
    let cannot = || format!("cannot write to {}", path.display());
    if let Some(directory) = path.parent() {
        std::fs::create_dir_all(directory)
            .into_diagnostic()
            .wrap_err_with(cannot)?;
    }
    let mut file = OpenOptions::new()
        .create(true)
        .append(true)
        .open(path)
        .into_diagnostic()
        .wrap_err_with(cannot)?;
    if file.metadata().is_ok_and(|metadata| metadata.len() > 0) {
        writeln!(file).into_diagnostic().wrap_err_with(cannot)?;
    }
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::super::claim::Report;
    use super::*;
    use std::collections::BTreeMap;
    use std::sync::atomic::AtomicUsize;

    static RUNS: AtomicUsize = AtomicUsize::new(0);

    fn measure(trial: &Trial) -> miette::Result<Measured> {
        RUNS.fetch_add(1, Ordering::Relaxed);
        let error = if trial.scene == "far" { 2.0 } else { 1.0 } * trial.seed as f64;
        let metrics = BTreeMap::from([("error".to_owned(), error)]);
        Ok(BTreeMap::from([("plain".to_owned(), metrics)]))
    }

    const EXPERIMENT: Experiment = Experiment {
        name: "test",
        paper: "none",
        scenes: |_| vec![("near", 3), ("far", 2)],
        run: measure,
        judge: |_| Report::default(),
        causes: &[],
    };

    #[test]
    fn trials_are_kept_in_order_and_not_run_twice() {
        let directory = tempfile::tempdir().unwrap();
        let log = directory.path().join("deep/trials.jsonl");
        let stop = AtomicBool::new(false);
        let options = |seeds| Options {
            extent: Extent::Quick,
            seeds,
            scenes: &[],
            threads: 2,
            log: &log,
            stop: &stop,
        };
        let results = run(&EXPERIMENT, &options(None), &|_, _| ()).unwrap().unwrap();
        assert_eq!(results.values("near", "error", "plain"), [1.0, 2.0, 3.0]);
        assert_eq!(results.values("far", "error", "plain"), [2.0, 4.0]);
        assert!(results.values("far", "error", "fancy").is_empty());
        assert_eq!(RUNS.load(Ordering::Relaxed), 5);
        // A line that an interruption cut off is done again; the others are not, and more seeds are added to them.
        let text = std::fs::read_to_string(&log).unwrap();
        std::fs::write(&log, &text[..text.len() - 20]).unwrap();
        let results = run(&EXPERIMENT, &options(Some(4)), &|_, _| ()).unwrap().unwrap();
        assert_eq!(results.values("near", "error", "plain"), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(RUNS.load(Ordering::Relaxed), 5 + 1 + 3);
        let far = ["far".to_owned()];
        let one = Options {
            scenes: &far,
            ..options(None)
        };
        let results = run(&EXPERIMENT, &one, &|_, _| ()).unwrap().unwrap();
        assert!(results.values("near", "error", "plain").is_empty());
        assert_eq!(results.values("far", "error", "plain"), [2.0, 4.0]);
        let nowhere = ["nowhere".to_owned()];
        let unknown = Options {
            scenes: &nowhere,
            ..options(None)
        };
        let error = run(&EXPERIMENT, &unknown, &|_, _| ()).unwrap_err().to_string();
        assert!(error.contains("`nowhere`; it has: near, far"), "{error}");
        stop.store(true, Ordering::Relaxed);
        assert!(run(&EXPERIMENT, &options(Some(5)), &|_, _| ()).unwrap().is_none());
    }

    #[test]
    fn results_of_another_program_do_not_count() {
        let trial = Trial {
            scene: "near".into(),
            seed: 1,
            quick: true,
        };
        let line = to_line(&trial, "abc", &Measured::new()).to_string();
        assert_eq!(from_line(line.as_bytes(), "abc"), Some((trial, Measured::new())));
        assert_eq!(from_line(line.as_bytes(), "abd"), None);
    }
}
