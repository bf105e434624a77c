//! Built-in talkers: people who speak without recordings, each with a voice of their own.
//!
//! Syllables without meaning, but with what matters to those who listen for speech: pitch that moves with the sentence,
//! vowels and consonants, about four syllables a second, pauses between words and phrases. What makes a voice known
//! again — pitch, length of the tract, place of the formants, breath, brightness — is drawn once from the seed.

mod phones;
mod tract;

use super::speech::{Speech, Utterance, normalize};
use super::turns::Turn;
use crate::acoustics::AcousticsError;
use crate::acoustics::error::check;
use crate::acoustics::random::{Generator, between, derive, generator, normal};
use phones::{Phone, REST, syllable};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use tract::{CONTROL_S, Score, sing};

/// Whose voice it is like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TalkerKind {
    /// 85 to 155 Hz.
    Man,
    /// 155 to 255 Hz.
    Woman,
    /// 240 to 340 Hz.
    Child,
}

/// What distinguishes a voice, all over those of an average man unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TalkerTraits {
    /// Usual pitch, hertz.
    pitch_hz: f32,
    /// How far it moves, octaves.
    liveliness: f32,
    /// The first three formants, and the upper ones.
    formants: [f32; 4],
    /// The fourth formant besides.
    fourth: f32,
    /// Width of the formants.
    width: f32,
    /// Share of a pulse in which the folds are open.
    open_share: f32,
    /// How long they take to close, a share of the pulse.
    closure: f32,
    /// Breath in the voice, 0 to 1.
    breath: f32,
    /// Strength of fricatives.
    friction: f32,
    /// Where and how much the spectrum's slope changes.
    darkness: f32,
    brightness: f32,
    /// Irregularity of pulses: a share of their length and strength.
    jitter: f32,
    shimmer: f32,
    /// Speed of speaking.
    tempo: f32,
}

/// A person's voice.
#[derive(Clone, Debug, PartialEq)]
pub struct Talker {
    seed: u64,
    traits: TalkerTraits,
}

impl Talker {
    /// The voice that belongs to a seed; another seed, another voice.
    pub fn new(kind: TalkerKind, seed: u64) -> Self {
        let mut random = generator(seed, "talker", 0);
        let mut draw = |low: f64, high: f64| between(&mut random, low, high) as f32;
        // Pitch evenly over the logarithm; the tract goes its own way with some of the pitch's.
        let ((low, high), size) = match kind {
            TalkerKind::Man => ((85.0_f64, 155.0_f64), 1.0),
            TalkerKind::Woman => ((155.0, 255.0), 1.16),
            TalkerKind::Child => ((240.0, 340.0), 1.34),
        };
        let place = draw(0.0, 1.0);
        let pitch_hz = (low.ln() + f64::from(place) * (high / low).ln()).exp() as f32;
        let size = size * draw(0.91, 1.09) * (0.98 + 0.04 * place);
        let traits = TalkerTraits {
            pitch_hz,
            liveliness: draw(0.12, 0.3),
            formants: [
                size * draw(0.9, 1.1),
                size * draw(0.91, 1.09),
                size * draw(0.9, 1.1),
                size,
            ],
            fourth: draw(0.9, 1.1),
            width: draw(0.7, 1.5),
            open_share: draw(0.5, 0.75),
            closure: draw(0.006, 0.03),
            breath: draw(0.0, 0.35),
            friction: draw(0.6, 1.5),
            darkness: draw(0.1, 0.6),
            brightness: draw(0.8, 3.2),
            jitter: draw(0.004, 0.012),
            shimmer: draw(0.02, 0.06),
            tempo: draw(0.88, 1.15),
        };
        Self { seed, traits }
    }

    /// The usual pitch, hertz.
    pub fn pitch_hz(&self) -> f64 {
        f64::from(self.traits.pitch_hz)
    }

    /// What this person says in these turns. Other people's turns are left out, so that a whole conversation may be
    /// given. What is said depends on the seed and on when the turn begins, not on the other turns.
    ///
    /// # Errors
    /// [`AcousticsError::Setting`] where a turn is not a span of up to an hour, or the rate is not within 8000 and
    /// 192000 Hz.
    pub fn speak(&self, turns: &[Turn], person: usize, rate_hz: u32) -> Result<Speech, AcousticsError> {
        let own = spans_of(turns, person, rate_hz)?;
        let stretches = own
            .par_iter()
            .map(|[start_s, end_s]| {
                let first = (start_s * f64::from(rate_hz)).round() as i64;
                let seed = derive(self.seed, "turn", (start_s * 1e3).round() as u64);
                (first, self.utter(end_s - start_s, rate_hz, seed))
            })
            .collect();
        Ok(Speech::new(rate_hz, stretches))
    }

    /// Speech of a length.
    fn utter(&self, length_s: f64, rate_hz: u32, seed: u64) -> Utterance {
        let mut random = generator(seed, "words", 0);
        let whole = (length_s / f64::from(CONTROL_S)) as usize;
        let mut score = Score::default();
        while score.len() < whole {
            let left_s = (whole - score.len()) as f32 * CONTROL_S;
            // Phrases of 0.7 to 2.2 s; what would be left over is spoken in one go.
            let mut phrase_s = between(&mut random, 0.7, 2.2) as f32;
            let mut pause_s = between(&mut random, 0.15, 0.5) as f32;
            if left_s < phrase_s + pause_s + 0.4 {
                (phrase_s, pause_s) = (left_s, 0.0);
            }
            self.phrase(phrase_s, pause_s == 0.0, &mut score, &mut random);
            if pause_s > 0.0 {
                self.rest(pause_s, &mut score);
            }
        }
        score.pitch_hz.resize(score.len(), self.traits.pitch_hz);
        score.articulate();
        let mut samples = sing(&score, &self.traits, rate_hz, seed);
        samples.truncate((length_s * f64::from(rate_hz)) as usize);
        fade(&mut samples, rate_hz);
        normalize(&mut samples, rate_hz);
        Utterance {
            samples,
            mouth: score.mouth(),
        }
    }

    /// Words that fill a time, with the melody of a sentence.
    fn phrase(&self, length_s: f32, last: bool, score: &mut Score, random: &mut Generator) {
        let begin = score.len();
        let mut syllables: Vec<(Vec<Phone>, f32)> = Vec::new();
        let mut total_s = 0.0;
        let mut in_word = 0;
        // Each syllable takes its phones' time; the last ones of a phrase are drawn out.
        while total_s < length_s * self.traits.tempo - 0.12 {
            if in_word == 0 {
                in_word = 1 + (between(random, 0.0, 1.0).powi(2) * 3.5) as usize;
                if !syllables.is_empty() && between(random, 0.0, 1.0) < 0.55 {
                    let gap_s = between(random, 0.03, 0.1) as f32;
                    syllables.push((
                        vec![Phone {
                            length_s: gap_s,
                            ..REST
                        }],
                        1.0,
                    ));
                    total_s += gap_s;
                }
            }
            in_word -= 1;
            let mut phones = Vec::new();
            syllable(random, &mut phones);
            let stretch = between(random, 0.75, 1.25) as f32;
            total_s += phones.iter().map(|phone| phone.length_s * stretch).sum::<f32>();
            syllables.push((phones, stretch));
        }
        let tail_s = 0.08_f32.min(0.2 * length_s);
        let fit = (length_s - tail_s) / total_s.max(0.05);
        let mut accents = Vec::new();
        for (phones, stretch) in &syllables {
            if phones.len() > 1 && between(random, 0.0, 1.0) < 0.45 {
                accents.push((score.len() - begin, between(random, 0.4, 1.0) as f32));
            }
            for phone in phones {
                score.push(phone, phone.length_s * stretch * fit);
            }
        }
        self.rest(tail_s, score);
        // Falls by a third of an octave over the phrase; at its end down, or up as a question does.
        let count = score.len() - begin;
        let rises = !last && between(random, 0.0, 1.0) < 0.4 || last && between(random, 0.0, 1.0) < 0.2;
        let lift = 0.04 * normal(random) as f32;
        score.pitch_hz.resize(begin, self.traits.pitch_hz);
        for at in 0..count {
            let part = at as f32 / count as f32;
            let mut octaves = 0.13 - 0.26 * part + lift;
            for (middle, strength) in &accents {
                let away = (at as f32 - *middle as f32 - 20.0) / 24.0;
                octaves += self.traits.liveliness * strength * (-away * away).exp();
            }
            let end = ((part - 0.8) / 0.2).max(0.0);
            octaves += if rises { 0.3 } else { -0.15 } * end * end;
            score.pitch_hz.push(self.traits.pitch_hz * octaves.exp2());
        }
    }

    fn rest(&self, length_s: f32, score: &mut Score) {
        score.push(&REST, length_s);
        score.pitch_hz.resize(score.len(), self.traits.pitch_hz);
    }
}

/// Longest turn, seconds.
const LONGEST_S: f64 = 3600.0;

/// The spans of one person, checked.
pub(crate) fn spans_of(turns: &[Turn], person: usize, rate_hz: u32) -> Result<Vec<[f64; 2]>, AcousticsError> {
    check(
        (8000..=192_000).contains(&rate_hz),
        "the rate of speech",
        "within 8000 and 192000 Hz",
        f64::from(rate_hz),
    )?;
    let own = turns.iter().enumerate().filter(|(_, turn)| turn.person == person);
    own.map(|(number, turn)| {
        let length_s = turn.end_s - turn.start_s;
        let fits = (0.0..=LONGEST_S).contains(&length_s) && (0.0..1e9).contains(&turn.start_s);
        check(
            fits,
            format!("the length of turn {number}"),
            "above 0 and up to 3600 s, from 0 s on",
            length_s,
        )?;
        Ok([turn.start_s, turn.end_s])
    })
    .collect()
}

/// Lets samples begin and end without a step: 5 ms.
pub(crate) fn fade(samples: &mut [f32], rate_hz: u32) {
    let count = (rate_hz as usize / 200).min(samples.len() / 2);
    let last = samples.len();
    for n in 0..count {
        let gain = (n as f32 + 0.5) / count as f32;
        samples[n] *= gain;
        samples[last - 1 - n] *= gain;
    }
}

#[cfg(test)]
mod tests;
