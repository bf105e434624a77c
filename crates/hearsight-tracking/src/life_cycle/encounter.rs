//! Encounters: after two people were at one place in the picture, who is who is asked again.
//!
//! While heads cover each other a filter may follow the wrong one. Colours learnt before the meeting are kept; once both
//! are apart again, the new colours are compared with the old ones, and identities change places where that fits clearly
//! better.

use super::Memory;
use crate::belief::{Belief, Portrait};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// When identities are exchanged after a meeting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct EncounterSettings {
    /// For how long both must have been seen apart before they are compared, seconds. Default 0.4.
    pub apart_s: f64,
    /// By how much the sum of both colour distances must fall for identities to be exchanged. Default 0.15. Raising it
    /// trusts the filters more.
    pub margin: f32,
    /// Colour distance to oneself before the meeting from which somebody whose partner is gone is a stranger, 0 to 1.
    /// Default 0.6.
    pub stranger: f32,
}

impl Default for EncounterSettings {
    fn default() -> Self {
        Self {
            apart_s: 0.4,
            margin: 0.15,
            stranger: 0.6,
        }
    }
}

/// A meeting that has not been settled: saved with the belief.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Encounter {
    /// Number of the belief met last.
    pub with: u64,
    /// Its identity.
    pub with_identity: Option<u64>,
    /// For how long the person has been seen apart since, seconds.
    pub apart_s: f64,
    /// Colours seen since.
    pub since: Portrait,
}

/// Begins a meeting of two beliefs, or begins it anew. Scouts meet nobody.
pub(crate) fn meet(beliefs: &mut [Belief], first: usize, second: usize) {
    for (own, other) in [(first, second), (second, first)] {
        let (with, with_identity) = (beliefs[other].number, beliefs[other].identity);
        beliefs[own].encounter = Some(Encounter {
            with,
            with_identity,
            ..Encounter::default()
        });
    }
}

/// Settles every meeting of which both sides have been seen apart for long enough, or of which the other is gone.
pub(crate) fn settle(beliefs: &mut [Belief], memory: &mut Memory, torso: f32, settings: &EncounterSettings) {
    for place in 0..beliefs.len() {
        let long_apart = |encounter: &&Encounter| encounter.apart_s >= settings.apart_s;
        let Some(encounter) = beliefs[place].encounter.as_ref().filter(long_apart).cloned() else {
            continue;
        };
        let other = beliefs.iter().position(|belief| belief.number == encounter.with);
        if other.is_none() {
            // One of both was given up while they were at one place: perhaps it was the wrong one.
            survive(&mut beliefs[place], &encounter, memory, torso, settings);
        }
        if let Some(other) = other {
            match &beliefs[other].encounter {
                Some(theirs) if theirs.with == beliefs[place].number => {
                    if theirs.apart_s < settings.apart_s {
                        continue;
                    }
                    let theirs = theirs.since.clone();
                    if fits_crossed(
                        &beliefs[place],
                        &encounter.since,
                        &beliefs[other],
                        &theirs,
                        torso,
                        settings,
                    ) {
                        exchange(beliefs, place, other);
                    }
                }
                // The other has met somebody else since, or has settled already.
                _ => {}
            }
        }
        // Both sides were compared at once, so both are settled at once.
        for settled in [Some(place), other].into_iter().flatten() {
            let belief = &mut beliefs[settled];
            if let Some(encounter) = belief
                .encounter
                .take_if(|encounter| encounter.apart_s >= settings.apart_s)
            {
                belief.portrait.join(&encounter.since);
            }
        }
    }
}

/// Settles the meeting of somebody whose partner is gone: takes over the partner's identity where that fits better, and
/// becomes a scout again where the colours since are those of neither.
fn survive(
    belief: &mut Belief,
    encounter: &Encounter,
    memory: &mut Memory,
    torso: f32,
    settings: &EncounterSettings,
) {
    let since = encounter.since.mean();
    let Some((identity, own)) = belief.identity.zip(belief.portrait.mean().distance(since, torso)) else {
        return;
    };
    let gone = encounter.with_identity;
    let theirs = gone
        .and_then(|gone| memory.portrait(gone))
        .and_then(|portrait| portrait.mean().distance(since, torso));
    if let Some((gone, theirs)) = gone.zip(theirs)
        && theirs + 0.5 * settings.margin < own
    {
        memory.exchange(gone, identity, &mut belief.portrait);
        belief.identity = Some(gone);
    } else if own > settings.stranger {
        memory.remember(identity, std::mem::take(&mut belief.portrait), belief.supported);
        belief.identity = None;
    }
}

fn fits_crossed(
    first: &Belief,
    first_since: &Portrait,
    second: &Belief,
    second_since: &Portrait,
    torso: f32,
    settings: &EncounterSettings,
) -> bool {
    let distance = |before: &Belief, since: &Portrait| before.portrait.mean().distance(since.mean(), torso);
    let straight = distance(first, first_since).zip(distance(second, second_since));
    let crossed = distance(first, second_since).zip(distance(second, first_since));
    straight
        .zip(crossed)
        .is_some_and(|(straight, crossed)| crossed.0 + crossed.1 + settings.margin < straight.0 + straight.1)
}

/// Exchanges what makes two beliefs persons: identity and portrait, and what they have since been seen like.
fn exchange(beliefs: &mut [Belief], first: usize, second: usize) {
    let Ok([a, b]) = beliefs.get_disjoint_mut([first, second]) else {
        return;
    };
    std::mem::swap(&mut a.identity, &mut b.identity);
    std::mem::swap(&mut a.portrait, &mut b.portrait);
    std::mem::swap(&mut a.unknown_since, &mut b.unknown_since);
}
