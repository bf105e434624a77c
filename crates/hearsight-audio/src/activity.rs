//! Voice activity by energy: a decision with hysteresis and hangover, and a probability.
//!
//! It hears that there is sound above the noise, not that it is speech.

use crate::error::{AudioError, check_setting, check_state};
use serde::{Deserialize, Serialize};

/// When sound counts as voice.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ActivitySettings {
    /// Signal-to-noise ratio in decibels from which activity begins, above `off_db`; default 8.
    pub on_db: f32,
    /// Signal-to-noise ratio in decibels below which it may end; default 5.
    pub off_db: f32,
    /// Seconds that it goes on after the ratio fell below `off_db`, 0 or more; default 0.2, which bridges the gaps
    /// within words.
    pub hangover_s: f64,
    /// Logarithm of the likelihood ratio gained with each decibel above the middle of both thresholds, above 0;
    /// default 0.4. Raising it makes the probability more decided.
    pub slope: f32,
    /// The greatest logarithm of the likelihood ratio of one frame, above 0; default 4. Energy alone is never surer.
    pub limit: f32,
    /// Seconds after which frames count as independent, above 0; default 0.1. Evidence of frames closer together is
    /// shared out.
    pub independence_s: f64,
    /// Mean seconds of speech without a pause, above 0; default 2.
    pub mean_speech_s: f64,
    /// Mean seconds of a pause, above 0; default 1.
    pub mean_pause_s: f64,
}

impl Default for ActivitySettings {
    fn default() -> Self {
        Self {
            on_db: 8.0,
            off_db: 5.0,
            hangover_s: 0.2,
            slope: 0.4,
            limit: 4.0,
            independence_s: 0.1,
            mean_speech_s: 2.0,
            mean_pause_s: 1.0,
        }
    }
}

/// Whether somebody speaks, as far as energy tells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Activity {
    /// The decision, with hysteresis and hangover.
    pub active: bool,
    /// Probability of activity given all frames up to now, 0 to 1.
    pub probability: f32,
    /// Natural logarithm of p(frame | activity) / p(frame | none), of this frame alone, within ± `limit`.
    pub log_ratio: f32,
}

/// Follows the activity at one array. Its whole state is serializable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActivityDetector {
    settings: ActivitySettings,
    active: bool,
    /// Seconds since the ratio was last at or above the lower threshold.
    below_s: f64,
    probability: f64,
}

impl ActivityDetector {
    /// A detector that starts inactive, with even odds.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where a setting is out of its range.
    pub fn new(settings: ActivitySettings) -> Result<Self, AudioError> {
        let ordered = settings.on_db > settings.off_db && (settings.on_db - settings.off_db).is_finite();
        check_setting(ordered, "on_db", "above off_db", f64::from(settings.on_db))?;
        check_setting(
            settings.hangover_s >= 0.0 && settings.hangover_s.is_finite(),
            "hangover_s",
            "0 or more",
            settings.hangover_s,
        )?;
        for (name, value) in [
            ("slope", f64::from(settings.slope)),
            ("limit", f64::from(settings.limit)),
            ("independence_s", settings.independence_s),
            ("mean_speech_s", settings.mean_speech_s),
            ("mean_pause_s", settings.mean_pause_s),
        ] {
            check_setting(value > 0.0 && value.is_finite(), name, "above 0", value)?;
        }
        Ok(Self {
            settings,
            active: false,
            below_s: f64::MAX,
            probability: 0.5,
        })
    }

    /// Checks a detector that was saved: whether this one could have become it.
    ///
    /// # Errors
    /// [`AudioError::State`] where it is of other settings or contradicts itself.
    pub fn check_saved(&self, saved: &Self) -> Result<(), AudioError> {
        check_state(saved.settings == self.settings, "what counts as voice")?;
        let holds = saved.below_s >= 0.0 && (1e-6..=1.0 - 1e-6).contains(&saved.probability);
        check_state(holds, "the probability of a voice")
    }

    /// Takes in the signal-to-noise ratio of the next frame in decibels (the mean over the channels of an array), and the
    /// seconds since the frame before. A ratio that is not a number tells nothing: time passes, no evidence is added.
    pub fn observe(&mut self, snr_db: f32, elapsed_s: f64) -> Activity {
        let settings = &self.settings;
        let elapsed_s = if elapsed_s.is_finite() {
            elapsed_s.max(0.0)
        } else {
            0.0
        };
        let middle = 0.5 * (settings.on_db + settings.off_db);
        let log_ratio = if snr_db.is_nan() {
            0.0
        } else {
            (settings.slope * (snr_db - middle)).clamp(-settings.limit, settings.limit)
        };
        // The two-state chain in continuous time, over whatever time has passed.
        let (begin, end) = (settings.mean_pause_s.recip(), settings.mean_speech_s.recip());
        let rest = begin / (begin + end);
        let predicted = rest + (self.probability - rest) * (-(begin + end) * elapsed_s).exp();
        let share = (elapsed_s / settings.independence_s).min(1.0);
        let odds = predicted / (1.0 - predicted) * (f64::from(log_ratio) * share).exp();
        self.probability = (odds / (1.0 + odds)).clamp(1e-6, 1.0 - 1e-6);

        self.below_s = if snr_db >= settings.off_db {
            0.0
        } else {
            (self.below_s + elapsed_s).min(f64::MAX)
        };
        self.active = snr_db >= settings.on_db || (self.active && self.below_s <= settings.hangover_s);
        Activity {
            active: self.active,
            probability: self.probability as f32,
            log_ratio,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detector() -> ActivityDetector {
        ActivityDetector::new(ActivitySettings::default()).unwrap()
    }

    #[test]
    fn hysteresis_and_hangover() {
        let mut detector = detector();
        let mut active = |snr, count: usize| {
            (0..count)
                .map(|_| detector.observe(snr, 0.04).active)
                .collect::<Vec<_>>()
        };
        assert_eq!(active(6.0, 3), [false; 3]);
        assert_eq!(active(8.5, 1), [true]);
        assert_eq!(active(5.5, 20), [true; 20]);
        assert_eq!(active(2.0, 7), [true, true, true, true, true, false, false]);
        assert_eq!(active(6.0, 2), [false; 2]);
    }

    #[test]
    fn probability_follows_the_evidence_and_forgets_without_it() {
        let mut detector = detector();
        let mut last = detector.observe(25.0, 0.02);
        assert_eq!(last.log_ratio, 4.0);
        for _ in 0..50 {
            last = detector.observe(25.0, 0.02);
        }
        assert!(last.probability > 0.97);
        for _ in 0..50 {
            last = detector.observe(0.0, 0.02);
        }
        assert!(last.probability < 0.05);
        for _ in 0..20 {
            last = detector.observe(f32::NAN, 1.0);
        }
        assert!((last.probability - 2.0 / 3.0).abs() < 0.01 && last.log_ratio == 0.0);
    }

    #[test]
    fn frames_twice_as_dense_are_no_more_evidence() {
        let (mut sparse, mut dense) = (detector(), detector());
        let mut last = [0.0; 2];
        for _ in 0..10 {
            last[0] = sparse.observe(8.0, 0.04).probability;
            dense.observe(8.0, 0.02);
            last[1] = dense.observe(8.0, 0.02).probability;
        }
        assert!((last[0] - last[1]).abs() < 0.01, "{last:?}");
    }

    #[test]
    fn a_saved_detector_goes_on() {
        let mut first = detector();
        first.observe(12.0, 0.02);
        let mut second: ActivityDetector =
            serde_json::from_str(&serde_json::to_string(&first).unwrap()).unwrap();
        assert_eq!(first.observe(4.0, 0.02), second.observe(4.0, 0.02));
        let settings = ActivitySettings {
            on_db: 3.0,
            ..ActivitySettings::default()
        };
        assert!(ActivityDetector::new(settings).is_err());
    }
}
