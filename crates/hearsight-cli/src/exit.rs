//! What the program's exit codes mean.

use std::process::ExitCode;

/// The part of `--help` on exit codes.
pub(crate) const HELP: &str = "\
Exit codes:
  0    done; faults in the data, if any, are in the report
  1    failed: the message says what is wrong and what helps; `check`: the room is not sane
  2    the command line is wrong
  3    done, but with faults or warnings, where --strict asks for this
  130  interrupted by Ctrl-C; every output is closed and valid";

/// How the program ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Code {
    /// Done.
    Done,
    /// Failed.
    Failure,
    /// Done, but with faults.
    Faults,
    /// Interrupted.
    Interrupted,
}

impl Code {
    /// The number.
    pub(crate) const fn number(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Failure => 1,
            Self::Faults => 3,
            Self::Interrupted => 130,
        }
    }
}

impl From<Code> for ExitCode {
    fn from(code: Code) -> Self {
        Self::from(code.number())
    }
}
