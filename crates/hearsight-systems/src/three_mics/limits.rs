//! Ranges of the parameters of three-mics.

use super::INFO;
use crate::limits::{Limit, Ranges};

const OWN: &[Limit] = &[
    ("room.low_m", -1000.0, 1000.0),
    ("room.high_m", -1000.0, 1000.0),
    ("audio.frame_s", 0.01, 2.0),
    ("audio.hop_s", 0.005, 2.0),
    ("audio.response.interpolation", 1.0, 64.0),
    ("audio.response.low_hz", 0.0, 24_000.0),
    ("audio.response.high_hz", 1.0, 1e6),
    ("audio.response.combination.product.floor", 1e-6, 0.999),
    ("audio.response.combination.product.exponent", 0.001, 100.0),
    ("audio.noise.smoothing_s", 0.001, 60.0),
    ("audio.noise.window_s", 0.01, 3600.0),
    ("audio.noise.start_s", 0.0, 3600.0),
    ("audio.noise.first_power", 1e-12, 1.0),
    ("audio.noise.rise_db_s", 0.01, 1000.0),
    ("audio.gate_db", -100.0, 100.0),
    ("audio.voice_s", 0.01, 2.0),
    ("audio.voice_hz", 0.0, 1e6),
    ("audio.activity.on_db", -100.0, 200.0),
    ("audio.activity.off_db", -100.0, 200.0),
    ("audio.activity.hangover_s", 0.0, 3600.0),
    ("audio.activity.slope", 0.001, 100.0),
    ("audio.activity.limit", 0.001, 100.0),
    ("audio.activity.independence_s", 0.001, 3600.0),
    ("audio.activity.mean_speech_s", 0.001, 3600.0),
    ("audio.activity.mean_pause_s", 0.001, 3600.0),
    ("sound.particles", 1.0, 100_000.0),
    ("sound.rate_per_s", 0.0, 1000.0),
    ("sound.velocity_m_s", 0.0, 100.0),
    ("sound.height.mean_m", -100.0, 100.0),
    ("sound.height.deviation_m", 0.001, 100.0),
    ("sound.external.filter.particles", 1.0, 100_000.0),
    ("sound.external.filter.distance_m", 0.0, 100.0),
    ("sound.external.filter.time_s", 0.0, 3600.0),
    ("sound.external.grid.coarse_m", 0.02, 10.0),
    ("sound.external.grid.distance_m", 0.0, 100.0),
    ("sound.external.grid.time_s", 0.0, 3600.0),
    ("sound.external.grid.advantage", -1000.0, 1000.0),
    ("vision.smallest_px", 8.0, 10_000.0),
    ("vision.largest_px", 0.0, 10_000.0),
    ("vision.full_search_s", 0.001, 3600.0),
    ("vision.change", 0.0, 255.0),
    ("vision.margin", 0.0, 10.0),
    ("vision.sizes", 0.1, 10.0),
    ("vision.scale_step", 1.01, 4.0),
    ("faces.particles", 1.0, 20_000.0),
    ("faces.walk.position", 0.0, 100.0),
    ("faces.walk.width", 0.0, 10.0),
    ("faces.likelihood.falloff", 0.0, 100.0),
    ("faces.likelihood.width_deviation", 0.001, 10.0),
    ("faces.likelihood.exponent", 0.0, 100.0),
    ("faces.likelihood.base", 1e-6, 1000.0),
    ("faces.colour.bins", 2.0, 32.0),
    ("faces.colour.weights", 0.0, 1000.0),
    ("faces.colour.variance", 1e-6, 1000.0),
    ("faces.colour.adaptation_s", 0.001, 1e6),
    ("faces.life.windows", 1.0, 1000.0),
    ("faces.life.support_s", 0.0, 3600.0),
    ("faces.life.seen", 0.0, 1000.0),
    ("faces.life.coloured", -1000.0, 1000.0),
    ("faces.life.missed", -1000.0, 0.0),
    ("faces.life.own_colours", 0.0, 1.0),
    ("faces.life.least", 0.0, 1.0),
    ("faces.life.overlap", 0.0, 1.0),
    ("faces.life.most", 1.0, 1000.0),
    ("association.residual_m", 0.001, 100.0),
    ("association.deviations", 0.001, 1000.0),
    ("association.height_m", -100.0, 100.0),
    ("association.face_width_m", 0.001, 10.0),
    ("activity.turn_s", 0.001, 3600.0),
    ("activity.independent_s", 0.001, 3600.0),
    ("activity.voice_independent_s", 0.001, 3600.0),
    ("activity.fit", -100.0, 100.0),
    ("activity.edge", -100.0, 100.0),
    ("activity.apart", -100.0, 100.0),
    ("activity.silence", -100.0, 100.0),
    ("activity.least", 0.0, 1.0),
    ("place.walk_m", 0.0, 100.0),
    ("place.independent_s", 0.001, 3600.0),
    ("place.box_deviation", 0.0, 1.0),
    ("place.sure", 0.0, 2.0),
];

/// The ranges of all parameters.
pub(super) const RANGES: Ranges = Ranges {
    system: INFO.name,
    tables: &[OWN],
    optional: &["room", "sound.height"],
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::testing;
    use crate::three_mics::{Parameters, RoomBox};
    use hearsight_tracking::sound::External;

    #[test]
    fn every_number_has_a_range_around_its_default_and_every_range_a_number() {
        let mut full = Parameters {
            room: Some(RoomBox {
                low_m: [-2.0; 3],
                high_m: [2.0; 3],
            }),
            ..Parameters::default()
        };
        let filter = External::Filter {
            particles: 500,
            distance_m: 1.0,
            time_s: 1.0,
        };
        let written = [External::default(), filter].map(|external| {
            full.sound.external = external;
            serde_json::to_value(&full).unwrap()
        });
        testing::every_number_has_a_range(&RANGES, &written, None);
    }

    #[test]
    fn each_end_is_allowed_and_nothing_beyond_it() {
        testing::each_end_is_allowed_and_nothing_beyond(&RANGES);
    }
}
