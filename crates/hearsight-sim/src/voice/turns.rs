//! Who speaks when: turns drawn from a model of conversation.
//!
//! The floor is a hidden Markov chain in continuous time: somebody talks for an exponentially distributed while, then
//! somebody takes over, either after a pause or before the first has finished. Nobody overlaps themselves. Sums of two
//! exponential spans keep turns from being too short to be heard.

use crate::acoustics::AcousticsError;
use crate::acoustics::error::check;
use crate::acoustics::random::{between, exponential, generator};
use serde::{Deserialize, Serialize};

/// One person speaks from start to end, with the short pauses of speech within.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Turn {
    /// Number of the person, from 0.
    pub person: usize,
    /// When it begins, seconds.
    pub start_s: f64,
    /// When it ends, seconds.
    pub end_s: f64,
}

/// How a conversation goes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TurnSettings {
    /// Mean length of a turn, seconds, 0.5 to 60; default 2.5.
    pub talk_s: f64,
    /// Mean length of a pause between turns, seconds, 0 to 60; default 0.6.
    pub pause_s: f64,
    /// Share of the time in which anyone speaks that has two speakers at once, 0 to 0.3; default 0.05.
    pub overlap: f64,
    /// Probability that somebody else goes on after a pause, 0 to 1; default 0.8. With 0 there is one talker, and no
    /// overlap.
    pub change: f64,
}

impl Default for TurnSettings {
    fn default() -> Self {
        Self {
            talk_s: 2.5,
            pause_s: 0.6,
            overlap: 0.05,
            change: 0.8,
        }
    }
}

/// Shortest turn, seconds: less could not be told from a noise.
const SHORTEST_S: f64 = 0.3;

/// The turns of `people` persons from `start_s` to `end_s`, in order of their start; the same for one seed always.
///
/// # Errors
/// [`AcousticsError::Setting`] where a setting is out of range, there is overlap of fewer than two people, or the span
/// is longer than a week.
pub fn draw_turns(
    settings: &TurnSettings,
    people: usize,
    start_s: f64,
    end_s: f64,
    seed: u64,
) -> Result<Vec<Turn>, AcousticsError> {
    let TurnSettings {
        talk_s,
        pause_s,
        overlap,
        change,
    } = *settings;
    check(
        (0.5..=60.0).contains(&talk_s),
        "turns.talk_s",
        "within 0.5 and 60",
        talk_s,
    )?;
    check(
        (0.0..=60.0).contains(&pause_s),
        "turns.pause_s",
        "within 0 and 60",
        pause_s,
    )?;
    check(
        (0.0..=0.3).contains(&overlap),
        "turns.overlap",
        "within 0 and 0.3",
        overlap,
    )?;
    check(
        (0.0..=1.0).contains(&change),
        "turns.change",
        "within 0 and 1",
        change,
    )?;
    let length_s = end_s - start_s;
    check(
        (0.0..=604_800.0).contains(&length_s),
        "the turns' time",
        "within 0 and 604800 s",
        length_s,
    )?;
    check(people >= 1, "people who take turns", "at least 1", people as f64)?;
    check(
        overlap == 0.0 || (people >= 2 && change > 0.0),
        "turns.overlap",
        "0 unless two people take turns",
        overlap,
    )?;
    let mut random = generator(seed, "turns", people as u64);
    let mut uniform = move || between(&mut random, 0.0, 1.0);
    let mut lengths = generator(seed, "turn lengths", people as u64);
    let mut length = move || {
        let mean = talk_s - SHORTEST_S;
        SHORTEST_S + 0.5 * (exponential(&mut lengths, mean) + exponential(&mut lengths, mean))
    };
    let mut pauses = generator(seed, "pauses", people as u64);
    let mut turns: Vec<Turn> = Vec::new();
    let mut person = ((uniform() * people as f64) as usize).min(people - 1);
    let mut free_s = vec![start_s; people];
    // Until when somebody speaks; the sums of time with any and with two speakers.
    let (mut reached_s, mut spoken_s, mut double_s) = (start_s, 0.0, 0.0);
    let mut begin_s = start_s + 0.5 * pause_s;
    while begin_s < end_s {
        let turn = Turn {
            person,
            start_s: begin_s,
            end_s: (begin_s + length()).min(end_s),
        };
        double_s += (reached_s.min(turn.end_s) - turn.start_s).max(0.0);
        spoken_s += (turn.end_s - turn.start_s.max(reached_s)).max(0.0);
        reached_s = reached_s.max(turn.end_s);
        free_s[person] = turn.end_s;
        turns.push(turn);
        let next = (person + 1 + (uniform() * (people - 1).max(1) as f64) as usize) % people;
        let changes = people > 1 && uniform() < change;
        // Overlap is added where the conversation has had less than its share, so that short ones have it too.
        let owed_s = overlap * (spoken_s + 0.5 * talk_s) - double_s;
        let chance = uniform();
        if changes && owed_s > 0.0 && chance < 0.75 && turn.end_s - turn.start_s > 2.0 * SHORTEST_S {
            let longest_s = turn.end_s - turn.start_s - SHORTEST_S;
            let by_s = (owed_s * (0.5 + uniform())).clamp(0.1, longest_s);
            begin_s = (reached_s - by_s)
                .max(free_s[next] + 0.1)
                .max(turn.start_s + SHORTEST_S);
            person = next;
            continue;
        }
        begin_s = reached_s + 0.1_f64.min(pause_s) + exponential(&mut pauses, (pause_s - 0.1).max(0.0));
        if changes {
            person = next;
        }
        begin_s = begin_s.max(free_s[person] + 0.05);
    }
    turns.retain(|turn| turn.end_s - turn.start_s >= SHORTEST_S);
    Ok(turns)
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Shares {
        talk_s: f64,
        pause_s: f64,
        overlap: f64,
    }

    fn shares(turns: &[Turn]) -> Shares {
        let talk_s = turns.iter().map(|turn| turn.end_s - turn.start_s).sum::<f64>() / turns.len() as f64;
        let (mut any, mut double, mut pauses, mut count) = (0.0, 0.0, 0.0, 0);
        let mut reached = turns[0].start_s;
        for turn in turns {
            double += (reached.min(turn.end_s) - turn.start_s).max(0.0);
            any += (turn.end_s - reached.max(turn.start_s)).max(0.0);
            if turn.start_s > reached {
                pauses += turn.start_s - reached;
                count += 1;
            }
            reached = reached.max(turn.end_s);
        }
        Shares {
            talk_s,
            pause_s: pauses / f64::from(count.max(1)),
            overlap: double / any,
        }
    }

    #[test]
    fn the_conversation_is_as_asked_for() {
        for overlap in [0.0, 0.05, 0.15, 0.3] {
            let settings = TurnSettings {
                overlap,
                ..TurnSettings::default()
            };
            let turns = draw_turns(&settings, 3, 0.0, 3600.0, 1).unwrap();
            let found = shares(&turns);
            assert!((found.talk_s - 2.5).abs() < 0.2, "talk {}", found.talk_s);
            assert!((found.pause_s - 0.6).abs() < 0.1, "pause {}", found.pause_s);
            assert!(
                (found.overlap - overlap).abs() < 0.02,
                "overlap {} of {overlap}",
                found.overlap
            );
        }
    }

    #[test]
    fn nobody_overlaps_themselves_and_all_speak() {
        let settings = TurnSettings {
            overlap: 0.3,
            ..TurnSettings::default()
        };
        for seed in 0..20 {
            let turns = draw_turns(&settings, 4, 5.0, 305.0, seed).unwrap();
            assert_eq!(turns, draw_turns(&settings, 4, 5.0, 305.0, seed).unwrap());
            assert!(turns.is_sorted_by(|a, b| a.start_s <= b.start_s));
            for person in 0..4 {
                let own: Vec<&Turn> = turns.iter().filter(|turn| turn.person == person).collect();
                assert!(own.len() > 5);
                assert!(own.windows(2).all(|pair| pair[0].end_s < pair[1].start_s));
            }
            assert!(
                turns
                    .iter()
                    .all(|turn| turn.start_s >= 5.0 && turn.end_s <= 305.0)
            );
        }
    }

    #[test]
    fn impossible_conversations_are_refused() {
        let settings = TurnSettings::default();
        assert!(draw_turns(&settings, 1, 0.0, 10.0, 0).is_err());
        assert!(
            draw_turns(
                &TurnSettings {
                    overlap: 0.0,
                    ..settings
                },
                1,
                0.0,
                10.0,
                0
            )
            .is_ok()
        );
        assert!(
            draw_turns(
                &TurnSettings {
                    overlap: 0.5,
                    ..settings
                },
                2,
                0.0,
                10.0,
                0
            )
            .is_err()
        );
        assert!(draw_turns(&settings, 2, 0.0, f64::NAN, 0).is_err());
        assert!(draw_turns(&settings, 0, 0.0, 1.0, 0).is_err());
    }
}
