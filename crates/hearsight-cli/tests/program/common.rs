//! A small recording that the program itself simulates, and ways to run the program.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;
use tempfile::TempDir;

/// Length of the recording, seconds: that of `recording.toml`.
pub(crate) const SECONDS: f64 = 5.0;

/// The program, not yet started.
pub(crate) fn hearsight(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hearsight"));
    command
        .args(arguments)
        .env_remove("RUST_LOG")
        .env("NO_COLOR", "1");
    command
}

/// Runs the program to its end.
pub(crate) fn run(arguments: &[&str]) -> Output {
    hearsight(arguments).output().unwrap()
}

/// What the program printed to standard error.
pub(crate) fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What the program printed.
pub(crate) fn printed(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The directory of a recording with `room.toml`, `front.mp4`, `pair.wav` and the truth, made once a test program.
pub(crate) fn recording() -> &'static Path {
    static RECORDING: OnceLock<TempDir> = OnceLock::new();
    let directory = RECORDING.get_or_init(|| {
        let directory = TempDir::new().unwrap();
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program/recording.toml");
        let out = directory.path().to_str().unwrap();
        let made = run(&[
            "simulate",
            scene.to_str().unwrap(),
            "--format",
            "mp4",
            "--out",
            out,
        ]);
        assert!(made.status.success(), "{}", errors(&made));
        directory
    });
    directory.path()
}

/// A text as a string for TOML.
pub(crate) fn quoted(path: &Path) -> String {
    format!("{:?}", path.to_str().unwrap())
}

/// Every file of a directory with its content, by name.
pub(crate) fn contents(directory: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<(String, Vec<u8>)> = std::fs::read_dir(directory)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| {
            (
                path.file_name().unwrap().to_str().unwrap().to_owned(),
                std::fs::read(&path).unwrap(),
            )
        })
        .collect();
    files.sort();
    files
}

/// The data that are not part of the project, where they are there.
pub(crate) fn shared_data() -> Option<PathBuf> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/av16.3-seq30");
    if directory.is_dir() {
        return Some(directory);
    }
    eprintln!("skipped: {} is missing", directory.display());
    None
}
