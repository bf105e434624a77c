//! Ranges of the parameters that are the closed loop's own.

use super::INFO;
use crate::limits::{COMMON, Limit, Ranges, seconds, share};

const OWN: &[Limit] = &[
    share("fuser.shares.prior"),
    ("fuser.shares.detected", 0.0, 0.9),
    ("fuser.shares.least", 0.0, 0.3),
    share("fuser.feedback.failing"),
    seconds("fuser.feedback.patience_s"),
    ("fuser.feedback.memory_s", 0.001, 3600.0),
    ("fuser.motion.rate_per_s", 0.01, 1000.0),
    ("fuser.motion.speed_heads_s", 0.001, 1000.0),
    ("fuser.motion.growth_per_s", 0.001, 100.0),
    ("fuser.contour.edges.lines", 4.0, 256.0),
    ("fuser.contour.edges.reach", 0.01, 2.0),
    ("fuser.contour.edges.longest_px", 3.0, 64.0),
    ("fuser.contour.edges.least_strength", 0.001, 1000.0),
    ("fuser.contour.line.deviation_px", 0.1, 100.0),
    ("fuser.contour.line.missed", 0.0001, 1.0),
    ("fuser.contour.line.clutter", 0.0001, 10.0),
    ("fuser.contour.smoothness_px", 0.01, 100.0),
    ("fuser.contour.deviation_px", 0.01, 1000.0),
    ("fuser.contour.least_ratio", 0.0, 1e6),
    share("fuser.contour.least_lines"),
    ("fuser.contour.spread_px", 0.0, 1000.0),
    ("fuser.contour.form.alpha", 0.0001, 1.0),
    ("fuser.contour.form.beta", 0.0, 100.0),
    ("fuser.contour.form.kappa", -5.9, 100.0),
    ("fuser.colour.search.iterations", 1.0, 200.0),
    ("fuser.colour.search.least_step_px", 0.001, 100.0),
    ("fuser.colour.search.size_step", 0.0, 0.5),
    share("fuser.colour.search.size_share"),
    ("fuser.colour.search.pixels", 16.0, 1e9),
    ("fuser.colour.sharpness", 0.001, 1e6),
    share("fuser.colour.least"),
    seconds("fuser.sound.separation_s"),
    ("fuser.sound.separation_rad", 0.0, 3.0),
    ("fuser.sound.least_deviation_px", 0.1, 10_000.0),
    ("fuser.sound.largest", 0.001, 10.0),
    share("fuser.verdict.outline"),
    share("fuser.verdict.no_outline"),
    share("fuser.verdict.colour"),
    share("fuser.verdict.no_colour"),
    ("fuser.verdict.smallest_px", 0.0, 1000.0),
    ("verifiers.contour.exponent", 0.0, 256.0),
    ("verifiers.contour.floor", -1000.0, 0.0),
    ("verifiers.contour_lines", 4.0, 256.0),
    ("verifiers.colour.exponent", 0.0, 100.0),
    ("verifiers.colour.floor", -1000.0, 0.0),
    ("verifiers.sound.exponent", 0.0, 100.0),
    ("verifiers.sound.floor", -1000.0, 0.0),
    ("verifiers.likeness.exponent", 0.0, 100.0),
    ("verifiers.likeness.floor", -1000.0, 0.0),
    seconds("faces.period_s"),
    ("faces.smallest_px", 1.0, 10_000.0),
    ("faces.neighbours", 0.0, 1e6),
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
    use crate::closed_loop::Parameters;
    use crate::limits::testing;

    #[test]
    fn every_number_has_a_range_around_its_default() {
        let defaults = serde_json::to_value(Parameters::default()).unwrap();
        testing::every_number_has_a_range(&RANGES, &[defaults], Some("audio.weighting."));
    }

    #[test]
    fn each_end_is_allowed_and_nothing_beyond_it() {
        testing::each_end_is_allowed_and_nothing_beyond(&RANGES);
    }
}
