//! The judge: results and truth to metrics and reports. Tracks nothing and knows no tracker.
//!
//! * [`Sequence`] — who is where and what was found, instant by instant, by a [`Measure`] of distance.
//! * [`events`] — what happened to each person and track: the log that most metrics are counted from.
//! * [`read`] — files to [`Recording`]s, one a side; [`pair()`] — two recordings to [`Case`]s.
//! * [`metrics`] — pure functions from these to counts, and from counts to values with unit and range. Many sequences are
//!   merged by adding counts, never by averaging ratios.
//! * [`Report`] — the values as a table, as JSON, and as one page of HTML with plots.
//! * [`statistics`] — intervals and tests for experiments with many seeds.

mod case;
mod events;
mod matching;
mod measure;
pub mod metrics;
mod pair;
pub mod read;
mod recording;
mod report;
mod sequence;
mod speech;
pub mod statistics;

pub use case::Case;
pub use events::{Event, Pair, events};
pub use measure::{Measure, Place};
pub use pair::{Options, PairError, Paired, pair};
pub use recording::{Observation, ObservedFrame, Recording, Scope, Side, Stream};
pub use report::{Report, list_of_metrics};
pub use sequence::{Frame, Sequence, SequenceError, Sighting};
pub use speech::{Speech, TooManyTurns, Turn};
