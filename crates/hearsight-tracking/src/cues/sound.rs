//! The sound cue: height of the correlation curve at the delay of a hypothesis' mouth (stac, section 2.2).
//!
//! A sound belongs to whoever made it: the score is drawn towards 1, which says nothing, by the probability that the
//! person does not speak. Otherwise one voice would pull at everybody.
//!
//! The raw score is R_n(tau(x)) = max(R, 0) / max R, which fusion turns into the likelihood of eq. 8 (corrected, E4).

use super::{Cue, CueInfo, Evidence, Hypotheses, Subject};
use crate::percepts::{ArrayPercepts, CameraPercepts};

pub(super) const INFO: CueInfo = CueInfo {
    name: "sound",
    meaning: "normalized cross-correlation of the microphone pair at the delay of the mouth (R_n, eq. 8 corrected)",
    unit: "1",
    range: (0.0, 1.0),
    larger_is_better: true,
    source: "Bregonzio, Taj, Cavallaro, section 2.2, eqs. 7-8, corrected",
};

/// Scores mouths by the correlation at their delay.
#[derive(Clone, Debug, Default)]
pub struct SoundCue {
    /// Whether every sound is of the one person who is followed, as the paper has it, instead of whoever speaks.
    pub one_talker: bool,
}

impl Cue for SoundCue {
    fn info(&self) -> &'static CueInfo {
        &INFO
    }

    fn subject(&self) -> Subject {
        Subject::Sounds
    }

    fn has_evidence(&self, _: &CameraPercepts, array: Option<&ArrayPercepts>) -> bool {
        array.is_some_and(ArrayPercepts::has_onset)
    }

    fn score(&self, hypotheses: &Hypotheses<'_>, scores: &mut [f32]) -> Evidence {
        let Some(array) = hypotheses.array.filter(|array| array.has_onset()) else {
            return Evidence::Missing;
        };
        if hypotheses.sounds.len() != scores.len() {
            return Evidence::Missing;
        }
        let speaking = if self.one_talker { 1.0 } else { hypotheses.speaking };
        for (score, point) in scores.iter_mut().zip(hypotheses.sounds) {
            let height = point
                .and_then(|point| array.delay_s(point))
                .map_or(0.0, |delay_s| array.onset_height(delay_s));
            *score = 1.0 - speaking * (1.0 - height);
        }
        Evidence::Scored
    }
}
