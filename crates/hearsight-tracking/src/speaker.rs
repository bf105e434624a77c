//! Who speaks: one decision over everyone believed in, whoever is not seen, and silence.
//!
//! A hidden Markov model whose forward probabilities are the saved state. Its states are the people (tracks and scouts), an
//! unseen talker at each delay that the microphones allow, and silence. Sound is explained by each of them through the
//! likelihood of their delay ([`DirectionPercept`]); an unseen talker stays an explanation where sound goes on from where
//! nobody is seen, so that a person who stands there silent is not taken for the talker. Somebody who comes into the
//! picture where an unseen talker is heard takes over from them.

use crate::percepts::DirectionPercept;
use hearsight_core::Span;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the speaker is decided.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SpeakerSettings {
    /// Standard deviation of the delay of a mouth for all that is not in the spread of its track, seconds. Default
    /// 6.0e-5: 2 cm of path, from calibration, the size of heads and the width of a peak. Raising it forgives bad
    /// calibration and confuses neighbours.
    pub tolerance_s: f64,
    /// The same of the azimuth where a whole array is listened to, radians. Default 0.07: four degrees.
    pub tolerance_rad: f64,
    /// How far the mouth may be beside the middle of the head, as a share of the head's width. Default 0.2: the mouth
    /// of a head that is turned aside is near the edge of its box. Raising it forgives turned heads and confuses
    /// neighbours.
    pub mouth_aside: f64,
    /// Mean time for which a head stays turned as it is, seconds. Default 1.
    pub turned_s: f64,
    /// Mean time for which somebody speaks before another does or all are silent, seconds. Default 2. Lowering it
    /// switches sooner and more often wrongly.
    pub turn_s: f64,
    /// Mean time of silence before somebody speaks, seconds. Default 0.6.
    pub pause_s: f64,
    /// How fast silence speaks against everybody, and sound against silence: change of the logarithm of odds a second.
    /// Default 12: pauses within a turn last a fifth of a second, and longer than a third seldom.
    pub silence: f64,
    /// Probability, against that of one person in the picture, that whoever begins to speak is not seen. Default 0.5.
    pub unseen: f64,
    /// How far an unseen talker's delay wanders in a second, as a share of the greatest delay. Default 0.05: a walk at
    /// some metres.
    pub wander: f64,
    /// Time after which a talker heard where somebody is seen is taken for that person, seconds. Default 0.05.
    pub claim_s: f64,
    /// Probability, that somebody in the picture speaks, from which the likeliest of them is called the speaker, 0 to
    /// 1. Default 0.5.
    pub least: f64,
}

impl Default for SpeakerSettings {
    fn default() -> Self {
        Self {
            tolerance_s: 6.0e-5,
            tolerance_rad: 0.07,
            mouth_aside: 0.2,
            turned_s: 1.0,
            turn_s: 2.0,
            pause_s: 0.6,
            silence: 12.0,
            unseen: 0.5,
            wander: 0.05,
            claim_s: 0.05,
            least: 0.5,
        }
    }
}

/// A person as the decision sees them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Voice {
    /// Number of the belief.
    pub number: u64,
    /// Probability that there is a person at all, 0 to 1.
    pub existence: f64,
    /// Whether it is a scout, which may be a part of somebody else: it is not thought of as beginning a turn, and
    /// speaks only where an unseen talker was heard before.
    pub scout: bool,
    /// Delay of the mouth, seconds, where known; its azimuth, radians, where a whole array is listened to, as are all
    /// delays of this module then.
    pub delay_s: Option<f64>,
    /// Standard deviation of that delay by the spread of the belief, seconds.
    pub deviation_s: f64,
    /// By how much that delay is longer where the head is turned to its right in the picture as far as it goes, seconds.
    pub aside_s: f64,
}

/// How far the mouth is beside the middle of the head, as shares of the farthest: the delay of a voice tells how a head
/// is turned, and goes on telling it while the voice lasts.
const ASIDE: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];

/// How likely each of them is before anything is heard: most people who speak look somewhere near the camera, or past it.
const FACING: [f64; 5] = [0.1, 0.2, 0.4, 0.2, 0.1];

/// Probabilities of speaking, saved from step to step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Speaker {
    silence: f64,
    /// An unseen talker at each delay of the correlation's curve; empty before any sound.
    unseen: Vec<f64>,
    /// Seconds from one delay to the next.
    step_s: f64,
    /// Whether the curve goes once all round: over azimuths.
    circular: bool,
    people: Vec<Person>,
    listened: bool,
}

/// The places of the curve.
#[derive(Clone, Copy)]
struct Places {
    count: usize,
    step_s: f64,
    circular: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Person {
    number: u64,
    /// That this person speaks, with the mouth at each place of [`ASIDE`].
    speaks: [f64; ASIDE.len()],
    existence: f64,
    scout: bool,
    delay_s: Option<f64>,
    deviation_s: f64,
    aside_s: f64,
}

/// Who of the tracks speaks, given each identity and its probability: the likeliest one, where it is likely that one of
/// them does.
pub fn decide(tracks: impl Iterator<Item = (u64, f64)>, settings: &SpeakerSettings) -> Option<u64> {
    let mut sum = 0.0;
    let mut best: Option<(u64, f64)> = None;
    for (identity, probability) in tracks {
        sum += probability;
        if best.is_none_or(|(_, highest)| probability > highest) {
            best = Some((identity, probability));
        }
    }
    best.filter(|(_, probability)| sum >= settings.least && *probability > 0.0)
        .map(|(identity, _)| identity)
}

impl Default for Speaker {
    fn default() -> Self {
        Self {
            silence: 1.0,
            unseen: Vec::new(),
            step_s: 0.0,
            circular: false,
            people: Vec::new(),
            listened: false,
        }
    }
}

impl Speaker {
    /// Whether it has listened to any moment yet.
    pub fn has_listened(&self) -> bool {
        self.listened
    }

    /// The probability that a belief speaks, 0 where it is unknown.
    pub fn probability_of(&self, number: u64) -> f64 {
        self.people
            .iter()
            .find(|person| person.number == number)
            .map_or(0.0, Person::probability)
    }

    /// The probability that an unseen talker is at a delay, within its tolerance, 0 to 1.
    pub fn unseen_near(&self, delay_s: f64, settings: &SpeakerSettings) -> f64 {
        let reach_s = 3.0 * self.tolerance(settings);
        let turn_s = self.step_s * self.unseen.len() as f64;
        let places = self.unseen.iter().enumerate();
        places
            .filter(|(index, _)| {
                let apart_s = (self.delay_of(*index) - delay_s).abs();
                apart_s <= reach_s || (self.circular && turn_s - apart_s <= reach_s)
            })
            .map(|(_, probability)| probability)
            .sum()
    }

    /// Where the talker is heard who is likeliest, seen or not, seconds.
    pub fn delay_s(&self) -> Option<f64> {
        let unseen: f64 = self.unseen.iter().sum();
        let person = self
            .people
            .iter()
            .max_by(|a, b| a.probability().total_cmp(&b.probability()))
            .filter(|person| person.probability() >= unseen && person.probability() > 0.0);
        if let Some(delay_s) = person.and_then(|person| person.delay_s) {
            return Some(delay_s);
        }
        let (index, _) = self
            .unseen
            .iter()
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(b.1))
            .filter(|_| unseen > 0.0)?;
        Some(self.delay_of(index))
    }

    /// Takes in what the array heard since the last call, over the people who are believed in now.
    pub fn listen(
        &mut self,
        voices: &[Voice],
        direction: &DirectionPercept,
        elapsed: Span,
        settings: &SpeakerSettings,
    ) {
        let curve = direction.log_ratio();
        let [sound_s, silence_s] = [direction.sound_s(), direction.silence_s()];
        self.circular = direction.is_circular();
        self.take(
            voices,
            &curve.values,
            curve.step_s,
            [sound_s, silence_s],
            elapsed.seconds().max(0.0),
            settings,
        );
    }

    /// One step, over `log_ratio` for each delay, seconds of sound and of silence in the moment, and seconds elapsed.
    fn take(
        &mut self,
        voices: &[Voice],
        log_ratio: &[f32],
        step_s: f64,
        [sound_s, silence_s]: [f64; 2],
        elapsed_s: f64,
        settings: &SpeakerSettings,
    ) {
        if self.unseen.len() != log_ratio.len() {
            // The first sound, or another array than before: whoever was unseen has no known place any more.
            self.silence += self.unseen.iter().sum::<f64>();
            self.unseen.clear();
            self.unseen.resize(log_ratio.len(), 0.0);
        }
        self.step_s = step_s.max(1e-9);
        self.meet(voices, settings);
        self.change(elapsed_s, settings);
        self.wander(elapsed_s, settings);
        self.claim(elapsed_s, settings);
        if sound_s > 0.0 {
            self.explain(log_ratio, sound_s, settings);
        }
        self.be_silent(silence_s, settings);
        self.normalize();
        self.listened = true;
    }

    fn places(&self) -> Places {
        Places {
            count: self.unseen.len(),
            step_s: self.step_s,
            circular: self.circular,
        }
    }

    fn tolerance(&self, settings: &SpeakerSettings) -> f64 {
        if self.circular {
            settings.tolerance_rad
        } else {
            settings.tolerance_s
        }
    }

    fn delay_of(&self, index: usize) -> f64 {
        (index as f64 - (self.unseen.len() / 2) as f64) * self.step_s
    }

    /// Takes in who is there now. Whoever left goes on speaking unseen.
    fn meet(&mut self, voices: &[Voice], settings: &SpeakerSettings) {
        let mut place = 0;
        while let Some(person) = self.people.get(place).copied() {
            if voices.iter().any(|voice| voice.number == person.number) {
                place += 1;
                continue;
            }
            self.people.remove(place);
            let (places, tolerance) = (self.places(), self.tolerance(settings));
            for (aside, probability) in person.speaks.into_iter().enumerate() {
                let near = || person.near(aside, places, tolerance);
                let sum: f64 = near().map(|(_, weight)| weight).sum();
                if sum > 0.0 {
                    for (index, weight) in near() {
                        self.unseen[index] += probability * weight / sum;
                    }
                } else {
                    self.silence += probability;
                }
            }
        }
        for voice in voices {
            let before = self
                .people
                .iter_mut()
                .find(|person| person.number == voice.number);
            let now = Person {
                number: voice.number,
                speaks: before.as_ref().map_or([0.0; ASIDE.len()], |person| person.speaks),
                existence: voice.existence.clamp(0.0, 1.0),
                scout: voice.scout,
                delay_s: voice.delay_s,
                deviation_s: voice.deviation_s,
                aside_s: voice.aside_s,
            };
            match before {
                Some(person) => *person = now,
                None => self.people.push(now),
            }
        }
    }

    /// Turns end and begin: half of those that end are followed at once by another, half by silence.
    fn change(&mut self, elapsed_s: f64, settings: &SpeakerSettings) {
        let ended = 1.0 - (-elapsed_s / settings.turn_s.max(1e-3)).exp();
        let broken = 1.0 - (-elapsed_s / settings.pause_s.max(1e-3)).exp();
        let talking =
            self.people.iter().map(Person::probability).sum::<f64>() + self.unseen.iter().sum::<f64>();
        let beginning = 0.5 * ended * talking + broken * self.silence;
        // Before any sound there is no curve, and nobody unseen.
        let unseen = if self.unseen.is_empty() {
            0.0
        } else {
            settings.unseen.max(0.0)
        };
        let weights = unseen + self.people.iter().map(Person::begins).sum::<f64>();
        let share = if weights > 0.0 { beginning / weights } else { 0.0 };
        let turned = 1.0 - (-elapsed_s / settings.turned_s.max(1e-3)).exp();
        for person in &mut self.people {
            let anew = turned * (1.0 - ended) * person.probability() + share * person.begins();
            for (speaks, facing) in person.speaks.iter_mut().zip(FACING) {
                *speaks = (1.0 - turned) * (1.0 - ended) * *speaks + anew * facing;
            }
        }
        let each = share * unseen / self.unseen.len().max(1) as f64;
        for probability in &mut self.unseen {
            *probability = (1.0 - ended) * *probability + each;
        }
        self.silence = (1.0 - broken) * self.silence + 0.5 * ended * talking;
    }

    /// Lets unseen talkers walk: repeated smoothing with three weights, in place.
    fn wander(&mut self, elapsed_s: f64, settings: &SpeakerSettings) {
        if self.unseen.len() < 3 {
            return;
        }
        let half = (self.unseen.len() / 2) as f64;
        let variance = (settings.wander * half).powi(2) * elapsed_s;
        // A quarter to each side adds a variance of a half; what lies beyond 64 passes is spread out anyway.
        let passes = (2.0 * variance).ceil().clamp(0.0, 64.0);
        if passes == 0.0 {
            return;
        }
        let side = (0.5 * variance / passes).min(0.25);
        for _ in 0..passes as usize {
            let (first, last) = (self.unseen[0], self.unseen[self.unseen.len() - 1]);
            let mut before = if self.circular { last } else { first };
            for index in 0..self.unseen.len() {
                let own = self.unseen[index];
                let end = if self.circular { first } else { own };
                let after = self.unseen.get(index + 1).copied().unwrap_or(end);
                self.unseen[index] = own + side * (before - 2.0 * own + after);
                before = own;
            }
        }
    }

    /// Lets people take over from unseen talkers at their own delay.
    fn claim(&mut self, elapsed_s: f64, settings: &SpeakerSettings) {
        let rate = 1.0 - (-elapsed_s / settings.claim_s.max(1e-3)).exp();
        let (places, tolerance) = (self.places(), self.tolerance(settings));
        for person in &mut self.people {
            for aside in 0..ASIDE.len() {
                for (index, weight) in person.near(aside, places, tolerance) {
                    let taken = rate * person.existence * weight * self.unseen[index];
                    self.unseen[index] -= taken;
                    person.speaks[aside] += taken;
                }
            }
        }
    }

    /// Weighs every explanation of the sound of a moment. Without any known delay only its loudness counts.
    fn explain(&mut self, log_ratio: &[f32], sound_s: f64, settings: &SpeakerSettings) {
        self.silence *= (-settings.silence * sound_s).exp();
        if !self.people.is_empty() && self.people.iter().all(|person| person.delay_s.is_none()) {
            return;
        }
        let highest = log_ratio.iter().copied().fold(0.0, f32::max);
        let likelihood = |index: usize| f64::from(log_ratio[index] - highest).exp();
        let count = log_ratio.len();
        let (places, tolerance) = (self.places(), self.tolerance(settings));
        let everywhere = (0..count).map(likelihood).sum::<f64>() / count.max(1) as f64;
        for person in &mut self.people {
            for aside in 0..ASIDE.len() {
                let (mut sum, mut weights) = (0.0, 0.0);
                for (index, weight) in person.near(aside, places, tolerance) {
                    sum += weight * likelihood(index);
                    weights += weight;
                }
                person.speaks[aside] *= if weights > 0.0 { sum / weights } else { everywhere };
            }
        }
        for (index, probability) in self.unseen.iter_mut().enumerate() {
            *probability *= likelihood(index);
        }
        self.silence *= f64::from(-highest).exp();
    }

    fn be_silent(&mut self, silence_s: f64, settings: &SpeakerSettings) {
        let factor = (-settings.silence * silence_s).exp();
        for person in &mut self.people {
            person.scale(factor);
        }
        for probability in &mut self.unseen {
            *probability *= factor;
        }
    }

    /// Whether a saved one holds nothing but probabilities.
    pub(crate) fn is_sound(&self) -> bool {
        // A little more than 1 is rounding.
        let probability = 0.0..=1.0 + 1e-9;
        let person = |person: &Person| {
            person.speaks.iter().all(|speaks| probability.contains(speaks))
                && probability.contains(&person.existence)
                && person.deviation_s >= 0.0
                && person.aside_s.is_finite()
        };
        probability.contains(&self.silence)
            && self.unseen.iter().all(|unseen| probability.contains(unseen))
            && self.people.iter().all(person)
            && self.step_s >= 0.0
    }

    fn normalize(&mut self) {
        let sum = self.silence
            + self.people.iter().map(Person::probability).sum::<f64>()
            + self.unseen.iter().sum::<f64>();
        let valid = sum > 0.0 && sum.is_finite();
        let scale = if valid { sum.recip() } else { 0.0 };
        for person in &mut self.people {
            person.scale(scale);
        }
        for probability in &mut self.unseen {
            *probability *= scale;
        }
        self.silence = if valid { self.silence * scale } else { 1.0 };
        if !valid {
            self.unseen.fill(0.0);
            self.people.iter_mut().for_each(|person| person.speaks.fill(0.0));
        }
    }
}

impl Person {
    /// The probability that this person speaks.
    fn probability(&self) -> f64 {
        self.speaks.iter().sum()
    }

    fn scale(&mut self, factor: f64) {
        self.speaks.iter_mut().for_each(|speaks| *speaks *= factor);
    }

    /// How likely this person is to begin a turn, against a track that surely exists.
    fn begins(&self) -> f64 {
        if self.scout { 0.0 } else { self.existence }
    }

    /// The places of a curve near the person's own with the mouth at a place of [`ASIDE`], each with
    /// its weight: a Gaussian, 1 in the middle.
    fn near(
        &self,
        aside: usize,
        places: Places,
        tolerance: f64,
    ) -> impl Iterator<Item = (usize, f64)> + use<> {
        let Places {
            count,
            step_s,
            circular,
        } = places;
        let deviation = tolerance.hypot(self.deviation_s).max(1e-9) / step_s;
        let last = count.saturating_sub(1) as f64;
        let middle = self
            .delay_s
            .map(|delay_s| (delay_s + ASIDE[aside] * self.aside_s) / step_s + (count / 2) as f64);
        let middle = middle.map(|middle| if circular { middle } else { middle.clamp(0.0, last) });
        let middle =
            middle.filter(|middle| middle.is_finite() && deviation.is_finite() && middle.abs() < 1e9);
        let range = middle.map_or(0..0, |middle| {
            // All round no place comes twice.
            let reach = (3.0 * deviation).min(if circular { 0.5 * last } else { f64::INFINITY });
            let (first, end) = ((middle - reach).floor(), (middle + reach).ceil());
            if circular {
                first as i64..(end as i64).min(first as i64 + count as i64 - 1) + 1
            } else {
                first.max(0.0) as i64..((end.min(count as f64) as i64).saturating_add(1)).min(count as i64)
            }
        });
        let middle = middle.unwrap_or(0.0);
        range.map(move |index| {
            let distance = (index as f64 - middle) / deviation;
            let place = index.rem_euclid(count.max(1) as i64) as usize;
            (place, (-0.5 * distance * distance).exp())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 2.0e-5;
    const HALF: usize = 100;

    fn voice(number: u64, delay_s: f64) -> Voice {
        Voice {
            number,
            existence: 1.0,
            scout: false,
            delay_s: Some(delay_s),
            deviation_s: 0.0,
            aside_s: 0.0,
        }
    }

    /// What is heard in 40 ms: a talker at a delay, or silence.
    struct Heard(Option<f64>);

    fn run(speaker: &mut Speaker, voices: &[Voice], heard: &Heard, ticks: usize) {
        let settings = SpeakerSettings::default();
        let curve: Vec<f32> = (0..=2 * HALF)
            .map(|index| {
                let delay_s = (index as f64 - HALF as f64) * STEP_S;
                heard.0.map_or(0.0, |talker_s| {
                    let distance = (delay_s - talker_s) / 8e-5;
                    (1.2 * (-0.5 * distance * distance).exp() - 0.1) as f32
                })
            })
            .collect();
        for _ in 0..ticks {
            let sound_s = if heard.0.is_some() { 0.04 } else { 0.0 };
            speaker.take(voices, &curve, STEP_S, [sound_s, 0.04 - sound_s], 0.04, &settings);
            let sum = speaker.silence
                + speaker.unseen.iter().sum::<f64>()
                + speaker.people.iter().map(Person::probability).sum::<f64>();
            assert!((sum - 1.0).abs() < 1e-9, "{sum}");
        }
    }

    #[test]
    fn the_one_at_the_delay_of_the_sound_speaks_and_then_the_other() {
        let voices = [voice(3, -0.0008), voice(7, 0.0006)];
        let mut speaker = Speaker::default();
        run(&mut speaker, &voices, &Heard(None), 25);
        assert!(speaker.silence > 0.7, "{}", speaker.silence);
        run(&mut speaker, &voices, &Heard(Some(0.0006)), 6);
        assert!(speaker.probability_of(7) > 0.8, "{speaker:?}");
        run(&mut speaker, &voices, &Heard(Some(-0.0008)), 12);
        assert!(speaker.probability_of(3) > 0.8, "{speaker:?}");
        run(&mut speaker, &voices, &Heard(None), 15);
        assert!(speaker.silence > 0.7);
    }

    #[test]
    fn a_head_that_is_turned_aside_keeps_its_voice_though_nobody_seen_would_explain_it_better() {
        let turned = Voice {
            aside_s: 0.0001,
            ..voice(4, 0.0005)
        };
        let mut speaker = Speaker::default();
        run(
            &mut speaker,
            &[turned, voice(8, -0.0009)],
            &Heard(Some(0.0006)),
            50,
        );
        assert!(speaker.probability_of(4) > 0.9, "{speaker:?}");
        // Whose mouth cannot be there loses it.
        let mut speaker = Speaker::default();
        run(&mut speaker, &[voice(4, 0.0003)], &Heard(Some(0.0006)), 50);
        assert!(speaker.probability_of(4) < 0.1, "{speaker:?}");
    }

    #[test]
    fn somebody_silent_is_not_taken_for_an_unseen_talker() {
        let voices = [voice(1, 0.0002)];
        let mut speaker = Speaker::default();
        run(&mut speaker, &voices, &Heard(Some(-0.0015)), 50);
        assert!(speaker.probability_of(1) < 0.05, "{speaker:?}");
        assert!(
            speaker
                .delay_s()
                .is_some_and(|delay_s| (delay_s + 0.0015).abs() < 1e-4)
        );
    }

    #[test]
    fn a_newcomer_takes_over_from_the_unseen_talker_and_leaves_speaking() {
        let mut speaker = Speaker::default();
        run(&mut speaker, &[], &Heard(Some(0.001)), 25);
        run(&mut speaker, &[voice(5, 0.001)], &Heard(Some(0.001)), 4);
        assert!(speaker.probability_of(5) > 0.5, "{speaker:?}");
        run(&mut speaker, &[], &Heard(None), 1);
        let near: f64 = (HALF + 40..HALF + 60).map(|index| speaker.unseen[index]).sum();
        assert!(near > 0.3, "{near}");
    }

    #[test]
    fn one_person_of_unknown_place_speaks_when_there_is_sound() {
        let unknown = Voice {
            delay_s: None,
            ..voice(2, 0.0)
        };
        let mut speaker = Speaker::default();
        run(&mut speaker, &[unknown], &Heard(Some(0.001)), 20);
        assert!(speaker.probability_of(2) > 0.5, "{speaker:?}");
    }

    #[test]
    fn the_decision_needs_somebody_in_the_picture_to_be_likely() {
        let settings = SpeakerSettings::default();
        let tracks = [(1, 0.3), (2, 0.35)];
        assert_eq!(decide(tracks.into_iter(), &settings), Some(2));
        assert_eq!(decide(tracks.into_iter().take(1), &settings), None);
        assert_eq!(decide(std::iter::empty(), &settings), None);
    }

    #[test]
    fn what_is_not_a_number_does_not_spread() {
        let mut speaker = Speaker::default();
        let broken = Voice {
            delay_s: Some(f64::NAN),
            deviation_s: f64::INFINITY,
            ..voice(4, 0.0)
        };
        run(&mut speaker, &[broken, voice(6, 0.0)], &Heard(Some(0.0)), 10);
        assert!(speaker.probability_of(6).is_finite());
    }
}
