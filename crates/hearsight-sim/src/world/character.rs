//! What makes one body move unlike another: how it sways, how often it blinks, how much it gestures. All from a seed.

use crate::acoustics::random::{between, generator, mix};
use std::f64::consts::TAU;

/// Seconds in which somebody blinks once.
const BLINK_EVERY_S: f64 = 3.6;
/// How long a blink lasts, seconds.
const BLINK_S: f64 = 0.22;

/// The little movements of one person.
#[derive(Clone, Debug, PartialEq)]
pub struct Character {
    seed: u64,
    waves: Vec<[Wave; 3]>,
    /// How much somebody moves their hands when talking, 0 to 1.
    pub liveliness: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Wave {
    rate_rad_s: f64,
    phase_rad: f64,
    share: f64,
}

/// What sways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sway {
    /// The trunk, forward and to the left.
    Forward,
    Left,
    /// The head.
    Yaw,
    Pitch,
    Roll,
    /// Hands of somebody who talks: one after the other forward, left, up.
    LeftHand(usize),
    RightHand(usize),
    /// The head of somebody who talks.
    Nod,
}

impl Sway {
    const COUNT: usize = 12;

    const fn number(self) -> usize {
        match self {
            Self::Forward => 0,
            Self::Left => 1,
            Self::Yaw => 2,
            Self::Pitch => 3,
            Self::Roll => 4,
            Self::Nod => 5,
            Self::LeftHand(axis) => 6 + axis % 3,
            Self::RightHand(axis) => 9 + axis % 3,
        }
    }

    /// Slowest and fastest of its waves, hertz.
    const fn range_hz(self) -> [f64; 2] {
        match self {
            Self::Forward | Self::Left => [0.08, 0.45],
            Self::Yaw | Self::Pitch | Self::Roll => [0.1, 0.6],
            Self::Nod => [0.7, 2.2],
            Self::LeftHand(_) | Self::RightHand(_) => [0.25, 1.4],
        }
    }
}

impl Character {
    /// The character of a seed.
    pub fn new(seed: u64) -> Self {
        let all = [
            Sway::Forward,
            Sway::Left,
            Sway::Yaw,
            Sway::Pitch,
            Sway::Roll,
            Sway::Nod,
            Sway::LeftHand(0),
            Sway::LeftHand(1),
            Sway::LeftHand(2),
            Sway::RightHand(0),
            Sway::RightHand(1),
            Sway::RightHand(2),
        ];
        let mut random = generator(seed, "character", 0);
        let mut waves = vec![
            [Wave {
                rate_rad_s: 0.0,
                phase_rad: 0.0,
                share: 0.0
            }; 3];
            Sway::COUNT
        ];
        for sway in all {
            let [slow, fast] = sway.range_hz();
            for (wave, share) in waves[sway.number()].iter_mut().zip([0.5, 0.3, 0.2]) {
                *wave = Wave {
                    rate_rad_s: TAU * between(&mut random, slow, fast),
                    phase_rad: between(&mut random, 0.0, TAU),
                    share,
                };
            }
        }
        let liveliness = between(&mut random, 0.2, 1.0);
        Self {
            seed,
            waves,
            liveliness,
        }
    }

    /// A smooth number within -1 and 1.
    pub(crate) fn sway(&self, sway: Sway, time_s: f64) -> f64 {
        let waves = &self.waves[sway.number()];
        waves
            .iter()
            .map(|wave| wave.share * (wave.rate_rad_s * time_s + wave.phase_rad).sin())
            .sum()
    }

    /// How far the eyes are closed: 0 open, 1 closed.
    pub(crate) fn blink(&self, time_s: f64) -> f64 {
        let slot = (time_s / BLINK_EVERY_S).floor();
        let bits = mix(self.seed ^ mix(slot as i64 as u64));
        let part = (bits >> 11) as f64 / 9_007_199_254_740_992.0;
        let begin = slot * BLINK_EVERY_S + part * (BLINK_EVERY_S - BLINK_S);
        let into = (time_s - begin) / BLINK_S;
        if (0.0..=1.0).contains(&into) {
            (1.0 - (2.0 * into - 1.0).abs()).min(0.5) * 2.0
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_differ_and_repeat() {
        let (one, other) = (Character::new(1), Character::new(2));
        assert_eq!(one, Character::new(1));
        assert_ne!(one.sway(Sway::Yaw, 3.0), other.sway(Sway::Yaw, 3.0));
        let mut closed = 0;
        for number in 0..60_000 {
            let time = f64::from(number) * 1e-3;
            assert!(one.sway(Sway::Nod, time).abs() <= 1.0);
            closed += u32::from(one.blink(time) > 0.9);
        }
        // 17 blinks a minute, the middle of each closed.
        assert!((1_000..3_000).contains(&closed), "{closed}");
    }
}
