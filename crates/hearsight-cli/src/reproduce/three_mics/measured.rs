//! What one variant said of the speaker and their place beside what was so, tick by tick, and what comes of it.
//!
//! A frame of sound says who spoke in its middle, half a frame before the tick at which it is told: who speaks is compared
//! with that instant, where they are with the tick itself.

use hearsight::core::record::{Scene, TrackRecord};
use hearsight::core::truth::TruthRecord;
use hearsight::eval::metrics::equal_error::EqualErrorCounts;
use std::collections::{BTreeMap, VecDeque};

/// Farther from the speaker than this, sound alone is trapped, metres.
const TRAPPED_M: f64 = 1.0;
/// Half of the paper's frame of 0.27 s, the longest that any variant has, seconds.
const MIDDLE_S: f64 = 0.135;

/// A run beside the truth.
#[derive(Debug, Default)]
pub(super) struct Measurement {
    ticks: Vec<Tick>,
    /// What sounded lately, the oldest first.
    lately: VecDeque<Sounding>,
}

#[derive(Debug)]
struct Sounding {
    time_s: f64,
    /// Numbers of the people who speak.
    speakers: Vec<u64>,
    /// Whether the source that is told apart sounds.
    rival: bool,
}

#[derive(Debug)]
struct Tick {
    speaks: bool,
    /// The mouth of the only speaker.
    mouth: Option<[f64; 3]>,
    /// The probability that somebody who is seen speaks.
    probability: f64,
    heard: Option<[f64; 3]>,
    fused: Option<[f64; 3]>,
    /// Whether something is marked.
    marked: bool,
    /// Whether the source that is told apart sounds.
    rival: bool,
}

impl Measurement {
    /// Adds a tick. `rival` is the beginning of the names of sounds that are not to be taken for speakers.
    pub(super) fn push(&mut self, scene: &Scene, truth: &TruthRecord, rival: &str) {
        let middle = self.middle(truth, rival);
        let only = match middle.speakers[..] {
            [only] => Some(only),
            _ => None,
        };
        let mouth = truth.people.iter().find(|person| Some(person.id) == only);
        let tick = Tick {
            speaks: !middle.speakers.is_empty(),
            mouth: mouth.and_then(|person| person.mouth_m),
            probability: scene.nobody_probability.map_or(0.0, |nobody| 1.0 - nobody),
            heard: scene.sounds.first().and_then(|sound| sound.position_m),
            fused: likeliest(scene).and_then(|track| track.position_m),
            marked: scene.speaker.is_some(),
            rival: middle.rival,
        };
        self.ticks.push(tick);
    }

    /// What sounded at the tick that is nearest to the middle of the newest frame.
    fn middle(&mut self, truth: &TruthRecord, rival: &str) -> &Sounding {
        let speaking = truth.people.iter().filter(|person| person.speaking);
        self.lately.push_back(Sounding {
            time_s: truth.time_s,
            speakers: speaking.map(|person| person.id).collect(),
            rival: truth
                .sounds
                .iter()
                .any(|sound| sound.sounding && sound.name.starts_with(rival)),
        });
        let middle_s = truth.time_s - MIDDLE_S;
        let apart = |sounding: &Sounding| (sounding.time_s - middle_s).abs();
        while self.lately.len() > 1 && apart(&self.lately[1]) <= apart(&self.lately[0]) {
            self.lately.pop_front();
        }
        &self.lately[0]
    }

    /// All metrics that could be measured. Errors are those of the frames correctly taken for speech at the point where
    /// as much speech as silence is recognized.
    pub(super) fn metrics(&self) -> BTreeMap<String, f64> {
        let mut metrics = BTreeMap::new();
        let mut put = |name: &str, value: Option<f64>| {
            if let Some(value) = value {
                metrics.insert(name.to_owned(), value);
            }
        };
        let scores = |speaks: bool| {
            let ticks = self.ticks.iter().filter(move |tick| tick.speaks == speaks);
            ticks.map(|tick| tick.probability).collect()
        };
        let counts = EqualErrorCounts {
            speaking: scores(true),
            silent: scores(false),
        };
        let point = counts.point();
        put("equal", point.map(|point| 1.0 - point.rate));
        put("speech", self.share(|tick| tick.speaks, |tick| tick.marked));
        put("silence", self.share(|tick| !tick.speaks, |tick| !tick.marked));
        put(
            "rejected",
            self.share(|tick| tick.rival && !tick.speaks, |tick| !tick.marked),
        );
        let threshold = point.map_or(0.5, |point| point.threshold);
        let detected: Vec<&Tick> = self
            .ticks
            .iter()
            .filter(|tick| tick.probability >= threshold)
            .collect();
        for (prefix, place) in [
            ("audio", heard as fn(&Tick) -> Option<[f64; 3]>),
            ("fused", fused as fn(&Tick) -> Option<[f64; 3]>),
        ] {
            for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                let errors = errors(&detected, place).map(|error| error[axis]);
                put(&format!("{prefix}_{name}"), root_mean_square(errors));
            }
            let distance = errors(&detected, place).map(|error| norm(&error));
            put(&format!("{prefix}_3d"), root_mean_square(distance));
        }
        let quiet: Vec<&Tick> = self.ticks.iter().filter(|tick| !tick.rival).collect();
        let apart: Vec<f64> = errors(&quiet, heard)
            .map(|[x, y, _]| f64::from(x.hypot(y) > TRAPPED_M))
            .collect();
        put("trapped", mean(&apart));
        metrics
    }

    fn share(&self, of: impl Fn(&Tick) -> bool, which: impl Fn(&Tick) -> bool) -> Option<f64> {
        let all: Vec<f64> = self
            .ticks
            .iter()
            .filter(|tick| of(tick))
            .map(|tick| f64::from(which(tick)))
            .collect();
        mean(&all)
    }
}

fn heard(tick: &Tick) -> Option<[f64; 3]> {
    tick.heard
}

fn fused(tick: &Tick) -> Option<[f64; 3]> {
    tick.fused
}

/// The track that is marked, or that most probably speaks.
fn likeliest(scene: &Scene) -> Option<&TrackRecord> {
    let probability = |track: &&TrackRecord| track.speaking_probability.unwrap_or(0.0);
    let marked = scene.tracks.iter().find(|track| scene.speaker == Some(track.id));
    marked.or_else(|| {
        scene
            .tracks
            .iter()
            .max_by(|one, other| probability(one).total_cmp(&probability(other)))
    })
}

fn errors<'a>(
    ticks: &'a [&'a Tick],
    place: fn(&Tick) -> Option<[f64; 3]>,
) -> impl Iterator<Item = [f64; 3]> + 'a {
    ticks.iter().filter_map(move |tick| {
        let (found, truth) = (place(tick)?, tick.mouth?);
        Some([0, 1, 2].map(|axis| found[axis] - truth[axis]))
    })
}

fn norm(error: &[f64; 3]) -> f64 {
    error.iter().map(|value| value * value).sum::<f64>().sqrt()
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> Option<f64> {
    let squares: Vec<f64> = values.map(|value| value * value).collect();
    mean(&squares).map(f64::sqrt)
}

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight::core::truth::PersonTruth;

    fn tick(speaks: bool, probability: f64, error: [f64; 3]) -> Tick {
        Tick {
            speaks,
            mouth: speaks.then_some([1.0, 2.0, 1.2]),
            probability,
            heard: Some([1.0 + error[0], 2.0 + error[1], 1.2 + error[2]]),
            fused: Some([1.0 + error[0] / 2.0, 2.0, 1.2]),
            marked: probability > 0.5,
            rival: false,
        }
    }

    #[test]
    fn errors_are_of_the_frames_taken_for_speech_and_rates_of_all() {
        let measurement = Measurement {
            lately: VecDeque::new(),
            ticks: vec![
                tick(true, 0.9, [0.3, 0.0, 0.0]),
                tick(true, 0.8, [-0.4, 1.2, 0.0]),
                tick(true, 0.1, [9.0, 9.0, 9.0]),
                tick(false, 0.2, [0.0; 3]),
                tick(false, 0.05, [0.0; 3]),
                tick(false, 0.0, [0.0; 3]),
            ],
        };
        let metrics = measurement.metrics();
        let near = |name: &str, value: f64| {
            let found = metrics[name];
            assert!((found - value).abs() < 1e-9, "{name}: {found} is not {value}");
        };
        near("speech", 2.0 / 3.0);
        near("silence", 1.0);
        near("equal", 2.0 / 3.0);
        near("fused_y", 0.0);
        near("trapped", 2.0 / 3.0);
        // The equal point takes in the silent frame of 0.2, not the speech of 0.1.
        near("audio_x", (0.25_f64 / 2.0).sqrt());
        near("fused_x", (0.25_f64 / 8.0).sqrt());
        assert!(!metrics.contains_key("rejected"));
    }

    #[test]
    fn who_speaks_is_compared_with_the_middle_of_the_frame_and_places_with_the_tick() {
        let person = |id: u64, speaking: bool, x_m: f64| PersonTruth {
            id,
            name: id.to_string(),
            present: true,
            speaking,
            mouth_m: Some([x_m, 2.0, 1.2]),
            head_m: Some([x_m, 2.0, 1.25]),
            head_yaw_rad: Some(0.0),
            views: Vec::new(),
        };
        let mut measurement = Measurement::default();
        // Ten ticks a second: the first speaks until 0.2 s while walking, the second from then on.
        for tick in 0..5_u32 {
            let time_s = 0.1 * f64::from(tick);
            let truth = TruthRecord {
                tick: tick.into(),
                time_s,
                people: vec![person(1, tick < 2, time_s), person(2, tick >= 2, 4.0)],
                ..TruthRecord::default()
            };
            measurement.push(&Scene::default(), &truth, "rival");
        }
        let x_m: Vec<f64> = measurement
            .ticks
            .iter()
            .map(|tick| tick.mouth.unwrap()[0])
            .collect();
        for (found, expected) in x_m.iter().zip([0.0, 0.1, 0.2, 4.0, 4.0]) {
            assert!((found - expected).abs() < 1e-9, "{x_m:?}");
        }
    }
}
