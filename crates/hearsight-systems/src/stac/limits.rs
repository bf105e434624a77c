//! Ranges of the parameters that are stac's own.

use super::INFO;
use crate::limits::{COMMON, Limit, Ranges, share};

const OWN: &[Limit] = &[
    share("anywhere"),
    ("transition.position", 0.0, 100.0),
    ("transition.size", 0.0, 10.0),
    share("detected.share"),
    ("detected.position", 0.0, 10.0),
    ("detected.size", 0.0, 10.0),
    ("head_colour.sigma", 0.001, 1000.0),
    ("head_colour.floor", -1000.0, 0.0),
    ("head_colour.exponent", 0.0, 100.0),
    ("torso_colour.sigma", 0.001, 1000.0),
    ("torso_colour.floor", -1000.0, 0.0),
    ("torso_colour.exponent", 0.0, 100.0),
    ("motion.sigma", 0.001, 1000.0),
    ("motion.floor", -1000.0, 0.0),
    ("motion.exponent", 0.0, 100.0),
    ("motion_shape.position", 0.001, 100.0),
    ("motion_shape.size", 0.001, 100.0),
    ("motion_shape.floor", 1e-30, 1.0),
    ("sound.sigma", 0.001, 1000.0),
    ("sound.floor", -1000.0, 0.0),
    ("sound.exponent", 0.0, 100.0),
];

/// The ranges of all parameters.
pub(super) const RANGES: Ranges = Ranges {
    system: INFO.name,
    tables: &[OWN, COMMON],
    optional: &[],
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::testing;
    use crate::stac::Parameters;

    #[test]
    fn every_number_has_a_range_around_its_default() {
        let defaults = serde_json::to_value(Parameters::default()).unwrap();
        testing::every_number_has_a_range(&RANGES, &[defaults], Some("audio.weighting."));
    }

    #[test]
    fn each_end_is_allowed_and_nothing_beyond_it() {
        testing::each_end_is_allowed_and_nothing_beyond(&RANGES);
    }

    #[test]
    fn what_is_not_finite_is_named() {
        let mut parameters = Parameters::default();
        parameters.association.gate = f32::INFINITY;
        let error = RANGES
            .check(&serde_json::to_value(parameters).unwrap())
            .unwrap_err();
        assert!(
            error.to_string().contains("system.stac.association.gate"),
            "{error}"
        );
    }
}
