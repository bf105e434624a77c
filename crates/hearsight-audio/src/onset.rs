//! The onset filter: after a pause, direct sound comes before its reverberation, so the first frames of a sound are
//! worth more than the rest (the precedence effect; Bregonzio, Taj and Cavallaro, section 2.2).
//!
//! ```text
//!            signal                    signal, T frames past
//!   ready ------------> onset 1..T -------------------------> reverberant
//!     ^                     |                                      |
//!     +---------------------+------ enough null frames in a row ---+
//! ```
//!
//! A *signal* frame has a signal-to-noise ratio above the threshold at every microphone; every other frame is a *null*
//! frame. The T frames are counted in time from the first one: null frames among them are not processed but do count.
//! The paper names neither threshold nor null rule; here the default is 6 dB and a single null frame.

use crate::error::{AudioError, check_setting, check_state};
use serde::{Deserialize, Serialize};

/// What an onset is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OnsetSettings {
    /// Signal-to-noise ratio in decibels that every microphone must exceed, -20 to 60; default 6. Raising it keeps only
    /// clear onsets and shortens the memory of reverberation, which then falls below it sooner.
    pub threshold_db: f32,
    /// Frames from the first of an onset that are processed, at least 1; default 6 (the paper's T).
    pub frames: u32,
    /// Null frames in a row after which the next signal frame is an onset, at least 1; default 1. Raising it leaves
    /// fewer onsets, each after a longer pause.
    pub null_frames: u32,
}

impl Default for OnsetSettings {
    fn default() -> Self {
        Self {
            threshold_db: 6.0,
            frames: 6,
            null_frames: 1,
        }
    }
}

/// What a frame is good for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FrameClass {
    /// Noise alone: there is nothing to localize.
    Null,
    /// Sound from near its beginning: the place in the onset, from 1 to T. To be localized.
    Onset(u32),
    /// Sound that its reverberation has caught up with: not to be localized.
    Reverberant,
}

impl FrameClass {
    /// Whether the frame is to be localized.
    pub fn is_onset(self) -> bool {
        matches!(self, Self::Onset(_))
    }
}

/// Sorts frames into onsets and others. Its whole state is serializable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OnsetFilter {
    settings: OnsetSettings,
    /// Frames since the onset began, itself included; 0 while ready for one.
    age: u32,
    /// Null frames in a row up to now.
    nulls: u32,
}

impl OnsetFilter {
    /// A filter that is ready: sound in its first frame is an onset.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where a setting is out of its range.
    pub fn new(settings: OnsetSettings) -> Result<Self, AudioError> {
        let OnsetSettings {
            threshold_db,
            frames,
            null_frames,
        } = settings;
        let holds = (-20.0..=60.0).contains(&threshold_db);
        check_setting(
            holds,
            "threshold_db",
            "within -20 and 60",
            f64::from(threshold_db),
        )?;
        check_setting(frames > 0, "frames", "above 0", f64::from(frames))?;
        check_setting(null_frames > 0, "null_frames", "above 0", f64::from(null_frames))?;
        Ok(Self {
            settings,
            age: 0,
            nulls: 0,
        })
    }

    /// Checks a filter that was saved: whether this one could have become it.
    ///
    /// # Errors
    /// [`AudioError::State`] where it is of other settings.
    pub fn check_saved(&self, saved: &Self) -> Result<(), AudioError> {
        check_state(saved.settings == self.settings, "what an onset is")
    }

    /// Sorts the next frame by the signal-to-noise ratio of each microphone in decibels. A ratio that is not a number, or
    /// no ratio at all, makes a null frame.
    pub fn classify(&mut self, snr_db: &[f32]) -> FrameClass {
        let signal = !snr_db.is_empty() && snr_db.iter().all(|&snr| snr > self.settings.threshold_db);
        if self.age > 0 {
            self.age = self.age.saturating_add(1);
        }
        if !signal {
            self.nulls = self.nulls.saturating_add(1);
            if self.nulls >= self.settings.null_frames {
                self.age = 0;
            }
            return FrameClass::Null;
        }
        self.nulls = 0;
        self.age = self.age.max(1);
        if self.age <= self.settings.frames {
            FrameClass::Onset(self.age)
        } else {
            FrameClass::Reverberant
        }
    }

    /// Makes it ready for an onset, as after a gap in the recording.
    pub fn reset(&mut self) {
        self.age = 0;
        self.nulls = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `s` a signal frame, `.` a null frame; the answer has digits for onsets, `r` and `.`.
    fn run(settings: OnsetSettings, frames: &str) -> String {
        let mut filter = OnsetFilter::new(settings).unwrap();
        let letter = |frame| match filter.classify(if frame == 's' { &[12.0, 7.0] } else { &[12.0, 5.0] }) {
            FrameClass::Null => '.',
            FrameClass::Onset(place) => char::from_digit(place, 10).unwrap(),
            FrameClass::Reverberant => 'r',
        };
        frames.chars().map(letter).collect()
    }

    #[test]
    fn the_first_six_frames_after_a_null_frame_are_onsets() {
        assert_eq!(
            run(OnsetSettings::default(), "ssssssss..ssss.sssssss"),
            "123456rr..1234.123456r"
        );
    }

    #[test]
    fn with_more_null_frames_asked_for_short_pauses_do_not_begin_an_onset() {
        let settings = OnsetSettings {
            null_frames: 2,
            frames: 3,
            ..OnsetSettings::default()
        };
        assert_eq!(run(settings, ".s.sss.s..sss"), ".1.3rr.r..123");
    }

    #[test]
    fn every_microphone_must_hear_it() {
        let mut filter = OnsetFilter::new(OnsetSettings::default()).unwrap();
        assert_eq!(filter.classify(&[f32::NAN, 20.0]), FrameClass::Null);
        assert_eq!(filter.classify(&[]), FrameClass::Null);
        assert_eq!(filter.classify(&[6.0, 20.0]), FrameClass::Null);
        assert_eq!(filter.classify(&[6.1, 20.0]), FrameClass::Onset(1));
    }

    #[test]
    fn a_saved_filter_goes_on() {
        let mut filter = OnsetFilter::new(OnsetSettings::default()).unwrap();
        filter.classify(&[10.0]);
        let saved = serde_json::to_string(&filter).unwrap();
        let mut restored: OnsetFilter = serde_json::from_str(&saved).unwrap();
        assert_eq!(restored.classify(&[10.0]), FrameClass::Onset(2));
        assert!(
            OnsetFilter::new(OnsetSettings {
                frames: 0,
                ..OnsetSettings::default()
            })
            .is_err()
        );
    }
}
