//! Diarization error rate: how much of the speech is missed, made up, or given to the wrong speaker.
//!
//! NIST, "Rich transcription spring 2003 evaluation plan"; numbers are those of pyannote.metrics, also where there is no
//! speech: the rate is then 0 without errors and 1 with any. Speakers are paired so that both sides speak together as
//! long as possible.

use super::{Better, Counts, Family, JudgeError, MetricInfo, NOT_NEGATIVE, Unit, metric};
use crate::case::Case;
use crate::speech::{Speech, TooManyTurns, compare};

/// The family.
pub struct Diarization;

/// What is counted, seconds; speakers who speak at once count each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DiarizationCounts {
    /// Speech of the truth.
    pub total_s: f64,
    /// Speech that the result gives to the right speaker.
    pub correct_s: f64,
    /// Speech that only the result has.
    pub false_alarm_s: f64,
    /// Speech that only the truth has.
    pub missed_s: f64,
    /// Speech that the result gives to another speaker.
    pub confusion_s: f64,
}

/// Counts what both sides have of speech.
///
/// # Errors
/// [`TooManyTurns`].
pub fn diarization(speech: &Speech) -> Result<DiarizationCounts, TooManyTurns> {
    let compared = compare(speech)?;
    let mut counts = DiarizationCounts::default();
    for stretch in &compared.stretches {
        let turns = |side: &[(u32, u32)]| side.iter().map(|&(_, turns)| turns).sum::<u32>();
        let (truth, result) = (turns(&stretch.truth), turns(&stretch.result));
        let right = |&(person, turns): &(u32, u32)| {
            let own = compared.result_of_truth.get(&person)?;
            let place = stretch.result.binary_search_by_key(own, |&(who, _)| who).ok()?;
            Some(turns.min(stretch.result[place].1))
        };
        let correct: u32 = stretch.truth.iter().filter_map(right).sum();
        let add = |sum: &mut f64, turns: u32| *sum += stretch.duration_s * f64::from(turns);
        add(&mut counts.total_s, truth);
        add(&mut counts.correct_s, correct);
        add(&mut counts.confusion_s, truth.min(result) - correct);
        add(&mut counts.missed_s, truth.saturating_sub(result));
        add(&mut counts.false_alarm_s, result.saturating_sub(truth));
    }
    Ok(counts)
}

impl DiarizationCounts {
    /// The rate, 0 to infinity.
    pub fn rate(&self) -> f64 {
        let wrong_s = self.false_alarm_s + self.missed_s + self.confusion_s;
        if self.total_s > 0.0 {
            wrong_s / self.total_s
        } else {
            f64::from(wrong_s > 0.0)
        }
    }
}

impl Counts for DiarizationCounts {
    fn add(&mut self, other: &Self) {
        self.total_s += other.total_s;
        self.correct_s += other.correct_s;
        self.false_alarm_s += other.false_alarm_s;
        self.missed_s += other.missed_s;
        self.confusion_s += other.confusion_s;
    }

    fn values(&self) -> Vec<Option<f64>> {
        let all = [
            self.rate(),
            self.missed_s,
            self.false_alarm_s,
            self.confusion_s,
            self.correct_s,
            self.total_s,
        ];
        all.map(Some).to_vec()
    }
}

const fn seconds(name: &'static str, better: Better, meaning: &'static str) -> MetricInfo {
    metric(name, Unit::Seconds, NOT_NEGATIVE, better, meaning)
}

impl Family for Diarization {
    type Counts = DiarizationCounts;
    const NAME: &'static str = "Diarization";
    const SOURCE: &'static str = "NIST 2003; numbers as pyannote.metrics";
    const METRICS: &'static [MetricInfo] = &[
        metric(
            "diarization error rate",
            Unit::Ratio,
            NOT_NEGATIVE,
            Better::Down,
            "Missed, made-up and confused speech as a part of all speech.",
        ),
        seconds(
            "missed detection",
            Better::Down,
            "Speech that only the truth has.",
        ),
        seconds("false alarm", Better::Down, "Speech that only the result has."),
        seconds("confusion", Better::Down, "Speech given to another speaker."),
        seconds("correct", Better::Up, "Speech given to the right speaker."),
        seconds("total", Better::Neither, "Speech of the truth."),
    ];

    fn count(case: &Case) -> Result<Option<DiarizationCounts>, JudgeError> {
        Ok(case.speech.as_ref().map(diarization).transpose()?)
    }
}
