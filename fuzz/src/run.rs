//! The loop: damage, try, keep what is new.

use crate::coverage::Coverage;
use crate::guard::Guard;
use crate::mutate::Damage;
use crate::random::Random;
use crate::shrink::shrink;
use crate::targets::{Target, Verdict};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
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

impl Finding {
    /// Seed and case, what went wrong, and the beginning of the file; [`Finding::write`] writes all of it.
    pub fn describe(&self, options: &Options) -> String {
        let start = &self.input[..self.input.len().min(200)];
        format!(
            "seed {}, case {}: {}\n{}",
            options.seed,
            self.case,
            self.wrong,
            start.escape_ascii()
        )
    }

    /// Writes the file into a directory and says how to try it again.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn write(&self, target: &Target, options: &Options, directory: &Path) -> std::io::Result<String> {
        let file = directory.join(format!("{}-{}-{}", target.name, options.seed, self.case));
        std::fs::write(&file, &self.input)?;
        Ok(format!(
            "cargo run -p hearsight-fuzz -- {} {}",
            target.name,
            file.display()
        ))
    }
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

/// Tries the seeds of a target and what comes of damaging them. `tell` hears of every finding at once, since a later
/// case may end the process.
pub fn run(target: &Target, options: &Options, tell: &mut dyn FnMut(&Finding)) -> Report {
    let mut run = Run {
        guard: Guard::new(target, options.trace.clone()),
        coverage: Coverage::default(),
        known: BTreeSet::new(),
        wrong: BTreeSet::new(),
        kept: Vec::new(),
        read: Vec::new(),
        report: Report::default(),
        tell,
    };
    let begun = Instant::now();
    for seed in (target.seeds)() {
        run.attempt(&seed);
        // Whatever became of it: a file that went wrong once is worth damaging too.
        run.kept.push(seed);
    }
    let seeds = run.kept.len() + run.read.len();
    let damage = Damage {
        text: target.text,
        words: target.words,
        longest: target.longest,
    };
    let mut random = Random(options.seed);
    while begun.elapsed() < options.time {
        let mut input = run.pick(&mut random).clone();
        damage.apply(&mut input, run.pick(&mut random), &mut random);
        run.attempt(&input);
    }
    run.report.kept = run.kept.len() + run.read.len() - seeds;
    run.report
}

struct Run<'a> {
    guard: Guard<'a>,
    coverage: Coverage,
    known: BTreeSet<String>,
    wrong: BTreeSet<String>,
    /// Seeds, and what was refused in a new way.
    kept: Vec<Vec<u8>>,
    /// What was read in a new way.
    read: Vec<Vec<u8>>,
    report: Report,
    tell: &'a mut dyn FnMut(&Finding),
}

impl Run<'_> {
    /// A file to damage. What can be read leads further than what is refused at its beginning, and the newest is the
    /// least explored.
    fn pick(&self, random: &mut Random) -> &Vec<u8> {
        let list = if self.read.is_empty() || random.one_in(3) {
            &self.kept
        } else {
            &self.read
        };
        let newest = if random.one_in(2) {
            list.len() - list.len().div_ceil(4)
        } else {
            0
        };
        &list[newest + random.below(list.len() - newest)]
    }

    /// Tries a case, and keeps it where it showed something new.
    fn attempt(&mut self, input: &[u8]) {
        self.coverage.begin();
        let outcome = self.guard.attempt(input);
        let new_way = self.coverage.is_new();
        let case = self.report.cases;
        self.report.cases += 1;
        self.report.slowest = self.report.slowest.max(outcome.time);
        self.report.most_bytes = self.report.most_bytes.max(outcome.bytes);
        match outcome.verdict {
            Ok(verdict) => {
                let is_read = matches!(verdict, Verdict::Read(_));
                self.report.read += u64::from(is_read);
                let list = if is_read { &mut self.read } else { &mut self.kept };
                let is_new = new_way.unwrap_or_else(|| self.known.insert(kind(&format!("{verdict:?}"))));
                if is_new && list.len() < MOST_KEPT {
                    list.push(input.to_vec());
                }
            }
            Err(wrong) => {
                if self.wrong.len() < MOST_FINDINGS && self.wrong.insert(kind(&wrong)) {
                    let input = shrink(&mut self.guard, input, &wrong);
                    let finding = Finding { wrong, case, input };
                    (self.tell)(&finding);
                    self.report.findings.push(finding);
                }
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
