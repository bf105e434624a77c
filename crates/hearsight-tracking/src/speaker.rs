//! Who speaks: one decision over every track and "nobody".
//!
//! A hidden Markov model whose states are the published tracks and "nobody"; its forward probabilities are the saved
//! state. While there is sound, a track explains it by the height of the correlation at the delay of its mouth, with the
//! likelihood of the sound cue (stac, eq. 8, corrected); "nobody" (a person outside the picture, a noise) explains every
//! sound as well as a correlation of middling height would.

use crate::percepts::ArrayPercepts;
use hearsight_core::Span;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the speaker is decided.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SpeakerSettings {
    /// Half the width of the window around the delay of a mouth in which the correlation is looked at, seconds. Default
    /// 1.0e-4: half a head's width at two metres between microphones a metre apart. Raising it forgives bad calibration and
    /// confuses neighbours.
    pub tolerance_s: f64,
    /// Width of the likelihood of a height (sigma_A of eq. 8). Default 0.3.
    pub sigma: f64,
    /// Height of correlation at which a track explains a sound just as well as "nobody", 0 to 1. Default 0.45. Raising it
    /// decides for people more rarely.
    pub even_height: f64,
    /// Time over which what is heard counts once, seconds. Default 0.05. Raising it decides more slowly and surely.
    pub independent_s: f64,
    /// Mean time for which one speaker goes on unheard, seconds. Default 0.5. Raising it switches later.
    pub turn_s: f64,
    /// How fast silence makes "nobody" likelier: change of the logarithm of odds a second. Default 4.
    pub silence: f64,
    /// Probability before anything is heard that the sound of a moment comes from nobody in the picture, 0 to 1.
    /// Default 0.3.
    pub nobody: f64,
    /// Probability that a track must reach to be called the speaker, 0 to 1. Default 0.5.
    pub least: f64,
}

impl Default for SpeakerSettings {
    fn default() -> Self {
        Self {
            tolerance_s: 1.0e-4,
            sigma: 0.3,
            even_height: 0.45,
            independent_s: 0.05,
            turn_s: 0.5,
            silence: 4.0,
            nobody: 0.3,
            least: 0.5,
        }
    }
}

/// A track as the decision sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Voice {
    /// Its identity.
    pub identity: u64,
    /// Delay of its mouth, seconds, where known.
    pub delay_s: Option<f64>,
    /// Whether it is hidden, so that its place is less sure.
    pub hidden: bool,
}

/// Probabilities of speaking, saved from step to step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Speaker {
    nobody: f64,
    people: Vec<(u64, f64)>,
    heard: bool,
}

impl Default for Speaker {
    fn default() -> Self {
        Self {
            nobody: 1.0,
            people: Vec::new(),
            heard: false,
        }
    }
}

impl Speaker {
    /// The probability that nobody in the picture speaks; `None` before any sound.
    pub fn nobody_probability(&self) -> Option<f64> {
        self.heard.then_some(self.nobody)
    }

    /// The probability that a track speaks, 0 where it is unknown.
    pub fn probability_of(&self, identity: u64) -> f64 {
        self.people
            .iter()
            .find(|(known, _)| *known == identity)
            .map_or(0.0, |(_, probability)| *probability)
    }

    /// The track that speaks, if any does.
    pub fn speaking(&self, settings: &SpeakerSettings) -> Option<u64> {
        self.people
            .iter()
            .copied()
            .filter(|(_, probability)| *probability >= settings.least && *probability > self.nobody)
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(identity, _)| identity)
    }

    /// Takes in what the array heard since the last call, over the tracks that are there now.
    pub fn listen(
        &mut self,
        voices: &[Voice],
        array: &ArrayPercepts,
        elapsed: Span,
        settings: &SpeakerSettings,
    ) {
        self.predict(voices, elapsed, settings);
        if array.has_sound() {
            self.explain(voices, array, elapsed, settings);
        } else {
            self.be_silent(elapsed, settings);
        }
        self.heard = true;
    }

    /// Follows the tracks that are there and lets every state change with time.
    fn predict(&mut self, voices: &[Voice], elapsed: Span, settings: &SpeakerSettings) {
        let before = std::mem::take(&mut self.people);
        let known = |identity| {
            before
                .iter()
                .find(|(other, _)| *other == identity)
                .map_or(0.0, |(_, probability)| *probability)
        };
        self.people = voices
            .iter()
            .map(|voice| (voice.identity, known(voice.identity)))
            .collect();
        // Whoever left took their speaking along: it is nobody's in the picture now.
        let kept: f64 = self.people.iter().map(|(_, probability)| probability).sum();
        self.nobody = (1.0 - kept).max(0.0);
        let stay = (-elapsed.seconds().max(0.0) / settings.turn_s.max(1e-3)).exp();
        let each = (1.0 - settings.nobody) / voices.len().max(1) as f64;
        let nobody = if voices.is_empty() { 1.0 } else { settings.nobody };
        self.nobody = stay * self.nobody + (1.0 - stay) * nobody;
        for (_, probability) in &mut self.people {
            *probability = stay * *probability + (1.0 - stay) * each;
        }
    }

    fn be_silent(&mut self, elapsed: Span, settings: &SpeakerSettings) {
        let factor = (-settings.silence * elapsed.seconds().max(0.0)).exp();
        for (_, probability) in &mut self.people {
            *probability *= factor;
        }
        self.normalize();
    }

    fn explain(
        &mut self,
        voices: &[Voice],
        array: &ArrayPercepts,
        elapsed: Span,
        settings: &SpeakerSettings,
    ) {
        let log_likelihood = |height: f64| -0.5 * ((1.0 - height) / settings.sigma.max(1e-3)).powi(2);
        let share = (elapsed.seconds().max(0.0) / settings.independent_s.max(1e-3)).min(1.0);
        let even = log_likelihood(settings.even_height);
        for ((_, probability), voice) in self.people.iter_mut().zip(voices) {
            let Some(delay_s) = voice.delay_s else { continue };
            let tolerance_s = settings.tolerance_s * if voice.hidden { 2.0 } else { 1.0 };
            let height = f64::from(array.voice_height(delay_s, tolerance_s));
            *probability *= (share * (log_likelihood(height) - even)).exp();
        }
        self.normalize();
    }

    fn normalize(&mut self) {
        let sum = self.nobody
            + self
                .people
                .iter()
                .map(|(_, probability)| probability)
                .sum::<f64>();
        if !(sum > 0.0 && sum.is_finite()) {
            self.nobody = 1.0;
            self.people
                .iter_mut()
                .for_each(|(_, probability)| *probability = 0.0);
            return;
        }
        self.nobody /= sum;
        self.people
            .iter_mut()
            .for_each(|(_, probability)| *probability /= sum);
    }
}
