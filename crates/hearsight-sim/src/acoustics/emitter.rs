//! One source as all microphones of an array need it: where it was lately, and its signal ready to be read anywhere.

use super::error::AcousticsError;
use super::kernel::{Branches, HALF, TAPS, branch_filters, correlate_into};
use super::room::Shoebox;
use super::source::SoundSource;
use super::synthesis::unit;

/// Instants a second at which positions are asked for.
const KEYS_PER_S: f64 = 100.0;
/// Seconds between two of them.
const KEY_S: f64 = 1.0 / KEYS_PER_S;
/// What moves faster leaps, metres a second.
const FASTEST_M_S: f64 = 50.0;

/// Where a source is at an instant, from the room's corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Key {
    pub(crate) position_m: [f64; 3],
    pub(crate) facing: [f64; 3],
    /// Whether it is in the room.
    present: bool,
}

/// Positions at instants [`KEY_S`] apart, of a stretch of time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Track {
    first: i64,
    keys: Vec<Key>,
    /// Number of the key since which nothing has changed.
    still_since: i64,
}

#[inline]
fn between(from: &[f64; 3], to: &[f64; 3], part: f64) -> [f64; 3] {
    [
        from[0] + part * (to[0] - from[0]),
        from[1] + part * (to[1] - from[1]),
        from[2] + part * (to[2] - from[2]),
    ]
}

impl Track {
    /// The key before a time and the share of the way to the next.
    #[inline]
    fn place(&self, time_s: f64) -> (usize, f64) {
        let place = (time_s * KEYS_PER_S - self.first as f64).max(0.0);
        let index = (place as usize).min(self.keys.len().saturating_sub(2));
        (index, (place - index as f64).min(1.0))
    }

    /// Where the source is, between two keys on the straight line.
    #[inline]
    pub(crate) fn position(&self, time_s: f64) -> [f64; 3] {
        let (index, part) = self.place(time_s);
        let (from, to) = (&self.keys[index].position_m, &self.keys[index + 1].position_m);
        between(from, to, part)
    }

    /// Where it faces; nearly of length 1.
    #[inline]
    pub(crate) fn facing(&self, time_s: f64) -> [f64; 3] {
        let (index, part) = self.place(time_s);
        let (from, to) = (&self.keys[index].facing, &self.keys[index + 1].facing);
        between(from, to, part)
    }

    /// Whether nothing has changed from a time to the end of the stretch.
    pub(crate) fn still_from(&self, time_s: f64) -> bool {
        (time_s * KEYS_PER_S).floor() as i64 >= self.still_since
    }

    /// How much of the source is heard at key `number`: 0 while it is away or leaps, else 1.
    fn heard(&self, number: i64) -> f32 {
        let index = (number - self.first) as usize;
        let Some(key) = self.keys.get(index) else {
            return 0.0;
        };
        let leaps = |a: &Key, b: &Key| {
            let square: f64 = (0..3)
                .map(|axis| (a.position_m[axis] - b.position_m[axis]).powi(2))
                .sum();
            square > (FASTEST_M_S * KEY_S).powi(2)
        };
        let after = self.keys.get(index + 1).is_some_and(|next| leaps(key, next));
        let before = index > 0 && leaps(&self.keys[index - 1], key);
        if key.present && !after && !before {
            1.0
        } else {
            0.0
        }
    }
}

/// A source, its recent past and what has been prepared of its future.
pub(crate) struct Emitter {
    pub(crate) source: SoundSource,
    gain: f64,
    pub(crate) track: Track,
    /// Samples with gain, from number `raw_first` on.
    raw: Vec<f32>,
    raw_first: i64,
    /// One for each mixture of bands, of which the first is the signal itself.
    pub(crate) branches: Vec<Branches>,
    /// Taps of the others.
    mixtures: Vec<Vec<f32>>,
    branch_filters: Vec<[f32; TAPS]>,
    mixed: Vec<f32>,
    /// Number of the last sample that was not silent; far in the past where none was.
    last_loud: i64,
}

/// A number of a sample before all others.
const LONG_AGO: i64 = i64::MIN / 2;

impl Emitter {
    /// `mixtures`: the taps of each mixture of bands that is needed besides the signal itself, all of one odd length.
    pub(crate) fn new(
        source: SoundSource,
        mixtures: Vec<Vec<f32>>,
        rate_hz: u32,
    ) -> Result<Self, AcousticsError> {
        source.check(rate_hz)?;
        Ok(Self {
            gain: source.gain(),
            source,
            track: Track::default(),
            raw: Vec::new(),
            raw_first: LONG_AGO,
            branches: vec![Branches::new(1); 1 + mixtures.len()],
            mixtures,
            branch_filters: branch_filters(),
            mixed: Vec::new(),
            last_loud: LONG_AGO,
        })
    }

    /// Samples on each side that a branch needs.
    fn margin(&self) -> i64 {
        (HALF + self.mixtures.first().map_or(0, |taps| taps.len() / 2)) as i64
    }

    /// Whether something may be heard that was emitted at sample `from` or later, as far as is prepared.
    pub(crate) fn sounds_since(&self, from: i64) -> bool {
        self.last_loud + self.margin() >= from
    }

    /// Asks for positions from `from_s` to `to_s` and forgets earlier ones.
    pub(crate) fn follow(&mut self, room: &Shoebox, from_s: f64, to_s: f64) -> Result<(), AcousticsError> {
        let first = (from_s * KEYS_PER_S).floor() as i64 - 2;
        // One key more than reached, to see whether the last one begins a leap.
        let end = (to_s * KEYS_PER_S).ceil() as i64 + 3;
        let track = &mut self.track;
        let known_end = track.first + track.keys.len() as i64;
        if track.keys.is_empty() || first < track.first || first >= known_end {
            track.keys.clear();
            track.first = first;
            track.still_since = first;
        } else {
            track.keys.drain(..(first - track.first) as usize);
            track.first = first;
        }
        for number in track.first + track.keys.len() as i64..end {
            let time_s = number as f64 * KEY_S;
            let key = match self.source.path.at(time_s) {
                Some(emission) => {
                    let entry = || format!("source {:?}", self.source.name);
                    let position_m = room.inside(emission.position, time_s, entry)?;
                    Key {
                        position_m,
                        facing: unit(emission.facing),
                        present: true,
                    }
                }
                // Stays where it was, unheard.
                None => match track.keys.last() {
                    Some(last) => Key {
                        present: false,
                        ..*last
                    },
                    None => Key {
                        position_m: [0.0; 3],
                        facing: [1.0, 0.0, 0.0],
                        present: false,
                    },
                },
            };
            if track.keys.last().is_some_and(|last| *last != key) {
                track.still_since = number;
            }
            track.keys.push(key);
        }
        track.still_since = track.still_since.max(track.first);
        Ok(())
    }

    /// Prepares the signal for reading from sample `from` to sample `to`, exclusive, and forgets what is before.
    ///
    /// Positions must be known until then.
    pub(crate) fn prepare(&mut self, from: i64, to: i64, rate_hz: u32) {
        let margin = self.margin();
        let begin = self.branches[0].end().max(from);
        // Raw samples that the new branches need.
        let (raw_from, raw_to) = (begin - margin, to + margin);
        let known_end = self.raw_first + self.raw.len() as i64;
        if raw_from >= known_end || raw_from < self.raw_first {
            self.raw.clear();
            self.raw_first = raw_from;
        } else {
            self.raw.drain(..(raw_from - self.raw_first) as usize);
            self.raw_first = raw_from;
        }
        let known = self.raw.len();
        let wanted = (raw_to - self.raw_first).max(0) as usize;
        if wanted > known {
            self.raw.resize(wanted, 0.0);
            let first = self.raw_first + known as i64;
            let samples = &mut self.raw[known..];
            self.source.sound.fill(first, samples);
            self.track.shade(self.gain, first, samples, rate_hz);
            if let Some(last) = samples.iter().rposition(|sample| *sample != 0.0) {
                self.last_loud = first + last as i64;
            }
        }
        let count = (to - begin).max(0) as usize;
        for (number, branches) in self.branches.iter_mut().enumerate() {
            branches.forget(from);
            let signal = match number
                .checked_sub(1)
                .and_then(|mixture| self.mixtures.get(mixture))
            {
                None => &self.raw[(margin - HALF as i64) as usize..][..count + 2 * HALF],
                Some(taps) => {
                    self.mixed.resize(count + 2 * HALF, 0.0);
                    correlate_into(&self.raw, taps, &mut self.mixed);
                    &self.mixed
                }
            };
            branches.append(&self.branch_filters, signal);
        }
    }

    /// Reads the signal itself at places that move evenly, as [`Branches::read`], into `output`.
    pub(crate) fn read_all(&self, start: f64, slope: f64, output: &mut [f32]) {
        output.fill(0.0);
        self.branches[0].read(start, slope, 1.0, 0.0, output);
    }
}

impl Track {
    /// Multiplies samples by the level and by how much of the source is heard; takes what is not finite as silence.
    fn shade(&self, gain: f64, first: i64, samples: &mut [f32], rate_hz: u32) {
        let per_key = f64::from(rate_hz) * KEY_S;
        let mut key = i64::MIN;
        let (mut from, mut to) = (0.0, 0.0);
        for (number, sample) in samples.iter_mut().enumerate() {
            let place = (first + number as i64) as f64 / per_key;
            let floor = place.floor();
            if floor as i64 != key {
                key = floor as i64;
                (from, to) = (self.heard(key), self.heard(key + 1));
            }
            let heard = if from == to {
                from
            } else {
                from + (place - floor) as f32 * (to - from)
            };
            let value = *sample * gain as f32 * heard;
            *sample = if value.is_finite() { value } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::room::{ShoeboxSettings, Walls};
    use super::super::source::{Clip, Directivity, Emission};
    use super::*;
    use hearsight_core::WorldPoint;
    use nalgebra::Vector3;
    use std::sync::Arc;

    fn emitter(
        path: impl Fn(f64) -> Option<[f64; 3]> + Send + Sync + 'static,
        walls: Walls,
    ) -> (Emitter, Shoebox) {
        let room = Shoebox::new(&ShoeboxSettings::new([6.0, 5.0, 3.0], walls)).unwrap();
        // Twice the signal, three samples later.
        let mut taps = vec![0.0; 401];
        taps[197] = 2.0;
        let mixtures = if room.is_banded() { vec![taps] } else { Vec::new() };
        let source = SoundSource {
            name: "one".to_owned(),
            path: Arc::new(move |time: f64| {
                path(time).map(|[x, y, z]| Emission {
                    position: WorldPoint::new(x, y, z),
                    facing: Vector3::x(),
                })
            }),
            sound: Arc::new(Clip {
                rate_hz: 16_000,
                first: 0,
                samples: vec![1.0; 16_000],
            }),
            directivity: Directivity::OMNIDIRECTIONAL,
            level_db: 0.0,
        };
        (Emitter::new(source, mixtures, 16_000).unwrap(), room)
    }

    #[test]
    fn mixtures_begin_with_the_signal() {
        let (mut one, room) = emitter(|_| Some([1.0; 3]), Walls::BandT60([0.4; 6]));
        one.follow(&room, -0.1, 0.3).unwrap();
        one.prepare(1000, 3000, 16_000);
        let mut output = [0.0; 500];
        one.read_all(2000.25, 0.0, &mut output);
        assert!(
            output.iter().all(|sample| (sample - 1.0).abs() < 2e-3),
            "{output:?}"
        );
    }

    #[test]
    fn who_is_away_or_leaps_is_not_heard() {
        let path = |time: f64| match time {
            ..0.2 => Some([1.0; 3]),
            0.2..0.4 => Some([4.0, 4.0, 1.0]),
            0.4..0.6 => None,
            _ => Some([2.0; 3]),
        };
        let (mut one, room) = emitter(path, Walls::Anechoic);
        one.follow(&room, -0.1, 0.9).unwrap();
        one.prepare(0, 12_000, 16_000);
        let at = |time: f64| {
            let mut output = [0.0; 1];
            one.read_all(time * 16_000.0, 0.0, &mut output);
            output[0]
        };
        for (time, wanted) in [(0.1, 1.0), (0.195, 0.0), (0.3, 1.0), (0.5, 0.0), (0.7, 1.0)] {
            assert!((at(time) - wanted).abs() < 2e-3, "{time}: {}", at(time));
        }
        // No step anywhere larger than the ramp of 10 ms.
        let mut output = vec![0.0; 10_000];
        one.read_all(1000.0, 0.0, &mut output);
        assert!(output.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.02));
        assert!(!one.track.still_from(0.3) && one.track.still_from(0.65));
    }

    #[test]
    fn a_source_that_walks_out_through_a_wall_is_named() {
        let (mut one, room) = emitter(|time| Some([5.0 + 2.0 * time, 1.0, 1.0]), Walls::Anechoic);
        one.follow(&room, 0.0, 0.2).unwrap();
        let error = one.follow(&room, 0.2, 1.0).unwrap_err();
        assert!(error.to_string().contains("source \"one\" at 0.51"), "{error}");
    }
}
