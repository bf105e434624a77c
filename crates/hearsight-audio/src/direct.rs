//! How much of each frequency is sound that came straight from its source, as far as the past tells.
//!
//! The reverberation of a room dies away exponentially: what a frequency still reverberates with follows from the power
//! that it had a moment ago. What stands above that and above the noise is new, and mostly direct. It is the
//! precedence effect a frequency: an onset in one band counts although another band still rings. Polack's model of late
//! reverberation, as in Lebart, Boucher and Denbigh, "A new method based on spectral subtraction for speech
//! dereverberation", 2001.

use crate::error::{AudioError, check_setting, check_shape, check_state};
use serde::{Deserialize, Serialize};

/// What is known of the room.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DirectSettings {
    /// Seconds in which reverberation falls by 60 dB, above 0; default 0.4, a furnished room. Raising it takes more of
    /// the sound for reverberation.
    pub reverberation_s: f64,
    /// Seconds after which sound counts as reverberation, above 0; default 0.03: what comes earlier has the direct
    /// sound in it.
    pub early_s: f64,
}

impl Default for DirectSettings {
    fn default() -> Self {
        Self {
            reverberation_s: 0.4,
            early_s: 0.03,
        }
    }
}

/// Follows the reverberation of each bin of a spectrum. Its whole state is serializable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DirectShare {
    /// Factor of the reverberant power from frame to frame.
    decay: f32,
    /// Factor over `early_s`.
    first: f32,
    reverberant: Vec<f32>,
    /// Powers of the last frames, the oldest at `oldest`; frames x bins.
    recent: Vec<Vec<f32>>,
    oldest: usize,
}

impl DirectShare {
    /// A follower of `bins` bins, one spectrum each `interval_s` seconds, before which it was silent.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where a setting is out of its range.
    pub fn new(settings: &DirectSettings, interval_s: f64, bins: usize) -> Result<Self, AudioError> {
        let DirectSettings {
            reverberation_s,
            early_s,
        } = *settings;
        for (name, value) in [
            ("reverberation_s", reverberation_s),
            ("early_s", early_s),
            ("interval_s", interval_s),
            ("bins", bins as f64),
        ] {
            check_setting(value > 0.0 && value.is_finite(), name, "above 0", value)?;
        }
        let fall = |seconds: f64| 10.0_f64.powf(-6.0 * seconds / reverberation_s) as f32;
        let frames = (early_s / interval_s).round().clamp(1.0, 1000.0) as usize;
        Ok(Self {
            decay: fall(interval_s),
            first: fall(early_s),
            reverberant: vec![0.0; bins],
            recent: vec![vec![0.0; bins]; frames],
            oldest: 0,
        })
    }

    /// Checks a follower that was saved: whether this one could have become it.
    ///
    /// # Errors
    /// [`AudioError::State`] or [`AudioError::Shape`] where it is of other settings or contradicts itself.
    pub fn check_saved(&self, saved: &Self) -> Result<(), AudioError> {
        check_state(
            (saved.decay, saved.first) == (self.decay, self.first),
            "the reverberation of the room",
        )?;
        check_shape("frames remembered", self.recent.len(), saved.recent.len())?;
        check_state(saved.oldest < self.recent.len(), "the oldest frame remembered")?;
        for powers in saved.recent.iter().chain([&saved.reverberant]) {
            check_shape("bins of a frame remembered", self.reverberant.len(), powers.len())?;
            let real = powers.iter().all(|&power| power >= 0.0 && power.is_finite());
            check_state(real, "the powers remembered")?;
        }
        Ok(())
    }

    /// Takes in the power |X|² of each bin of the next frame and writes the share of direct sound in it, 0 to 1, into
    /// `share`; `noise` is the noise power of each bin in the same scaling. Powers that are not finite count as silence.
    ///
    /// # Errors
    /// [`AudioError::Shape`] where a slice does not have one value a bin; nothing is changed then.
    pub fn observe(&mut self, power: &[f32], noise: &[f32], share: &mut [f32]) -> Result<(), AudioError> {
        let bins = self.reverberant.len();
        check_shape("powers of a frame", bins, power.len())?;
        check_shape("noise powers", bins, noise.len())?;
        check_shape("shares", bins, share.len())?;
        let past = &mut self.recent[self.oldest];
        for bin in 0..bins {
            let reverberant = (self.decay * self.reverberant[bin]).max(self.first * past[bin]);
            self.reverberant[bin] = reverberant;
            let now = if power[bin].is_finite() { power[bin] } else { 0.0 };
            let known = reverberant + noise[bin].max(0.0);
            share[bin] = if now > known { 1.0 - known / now } else { 0.0 };
            past[bin] = now;
        }
        self.oldest = (self.oldest + 1) % self.recent.len();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(follower: &mut DirectShare, powers: &[f32]) -> Vec<f32> {
        let mut share = [0.0];
        powers
            .iter()
            .map(|&power| {
                follower.observe(&[power], &[1.0], &mut share).unwrap();
                share[0]
            })
            .collect()
    }

    fn follower() -> DirectShare {
        let settings = DirectSettings {
            reverberation_s: 0.6,
            early_s: 0.04,
        };
        DirectShare::new(&settings, 0.02, 1).unwrap()
    }

    #[test]
    fn an_onset_is_direct_and_its_decay_is_not() {
        // 60 dB in 0.6 s are 2 dB a frame.
        let decay = |k: i32| 1e4 * 10.0_f32.powf(-0.2 * k as f32);
        let powers: Vec<f32> = [1.0, 1.0, 1e4, 1e4]
            .into_iter()
            .chain((1..12).map(decay))
            .collect();
        let shares = run(&mut follower(), &powers);
        assert_eq!(shares[..2], [0.0, 0.0], "noise alone");
        assert!(shares[2] > 0.999 && shares[3] > 0.999, "{shares:?}");
        assert!(shares[6..].iter().all(|share| *share < 0.01), "{shares:?}");
    }

    #[test]
    fn sound_that_rises_out_of_reverberation_counts_by_what_it_adds() {
        let mut follower = follower();
        run(&mut follower, &[1e4, 1e4, 1e4]);
        let share = run(&mut follower, &[1e5])[0];
        let expected = 1.0 - (10.0_f32.powf(-0.4) * 1e4 + 1.0) / 1e5;
        assert!((share - expected).abs() < 1e-4, "{share} {expected}");
    }

    #[test]
    fn what_is_not_finite_is_silence_and_a_saved_follower_goes_on() {
        let mut first = follower();
        assert_eq!(run(&mut first, &[f32::NAN, f32::INFINITY, 5.0])[..2], [0.0, 0.0]);
        let saved = serde_json::to_string(&first).unwrap();
        let mut second: DirectShare = serde_json::from_str(&saved).unwrap();
        assert_eq!(run(&mut first, &[7.0, 3.0]), run(&mut second, &[7.0, 3.0]));
        assert!(first.observe(&[1.0], &[1.0, 1.0], &mut [0.0]).is_err());
        assert!(DirectShare::new(&DirectSettings::default(), 0.0, 4).is_err());
    }
}
