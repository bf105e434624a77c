//! Who speaks, over time: hysteresis over the associations of single frames.
//!
//! A hidden Markov model whose states are the faces and "nobody"; where frames are asked how well they fit each face,
//! nobody is silence or a sound from elsewhere, which explains any frame with a voice as well as the best place of the room,
//! less by how seldom it is. A frame whose sound survives with a face speaks for that
//! face, the more the better both fit; one whose sound survives with none, or that has no sound, speaks for nobody. The
//! last who spoke is kept.

use hearsight_core::Span;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the speaker is decided.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ActivitySettings {
    /// Mean time for which somebody speaks, or nobody, seconds. Default 0.4. Raising it switches later and more rarely.
    pub turn_s: f64,
    /// Time over which frames count once for where a sound is, since they overlap and err together, seconds. Default 0.1.
    pub independent_s: f64,
    /// The same for whether there is voice. Default 0.04, the part of a frame that this is asked of.
    pub voice_independent_s: f64,
    /// Logarithm of the likelihood ratio, a face over nobody, of a perfect fit, above 0. Default 1.5.
    pub fit: f64,
    /// The same where both are as far apart as is allowed. Default -0.5.
    pub edge: f64,
    /// The same of a face with which the sound does not survive. Default -1.5.
    pub apart: f64,
    /// The same of every face in a frame without sound. Default -1.5.
    pub silence: f64,
    /// Probability that a face must reach to be called the speaker, 0 to 1. Default 0.5.
    pub least: f64,
}

impl Default for ActivitySettings {
    fn default() -> Self {
        Self {
            turn_s: 0.4,
            independent_s: 0.1,
            voice_independent_s: 0.04,
            fit: 1.5,
            edge: -0.5,
            apart: -1.5,
            silence: -1.5,
            least: 0.5,
        }
    }
}

/// What a frame says of the sound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Heard<'a> {
    /// Nothing sounds.
    Silence,
    /// Something sounds: for each face that survives its identity and strain, 0 to 1.
    Sound(&'a [(u64, f64)]),
    /// The frame itself: the log-likelihood ratio of voice and none, and for each face by how much its log-likelihood is
    /// below that of the best place in the room, 0 or less.
    Frame(f64, &'a [(u64, f64)]),
}

/// Probabilities of speaking, saved from frame to frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Activity {
    nobody: f64,
    /// Of that, that something sounds which is no face's.
    elsewhere: f64,
    faces: Vec<(u64, f64)>,
    last: Option<u64>,
}

impl Default for Activity {
    fn default() -> Self {
        Self {
            nobody: 1.0,
            elsewhere: 0.0,
            faces: Vec::new(),
            last: None,
        }
    }
}

impl Activity {
    /// Whether these are probabilities.
    pub fn is_sound(&self) -> bool {
        let share = |value: f64| (0.0..=1.0 + 1e-6).contains(&value);
        share(self.nobody)
            && (0.0..=self.nobody + 1e-6).contains(&self.elsewhere)
            && self.faces.iter().all(|(_, probability)| share(*probability))
    }

    /// The probability that none of the faces speaks.
    pub fn nobody(&self) -> f64 {
        self.nobody
    }

    /// The probability that a face speaks, 0 where it is unknown.
    pub fn probability_of(&self, identity: u64) -> f64 {
        self.faces
            .iter()
            .find(|(known, _)| *known == identity)
            .map_or(0.0, |(_, probability)| *probability)
    }

    /// The face that speaks, if any does.
    pub fn speaking(&self, settings: &ActivitySettings) -> Option<u64> {
        let best = self.faces.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        (best.1 >= settings.least && best.1 > self.nobody).then_some(best.0)
    }

    /// Who spoke last, whether or not they still do; none before anybody did.
    pub fn last(&self) -> Option<u64> {
        self.last
    }

    /// Follows the faces that are there now: new ones do not speak yet, and those that left take their share to nobody.
    pub fn follow(&mut self, faces: impl Iterator<Item = u64> + Clone) {
        self.faces
            .retain(|(known, _)| faces.clone().any(|face| face == *known));
        for face in faces {
            if !self.faces.iter().any(|(known, _)| *known == face) {
                self.faces.push((face, 0.0));
            }
        }
        self.faces.sort_unstable_by_key(|(identity, _)| *identity);
        let kept: f64 = self.faces.iter().map(|(_, probability)| probability).sum();
        self.nobody = (1.0 - kept).max(0.0);
        self.elsewhere = self.elsewhere.min(self.nobody);
    }

    /// Takes in a frame, `elapsed` after the one before.
    pub fn hear(&mut self, heard: Heard<'_>, elapsed: Span, settings: &ActivitySettings) {
        let seconds = elapsed.seconds().max(0.0);
        let stay = (-seconds / settings.turn_s.max(1e-3)).exp();
        let share = |independent_s: f64| (seconds / independent_s.max(1e-3)).min(1.0);
        let (share, of_voice) = (share(settings.independent_s), share(settings.voice_independent_s));
        // That something sounds elsewhere is told apart only where the frame itself is asked.
        let rival = match heard {
            Heard::Frame(voice, _) => Some(of_voice * voice - share * settings.fit),
            Heard::Silence | Heard::Sound(_) => None,
        };
        let states = self.faces.len() + 1 + usize::from(rival.is_some());
        let moves = |probability: f64| stay * probability + (1.0 - stay) / states as f64;
        let (mut silent, mut elsewhere) = match rival {
            Some(ratio) => (
                moves(self.nobody - self.elsewhere),
                moves(self.elsewhere) * ratio.exp(),
            ),
            None => (moves(self.nobody), 0.0),
        };
        for (identity, probability) in &mut self.faces {
            let ratio = match heard {
                Heard::Silence => share * settings.silence,
                Heard::Frame(voice, fits) => {
                    let found = fits.iter().find(|(face, _)| face == identity);
                    let least = settings.apart - settings.fit;
                    of_voice * voice + share * found.map_or(least, |(_, below)| below.max(least))
                }
                Heard::Sound(matches) => {
                    let found = matches.iter().find(|(face, _)| face == identity);
                    share
                        * found.map_or(settings.apart, |(_, strain)| {
                            settings.fit + (settings.edge - settings.fit) * strain.clamp(0.0, 1.0)
                        })
                }
            };
            *probability = moves(*probability) * ratio.exp();
        }
        let sum = silent + elsewhere + self.faces.iter().map(|(_, probability)| probability).sum::<f64>();
        if sum > 0.0 && sum.is_finite() {
            silent /= sum;
            elsewhere /= sum;
            self.faces
                .iter_mut()
                .for_each(|(_, probability)| *probability /= sum);
        } else {
            (silent, elsewhere) = (1.0, 0.0);
            self.faces
                .iter_mut()
                .for_each(|(_, probability)| *probability = 0.0);
        }
        (self.nobody, self.elsewhere) = (silent + elsewhere, elsewhere);
        self.last = self.speaking(settings).or(self.last);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOP: Span = Span::from_nanoseconds(50_000_000);

    fn hear(activity: &mut Activity, heard: Heard<'_>, frames: usize) {
        for _ in 0..frames {
            activity.follow([1, 2].into_iter());
            activity.hear(heard, HOP, &ActivitySettings::default());
        }
    }

    #[test]
    fn turns_are_taken_and_the_last_speaker_is_kept() {
        let settings = ActivitySettings::default();
        let mut activity = Activity::default();
        assert_eq!((activity.speaking(&settings), activity.last()), (None, None));
        hear(&mut activity, Heard::Sound(&[(1, 0.1)]), 8);
        assert_eq!(activity.speaking(&settings), Some(1));
        // One frame of somebody else's is not yet a turn.
        hear(&mut activity, Heard::Sound(&[(2, 0.1)]), 1);
        assert_eq!(activity.speaking(&settings), Some(1));
        hear(&mut activity, Heard::Sound(&[(2, 0.1)]), 6);
        assert_eq!(activity.speaking(&settings), Some(2));
        hear(&mut activity, Heard::Silence, 12);
        assert_eq!(activity.speaking(&settings), None);
        assert_eq!(activity.last(), Some(2));
        assert!(activity.nobody() > 0.8);
    }

    #[test]
    fn a_sound_that_survives_with_nobody_is_nobodys() {
        let settings = ActivitySettings::default();
        let mut activity = Activity::default();
        hear(&mut activity, Heard::Sound(&[(1, 0.0)]), 8);
        hear(&mut activity, Heard::Sound(&[]), 8);
        assert_eq!(activity.speaking(&settings), None);
        let sum = activity.nobody() + activity.probability_of(1) + activity.probability_of(2);
        assert!((sum - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_voice_is_nobodys_where_the_frame_fits_no_face_and_a_faces_where_it_does() {
        let settings = ActivitySettings::default();
        let (at_second, elsewhere) = ([(1, -6.0), (2, -0.3)], [(1, -6.0), (2, -5.0)]);
        let mut activity = Activity::default();
        hear(&mut activity, Heard::Frame(3.0, &at_second), 3);
        assert_eq!(activity.speaking(&settings), Some(2));
        hear(&mut activity, Heard::Frame(3.0, &elsewhere), 12);
        assert!(
            activity.elsewhere > 0.6 && activity.speaking(&settings).is_none(),
            "{activity:?}"
        );
        // Without a voice it does not matter whom the frame fits.
        hear(&mut activity, Heard::Frame(-3.0, &at_second), 4);
        assert!(
            activity.nobody() > 0.95 && activity.elsewhere < 0.05,
            "{activity:?}"
        );
        hear(&mut activity, Heard::Frame(3.0, &at_second), 3);
        assert_eq!(activity.speaking(&settings), Some(2));
        assert!(activity.is_sound());
    }

    #[test]
    fn whoever_leaves_speaks_no_more() {
        let mut activity = Activity::default();
        hear(&mut activity, Heard::Sound(&[(1, 0.0)]), 8);
        activity.follow([2].into_iter());
        assert_eq!(activity.probability_of(1), 0.0);
        assert!(activity.nobody() > 0.5);
    }
}
