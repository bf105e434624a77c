//! Experiments of the papers, run again on simulated rooms: seeds in parallel, resumable, judged claim by claim.
//!
//! An experiment says which scenes it needs, measures one of them with one seed, and judges what all seeds gave
//! ([`Experiment`]). What runs the seeds and keeps what was measured ([`trials`]), and what turns numbers into verdicts
//! ([`claim`]), is common to all. The systems see pictures and samples only; the truth goes to the measuring code.
//!
//! To add an experiment: its own file, its test, and a line in [`EXPERIMENTS`].

pub(crate) mod claim;
mod closed_loop;
pub(crate) mod lockstep;
pub(crate) mod observed;
mod stac;
mod three_mics;
pub(crate) mod trials;

use claim::Report;
use std::collections::BTreeMap;
use trials::Results;

/// Every experiment there is.
pub(crate) const EXPERIMENTS: &[&Experiment] = &[
    &stac::EXPERIMENT,
    &closed_loop::EXPERIMENT,
    &three_mics::EXPERIMENT,
];

/// How much of an experiment is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extent {
    /// Short scenes and few seeds: minutes.
    Quick,
    /// As the paper has it.
    Full,
}

/// A paper's experiment.
#[derive(Clone, Copy)]
pub(crate) struct Experiment {
    /// Name of the system, as in `room.toml`.
    pub(crate) name: &'static str,
    /// The paper.
    pub(crate) paper: &'static str,
    /// Scenes by name with the number of seeds of each.
    pub(crate) scenes: fn(Extent) -> Vec<(&'static str, u64)>,
    /// Simulates one scene with one seed, tracks it with every variant of the system, and measures.
    pub(crate) run: fn(&Trial) -> miette::Result<Measured>,
    /// Judges the claims.
    pub(crate) judge: fn(&Results) -> Report,
    /// Why claims that fail do, as far as it has been found out.
    pub(crate) causes: &'static claim::Causes,
}

/// One scene with one seed.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Trial {
    /// Name of the scene.
    pub(crate) scene: String,
    /// Seed of the simulation and of the trackers, from 1.
    pub(crate) seed: u64,
    /// Whether the scene is short.
    pub(crate) quick: bool,
}

/// What was measured: for each variant of the system its metrics by name. A metric that could not be measured is missing.
pub(crate) type Measured = BTreeMap<String, BTreeMap<String, f64>>;
