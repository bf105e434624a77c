//! Beliefs: what is remembered of one person. All of it is saved state; scratch memory lives in the tracker.

use crate::body::Part;
use crate::closed_loop::LoopState;
use crate::life_cycle::Encounter;
use crate::percepts::beside;
use hearsight_core::{Instant, Rectangle, Span};
use hearsight_filter::{Generator, Particles};
use hearsight_vision::histogram::Histogram;
use serde::{Deserialize, Serialize};

/// What is remembered of one person.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Belief {
    /// Number of the belief in its tracker, from 0; never given twice.
    pub number: u64,
    /// Published identity; none while the belief is a scout.
    pub identity: Option<u64>,
    /// Possible states.
    pub particles: Particles,
    /// Its own generator, so that no other belief changes its numbers.
    pub generator: Generator,
    /// Colours of its parts as they are now.
    pub appearance: Appearance,
    /// Colours of its parts in the mean over its life, by which it is known again.
    pub portrait: Portrait,
    /// Whether there is a person at all.
    pub existence: Existence,
    /// Whether the person is hidden behind another.
    pub occluded: bool,
    /// Suspicion that it is a part of another's body: seconds for which it looked so, less those for which it did not.
    pub body_part_s: f64,
    /// Seconds for which it has stood at the place of another, less those for which it has not.
    pub merged_s: f64,
    /// A meeting with another belief that has not been settled.
    pub encounter: Option<Encounter>,
    /// When it was last looked at, if it has a new identity that may yet turn out to be that of somebody known.
    pub unknown_since: Option<Instant>,
    /// How often it has been looked at since the first time.
    pub looks: u32,
    /// When the belief began.
    pub born: Instant,
    /// Height of its head when it began, pixels.
    pub born_height_px: f32,
    /// When a detection last supported it.
    pub supported: Instant,
    /// For how long detections have supported it in all.
    pub support: Span,
    /// Whether a face was ever among those detections.
    pub face_seen: bool,
    /// Share of its body that changed from picture to picture, summed over the time of support, seconds.
    pub stirred_s: f64,
    /// Weighted mean of the particles, as a head box in the picture.
    pub head: Rectangle,
    /// Columns of a full turn, where the picture goes all round; 0 elsewhere.
    pub turn_px: f32,
    /// How the head's centre moves (x, y), pixels a second.
    pub velocity_px_s: [f32; 2],
    /// Standard deviation of the head's centre (x, y), pixels.
    pub deviation: [f32; 2],
    /// Effective number of particles before the last resampling.
    pub effective_sample_size: f64,
    /// Probability of speaking, 0 to 1.
    pub speaking: f64,
    /// What the trackers of a closed loop remember, where a system has them.
    pub trackers: Option<LoopState>,
}

impl Belief {
    /// The head as near to another as whole turns bring it.
    pub(crate) fn head_beside(&self, other: &Rectangle) -> Rectangle {
        beside(&self.head, other, self.turn_px)
    }
}

/// Colour histograms of the parts of one person, each learnt when it was first seen well.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Appearance {
    parts: [Histogram; Part::ALL.len()],
}

/// The mean appearance over a life.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Portrait {
    mean: Appearance,
    seen: [u32; Part::ALL.len()],
}

/// The probability that a person exists, as a logarithm of odds that evidence adds to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Existence {
    log_odds: f64,
}

impl Existence {
    /// Odds beyond this are not counted, so that a lost person is given up within a bounded time.
    pub(crate) const BOUND: f64 = 4.0;

    /// A probability of one half.
    pub fn even() -> Self {
        Self { log_odds: 0.0 }
    }

    /// Adds evidence: a logarithm of a likelihood ratio, existing over not.
    pub fn add(&mut self, log_ratio: f64) {
        if log_ratio.is_finite() {
            self.log_odds = (self.log_odds + log_ratio).clamp(-Self::BOUND, Self::BOUND);
        }
    }

    /// The logarithm of its odds.
    pub(crate) fn log_odds(self) -> f64 {
        self.log_odds
    }

    /// The probability, 0 to 1.
    pub fn probability(self) -> f64 {
        1.0 / (1.0 + (-self.log_odds).exp())
    }
}

impl Portrait {
    /// Adds one sight of a part.
    pub fn add(&mut self, part: Part, histogram: &Histogram) {
        let seen = &mut self.seen[part.index()];
        *seen = seen.saturating_add(1);
        self.mean.learn(part, histogram, 1.0 / *seen as f32);
    }

    /// How often a part was seen.
    pub fn sights(&self, part: Part) -> u32 {
        self.seen[part.index()]
    }

    /// The mean of all sights.
    pub fn mean(&self) -> &Appearance {
        &self.mean
    }

    /// Goes on from an older portrait of the same person.
    pub fn join(&mut self, older: &Self) {
        for part in Part::ALL {
            let (new, old) = (self.seen[part.index()], older.seen[part.index()]);
            if let Some(histogram) = older.mean.part(part) {
                let share = f64::from(old) / (f64::from(old) + f64::from(new)).max(1.0);
                self.mean.learn(part, histogram, share as f32);
                self.seen[part.index()] = new.saturating_add(old);
            }
        }
    }
}

impl Appearance {
    /// The histogram of a part, where it has been seen.
    pub fn part(&self, part: Part) -> Option<&Histogram> {
        Some(&self.parts[part.index()]).filter(|histogram| !histogram.is_zero())
    }

    /// Takes a share `rate` (0 to 1) of a new histogram; the first one is taken whole.
    pub fn learn(&mut self, part: Part, histogram: &Histogram, rate: f32) {
        self.parts[part.index()].blend(histogram, rate);
    }

    /// Replaces a part by what was seen, or by nothing.
    pub fn set(&mut self, part: Part, histogram: Option<&Histogram>) {
        match histogram {
            Some(histogram) => self.parts[part.index()].clone_from(histogram),
            None => self.parts[part.index()].clear(),
        }
    }

    /// Bhattacharyya distance to another appearance over the parts that both know, the torso counting `torso` (0 to
    /// 1) against the head; `None` where no part is known to both.
    pub fn distance(&self, other: &Self, torso: f32) -> Option<f32> {
        let mut sum = 0.0;
        let mut weights = 0.0;
        for part in Part::ALL {
            if let (Some(a), Some(b)) = (self.part(part), other.part(part)) {
                let weight = if part == Part::Torso { torso } else { 1.0 - torso };
                sum += weight * a.distance(b);
                weights += weight;
            }
        }
        (weights > 0.0).then(|| sum / weights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn existence_is_bounded_and_ignores_what_is_not_a_number() {
        let mut existence = Existence::even();
        existence.add(f64::NAN);
        assert_eq!(existence.probability(), 0.5);
        existence.add(1e9);
        let sure = existence.probability();
        assert!(sure > 0.95 && sure < 1.0);
        existence.add(-2.0 * Existence::BOUND);
        assert!(existence.probability() < 0.05);
    }

    #[test]
    fn appearance_moves_towards_what_is_seen() {
        let mut appearance = Appearance::default();
        assert!(appearance.part(Part::Head).is_none());
        let of = |values: [f32; 2]| Histogram::new(values.to_vec()).unwrap();
        appearance.learn(Part::Head, &of([1.0, 0.0]), 0.1);
        appearance.learn(Part::Head, &of([0.0, 1.0]), 0.25);
        assert_eq!(appearance.part(Part::Head), Some(&of([0.75, 0.25])));
        let mut other = Appearance::default();
        assert_eq!(appearance.distance(&other, 0.5), None);
        other.learn(Part::Head, &of([0.75, 0.25]), 1.0);
        assert!(appearance.distance(&other, 0.5).is_some_and(|d| d < 1e-3));
    }
}
