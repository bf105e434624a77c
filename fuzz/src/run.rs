//! The loop: damage, try, keep what is new.

use crate::coverage::Coverage;
use crate::guard::Guard;
use crate::mutate::Damage;
use crate::random::Random;
use crate::shrink::shrink;
use crate::targets::{Target, Verdict};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Most cases kept to be damaged further.
const MOST_KEPT: usize = 20_000;
/// Most different findings reported.
const MOST_FINDINGS: usize = 50;

/// How long a run takes, and from where it starts.
#[derive(Clone, Debug)]
pub struct Options {
    /// How long; seeds are always tried.
    pub time: Duration,
    /// Seed of all random numbers.
    pub seed: u64,
    /// A file to which every case is written before it is tried, for cases that end the process.
    pub trace: Option<PathBuf>,
}

/// What went wrong.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The panic with its place, or what took too long or too much, or what was promised and not kept.
    pub wrong: String,
    /// Number of the case, from 0.
    pub case: u64,
    /// The file, made as small as it goes.
    pub input: Vec<u8>,
}

/// What a run saw.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Cases tried.
    pub cases: u64,
    /// Those that were read without an error.
    pub read: u64,
    /// Those that were kept because they showed something new.
    pub kept: usize,
    /// Time of the slowest.
    pub slowest: Duration,
    /// Most bytes that one allocated at once.
    pub most_bytes: usize,
    /// What went wrong, each kind once.
    pub findings: Vec<Finding>,
}

impl Options {
    /// From HEARSIGHT_FUZZ_SECONDS (default 1), HEARSIGHT_FUZZ_SEED (default 1) and HEARSIGHT_FUZZ_TRACE (default none).
    ///
    /// # Errors
    /// Where one is no number.
    pub fn from_environment() -> Result<Self, String> {
        let number = |name: &str, default: &str| std::env::var(name).unwrap_or_else(|_| default.to_owned());
        let seconds = number("HEARSIGHT_FUZZ_SECONDS", "1");
        let time = seconds
            .parse()
            .ok()
            .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
        let seed = number("HEARSIGHT_FUZZ_SEED", "1");
        Ok(Self {
            time: time.ok_or_else(|| format!("HEARSIGHT_FUZZ_SECONDS={seconds} are no seconds"))?,
            seed: seed
                .parse()
                .map_err(|_| format!("HEARSIGHT_FUZZ_SEED={seed} is no whole number"))?,
            trace: std::env::var_os("HEARSIGHT_FUZZ_TRACE").map(PathBuf::from),
        })
    }
}

/// Tries one case.
///
/// # Errors
/// What went wrong.
pub fn run_one(target: &Target, input: &[u8]) -> Result<Verdict, String> {
    Guard::new(target, None).attempt(input).verdict
}

/// Tries the seeds of a target and what comes of damaging them.
pub fn run(target: &Target, options: &Options) -> Report {
    let mut run = Run {
        guard: Guard::new(target, options.trace.clone()),
        coverage: Coverage::default(),
        known: BTreeSet::new(),
        wrong: BTreeSet::new(),
        kept: Vec::new(),
        report: Report::default(),
    };
    let begun = Instant::now();
    for seed in (target.seeds)() {
        run.attempt(&seed);
        run.kept.push(seed);
    }
    let seeds = run.kept.len();
    let damage = Damage {
        text: target.text,
        words: target.words,
        longest: target.longest,
    };
    let mut random = Random(options.seed);
    while begun.elapsed() < options.time {
        // The newest are the least explored.
        let newest = run.kept.len() - run.kept.len() / 4;
        let from = if random.one_in(2) {
            0
        } else {
            newest.min(run.kept.len() - 1)
        };
        let one = from + random.below(run.kept.len() - from);
        let other = random.below(run.kept.len());
        let mut input = run.kept[one].clone();
        damage.apply(&mut input, &run.kept[other], &mut random);
        if run.attempt(&input) {
            if run.kept.len() < MOST_KEPT {
                run.kept.push(input);
            } else {
                let place = seeds + random.below(run.kept.len() - seeds);
                run.kept[place] = input;
            }
        }
    }
    run.report.kept = run.kept.len() - seeds;
    run.report
}

struct Run<'a> {
    guard: Guard<'a>,
    coverage: Coverage,
    known: BTreeSet<String>,
    wrong: BTreeSet<String>,
    kept: Vec<Vec<u8>>,
    report: Report,
}

impl Run<'_> {
    /// Tries a case; whether it showed something new.
    fn attempt(&mut self, input: &[u8]) -> bool {
        self.coverage.begin();
        let outcome = self.guard.attempt(input);
        let new_way = self.coverage.is_new();
        let case = self.report.cases;
        self.report.cases += 1;
        self.report.slowest = self.report.slowest.max(outcome.time);
        self.report.most_bytes = self.report.most_bytes.max(outcome.bytes);
        match outcome.verdict {
            Ok(verdict) => {
                self.report.read += u64::from(matches!(verdict, Verdict::Read(_)));
                new_way.unwrap_or_else(|| self.known.insert(kind(&format!("{verdict:?}"))))
            }
            Err(wrong) => {
                if self.wrong.len() < MOST_FINDINGS && self.wrong.insert(kind(&wrong)) {
                    let input = shrink(&mut self.guard, input, &wrong);
                    self.report.findings.push(Finding { wrong, case, input });
                }
                false
            }
        }
    }
}

/// A message without what differs from case to case: numbers, and what it quotes of the file.
pub(crate) fn kind(message: &str) -> String {
    let mut kind = String::new();
    let mut quote = None;
    for letter in message.chars() {
        match quote {
            Some(end) if letter == end => quote = None,
            Some(_) => {}
            None if matches!(letter, '"' | '`') => quote = Some(letter),
            None if letter.is_ascii_digit() => {}
            None => kind.push(letter),
        }
    }
    kind.chars().take(160).collect()
}
