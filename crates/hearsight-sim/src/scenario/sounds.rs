//! Sounds that are not speech of people.

use super::names::Thing;
use super::raw::{RawNoise, RawScene};
use super::resolve::Resolver;
use crate::world::{Noise, NoiseKind, NoiseLevel, NoisePlace};
use hearsight_core::configuration::{ConfigurationError, Field};

const USUAL_LEVEL_DB: f64 = -45.0;
const USUAL_BAND_HZ: [f64; 2] = [1000.0, 200.0];
/// Height of what a base itself sounds from, metres.
const BASE_HEIGHT_M: f64 = 0.3;

/// Name of a kind, for names of things.
pub(super) fn kind_name(kind: Option<NoiseKind>) -> &'static str {
    match kind.unwrap_or(NoiseKind::Fan) {
        NoiseKind::Fan => "fan",
        NoiseKind::Television => "television",
        NoiseKind::Telephone => "telephone",
        NoiseKind::Cough => "cough",
        NoiseKind::Laugh => "laugh",
        NoiseKind::Clap => "clap",
        NoiseKind::Motor => "motor",
        NoiseKind::Street => "street",
        NoiseKind::White => "white",
        NoiseKind::Band => "band",
    }
}

impl Resolver {
    pub(super) fn noises(&self, raw: &RawScene) -> Result<Vec<Noise>, ConfigurationError> {
        let noises = raw.noise.iter().enumerate();
        noises
            .map(|(number, noise)| {
                self.noise(&Field::of("noise").index(number), noise, !raw.person.is_empty())
            })
            .collect()
    }

    fn noise(&self, field: &Field, raw: &RawNoise, people: bool) -> Result<Noise, ConfigurationError> {
        let Some(kind) = raw.kind else {
            return Err(self.missing(field, "kind", "say what makes the sound, such as kind = \"fan\""));
        };
        let place = match (raw.at, &raw.person, &raw.base) {
            (Some(place), None, None) => NoisePlace::Fixed(self.inside(&field.key("at"), place)?),
            (None, Some(name), None) => {
                NoisePlace::Person(
                    self.find(&field.key("person"), name, "person", |thing| match thing {
                        Thing::Person(number, _) => Some(number),
                        _ => None,
                    })?,
                )
            }
            (None, None, Some(name)) => {
                let base = self.find(&field.key("base"), name, "base", |thing| match thing {
                    Thing::Base(number) => Some(number),
                    _ => None,
                })?;
                NoisePlace::Base(base, BASE_HEIGHT_M)
            }
            (None, None, None) => NoisePlace::Diffuse,
            _ => {
                return Err(self.wrong(
                    field,
                    "comes from several places at once",
                    "keep one of at, person, base",
                ));
            }
        };
        if place == NoisePlace::Diffuse {
            if !matches!(kind, NoiseKind::Fan | NoiseKind::Street | NoiseKind::White) {
                let cure =
                    "give its place, `at = [x, y, z]`; fans, streets and white noise may be everywhere";
                return Err(self.wrong(
                    field,
                    format!("a {} comes from somewhere", kind_name(raw.kind)),
                    cure,
                ));
            }
            if !raw.during.is_empty() {
                let cure = "leave it out, or give the sound a place";
                return Err(self.wrong(
                    &field.key("during"),
                    "a sound from everywhere is always there",
                    cure,
                ));
            }
        }
        let level = match (raw.level, raw.snr) {
            (Some(_), Some(_)) => {
                return Err(self.wrong(field, "has `level` and `snr` at once", "keep one of them"));
            }
            (level, None) => NoiseLevel::Level(self.number(
                &field.key("level"),
                level,
                USUAL_LEVEL_DB,
                [-150.0, 40.0],
                "give decibels relative to full scale",
            )?),
            (None, Some(_)) if !people => {
                return Err(self.wrong(&field.key("snr"), "nobody speaks here", "give a `level` instead"));
            }
            (None, snr) => NoiseLevel::SignalToNoise(self.number(
                &field.key("snr"),
                snr,
                10.0,
                [-60.0, 100.0],
                "give decibels, such as 10",
            )?),
        };
        self.spans(&field.key("during"), &raw.during, "a sound")?;
        let band = raw.band.unwrap_or(USUAL_BAND_HZ);
        if !(band[0] > 0.0 && band[1] > 0.0 && band[1] < 2.0 * band[0] && band[0] < 100_000.0) {
            let what = format!("{band:?} is no band");
            return Err(self.wrong(
                &field.key("band"),
                what,
                "give middle and width in hertz, such as [1000, 200]",
            ));
        }
        let recording = match &raw.recording {
            Some(path) => Some(self.existing(&field.key("recording"), path)?),
            None => None,
        };
        let name = self.name_of(field);
        Ok(Noise {
            seed: self.seed_of("noise", &name),
            name,
            kind,
            place,
            level,
            during: if raw.during.is_empty() {
                vec![[0.0, self.seconds]]
            } else {
                raw.during.clone()
            },
            band_hz: band,
            recording,
        })
    }
}
