//! Sounds that are not speech of people: what they are, where, when and how loud.

use hearsight_core::WorldPoint;
use serde::Deserialize;
use std::path::PathBuf;

/// What makes a sound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NoiseKind {
    /// A fan: broad-band, with the tone of its blades.
    Fan,
    /// A television whose speakers talk.
    Television,
    /// A telephone that rings.
    Telephone,
    /// Coughs.
    Cough,
    /// Laughter.
    Laugh,
    /// Hands that clap.
    Clap,
    /// Motors that move something: louder the faster.
    Motor,
    /// A street outside: slow swells of low frequencies.
    Street,
    /// Noise with equal power at all frequencies.
    White,
    /// Noise within one band.
    Band,
}

/// Where a sound comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoisePlace {
    /// A place in the room.
    Fixed(WorldPoint),
    /// The mouth of a person, by number from 0.
    Person(usize),
    /// A moving base, by number from 0: its middle, so high above the floor, metres.
    Base(usize, f64),
    /// Everywhere: a diffuse field.
    Diffuse,
}

/// How loud a sound is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoiseLevel {
    /// Level at one metre while it sounds, decibels relative to full scale; of a diffuse field, at the microphones.
    Level(f64),
    /// So many decibels below the speech of people, at the microphones, while both sound.
    SignalToNoise(f64),
}

/// One source of sound that is not speech of people.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Its name, unique in the scenario.
    pub name: String,
    /// What it is.
    pub kind: NoiseKind,
    /// Where it is.
    pub place: NoisePlace,
    /// How loud it is.
    pub level: NoiseLevel,
    /// When it sounds: from and until, seconds, in order of time.
    pub during: Vec<[f64; 2]>,
    /// Middle and width of a band, hertz.
    pub band_hz: [f64; 2],
    /// A folder of recordings to be played instead.
    pub recording: Option<PathBuf>,
    /// What distinguishes it from others of its kind.
    pub seed: u64,
}

impl Noise {
    /// Whether it sounds at a time.
    pub fn is_sounding(&self, time_s: f64) -> bool {
        let begun = self.during.partition_point(|span| span[0] <= time_s);
        begun > 0 && time_s < self.during[begun - 1][1]
    }
}
