//! Jaccard error rate: how much of each speaker's speech is wrong, every speaker of the truth weighing the same.
//!
//! Ryant et al., "Second DIHARD challenge evaluation plan", 2019; numbers are those of pyannote.metrics. A speaker whom
//! nobody of the result is paired with has the error 1. Without any speaker pyannote.metrics gives 1; here the rate is not
//! defined then.

use super::{Better, Counts, Family, JudgeError, MetricInfo, NOT_NEGATIVE, UNIT_RANGE, Unit, metric, ratio};
use crate::case::Case;
use crate::speech::{Speech, TooManyTurns, compare};
use std::collections::BTreeMap;

/// The family.
pub struct Jaccard;

/// What is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JaccardCounts {
    /// Speakers of the truth who speak in what is evaluated.
    pub speakers: u64,
    /// Sum of their errors, each 0 to 1.
    pub error: f64,
}

/// Counts the errors of the speakers of the truth.
///
/// # Errors
/// [`TooManyTurns`].
pub fn jaccard(speech: &Speech) -> Result<JaccardCounts, TooManyTurns> {
    let compared = compare(speech)?;
    let speakers_of =
        |side: &[(u32, u32)], who: u32| side.binary_search_by_key(&who, |&(who, _)| who).is_ok();
    // Of each speaker of the truth: seconds of both, and of either.
    let mut lives: BTreeMap<u32, [f64; 2]> = BTreeMap::new();
    let truth_of_result: BTreeMap<u32, u32> = compared
        .result_of_truth
        .iter()
        .map(|(&person, &track)| (track, person))
        .collect();
    for stretch in &compared.stretches {
        for &(person, _) in &stretch.truth {
            let own = compared.result_of_truth.get(&person);
            let both = own.is_some_and(|&track| speakers_of(&stretch.result, track));
            let [together, either] = lives.entry(person).or_default();
            *either += stretch.duration_s;
            if both {
                *together += stretch.duration_s;
            }
        }
        for (track, _) in &stretch.result {
            if let Some(&person) = truth_of_result.get(track)
                && !speakers_of(&stretch.truth, person)
            {
                lives.entry(person).or_default()[1] += stretch.duration_s;
            }
        }
    }
    Ok(JaccardCounts {
        speakers: lives.len() as u64,
        error: lives
            .values()
            .map(|[together, either]| 1.0 - together / either)
            .sum(),
    })
}

impl Counts for JaccardCounts {
    fn add(&mut self, other: &Self) {
        self.speakers += other.speakers;
        self.error += other.error;
    }

    fn values(&self) -> Vec<Option<f64>> {
        let speakers = self.speakers as f64;
        vec![ratio(self.error, speakers), Some(speakers)]
    }
}

impl Family for Jaccard {
    type Counts = JaccardCounts;
    const NAME: &'static str = "Jaccard";
    const SOURCE: &'static str = "Ryant et al. 2019; numbers as pyannote.metrics";
    const METRICS: &'static [MetricInfo] = &[
        metric(
            "jaccard error rate",
            Unit::Ratio,
            UNIT_RANGE,
            Better::Down,
            "Mean over speakers of the part of their and their track's speech that only one side has.",
        ),
        metric(
            "speaker count",
            Unit::Count,
            NOT_NEGATIVE,
            Better::Neither,
            "Speakers of the truth.",
        ),
    ];

    fn count(case: &Case) -> Result<Option<JaccardCounts>, JudgeError> {
        Ok(case.speech.as_ref().map(jaccard).transpose()?)
    }
}
