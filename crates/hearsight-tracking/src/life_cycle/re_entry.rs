//! Re-entry: a person who comes back is known by the colours of clothing and hair.
//!
//! The paper's system numbers everyone anew; this part is on by default and can be turned off for its figures.

use crate::belief::Portrait;
use hearsight_core::Instant;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How alike a newcomer must be to somebody remembered.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Likeness {
    /// Largest colour distance to the person remembered, 0 to 1. Raising it knows more people again and mistakes more
    /// strangers for them.
    pub distance: f32,
    /// By how much the next best person must be further away in colour, 0 to 1.
    pub margin: f32,
}

/// When a newcomer is somebody known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ReEntrySettings {
    /// Whether people are known again. Default true; false is the paper's system.
    pub enabled: bool,
    /// What it takes at first sight, when little of the person has been seen. Default: distance 0.45, margin 0.1.
    pub first: Likeness,
    /// What it takes at the second look. Default: distance 0.65, margin 0.04.
    pub second: Likeness,
    /// Weight of the torso's colours against the head's, 0 to 1. Default 0.8.
    pub torso: f32,
    /// For how long somebody who left is remembered, seconds. Default 600.
    pub remember_s: f64,
    /// Only somebody whom detections have supported for this long is remembered, seconds. Default 1.
    pub least_s: f64,
    /// Somebody unknown is looked at again after this time, when more of them has been seen, seconds. Default 0.8.
    pub second_look_s: f64,
    /// Nobody is in two places: whoever was still seen for this long while the newcomer was there is not the newcomer,
    /// seconds. Default 1, in which a track may have outlived the person.
    pub together_s: f64,
    /// Looks after the first one, each `second_look_s` after the one before. Default 3.
    pub looks: u32,
}

impl Default for ReEntrySettings {
    fn default() -> Self {
        Self {
            enabled: true,
            first: Likeness {
                distance: 0.45,
                margin: 0.1,
            },
            second: Likeness {
                distance: 0.65,
                margin: 0.04,
            },
            torso: 0.8,
            remember_s: 600.0,
            least_s: 1.0,
            second_look_s: 0.8,
            together_s: 1.0,
            looks: 3,
        }
    }
}

/// Everyone who left.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Memory {
    gone: Vec<Gone>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Gone {
    identity: u64,
    portrait: Portrait,
    left: Instant,
}

impl Memory {
    /// Most people remembered; the one who left first is forgotten first.
    const CAPACITY: usize = 64;

    /// Remembers somebody who left.
    pub fn remember(&mut self, identity: u64, portrait: Portrait, left: Instant) {
        if self.gone.len() >= Self::CAPACITY {
            self.gone.remove(0);
        }
        self.gone.push(Gone {
            identity,
            portrait,
            left,
        });
    }

    /// Everyone remembered, with their identity.
    pub(crate) fn everyone(&self) -> impl Iterator<Item = (u64, &Portrait)> {
        self.gone.iter().map(|gone| (gone.identity, &gone.portrait))
    }

    /// The portrait of somebody who left.
    pub(crate) fn portrait(&self, identity: u64) -> Option<&Portrait> {
        self.gone
            .iter()
            .find(|gone| gone.identity == identity)
            .map(|gone| &gone.portrait)
    }

    /// Lets somebody who left change places with somebody who is there: `identity` and `portrait` are remembered in
    /// place of `gone`, whose portrait is handed out.
    pub(crate) fn exchange(&mut self, gone: u64, identity: u64, portrait: &mut Portrait) {
        if let Some(remembered) = self
            .gone
            .iter_mut()
            .find(|remembered| remembered.identity == gone)
        {
            remembered.identity = identity;
            std::mem::swap(&mut remembered.portrait, portrait);
        }
    }

    /// Who of those who left this is, if anybody; they are no longer gone then. `born` is when the newcomer was first seen.
    pub fn recognize(
        &mut self,
        portrait: &Portrait,
        born: Instant,
        now: Instant,
        second_look: bool,
        settings: &ReEntrySettings,
    ) -> Option<(u64, Portrait)> {
        self.gone
            .retain(|gone| (now - gone.left).seconds() <= settings.remember_s);
        if !settings.enabled {
            return None;
        }
        let mut best: Option<(usize, f32)> = None;
        let mut next = f32::INFINITY;
        for (place, gone) in self.gone.iter().enumerate() {
            if (gone.left - born).seconds() > settings.together_s {
                continue;
            }
            let Some(distance) = gone.portrait.mean().distance(portrait.mean(), settings.torso) else {
                continue;
            };
            match best {
                Some((_, nearest)) if distance >= nearest => next = next.min(distance),
                _ => {
                    next = best.map_or(next, |(_, nearest)| nearest);
                    best = Some((place, distance));
                }
            }
        }
        let (place, distance) = best?;
        let likeness = if second_look {
            settings.second
        } else {
            settings.first
        };
        let clear = distance <= likeness.distance && next - distance >= likeness.margin;
        clear.then(|| {
            let gone = self.gone.remove(place);
            (gone.identity, gone.portrait)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Part;
    use hearsight_vision::histogram::Histogram;

    #[test]
    fn whoever_was_seen_beside_somebody_is_not_them() {
        let mut portrait = Portrait::default();
        portrait.add(Part::Torso, &Histogram::new(vec![0.5, 0.5]).unwrap());
        let at = |seconds: f64| Instant::ZERO + hearsight_core::Span::from_seconds(seconds);
        let settings = ReEntrySettings::default();
        let mut memory = Memory::default();
        memory.remember(7, portrait.clone(), at(10.0));
        let mut known = |born| memory.recognize(&portrait, at(born), at(12.0), true, &settings);
        assert!(known(8.0).is_none(), "two seconds together");
        assert!(known(9.5).is_some_and(|(identity, _)| identity == 7));
    }
}
