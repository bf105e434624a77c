//! What is fed with damaged files.

mod calibration;
mod cascade;
mod flac;
mod microphones;
mod parameters;
mod recording;
mod room;
mod saved_run;
mod scenario;
mod state;
mod wav;

/// Tries one file.
pub type Trial = Box<dyn FnMut(&[u8]) -> Verdict>;

/// What became of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It was refused, with this message.
    Refused(String),
    /// It was read and could be used; what was read, in a few words.
    Read(String),
    /// It was read, and something that is promised does not hold.
    Broken(String),
}

/// Something that reads bytes from outside.
#[derive(Clone, Copy)]
pub struct Target {
    /// Its name.
    pub name: &'static str,
    /// One sentence: what is read, and what must hold of what was read.
    pub meaning: &'static str,
    /// Whether files are text.
    pub text: bool,
    /// Words that mean something in such files.
    pub words: &'static [&'static str],
    /// Longest file tried, bytes.
    pub longest: usize,
    /// Sound files, and files that went wrong once.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// Makes ready to try files.
    pub open: fn() -> Trial,
}

/// Every target there is.
pub const TARGETS: &[Target] = &[
    cascade::TARGET,
    calibration::TARGET,
    room::TARGET,
    scenario::TARGET,
    microphones::TARGET,
    parameters::TARGET,
    state::TARGET,
    saved_run::TARGET,
    recording::TARGET,
    wav::TARGET,
    flac::TARGET,
];

/// Texts as seeds.
fn texts(texts: &[&str]) -> Vec<Vec<u8>> {
    texts.iter().map(|text| text.as_bytes().to_vec()).collect()
}
