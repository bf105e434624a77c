//! What makes sound: where it is, where it radiates to, and its samples. All are pure functions of time.

use super::error::{AcousticsError, check};
use hearsight_core::WorldPoint;
use nalgebra::Vector3;
use std::sync::Arc;

/// Where a source is and where it radiates to at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Place of the mouth, loudspeaker or other source, metres.
    pub position: WorldPoint,
    /// Where it faces; its length does not matter. Only directive sources use it.
    pub facing: Vector3<f64>,
}

/// Where a source is at any time.
///
/// Closures from seconds to `Option<Emission>` are paths. Answers are interpolated between instants 10 ms apart; what
/// moves faster than 50 m/s is taken to leap: it is silent on its way.
pub trait Path: Send + Sync {
    /// Where the source is `time_s` seconds into the scenario (perhaps before its start), or `None` while it is not in
    /// the room, where it is not heard. Must give the same answer to the same time.
    fn at(&self, time_s: f64) -> Option<Emission>;
}

impl<F: Fn(f64) -> Option<Emission> + Send + Sync> Path for F {
    fn at(&self, time_s: f64) -> Option<Emission> {
        self(time_s)
    }
}

/// A source that never moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing(pub Emission);

impl Path for Standing {
    fn at(&self, _: f64) -> Option<Emission> {
        Some(self.0)
    }
}

/// What a source plays: samples at a fixed rate, in any order, as often as asked for.
pub trait Sound: Send + Sync {
    /// Samples a second.
    fn rate_hz(&self) -> u32;

    /// Writes the samples numbered `first` and following; sample n belongs to n / rate seconds of the scenario. Numbers
    /// may be negative. Where there is no sound, zeros. Must write the same to the same numbers, however split.
    fn fill(&self, first: i64, samples: &mut [f32]);
}

/// How much of its sound a source radiates where: first-order patterns, gain = e + (1 - e) cos(angle from its facing).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
pub struct Directivity {
    /// The share e that goes everywhere alike, 0.5 to 1.
    pub everywhere: f64,
}

impl Directivity {
    /// The same everywhere.
    pub const OMNIDIRECTIONAL: Self = Self { everywhere: 1.0 };
    /// Nothing to the back.
    pub const CARDIOID: Self = Self { everywhere: 0.5 };
    /// Between both, 8 dB less to the back: what a head does to speech, averaged over its bands.
    pub const MOUTH: Self = Self { everywhere: 0.7 };

    /// The factor for sound that leaves at this cosine of the angle from the facing.
    pub fn gain(self, cosine: f64) -> f64 {
        self.everywhere + (1.0 - self.everywhere) * cosine
    }
}

/// One source of sound in the room.
#[derive(Clone)]
pub struct SoundSource {
    /// Its name, for messages.
    pub name: String,
    /// Where it is.
    pub path: Arc<dyn Path>,
    /// What it plays; speech and noises of [`crate::voice`] have a root mean square of 1 while they sound.
    pub sound: Arc<dyn Sound>,
    /// Where it radiates to.
    pub directivity: Directivity,
    /// Level at 1 m before it where the sound's root mean square is 1, decibels relative to full scale (0 dB is a root
    /// mean square of 1), -200 to 60. Speech near -30 leaves room for loud voices close to a microphone.
    pub level_db: f64,
}

impl SoundSource {
    /// Whether level, directivity and rate can be used.
    pub(crate) fn check(&self, rate_hz: u32) -> Result<(), AcousticsError> {
        let name = &self.name;
        check(
            (-200.0..=60.0).contains(&self.level_db),
            format!("level_db of source {name:?}"),
            "within -200 and 60",
            self.level_db,
        )?;
        check(
            (0.5..=1.0).contains(&self.directivity.everywhere),
            format!("directivity of source {name:?}"),
            "within 0.5 and 1",
            self.directivity.everywhere,
        )?;
        if self.sound.rate_hz() == rate_hz {
            return Ok(());
        }
        Err(AcousticsError::Rate {
            entry: format!("the sound of source {name:?}"),
            expected_hz: rate_hz,
            found_hz: self.sound.rate_hz(),
        })
    }

    /// The factor of the level.
    pub(crate) fn gain(&self) -> f64 {
        10.0_f64.powf(self.level_db / 20.0)
    }
}

/// Samples held in memory, at these numbers and silence elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// Samples a second.
    pub rate_hz: u32,
    /// Number of the first sample.
    pub first: i64,
    /// The samples.
    pub samples: Vec<f32>,
}

impl Sound for Clip {
    fn rate_hz(&self) -> u32 {
        self.rate_hz
    }

    fn fill(&self, first: i64, samples: &mut [f32]) {
        samples.fill(0.0);
        add_clip(self.first, &self.samples, first, samples);
    }
}

/// Adds a clip that begins at sample `clip_first` to samples that begin at `first`.
pub(crate) fn add_clip(clip_first: i64, clip: &[f32], first: i64, samples: &mut [f32]) {
    let begin = clip_first.max(first);
    let end = (clip_first + clip.len() as i64).min(first + samples.len() as i64);
    if begin >= end {
        return;
    }
    let from = &clip[(begin - clip_first) as usize..(end - clip_first) as usize];
    let to = &mut samples[(begin - first) as usize..(end - first) as usize];
    for (to, from) in to.iter_mut().zip(from) {
        *to += from;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clips_sound_where_they_are_and_nowhere_else() {
        let clip = Clip {
            rate_hz: 16_000,
            first: -2,
            samples: vec![1.0, 2.0, 3.0],
        };
        let mut all = [9.0; 6];
        clip.fill(-4, &mut all);
        assert_eq!(all, [0.0, 0.0, 1.0, 2.0, 3.0, 0.0]);
        let mut part = [9.0; 2];
        clip.fill(0, &mut part);
        assert_eq!(part, [3.0, 0.0]);
    }

    #[test]
    fn patterns_have_their_front_and_back() {
        assert_eq!(Directivity::CARDIOID.gain(1.0), 1.0);
        assert_eq!(Directivity::CARDIOID.gain(-1.0), 0.0);
        assert!((20.0 * Directivity::MOUTH.gain(-1.0).log10() + 7.96).abs() < 0.01);
        assert_eq!(Directivity::OMNIDIRECTIONAL.gain(-0.3), 1.0);
    }
}
