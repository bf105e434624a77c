//! The range of every number among the parameters, checked before anything is built of them.
//!
//! A table a system, and one of what systems on the same parts share: a test walks all parameters, so that none can be
//! without its line. Ranges keep time and memory bounded and leave every sensible value in.

use crate::SystemError;
use serde_json::Value;

/// A parameter by its path, its least and its greatest value.
pub(crate) type Limit = (&'static str, f64, f64);

/// A share or a probability.
pub(crate) const fn share(path: &'static str) -> Limit {
    (path, 0.0, 1.0)
}

/// A time in seconds, up to an hour.
pub(crate) const fn seconds(path: &'static str) -> Limit {
    (path, 0.0, 3600.0)
}

/// What every system that follows heads in pictures has.
pub(crate) const COMMON: &[Limit] = &[
    ("particles", 1.0, 20_000.0),
    ("hidden", -1000.0, 0.0),
    ("body.head_height_m", 0.01, 10.0),
    share("body.mouth_share"),
    ("body.torso_width", 0.1, 10.0),
    ("body.torso_height", 0.1, 10.0),
    ("body.neck", -1.0, 5.0),
    ("vision.background.threshold", 0.0, 255.0),
    ("vision.background.clean.median", 1.0, 15.0),
    ("vision.background.clean.dilation_width", 1.0, 127.0),
    ("vision.background.clean.dilation_height", 1.0, 127.0),
    ("vision.background.background_rate", 0.0, 10_000.0),
    ("vision.background.foreground_rate", 0.0, 10_000.0),
    ("vision.background.learning_secs", 0.0, 600.0),
    ("vision.background.learning_pictures", 1.0, 31.0),
    ("vision.background.largest_gain", 1.0, 8.0),
    share("vision.background.darkest_shadow"),
    ("vision.background.brightest_highlight", 1.0, 4.0),
    ("vision.background.shadow_colour", 0.0, 255.0),
    ("vision.background.ghost_secs", 0.0, 60.0),
    ("vision.background.ghost_pixels", 0.0, u32::MAX as f64),
    ("vision.background.ghost_contrast", 1.0, 1e6),
    ("vision.heads.smallest_px", 4.0, 10_000.0),
    share("vision.heads.widest_share"),
    ("vision.heads.step", 1.02, 10.0),
    ("vision.heads.aspect", 0.2, 5.0),
    share("vision.heads.least_score"),
    ("vision.heads.most", 1.0, 1000.0),
    ("vision.contrast.ring", 1.05, 4.0),
    ("vision.contrast.pixels", 32.0, 60_000.0),
    seconds("vision.faces.period_s"),
    ("vision.faces.smallest_px", 1.0, 10_000.0),
    ("vision.faces.neighbours", 0.0, 1e6),
    share("vision.faces.changed"),
    ("vision.histogram.red", 1.0, 40.0),
    ("vision.histogram.green", 1.0, 40.0),
    ("vision.histogram.blue", 1.0, 40.0),
    ("vision.histogram.pixels", 16.0, u32::MAX as f64),
    ("audio.frame_s", 0.01, 1.0),
    ("audio.hop_s", 0.001, 1.0),
    ("audio.direction.frame_s", 0.005, 1.0),
    ("audio.direction.low_hz", 0.0, 24_000.0),
    share("audio.direction.clarity"),
    ("audio.direction.sound_db", -100.0, 200.0),
    ("audio.direction.silence_db", -100.0, 200.0),
    ("audio.direction.room.reverberation_s", 0.01, 60.0),
    ("audio.direction.room.early_s", 0.001, 1.0),
    share("audio.weighting.noise_regularized.gamma"),
    share("audio.weighting.maximum_likelihood.reverberation"),
    ("audio.agreement.tolerance", 0.001, 100.0),
    share("audio.agreement.floor"),
    ("audio.noise.smoothing_s", 0.001, 60.0),
    ("audio.noise.window_s", 0.01, 3600.0),
    seconds("audio.noise.start_s"),
    ("audio.noise.first_power", 1e-12, 1.0),
    ("audio.noise.rise_db_s", 0.01, 1000.0),
    ("audio.onset.threshold_db", -20.0, 60.0),
    ("audio.onset.frames", 1.0, 1e6),
    ("audio.onset.null_frames", 1.0, 1e6),
    ("audio.activity.on_db", -100.0, 200.0),
    ("audio.activity.off_db", -100.0, 200.0),
    seconds("audio.activity.hangover_s"),
    ("audio.activity.slope", 0.001, 100.0),
    ("audio.activity.limit", 0.001, 100.0),
    ("audio.activity.independence_s", 0.001, 3600.0),
    ("audio.activity.mean_speech_s", 0.001, 3600.0),
    ("audio.activity.mean_pause_s", 0.001, 3600.0),
    ("momentum.settle_s", 0.001, 3600.0),
    ("momentum.keep_s", 0.001, 3600.0),
    ("association.position", 0.01, 100.0),
    ("association.size", 0.01, 100.0),
    ("association.colour", 0.001, 1000.0),
    ("association.gate", 0.0, 10_000.0),
    ("association.hidden", 0.0, 10_000.0),
    share("association.torso"),
    seconds("birth.support_s"),
    share("birth.probability"),
    share("birth.stirred"),
    ("birth.grown", 0.0, 1000.0),
    share("birth.torso_inside"),
    seconds("birth.patience_s"),
    share("birth.talking"),
    ("birth.score", -10.0, 10.0),
    share("birth.crowded"),
    ("birth.margin", -10.0, 10.0),
    ("birth.most_scouts", 0.0, 100.0),
    ("existence.detected", 0.0, 1000.0),
    ("existence.present", -1000.0, 0.0),
    ("existence.verified", 0.0, 1000.0),
    ("existence.refuted", -1000.0, 0.0),
    ("existence.occluded", -1000.0, 0.0),
    ("existence.leaving", -1000.0, 0.0),
    ("existence.absent", -1000.0, 0.0),
    ("existence.outside", -1000.0, 0.0),
    ("existence.least", 0.0, 0.5),
    share("exclusion.overlap"),
    seconds("exclusion.patience_s"),
    seconds("exclusion.body_part_s"),
    seconds("exclusion.hidden_s"),
    seconds("exclusion.fresh_s"),
    seconds("encounter.apart_s"),
    ("encounter.margin", -10.0, 10.0),
    ("encounter.stranger", 0.0, 10.0),
    share("re_entry.first.distance"),
    share("re_entry.first.margin"),
    share("re_entry.second.distance"),
    share("re_entry.second.margin"),
    share("re_entry.torso"),
    ("re_entry.remember_s", 0.0, 1e7),
    seconds("re_entry.least_s"),
    seconds("re_entry.second_look_s"),
    seconds("re_entry.together_s"),
    ("re_entry.looks", 0.0, 1000.0),
    ("appearance.memory_s", 0.001, 3600.0),
    share("appearance.inside"),
    ("speaker.tolerance_s", 0.0, 0.1),
    ("speaker.tolerance_rad", 0.001, 1.0),
    ("speaker.mouth_aside", 0.0, 10.0),
    ("speaker.turned_s", 0.001, 3600.0),
    ("speaker.turn_s", 0.001, 3600.0),
    ("speaker.pause_s", 0.001, 3600.0),
    ("speaker.silence", 0.0, 1000.0),
    ("speaker.unseen", 0.0, 1000.0),
    ("speaker.wander", 0.0, 100.0),
    ("speaker.claim_s", 0.001, 3600.0),
    share("speaker.least"),
];

/// The ranges of a system.
pub(crate) struct Ranges {
    /// Its name.
    pub(crate) system: &'static str,
    /// Its own table and those that it shares.
    pub(crate) tables: &'static [&'static [Limit]],
    /// Parameters that may be null.
    pub(crate) optional: &'static [&'static str],
}

impl Ranges {
    /// Checks the numbers of parameters written as JSON, where one that is not finite is null. Numbers of a list share the
    /// range of the list.
    ///
    /// # Errors
    /// [`SystemError::Range`] for the first that is out of its range.
    pub(crate) fn check(&self, parameters: &Value) -> Result<(), SystemError> {
        self.check_part(parameters, &mut String::new())
    }

    fn find(&self, path: &str) -> Option<&Limit> {
        let mut limits = self.tables.iter().copied().flatten();
        limits.find(|(known, ..)| *known == path)
    }

    fn check_part(&self, value: &Value, path: &mut String) -> Result<(), SystemError> {
        match value {
            Value::Object(table) => {
                for (key, value) in table {
                    let length = path.len();
                    if !path.is_empty() {
                        path.push('.');
                    }
                    path.push_str(key);
                    self.check_part(value, path)?;
                    path.truncate(length);
                }
                Ok(())
            }
            Value::Array(list) => list.iter().try_for_each(|value| self.check_part(value, path)),
            Value::Null if self.optional.contains(&path.as_str()) => Ok(()),
            Value::Null => self.check_number(f64::NAN, path),
            Value::Number(number) => self.check_number(number.as_f64().unwrap_or(f64::NAN), path),
            _ => Ok(()),
        }
    }

    fn check_number(&self, found: f64, path: &str) -> Result<(), SystemError> {
        let &(_, least, greatest) = self.find(path).unwrap_or(&("", f64::MIN, f64::MAX));
        // Parameters of 32 bits are a little off the number that was written.
        let slack = 1e-6 * least.abs().max(greatest.abs().min(1.0));
        if found >= least - slack && found <= greatest + slack {
            return Ok(());
        }
        Err(SystemError::Range {
            system: self.system,
            parameter: path.to_owned(),
            value: found,
            least,
            greatest,
        })
    }
}

/// Tests that every system runs on its tables.
#[cfg(test)]
pub(crate) mod testing {
    use super::*;
    use serde_json::json;

    fn walk(value: &Value, path: &str, each: &mut impl FnMut(&str, f64)) {
        match value {
            Value::Object(table) => {
                for (key, value) in table {
                    let dot = if path.is_empty() { "" } else { "." };
                    walk(value, &format!("{path}{dot}{key}"), each);
                }
            }
            Value::Array(list) => list.iter().for_each(|value| walk(value, path, each)),
            Value::Number(number) => each(path, number.as_f64().unwrap()),
            _ => {}
        }
    }

    /// Every number among these parameters has a range around it, and every range belongs to a number, but for those of
    /// `choices`, which stand for one of several.
    pub(crate) fn every_number_has_a_range(ranges: &Ranges, parameters: &[Value], choices: Option<&str>) {
        let mut seen = Vec::new();
        for parameters in parameters {
            ranges.check(parameters).unwrap();
            walk(parameters, "", &mut |path, value| {
                let limit = ranges.find(path);
                let (_, least, greatest) =
                    limit.unwrap_or_else(|| panic!("{path} has no range in its table"));
                assert!(least < greatest && (least..=greatest).contains(&&value), "{path}");
                seen.push(path.to_owned());
            });
        }
        for (path, ..) in ranges.tables.iter().copied().flatten() {
            let choice = choices.is_some_and(|choices| path.starts_with(choices));
            assert!(
                choice || seen.iter().any(|known| known == path),
                "{path} is no parameter"
            );
        }
    }

    pub(crate) fn each_end_is_allowed_and_nothing_beyond(ranges: &Ranges) {
        for (path, least, greatest) in ranges.tables.iter().copied().flatten() {
            for (value, holds) in [
                (*least, true),
                (*greatest, true),
                (least - 0.1 - 0.1 * least.abs(), false),
                (greatest + 0.1 + 0.1 * greatest.abs(), false),
            ] {
                let nested = path
                    .rsplit('.')
                    .fold(json!(value), |inner, key| json!({ key: inner }));
                let error = ranges.check(&nested).err().map(|error| error.to_string());
                assert_eq!(error.is_none(), holds, "{path} = {value}: {error:?}");
                assert!(error.is_none_or(|error| error.contains(path)));
            }
        }
    }
}
