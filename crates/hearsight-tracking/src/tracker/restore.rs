//! Checks of saved states: what the composition could not have left is refused before anything is taken over.

use super::{ViewState, ViewTracker};
use crate::belief::{Appearance, Belief, Existence, Portrait};
use crate::body::Part;
use crate::system::StateError;
use hearsight_filter::uniform;
use std::collections::BTreeSet;

/// Largest number of a belief or an identity in a saved state: far from what integers hold.
pub const MOST_NUMBERED: u64 = 1 << 48;

fn foreign(what: &str) -> StateError {
    StateError::Foreign(what.to_owned())
}

/// An error where something does not hold.
fn check(holds: bool, what: &str) -> Result<(), StateError> {
    if holds { Ok(()) } else { Err(foreign(what)) }
}

impl ViewTracker {
    /// Checks what was remembered: whether this composition could have left it. `bins` are those of a histogram,
    /// `last_identity` is the greatest identity given.
    ///
    /// # Errors
    /// [`StateError::Foreign`] where it could not.
    pub fn check_state(&self, state: &ViewState, bins: usize, last_identity: u64) -> Result<(), StateError> {
        check(state.next_number <= MOST_NUMBERED, "the number of beliefs")?;
        check(state.speaker.is_sound(), "the probabilities of who speaks")?;
        let mut identities = BTreeSet::new();
        let mut least_number = 0;
        for belief in &state.beliefs {
            let numbered = (least_number..state.next_number).contains(&belief.number);
            check(numbered, "the order of beliefs")?;
            least_number = belief.number + 1;
            if let Some(identity) = belief.identity {
                check(
                    identity <= last_identity && identities.insert(identity),
                    "identities of people",
                )?;
            }
            self.check_belief(belief, bins)?;
        }
        for (identity, portrait) in state.memory.everyone() {
            check(
                identity <= last_identity && identities.insert(identity),
                "identities of those who left",
            )?;
            check(is_portrait(portrait, bins), "colours of those who left")?;
        }
        Ok(())
    }

    fn check_belief(&self, belief: &Belief, bins: usize) -> Result<(), StateError> {
        let particles = &belief.particles;
        check(
            particles.count() == self.composition.particles
                && particles.dimensions() == self.composition.body.dimensions(),
            "the number of particles",
        )?;
        let real = particles
            .columns()
            .iter()
            .flatten()
            .all(|value| value.is_finite());
        check(
            real && belief.head.is_finite() && belief.born_height_px.is_finite(),
            "states of particles",
        )?;
        // A generator of zeros alone gives zeros for ever.
        let mut generator = belief.generator.clone();
        check((0..8).any(|_| uniform(&mut generator) > 0.0), "random numbers")?;
        let encounter = belief.encounter.as_ref();
        let coloured = is_appearance(&belief.appearance, bins)
            && is_portrait(&belief.portrait, bins)
            && encounter.is_none_or(|encounter| is_portrait(&encounter.since, bins));
        check(coloured, "colours of people")?;
        // A little more than 1 is rounding.
        let share = 0.0..=1.0 + 1e-9;
        let counted = belief.existence.is_bounded()
            && share.contains(&belief.speaking)
            && belief.deviation.iter().all(|deviation| *deviation >= 0.0)
            && belief.effective_sample_size >= 0.0
            && encounter.is_none_or(|encounter| encounter.apart_s >= 0.0)
            && [
                belief.body_part_s,
                belief.merged_s,
                belief.stirred_s,
                belief.support.seconds(),
            ]
            .iter()
            .all(|seconds| *seconds >= 0.0);
        check(counted, "the evidence for people")?;
        let turn_px = self.turn.map_or(0.0, |turn| turn.columns as f32);
        check(belief.turn_px == turn_px, "the turn of the picture")?;
        let tracked = belief.trackers.as_ref().is_none_or(|trackers| {
            trackers.reliabilities.iter().all(|value| share.contains(value))
                && trackers.failing_s.iter().all(|seconds| *seconds >= 0.0)
        });
        check(tracked, "the trackers of people")
    }
}

impl Existence {
    /// Whether it is what evidence can lead to.
    fn is_bounded(self) -> bool {
        (-Self::BOUND..=Self::BOUND).contains(&self.log_odds())
    }
}

fn is_appearance(appearance: &Appearance, bins: usize) -> bool {
    Part::ALL.iter().all(|part| {
        appearance.part(*part).is_none_or(|histogram| {
            let values = histogram.values();
            values.len() == bins && values.iter().all(|value| (0.0..=1.001).contains(value))
        })
    })
}

fn is_portrait(portrait: &Portrait, bins: usize) -> bool {
    is_appearance(portrait.mean(), bins)
}
